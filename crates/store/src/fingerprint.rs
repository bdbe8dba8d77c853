//! The fingerprint of a run: everything that decides its results, as named texts that can be compared.

use realgap_core::error::{Advice, Error, Result};

/// Names of the entries with the version of the program that made the results.
const VERSIONS: [&str; 2] = ["realgap", "engine"];

/// Named texts in order: versions, hashes of inputs, ranges, settings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Fingerprint(Vec<(String, String)>);

impl Fingerprint {
    /// An empty fingerprint.
    pub fn new() -> Self {
        Self::default()
    }

    /// The fingerprint with one more entry.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.0.push((name.into(), value.to_string()));
        self
    }

    /// The entries, in order.
    pub fn entries(&self) -> &[(String, String)] {
        &self.0
    }

    /// Checks that `self` (the present run) equals `stored` (the run in the folder).
    ///
    /// # Errors
    /// The first entry that differs, with both values.
    pub fn must_equal(&self, stored: &Self) -> Result<()> {
        let value = |set: &Self, name: &str| {
            set.0
                .iter()
                .find(|(n, _)| n == name)
                .map(|(_, v)| v.clone())
        };
        let names = self.0.iter().chain(&stored.0).map(|(name, _)| name);
        for name in names {
            let (now, then) = (value(self, name), value(stored, name));
            if now != then {
                let text = |v: Option<String>| v.unwrap_or_else(|| "nothing".to_owned());
                let (now, then) = difference(&text(now), &text(then));
                let error = Error::conflict("the stored results belong to a different study")
                    .field(name.clone())
                    .found(format!("now {now}, stored {then}"))
                    .allowed("the same study, unchanged")
                    .advise(Advice::OtherFolder);
                return Err(if VERSIONS.contains(&name.as_str()) {
                    error.hint("these results can still be listed; continue the run with the version that made them")
                } else {
                    error.hint("undo the change")
                });
            }
        }
        Ok(())
    }
}

/// The length of the longest text that an error shows completely, characters.
const SHOWN: usize = 80;
/// The number of characters that an error shows of a longer text before the first difference.
const BEFORE: usize = 20;

/// Two texts as an error shows them: one line each; long texts start shortly before the first difference.
fn difference(one: &str, other: &str) -> (String, String) {
    let same = one.chars().zip(other.chars()).take_while(|(a, b)| a == b);
    let from = same.count().saturating_sub(BEFORE);
    let shown = |text: &str| {
        let count = text.chars().count();
        let from = if count <= SHOWN { 0 } else { from };
        let middle: String = text.chars().skip(from).take(SHOWN).collect();
        let start = if from > 0 { "..." } else { "" };
        let end = if from + SHOWN < count { "..." } else { "" };
        // The stored text comes from a file of unknown origin, so control characters are escaped.
        format!("{start}{}{end}", middle.escape_debug()).replace("\\\"", "\"")
    };
    (shown(one), shown(other))
}

impl FromIterator<(String, String)> for Fingerprint {
    fn from_iter<T: IntoIterator<Item = (String, String)>>(entries: T) -> Self {
        Self(entries.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_named_with_both_values() {
        let stored = Fingerprint::new().with("engine", "1").with("points", 21);
        let now = Fingerprint::new().with("engine", "1").with("points", 11);
        assert!(stored.must_equal(&stored).is_ok());
        let message = now.must_equal(&stored).unwrap_err().to_string();
        assert!(
            message.contains("points") && message.contains("now 11, stored 21"),
            "{message}"
        );
    }

    #[test]
    fn long_texts_are_shown_where_they_differ_and_control_characters_are_escaped() {
        let long = |end: &str| format!("{}{end}", "a".repeat(500));
        let stored = Fingerprint::new().with("strategy", long("\u{1b}[2Jseed: 1"));
        let now = Fingerprint::new().with("strategy", long("seed: 2 \"b\""));
        let message = now.must_equal(&stored).unwrap_err().to_string();
        assert!(
            message.contains("...aaaaaaaaaaaaaaaaaaaaseed: 2 \"b\""),
            "{message}"
        );
        assert!(message.contains("\\u{1b}[2Jseed: 1"), "{message}");
        assert!(
            message.len() < 500 && !message.contains('\u{1b}'),
            "{message}"
        );
    }

    #[test]
    fn an_entry_missing_on_either_side_is_a_difference() {
        let long = Fingerprint::new().with("engine", "1").with("points", 21);
        let short = Fingerprint::new().with("engine", "1");
        assert!(long.must_equal(&short).is_err());
        assert!(short.must_equal(&long).is_err());
    }
}
