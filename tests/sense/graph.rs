//! `realgap sense graph` as a command: its output.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use crate::room::room;

#[test]
fn the_commands_fit_evaluate_and_print() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("scans.csv"), room(400, true)).unwrap();
    let run = |args: &[&str]| {
        let output = common::realgap().args(args).output().unwrap();
        assert!(output.status.success(), "{}", common::text(&output.stderr));
        common::text(&output.stdout)
    };
    run(&[
        "sense",
        "graph",
        "fit",
        &path("scans.csv"),
        "--to",
        "0.7",
        "-o",
        &path("model.ron"),
        "--way",
        &path("from_above.svg"),
        "--visits",
        &path("visits.svg"),
    ]);
    let drawn = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    assert!(drawn("from_above.svg").contains("280 scans"));
    for axis in ["x (m)", "y (m)", "heading (°)"] {
        assert!(drawn("visits.svg").contains(axis), "{axis}");
    }
    let json = run(&[
        "sense",
        "graph",
        "evaluate",
        &path("scans.csv"),
        "--from",
        "0.7",
        "--parameters",
        &path("model.ron"),
        "--plot",
        &path("way.png"),
        "--segment",
        "3",
        "--format",
        "json",
    ]);
    let found = common::schema::answer("sensorgraph-evaluate", &json);
    for field in [
        "mean_absolute_error_m",
        "baseline_constant_m",
        "baseline_nearest_m",
        "spearman",
        "p",
    ] {
        assert!(found[field].is_f64(), "{field}: {}", found[field]);
    }
    assert!(found["mean_absolute_error_m"].as_f64() < found["baseline_constant_m"].as_f64());
    assert!(folder.path().join("way.png").is_file());
    assert!(run(&["sense", "graph", "print", &path("model.ron")]).contains("direction 30 deg:"));
    assert!(
        run(&[
            "sense",
            "graph",
            "print",
            &path("model.ron"),
            "--language",
            "c"
        ])
        .contains("double sensorgraph_range_m")
    );
    let bic = run(&[
        "sense",
        "graph",
        "fit",
        &path("scans.csv"),
        "--stop",
        "bic",
        "--frame",
        "robot",
        "--format",
        "json",
    ]);
    let bic = common::schema::answer("sensorgraph-fit", &bic);
    assert_eq!(bic["polynomials"], 144);
    let output = common::realgap()
        .args([
            "sense",
            "graph",
            "fit",
            &path("scans.csv"),
            "--from",
            "0.9",
            "--to",
            "0.2",
        ])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
}
