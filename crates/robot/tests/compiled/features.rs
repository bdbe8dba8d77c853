//! One small file for each feature, with the numbers that MuJoCo 4.0.0 compiled from it (tools/compiled_mjcf.py).

use std::path::Path;

use realgap_core::file::Source;
use realgap_robot::import::{Imported, NoteKind, Options, import};
use serde_json::Value;

use super::compare::Comparison;

const GOLDEN: &str = include_str!("../golden/compiled_mjcf.json");

fn cases() -> Vec<Value> {
    serde_json::from_str(GOLDEN).unwrap()
}

/// Writes the files of a case into a folder and imports the main one.
fn imported(case: &Value, folder: &Path) -> Imported {
    for (name, text) in case["files"].as_object().unwrap() {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text.as_str().unwrap()).unwrap();
    }
    let source = Source::read(folder.join("main.xml"), "robot").unwrap();
    import(&source, &Options::default()).unwrap_or_else(|e| panic!("{}: {e}", case["name"]))
}

fn named(name: &str) -> Value {
    cases()
        .into_iter()
        .find(|case| case["name"] == name)
        .unwrap()
}

fn notes(name: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let notes = imported(&named(name), folder.path()).notes;
    notes.into_iter().map(|note| note.to_string()).collect()
}

#[test]
fn every_feature_has_the_numbers_that_mujoco_compiles() {
    let mut broken = Vec::new();
    for case in cases() {
        let folder = tempfile::tempdir().unwrap();
        let robot = imported(&case, folder.path());
        let comparison = Comparison::of(&robot, &case["compiled"]);
        assert!(comparison.numbers > 10, "{}", case["name"]);
        broken
            .extend((comparison.broken().iter()).map(|fault| format!("{}: {fault}", case["name"])));
    }
    assert!(
        broken.is_empty(),
        "{} faults:\n{}",
        broken.len(),
        broken.join("\n")
    );
}

#[test]
fn what_is_not_taken_is_said_in_one_line() {
    for (name, part) in [
        ("timeconst", "the activation (filterexact of 0.05 s)"),
        (
            "muscle",
            "the actuator `a`: its gain is of the kind `muscle`",
        ),
        ("second actuator", "already has an actuator"),
        ("polynomial stiffness", "(polynomial)"),
        (
            "keyframe",
            "joints start in the posture of the keyframe home",
        ),
        ("ball joint", "replaced by three hinges"),
        ("gear", "recorded commands are those of MuJoCo's `ctrl`"),
    ] {
        let all = notes(name);
        let lines = all.iter().filter(|note| note.contains(part)).count();
        assert_eq!(lines, 1, "{name}: {all:#?}");
    }
}

#[test]
fn a_file_that_takes_everything_has_no_note_about_its_numbers() {
    for name in [
        "dampratio",
        "gravcomp",
        "replicate",
        "include",
        "stiffness and springref",
    ] {
        let all = notes(name);
        let about = |note: &&String| {
            let world = note.contains("below the floor") || note.contains("is recorded");
            !note.contains("no force limit")
                && !note.contains("ctrl")
                && !note.contains("motors")
                && !world
        };
        let more: Vec<_> = all.iter().filter(about).collect();
        assert!(more.is_empty(), "{name}: {more:#?}");
    }
}

#[test]
fn an_impossible_inertia_is_doubted() {
    let text = r#"<mujoco><worldbody><body name="b"><inertial pos="0 0 0" mass="1" diaginertia="0.1 0.2 0.9"/><joint/></body></worldbody></mujoco>"#;
    let robot = import(&Source::new("b.xml", text), &Options::default()).unwrap();
    let doubts = robot
        .notes
        .iter()
        .filter(|note| note.kind == NoteKind::Doubt);
    let all: Vec<String> = doubts.map(ToString::to_string).collect();
    assert!(
        all.iter().any(|note| note.contains("impossible")),
        "{all:?}"
    );
}

#[test]
fn files_that_mujoco_refuses_are_refused_with_their_line() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("part.xml"), "<mujocoinclude/>").unwrap();
    for (inside, part) in [
        (
            "<include file=\"part.xml\"/>\n<include file=\"part.xml\"/>",
            "included twice",
        ),
        ("\n<include file=\"none.xml\"/>", "cannot be found"),
        (
            "\n<worldbody><body><geom size=\"a\"/></body></worldbody>",
            "`size` has the wrong form",
        ),
        ("\n<compiler coordinate=\"global\"/>", "global"),
        (
            "\n<worldbody><attach model=\"m\" body=\"b\"/></worldbody>",
            "not among the assets",
        ),
        (
            "\n<worldbody><replicate count=\"1e9\"><body/></replicate></worldbody>",
            "number of copies",
        ),
    ] {
        let path = folder.path().join("main.xml");
        std::fs::write(&path, format!("<mujoco>{inside}</mujoco>")).unwrap();
        let source = Source::read(&path, "robot").unwrap();
        let error = import(&source, &Options::default())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(part) && error.contains(":2"),
            "{part}: {error}"
        );
    }
}
