//! One writer per results folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::error::{Advice, Error, Result};

/// Name of the file that is locked.
const LOCK_FILE: &str = ".lock";
/// Longest note of a writer that is read back.
const NOTE_BYTES: u64 = 300;

/// An exclusive lock on a folder, released when dropped or when the process dies. Whoever writes into a results folder
/// holds one.
#[derive(Debug)]
pub struct FolderLock(#[expect(dead_code, reason = "holds the lock")] File);

impl FolderLock {
    /// Locks `folder`, which is made where it is absent: also a test, before any work, of whether it can be written.
    ///
    /// # Errors
    /// As [`FolderLock::acquire`]; a folder that cannot be made.
    pub fn make(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::io("make the results folder", folder, &e))?;
        Self::acquire(folder)
    }

    /// Locks `folder`, which must exist.
    ///
    /// # Errors
    /// A folder that cannot be written, or that another process writes into: the error says which, and since when.
    pub fn acquire(folder: &Path) -> Result<Self> {
        let path = folder.join(LOCK_FILE);
        let mut file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&path)
            .map_err(|e| Error::io("create the lock file", &path, &e))?;
        match file.try_lock() {
            Ok(()) => {
                // A note for whoever comes second; the lock holds without it.
                let _unwritten = file
                    .set_len(0)
                    .and_then(|()| file.write_all(note().as_bytes()));
                Ok(Self(file))
            }
            Err(TryLockError::WouldBlock) => {
                let error = Error::conflict("another process is writing into this folder")
                    .at_file(folder)
                    .hint("wait until it has finished")
                    .advise(Advice::OtherFolder);
                Err(match holder(&mut file) {
                    Some(holder) => error.found(holder),
                    None => error,
                })
            }
            Err(TryLockError::Error(e)) => Err(Error::io("lock the folder", &path, &e)),
        }
    }

    /// Whether anybody has ever written into this folder.
    pub(super) fn was_in(folder: &Path) -> bool {
        folder.join(LOCK_FILE).exists()
    }
}

/// Who writes, since when.
fn note() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let since = utc(now.map_or(0, |since| since.as_secs()));
    let command: Vec<String> = std::env::args_os()
        .take(3)
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    let process = std::process::id();
    format!("process {process} ({}) since {since}\n", command.join(" "))
}

/// The note of the process that holds the lock.
fn holder(file: &mut File) -> Option<String> {
    let mut note = Vec::new();
    file.take(NOTE_BYTES).read_to_end(&mut note).ok()?;
    let note = String::from_utf8_lossy(&note);
    let line: String = note.lines().next()?.escape_debug().collect();
    (!line.is_empty()).then_some(line)
}

/// Seconds since 1970 as `2026-03-01 12:00:00 UTC`.
fn utc(seconds: u64) -> String {
    // Days from civil, backwards: H. Hinnant, "chrono-compatible low-level date algorithms", 2021.
    let days = seconds / 86_400 + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (seconds / 3_600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_399, "2000-02-28 23:59:59 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_767_225_599, "2025-12-31 23:59:59 UTC"),
            (4_107_542_400, "2100-03-01 00:00:00 UTC"),
        ] {
            assert_eq!(utc(seconds), text);
        }
    }

    #[test]
    fn the_second_writer_hears_who_holds_the_folder_and_since_when() {
        let folder = tempfile::tempdir().unwrap();
        let first = FolderLock::acquire(folder.path()).unwrap();
        let second = FolderLock::acquire(folder.path()).unwrap_err().to_string();
        let process = format!("process {} (", std::process::id());
        assert!(
            second.contains(&process) && second.contains(" UTC"),
            "{second}"
        );
        drop(first);
        FolderLock::acquire(folder.path()).unwrap();
    }
}
