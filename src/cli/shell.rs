//! Commands and paths, quoted for a shell.

use std::path::Path;

/// The running command, quoted for a shell.
pub fn command_line() -> String {
    let words = super::invocation::typed().iter().skip(1);
    let words = words.map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("realgap".to_owned())
        .chain(words)
        .collect::<Vec<_>>()
        .join(" ")
}

/// A word, quoted for a shell where that is necessary.
pub fn quoted(word: String) -> String {
    let is_simple = |c: char| c.is_alphanumeric() || "_-./=,:+%@".contains(c);
    match word.chars().all(is_simple) && !word.is_empty() {
        true => word,
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// A path, quoted as one word.
pub fn path(path: &Path) -> String {
    quoted(path.to_string_lossy().into_owned())
}
