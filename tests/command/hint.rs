//! Errors of users: the message names the mistake correctly, and says how to correct it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use common::{project, quick_study, realgap, text};
use realgap::calibration::{Definition, Overrides, Study};
use realgap::optimization::{Progress, RunOptions};
use realgap::unit::Unit;

/// Standard error of the command, and its exit code.
fn said(arguments: &[&str]) -> (String, i32) {
    let out = realgap().args(arguments).output().unwrap();
    (text(&out.stderr), out.status.code().unwrap())
}

/// Checks that a command is refused as wrong usage, with all of these words.
fn refused(arguments: &[&str], words: &[&str]) {
    let (error, code) = said(arguments);
    assert_eq!(code, 2, "{arguments:?}\n{error}");
    for word in words {
        assert!(
            error.contains(word),
            "{arguments:?}: `{word}` is missing\n{error}"
        );
    }
}

/// The error of `check` for a file with this text.
fn checked(folder: &Path, body: &str) -> String {
    let path = folder.join("file.ron");
    std::fs::write(&path, body).unwrap();
    said(&["check", path.to_str().unwrap()]).0
}

fn tripod() -> String {
    std::fs::read_to_string(project().join("morphologies/tripod.ron")).unwrap()
}

#[test]
fn a_count_of_zero_is_wrong_usage_with_the_allowed_range() {
    let study = "sweeps/tripod_floor.ron";
    refused(&["sweep", study, "--jobs", "0"], &["allowed: 1 to"]);
    for option in ["--every", "--limit-recordings"] {
        refused(
            &["evaluate", study, option, "0"],
            &[option, "allowed: a whole number, 1 or more"],
        );
    }
    for folds in ["0", "1"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        refused(
            &[
                "sweep",
                study,
                "--folds",
                folds,
                "-o",
                out.to_str().unwrap(),
            ],
            &["--folds", "allowed: 2 up to the number of recordings"],
        );
        assert!(!out.exists());
    }
}

#[test]
fn a_file_in_place_of_a_folder_is_named_in_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("results");
    std::fs::write(&file, "mine").unwrap();
    let study = "sweeps/tripod_floor.ron";
    for command in [
        &["sweep", study][..],
        &["tune", study],
        &["ensemble", study],
        &["gap", study],
        &["search", "sweeps/best_robot.ron"],
        &["study", "record", "morphologies/cube.ron"],
        &["predict", "morphologies/cube.ron"],
    ] {
        refused(
            &[command, &["-o", file.to_str().unwrap()]].concat(),
            &["results need a folder", "found:   a file", "-o"],
        );
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn every_command_names_the_kind_of_a_wrong_file() {
    let (robot, study) = ("morphologies/cube.ron", "sweeps/tripod_floor.ron");
    for (command, file, found) in [
        (&["simulate"][..], study, "a study"),
        (&["predict"], study, "a study"),
        (&["study", "record"], study, "a study"),
        (&["robot", "develop"], robot, "a morphology"),
        (&["sweep"], robot, "a morphology"),
        (&["tune"], robot, "a morphology"),
        (&["ensemble"], robot, "a morphology"),
        (&["gap"], robot, "a morphology"),
        (&["study", "sensitivity"], robot, "a morphology"),
        (&["search"], study, "a study"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut arguments = [command, &[file]].concat();
        if command == ["study", "record"] {
            arguments.extend(["-o", out.to_str().unwrap()]);
        }
        refused(&arguments, &[&format!("found:   {found}"), "hint:"]);
    }
}

#[test]
fn a_decimal_comma_is_recognized() {
    refused(
        &["simulate", "morphologies/cube.ron", "--duration", "0,08"],
        &["decimals follow a point: 0.08"],
    );
    refused(
        &[
            "simulate",
            "morphologies/cube.ron",
            "--set",
            "floor.friction=0,08",
        ],
        &["a comma within a number", "allowed: 0.08"],
    );
    let folder = tempfile::tempdir().unwrap();
    let found = |from: &str, to: &str| checked(folder.path(), &tripod().replacen(from, to, 1));
    for (from, to, right) in [
        ("side_m: 0.06", "side_m: 0,06", "allowed: 0.06"),
        ("max_torque_nm: 0.2", "max_torque_nm: 0,2", "allowed: 0.2"),
        ("phase_rad: 5.588", "phase_rad: 5,588", "allowed: 5.588"),
    ] {
        let error = found(from, to);
        assert!(
            error.contains("a comma within a number") && error.contains(right),
            "{error}"
        );
    }
    // The error names the place of the comma: line 5, at the number.
    assert!(found("side_m: 0.06", "side_m: 0,06").contains("file.ron:5:24: "));
}

#[test]
fn a_list_that_is_never_closed_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, list) in [
        ("    ],\n    track", "    track", "glue"),
        (
            "        )),\n    ],\n    glue",
            "        )),\n    glue",
            "modules",
        ),
        ("    ],\n    track: \"core\",\n", "", "glue"),
    ] {
        let error = checked(folder.path(), &tripod().replacen(from, to, 1));
        let expected = format!("{list}: a closing `]` is missing");
        assert!(error.contains(&expected), "{error}");
    }
    let study = "Study(\n morphology: \"a.ron\",\n recordings: [\"a.csv\",\n start: Settled,\n)";
    let error = checked(folder.path(), study);
    assert!(
        error.contains("recordings: a closing `]` is missing"),
        "{error}"
    );
}

