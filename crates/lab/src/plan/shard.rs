//! The progress of a round's shards.

use std::path::Path;

use serde::Serialize;

use super::{Cost, Plan, Round};
use realgap_core::Result;
use realgap_store::{FolderLock, RobotRow, RunRow, STORE_FILE, Store, Table, Trial};

realgap_core::labelled_enum! {
    /// State of a shard.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
    #[serde(rename_all = "snake_case")]
    ShardState.name;
    /// The round has no rows for it.
    Idle "idle";
    /// Its rows are merged.
    Merged "merged";
    /// All of its rows are simulated, but not merged yet.
    Done "done";
    /// A worker is simulating its rows.
    Running "running";
    /// It was begun, but no worker is simulating its rows.
    Stopped "stopped";
    /// Not begun.
    Waiting "waiting";
    /// Its store cannot be read.
    Damaged "DAMAGED";
}

impl ShardState {
    /// Whether its rows still have to be simulated.
    pub(crate) fn is_pending(self) -> bool {
        matches!(
            self,
            Self::Running | Self::Stopped | Self::Waiting | Self::Damaged
        )
    }
}

/// One shard in a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shard {
    /// Its number, from 0.
    pub shard: usize,
    /// State of the shard.
    pub state: ShardState,
    /// Rows that are simulated.
    pub done: usize,
    /// Rows of this round that belong to it.
    pub rows: usize,
}

/// Progress of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Status {
    /// Name of the study or search.
    pub name: String,
    /// The command.
    pub command: String,
    /// The current round.
    pub round: Round,
    /// Rows that are merged, of all rounds.
    pub merged: usize,
    /// Whether the answer is written, too.
    pub answered: bool,
    /// Estimated cost, where runs were measured.
    pub cost: Option<Cost>,
    /// The shards.
    pub shards: Vec<Shard>,
}

impl Status {
    /// Numbers of the shards that have to be run, in the form of Slurm's arrays: `0-3,7`. Empty where all shards are done.
    pub fn pending(&self) -> String {
        let pending = self.shards.iter().filter(|shard| shard.state.is_pending());
        ranges(&pending.map(|shard| shard.shard).collect::<Vec<_>>())
    }
}

/// Numbers in order; consecutive ones are written as `FIRST-LAST`.
pub(super) fn ranges(numbers: &[usize]) -> String {
    let mut parts: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match parts.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => parts.push((number, number)),
        }
    }
    let parts: Vec<String> = parts
        .into_iter()
        .map(|(first, last)| match last - first {
            0 => first.to_string(),
            _ => format!("{first}-{last}"),
        })
        .collect();
    parts.join(",")
}

/// Number of rows in a store, and whether its run was completed.
fn rows_in<R: Table>(folder: &Path) -> Result<(usize, bool)> {
    let store = Store::<R>::look(folder)?;
    Ok((store.finished()?.len(), store.is_complete()?))
}

impl Plan {
    /// The progress of the current round's shards. Nothing is verified, so this is quick.
    ///
    /// # Errors
    /// A plan whose round cannot be read.
    pub fn status(&self) -> Result<Status> {
        let round = self.round()?;
        let results = self.store();
        let count = match self.draft().command.first().map(String::as_str) {
            Some("search") => rows_in::<RobotRow>,
            Some("ensemble" | "gap") => rows_in::<RunRow>,
            _ => rows_in::<Trial>,
        };
        let there = results.join(STORE_FILE).exists();
        let (merged, is_complete) = match there {
            false => (0, false),
            // A merge that has just begun has no tables yet.
            true => match count(&results) {
                Err(_) if FolderLock::is_held(&results) => (0, false),
                counted => counted?,
            },
        };
        let answered = match self.answer_file() {
            None => is_complete,
            Some(file) => round.complete && self.results().join(file).exists(),
        };
        let whole = round.complete || round.merged == round.to - round.from;
        let shards = round
            .rows_of_each(self.draft().shards)
            .into_iter()
            .enumerate()
            .map(|(shard, rows)| {
                let folder = self.shard_folder(round.number, shard);
                let is_begun = folder.join(STORE_FILE).exists();
                let counted = is_begun.then(|| count(&folder));
                let (done, is_complete, is_damaged) = match counted {
                    Some(Ok((done, is_complete))) => (done, is_complete, false),
                    // The worker was killed before the store had a table.
                    Some(Err(_)) if FolderLock::is_held(&folder) => (0, false, false),
                    Some(Err(_)) => (0, false, true),
                    None => (0, false, false),
                };
                let state = if rows == 0 {
                    ShardState::Idle
                } else if whole {
                    ShardState::Merged
                } else if is_damaged {
                    ShardState::Damaged
                } else if FolderLock::is_held(&folder) {
                    ShardState::Running
                } else if is_complete {
                    ShardState::Done
                } else if is_begun {
                    ShardState::Stopped
                } else {
                    ShardState::Waiting
                };
                Shard {
                    shard,
                    state,
                    done,
                    rows,
                }
            })
            .collect();
        Ok(Status {
            name: self.draft().name.clone(),
            command: self.draft().command.join(" "),
            round,
            merged,
            answered,
            cost: self.draft().cost,
            shards,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_arrays_of_jobs() {
        assert_eq!(ranges(&[0, 1, 2, 3, 7, 9, 10]), "0-3,7,9-10");
        assert_eq!(ranges(&[]), "");
    }
}
