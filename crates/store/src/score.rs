//! Stores the scores of trials in a table of their own, because a basis that is fitted later changes the scores.

use super::connection::sql;
use super::database::Store;
use super::trial::{Trial, TrialScore};
use realgap_core::error::Result;

impl Store<Trial> {
    /// All trials, sorted by index.
    ///
    /// # Errors
    /// The same as of [`Store::rows`].
    pub fn trials(&self) -> Result<Vec<Trial>> {
        self.rows()
    }

    /// Stores the scores of trials; older scores of the same trials are replaced.
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

    /// The stored scores, sorted by trial.
    ///
    /// # Errors
    /// The same as of [`Store::rows`].
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