#[test]
fn a_name_given_twice_is_found_before_the_name_that_it_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let twice = tripod().replacen("\"leg_b\", kind", "\"leg_a\", kind", 1);
    let error = checked(folder.path(), &twice);
    assert!(
        error.contains("modules[2].name: two modules have the same name"),
        "{error}"
    );
}

#[test]
fn an_invalid_default_is_reported_at_the_place_of_the_default() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, field) in [
        ("side_m: 0.06", "side_m: -0.06", "5:24: defaults.side_m: "),
        (
            "gain_1_s: 30.0",
            "gain_1_s: -30.0",
            "5:62: defaults.servo.law.gain_1_s: ",
        ),
        // A module's own value stays its own.
        (
            "mass_kg: 0.03",
            "mass_kg: -0.03",
            "7:47: modules[0].kind.mass_kg: ",
        ),
    ] {
        let error = checked(folder.path(), &tripod().replacen(from, to, 1));
        assert!(error.contains(field), "{error}");
    }
}

#[test]
fn the_error_says_to_which_folder_a_relative_path_belongs() {
    let folder = tempfile::tempdir().unwrap();
    let study = std::fs::read_to_string(project().join("sweeps/tripod_floor.ron")).unwrap();
    let error = checked(folder.path(), &study);
    assert!(
        error.contains("relative paths in a study start at the study's folder"),
        "{error}"
    );
    assert!(!error.contains("current folder"), "{error}");
    // The robot is there now, the recordings are not.
    let robot = project().join("morphologies/tripod.ron");
    let study = study.replace("../morphologies/tripod.ron", robot.to_str().unwrap());
    let error = checked(folder.path(), &study);
    assert!(
        error.contains("a glob in a study file starts at that file's folder"),
        "{error}"
    );
    let (error, _) = said(&[
        "sweep",
        "sweeps/tripod_floor.ron",
        "--recordings",
        "nowhere/*.csv",
    ]);
    assert!(
        error.contains("the glob starts at the current folder"),
        "{error}"
    );
}

#[test]
fn a_random_genome_can_be_printed_as_json() {
    let out = realgap()
        .args([
            "robot",
            "genome",
            "random",
            "--modules",
            "2",
            "--format",
            "json",
        ])
        .assert()
        .success();
    let genome: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
    assert_eq!(genome["name"], "random_2_1");
    assert_eq!(genome["genes"].as_array().unwrap().len(), 2);
    assert!(genome["develops"].is_boolean());
}

