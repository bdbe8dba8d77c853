//! Locks a results folder, so that only one process at a time writes into it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::file_system::FileSystem;
use realgap_core::error::{Advice, Error, Result};
use realgap_core::file::check_writable;

/// The name of the lock file.
const LOCK_FILE: &str = ".lock";
/// The largest number of bytes that are read of another writer's note.
const NOTE_BYTES: u64 = 300;

/// How often a lock is tried: a process that only checks whether the lock is held also holds it for an instant.
const TRIES: usize = 5;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// An exclusive lock on a folder, released when the last clone is dropped or when the process ends. Every process that writes into a
/// results folder holds one, from before its work until its last file is written.
#[derive(Debug, Clone)]
pub struct FolderLock(Arc<Held>);

#[derive(Debug)]
struct Held {
    file: File,
    folder: PathBuf,
    file_system: FileSystem,
    /// True if the folder had a lock file before this lock, so a process has written results into it before.
    is_known: bool,
    /// True if the folder was created for this lock.
    is_new_folder: bool,
}

impl FolderLock {
    /// Locks `folder`, and creates it if it is missing. This also tests, before any work, whether results can be written there.
    ///
    /// # Errors
    /// A file in place of the folder, a folder that cannot be created or written, a folder that another process writes into: the error
    /// says which process, and since when. A file system of several computers that do not see each other's locks.
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
            .map_err(|e| Error::io("create the results folder", folder, &e))?;
        Self::acquire(folder, is_new_folder)
    }

    fn acquire(folder: &Path, is_new_folder: bool) -> Result<Self> {
        let path = folder.join(LOCK_FILE);
        let file_system = FileSystem::of(folder);
        if let Err(error) = file_system.must_lock(folder) {
            if is_new_folder {
                let _best_effort = std::fs::remove_dir(folder);
            }
            return Err(error);
        }
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
                // The previous holder may have removed the lock file meanwhile; then the lock is tried again.
                Ok(()) if !is_same(&file, &path) && tried < TRIES => {}
                Ok(()) => {
                    // The note tells other processes who holds the lock; without the note the lock still works.
                    let _unwritten = file
                        .set_len(0)
                        .and_then(|()| file.write_all(note().as_bytes()));
                    return Ok(Self(Arc::new(Held {
                        file,
                        folder: folder.to_path_buf(),
                        file_system,
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

    /// The locked folder.
    pub fn folder(&self) -> &Path {
        &self.0.folder
    }

    /// The file system of the locked folder.
    pub(super) fn file_system(&self) -> &FileSystem {
        &self.0.file_system
    }

    /// Checks that the folder still exists and can be written, so that no work is done for a folder that was removed.
    ///
    /// # Errors
    /// The folder was removed, moved or replaced, or no file can be written there any more.
    pub fn check(&self) -> Result<()> {
        let held = &*self.0;
        if !is_same(&held.file, &held.folder.join(LOCK_FILE)) {
            return Err(
                Error::conflict("the results folder was removed during the run")
                    .at_file(&held.folder)
                    .hint("the results that were stored in it are lost")
                    .advise(Advice::OtherFolder),
            );
        }
        check_writable(held.folder.join("results"))
    }

    /// True if a process had written results into this folder before this lock.
    pub(super) fn is_known(&self) -> bool {
        self.0.is_known
    }

    /// True if any process has ever written results into this folder.
    pub fn was_used(folder: &Path) -> bool {
        folder.join(LOCK_FILE).exists()
    }

    /// True if a process is writing into this folder now.
    pub fn is_held(folder: &Path) -> bool {
        let file = File::open(folder.join(LOCK_FILE));
        file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

impl Drop for Held {
    /// Releases the lock. If no file was written meanwhile, the lock file is removed, and the folder too if it was created for this lock.
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

/// True if the open file is the file at this path.
#[cfg(unix)]
fn is_same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(there)) => (open.dev(), open.ino()) == (there.dev(), there.ino()),
        _ => false,
    }
}

/// True if the open file is the file at this path.
#[cfg(not(unix))]
fn is_same(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// The place for results: a folder that will be locked, or a folder that the caller has locked already.
#[derive(Debug, Clone, Copy)]
pub enum Place<'a> {
    /// A folder that will be locked until the results are stored.
    Folder(&'a Path),
    /// A folder that the caller has locked and will continue to write into.
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

/// The note in the lock file: the process that writes, its command, and since when.
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

/// Formats seconds since 1970 as `2026-03-01 12:00:00 UTC`.
fn utc(seconds: u64) -> String {
    // The algorithm `civil_from_days` of H. Hinnant, "chrono-compatible low-level date algorithms", 2021.
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
    fn seconds_are_converted_to_calendar_dates() {
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
    fn a_second_writer_gets_an_error_that_names_the_holder_and_the_time() {
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
    fn a_folder_without_new_files_is_left_as_before_and_one_with_results_keeps_its_lock_file() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        drop(FolderLock::make(&out).unwrap());
        assert!(!out.exists());
        std::fs::create_dir(&out).unwrap();
        drop(FolderLock::make(&out).unwrap());
        assert!(out.exists() && !FolderLock::was_used(&out));
        let lock = FolderLock::make(&out).unwrap();
        std::fs::write(out.join("points.csv"), "").unwrap();
        drop(lock);
        // The note is removed, so that equal runs leave equal folders.
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
        // Releasing the lock of the moved folder does not affect the new folder.
        other.check().unwrap();
    }
}
