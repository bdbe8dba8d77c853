//! Recordings on which values were fitted are marked as in-sample.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common::{self, project, realgap, text};
use realgap::calibration::read_best;

/// The tripod for half a second on four points, with noise.
fn study(folder: &Path, recordings: &str) -> String {
    let root = project().display();
    let body = format!(
        "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/{recordings}\"],
    start: Settled,
    duration_s: 0.5,
    {}
    metric: \"rms\",
    score: Single,
    parameters: [
        (name: \"floor.friction\", from: 0.1, to: 0.9, points: 2),
        (name: \"floor.restitution\", from: 0.0, to: 0.8, points: 2),
    ],
    noise: (start_heading_rad: Normal(0.02)),",
        common::STANDIN_NUMERICS
    );
    common::study(folder, &body).display().to_string()
}

fn run(arguments: &[&str]) -> String {
    let output = realgap().args(arguments).output().unwrap();
    let said = text(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
    said
}

#[test]
fn recordings_that_the_values_were_fitted_on_are_called_in_sample_and_others_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let study = study(folder.path(), "run_0[0-4].csv");
    run(&["sweep", &study, "--hold-out", "0.4", "-o", &place("fit")]);
    let best = format!("{}/best.ron", place("fit"));
    let fitted = read_best(&best).unwrap();
    assert_eq!(fitted.fitted_on.len(), 3, "two of five were held out");
    assert!(fitted.draws[0].len() > 30, "{:?}", fitted.draws);
    let shipped = project().join("real_trajectories/tripod_standin");
    let others = format!("{}/run_0[5-9].csv", shipped.display());
    for command in ["gap", "ensemble", "evaluate"] {
        let mut known = vec![command, &study, "--parameters", &best];
        let folder = place(command);
        if command != "evaluate" {
            known.extend(["--repeats", "2", "-o", &folder]);
        }
        let said = run(&known);
        assert!(said.contains("fitted on 3 of these 5"), "{command}: {said}");
        assert!(said.contains("[in-sample]"), "{command}: {said}");
        // Repeats draw what the fit left open; a single run has its best point.
        let carried = said.contains("[uncertain-parameters]");
        assert_eq!(carried, command != "evaluate", "{command}: {said}");
        known.extend(["--recordings", &others]);
        let said = run(&known);
        assert!(!said.contains("[in-sample]"), "{command}: {said}");
        assert!(!said.contains("[few-recordings]"), "{command}: {said}");
        known.extend(["--limit-recordings", "3"]);
        let said = run(&known);
        assert!(said.contains("[few-recordings]"), "{command}: {said}");
    }
    // The same samples under another name are the same recording.
    let copy = folder.path().join("copy.csv");
    std::fs::copy(shipped.join("run_00.csv"), &copy).unwrap();
    std::fs::copy(shipped.join("meta.ron"), folder.path().join("meta.ron")).unwrap();
    let all: Vec<usize> = (0..5)
        .filter(|number| {
            std::fs::copy(shipped.join(format!("run_0{number}.csv")), &copy).unwrap();
            let copy = copy.display().to_string();
            let said = run(&[
                "evaluate",
                &study,
                "--parameters",
                &best,
                "--recordings",
                &copy,
            ]);
            said.contains("fitted on 1 of these 1")
        })
        .collect();
    assert_eq!(all.len(), 3, "{all:?}");
}
