//! A store of trials, whose scores are kept apart: a basis that is fitted later changes them.

use super::connection::sql;
use super::database::Store;
use super::trial::{Trial, TrialScore};
use realgap_core::error::Result;

impl Store<Trial> {
    /// All trials, by index.
    ///
    /// # Errors
    /// As [`Store::rows`].
    pub fn trials(&self) -> Result<Vec<Trial>> {
        self.rows()
    }

    /// Keeps the scores of trials; scores of the same trial are replaced (a basis fitted later changes them).
    ///
    /// # Errors
    /// A full disk or a store that cannot be written.
    pub fn insert_scores(&mut self, scores: &[TrialScore]) -> Result<()> {
        self.write("write the results", |transaction, tally| {
            for score in scores {
                if let Some(old) = score.replaced(transaction)? {
                    tally.remove(old);
                }
                tally.add(score.insert(transaction)?);
            }
            Ok(())
        })
    }

    /// The scores that are there, by trial.
    ///
    /// # Errors
    /// As [`Store::rows`].
    pub fn scores(&self) -> Result<Vec<TrialScore>> {
        let scores = TrialScore::read(&self.connection)
            .map_err(|e| sql(&self.path, "read the results", &e))?;
        scores
            .into_iter()
            .map(|checked| {
                if checked.stored == checked.computed {
                    return Ok(checked.row);
                }
                Err(self.damaged(format!(
                    "the score of trial {} has changed",
                    checked.row.index
                )))
            })
            .collect()
    }
}
