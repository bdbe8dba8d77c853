//! The file `round.json`: the rows that are simulated at the moment.

use serde::{Deserialize, Serialize};

use super::Plan;
use super::plan_file::write_json;
use realgap_core::file::Source;
use realgap_core::{Error, Result};
use realgap_store::Share;

/// Name of the file.
const FILE: &str = "round.json";

/// The rows that are simulated at the moment: those from number `from` to below `to` that are not merged yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Round {
    /// Its number, from 0.
    pub number: usize,
    /// First row.
    pub from: usize,
    /// Row after the last.
    pub to: usize,
    /// Number of its rows that are merged.
    pub merged: usize,
    /// Whether no further rows are needed, so that only the answer has to be written.
    pub complete: bool,
}

impl Round {
    /// The first round: so many rows, of which none is done.
    pub fn first(rows: usize) -> Self {
        Self {
            number: 0,
            from: 0,
            to: rows,
            merged: 0,
            complete: false,
        }
    }

    /// The round that follows once `asked` rows are requested and the rows in `missing` do not exist.
    #[must_use]
    pub fn after(self, asked: usize, missing: &[usize]) -> Self {
        let Some(&first) = missing.first() else {
            return Self {
                merged: asked.max(self.to) - self.from,
                to: asked.max(self.to),
                complete: true,
                ..self
            };
        };
        let (number, from) = if first >= self.to {
            (self.number + 1, self.to)
        } else {
            (self.number, self.from)
        };
        Self {
            number,
            from,
            to: asked,
            merged: asked - from - missing.len(),
            complete: false,
        }
    }

    /// The current round where its file is lost: the last one that has shards.
    pub(super) fn found_again(number: usize, asked: usize, missing: &[usize]) -> Self {
        let from = missing.first().copied().unwrap_or(asked);
        Self {
            number,
            from,
            to: asked,
            merged: asked - from - missing.len(),
            complete: missing.is_empty(),
        }
    }

    /// Rows of the round that a shard simulates, merged ones included.
    pub fn rows_of(&self, share: Share) -> usize {
        (self.from..self.to).filter(|row| share.has(*row)).count()
    }

    /// As [`Round::rows_of`], for each of so many shards.
    pub(crate) fn rows_of_each(&self, shards: usize) -> Vec<usize> {
        let mut rows = vec![0; shards];
        for row in self.from..self.to {
            rows[Share::owner(row, shards)] += 1;
        }
        rows
    }
}

impl Plan {
    /// The current round.
    ///
    /// # Errors
    /// No readable `round.json` beside the plan.
    pub fn round(&self) -> Result<Round> {
        let file = self.folder().join(FILE);
        let source = Source::read(&file, "round")?;
        let refused = |found: String| {
            Error::invalid("not a round of a plan")
                .at_file(&file)
                .found(found)
                .hint("remove this file: the next merge writes it anew from what is merged")
        };
        let round: Round =
            serde_json::from_str(source.text()).map_err(|e| refused(e.to_string()))?;
        if round.from > round.to || round.merged > round.to - round.from {
            return Err(refused(format!(
                "rows {} to {}, {} of them merged",
                round.from, round.to, round.merged
            )));
        }
        Ok(round)
    }

    /// Writes the current round.
    ///
    /// # Errors
    /// A full disk or a folder that cannot be written.
    pub(crate) fn write_round(&self, round: &Round) -> Result<()> {
        write_json(&self.folder().join(FILE), round)
    }

    /// Whether there is no file of the current round.
    pub(crate) fn has_round(&self) -> bool {
        self.folder().join(FILE).exists()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_ends_when_all_of_its_rows_are_merged() {
        let first = Round::first(10);
        let partly = first.after(10, &[3, 7]);
        assert_eq!((partly.number, partly.merged), (0, 8));
        let missing: Vec<usize> = (10..14).collect();
        let second = partly.after(14, &missing);
        assert_eq!(
            (second.number, second.from, second.to, second.merged),
            (1, 10, 14, 0)
        );
        let rows = [0, 1, 2].map(|n| second.rows_of(Share::new(n, 3).unwrap()));
        assert_eq!(second.rows_of_each(3), rows);
        assert_eq!(rows.iter().sum::<usize>(), 4);
        // Two blocks of rows are begun, so no shard has more than one row of each.
        assert!(rows.iter().all(|count| *count <= 2), "{rows:?}");
        let end = second.after(14, &[]);
        assert!(end.complete && end.merged == 4, "{end:?}");
    }
}
