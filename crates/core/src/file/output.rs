//! Writes a file atomically: readers see either the old content or the new content, never a part of it.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};

/// Writes `bytes` into a temporary file beside `path`, flushes it to the disk and renames it to `path`.
///
/// # Errors
/// An unwritable folder or a full disk; the file at `path` is then unchanged.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    write_whole(path, bytes).map_err(|e| Error::io("write the file", path, &e))
}

/// Checks whether [`write_atomic`] can write to `path`, so that the result of a long computation is not lost because of a mistyped path.
/// The file is neither created nor changed.
///
/// # Errors
/// A missing or unwritable folder, or a path that is itself a folder. Pipes and devices are not tried, because the reader of a
/// pipe sees its end as soon as the pipe is opened and closed.
pub fn check_writable(path: impl AsRef<Path>) -> Result<()> {
    let path = path.as_ref();
    match target_of(path) {
        Target::Folder => Err(Error::invalid("cannot write the file: this is a folder")
            .at_file(path)
            .hint("name a file inside it")),
        Target::Stream => Ok(()),
        Target::File(resolved) => {
            let temporary = temporary_beside(&resolved);
            fs::File::create_new(&temporary)
                .and_then(|_file| fs::remove_file(&temporary))
                .map_err(|e| Error::io("write the file", path, &e))
        }
    }
}

/// The kind of object to which a path leads.
enum Target {
    /// A file, existing or not, with all symbolic links resolved.
    File(PathBuf),
    /// A pipe, a device or a process's own stream, which cannot be replaced by a file.
    Stream,
    /// An existing folder.
    Folder,
}

fn target_of(path: &Path) -> Target {
    // A symbolic link is kept: the file to which it points is written.
    let is_link = fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink());
    let resolved = if is_link {
        fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
    } else {
        path.to_path_buf()
    };
    // `/dev/shm` is a disk in memory.
    let is_stream = ["/dev", "/proc"]
        .iter()
        .any(|folder| path.starts_with(folder))
        && !path.starts_with("/dev/shm");
    match fs::metadata(&resolved) {
        Ok(metadata) if metadata.is_dir() => Target::Folder,
        Ok(metadata) if !metadata.is_file() => Target::Stream,
        _ if is_stream => Target::Stream,
        _ => Target::File(resolved),
    }
}

fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let Target::File(path) = target_of(path) else {
        return fs::OpenOptions::new()
            .write(true)
            .open(path)?
            .write_all(bytes);
    };
    let path = path.as_path();
    let temporary = temporary_beside(path);
    let written = fs::File::create_new(&temporary)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // An error of this removal is ignored, because the caller needs the first error.
        let _ignored = fs::remove_file(&temporary);
    }
    written
}

/// Removes temporary files that killed processes left when they wrote this file. Errors are ignored; files of running processes stay,
/// where the system lists running processes in `/proc`.
pub(super) fn remove_stale_temporaries(path: &Path) {
    let (Some(name), Some(folder)) = (path.file_name(), path.parent()) else {
        return;
    };
    let start = format!(".{}.", name.to_string_lossy());
    let alive = |process: &str| {
        !Path::new("/proc/self").exists() || Path::new("/proc").join(process).exists()
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let left = entry.file_name().to_string_lossy().into_owned();
        let process = left
            .strip_prefix(&start)
            .and_then(|rest| rest.strip_suffix(".tmp")?.split('-').next());
        if process.is_some_and(|process| process.parse::<u32>().is_ok() && !alive(process)) {
            let _gone = fs::remove_file(entry.path());
        }
    }
}

fn temporary_beside(path: &Path) -> PathBuf {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let count = COUNTER.fetch_add(1, Ordering::Relaxed);
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    path.with_file_name(format!(".{name}.{}-{count}.tmp", std::process::id()))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_symbolic_link_is_kept_and_its_target_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_atomic(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }

    #[test]
    fn a_disk_in_memory_takes_files() {
        let Ok(folder) = tempfile::tempdir_in("/dev/shm") else {
            println!("SKIPPED: there is no /dev/shm that can be written");
            return;
        };
        let file = folder.path().join("file");
        check_writable(&file).unwrap();
        write_atomic(&file, b"new").unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }

    #[test]
    fn checking_a_path_leaves_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        check_writable(&file).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&file, "old").unwrap();
        check_writable(&file).unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "old");
        let message = |path: &Path| check_writable(path).unwrap_err().to_string();
        assert!(message(folder.path()).contains("this is a folder"));
        assert!(message(&folder.path().join("missing/file")).contains("check the path"));
        check_writable("/dev/null").unwrap();
    }
}
