//! The kind of file system that a folder is on: whether other computers write into it, too.
//!
//! SQLite's write-ahead log needs memory that all its processes share, and the lock of a folder needs a file system that shows it to all of
//! them. A disk of this computer has both. A network file system does not have the first
//! (<https://www.sqlite.org/wal.html>), and some do not have the second.

use std::path::Path;

use realgap_core::error::{Advice, Error, Result};

/// Where Linux lists what is mounted: <https://man7.org/linux/man-pages/man5/proc_pid_mountinfo.5.html>.
const MOUNTS: &str = "/proc/self/mountinfo";

/// File systems that several computers use, or a computer and its virtual machines, and that show locks to all of them.
const SHARED: &[&str] = &[
    "9p",
    "afs",
    "beegfs",
    "beegfs_nodev",
    "ceph",
    "cifs",
    "drvfs",
    "fakeowner",
    "fuse.ceph",
    "fuse.ceph-fuse",
    "fuse.glusterfs",
    "fuse.grpcfuse",
    "fuse.juicefs",
    "fuse.mfs",
    "fuse.quobyte",
    "fuse.vmhgfs-fuse",
    "gfs2",
    "gpfs",
    "lustre",
    "ncpfs",
    "nfs",
    "nfs4",
    "ocfs2",
    "orangefs",
    "panfs",
    "prl_fs",
    "pvfs2",
    "smb2",
    "smb3",
    "smbfs",
    "vboxsf",
    "virtiofs",
    "vmhgfs",
    "wekafs",
];

/// File systems of other computers whose locks only this computer sees, or whose files cannot be changed in place.
const WITHOUT_LOCKS: &[&str] = &[
    "coda",
    "davfs",
    "fuse.blobfuse",
    "fuse.blobfuse2",
    "fuse.curlftpfs",
    "fuse.davfs2",
    "fuse.gcsfuse",
    "fuse.google-drive-ocamlfuse",
    "fuse.goofys",
    "fuse.gvfsd-fuse",
    "fuse.mount-s3",
    "fuse.mountpoint-s3",
    "fuse.onedriver",
    "fuse.rclone",
    "fuse.s3fs",
    "fuse.sshfs",
];

/// The kind of file system that a folder is on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum FileSystem {
    /// Of this computer, as far as is known.
    Own,
    /// Other computers use it, too, and all see its locks; its type.
    Shared(String),
    /// Other computers use it, too, and do not see the locks; its type.
    WithoutLocks(String),
}

impl FileSystem {
    /// The file system of an existing folder. Only Linux says it; elsewhere it counts as one of this computer.
    pub fn of(folder: &Path) -> Self {
        #[cfg(test)]
        if let Some(faked) = tests::faked() {
            return faked;
        }
        let whole = std::fs::canonicalize(folder);
        match (std::fs::read_to_string(MOUNTS), whole) {
            (Ok(mounts), Ok(whole)) => Self::among(&mounts, &whole),
            _ => Self::Own,
        }
    }

    /// The file system of an absolute path among those that are mounted: the last one at the longest beginning of the path.
    fn among(mounts: &str, path: &Path) -> Self {
        let found = mounts
            .lines()
            .filter_map(mounted)
            .filter(|(point, _)| path.starts_with(point))
            .max_by_key(|(point, _)| Path::new(point).components().count());
        match found {
            Some((_, kind)) if SHARED.contains(&kind) => Self::Shared(kind.to_owned()),
            Some((_, kind)) if WITHOUT_LOCKS.contains(&kind) => Self::WithoutLocks(kind.to_owned()),
            _ => Self::Own,
        }
    }

    /// Checks that a lock in this folder keeps other computers from writing.
    ///
    /// # Errors
    /// A file system whose locks other computers do not see.
    pub fn must_lock(&self, folder: &Path) -> Result<()> {
        match self {
            Self::WithoutLocks(kind) => Err(Error::conflict(
                "results cannot be kept on this file system: other computers do not see who writes",
            )
            .at_file(folder)
            .found(kind)
            .allowed("a disk of this computer, or NFS, SMB, Lustre, GPFS, ...")
            .hint("write into a folder on a disk of this computer, and copy that folder here when the run has ended")
            .advise(Advice::OtherFolder)),
            _ => Ok(()),
        }
    }

