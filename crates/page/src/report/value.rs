//! Reports as they stand in a folder: JSON of which anything may be missing, and what it says for people.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde_json::Value;

use super::page::html;
use realgap_core::error::{Error, Result};
use realgap_core::unit::{Unit, number, quantity};

/// A JSON file; `whose` is for the message, e.g. `a report`.
///
/// # Errors
/// A file that cannot be read, or holds something else.
pub(super) fn read_json<T: DeserializeOwned>(path: &Path, whose: &str) -> Result<T> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io("read the file", path, &e))?;
    serde_json::from_str(&text)
        .map_err(|e| Error::invalid(format!("not {whose}: {e}")).at_file(path))
}

/// What a report says under a name, whatever else it holds.
pub(super) trait Found {
    /// The value at `a.b.2`; null where there is none.
    fn at(&self, path: &str) -> &Value;

    fn text(&self, name: &str) -> &str {
        self.at(name).as_str().unwrap_or_default()
    }

    fn owned(&self, name: &str) -> String {
        self.text(name).to_owned()
    }

    /// A text, or another where there is none.
    fn named(&self, name: &str, otherwise: &str) -> String {
        match self.text(name) {
            "" => otherwise.to_owned(),
            text => text.to_owned(),
        }
    }

    fn list(&self, name: &str) -> &[Value] {
        self.at(name).as_array().map_or(&[], Vec::as_slice)
    }

    fn float(&self, name: &str) -> Option<f64> {
        self.at(name).as_f64()
    }

    fn count(&self, name: &str) -> Option<u64> {
        self.at(name).as_u64()
    }

    /// A count for people, or a dash.
    fn number(&self, name: &str) -> String {
        self.count(name).map_or("–".to_owned(), |n| n.to_string())
    }

    fn is(&self, name: &str) -> Option<bool> {
        self.at(name).as_bool()
    }

    /// Numbers of a list.
    fn floats(&self, name: &str) -> Vec<f64> {
        let values = self.list(name).iter();
        values.map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()
    }

    /// A number with its unit as people write it, or a dash.
    fn measured(&self, name: &str, unit: &str) -> String {
        measured(self.float(name), unit)
    }

    /// A share as whole percent, or a dash.
    fn percent(&self, name: &str) -> String {
        percent(self.float(name))
    }

    /// From one number to another, or a dash.
    fn span(&self, [low, high]: [&str; 2], unit: &str) -> String {
        span(self.float(low), self.float(high), unit)
    }

    /// The same in a sentence, which says what the interval is.
    fn likely(&self, name: &str) -> String {
        self.proportion(name).replacen('(', "(95 %: ", 1)
    }

    /// A proportion: its share with the interval of sampling.
    fn proportion(&self, name: &str) -> String {
        let found = self.at(name);
        match found.float("share") {
            None => "–".to_owned(),
            share => {
                let (low, high) = (found.percent("low"), found.percent("high"));
                format!("{} ({low} to {high})", percent(share))
            }
        }
    }
}

impl Found for Value {
    fn at(&self, path: &str) -> &Value {
        let found = path.split('.').try_fold(self, |value, name| match value {
            Self::Array(all) => all.get(name.parse::<usize>().ok()?),
            _ => value.get(name),
        });
        found.unwrap_or(&Self::Null)
    }
}

/// A number with its unit as people write it, or a dash.
pub(super) fn measured(value: Option<f64>, unit: &str) -> String {
    match (value, unit) {
        (None, _) => "–".to_owned(),
        (Some(value), "m") => quantity(value, Unit::Metre),
        (Some(value), "" | "1") => number(value),
        (Some(value), unit) => format!("{} {unit}", number(value)),
    }
}

/// `low to high`, or a dash.
pub(super) fn span(low: Option<f64>, high: Option<f64>, unit: &str) -> String {
    if low.is_none() && high.is_none() {
        return "–".to_owned();
    }
    format!("{} to {}", measured(low, unit), measured(high, unit))
}

/// A share as whole percent, or a dash.
pub(super) fn percent(share: Option<f64>) -> String {
    // A zero of rounding has no sign.
    share.map_or_else(
        || "–".to_owned(),
        |share| format!("{:.0} %", (100.0 * share).round() + 0.0),
    )
}

