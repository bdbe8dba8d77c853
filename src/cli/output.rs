//! Writes the file that a command produces. A file that realgap did not write is replaced with `--force` only.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use realgap::file::{check_writable, write_sealed};
use realgap::{Error, Result};

/// Set by `--force`.
static FORCE: AtomicBool = AtomicBool::new(false);
/// Texts near the beginning of files that this program wrote.
const MARKS: [&str; 9] = [
    "Written by realgap",
    // In a PNG.
    "Software\0realgap",
    "exported by realgap",
    "content=\"realgap",
    "\"generator\":\"realgap",
    "(realgap study identify)",
    "\"schema_version\"",
    // In the comments of a robot's file.
    "<!-- realgap: ",
    // In a JSON Schema.
    "\"title\": \"realgap ",
];
/// Number of bytes of a file that are searched for these texts.
const LOOKED_AT: u64 = 16_384;
/// First bytes of an MCAP file; the name of the program that wrote it follows.
const MCAP: &[u8] = b"\x89MCAP0\r\n";

/// From now on, existing files are replaced.
pub fn force() {
    FORCE.store(true, Ordering::Relaxed);
}

/// Whether `--force` was given.
pub fn is_forced() -> bool {
    FORCE.load(Ordering::Relaxed)
}

/// Checks before the work that a file can be written and replaces nothing that this program did not write.
///
/// # Errors
/// A missing or unwritable folder; a file whose content does not show that this program wrote it.
pub fn check(path: &Path) -> Result<()> {
    check_writable(path)?;
    if is_forced() || !path.is_file() || is_ours(path) {
        return Ok(());
    }
    Err(
        Error::conflict("this file exists already, and nothing in it shows that realgap wrote it")
            .at_file(path)
            .hint("name another file, or replace this one with --force"),
    )
}

/// As [`check`], for each of these files.
pub fn check_all<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    paths.into_iter().try_for_each(|path| check(path))
}

/// Checks before the work that pictures can be written there.
pub fn check_pictures<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    paths.into_iter().try_for_each(|path| {
        realgap::plot::check_picture_path(path)?;
        check(path)
    })
}

/// Checks before the work that a page can be written there.
pub fn check_page(path: &Path) -> Result<()> {
    if path.extension().is_none_or(|ending| ending != "html") {
        return Err(Error::usage("a page is an HTML file")
            .at_file(path)
            .allowed("a name that ends in .html"));
    }
    check(path)
}

/// Writes the file, after [`check`].
///
/// # Errors
/// As [`check`], and a full disk.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    check(path)?;
    write_sealed(path, bytes, false)
}

/// Writes RON text, with a first line that names this program.
///
/// # Errors
/// As [`write`].
pub fn write_ron(path: &Path, text: &str) -> Result<()> {
    let head = concat!("// Written by realgap ", env!("CARGO_PKG_VERSION"), ".\n");
    write(path, format!("{head}{text}").as_bytes())
}

/// Whether the content of a file shows that this program wrote it. A CSV table cannot show it; an empty file may be replaced.
fn is_ours(path: &Path) -> bool {
    let mut start = Vec::new();
    let read =
        std::fs::File::open(path).and_then(|file| file.take(LOOKED_AT).read_to_end(&mut start));
    let text = String::from_utf8_lossy(&start);
    read.is_ok()
        && (start.is_empty()
            || MARKS.iter().any(|mark| text.contains(mark))
            || (start.starts_with(MCAP) && text.contains("realgap ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_this_program_wrote_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("robot.ron");
        write_ron(&file, "(a: 1)").unwrap();
        write_ron(&file, "(a: 2)").unwrap();
        std::fs::write(&file, "(a: 3)").unwrap();
        let refused = write_ron(&file, "(a: 4)").unwrap_err().to_string();
        assert!(refused.contains("--force"), "{refused}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "(a: 3)");
        check(Path::new("/dev/null")).unwrap();
    }
}
