//! The checksum file of a results folder (its seal): SHA-256 of every file that this program wrote there, in the format of `sha256sum -c`.
//!
//! The seal is written last, so a folder without a seal is incomplete. Every read of a file in a sealed folder compares the file with its
//! checksum.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::hash::sha256;
use super::output::{remove_stale_temporaries, write_atomic};
use crate::error::{Advice, Error, Result};

/// File name of the seal.
pub const SEAL_FILE: &str = "SHA256SUMS";
/// The beginning of the first line of the seal; the checksum of all other lines follows.
const HEAD: &str = "# Written by realgap. Check: sha256sum -c SHA256SUMS. Lines: ";
/// The subfolder of a results folder whose files are also listed in the folder's seal.
const INSIDE: &str = "best";

/// The checksums of the files of a folder, by file name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Seal(BTreeMap<String, BTreeSet<String>>);

impl Seal {
    /// Reads the seal of a folder; `None` if the folder has no seal.
    ///
    /// # Errors
    /// A seal that cannot be read, or that was itself changed after it was written.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(SEAL_FILE);
        let text = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            // A path that is a file instead of a folder has no seal either.
            Err(e) if e.kind() == std::io::ErrorKind::NotADirectory => return Ok(None),
            Err(e) => return Err(Error::io("read the checksums", &path, &e)),
        };
        let Some(rest) = text.strip_prefix(HEAD) else {
            let equal = HEAD.bytes().zip(text.bytes()).filter(|(a, b)| a == b);
            let was_ours = 2 * equal.count() > HEAD.len();
            if was_ours || (!text.is_empty() && HEAD.starts_with(&text)) {
                return Err(changed(&path).found("a checksum file that was itself changed"));
            }
            // Another program has written these checksums.
            return Ok(None);
        };
        let (sum, lines) = rest.split_once('\n').unwrap_or((rest, ""));
        let mut seal = Self::default();
        let listed = lines.lines().all(|line| {
            let entry = line.split_once("  ");
            entry.is_some_and(|(sum, name)| seal.add(name, sum.to_owned()))
        });
        if !listed || sha256(lines) != sum {
            return Err(changed(&path).found("a checksum file that was itself changed"));
        }
        Ok(Some(seal))
    }

    /// Adds one more allowed checksum for the file with this name.
    fn add(&mut self, name: &str, sum: String) -> bool {
        self.0.entry(name.to_owned()).or_default().insert(sum)
    }

    /// Computes the checksums of these files of a folder.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of<'a>(folder: &Path, names: impl IntoIterator<Item = &'a str>) -> Result<Self> {
        let mut seal = Self::default();
        for name in names {
            let path = folder.join(name);
            let bytes = std::fs::read(&path).map_err(|e| Error::io("read the file", &path, &e))?;
            seal.add(name, sha256(bytes));
        }
        Ok(seal)
    }

    /// Adds the entries of another seal whose names satisfy `keeps` and that this seal does not have yet.
    pub fn keep(&mut self, other: Self, keeps: impl Fn(&str) -> bool) {
        for (name, sums) in other.0 {
            if keeps(&name) {
                self.0.entry(name).or_insert(sums);
            }
        }
    }

    /// Writes the seal into its folder.
    ///
    /// # Errors
    /// A full disk or an unwritable folder.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let mut lines = String::new();
        for (name, sums) in &self.0 {
            for sum in sums {
                lines += &format!("{sum}  {name}\n");
            }
        }
        let text = format!("{HEAD}{}\n{lines}", sha256(&lines));
        write_atomic(folder.join(SEAL_FILE), text.as_bytes())
    }

    /// True if the seal lists no file.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if the seal lists a file with this name.
    pub fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// Checks every listed file; files whose names satisfy `may_miss` are allowed to be missing.
    ///
    /// # Errors
    /// The first file that was changed after it was written, or that is missing.
    pub fn check(&self, folder: &Path, may_miss: impl Fn(&str) -> bool) -> Result<()> {
        for (name, sums) in &self.0 {
            let path = folder.join(name);
            match std::fs::read(&path) {
                Ok(bytes) if sums.contains(&sha256(&bytes)) => {}
                Ok(_) => return Err(changed(&path).found(OTHER_SUM)),
                Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                    if !may_miss(name) {
                        return Err(changed(&path).found("no such file"));
                    }
                }
                Err(e) => return Err(Error::io("read the file", &path, &e)),
            }
        }
        Ok(())
    }
}

const OTHER_SUM: &str = "another checksum: the file was changed by hand, or is damaged";

fn changed(path: &Path) -> Error {
    Error::conflict("this file is not what realgap wrote into the folder")
        .at_file(path)
        .allowed(format!("a file with its checksum in {SEAL_FILE}"))
        .hint("run the command that wrote the folder again")
        .advise(Advice::AcceptFiles)
}

