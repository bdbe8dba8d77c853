//! Values and tables of a report for readers; a missing value is a dash.

use crate::report::document::page::html;
use realgap_core::statistics::Proportion;
use realgap_core::unit::{Unit, number, percent_range, quantity};

/// The text for a missing value.
pub(in crate::report) const NOTHING: &str = "–";

/// A number with its unit as people write it, or a dash.
pub(in crate::report) fn measured(value: impl Into<Option<f64>>, unit: &str) -> String {
    match (value.into(), unit) {
        (None, _) => NOTHING.to_owned(),
        (Some(value), "m") => quantity(value, Unit::Metre),
        (Some(value), "" | "1") => number(value),
        (Some(value), unit) => format!("{} {unit}", number(value)),
    }
}

/// `low to high`, or a dash.
pub(in crate::report) fn span(
    low: impl Into<Option<f64>>,
    high: impl Into<Option<f64>>,
    unit: &str,
) -> String {
    match (low.into(), high.into()) {
        (None, None) => NOTHING.to_owned(),
        (low, high) => format!("{} to {}", measured(low, unit), measured(high, unit)),
    }
}

/// A share as whole percent, or a dash.
pub(in crate::report) fn percent(share: impl Into<Option<f64>>) -> String {
    // A zero of rounding has no sign.
    let shown = |share: f64| format!("{:.0} %", (100.0 * share).round() + 0.0);
    share.into().map_or_else(|| NOTHING.to_owned(), shown)
}

/// An observed share with its interval, or a dash.
pub(crate) fn odds(found: impl Into<Option<Proportion>>) -> String {
    let Some(found) = found.into() else {
        return NOTHING.to_owned();
    };
    format!(
        "{} ({})",
        percent(found.share),
        percent_range(found.low, found.high)
    )
}

/// The count and the number of trials.
pub(in crate::report) fn counted_of(found: &Proportion) -> String {
    format!("{} of {}", found.count, found.trials)
}

/// A value as its own text, or a dash.
pub(in crate::report) fn shown(value: Option<impl ToString>) -> String {
    value.map_or_else(|| NOTHING.to_owned(), |value| value.to_string())
}

/// Cells longer than this are text, which may wrap.
const WORDS: usize = 36;

/// A table with a note below it; nothing without rows.
pub(in crate::report) fn noted(
    head: &str,
    rows: impl IntoIterator<Item = Vec<String>>,
    note: &str,
) -> String {
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
pub(in crate::report) fn titled(head: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    table(&head.split('|').map(str::trim).collect::<Vec<_>>(), rows)
}

/// A table; the first column names its rows. Cells are texts, nothing in them is markup.
pub(in crate::report) fn table(
    head: &[&str],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
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

/// Pairs of texts, borrowed.
pub(in crate::report) fn pairs_of(
    pairs: &[(String, String)],
) -> impl Iterator<Item = (&str, &str)> {
    let pairs = pairs.iter();
    pairs.map(|(name, text)| (name.as_str(), text.as_str()))
}

/// The entries of a list of names and values.
pub(in crate::report) fn entries<'a>(
    pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> String {
    let entry = |(name, value)| format!("<dt>{}</dt><dd>{}</dd>", html(name), html(value));
    pairs.into_iter().map(entry).collect()
}

/// Content that is shown after a click on its name; both are markup.
pub(in crate::report) fn folded(name: &str, content: &str) -> String {
    format!("<details><summary>{name}</summary>{content}</details>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_missing_is_a_dash() {
        assert_eq!(measured(None, "m"), "–");
        assert_eq!(measured(0.118, "m"), "11.8 cm");
        assert_eq!(span(0.01, None, "m"), "1.00 cm to –");
        assert_eq!(percent(0.123), "12 %");
        assert_eq!(percent(-0.004), "0 %");
        assert_eq!(odds(None), "–");
        let half = Proportion::new(2, 4, 0.95);
        assert_eq!(odds(half), "50 % (15 to 85 %)");
        // Of many trials both ends are near: they are never the same text.
        let all = Proportion::new(20_000, 20_000, 0.95);
        assert_eq!(odds(all), "100 % (99.98 to 100 %)");
        let none = Proportion::new(0, 20_000, 0.95);
        assert_eq!(odds(none), "0 % (0 to 0.02 %)");
    }

    #[test]
    fn cells_are_no_markup() {
        let table = table(&["<a>"], [vec!["<b>".to_owned(), "x".to_owned()]]);
        assert!(!table.contains("<a>") && !table.contains("<b>"), "{table}");
    }
}
