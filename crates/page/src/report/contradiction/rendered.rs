//! Statements found in the texts of a report, by their words alone.

use std::collections::BTreeSet;

use realgap_lab::claim::Claim;

/// The texts of a report in every place that shows it.
pub(in crate::report) struct RenderedTexts {
    pub name: String,
    /// On the terminal.
    pub text: String,
    /// In the first sentences of the page.
    pub answer: String,
    /// In all of the page, a line a row or paragraph.
    pub page: String,
    /// In the file of the best values.
    pub more: String,
    pub claims: Vec<Claim>,
}

impl RenderedTexts {
    /// The places that say something of parameters.
    pub fn places(&self) -> [(&'static str, &str); 4] {
        [
            ("terminal", &self.text),
            ("page's answer", &self.answer),
            ("page", &self.page),
            ("best.ron", &self.more),
        ]
    }

    /// A page's first sentences are claims, and nothing else.
    pub(crate) fn only_claims(&self, contradictions: &mut Vec<String>) {
        let mut rest = self.answer.clone();
        for claim in &self.claims {
            rest = rest.replacen(&claim.text, "", 1);
        }
        let left = rest.trim_matches([' ', '.']);
        if !left.is_empty() {
            contradictions.push(format!("{}: the page alone says {left}", self.name));
        }
    }
}

/// A page without markup: a line for what stands alone, cells of a row after each other.
pub(in crate::report) fn plain(page: &str) -> String {
    let mut text = String::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        text += &rest[..start];
        let tag = &rest[start + 1..];
        let end = tag.find('>').unwrap_or(tag.len() - 1);
        let name = tag[..end].trim_start_matches('/');
        let name = name.split([' ', '>']).next().unwrap_or_default();
        rest = &tag[end + 1..];
        text += match name {
            "td" | "th" => " | ",
            "em" | "b" | "span" => "",
            _ => "\n",
        };
        if ["script", "style"].contains(&name) && tag.starts_with(name) {
            let close = format!("</{name}");
            rest = &rest[rest.find(&close).unwrap_or(0)..];
        }
    }
    text += rest;
    let lines = text.lines().map(|line| line.trim_start_matches([' ', '|']));
    let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
    let marks = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&amp;", "&"),
    ];
    let text = lines.join("\n");
    marks
        .iter()
        .fold(text, |text, (mark, sign)| text.replace(mark, sign))
}

/// The parts of lines that are about a parameter: parts about different parameters are separated by semicolons or full stops.
pub(in crate::report) fn whole_line<'a>(
    text: &'a str,
    name: &'a str,
) -> impl Iterator<Item = &'a str> {
    let is_about = move |part: &str| {
        part.find("floor.")
            .is_some_and(|at| part[at..].starts_with(name))
    };
    let mut parts: Vec<&str> = Vec::new();
    for line in text.lines().flat_map(|line| line.split(". ")) {
        // What follows a semicolon belongs to what was named before, up to the next name.
        let mut from = 0;
        for (at, _) in line.match_indices("; floor.") {
            parts.push(&line[from..at]);
            from = at + 2;
        }
        parts.push(&line[from..]);
    }
    parts.into_iter().filter(move |part| is_about(part))
}

/// Whether a text calls a parameter determined or not; both where it contradicts itself.
pub(in crate::report) fn polarity(text: &str, name: &str) -> BTreeSet<bool> {
    let known = [
        "narrowed down",
        "interval",
        "lies in",
        "is at most",
        "is at least",
    ];
    let heard = |part: &str| {
        if part.contains("not determined") {
            Some(false)
        } else {
            known.iter().any(|word| part.contains(word)).then_some(true)
        }
    };
    whole_line(text, name).filter_map(heard).collect()
}

/// An interval as it was printed.
#[derive(Debug)]
pub(in crate::report) struct Span {
    low: f64,
    high: f64,
    /// Half of the last digit.
    rounding: f64,
}

impl Span {
    /// Whether it is this interval, as far as its digits go.
    pub fn is(&self, (low, high): (f64, f64)) -> bool {
        let near = |said: f64, is: f64| (said - is).abs() <= 1.001 * self.rounding;
        near(self.low, low) && near(self.high, high)
    }
}

/// The intervals that a part of a line gives a parameter; `None` where it gives none.
pub(in crate::report) fn spans(part: &str) -> Option<Vec<Span>> {
    let opening = ["interval ", "narrowed down to ", "lies in "];
    let after = opening.iter().find_map(|word| part.split(word).nth(1))?;
    let mut words = after.split_whitespace();
    let mut spans = Vec::new();
    loop {
        let (low, to, high) = (words.next()?, words.next()?, words.next()?);
        if to != "to" {
            return None;
        }
        let high = high.trim_end_matches([')', ';', ',', '.']);
        let digits = high.split('.').nth(1).map_or(0, str::len);
        spans.push(Span {
            low: low.parse().ok()?,
            high: high.parse().ok()?,
            rounding: 0.5 * 0.1_f64.powi(digits as i32),
        });
        if words.next() != Some("or") {
            return Some(spans);
        }
    }
}
