//! One writer per results folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use crate::error::{Error, Result};

/// An exclusive lock on a folder, released when dropped or when the process dies.
#[derive(Debug)]
pub(super) struct FolderLock(#[expect(dead_code, reason = "holds the lock")] File);

impl FolderLock {
    /// Locks `folder`, which must exist.
    pub fn acquire(folder: &Path) -> Result<Self> {
        let path = folder.join(".lock");
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .map_err(|e| Error::io("create the lock file", &path, &e))?;
        match file.try_lock() {
            Ok(()) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => Err(Error::conflict(
                "another process is writing into this folder",
            )
            .at_file(folder)
            .hint("wait until it has finished, or choose another folder with -o")),
            Err(TryLockError::Error(e)) => Err(Error::io("lock the folder", &path, &e)),
        }
    }
}
