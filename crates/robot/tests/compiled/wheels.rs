//! Models of public collections, where Python has `mujoco` and the collections.
#![allow(
    clippy::print_stdout,
    reason = "the table is the result that the docs quote"
)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use realgap_core::file::Source;
use realgap_robot::import::{Options, import};
use serde_json::Value;

use super::compare::Comparison;
use crate::common::{project, python_with, skipped};

/// What MuJoCo compiles, one model per line.
fn compiled(arguments: &[&Path]) -> Option<Vec<Value>> {
    let python = python_with("mujoco")?;
    let done = Command::new(python)
        .arg(project().join("tools/compiled_mjcf.py"))
        .args(arguments)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    Some(
        said.lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect(),
    )
}

/// Counts of a collection: models that MuJoCo compiles, that are imported, and that hold the contract.
#[derive(Default)]
struct Count {
    compiled: usize,
    imported: usize,
    held: usize,
    refused_by_mujoco: usize,
    numbers: usize,
}

/// Compares models, prints a table, and returns the broken promises.
fn check(models: &[Value]) -> Vec<String> {
    let mut counts: BTreeMap<String, Count> = BTreeMap::new();
    let mut largest: BTreeMap<&'static str, (f64, String)> = BTreeMap::new();
    let mut broken = Vec::new();
    for model in models {
        if let Some(package) = model["absent"].as_str() {
            skipped(&format!("the Python package {package} is not installed"));
            continue;
        }
        let (package, path) = (
            model["package"].as_str().unwrap(),
            model["path"].as_str().unwrap(),
        );
        let count = counts.entry(package.to_owned()).or_default();
        if model.get("refused").is_some() {
            count.refused_by_mujoco += 1;
            continue;
        }
        // A model without bodies moves nothing.
        if model["bodies"].as_array().unwrap().is_empty() {
            continue;
        }
        count.compiled += 1;
        let imported = match import(&Source::read(path, "robot").unwrap(), &Options::default()) {
            Ok(imported) => imported,
            Err(error) => {
                println!("REFUSED {path}: {error}");
                continue;
            }
        };
        count.imported += 1;
        let comparison = Comparison::of(&imported, model);
        count.numbers += comparison.numbers;
        for (field, (size, place)) in &comparison.largest {
            let known = largest.entry(field).or_insert((0.0, String::new()));
            if *size > known.0 {
                *known = (*size, format!("{path}: {place}"));
            }
        }
        let faults = comparison.broken();
        count.held += usize::from(faults.is_empty());
        broken.extend(faults.iter().map(|fault| format!("{path}: {fault}")));
    }
    for (package, count) in &counts {
        println!(
            "{package}: {} compiled, {} imported, {} held, {} numbers ({} refused by MuJoCo)",
            count.compiled, count.imported, count.held, count.numbers, count.refused_by_mujoco
        );
    }
    for (field, (size, place)) in &largest {
        println!(
            "{field}: {size:.1e} {}",
            place.chars().take(160).collect::<String>()
        );
    }
    broken
}

fn assert_sound(broken: &[String]) {
    assert!(
        broken.is_empty(),
        "{} faults:\n{}",
        broken.len(),
        broken.join("\n")
    );
}

#[test]
fn models_of_wheels_have_the_numbers_that_mujoco_compiles() {
    let Some(models) = compiled(&[Path::new("--wheels")]) else {
        return;
    };
    assert_sound(&check(&models));
}

#[test]
fn robots_of_recordings_and_of_cases_have_the_numbers_that_mujoco_compiles() {
    let Some(recorded) = crate::common::shared_data("go2_hang") else {
        return;
    };
    let cases = project().join("../shared/cases/robots");
    let listed = std::fs::read_dir(cases).into_iter().flatten().flatten();
    let mut files: Vec<_> = listed.map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "xml"));
    files.push(recorded.join("go2.xml"));
    files.sort();
    let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let Some(models) = compiled(&paths) else {
        return;
    };
    assert_sound(&check(&models));
}
