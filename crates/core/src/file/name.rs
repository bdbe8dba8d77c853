//! Checks names that become part of a path, such as the names of studies and searches.

use std::path::Path;

use crate::error::{Error, Result};
use crate::text::is_plain;

/// The largest length of a name, bytes; it leaves enough bytes for a prefix and a suffix of the file name.
const MAX_BYTES: usize = 100;

/// Checks a name that becomes part of a path. `whose` says in the error message what has the name, e.g. `a study`.
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
/// A name that is empty or longer than 100 bytes, that begins with `.`, `-` or a blank, that ends with a blank, or that contains a slash
/// or an invisible character.
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
        "not a usable name for {whose}: results are named after it"
    ))
    .field("name")
    .found(format!("{name:?}"))
    .allowed(format!(
        "1 to {MAX_BYTES} bytes of visible characters, no slashes, not beginning with `.` or `-`"
    )))
}

/// The name of the object in a file, which is the file's name without its extension.
///
/// # Errors
/// The same as of [`check_name`].
pub fn name_of_file(path: &Path, whose: &str) -> Result<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    check_name(&stem, whose).map_err(|e| e.at_file(path).hint("give the file another name"))?;
    Ok(stem.into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_lead_out_of_its_folder() {
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
    fn a_file_name_made_of_dots_gives_no_name() {
        assert_eq!(name_of_file(Path::new("a/b.ron"), "a study").unwrap(), "b");
        for bad in ["...ron", "a/.ron", "-x.ron", ".."] {
            assert!(name_of_file(Path::new(bad), "a study").is_err(), "{bad}");
        }
    }
}
