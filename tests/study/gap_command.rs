//! `realgap gap` on folders of recordings and on studies.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::{Path, PathBuf};

use realgap::prediction::ensemble;
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Distribution, Experiment, Noise, Sampling};
use realgap::trajectory::write;
use serde_json::Value;

/// Ten stand-ins of the tripod made by realgap with this noise, in `folder`.
fn stand_ins(folder: &Path, noise: &Noise) {
    let file = common::project().join("morphologies/tripod.ron");
    let mut experiment = Experiment::new(Morphology::read(file).unwrap().assemble());
    experiment.duration_s = 3.0;
    experiment.sampling = Sampling::Rate(60.0);
    for number in 0..10 {
        let run = ensemble::repeat(&experiment, noise, 77, number).unwrap();
        let file = folder.join(format!("run_{number:02}.csv"));
        write(file, &run.outcome.completed().unwrap()).unwrap();
    }
}

/// A study of these stand-ins with the same noise.
fn study_of(folder: &Path) -> PathBuf {
    common::study(
        folder,
        &format!(
            "morphology: \"{}/morphologies/tripod.ron\",
    recordings: [\"*.csv\"],
    start: Settled,
    duration_s: 3.0,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 3)],
    noise: Noise(servo_phase_rad: Normal(0.1), start_tilt_rad: Normal(0.0175)),",
            common::project().display()
        ),
    )
}

fn gap_json(study: &Path, folder: &Path, more: &[&str]) -> Value {
    let mut command = common::realgap();
    command.arg("gap").arg(study).arg("-o").arg(folder);
    command
        .args(["--repeats", "30", "--format", "json"])
        .args(more);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", common::text(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: Value = serde_json::from_str(&common::read(folder, "gap.json")).unwrap();
    assert_eq!(printed, written);
    printed
}

#[test]
fn stand_ins_of_known_noise_are_one_noise_floor_away_and_a_wrong_floor_is_more() {
    let folder = tempfile::tempdir().unwrap();
    let noise = Noise {
        servo_phase_rad: Distribution::Normal(0.1),
        start_tilt_rad: Distribution::Normal(0.0175),
        ..Noise::default()
    };
    stand_ins(folder.path(), &noise);
    let study = study_of(folder.path());
    let out = folder.path().join("truth");
    let truth = gap_json(&study, &out, &["--jobs", "1"]);
    let ratio = &truth["metrics"][0]["repeats"]["ratio"];
    assert_eq!(truth["metrics"][0]["metric"], "pca");
    let [low, high] = ["low", "high"].map(|end| ratio[end].as_f64().unwrap());
    assert!(low < 1.0 && 1.0 < high, "{ratio}");
    let confidence = truth["confidence"]["over_time"].as_f64().unwrap();
    assert!(confidence > 0.75, "{confidence}");
    // With few recordings the confidence may dip at one instant, but not surely.
    assert!(truth["confidence"]["surely_below_half_s"].is_null());
    for picture in ["confidence.png", "confidence.svg", "rmse.png", "rmse.svg"] {
        assert!(out.join(picture).metadata().unwrap().len() > 1000);
    }
    // The same bits on other threads.
    let again = folder.path().join("again");
    gap_json(&study, &again, &["--jobs", "2"]);
    for file in ["gap.json", "rmse.svg", "confidence.svg"] {
        assert_eq!(common::read(&out, file), common::read(&again, file));
    }
    // Slippery instead of the default floor.
    let wrong = gap_json(
        &study,
        &folder.path().join("wrong"),
        &["--set", "floor.friction=0.05"],
    );
    let wrong_ratio = &wrong["metrics"][0]["repeats"]["ratio"];
    assert!(
        wrong_ratio["low"].as_f64().unwrap() > 1.5,
        "{wrong_ratio} where the truth has {ratio}"
    );
    let [first_s, surely_s] = ["below_half_s", "surely_below_half_s"]
        .map(|field| wrong["confidence"][field].as_f64().unwrap());
    assert!(first_s <= surely_s, "{first_s} {surely_s}");
    assert!(wrong["confidence"]["over_time"].as_f64().unwrap() < confidence);
    // The noise floor comes from the recordings and does not depend on the simulation.
    assert_eq!(wrong["metrics"][0]["floor"], truth["metrics"][0]["floor"]);
}