    /// Checks that a store with a write-ahead log may be used here.
    ///
    /// # Errors
    /// A file system of several computers.
    pub fn must_share_memory(&self, store: &Path) -> Result<()> {
        match self {
            Self::Own => Ok(()),
            Self::Shared(kind) | Self::WithoutLocks(kind) => Err(Error::conflict(
                "the run was interrupted, and the log with its last results cannot be used on a network file system",
            )
            .at_file(store)
            .found(kind)
            .hint("copy the whole folder to a disk of this computer, and read or resume it there")),
        }
    }
}

/// The place and the type of a mounted file system, from a line of the list.
fn mounted(line: &str) -> Option<(String, &str)> {
    let (before, after) = line.split_once(" - ")?;
    let point = before.split(' ').nth(4)?;
    Some((unescaped(point), after.split(' ').next()?))
}

/// A path in which white space and backslashes stand as a backslash with three octal digits.
fn unescaped(point: &str) -> String {
    let mut parts = point.split('\\');
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let code = part
            .get(..3)
            .and_then(|code| u8::from_str_radix(code, 8).ok());
        match code {
            Some(code) => {
                whole.push(char::from(code));
                whole.push_str(&part[3..]);
            }
            None => {
                whole.push('\\');
                whole.push_str(part);
            }
        }
    }
    whole
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::cell::RefCell;

    thread_local! {
        static FAKED: RefCell<Option<FileSystem>> = const { RefCell::new(None) };
    }

    /// The answer that this test gives instead of the list of mounted file systems.
    pub(super) fn faked() -> Option<FileSystem> {
        FAKED.with_borrow(Clone::clone)
    }

    /// Makes every folder one on this file system, for this test only.
    pub(crate) fn fake(answer: FileSystem) {
        FAKED.set(Some(answer));
    }

    const LIST: &str = "\
22 1 254:1 / / rw,relatime shared:1 - ext4 /dev/root rw
31 22 0:27 / /home rw,relatime shared:2 - nfs4 server:/home rw,vers=4.2,local_lock=none
32 31 0:28 / /home/me/scratch rw - ext4 /dev/sdb1 rw
33 22 0:29 / /mnt/team\\040disk rw - cifs //server/team rw
34 22 0:30 / /mnt/far rw - fuse.sshfs me@far: rw
35 22 0:31 / /over rw - ext4 /dev/sdc1 rw
36 35 0:32 / /over rw - lustre mds:/work rw
37 22 0:33 / /homework rw - btrfs /dev/sdd1 rw
a line of a later version
";

    #[test]
    fn the_last_mount_at_the_longest_beginning_of_a_path_decides() {
        let shared = |kind: &str| FileSystem::Shared(kind.to_owned());
        for (path, expected) in [
            ("/tmp/out", FileSystem::Own),
            ("/home/me/out", shared("nfs4")),
            ("/home/me/scratch/out", FileSystem::Own),
            ("/mnt/team disk/out", shared("cifs")),
            (
                "/mnt/far/out",
                FileSystem::WithoutLocks("fuse.sshfs".to_owned()),
            ),
            ("/over/out", shared("lustre")),
            ("/homework/out", FileSystem::Own),
        ] {
            assert_eq!(FileSystem::among(LIST, Path::new(path)), expected, "{path}");
        }
    }

    #[test]
    fn the_list_of_this_computer_is_understood() {
        let Ok(mounts) = std::fs::read_to_string(MOUNTS) else {
            println!("SKIPPED: this system has no {MOUNTS}");
            return;
        };
        let points: Vec<String> = mounts
            .lines()
            .map(|line| {
                mounted(line)
                    .expect("every line names a place and a type")
                    .0
            })
            .collect();
        assert!(points.iter().any(|point| point == "/"), "{points:?}");
    }
}
