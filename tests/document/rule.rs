//! Rules of the project that `Cargo.toml` cannot express.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::{Path, PathBuf};

use crate::common;

/// Crates that only these may name in their `[dependencies]`, so that another engine, another store or another way of
/// drawing is work in one place. The facade is called `realgap`.
const OWNED: &[(&str, &[&str])] = &[
    ("rapier3d-f64", &["simulation"]),
    ("plotters", &["drawing"]),
    ("rusqlite", &["store"]),
    // The facade needs it for tests only, and a dependency of tests cannot be optional.
    ("parquet", &["store", "realgap"]),
    ("ruzstd", &["core"]),
    ("lz4_flex", &["core"]),
    ("crc32fast", &["core"]),
    ("flate2", &["core"]),
    ("comfy-table", &["core"]),
    ("ab_glyph", &["core"]),
    ("roxmltree", &["robot"]),
    ("rustfft", &["vision"]),
    ("zune-jpeg", &["vision"]),
    ("jpeg-encoder", &["vision"]),
    ("kodama", &["lab"]),
    ("clap", &["realgap"]),
    ("clap_complete", &["realgap"]),
    ("indicatif", &["realgap"]),
];

/// Names in the tables of dependencies of a manifest, those of tests left out.
fn dependencies(manifest: &str) -> Vec<&str> {
    let mut is_inside = false;
    let mut names = Vec::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            let is_target = line.starts_with("[target.") && line.ends_with(".dependencies]");
            is_inside = line == "[dependencies]" || is_target;
        } else if is_inside {
            let end = line.find(['.', ' ', '=']).unwrap_or(0);
            names.push(line[..end].trim_matches('"'));
        }
    }
    names
}

#[test]
fn a_crate_with_an_owner_is_named_by_its_owner_alone() {
    let mut manifests = vec![("realgap".to_owned(), common::project().join("Cargo.toml"))];
    for entry in std::fs::read_dir(common::project().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        manifests.push((name, folder.join("Cargo.toml")));
    }
    let mut owned = 0;
    for (name, path) in manifests {
        let text = std::fs::read_to_string(path).unwrap();
        for dependency in dependencies(&text) {
            if let Some((_, owners)) = OWNED.iter().find(|(crate_, _)| *crate_ == dependency) {
                assert!(
                    owners.contains(&name.as_str()),
                    "`{name}` names `{dependency}`, which belongs to {owners:?}"
                );
                owned += 1;
            }
        }
    }
    assert!(owned > 15, "only {owned} crates with an owner were found");
}

/// A crate that takes another with its default features takes them for the whole program, so that `papers` could not be left out.
#[test]
fn crates_take_each_other_without_default_features() {
    let text = std::fs::read_to_string(common::project().join("Cargo.toml")).unwrap();
    let (_, table) = text.split_once("[workspace.dependencies]").unwrap();
    let (table, _) = table.split_once("\n[").unwrap();
    let own: Vec<&str> = table
        .lines()
        .filter(|line| line.starts_with("realgap-"))
        .collect();
    assert!(own.len() > 10, "only {} crates were found", own.len());
    for line in own {
        assert!(line.contains("default-features = false"), "{line}");
    }
}

/// Files of the library: of all crates, and the facade without its command line.
fn library(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !["cli", "tests"].contains(&name.as_str()) {
            library(&path, files);
        } else if name.ends_with(".rs") && name != "tests.rs" && name != "main.rs" {
            files.push(path);
        }
    }
}

/// The command line's options are its own: an error holds advice ([`realgap::Advice`]), and the command line names the option for it.
#[test]
fn the_library_names_no_option_of_the_command_line() {
    let is_option = |line: &str| {
        line.match_indices("--").any(|(position, _)| {
            let rest = &line[position + 2..];
            rest.starts_with(|c: char| c.is_ascii_lowercase())
        })
    };
    assert!(is_option("hint(\"go on with --resume\")"));
    let mut files = Vec::new();
    library(&common::project().join("src"), &mut files);
    library(&common::project().join("crates"), &mut files);
    assert!(files.len() > 200, "only {} files were found", files.len());
    // Options of Cargo are for users who build the library; the other words are arguments of another program.
    let of_others = [
        "features",
        "\"--version\"",
        "\"--psm\"",
        "xmllint",
        "rosbags-convert",
        "mavlogdump",
    ];
    let mut offences = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for line in code.lines() {
            let is_comment = line.trim_start().starts_with("//");
            let is_of_others = of_others.iter().any(|word| line.contains(word));
            if !is_comment && !is_of_others && is_option(line) {
                offences.push(format!("{}: {}", file.display(), line.trim()));
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

/// Words that state something about reality. Code that shows a report shows its claims (`realgap::claim`) and makes no statements of
/// its own.
const CLAIMED: [&str; 7] = [
    " honest",
    "narrowed down",
    "is not determined",
    "not determined by",
    "have the distribution of",
    "noise floors away",
    "explain these",
];

#[test]
fn code_that_shows_a_report_makes_no_claims_of_its_own() {
    let mut files = Vec::new();
    for folder in [
        "crates/page/src/report",
        "crates/page/src/plot",
        "crates/page/src/results",
    ] {
        library(&common::project().join(folder), &mut files);
    }
    library(&common::project().join("src/cli"), &mut files);
    let entries = std::fs::read_dir(common::project().join("python/realgap")).unwrap();
    files.extend(
        entries
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.is_file()),
    );
    files.retain(|file| {
        !file
            .components()
            .any(|part| part.as_os_str() == "contradiction")
    });
    files.retain(|file| !file.ends_with("contradiction.rs"));
    assert!(files.len() > 150, "only {} files were found", files.len());
    let claims = |line: &str| CLAIMED.iter().any(|word| line.contains(word));
    assert!(claims("\"these confidences are NOT honest\""));
    let mut offences = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        for line in text.lines() {
            let line = line.trim_start();
            if !line.starts_with("//") && claims(line) {
                offences.push(format!("{}: {line}", file.display()));
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn tests_that_ci_does_not_run_again_exist_and_are_those_of_every_build() {
    let mut files = Vec::new();
    for folder in ["tests/command", "tests/page"] {
        library(&common::project().join(folder), &mut files);
    }
    let listed = std::fs::read_to_string(common::project().join(".ci/ran_above")).unwrap();
    let names: Vec<&str> = listed
        .lines()
        .filter(|line| !line.starts_with('#'))
        .collect();
    assert!(!names.is_empty());
    for name in names {
        let (module, test) = name.split_once("::").unwrap();
        let file = files
            .iter()
            .find(|file| file.file_stem().unwrap() == module);
        let text = std::fs::read_to_string(file.unwrap_or_else(|| panic!("{name}"))).unwrap();
        let from = text
            .find(&format!("fn {test}()"))
            .unwrap_or_else(|| panic!("{name}"));
        let body = &text[from..];
        let body = &body[..body.find("\n}\n").unwrap()];
        let is_of_one_build = [
            "is_long_run",
            "shared_data(",
            "python_with(",
            "cfg!(feature",
        ];
        assert!(
            is_of_one_build.iter().all(|word| !body.contains(word)),
            "{name}"
        );
    }
}
