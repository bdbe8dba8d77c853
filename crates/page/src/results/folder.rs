//! Checks of a results folder: whether its files are unchanged, and whether they may be replaced.

use std::path::Path;

use super::draft;
use super::kind::{Kind, file};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::file::{SEAL_FILE, Seal};
use realgap_store::{FolderLock, STORE_FILE};

/// Checks that the files of a finished results folder are what was written there.
///
/// # Errors
/// A file that has changed or is gone; a folder without check sums.
pub fn check_seal(folder: &Path) -> Result<()> {
    let Some(seal) = Seal::read(folder)? else {
        return Err(Error::conflict(
            "the folder has no check sums, so its files cannot be verified",
        )
        .at_file(folder)
        .found(format!("no {SEAL_FILE}"))
        .hint("run the command that writes the folder to its end")
        .advise(Advice::AcceptFiles));
    };
    // The page is made from the other files, and can be made without `page.json`.
    seal.check(folder, |name| file::PAGE.contains(&name))
}

/// Accepts the files of a results folder as they are, even if they were changed by hand.
///
/// # Errors
/// A folder without results, or one that cannot be written.
pub fn accept(folder: &Path) -> Result<()> {
    let unsealed = [file::TIMING, SEAL_FILE];
    let files = draft::files(folder)?;
    let is_ours =
        |name: &&str| !unsealed.contains(name) && Kind::ALL.iter().any(|kind| kind.has(name));
    let ours = files.iter().filter_map(|name| name.to_str());
    let seal = Seal::of(folder, ours.filter(is_ours))?;
    if seal.is_empty() {
        return Err(Error::invalid("no results here").at_file(folder));
    }
    seal.write(folder)
}

/// Checks before the work that results of this kind replace no foreign file in `folder`: a folder without results of this program
/// may hold no file with the name of a result.
///
/// # Errors
/// Such a file; a folder with the name of a result.
pub fn check_folder(folder: &Path, kind: Kind) -> Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    let entries = std::fs::read_dir(folder)
        .map_err(|e| Error::io("look into the results folder", folder, &e))?;
    for entry in entries.flatten() {
        let name = entry.file_name();
        if entry.path().is_dir() && name.to_str().is_some_and(|name| kind.has(name)) {
            return Err(
                Error::conflict("a folder stands where a result would be written")
                    .at_file(entry.path())
                    .hint("move it away")
                    .advise(Advice::OtherFolder),
            );
        }
    }
    if FolderLock::was_used(folder) || folder.join(STORE_FILE).exists() {
        return Ok(());
    }
    let files = draft::files(folder)?;
    let mut files = files.iter();
    match files.find(|name| name.to_str().is_some_and(|name| kind.has(name))) {
        None => Ok(()),
        Some(name) => Err(Error::conflict(
            "this file would be replaced, and it may not be a result of this program",
        )
        .at_file(folder.join(name))
        .hint("move it away")
        .advise(Advice::OtherFolder)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_others_is_never_replaced_where_nobody_has_written_results() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("best.ron"), "mine").unwrap();
        check_folder(folder.path(), Kind::Gap).unwrap();
        let error = check_folder(folder.path(), Kind::Study).unwrap_err();
        assert!(error.to_string().contains("best.ron"), "{error}");
        std::fs::write(folder.path().join(STORE_FILE), "").unwrap();
        check_folder(folder.path(), Kind::Study).unwrap();
        check_folder(&folder.path().join("missing"), Kind::Study).unwrap();
        std::fs::create_dir(folder.path().join("points.csv")).unwrap();
        let error = check_folder(folder.path(), Kind::Study).unwrap_err();
        assert!(error.to_string().contains("points.csv"), "{error}");
    }
}
