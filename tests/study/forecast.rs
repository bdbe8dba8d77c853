//! `realgap ensemble` and `realgap predict`, as a user runs them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{project, realgap, text};
use serde_json::Value;

const NOISE: &str =
    "noise: (start_heading_rad: Normal(0.02), friction_run_relative: LogNormal(0.1)),";

/// The tripod for one second, with this noise section.
fn study(folder: &Path, more: &str) -> PathBuf {
    let root = project().display();
    common::study(
        folder,
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    start: Settled,
    duration_s: 1.0,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9)],
    {more}"
        ),
    )
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

#[test]
fn an_ensemble_of_a_study_prints_and_writes_its_forecast() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), NOISE);
    let mut written = Vec::new();
    for jobs in ["1", "2"] {
        let results = folder.path().join(jobs);
        let output = realgap()
            .arg("ensemble")
            .arg(&study)
            .args(["--repeats", "8", "--jobs", jobs, "--format", "json"])
            .args(["--model-error", "off", "-o"])
            .arg(&results)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        for file in [
            "ensemble.json",
            "repeats.csv",
            "ensemble.png",
            "ensemble.svg",
        ] {
            assert!(results.join(file).metadata().unwrap().len() > 500, "{file}");
        }
        let report = json(&output.stdout);
        assert_eq!(report["complete"], true);
        let case = &report["cases"][0];
        assert_eq!(case["summary"]["repeats"], 8);
        assert_eq!(case["reality"]["runs"].as_array().unwrap().len(), 10);
        assert_eq!(
            case["summary"]["noise"]["start_heading_rad"]["Normal"],
            0.02
        );
        let codes = report["warnings"].to_string();
        assert!(
            codes.contains("few-repeats") && codes.contains("stand-in"),
            "{codes}"
        );
        written.push(common::read(&results, "repeats.csv"));
    }
    assert_eq!(written[0], written[1]);
    assert_eq!(written[0].lines().count(), 9);
    assert!(written[0].starts_with("case,repeat,seed,status,behaviour,net_displacement_m"));
}

#[test]
fn a_repeat_replayed_alone_goes_as_far_as_in_the_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), NOISE);
    let results = folder.path().join("results");
    realgap()
        .arg("ensemble")
        .arg(&study)
        .args(["--repeats", "4", "--model-error", "off", "-o"])
        .arg(&results)
        .assert()
        .success();
    let rows = common::read(&results, "repeats.csv");
    let row: Vec<&str> = rows.lines().nth(4).unwrap().split(',').collect();
    assert_eq!(row[1], "3");
    let alone = folder.path().join("alone.csv");
    realgap()
        .arg("ensemble")
        .arg(&study)
        .args(["--only", "3", "-o"])
        .arg(&alone)
        .assert()
        .success();
    let motion = realgap::trajectory::read(&alone, realgap::unit::LengthUnit::Metre).unwrap();
    let net_m = realgap::trajectory::prepare(&motion.trajectory)
        .unwrap()
        .net_displacement_m();
    assert!((net_m - row[5].parse::<f64>().unwrap()).abs() < 1e-12);
}