/// A value without parts, for people; `None` for what has parts or is nothing.
pub(super) fn scalar(value: &Value) -> Option<String> {
    match value {
        Value::Number(n) if n.is_f64() => n.as_f64().map(number),
        Value::Number(n) => Some(n.to_string()),
        Value::String(text) => Some(text.clone()),
        Value::Bool(yes) => Some(if *yes { "yes" } else { "no" }.to_owned()),
        _ => None,
    }
}

/// Cells longer than this are text, which may wrap.
const WORDS: usize = 36;

/// A table with what to say below it; nothing without rows.
pub(super) fn noted(head: &str, rows: impl IntoIterator<Item = Vec<String>>, note: &str) -> String {
    let rows: Vec<Vec<String>> = rows.into_iter().collect();
    if rows.is_empty() {
        return String::new();
    }
    let below = match note {
        "" => String::new(),
        note => format!("<p class=\"note\">{note}</p>"),
    };
    titled(head, rows) + &below
}

/// A table whose columns are `called | so`.
pub(super) fn titled(head: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    table(&head.split('|').map(str::trim).collect::<Vec<_>>(), rows)
}

/// A table; the first column names its rows. Cells are texts, nothing in them is markup.
pub(super) fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let rows: Vec<Vec<String>> = rows.into_iter().collect();
    let is_words = |column: usize| {
        let mut cells = rows.iter().filter_map(|row| row.get(column));
        cells.any(|cell| cell.chars().count() > WORDS)
    };
    let words: Vec<bool> = (0..head.len()).map(is_words).collect();
    let class = |column: usize| match words.get(column) {
        Some(true) => " class=\"words\"",
        _ => "",
    };
    let head: String = head
        .iter()
        .enumerate()
        .map(|(column, name)| format!("<th scope=\"col\"{}>{}</th>", class(column), html(name)))
        .collect();
    let mut body = String::new();
    for row in rows.iter() {
        body.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            let words = class(column);
            let cell = html(cell);
            body += &if column == 0 {
                format!("<th scope=\"row\"{words}>{cell}</th>")
            } else {
                format!("<td{words}>{cell}</td>")
            };
        }
        body.push_str("</tr>");
    }
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )
}

/// What stands directly in a report, or one level below, and is a number or a short text; names in `said` are told elsewhere.
pub(super) fn scalars(report: &Value, said: &[&str]) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for (name, value) in report.as_object().into_iter().flatten() {
        if said.contains(&name.as_str()) {
            continue;
        }
        let shown = name.replace('_', " ");
        if let Some(text) = scalar(value) {
            all.push((shown.clone(), text));
        }
        for (inner, value) in value.as_object().into_iter().flatten() {
            if let Some(text) = scalar(value) {
                all.push((format!("{shown}: {}", inner.replace('_', " ")), text));
            }
        }
    }
    all
}

/// Pairs of texts, borrowed.
pub(super) fn pairs_of(pairs: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> {
    let pairs = pairs.iter();
    pairs.map(|(name, text)| (name.as_str(), text.as_str()))
}

/// What stands in a list of names and values.
pub(super) fn entries<'a>(pairs: impl IntoIterator<Item = (&'a str, &'a str)>) -> String {
    let entry = |(name, value)| format!("<dt>{}</dt><dd>{}</dd>", html(name), html(value));
    pairs.into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_missing_is_a_dash() {
        let report = serde_json::json!({ "a": { "b": { "low": 0.25 } }, "n": [1.0, null] });
        assert_eq!(report.float("a.b.low"), Some(0.25));
        assert!(report.at("a.x.low").is_null());
        assert_eq!(measured(None, "m"), "–");
        assert_eq!(measured(Some(0.118), "m"), "11.8 cm");
        assert_eq!(span(Some(0.01), None, "m"), "1.00 cm to –");
        assert!(report.floats("n")[1].is_nan());
        assert_eq!(percent(Some(0.123)), "12 %");
        assert_eq!(percent(Some(-0.004)), "0 %");
        let odds = serde_json::json!({ "p": { "share": 0.5, "low": 0.25, "high": 0.75 } });
        assert_eq!(odds.likely("p"), "50 % (95 %: 25 % to 75 %)");
    }

    #[test]
    fn cells_are_no_markup() {
        let table = table(&["<a>"], [vec!["<b>".to_owned(), "x".to_owned()]]);
        assert!(!table.contains("<a>") && !table.contains("<b>"), "{table}");
    }
}