#[test]
fn a_study_without_noise_has_a_gap_but_no_confidence_and_leaves_no_old_picture() {
    let folder = tempfile::tempdir().unwrap();
    let study = common::quick_study(folder.path(), 2);
    let out = folder.path().join("out");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("confidence.png"), "old").unwrap();
    // A folder that results were written into before.
    std::fs::write(out.join(".lock"), "").unwrap();
    let zero = folder.path().join("zero.ron");
    std::fs::write(&zero, "()").unwrap();
    let zero = zero.display().to_string();
    for more in [
        &["--metric", "frechet", "--metric", "rms"][..],
        &["--metric", "frechet", "--metric", "rms", "--noise", &zero],
    ] {
        let found = gap_json(&study, &out, more);
        assert!(found["confidence"].is_null());
        assert_eq!(found["repeats"], 0);
        assert_eq!(found["metrics"].as_array().unwrap().len(), 2);
        assert!(
            found["metrics"][0]["ideal"]["ratio"]["value"]
                .as_f64()
                .unwrap()
                > 0.0
        );
        assert!(found["metrics"][0]["repeats"].is_null());
        let codes: Vec<&str> = found["warnings"]
            .as_array()
            .unwrap()
            .iter()
            .map(|w| w["code"].as_str().unwrap())
            .collect();
        assert!(
            codes.contains(&"no-noise") && codes.contains(&"stand-in"),
            "{codes:?}"
        );
        assert!(!out.join("confidence.png").exists());
        assert!(out.join("rmse.png").exists());
    }
}

#[test]
fn the_shipped_stand_ins_have_a_noise_floor_without_a_study() {
    let output = common::realgap()
        .args([
            "gap",
            "--recordings",
            "real_trajectories/tripod_mujoco/*.csv",
        ])
        .output()
        .unwrap();
    let (out, err) = (common::text(&output.stdout), common::text(&output.stderr));
    assert!(output.status.success(), "{err}");
    assert!(
        out.contains("all recordings") && out.contains("10"),
        "{out}"
    );
    assert!(err.contains("[stand-in]"), "{err}");
}

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let long = folder.path().join("runs.csv");
    let rows = "condition,run,t_s,x_m,y_m\na,1,0,0,0\na,1,1,1,0\nb,1,0,0,0\nb,1,1,1,0\n";
    std::fs::write(&long, rows).unwrap();
    let long = long.display().to_string();
    let standin = "real_trajectories/tripod_standin/run_00.csv";
    for (arguments, code, words) in [
        (vec![], 2, vec!["recordings must be named"]),
        (
            vec!["--recordings", "nowhere/*.csv"],
            1,
            vec!["no file matches"],
        ),
        (
            vec!["--recordings", standin],
            1,
            vec!["1 recording", "two or more"],
        ),
        (
            vec!["--recordings", &long],
            1,
            vec!["2 recordings", "two or more"],
        ),
        (
            vec!["--recordings", &long, "--group", "robot"],
            1,
            vec!["unknown column", "robot", "condition, run, t_s"],
        ),
        (
            vec!["--recordings", &long, "--group", "run"],
            2,
            vec!["distinguishes the repeats"],
        ),
        (
            vec!["--recordings", standin, "--group", "condition"],
            1,
            vec!["unknown column"],
        ),
        (
            vec!["--recordings", standin, "--metric", "rsm"],
            2,
            vec!["unknown metric", "rms"],
        ),
        (
            vec!["sweeps/tripod_floor.ron", "--metric", "rsm"],
            2,
            vec!["unknown metric", "rms"],
        ),
        (
            vec![
                "--recordings",
                "real_trajectories/tripod_standin/*.csv",
                "--metric",
                "pose",
            ],
            1,
            vec!["body length"],
        ),
        (
            vec!["--recordings", standin, "--set", "floor.friction=0.3"],
            2,
            vec!["without a study"],
        ),
        (
            vec!["sweeps/tripod_floor.ron", "--repeats", "0"],
            2,
            vec!["repeats"],
        ),
        (
            vec!["sweeps/tripod_floor.ron", "--group", "condition"],
            2,
            vec!["cannot be used with"],
        ),
    ] {
        let output = common::realgap()
            .arg("gap")
            .args(&arguments)
            .output()
            .unwrap();
        let text = common::text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
        for word in words {
            assert!(text.contains(word), "{arguments:?}: {text}");
        }
    }
}
