//! Licences of dependencies: none requires more than a notice.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::process::Command;

/// Licences that require only that their text is passed on.
const FREE: [&str; 12] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "0BSD",
    "BSL-1.0",
    "CC0-1.0",
    "IJG",
    "ISC",
    "Unicode-3.0",
    "Zlib",
];

/// Whether an SPDX expression can be met with free licences alone: one side of every OR, all sides of every AND.
fn is_free(expression: &str) -> bool {
    let text = expression.replace('/', " OR ");
    // No expression among crates nests deeper than one bracket.
    if let Some((before, rest)) = text.split_once('(') {
        let Some((inner, after)) = rest.split_once(')') else {
            return false;
        };
        let word = if is_free(inner) { "MIT" } else { "unfree" };
        return is_free(&format!("{before}{word}{after}"));
    }
    text.split(" OR ")
        .any(|all| all.split(" AND ").all(|one| FREE.contains(&one.trim())))
}

#[test]
fn every_dependency_is_free_to_use() {
    let said = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline", "--locked"])
        .current_dir(common::project())
        .output()
        .unwrap();
    if !said.status.success() {
        // Crates of other systems, which are listed but never built here, may not have been fetched.
        return common::skipped("cargo metadata needs crates that were not fetched");
    }
    let all: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
    let packages = all["packages"].as_array().unwrap();
    assert!(packages.len() > 100, "{}", packages.len());
    let offences: Vec<String> = packages
        .iter()
        .filter(|package| !package["license"].as_str().is_some_and(is_free))
        .map(|package| format!("{}: {}", package["name"], package["license"]))
        .collect();
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn every_dependency_comes_from_the_registry_of_crates() {
    let lock = std::fs::read_to_string(common::project().join("Cargo.lock")).unwrap();
    let sources: Vec<&str> = lock
        .lines()
        .filter_map(|line| line.strip_prefix("source = "))
        .collect();
    assert!(sources.len() > 100, "{}", sources.len());
    let registry = "\"registry+https://github.com/rust-lang/crates.io-index\"";
    let others: Vec<&&str> = sources
        .iter()
        .filter(|source| **source != registry)
        .collect();
    assert!(others.is_empty(), "{others:?}");
}

#[test]
fn licence_expressions_are_parsed_correctly() {
    assert!(is_free("MIT/Apache-2.0"));
    assert!(is_free("(MIT OR Apache-2.0) AND Unicode-3.0"));
    assert!(is_free("MIT OR LGPL-2.1-or-later"));
    assert!(!is_free("MIT AND GPL-3.0"));
    assert!(!is_free("(MIT OR Apache-2.0) AND MPL-2.0"));
    assert!(!is_free("LGPL-2.1-or-later"));
}
