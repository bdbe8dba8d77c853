//! Layers hold: a room may use only the rooms below it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::{Path, PathBuf};

/// Rooms from the ground up, each with the rooms it may use. A room inside another (`simulation::parameter`) has rules of
/// its own; who may use a room may use the rooms inside it.
const PERMITTED: &[(&str, &[&str])] = &[
    ("text", &[]),
    ("error", &["unit", "text"]),
    ("warning", &["text"]),
    ("unit", &[]),
    ("table", &["text"]),
    ("quantity", &["error", "unit"]),
    ("random", &[]),
    ("font", &["error"]),
    ("statistics", &["error", "random"]),
    ("file", &["error", "text"]),
    ("store", &["error", "file"]),
    ("trajectory", &["error", "warning", "unit", "file", "store"]),
    (
        "comparison",
        &["error", "warning", "unit", "file", "trajectory"],
    ),
    ("robot::morphology", &["error", "warning", "unit", "file"]),
    ("robot::genome", &["error", "file", "robot::morphology"]),
    (
        "simulation",
        &[
            "error",
            "warning",
            "unit",
            "random",
            "robot::morphology",
            "file",
            "sensing",
            "trajectory",
        ],
    ),
    (
        "simulation::parameter",
        &[
            "error",
            "file",
            "warning",
            "unit",
            "quantity",
            "robot::morphology",
            "sensing",
            "simulation",
        ],
    ),
    (
        "simulation::verification",
        &[
            "error",
            "warning",
            "unit",
            "file",
            "robot::morphology",
            "trajectory",
            "simulation",
        ],
    ),
    (
        "sensing",
        &[
            "error",
            "warning",
            "unit",
            "random",
            "table",
            "text",
            "font",
            "statistics",
            "file",
            "trajectory",
        ],
    ),
    (
        "task",
        &[
            "error",
            "warning",
            "unit",
            "table",
            "text",
            "statistics",
            "file",
            "trajectory",
        ],
    ),
    (
        "export",
        &[
            "error",
            "file",
            "warning",
            "unit",
            "robot::morphology",
            "simulation",
        ],
    ),
    ("import", &["error", "file", "robot::morphology"]),
    (
        "optimization",
        &["error", "file", "statistics", "quantity", "store"],
    ),
    (
        "calibration::identification",
        &[
            "error",
            "warning",
            "unit",
            "statistics",
            "robot::morphology",
            "trajectory",
            "simulation",
        ],
    ),
    (
        "calibration::camera",
        &[
            "error",
            "warning",
            "unit",
            "table",
            "statistics",
            "sensing",
            "optimization",
        ],
    ),
    // A study is where everything meets but pictures.
    (
        "calibration",
        &[
            "error",
            "warning",
            "unit",
            "quantity",
            "random",
            "statistics",
            "file",
            "trajectory",
            "comparison",
            "robot::morphology",
            "simulation",
            "calibration::identification",
            "store",
            "optimization",
        ],
    ),
    (
        "prediction::ensemble",
        &[
            "error",
            "warning",
            "unit",
            "table",
            "statistics",
            "trajectory",
            "simulation",
            "optimization",
        ],
    ),
    (
        "prediction::card",
        &[
            "error",
            "warning",
            "unit",
            "statistics",
            "simulation",
            "prediction::ensemble",
            "prediction::model",
        ],
    ),
    (
        "prediction::report",
        &[
            "error",
            "warning",
            "statistics",
            "simulation",
            "optimization",
            "trajectory",
            "calibration",
            "prediction::ensemble",
            "prediction::model",
            "prediction::kept",
            "file",
            "store",
        ],
    ),
    (
        "prediction::kept",
        &["error", "simulation", "store", "trajectory"],
    ),
    (
        "prediction::model",
        &[
            "error",
            "unit",
            "statistics",
            "simulation",
            "optimization",
            "trajectory",
            "prediction::ensemble",
        ],
    ),
    (
        "prediction::odds",
        &[
            "error",
            "warning",
            "statistics",
            "optimization",
            "trajectory",
            "simulation",
            "calibration",
            "prediction::ensemble",
        ],
    ),
    (
        "prediction::gap",
        &[
            "error",
            "warning",
            "unit",
            "table",
            "statistics",
            "optimization",
            "trajectory",
            "comparison",
            "simulation",
            "calibration",
            "prediction::ensemble",
            "prediction::kept",
            "store",
        ],
    ),
    ("search::body", &["error", "robot"]),
    // Strategies propose; they know no simulator.
    (
        "search::strategy",
        &[
            "error",
            "file",
            "random",
            "statistics",
            "robot::genome",
            "optimization",
            "search::body",
        ],
    ),
    (
        "search",
        &[
            "error",
            "warning",
            "unit",
            "random",
            "statistics",
            "file",
            "trajectory",
            "robot",
            "simulation",
            "export",
            "store",
            "optimization",
            "prediction",
        ],
    ),
    (
        "plan",
        &[
            "error",
            "file",
            "store",
            "optimization",
            "calibration",
            "prediction",
            "search",
        ],
    ),
    (
        "plot",
        &["error", "warning", "unit", "table", "font", "file"],
    ),
    (
        "report",
        &[
            "error",
            "warning",
            "unit",
            "text",
            "file",
            "statistics",
            "trajectory",
            "robot",
            "simulation",
            "store",
            "plot",
        ],
    ),
    (
        "results",
        &[
            "error",
            "warning",
            "unit",
            "text",
            "store",
            "statistics",
            "file",
            "trajectory",
            "comparison",
            "robot",
            "simulation",
            "sensing",
            "task",
            "optimization",
            "calibration",
            "prediction",
            "search",
            "export",
            "plot",
        ],
    ),
    // Describes types of all rooms whose files people write; nobody needs it.
    (
        "schema",
        &[
            "unit",
            "warning",
            "trajectory",
            "comparison",
            "robot",
            "sensing",
            "simulation",
            "calibration",
            "prediction",
            "search",
            "plan",
        ],
    ),
];