#[test]
fn a_study_without_noise_is_refused_with_a_section_to_copy_and_zero_noise_is_warned_about() {
    let folder = tempfile::tempdir().unwrap();
    let output = realgap()
        .arg("ensemble")
        .arg(study(folder.path(), ""))
        .args(["--repeats", "2", "--model-error", "off", "-o"])
        .arg(folder.path().join("a"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let error = text(&output.stderr);
    assert!(
        error.contains("noise") && error.contains("Normal(0.0175)"),
        "{error}"
    );
    let output = realgap()
        .arg("ensemble")
        .arg(study(folder.path(), "noise: (),"))
        .args(["--repeats", "2", "--model-error", "off", "-o"])
        .arg(folder.path().join("b"))
        .output()
        .unwrap();
    assert!(output.status.success());
    assert!(text(&output.stderr).contains("[no-noise]"));
    assert!(common::read(&folder.path().join("b"), "ensemble.json").contains("no-noise"));
}

#[test]
fn every_recording_with_its_own_start_has_an_ensemble_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let root = project().display();
    let study = common::study(
        folder.path(),
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    start: FromRecording,
    duration_s: 0.5,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9)],
    {NOISE}"
        ),
    );
    let output = realgap()
        .arg("ensemble")
        .arg(&study)
        .args([
            "--repeats",
            "4",
            "--limit-recordings",
            "2",
            "--format",
            "json",
            "-o",
        ])
        .arg(folder.path().join("results"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report = json(&output.stdout);
    let cases = report["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 2);
    let second = folder.path().join("results/ensemble_001.png");
    assert!(second.is_file());
    // A picture does not outlive its recording.
    realgap()
        .arg("ensemble")
        .arg(&study)
        .args(["--repeats", "2", "--limit-recordings", "1", "-o"])
        .arg(folder.path().join("results"))
        .assert()
        .success();
    assert!(!second.exists());
    assert_eq!(cases[1]["case"], "run_01");
    assert_eq!(report["reality"]["runs"].as_array().unwrap().len(), 2);
    // Which of the two should be replayed?
    realgap()
        .arg("ensemble")
        .arg(&study)
        .args(["--only", "1", "--limit-recordings", "2", "-o"])
        .arg(folder.path().join("alone.csv"))
        .assert()
        .code(2);
}

#[test]
fn a_prediction_card_says_how_far_how_likely_and_by_which_rule() {
    let folder = tempfile::tempdir().unwrap();
    let output = realgap()
        .args([
            "predict",
            "morphologies/tripod.ron",
            "--duration",
            "2",
            "--repeats",
            "6",
        ])
        .args(["--format", "json", "-o"])
        .arg(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let card = json(&output.stdout);
    assert_eq!(card["success"]["rule"], "half of the run without noise");
    let free_m = card["prediction"]["noise_free_displacement_m"]
        .as_f64()
        .unwrap();
    let least_m = card["success"]["least_displacement_m"].as_f64().unwrap();
    assert!((least_m - 0.5 * free_m).abs() < 1e-15);
    assert!(card["warnings"].to_string().contains("estimated-noise"));
    assert!(card["growth"]["rate_1_s"].as_f64().unwrap() > 0.0);
    for file in [
        "prediction.json",
        "repeats.csv",
        "prediction.png",
        "prediction.svg",
    ] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let table = realgap()
        .args([
            "predict",
            "morphologies/tripod.ron",
            "--duration",
            "2",
            "--repeats",
            "6",
        ])
        .args(["--success-m", "100"])
        .output()
        .unwrap();
    let table = text(&table.stdout);
    for words in [
        "P(success)        0 %",
        "at least 100 m",
        "quantiles",
        "small differences grow by a factor of",
        "as predicted",
        "mm/s",
    ] {
        assert!(table.contains(words), "{words}: {table}");
    }
}

#[test]
fn a_passive_cube_is_legal_and_goes_nowhere() {
    let output = realgap()
        .args([
            "predict",
            "morphologies/cube.ron",
            "--duration",
            "1",
            "--repeats",
            "3",
        ])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("[no-success-rule]"));
}

#[test]
fn bad_input_is_refused_with_the_allowed_values() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("noise.ron");
    std::fs::write(&bad, "(\n    mass_relative: Normal(-0.1),\n)").unwrap();
    let bad = bad.display().to_string();
    for (args, code, words) in [
        (vec!["--repeats", "0"], 2, "1..=5000"),
        (vec!["--success-m", "-1"], 2, "more than 0 m"),
        (vec!["--duration", "0"], 2, "0.001 to 86400"),
        (vec!["--noise", &bad], 1, "noise.ron:2:"),
        (vec!["--noise", "nowhere.ron"], 1, "nowhere.ron"),
    ] {
        let output = realgap()
            .args(["predict", "morphologies/tripod.ron"])
            .args(&args)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(code), "{args:?}");
        let error = text(&output.stderr);
        assert!(error.contains(words), "{args:?}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_writes_the_results_so_far_marked_as_incomplete() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), NOISE).display().to_string();
    let long = std::fs::read_to_string(&study)
        .unwrap()
        .replace("duration_s: 1.0", "duration_s: 5.0");
    std::fs::write(&study, long).unwrap();
    let results = folder.path().join("results");
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_realgap"))
        .args(["ensemble", &study, "--repeats", "5000", "--jobs", "1", "-o"])
        .arg(&results)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_secs(4));
    let killed = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    let report = json(common::read(&results, "ensemble.json").as_bytes());
    assert_eq!(report["complete"], false);
    let done = report["cases"][0]["summary"]["repeats"].as_u64().unwrap();
    assert!(done > 0 && done < 5000, "{done}");
    assert!(report["warnings"].to_string().contains("incomplete"));
}
