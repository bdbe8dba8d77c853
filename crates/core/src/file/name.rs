//! Names that become paths: of studies, searches and whatever else a folder or file is called after.

use std::path::Path;

use crate::error::{Error, Result};
use crate::text::is_plain;

/// Longest name, bytes: room for what is put before and behind it.
const MAX_BYTES: usize = 100;

/// Checks a name that becomes part of a path. `whose` is for the message, e.g. `a study`.
///
/// ```
/// use realgap_core::file::check_name;
///
/// check_name("größe 3", "a study")?;
/// for name in ["", "..", "-rf", "a/b", ".hidden", "two\nlines"] {
///     assert!(check_name(name, "a study").is_err(), "{name:?}");
/// }
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// An empty name or one of over 100 bytes; one that begins with `.` or `-` or with a blank, or ends with one; one with a slash or with
/// a character that cannot be seen.
pub fn check_name(name: &str, whose: &str) -> Result<()> {
    let is_usable = (1..=MAX_BYTES).contains(&name.len())
        && !name.starts_with(['.', '-'])
        && name.trim() == name
        && name
            .chars()
            .all(|c| is_plain(c) && !matches!(c, '/' | '\\'));
    if is_usable {
        return Ok(());
    }
    Err(Error::invalid(format!(
        "not a usable name for {whose}, after which results are called"
    ))
    .field("name")
    .found(format!("{name:?}"))
    .allowed(format!(
        "1 to {MAX_BYTES} bytes that can be seen, no slashes, not beginning with `.` or `-`"
    )))
}

/// The name of what is in a file: the file's own, without its ending.
///
/// # Errors
/// As [`check_name`].
pub fn name_of_file(path: &Path, whose: &str) -> Result<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    check_name(&stem, whose).map_err(|e| e.at_file(path).hint("give the file another name"))?;
    Ok(stem.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stays_inside_of_the_folder_that_it_is_put_into() {
        for good in ["tripod_floor", "a.b", "Ø 3", "x".repeat(100).as_str()] {
            check_name(good, "a study").unwrap();
        }
        for bad in [
            "",
            ".",
            "..",
            "...",
            "-x",
            "a/../b",
            "a\\b",
            " a",
            "a ",
            "a\0",
            "\u{1b}[2J",
            "\u{202e}a",
            "x".repeat(101).as_str(),
        ] {
            let error = check_name(bad, "a study").unwrap_err().to_string();
            assert!(error.contains("a study") && error.chars().all(|c| c == '\n' || is_plain(c)));
        }
    }

    #[test]
    fn a_file_that_is_called_dots_names_nothing() {
        assert_eq!(name_of_file(Path::new("a/b.ron"), "a study").unwrap(), "b");
        for bad in ["...ron", "a/.ron", "-x.ron", ".."] {
            assert!(name_of_file(Path::new(bad), "a study").is_err(), "{bad}");
        }
    }
}
