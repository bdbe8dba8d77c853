//! The words of the command line before clap reads them: names of before are those of today.

use std::ffi::OsString;
use std::sync::OnceLock;

use clap::Subcommand as _;

use super::{Command, terminal};

/// The words as they were typed.
static TYPED: OnceLock<Vec<OsString>> = OnceLock::new();

/// Keeps the words for whoever names the command later.
pub fn keep(words: impl Iterator<Item = OsString>) -> impl Iterator<Item = OsString> {
    TYPED.get_or_init(|| words.collect()).iter().cloned()
}

/// The words as they were typed, the program's name first.
pub fn typed() -> &'static [OsString] {
    TYPED.get().map_or(&[], Vec::as_slice)
}

/// The words in today's names. What has moved is said on standard error.
pub fn today(words: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut words: Vec<OsString> = words.collect();
    let at = if words.get(1).is_some_and(|word| word == "help") {
        2
    } else {
        1
    };
    let rest = words.get(at + 1..).unwrap_or_default();
    let old = words.get(at).and_then(|word| word.to_str());
    if let Some(old) = old.map(str::to_owned)
        && let Some(place) = place(&old, rest)
    {
        terminal::note(format!(
            "note: `realgap {old}` is now `realgap {}`",
            place.join(" ")
        ));
        words.splice(at..=at, place.map(OsString::from));
    }
    words
}

/// The group that a command of before belongs to, and its name there.
fn place(old: &str, rest: &[OsString]) -> Option<[String; 2]> {
    let top = Command::augment_subcommands(clap::Command::new("realgap"));
    let named = |group: &str, name: &str| Some([group.to_owned(), name.to_owned()]);
    let sense = top.find_subcommand("sense");
    match old {
        // A log of readings was all that `sense` once drew.
        "sense" => {
            let sense = sense?;
            let is_today = rest
                .first()
                .is_some_and(|word| word == "help" || sense.find_subcommand(word).is_some());
            let draws = |word: &OsString| {
                let word = word.to_string_lossy();
                word.starts_with("-o") || word.starts_with("--output")
            };
            (!is_today && rest.iter().any(draws)).then(|| ["sense".to_owned(), "draw".to_owned()])
        }
        "sensorgraph" => named("sense", "graph"),
        name if top.find_subcommand(name).is_some() => None,
        name => {
            let mut groups = top.get_subcommands();
            let group = groups.find(|group| group.find_subcommand(name).is_some())?;
            named(group.get_name(), name)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_before_lead_to_where_commands_are_now() {
        let now = |words: &str| {
            let words = today(words.split(' ').map(OsString::from));
            let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
            words.join(" ")
        };
        for (old, new) in [
            ("record a.ron", "study record a.ron"),
            ("sensorgraph fit l.csv", "sense graph fit l.csv"),
            ("sense laser -o l.csv", "sense draw laser -o l.csv"),
            ("help merge", "help cluster merge"),
            ("sense draw laser -o l.csv", "sense draw laser -o l.csv"),
            ("sense --help", "sense --help"),
            ("sweep a.ron", "sweep a.ron"),
            ("conquer", "conquer"),
        ] {
            assert_eq!(now(&format!("realgap {old}")), format!("realgap {new}"));
        }
    }
}
