//! One writer per results folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use realgap_core::error::{Advice, Error, Result};
use realgap_core::file::check_writable;

/// Name of the file that is locked.
const LOCK_FILE: &str = ".lock";
/// Longest note of a writer that is read back.
const NOTE_BYTES: u64 = 300;

/// How often a lock is tried: whoever only looks whether it is held, holds it for an instant.
const TRIES: usize = 5;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// An exclusive lock on a folder, released when the last clone is dropped or when the process dies. Whoever writes into a results
/// folder holds one, from before the work until the last file is written.
#[derive(Debug, Clone)]
pub struct FolderLock(Arc<Held>);

#[derive(Debug)]
struct Held {
    file: File,
    folder: PathBuf,
    /// Whether somebody had written into this folder before.
    is_known: bool,
    /// Whether the folder was made for this lock.
    is_new_folder: bool,
}

impl FolderLock {
    /// Locks `folder`, which is made where it is absent: also a test, before any work, of whether it can be written.
    ///
    /// # Errors
    /// A file in its place, a folder that cannot be made or written, or that another process writes into: the error says which, and since when.
    pub fn make(folder: &Path) -> Result<Self> {
        if folder.exists() && !folder.is_dir() {
            return Err(Error::usage("results need a folder")
                .at_file(folder)
                .found("a file")
                .allowed("a folder, or a name that is still free")
                .advise(Advice::OtherFolder));
        }
        let is_new_folder = !folder.exists();
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::io("make the results folder", folder, &e))?;
        Self::acquire(folder, is_new_folder)
    }

    fn acquire(folder: &Path, is_new_folder: bool) -> Result<Self> {
        let path = folder.join(LOCK_FILE);
        let mut tried = 0;
        loop {
            tried += 1;
            let is_known = path.exists();
            let mut file = OpenOptions::new()
                .create(true)
                .truncate(false)
                .read(true)
                .write(true)
                .open(&path)
                .map_err(|e| Error::io("create the lock file", &path, &e))?;
            match file.try_lock() {
                // Whoever held it before may have removed it meanwhile.
                Ok(()) if !is_same(&file, &path) && tried < TRIES => {}
                Ok(()) => {
                    // A note for whoever comes second; the lock holds without it.
                    let _unwritten = file
                        .set_len(0)
                        .and_then(|()| file.write_all(note().as_bytes()));
                    return Ok(Self(Arc::new(Held {
                        file,
                        folder: folder.to_path_buf(),
                        is_known,
                        is_new_folder,
                    })));
                }
                Err(TryLockError::WouldBlock) if tried < TRIES => std::thread::sleep(BETWEEN_TRIES),
                Err(TryLockError::WouldBlock) => {
                    let error = Error::conflict("another process is writing into this folder")
                        .at_file(folder)
                        .hint("wait until it has finished")
                        .advise(Advice::OtherFolder);
                    return Err(match holder(&mut file) {
                        Some(holder) => error.found(holder),
                        None => error,
                    });
                }
                Err(TryLockError::Error(e)) => {
                    return Err(Error::io("lock the folder", &path, &e));
                }
            }
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.0.folder
    }

    /// Whether the folder is still there and can be written: an hour of work for a folder that is gone is an hour lost.
    ///
    /// # Errors
    /// The folder was removed, moved or replaced, or nothing can be written there any more.
    pub fn check(&self) -> Result<()> {
        let held = &*self.0;
        if !is_same(&held.file, &held.folder.join(LOCK_FILE)) {
            return Err(
                Error::conflict("the results folder was removed during the run")
                    .at_file(&held.folder)
                    .hint("what was stored in it is gone")
                    .advise(Advice::OtherFolder),
            );
        }
        check_writable(held.folder.join("results"))
    }

    /// Whether anybody had written into this folder before.
    pub(super) fn is_known(&self) -> bool {
        self.0.is_known
    }

    /// Whether anybody has ever written into this folder.
    pub fn was_in(folder: &Path) -> bool {
        folder.join(LOCK_FILE).exists()
    }

    /// Whether anybody is writing into this folder now.
    pub fn is_held(folder: &Path) -> bool {
        let file = File::open(folder.join(LOCK_FILE));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

impl Drop for Held {
    /// Nobody holds the folder any more; where nothing came of it, it is as if nobody had.
    fn drop(&mut self) {
        let _best_effort = self.file.set_len(0);
        let path = self.folder.join(LOCK_FILE);
        if self.is_known || !is_same(&self.file, &path) {
            return;
        }
        let entries = std::fs::read_dir(&self.folder).map_or(0, Iterator::count);
        if entries == 1 && std::fs::remove_file(&path).is_ok() && self.is_new_folder {
            let _best_effort = std::fs::remove_dir(&self.folder);
        }
    }
}

/// Whether the open file is the one at this path.
#[cfg(unix)]
fn is_same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(there)) => (open.dev(), open.ino()) == (there.dev(), there.ino()),
        _ => false,
    }
}

