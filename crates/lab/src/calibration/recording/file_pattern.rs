//! The files that a glob names: every match counts, and a match that cannot be a recording is an error that names it.

use std::fs;
use std::path::{Component, Path, PathBuf};

use glob::{MatchOptions, Pattern};

use realgap_core::{Error, Result};
use realgap_path::trajectory::is_data_set;

/// How names are matched: `*` does not match slashes (a name has none), and case matters.
const OPTIONS: MatchOptions = MatchOptions {
    case_sensitive: true,
    require_literal_separator: true,
    require_literal_leading_dot: false,
};

/// Every file below `base` that the pattern matches, in the order of the paths. Wildcards have a meaning in the pattern only, not
/// in `base`.
///
/// # Errors
/// A pattern that is not a glob; a folder that cannot be read; a match that is not a file (a folder, a pipe, a link that leads to
/// no file) or whose name is not UTF-8.
pub(in crate::calibration) fn matching_files(base: &Path, pattern: &str) -> Result<Vec<PathBuf>> {
    let mut steps = Vec::new();
    for component in Path::new(pattern).components() {
        steps.push(Step::new(component, pattern)?);
    }
    let mut found = Vec::new();
    walk(base.to_path_buf(), &steps, &mut found)?;
    found.sort();
    found.dedup();
    for path in &found {
        must_be_file(path)?;
    }
    Ok(found)
}

/// Whether a name matches a pattern with wildcards; a pattern that is not a glob matches nothing.
pub(in crate::calibration) fn name_matches(pattern: &str, name: &str) -> bool {
    Pattern::new(pattern).is_ok_and(|pattern| pattern.matches_with(name, OPTIONS))
}

/// One step down the path.
enum Step {
    /// To the entry with this name.
    Literal(PathBuf),
    /// To every entry whose name matches.
    Names(Pattern),
    /// To every folder at any depth.
    Anywhere,
}

impl Step {
    fn new(component: Component<'_>, pattern: &str) -> Result<Self> {
        let text = component.as_os_str().to_string_lossy();
        let is_name = matches!(component, Component::Normal(_));
        if is_name && text == "**" {
            return Ok(Self::Anywhere);
        }
        if is_name && text.contains(['*', '?', '[']) {
            let names = Pattern::new(&text).map_err(|e| {
                Error::invalid(format!("not a glob: {}", e.msg))
                    .field("recordings")
                    .found(pattern)
            })?;
            return Ok(Self::Names(names));
        }
        Ok(Self::Literal(component.as_os_str().into()))
    }
}

fn walk(at: PathBuf, steps: &[Step], found: &mut Vec<PathBuf>) -> Result<()> {
    let Some((step, rest)) = steps.split_first() else {
        found.push(at);
        return Ok(());
    };
    match step {
        Step::Literal(name) => {
            let next = at.join(name);
            // A dangling link exists, too, and is refused by name later.
            if fs::symlink_metadata(&next).is_ok() {
                walk(next, rest, found)?;
            }
        }
        Step::Names(pattern) => {
            for entry in entries(&at)? {
                let name = entry.file_name();
                if !pattern.matches_with(&name.to_string_lossy(), OPTIONS) {
                    continue;
                }
                if name.to_str().is_none() {
                    return Err(Error::invalid("the name of a recording is not UTF-8 text")
                        .at_file(at.join(&name))
                        .hint("give the file another name, or a glob that does not match it"));
                }
                // Only folders have further steps below them.
                if rest.is_empty() || at.join(&name).is_dir() {
                    walk(at.join(&name), rest, found)?;
                }
            }
        }
        Step::Anywhere => {
            walk(at.clone(), rest, found)?;
            for entry in entries(&at)? {
                // Links to folders are not followed, because they may form a circle.
                if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                    walk(at.join(entry.file_name()), steps, found)?;
                }
            }
        }
    }
    Ok(())
}

fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>> {
    let here = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    if !here.is_dir() {
        return Ok(Vec::new());
    }
    fs::read_dir(here)
        .and_then(Iterator::collect)
        .map_err(|e| Error::io("look for recordings", here, &e))
}

/// Checks that a match is a file or a data set; links are followed.
fn must_be_file(path: &Path) -> Result<()> {
    let what = match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() || is_data_set(path) => return Ok(()),
        Ok(metadata) if metadata.is_dir() => "a folder",
        Ok(_) => "a pipe or a device",
        Err(_) if path.is_symlink() => "a link that leads to no file",
        Err(e) => return Err(Error::io("read the recording", path, &e)),
    };
    Err(Error::invalid("a recording must be a file")
        .at_file(path)
        .found(what)
        .hint("remove it, or name a glob that does not match it: every match counts"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(base: &Path, pattern: &str) -> Vec<String> {
        let found = matching_files(base, pattern).unwrap();
        let name = |path: &PathBuf| path.strip_prefix(base).unwrap().display().to_string();
        found.iter().map(name).collect()
    }

    #[test]
    fn globs_find_what_shells_find_and_the_base_has_no_wildcards() {
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path().join("my [old] runs*");
        for name in ["b.csv", "a.csv", "sub/c.csv", "sub/deep/d.csv", "e.tum"] {
            let path = base.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        assert_eq!(names(&base, "*.csv"), ["a.csv", "b.csv"]);
        assert_eq!(names(&base, "[ae].*"), ["a.csv", "e.tum"]);
        assert_eq!(names(&base, "*/c.csv"), ["sub/c.csv"]);
        assert_eq!(names(&base, "sub/../a.csv"), ["sub/../a.csv"]);
        assert_eq!(
            names(&base, "**/*.csv"),
            ["a.csv", "b.csv", "sub/c.csv", "sub/deep/d.csv"]
        );
        assert!(names(&base, "x*").is_empty() && names(&base, "missing/*.csv").is_empty());
        let absolute = base.join("a.csv").display().to_string();
        let error = matching_files(&base, "[a").unwrap_err().to_string();
        assert!(error.contains("not a glob"), "{error}");
        assert_eq!(
            matching_files(Path::new("x"), &absolute.replace("[old]", "[[]old]"))
                .unwrap()
                .len(),
            1
        );
    }

    #[cfg(unix)]
    #[test]
    fn whatever_matches_and_is_no_file_is_named() {
        use std::os::unix::ffi::OsStrExt;
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let base = folder.path();
        fs::write(base.join("run.csv"), "").unwrap();
        symlink(base.join("run.csv"), base.join("link.csv")).unwrap();
        assert_eq!(names(base, "*.csv"), ["link.csv", "run.csv"]);
        let refused = |name: &str, words: &str| {
            let error = matching_files(base, "*.csv").unwrap_err().to_string();
            assert!(error.contains(name) && error.contains(words), "{error}");
        };
        symlink(base.join("gone"), base.join("dangling.csv")).unwrap();
        refused("dangling.csv", "leads to no file");
        assert!(matching_files(base, "dangling.csv").is_err());
        fs::remove_file(base.join("dangling.csv")).unwrap();
        symlink(base.join("loop.csv"), base.join("loop.csv")).unwrap();
        refused("loop.csv", "leads to no file");
        fs::remove_file(base.join("loop.csv")).unwrap();
        fs::create_dir(base.join("folder.csv")).unwrap();
        refused("folder.csv", "a folder");
        fs::remove_dir(base.join("folder.csv")).unwrap();
        let made = std::process::Command::new("mkfifo")
            .arg(base.join("pipe.csv"))
            .status();
        if made.is_ok_and(|status| status.success()) {
            refused("pipe.csv", "a pipe");
            fs::remove_file(base.join("pipe.csv")).unwrap();
        }
        let name = std::ffi::OsStr::from_bytes(b"run_\xff.csv");
        fs::write(base.join(name), "").unwrap();
        refused("run_", "not UTF-8");
    }
}