#[test]
fn reports_print_readable_units_and_names() {
    // Every report writes a unit through this.
    assert_eq!(serde_json::to_string(&Unit::Metre).unwrap(), "\"m\"");
    assert_eq!(serde_json::to_string(&Unit::One).unwrap(), "\"1\"");
    let json = |file: &str| -> serde_json::Value {
        let out = realgap()
            .args(["check", file, "--format", "json"])
            .assert()
            .success();
        serde_json::from_slice(&out.get_output().stdout).unwrap()
    };
    assert_eq!(json("sweeps/tripod_self.ron")[0]["contents"]["unit"], "m");
    let robot = json("morphologies/tripod.ron");
    assert_eq!(robot[0]["contents"]["track"], "core");
}

#[test]
fn a_command_that_only_reads_gives_no_advice_about_runs() {
    let folder = tempfile::tempdir().unwrap();
    let store = folder.path().join("results.sqlite");
    std::fs::write(&store, "no database").unwrap();
    let (error, code) = said(&["study", "results", folder.path().to_str().unwrap()]);
    assert_eq!(code, 1);
    for option in ["--resume", "--restart", "-o"] {
        assert!(!error.contains(option), "{error}");
    }
    assert!(error.contains("backup"), "{error}");
}

#[test]
fn progress_does_not_stand_still_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = quick_study(folder.path(), 2);
    let overrides = Overrides {
        metric: Some(realgap::comparison::by_name("rms").unwrap()),
        limit_recordings: Some(1),
        ..Overrides::default()
    };
    let study = Study::new(Definition::read(&path, &overrides).unwrap()).unwrap();
    let heard = Mutex::new(Vec::new());
    let listen = |progress: Progress| heard.lock().unwrap().push(progress);
    let run = RunOptions {
        jobs: 1,
        progress: Some(&listen),
        ..RunOptions::default()
    };
    study.sweep(&run).unwrap();
    let heard = heard.into_inner().unwrap();
    let [.., counted, last] = heard.as_slice() else {
        panic!("{heard:?}");
    };
    assert!(counted.done > 0 && last.done == last.total && last.total > 0);
    assert!(last.finishing.is_some_and(|what| what.contains("audit")));
}

#[test]
fn evaluate_refuses_paths_without_orientations_and_suggests_other_commands() {
    let study = project().join("sweeps/two_wheel_us1.ron");
    let (error, code) = said(&["evaluate", study.to_str().unwrap()]);
    assert_eq!(code, 1, "{error}");
    for words in ["lack", "realgap gap ", "realgap ensemble "] {
        assert!(error.contains(words), "`{words}` is missing\n{error}");
    }
}

#[test]
fn without_an_audit_the_answer_is_the_same_and_says_that_nothing_checked_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = quick_study(folder.path(), 2);
    let answer = |options: &[&str]| {
        let out = folder.path().join("results");
        let study = path.to_str().unwrap();
        let args = ["sweep", study, "--metric", "rms", "--format", "json", "-o"];
        let args = [&args[..], &[out.to_str().unwrap()], options].concat();
        let out = realgap().args(args).assert().success();
        serde_json::from_slice::<serde_json::Value>(&out.get_output().stdout).unwrap()
    };
    let quick = answer(&["--no-audit"]);
    assert!(
        quick["audit"].is_null() && quick["fit"].is_null(),
        "{quick}"
    );
    let codes = |answer: &serde_json::Value| answer["warnings"].to_string();
    assert!(codes(&quick).contains("not-audited"));
    // The runs are kept, and the audit is made up for.
    let whole = answer(&["--resume"]);
    assert!(
        whole["audit"]["rows"]
            .as_array()
            .is_some_and(|rows| !rows.is_empty())
    );
    assert!(!codes(&whole).contains("not-audited"));
    assert_eq!(quick["best"], whole["best"]);
}