/// Whether the open file is the one at this path.
#[cfg(not(unix))]
fn is_same(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// Where results go: a folder that is locked for them, or one that the caller has locked already.
#[derive(Debug, Clone, Copy)]
pub enum Place<'a> {
    /// To be locked until the results are stored.
    Folder(&'a Path),
    /// Locked by the caller, who goes on writing there.
    Locked(&'a FolderLock),
}

impl Place<'_> {
    /// The folder.
    pub fn folder(&self) -> &Path {
        match self {
            Self::Folder(folder) => folder,
            Self::Locked(lock) => lock.folder(),
        }
    }

    pub(super) fn lock(self) -> Result<FolderLock> {
        match self {
            Self::Folder(folder) => FolderLock::make(folder),
            Self::Locked(lock) => Ok(lock.clone()),
        }
    }
}

impl<'a> From<&'a Path> for Place<'a> {
    fn from(folder: &'a Path) -> Self {
        Self::Folder(folder)
    }
}

impl<'a> From<&'a PathBuf> for Place<'a> {
    fn from(folder: &'a PathBuf) -> Self {
        Self::Folder(folder)
    }
}

impl<'a> From<&'a FolderLock> for Place<'a> {
    fn from(lock: &'a FolderLock) -> Self {
        Self::Locked(lock)
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
        let first = FolderLock::make(folder.path()).unwrap();
        let clone = first.clone();
        drop(first);
        let second = FolderLock::make(folder.path()).unwrap_err().to_string();
        let process = format!("process {} (", std::process::id());
        assert!(
            second.contains(&process) && second.contains(" UTC"),
            "{second}"
        );
        assert!(FolderLock::is_held(folder.path()));
        drop(clone);
        assert!(!FolderLock::is_held(folder.path()));
        FolderLock::make(folder.path()).unwrap();
    }

    #[test]
    fn a_folder_that_nothing_was_written_into_is_as_before_and_one_with_results_keeps_its_mark() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        drop(FolderLock::make(&out).unwrap());
        assert!(!out.exists());
        std::fs::create_dir(&out).unwrap();
        drop(FolderLock::make(&out).unwrap());
        assert!(out.exists() && !FolderLock::was_in(&out));
        let lock = FolderLock::make(&out).unwrap();
        std::fs::write(out.join("points.csv"), "").unwrap();
        drop(lock);
        // The note is gone, so that equal runs leave equal folders.
        assert_eq!(std::fs::read(out.join(LOCK_FILE)).unwrap(), b"");
        assert!(FolderLock::make(&out).unwrap().is_known());
    }

    #[test]
    fn a_folder_that_is_removed_moved_or_replaced_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let lock = FolderLock::make(&out).unwrap();
        lock.check().unwrap();
        std::fs::rename(&out, folder.path().join("moved")).unwrap();
        let error = lock.check().unwrap_err().to_string();
        assert!(error.contains("removed during the run"), "{error}");
        let other = FolderLock::make(&out).unwrap();
        assert!(lock.check().is_err());
        other.check().unwrap();
        drop(lock);
        // What was replaced is nobody's business any more.
        other.check().unwrap();
    }
}
