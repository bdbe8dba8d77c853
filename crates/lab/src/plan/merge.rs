//! Merging: the rows of a round's shards are added to the results.

use serde::Serialize;

use super::{Plan, Round};
use realgap_core::{Error, Result};
use realgap_store::{FolderLock, Merger, STORE_FILE, Table};

/// A shard whose rows were not added.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Refused {
    /// Name of its folder.
    pub shard: String,
    /// Reason of the refusal.
    pub why: String,
}

/// The result of merging the shards of a round.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Merged {
    /// Rows that were added.
    pub new: usize,
    /// Rows that were there already with the same bits: from earlier merges, or from shards that were run twice.
    pub known: usize,
    /// Shards that a worker is simulating at the moment; they were left alone.
    pub running: Vec<usize>,
    /// Shards whose rows cannot be added: damaged, of another plan or program, or with other bits.
    pub refused: Vec<Refused>,
}

impl Plan {
    /// Adds the rows of the round's shards. A shard that cannot be added is named, and all others are added.
    ///
    /// # Errors
    /// Results that cannot be written, or that are not results of this plan.
    pub(super) fn absorb<R: Table>(&self, round: &Round) -> Result<Merged> {
        let lock = FolderLock::make(&self.store())?;
        let mut merger: Merger<R> = Merger::open(&lock, &self.fingerprint())?;
        let mut merged = Merged::default();
        for name in self.shards_there(round)? {
            let folder = self.round_folder(round.number).join(&name);
            let number: Option<usize> = name
                .strip_prefix("shard_")
                .and_then(|number| number.parse().ok());
            if FolderLock::is_held(&folder) {
                merged.running.extend(number);
                continue;
            }
            if !folder.join(STORE_FILE).exists() {
                continue;
            }
            match merger.absorb(&folder) {
                Ok(absorbed) => {
                    merged.new += absorbed.new;
                    merged.known += absorbed.known;
                }
                // An error in writing concerns all shards.
                Err(error)
                    if error
                        .file()
                        .is_some_and(|file| file.starts_with(lock.folder())) =>
                {
                    return Err(error);
                }
                Err(error) => merged.refused.push(Refused {
                    shard: name,
                    why: error.to_string(),
                }),
            }
        }
        Ok(merged)
    }

    /// Names of the folders of a round, in order; a copy of a shard under another name counts as one, too.
    fn shards_there(&self, round: &Round) -> Result<Vec<String>> {
        let folder = self.round_folder(round.number);
        if !folder.exists() {
            return Ok(Vec::new());
        }
        let entries = std::fs::read_dir(&folder)
            .map_err(|e| Error::io("look into the folder of the shards", &folder, &e))?;
        let mut names: Vec<String> = entries
            .flatten()
            .filter(|entry| entry.path().is_dir())
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        names.sort();
        Ok(names)
    }

    /// The last round in which a shard was begun; 0 where there is none.
    pub(super) fn last_round(&self) -> usize {
        let shards = self.folder().join("shards");
        let entries = std::fs::read_dir(shards).into_iter().flatten().flatten();
        entries
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                name.strip_prefix("round_")?.parse().ok()
            })
            .max()
            .unwrap_or(0)
    }

    /// Removes the stores of earlier rounds, whose rows are merged.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn tidy(&self, round: &Round) -> Result<()> {
        let end = round.number + usize::from(round.complete);
        for number in 0..end {
            let folder = self.round_folder(number);
            match std::fs::remove_dir_all(&folder) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::io("remove merged shards", &folder, &e));
                }
                _ => {}
            }
        }
        Ok(())
    }
}
