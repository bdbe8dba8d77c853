//! Where principal components come from: everything, the recordings alone, or a file; and folds that fit again.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::Path;

use common::{project, quick_study, read, realgap, summary, text};
use realgap::RunOptions;
use realgap::calibration::{BasisRule, Split, Study, StudyBuilder, TuneOptions};
use realgap::comparison;
use realgap::robot::morphology::Morphology;
use realgap::trajectory::Recording;
use realgap::unit::LengthUnit;

fn sweep(study: &Path, out: &Path, more: &[&str]) -> String {
    let said = realgap()
        .arg("sweep")
        .arg(study)
        .arg("-o")
        .arg(out)
        .args(more)
        .assert()
        .success();
    text(&said.get_output().stdout)
}

#[test]
fn the_basis_of_one_study_makes_the_scores_of_another_comparable() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    let [first, second, third] = ["first", "second", "third"].map(|name| folder.path().join(name));
    sweep(&study, &first, &[]);
    let saved = first.join("basis.json").display().to_string();
    // The same points again with the same basis are the same scores; with a grid of its own a study has a basis of its own.
    sweep(&study, &second, &["--basis", &saved]);
    sweep(&study, &third, &["--points", "3"]);
    assert_eq!(read(&first, "points.csv"), read(&second, "points.csv"));
    assert_eq!(read(&first, "basis.json"), read(&second, "basis.json"));
    assert_ne!(read(&first, "basis.json"), read(&third, "basis.json"));
    let provenance = summary(&second)["provenance"]["basis"].to_string();
    assert!(provenance.contains("saved, sha256 "), "{provenance}");
    assert!(
        std::fs::metadata(first.join("components.png"))
            .unwrap()
            .len()
            > 5_000
    );
}

#[test]
fn a_basis_of_the_recordings_alone_does_not_depend_on_what_was_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2);
    let [coarse, fine] = ["coarse", "fine"].map(|name| folder.path().join(name));
    sweep(&study, &coarse, &["--basis", "recordings"]);
    sweep(&study, &fine, &["--basis", "recordings", "--points", "3"]);
    assert_eq!(read(&coarse, "basis.json"), read(&fine, "basis.json"));
    // One recording has no components: refused before any work, with the remedy.
    let refused = realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--basis", "recordings", "--limit-recordings", "1", "-o"])
        .arg(folder.path().join("one"))
        .assert()
        .code(1);
    let error = text(&refused.get_output().stderr);
    assert!(
        error.contains("at least two different recordings"),
        "{error}"
    );
}

#[test]
fn a_comparison_writes_its_basis_and_takes_one() {
    let folder = tempfile::tempdir().unwrap();
    let runs = |count: usize| -> Vec<String> {
        let name = |k| format!("real_trajectories/tripod_standin/run_{k:02}.csv");
        (0..count).map(name).collect()
    };
    let compare = |count: usize, more: &[&str]| {
        let said = realgap()
            .arg("compare")
            .args(runs(count))
            .args(["--metric", "pca", "--format", "json"])
            .args(more)
            .assert()
            .success();
        let rows: serde_json::Value = serde_json::from_slice(&said.get_output().stdout).unwrap();
        rows[0]["pca_coefficients_m"].as_f64().unwrap()
    };
    let file = folder.path().join("basis.json").display().to_string();
    let plane = folder.path().join("plane.png").display().to_string();
    let of_eight = compare(8, &["--save-basis", &file, "--plane", &plane]);
    let of_three = compare(3, &[]);
    assert_ne!(of_three, of_eight);
    assert_eq!(compare(3, &["--basis", &file]), of_eight);
    assert!(std::fs::metadata(&plane).unwrap().len() > 5_000);
    std::fs::write(&file, "{}").unwrap();
    let refused = realgap()
        .arg("compare")
        .args(runs(3))
        .args(["--basis", &file])
        .assert()
        .code(1);
    let error = text(&refused.get_output().stderr);
    assert!(error.contains("not a saved basis"), "{error}");
}

fn recording(number: usize) -> Recording {
    let file = format!("real_trajectories/tripod_standin/run_{number:02}.csv");
    realgap::trajectory::read(project().join(file), LengthUnit::Metre).unwrap()
}

/// A study of a second with these recordings.
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
fn folds_of_tuning_are_what_tuning_without_them_finds() {
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
        // Runs beyond the budget belong to the answer, not to the search for it.
        let searched = alone.scores.runs.iter().filter(|run| run.index < 20);
        let best = searched.min_by(|a, b| a.score.unwrap().total_cmp(&b.score.unwrap()));
        let best = best.unwrap();
        assert_eq!(fold.values, best.values);
        assert!((fold.fit_score - best.score.unwrap()).abs() < 1e-15);
    }
}

#[test]
fn whitened_scores_need_repeats_and_say_so() {
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
    // Another engine's tripod is farther from these recordings than they are from each other.
    assert!(best.score.unwrap() > 1.0, "{best:?}");
    let alone = study(&[0]).basis(BasisRule::Recordings);
    let pca = comparison::by_name("pca").unwrap();
    assert!(alone.metric(pca).build().is_err());
}
