//! The seal of a results folder: check sums of the files that this program wrote there, in the form that `sha256sum -c` reads.
//!
//! It is written last, so a folder without one is not whole. Whoever reads a file of a sealed folder compares it with its sum.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::hash::sha256;
use super::output::{sweep, write_atomic};
use crate::error::{Advice, Error, Result};

/// Name of the file.
pub const SEAL_FILE: &str = "SHA256SUMS";
/// What its first line begins with; the sum of all other lines follows.
const HEAD: &str = "# Written by realgap. Check: sha256sum -c SHA256SUMS. Lines: ";
/// Folders inside of a results folder whose files are in its seal.
const INSIDE: &str = "best";

/// Check sums of files by their names, in a folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Seal(BTreeMap<String, BTreeSet<String>>);

impl Seal {
    /// The seal of a folder; nothing where there is none.
    ///
    /// # Errors
    /// One that cannot be read, or is itself not what was written.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(SEAL_FILE);
        let text = match std::fs::read(&path) {
            Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            // A file in place of the folder has no seal, either.
            Err(e) if e.kind() == std::io::ErrorKind::NotADirectory => return Ok(None),
            Err(e) => return Err(Error::io("read the check sums", &path, &e)),
        };
        let Some(rest) = text.strip_prefix(HEAD) else {
            let alike = HEAD.bytes().zip(text.bytes()).filter(|(a, b)| a == b);
            let was_ours = 2 * alike.count() > HEAD.len();
            if was_ours || (!text.is_empty() && HEAD.starts_with(&text)) {
                return Err(changed(&path).found("check sums that have changed themselves"));
            }
            // Somebody else's check sums.
            return Ok(None);
        };
        let (sum, lines) = rest.split_once('\n').unwrap_or((rest, ""));
        let mut seal = Self::default();
        let listed = lines.lines().all(|line| {
            let entry = line.split_once("  ");
            entry.is_some_and(|(sum, name)| seal.add(name, sum.to_owned()))
        });
        if !listed || sha256(lines) != sum {
            return Err(changed(&path).found("check sums that have changed themselves"));
        }
        Ok(Some(seal))
    }

    /// Adds a file with one more sum that it may have.
    fn add(&mut self, name: &str, sum: String) -> bool {
        self.0.entry(name.to_owned()).or_default().insert(sum)
    }

    /// The seal of these files of a folder.
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

    /// Takes over of another seal the files that `keeps`.
    pub fn keep(&mut self, other: Self, keeps: impl Fn(&str) -> bool) {
        for (name, sums) in other.0 {
            if keeps(&name) {
                self.0.entry(name).or_insert(sums);
            }
        }
    }

    /// Writes it into its folder.
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

    /// Whether it has no file.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether it has a file of this name.
    pub fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    /// Checks every file, but for those that `may_miss` where they are not there.
    ///
    /// # Errors
    /// The first that is not what was written, or is gone.
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

const OTHER_SUM: &str = "another check sum: changed by hand, or damaged";

fn changed(path: &Path) -> Error {
    Error::conflict("this is not what realgap wrote into the folder")
        .at_file(path)
        .allowed(format!("what {SEAL_FILE} says"))
        .hint("run the command that wrote the folder again")
        .advise(Advice::AcceptFiles)
}

/// The sealed folder that a file may be in, and its name there.
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

/// Compares what was read of a file with the seal of its folder, where that has both.
///
/// # Errors
/// A file that is not what was written there, a damaged seal.
pub(super) fn check_sealed(path: &Path, bytes: &[u8]) -> Result<()> {
    let Some((folder, name)) = place(path) else {
        return Ok(());
    };
    match Seal::read(&folder)?.and_then(|seal| seal.0.get(&name).cloned()) {
        Some(sums) if !sums.contains(&sha256(bytes)) => Err(changed(path).found(OTHER_SUM)),
        _ => Ok(()),
    }
}

/// Writes a file as [`write_atomic`] does, and its new check sum into the seal of its folder where that has the file already, or
/// where `is_new_there`. Whoever is killed on the way leaves the file old or new, and the folder sealed.
///
/// # Errors
/// A full disk or an unwritable folder.
pub fn write_sealed(path: &Path, bytes: &[u8], is_new_there: bool) -> Result<()> {
    sweep(path);
    let sealed = match place(path) {
        // Damaged check sums stay as they are.
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

/// Removes a file of a results folder, and its check sum.
///
/// # Errors
/// A seal that cannot be written.
pub fn remove_sealed(path: &Path) -> Result<()> {
    // There may be none.
    let _none = std::fs::remove_file(path);
    let Some((folder, name)) = place(path) else {
        return Ok(());
    };
    match Seal::read(&folder) {
        Ok(Some(mut seal)) => match seal.0.remove(&name) {
            Some(_) => seal.write(&folder),
            None => Ok(()),
        },
        // Damaged check sums stay as they are.
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::read_limited;

    #[test]
    fn what_was_changed_lost_or_unlisted_is_noticed_by_whoever_reads_it() {
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
            // What this program writes is sealed again.
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
        // The sums themselves: a changed digit, a lost line.
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
