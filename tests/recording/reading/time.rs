//! The same way at another speed is another run.

use realgap::calibration::{Definition, Overrides, Study};

use super::common::{project, realgap, study, text};
use super::{file, own_form, walk};

#[test]
fn a_path_at_another_speed_is_not_the_same_run() {
    let folder = tempfile::tempdir().unwrap();
    let fast = file(folder.path(), "fast.csv", &own_form(&walk()));
    let slow: Vec<[f64; 4]> = walk()
        .iter()
        .map(|[t, x, y, a]| [t / 0.7, *x, *y, *a])
        .collect();
    let slow = file(folder.path(), "slow.csv", &own_form(&slow));
    let compare = |options: &[&str]| {
        let out = realgap()
            .arg("compare")
            .args([&fast, &slow])
            .args(["--metric", "rms", "--format", "json"])
            .args(options)
            .assert()
            .success();
        let rows: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
        let said = text(&out.get_output().stderr);
        (rows[0]["rms_m"].as_f64().unwrap(), said, rows)
    };
    let (rms_m, said, _) = compare(&["--time", "fraction"]);
    assert!(rms_m < 1e-9);
    assert!(
        said.contains("different-durations") && said.contains("--time start"),
        "{said}"
    );
    // 20 s of the slow one are 14 s of the fast one's way.
    let (rms_m, said, rows) = compare(&["--time", "start"]);
    assert!(rms_m > 0.05, "{rms_m}");
    assert!(!said.contains("different-durations"), "{said}");
    assert!(
        said.contains("compared at equal times over the first 20.000 s"),
        "{said}"
    );
    assert_eq!(rows[0]["warnings"][0]["code"], "read-as");
    // Both begin at 0, so the clock says the same.
    let (by_clock_m, said, rows) = compare(&[]);
    assert_eq!(by_clock_m, rms_m);
    assert_eq!(rows[0]["time"], "clock");
    assert!(
        said.contains("over the 20.000 s that all recordings have in common"),
        "{said}"
    );
    // Between repeats that have no study it can be asked for, too.
    let glob = folder.path().join("*.csv");
    let gap = |options: &[&str]| {
        let out = realgap()
            .args(["gap", "--metric", "rms", "--format", "json", "--recordings"])
            .arg(&glob)
            .args(options)
            .assert()
            .success();
        let report: serde_json::Value = serde_json::from_slice(&out.get_output().stdout).unwrap();
        report["sets"][0].to_string()
    };
    assert!(gap(&["--time", "start"]).contains("over the first 20.000 s"));
    assert!(!gap(&[]).contains("over the first"));
}

#[test]
fn a_study_compares_at_equal_times() {
    // The same way at 0.7 of the speed: clipped to what all last, it is another run.
    let folder = tempfile::tempdir().unwrap();
    file(folder.path(), "a.csv", &own_form(&walk()));
    let slow: Vec<[f64; 4]> = walk()
        .iter()
        .map(|[t, x, y, a]| [t / 0.7, *x, *y, *a])
        .collect();
    file(folder.path(), "b.csv", &own_form(&slow));
    let body = format!(
        "morphology: \"{}/morphologies/tripod.ron\", recordings: [\"*.csv\"], start: Settled,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],",
        project().display()
    );
    let path = study(folder.path(), &body);
    let study = Study::new(Definition::read(path, &Overrides::default()).unwrap()).unwrap();
    let [a, b] = [0, 1].map(|i| &study.cases()[0].targets[i]);
    assert!(
        (a.motion.duration_s() - 20.0).abs() < 1e-6 && (b.motion.duration_s() - 20.0).abs() < 1e-6
    );
    assert!(a.prepared.net_displacement_m() > 1.2 * b.prepared.net_displacement_m());
}
