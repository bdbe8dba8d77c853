//! Layers hold: a room may use only the rooms below it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::{Path, PathBuf};

/// Rooms from the ground up, each with the rooms it may use.
const PERMITTED: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("warning", &[]),
    ("quantity", &[]),
    ("statistic", &["error"]),
    ("file", &["error"]),
    ("trajectory", &["error", "warning", "quantity", "file"]),
    (
        "comparison",
        &["error", "warning", "quantity", "trajectory"],
    ),
    ("morphology", &["error", "warning", "quantity", "file"]),
    ("genome", &["error", "file", "morphology"]),
    ("search", &["error", "statistic", "genome"]),
    (
        "simulation",
        &["error", "warning", "quantity", "morphology", "trajectory"],
    ),
    (
        "export",
        &["error", "warning", "quantity", "morphology", "simulation"],
    ),
    (
        "verification",
        &[
            "error",
            "warning",
            "quantity",
            "file",
            "morphology",
            "trajectory",
            "simulation",
        ],
    ),
    (
        "parameter",
        &["error", "warning", "quantity", "morphology", "simulation"],
    ),
    (
        "identification",
        &[
            "error",
            "warning",
            "quantity",
            "morphology",
            "trajectory",
            "simulation",
        ],
    ),
    ("store", &["error"]),
    ("tuning", &["error", "statistic", "parameter", "store"]),
    ("study", BELOW_STUDY),
    (
        "ensemble",
        &[
            "error",
            "warning",
            "quantity",
            "statistic",
            "trajectory",
            "simulation",
        ],
    ),
    (
        "gap",
        &[
            "error",
            "warning",
            "statistic",
            "trajectory",
            "comparison",
            "simulation",
            "parameter",
            "study",
            "ensemble",
        ],
    ),
    // Where strategies meet the simulator: they do not know of it.
    (
        "hunt",
        &[
            "error",
            "warning",
            "quantity",
            "statistic",
            "file",
            "trajectory",
            "morphology",
            "genome",
            "search",
            "simulation",
            "export",
            "parameter",
            "store",
            "tuning",
            "ensemble",
        ],
    ),
    ("report", &["error", "warning", "quantity", "file"]),
    ("portrait", &["error", "morphology", "report"]),
    (
        "folder",
        &[
            "error",
            "warning",
            "quantity",
            "statistic",
            "file",
            "trajectory",
            "comparison",
            "simulation",
            "parameter",
            "tuning",
            "study",
            "ensemble",
            "gap",
            "morphology",
            "genome",
            "search",
            "export",
            "hunt",
            "report",
            "portrait",
        ],
    ),
];

/// A study is where everything meets but pictures.
const BELOW_STUDY: &[&str] = &[
    "error",
    "warning",
    "quantity",
    "statistic",
    "file",
    "trajectory",
    "comparison",
    "morphology",
    "simulation",
    "parameter",
    "identification",
    "store",
    "tuning",
];

/// Crates that only one room may name.
const OWNED: &[(&str, &str)] = &[
    ("rapier3d", "simulation"),
    ("rapier3d_f64", "simulation"),
    ("plotters", "report"),
    ("rusqlite", "store"),
    ("parquet", "store"),
    ("argmin", "tuning"),
    ("cmaes", "tuning"),
    ("egobox_ego", "tuning"),
    ("kodama", "ensemble"),
    ("indicatif", "cli"),
    ("clap", "cli"),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// Path relative to `src`, room, and code without comments and unit tests.
fn code() -> Vec<(String, String, String)> {
    let src = common::project().join("src");
    sources(&src)
        .into_iter()
        .map(|path| {
            let relative = path
                .strip_prefix(&src)
                .unwrap()
                .to_string_lossy()
                .into_owned();
            let room = relative.split(['/', '.']).next().unwrap().to_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            let text = text
                .split("#[cfg(test)]")
                .next()
                .unwrap_or_default()
                .to_owned();
            let code: Vec<&str> = text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
                .collect();
            (relative, room, code.join("\n"))
        })
        .collect()
}

/// The rooms that code names as `crate::room` or inside `use crate::{room::…}`.
fn used_rooms(code: &str) -> Vec<String> {
    let mut rooms = Vec::new();
    for (position, _) in code.match_indices("crate::") {
        let rest = &code[position + "crate::".len()..];
        let names: Vec<&str> = match rest.strip_prefix('{') {
            Some(list) => list
                .split('}')
                .next()
                .unwrap_or_default()
                .split(',')
                .collect(),
            None => vec![rest],
        };
        for name in names {
            let name: String = name
                .trim()
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            rooms.push(match name.as_str() {
                "Error" | "Result" | "ErrorKind" => "error".to_owned(),
                "Warning" => "warning".to_owned(),
                _ => name,
            });
        }
    }
    rooms
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let mut offences = Vec::new();
    for (file, room, code) in code() {
        if matches!(room.as_str(), "lib" | "main" | "cli") {
            continue;
        }
        let Some((_, permitted)) = PERMITTED.iter().find(|(name, _)| *name == room) else {
            offences.push(format!(
                "{file}: the room `{room}` has no place in the layers"
            ));
            continue;
        };
        for used in used_rooms(&code) {
            if used != room && !permitted.contains(&used.as_str()) {
                offences.push(format!("{file}: `{room}` uses `{used}`"));
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn a_crate_with_an_owner_is_named_in_its_room_alone() {
    let mut offences = Vec::new();
    for (file, room, code) in code() {
        for (name, owner) in OWNED {
            if code.contains(&format!("{name}::")) && room != *owner {
                offences.push(format!(
                    "{file}: names `{name}`, which belongs to `{owner}`"
                ));
            }
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn the_library_never_prints() {
    let printing = [
        "println!",
        "eprintln!",
        "print!(",
        "eprint!(",
        "dbg!",
        "stdout()",
        "stderr()",
    ];
    let offences: Vec<String> = code()
        .into_iter()
        .filter(|(_, room, code)| room != "cli" && printing.iter().any(|word| code.contains(word)))
        .map(|(file, _, _)| file)
        .collect();
    assert!(offences.is_empty(), "{offences:?}");
}

#[test]
fn the_rule_is_able_to_fail() {
    assert_eq!(used_rooms("use crate::simulation::run;"), ["simulation"]);
    assert_eq!(
        used_rooms("use crate::{Error, report::Curve};"),
        ["error", "report"]
    );
}
