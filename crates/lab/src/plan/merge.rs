//! The shards of a round become part of the results.

use serde::Serialize;

use super::{Plan, Round};
use realgap_core::{Error, Result};
use realgap_store::{FolderLock, Merger, STORE_FILE, Table};

/// A shard whose rows were not taken over.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Refused {
    /// Name of its folder.
    pub shard: String,
    /// Why.
    pub why: String,
}

/// What came of merging the shards of a round.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Merged {
    /// Rows that were new.
    pub new: usize,
    /// Rows that were there already, to the bit: of merges before, or of shards that were run twice.
    pub known: usize,
    /// Shards at which somebody is at work: they were left alone.
    pub running: Vec<usize>,
    /// Shards whose rows cannot be taken: damaged, of another plan or program, or with other bits.
    pub refused: Vec<Refused>,
}

impl Plan {
    /// Takes over what the shards of the round have made. What cannot be taken is named, and the others are.
    ///
    /// # Errors
    /// Results that cannot be written, or that are not this plan's.
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
                // What cannot be written concerns all of them.
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

    /// Names of the folders of a round, in order; a copy of a shard under another name is one, too.
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

    /// The last round that a shard was begun in; 0 where none was.
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

    /// Removes the stores of the rounds before this one, whose rows are merged.
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
