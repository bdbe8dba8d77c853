//! `realgap compare` by the clock: what is said about the time of two files, and what is refused.

use std::path::{Path, PathBuf};

use super::common::{project, python_with, realgap, text};

/// A walk as a TUM file: 20 s with 50 samples a second from the stamp `start_s`, of which the samples `part` are written.
fn tum(
    folder: &Path,
    name: &str,
    start_s: f64,
    part: std::ops::Range<u32>,
    every: usize,
) -> PathBuf {
    let row = |i: u32| {
        let t = f64::from(i) * 0.02;
        let (x, y) = (0.3 * t + 0.1 * (1.3 * t).sin(), 0.4 * (0.7 * t).sin());
        let (s, c) = (0.5 * (0.9 * t).sin()).sin_cos();
        format!("{:.6} {x:.9} {y:.9} 0.1 0 0 {s:.12} {c:.12}\n", start_s + t)
    };
    let path = folder.join(name);
    std::fs::write(&path, part.step_by(every).map(row).collect::<String>()).unwrap();
    path
}

/// Exit code, output and messages of `realgap compare`.
fn compare(files: &[&Path], options: &[&str]) -> (Option<i32>, String, String) {
    let done = realgap()
        .arg("compare")
        .args(files)
        .args(options)
        .output()
        .unwrap();
    (done.status.code(), text(&done.stdout), text(&done.stderr))
}

fn row(files: &[&Path], options: &[&str]) -> (serde_json::Value, String) {
    let options = [options, &["--format", "json"]].concat();
    let (code, out, said) = compare(files, &options);
    assert_eq!(code, Some(0), "{said}");
    let rows: serde_json::Value = serde_json::from_str(&out).unwrap();
    (rows[0].clone(), said)
}

const EPOCH_S: f64 = 1.7e9;

#[test]
fn the_middle_of_a_file_compares_as_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tum(folder.path(), "whole.tum", EPOCH_S, 0..1001, 1);
    let middle = tum(folder.path(), "middle.tum", EPOCH_S, 333..664, 5);
    let files = [whole.as_path(), middle.as_path()];
    let (found, said) = row(&files, &["--metric", "ape"]);
    assert!(found["ape_rmse_m"].as_f64().unwrap() < 1e-9, "{found}");
    assert_eq!(found["time"], "clock");
    assert_eq!(found["matched"], 67);
    assert_eq!(found["unmatched_reference"], 934);
    assert_eq!(found["unmatched"], 0);
    assert!(found["offset_s"].is_null(), "{found}");
    assert!(said.contains("unmatched-samples"), "{said}");
    let (_, out, _) = compare(&files, &["--metric", "ape"]);
    assert!(
        out.contains("time: stamps of one clock, 6.600 s in common; 67 samples matched"),
        "{out}"
    );
    // The paths of all metrics are those of the common time.
    let (found, said) = row(&files, &[]);
    assert!(found["rms_m"].as_f64().unwrap() < 1e-3, "{found}");
    assert!(
        said.contains("paths are compared over the 6.600 s"),
        "{said}"
    );
}

#[test]
fn files_without_common_time_are_refused_with_the_other_time_bases() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tum(folder.path(), "whole.tum", EPOCH_S, 0..1001, 1);
    let boot = tum(folder.path(), "boot.tum", 5.0, 0..1001, 1);
    let files = [whole.as_path(), boot.as_path()];
    for options in [&[][..], &["--time", "clock"], &["--metric", "ape"]] {
        let (code, _, said) = compare(&files, options);
        assert_eq!(code, Some(1), "{said}");
        for words in [
            "boot.tum",
            "no common time",
            "--time start",
            "--time fraction",
            "--offset auto",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
    }
    let (found, _) = row(&files, &["--metric", "ape", "--time", "start"]);
    assert!(found["ape_rmse_m"].as_f64().unwrap() < 1e-9);
    assert_eq!(found["time"], "start");
    let (found, _) = row(&files, &["--metric", "ape", "--time", "fraction"]);
    assert!(
        found["matched"].is_null() && found["samples"] == 182,
        "{found}"
    );
    let (found, _) = row(&files, &["--metric", "ape", "--offset", "auto"]);
    assert!(found["ape_rmse_m"].as_f64().unwrap() < 1e-3, "{found}");
}