/// Crates that only one room may name.
const OWNED: &[(&str, &str)] = &[
    ("rapier3d", "simulation"),
    ("rapier3d_f64", "simulation"),
    ("plotters", "plot"),
    ("rusqlite", "store"),
    ("parquet", "store"),
    ("ruzstd", "file"),
    ("lz4_flex", "file"),
    ("crc32fast", "file"),
    ("roxmltree", "import"),
    ("comfy_table", "table"),
    ("ab_glyph", "font"),
    ("rustfft", "sensing"),
    ("zune_jpeg", "sensing"),
    ("jpeg_encoder", "sensing"),
    ("kodama", "prediction::ensemble"),
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
            let module = relative.trim_end_matches(".rs").trim_end_matches("/mod");
            let room = room_of(&module.replace('/', "::")).to_owned();
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

/// The deepest room with a place in the layers that this path leads into; else its first segment.
fn room_of(path: &str) -> &str {
    let known = |candidate: &str| PERMITTED.iter().any(|(room, _)| *room == candidate);
    let mut candidate = path;
    loop {
        if known(candidate) {
            return candidate;
        }
        match candidate.rsplit_once("::") {
            Some((parent, _)) => candidate = parent,
            None => return candidate,
        }
    }
}

fn is_inside(room: &str, other: &str) -> bool {
    room == other
        || room
            .strip_prefix(other)
            .is_some_and(|rest| rest.starts_with("::"))
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
            let path: String = name
                .trim()
                .chars()
                .take_while(|c| c.is_alphanumeric() || matches!(c, '_' | ':'))
                .collect();
            rooms.push(match path.as_str() {
                "Error" | "Result" | "ErrorKind" | "Advice" => "error".to_owned(),
                "Warning" => "warning".to_owned(),
                path => room_of(path.trim_end_matches(':')).to_owned(),
            });
        }
    }
    rooms
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let mut offences = Vec::new();
    for (file, room, code) in code() {
        if matches!(
            room.as_str(),
            "lib" | "main" | "cli" | "robot" | "prediction"
        ) {
            continue;
        }
        let Some((_, permitted)) = PERMITTED.iter().find(|(name, _)| *name == room) else {
            offences.push(format!(
                "{file}: the room `{room}` has no place in the layers"
            ));
            continue;
        };
        for used in used_rooms(&code) {
            if used != room && !permitted.iter().any(|p| is_inside(&used, p)) {
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
            if code.contains(&format!("{name}::")) && !is_inside(&room, owner) {
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

/// The command line's options are its own: an error says what can be done ([`realgap::Advice`]), the command line how.
#[test]
fn the_library_names_no_option_of_the_command_line() {
    let is_option = |line: &str| {
        line.match_indices("--").any(|(position, _)| {
            let rest = &line[position + 2..];
            rest.starts_with(|c: char| c.is_ascii_lowercase())
        })
    };
    assert!(is_option("hint(\"go on with --resume\")"));
    let mut offences = Vec::new();
    for (file, room, code) in code() {
        // Cargo's own options are for who builds the library; these words are said to another program.
        let of_others = ["features", "\"--version\"", "\"--psm\""];
        let is_of_others = |line: &&str| of_others.iter().any(|word| line.contains(word));
        let lines = code.lines().filter(|line| !is_of_others(line));
        for line in lines.filter(|line| room != "cli" && is_option(line)) {
            offences.push(format!("{file}: {}", line.trim()));
        }
    }
    assert!(offences.is_empty(), "{}", offences.join("\n"));
}

#[test]
fn the_rule_is_able_to_fail() {
    assert_eq!(used_rooms("use crate::simulation::run;"), ["simulation"]);
    assert_eq!(
        used_rooms("use crate::simulation::parameter::by_name;"),
        ["simulation::parameter"]
    );
    assert_eq!(
        used_rooms("use crate::{Error, plot::Curve};"),
        ["error", "plot"]
    );
    assert!(is_inside("robot::genome", "robot") && !is_inside("robotics", "robot"));
}