/// The folder whose seal may list the file at `path`, and the file's name in this seal.
fn place(path: &Path) -> Option<(PathBuf, String)> {
    let name = path.file_name()?.to_str()?;
    let folder = match path.parent()? {
        here if here.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    if folder.file_name().is_some_and(|inside| inside == INSIDE) {
        let above = folder.parent()?;
        return Some((above.to_path_buf(), format!("{INSIDE}/{name}")));
    }
    Some((folder.to_path_buf(), name.to_owned()))
}

/// Compares the bytes read from a file with the seal of its folder, if the folder has a seal that lists the file.
///
/// # Errors
/// A file that was changed after it was written, a damaged seal.
pub(super) fn check_sealed(path: &Path, bytes: &[u8]) -> Result<()> {
    let Some((folder, name)) = place(path) else {
        return Ok(());
    };
    match Seal::read(&folder)?.and_then(|seal| seal.0.get(&name).cloned()) {
        Some(sums) if !sums.contains(&sha256(bytes)) => Err(changed(path).found(OTHER_SUM)),
        _ => Ok(()),
    }
}

/// Writes a file as [`write_atomic`] does, and writes its new checksum into the seal of its folder, if the seal lists the file already
/// or if `is_new_there` is set. If the process is killed meanwhile, the file has its old or its new content, and the seal is valid for it.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_sealed(path: &Path, bytes: &[u8], is_new_there: bool) -> Result<()> {
    remove_stale_temporaries(path);
    let sealed = match place(path) {
        // A damaged seal is left as it is.
        Some((folder, name)) => Seal::read(&folder)
            .ok()
            .flatten()
            .map(|s| (folder, name, s)),
        None => None,
    };
    let Some((folder, name, mut seal)) =
        sealed.filter(|(_, name, seal)| is_new_there || seal.has(name))
    else {
        return write_atomic(path, bytes);
    };
    let sum = sha256(bytes);
    let new = BTreeSet::from([sum.clone()]);
    if seal.0.get(&name) == Some(&new) {
        return write_atomic(path, bytes);
    }
    seal.add(&name, sum);
    seal.write(&folder)?;
    write_atomic(path, bytes)?;
    seal.0.insert(name, new);
    seal.write(&folder)
}

/// Removes a file of a results folder and its checksum.
///
/// # Errors
/// A seal that cannot be written.
pub fn remove_sealed(path: &Path) -> Result<()> {
    // The file may be missing already.
    let _none = std::fs::remove_file(path);
    let Some((folder, name)) = place(path) else {
        return Ok(());
    };
    match Seal::read(&folder) {
        Ok(Some(mut seal)) => match seal.0.remove(&name) {
            Some(_) => seal.write(&folder),
            None => Ok(()),
        },
        // A damaged seal is left as it is.
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::read_limited;

    #[test]
    fn changed_and_missing_files_are_noticed_and_unlisted_files_are_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("best")).unwrap();
        for name in ["points.csv", "best/01.ron", "mine.txt"] {
            std::fs::write(at(name), name).unwrap();
        }
        let read = |name: &str| read_limited(&at(name), 100, "file");
        let seal = Seal::of(folder.path(), ["points.csv", "best/01.ron"]).unwrap();
        seal.write(folder.path()).unwrap();
        assert_eq!(Seal::read(folder.path()).unwrap().unwrap(), seal);
        seal.check(folder.path(), |_| false).unwrap();
        for name in ["points.csv", "best/01.ron"] {
            read(name).unwrap();
            std::fs::write(at(name), "other").unwrap();
            let error = read(name).unwrap_err().to_string();
            assert!(error.contains("not what realgap wrote"), "{error}");
            assert!(seal.check(folder.path(), |_| true).is_err());
            // A file that this program writes gets its new checksum in the seal.
            write_sealed(&at(name), b"new", false).unwrap();
            read(name).unwrap();
        }
        std::fs::write(at("mine.txt"), "other").unwrap();
        read("mine.txt").unwrap();
        write_sealed(&at("mine.txt"), b"new", false).unwrap();
        let seal = Seal::read(folder.path()).unwrap().unwrap();
        assert!(!seal.has("mine.txt"));
        std::fs::remove_file(at("points.csv")).unwrap();
        assert!(seal.check(folder.path(), |_| false).is_err());
        seal.check(folder.path(), |name| name == "points.csv")
            .unwrap();
        // The seal itself is damaged: a changed digit, a lost line.
        let text = std::fs::read_to_string(at(SEAL_FILE)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for changed in [text.replacen('a', "b", 99), lines[..2].join("\n") + "\n"] {
            std::fs::write(at(SEAL_FILE), changed).unwrap();
            assert!(read("best/01.ron").is_err());
        }
        std::fs::write(at(SEAL_FILE), "sums of somebody else").unwrap();
        read("best/01.ron").unwrap();
    }
}
