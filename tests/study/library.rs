//! The library as a program uses it: no command line, no results folder. The examples run here too.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

#[path = "../../examples/compare.rs"]
mod compare;
#[path = "../../examples/own_engine.rs"]
mod own_engine;
#[path = "../../examples/own_feedback.rs"]
mod own_feedback;
#[cfg(feature = "papers")]
#[path = "../../examples/own_sensor.rs"]
mod own_sensor;
#[path = "../../examples/predict.rs"]
mod predict;
#[path = "../../examples/sweep.rs"]
mod sweep;
#[path = "../../examples/tune.rs"]
mod tune;

use std::sync::Mutex;

use realgap::calibration::{Answer, Overrides, Study, TuneOptions};
use realgap::comparison::by_name;
use realgap::optimization::optimizer_by_name;
use realgap::results;
use realgap::robot::morphology::Morphology;
use realgap::store::Mode;
use realgap::unit::LengthUnit;
use realgap::{ErrorKind, Progress, RunOptions, trajectory};

#[test]
fn every_example_runs() {
    if !common::is_long_run("the examples") {
        return;
    }
    for example in [
        sweep::main,
        tune::main,
        compare::main,
        predict::main,
        own_feedback::main,
        #[cfg(feature = "papers")]
        own_sensor::main,
        own_engine::main,
    ] {
        example().unwrap();
    }
}

fn quick(metric: &str) -> Study {
    let folder = tempfile::tempdir().unwrap();
    let overrides = Overrides {
        metric: Some(by_name(metric).unwrap()),
        limit_recordings: Some(2),
        ..Overrides::default()
    };
    Study::read(common::quick_study(folder.path(), 3), &overrides).unwrap()
}

fn bits(answer: &Answer) -> String {
    format!(
        "{:?} {:?} {:?} {}",
        answer.scores.points,
        answer.uncertainty,
        answer.draws,
        serde_json::to_string(&answer.report).unwrap()
    )
}

#[test]
fn a_sweep_has_the_same_bits_with_and_without_a_store() {
    let study = quick("pca");
    let folder = tempfile::tempdir().unwrap();
    let one = RunOptions {
        jobs: 1,
        ..RunOptions::default()
    };
    let kept = study.sweep_into(folder.path(), Mode::Start, &one).unwrap();
    let two = RunOptions {
        jobs: 2,
        ..RunOptions::default()
    };
    assert_eq!(bits(&study.sweep(&two).unwrap()), bits(&kept));
}

#[test]
fn tuning_has_the_same_bits_with_and_without_a_store() {
    let study = quick("rms");
    let options = TuneOptions {
        optimizer: optimizer_by_name("cma-es").unwrap(),
        budget: 30,
        patience: None,
    };
    let folder = tempfile::tempdir().unwrap();
    let run = RunOptions::default();
    let kept = study
        .tune_into(folder.path(), Mode::Start, &options, &run)
        .unwrap();
    assert_eq!(bits(&study.tune(&options, &run).unwrap()), bits(&kept));
}

#[test]
fn an_answer_prints_its_report_and_can_be_written_anywhere() {
    let study = quick("rms");
    let heard = Mutex::new(Vec::new());
    let listen = |progress: Progress| {
        if progress.finishing.is_none() {
            heard.lock().unwrap().push(progress.done);
        }
    };
    let run = RunOptions {
        progress: Some(&listen),
        ..RunOptions::default()
    };
    let answer = study.sweep(&run).unwrap();
    // Nine points, and waves of nine where the best may be.
    assert_eq!(heard.lock().unwrap().last(), Some(&27));
    let text = answer.to_string();
    for verdict in &answer.report.verdicts {
        assert!(text.contains(&verdict.text), "{text}");
    }
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("new");
    results::write(&results, &study, &answer).unwrap();
    assert!(results.join("heatmap.png").is_file() && results.join("best.ron").is_file());
    assert!(!results.join("results.sqlite").exists());
}

fn tripod() -> Morphology {
    Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap()
}

fn first_run() -> trajectory::Recording {
    let path = common::project().join("real_trajectories/tripod_standin/run_00.csv");
    trajectory::read(path, LengthUnit::Metre).unwrap()
}

#[test]
fn a_study_made_in_rust_scores_as_the_same_study_from_a_file() {
    // With one recording, the settings contain the noise that the file states, which has no place in the builder.
    let recording = |name: &str| {
        let path = common::project()
            .join("real_trajectories/tripod_mujoco")
            .join(name);
        trajectory::read(path, LengthUnit::Metre).unwrap()
    };
    let built = Study::builder("tripod_floor", tripod())
        .recording(recording("run_00.csv"))
        .recording(recording("run_01.csv"))
        .duration_s(20.0)
        .vary("floor.friction", 0.05, 1.0, 3)
        .vary("floor.restitution", 0.0, 0.9, 3)
        .metric(by_name("rms").unwrap())
        .build()
        .unwrap();
    let overrides = Overrides {
        metric: Some(by_name("rms").unwrap()),
        limit_recordings: Some(2),
        points: Some(3),
        ..Overrides::default()
    };
    let path = common::project().join("sweeps/tripod_floor.ron");
    let read = Study::read(path, &overrides).unwrap();
    assert_eq!(built.simulate(4).unwrap(), read.simulate(4).unwrap());
}

#[test]
fn an_invalid_study_is_refused_with_the_reason() {
    let study = || Study::builder("wrong", tripod()).recording(first_run());
    let refused = |error: realgap::Error, words: &str| {
        assert_eq!(error.kind(), ErrorKind::Invalid);
        assert!(error.to_string().contains(words), "{error}");
    };
    refused(study().build().unwrap_err(), "nothing to vary");
    let unknown = study().vary("floor.fiction", 0.0, 1.0, 3).build();
    refused(unknown.unwrap_err(), "floor.friction");
    let beyond = study()
        .vary("floor.friction", 0.1, 1.0, 3)
        .set("floor.restitution", 2.0)
        .build();
    refused(beyond.unwrap_err(), "floor.restitution");
    let nothing = Study::builder("wrong", tripod())
        .vary("floor.friction", 0.1, 1.0, 3)
        .build();
    refused(nothing.unwrap_err(), "no recordings");
}
