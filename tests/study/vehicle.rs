//! Studies of the two-wheel robot like of any other.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

#[test]
fn a_study_names_one_robot_and_a_condition_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let root = common::project().display();
    let runs = folder.path().join("runs.csv");
    let mut text = String::from("condition,run,t_s,x_m,y_m\n");
    for (condition, speed) in [("slow", 0.1), ("fast", 0.21)] {
        for run in 0..3 {
            for k in 0..12 {
                let t = 0.1 * f64::from(k);
                text += &format!(
                    "{condition},{run},{t},{},{}\n",
                    0.36 + speed * t,
                    0.51 + 0.001 * f64::from(run) * t
                );
            }
        }
    }
    std::fs::write(&runs, text).unwrap();
    let study = |condition: &str, more: &str| {
        common::study(
            folder.path(),
            &format!(
                "vehicle: (file: \"{root}/vehicles/two_wheel.ron\"), {more}
                condition: \"{condition}\", start: Settled, duration_s: 1.0, metric: \"rms\", score: Single,
                parameters: [(name: \"vehicle.speed_m_s\", from: 0.05, to: 0.25, points: 5)],
                noise: (camera: (position_m: Normal(0.0005))),"
            ),
        )
    };
    let ensemble = |study: &std::path::Path| {
        common::realgap()
            .args([
                "ensemble",
                study.to_str().unwrap(),
                "--recordings",
                runs.to_str().unwrap(),
                "--repeats",
                "40",
                "--format",
                "json",
                "-o",
            ])
            .arg(folder.path().join("out"))
            .output()
            .unwrap()
    };
    let output = ensemble(&study("fast", ""));
    assert!(output.status.success(), "{}", common::text(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let reality = &found["ensembles"][0]["reality"];
    let reality = if reality.is_null() {
        &found["reality"]
    } else {
        reality
    };
    assert_eq!(
        reality["runs"].as_array().map(Vec::len),
        Some(3),
        "{}",
        common::text(&output.stdout)
    );
    let output = ensemble(&study("quick", ""));
    assert!(
        common::text(&output.stderr).contains("fast, slow"),
        "{}",
        common::text(&output.stderr)
    );
    let output = ensemble(&study(
        "fast",
        &format!("morphology: \"{root}/morphologies/cube.ron\","),
    ));
    assert!(common::text(&output.stderr).contains("one robot"));
    // A sweep finds the speed of the recordings.
    let output = common::realgap()
        .args([
            "sweep",
            study("slow", "").to_str().unwrap(),
            "--recordings",
            runs.to_str().unwrap(),
            "--format",
            "json",
            "-o",
        ])
        .arg(folder.path().join("swept"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", common::text(&output.stderr));
    let best = common::read(&folder.path().join("swept"), "best.ron");
    assert!(
        best.contains("0.1,") || best.contains("0.1\n") || best.contains(": 0.1"),
        "{best}"
    );
}

/// The shipped studies against the real runs, all of them: those that were held out are in docs/validation/sensing.md.
#[test]
fn real_runs_lie_where_the_shipped_studies_put_them() {
    let Some(folder) = common::shared_data("two_wheel_runs") else {
        return;
    };
    let runs = folder.join("runs.csv");
    let out = tempfile::tempdir().unwrap();
    let mut good = 0;
    for condition in ["us1", "us_bayesian", "ir", "ir_bayesian"] {
        let study = format!("sweeps/two_wheel_{condition}.ron");
        let output = common::realgap()
            .args([
                "ensemble",
                &study,
                "--recordings",
                runs.to_str().unwrap(),
                "--format",
                "json",
                "-o",
            ])
            .arg(out.path().join(condition))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let coverage = found["reality"]["coverage"].as_array().unwrap();
        let inside = coverage[2]["over_time"].as_f64().unwrap();
        assert!(inside > 0.7, "{condition}: {inside}");
        good += usize::from((0.8..=0.97).contains(&inside));
    }
    assert!(good >= 3, "{good} of 4");
}