#[test]
fn a_late_clock_is_doubted_and_its_offset_found() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tum(folder.path(), "whole.tum", EPOCH_S, 0..1001, 1);
    let late = tum(folder.path(), "late.tum", EPOCH_S + 0.5, 0..1001, 1);
    let files = [whole.as_path(), late.as_path()];
    let (found, said) = row(&files, &["--metric", "ape"]);
    assert!(found["ape_rmse_m"].as_f64().unwrap() > 0.1, "{found}");
    assert!(
        said.contains("0.500 s late") && said.contains("(--offset auto)"),
        "{said}"
    );
    let (found, said) = row(&files, &["--metric", "ape", "--offset", "auto"]);
    let value = |field: &str| found[field].as_f64().unwrap();
    assert!(value("ape_rmse_m") < 1e-3, "{found}");
    assert!((value("offset_s") - 0.5).abs() < 0.005 && value("offset_deviation_s") < 0.005);
    assert!(!said.contains("clock-offset"), "{said}");
    let (found, _) = row(&files, &["--metric", "ape", "--offset", "0.5"]);
    assert!(found["ape_rmse_m"].as_f64().unwrap() < 1e-9, "{found}");
    let (_, out, _) = compare(&files, &["--metric", "ape", "--offset", "auto"]);
    assert!(out.contains("offset 0.500 s (± "), "{out}");
}

#[test]
fn old_words_and_options_that_do_not_belong_together_are_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tum(folder.path(), "whole.tum", EPOCH_S, 0..100, 1);
    let files = [whole.as_path(), whole.as_path()];
    for (options, words) in [
        (
            &["--time", "absolute"][..],
            "`absolute` is now called `start`",
        ),
        (
            &["--time", "relative"],
            "`relative` is now called `fraction`",
        ),
        (&["--time", "watch"], "clock, start, fraction"),
        (&["--offset", "soon"], "`auto`, or a number of seconds"),
        (
            &["--time", "fraction", "--offset", "auto"],
            "no samples are matched",
        ),
        (
            &["--time", "fraction", "--align", "se3"],
            "no samples are matched",
        ),
        (&["--max-difference", "-1"], "0 or more"),
        (&["--metric", "rms", "--align", "se3"], "no matched samples"),
        (
            &["--associate", "interpolate", "--max-difference", "1"],
            "belongs to --associate nearest",
        ),
    ] {
        let (code, _, said) = compare(&files, options);
        assert!(
            code == Some(2) && said.contains(words),
            "{options:?}: {said}"
        );
    }
    let gap = |word: &str| {
        let gap = ["gap", "--time", word, "--recordings"];
        let done = realgap().args(gap).arg(&whole).output().unwrap();
        (done.status.code(), text(&done.stderr))
    };
    let (code, said) = gap("clock");
    assert!(
        code == Some(2) && said.contains("no common time by the clock"),
        "{said}"
    );
    let (code, said) = gap("relative");
    assert!(
        code == Some(2) && said.contains("now called `fraction`"),
        "{said}"
    );
}

#[test]
fn samples_too_far_apart_in_time_are_refused_with_the_options_that_help() {
    let folder = tempfile::tempdir().unwrap();
    let a = tum(folder.path(), "a.tum", EPOCH_S, 0..1000, 10);
    let b = tum(folder.path(), "b.tum", EPOCH_S, 5..1000, 10);
    let files = [a.as_path(), b.as_path()];
    let (code, _, said) = compare(&files, &["--metric", "ape"]);
    assert!(
        code == Some(1) && said.contains("no sample in common"),
        "{said}"
    );
    assert!(said.contains("--max-difference") && said.contains("--associate interpolate"));
    for options in [
        &["--max-difference", "0.1"],
        &["--associate", "interpolate"],
    ] {
        let options = [&["--metric", "ape"], &options[..]].concat();
        let (found, _) = row(&files, &options);
        assert!(found["matched"].as_u64().unwrap() >= 99, "{found}");
    }
    // Metrics of paths need no matched samples.
    assert_eq!(compare(&files, &["--metric", "rms"]).0, Some(0));
}

/// Synthetic pairs only; `tools/evo_pairs.py` without this option also compares evo's own test files.
#[test]
fn errors_are_those_that_evo_computes() {
    let Some(python) = python_with("evo") else {
        return;
    };
    let done = std::process::Command::new(python)
        .arg(project().join("tools/evo_pairs.py"))
        .args(["--synthetic", "--realgap", env!("CARGO_BIN_EXE_realgap")])
        .output()
        .unwrap();
    let (out, said) = (text(&done.stdout), text(&done.stderr));
    assert!(
        done.status.success() && out.contains("largest difference"),
        "{out}\n{said}"
    );
}

#[test]
fn errors_are_those_that_evo_computes_on_its_own_files() {
    use super::common::{is_long_run, skipped};
    if !is_long_run("evo's own test files") {
        return;
    }
    let Some(python) = python_with("evo") else {
        return;
    };
    let done = std::process::Command::new(python)
        .arg(project().join("tools/evo_pairs.py"))
        .args(["--realgap", env!("CARGO_BIN_EXE_realgap")])
        .output()
        .unwrap();
    let (out, said) = (text(&done.stdout), text(&done.stderr));
    assert!(done.status.success(), "{out}\n{said}");
    for line in out.lines().filter(|line| line.starts_with("SKIPPED")) {
        skipped(line);
    }
}
