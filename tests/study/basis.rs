//! A basis is kept, so that scores of other runs can be compared with it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::Path;

use crate::common::{quick_study, read, realgap, summary, text};

fn sweep(study: &Path, out: &Path, more: &[&str]) -> String {
    let said = realgap()
        .arg("sweep")
        .arg(study)
        // Where waves of further runs go depends on the basis of the runs so far; single runs have none.
        .args(["--score", "single", "-o"])
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
