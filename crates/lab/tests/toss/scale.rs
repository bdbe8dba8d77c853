//! Recordings with a wrong length scale: when the study states that scale, all results are those of recordings with true lengths.

use std::path::Path;

use realgap_identification::StartState;
use realgap_lab::calibration::{Overrides, Scores, Study};
use realgap_optimization::RunOptions;
use realgap_path::comparison::by_name;
use realgap_simulation::parameter::ParameterSet;

use super::standin::{EXACT, Tracker, cube, tosses, write};

const STUDY: &str = r#"Study(
    morphology: "MORPHOLOGY",
    start: FromRecording,
    timestep_s: 0.003378,
    set: {"floor.friction": 0.2},
    parameters: [(name: "floor.restitution", from: 0.1, to: 0.4, points: 2)],
)"#;

fn study(folder: &Path, glob: &str, metric: &str, start: StartState, scale: &str) -> Study {
    let definition = folder.join("study.ron");
    let morphology = crate::common::project().join("morphologies/cube.ron");
    let morphology = morphology.to_str().unwrap();
    std::fs::write(&definition, STUDY.replace("MORPHOLOGY", morphology)).unwrap();
    let overrides = Overrides {
        recordings: vec![glob.to_owned()],
        metric: Some(by_name(metric).unwrap()),
        start_state: Some(start),
        set: [format!("recording.length_scale={scale}").parse().unwrap()]
            .into_iter()
            .collect(),
        ..Overrides::default()
    };
    Study::read(definition, &overrides).unwrap()
}

#[test]
fn recordings_divided_by_their_length_scale_give_the_scores_and_errors_of_true_lengths() {
    let half = Tracker {
        length_scale: 0.5,
        ..EXACT
    };
    let (right, short) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let right_glob = write(right.path(), &tosses(&cube(), &EXACT, 3));
    let short_glob = write(short.path(), &tosses(&cube(), &half, 3));
    for metric in ["pose", "pca", "rms", "displacement"] {
        for start in [
            StartState::FirstSample,
            StartState::HalfSampleCorrected,
            StartState::Flight,
        ] {
            let a = study(right.path(), &right_glob, metric, start, "1");
            let b = study(short.path(), &short_glob, metric, start, "0.5");
            let score = |p: &Study| {
                let trials = [p.simulate(0).unwrap(), p.simulate(1).unwrap()];
                let scores = Scores::new(p, &trials).unwrap();
                let points: Vec<f64> = scores
                    .points
                    .iter()
                    .flat_map(|point| [point.score.unwrap(), point.displacement_error_m.unwrap()])
                    .collect();
                points
            };
            for (x, y) in score(&a).iter().zip(score(&b)) {
                assert!(
                    (x - y).abs() < 1e-6 * (1.0 + x),
                    "{metric} {start:?}: {x} {y}"
                );
            }
        }
    }
    let a = study(
        right.path(),
        &right_glob,
        "pose",
        StartState::FirstSample,
        "1",
    );
    let b = study(
        short.path(),
        &short_glob,
        "pose",
        StartState::FirstSample,
        "0.5",
    );
    let none = ParameterSet::new();
    let (a, b) = (
        a.evaluate(&none, &RunOptions::default()).unwrap(),
        b.evaluate(&none, &RunOptions::default()).unwrap(),
    );
    assert!((a.position_percent.mean - b.position_percent.mean).abs() < 1e-5);
    assert_eq!(a.resting_faces, b.resting_faces);
}

#[test]
fn a_wrong_length_scale_changes_the_errors() {
    let folder = tempfile::tempdir().unwrap();
    let glob = write(folder.path(), &tosses(&cube(), &EXACT, 2));
    let mean = |scale: &str| {
        let p = study(folder.path(), &glob, "pose", StartState::FirstSample, scale);
        p.evaluate(&ParameterSet::new(), &RunOptions::default())
            .unwrap()
            .position_percent
            .mean
    };
    assert!((mean("1") - mean("0.978")).abs() > 0.1);
}

#[test]
fn a_start_from_the_flight_is_refused_for_a_walker_and_for_a_settled_start() {
    let folder = tempfile::tempdir().unwrap();
    let glob = write(folder.path(), &tosses(&cube(), &EXACT, 1));
    let path = folder.path().join("walker.ron");
    let read = |text: String| {
        std::fs::write(&path, text).unwrap();
        let overrides = Overrides {
            recordings: vec![glob.clone()],
            ..Overrides::default()
        };
        Study::read(&path, &overrides)
    };
    let walker = crate::common::project().join("morphologies/tripod.ron");
    let walker = walker.to_str().unwrap();
    let text = STUDY.replace("MORPHOLOGY", walker).replace(
        "start: FromRecording,",
        "start: FromRecording, start_state: Flight,",
    );
    let error = read(text.clone()).unwrap_err().to_string();
    assert!(
        error.contains("walker.ron: start_state") && error.contains("servos"),
        "{error}"
    );
    let error = read(text.replace("FromRecording", "Settled"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("start_state") && error.contains("FromRecording"),
        "{error}"
    );
}
