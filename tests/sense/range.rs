//! `realgap sense fit` and `realgap sense draw` as commands.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use realgap::sensing::range::find_sensor;

#[test]
fn a_fitted_model_can_be_drawn_from() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let run = |args: &[&str]| {
        let output = common::realgap().args(args).output().unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        common::text(&output.stdout)
    };
    run(&[
        "sense",
        "draw",
        "ultrasonic",
        "-o",
        &path("log.csv"),
        "--readings",
        "100",
    ]);
    let json = run(&[
        "sense",
        "fit",
        &path("log.csv"),
        "--model",
        "linear",
        "-o",
        &path("own.ron"),
        "--plot",
        &path("sensor.png"),
        "--histograms",
        &path("histograms.svg"),
        "--format",
        "json",
    ]);
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    let slope = &found["mean"][1];
    assert_eq!(slope["name"], "slope");
    assert!(slope["low"].as_f64().unwrap() < 0.9582 && slope["high"].as_f64().unwrap() > 0.9582);
    let own = find_sensor(&path("own.ron")).unwrap();
    assert_eq!(own.mean.values[1], slope["value"].as_f64().unwrap());
    assert!(
        folder.path().join("sensor.png").is_file()
            && folder.path().join("histograms.svg").is_file()
    );
    // Readings can be drawn from the fitted model; a distance outside of its range gives a warning.
    let output = common::realgap()
        .args([
            "sense",
            "draw",
            &path("own.ron"),
            "--distances",
            "30",
            "-o",
            &path("far.csv"),
        ])
        .output()
        .unwrap();
    assert!(common::text(&output.stderr).contains("[extrapolated]"));
    let twice = |name: &str| {
        run(&["sense", "draw", "infrared", "-o", &path(name)]);
        std::fs::read(path(name)).unwrap()
    };
    assert_eq!(twice("a.csv"), twice("b.csv"));
    let output = common::realgap()
        .args(["sense", "fit", &path("log.csv"), "--model", "lines"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(common::text(&output.stderr).contains("did you mean `linear`?"));
}
