//! The source of principal components (all paths, the recordings alone, or a file), and cross-validation that refits each fold.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::project;
use realgap_core::unit::LengthUnit;
use realgap_lab::calibration::{BasisRule, Split, Study, StudyBuilder, TuneOptions};
use realgap_optimization::RunOptions;
use realgap_path::comparison;
use realgap_path::trajectory::Recording;
use realgap_robot::morphology::Morphology;

fn recording(number: usize) -> Recording {
    let file = format!("real_trajectories/tripod_standin/run_{number:02}.csv");
    realgap_path::trajectory::read(project().join(file), LengthUnit::Metre).unwrap()
}

/// A study of one second with these recordings.
fn study(recordings: &[usize]) -> StudyBuilder {
    let robot = Morphology::read(project().join("morphologies/tripod.ron")).unwrap();
    let study = Study::builder("folds", robot)
        .duration_s(1.0)
        .vary("floor.friction", 0.1, 0.9, 9)
        .metric(comparison::by_name("rms").unwrap())
        .set("timestep_s", 1.0 / 240.0)
        .set("solver.joint", 0.0);
    let each = recordings.iter();
    each.fold(study, |study, number| study.recording(recording(*number)))
}

#[test]
fn each_fold_of_a_tuning_equals_a_tuning_without_the_held_out_recordings() {
    let options = TuneOptions {
        budget: 20,
        ..TuneOptions::default()
    };
    let run = RunOptions::default();
    let all = [0, 1, 2, 3];
    let folded = study(&all).split(Split::Folds(2)).build().unwrap();
    let answer = folded.tune(&options, &run).unwrap();
    let folds = answer.report.validation.unwrap().folds;
    assert_eq!(folds.len(), 2);
    for fold in folds {
        let is_fitted = |number: &&usize| !fold.held_out.contains(&format!("run_{number:02}"));
        let fitted: Vec<usize> = all.iter().filter(is_fitted).copied().collect();
        assert_eq!(fitted.len(), 2);
        let alone = study(&fitted)
            .build()
            .unwrap()
            .tune(&options, &run)
            .unwrap();
        // Runs beyond the budget of 20 assess the uncertainty of the answer; the optimizer did not propose them.
        let searched = alone.scores.runs.iter().filter(|run| run.index < 20);
        let best = searched.min_by(|a, b| a.score.unwrap().total_cmp(&b.score.unwrap()));
        let best = best.unwrap();
        assert_eq!(fold.values, best.values);
        assert!((fold.fit_score - best.score.unwrap()).abs() < 1e-15);
    }
}

#[test]
fn whitened_scores_are_refused_without_at_least_two_repeats() {
    let whitened = comparison::by_name("pca-whitened").unwrap();
    let error = study(&[0])
        .metric(whitened)
        .build()
        .unwrap_err()
        .to_string();
    assert!(error.contains("at least two repeats"), "{error}");
    let answer = study(&[0, 1, 2])
        .metric(whitened)
        .build()
        .unwrap()
        .sweep(&RunOptions::default())
        .unwrap();
    let best = &answer.scores.points[answer.scores.best.unwrap()];
    // The recordings come from another engine: the simulated tripod is farther from them than they are from each other.
    assert!(best.score.unwrap() > 1.0, "{best:?}");
    let alone = study(&[0]).basis(BasisRule::Recordings);
    let pca = comparison::by_name("pca").unwrap();
    assert!(alone.metric(pca).build().is_err());
}
