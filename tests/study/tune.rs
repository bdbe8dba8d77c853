//! Tuning as a user runs it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;

use common::{STANDIN_NUMERICS, project, read, realgap, study, summary, text};

/// The tripod for some tenths of a second, compared point by point: no basis, so that small budgets are enough. Cheap
/// numerics, because only the tuning is tested.
fn quick(folder: &Path) -> std::path::PathBuf {
    let root = project().display();
    study(
        folder,
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    start: Settled,
    duration_s: 0.4,
    timestep_s: 0.004166666666666667,
    joint: Impulse,
    set: {{\"solver.sweeps\": 1}},
    parameters: [
        (name: \"floor.friction\", from: 0.1, to: 0.9),
        (name: \"servo.gain\", from: 0.5, to: 2.0),
        (name: \"solver.substeps\", from: 4, to: 8, points: 5),
    ],
    metric: \"rms\","
        ),
    )
}

fn tune(study: &Path, out: &Path, more: &[&str]) -> assert_cmd::assert::Assert {
    realgap()
        .arg("tune")
        .arg(study)
        .arg("-o")
        .arg(out)
        .args(more)
        .assert()
}

#[test]
fn a_shorter_duration_on_the_command_line_is_that_of_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let long = quick(folder.path());
    let stated = read(folder.path(), "study.ron");
    let short = folder.path().join("short.ron");
    std::fs::write(&short, stated.replace("duration_s: 0.4", "duration_s: 0.2")).unwrap();
    let trials = |study: &Path, name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let few = [
            "--budget",
            "4",
            "--optimizer",
            "random",
            "--score",
            "single",
        ];
        tune(study, &out, &[&few, more].concat()).success();
        read(&out, "trials.csv")
    };
    let told = trials(&long, "told", &["--duration", "0.2"]);
    assert_eq!(told, trials(&short, "stated", &[]));
    assert_ne!(told, trials(&long, "whole", &[]));
    let refused = tune(&long, &folder.path().join("none"), &["--duration", "0"]).failure();
    let said = text(&refused.get_output().stderr);
    assert!(said.contains("duration_s"), "{said}");
}

#[test]
fn tuning_writes_all_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let study = quick(folder.path());
    tune(&study, &out, &["--budget", "40", "--folds", "5"]).success();
    let trials = read(&out, "trials.csv");
    assert_eq!(
        trials.lines().next(),
        Some("trial,phase,floor.friction,servo.gain,solver.substeps,score,unit,best_so_far")
    );
    assert_eq!(trials.lines().count(), 1 + 40);
    for picture in [
        "convergence.png",
        "profile_servo_gain.svg",
        "trajectories.png",
    ] {
        assert!(
            std::fs::metadata(out.join(picture)).unwrap().len() > 5_000,
            "{picture}"
        );
    }
    let summary = summary(&out);
    assert_eq!(summary["tuning"]["optimizer"], "cma-es");
    assert_eq!(summary["tuning"]["termination"], "budget");
    assert_eq!(summary["audit"]["rows"].as_array().unwrap().len(), 5);
    assert_eq!(summary["validation"]["held_out_recordings"], 10);
    assert_eq!(summary["correlations"].as_array().unwrap().len(), 3);
    let substeps = summary["best"]["parameters"]["solver.substeps"]
        .as_f64()
        .unwrap();
    assert_eq!(substeps.fract(), 0.0, "whole numbers stay whole");
    // The best never gets worse, and the last is the luckiest of all runs.
    let best: Vec<f64> = trials
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').next().unwrap().parse().unwrap())
        .collect();
    assert!(best.windows(2).all(|w| w[1] <= w[0]));
    let scores = trials.lines().skip(1).map(|line| line.split(',').nth(5));
    let scores = scores.map(|score| score.unwrap().parse::<f64>().unwrap());
    assert_eq!(best.last().copied(), scores.reduce(f64::min));
    // The answer is not the luckiest run but a mean over equally valid settings.
    assert_eq!(summary["best"]["settings"], 16);
}

#[test]
fn threads_and_larger_budgets_change_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    for optimizer in [
        "cma-es",
        "bayesian",
        "nelder-mead",
        "particle-swarm",
        "random",
    ] {
        let out = |name: &str| folder.path().join(format!("{optimizer}-{name}"));
        let run = |name: &str, more: &[&str]| {
            let all = [&["--optimizer", optimizer, "--limit-recordings", "6"], more].concat();
            tune(Path::new("sweeps/cube_toss.ron"), &out(name), &all).success();
        };
        run("one", &["--budget", "40", "-j", "1"]);
        run("two", &["--budget", "40", "-j", "2"]);
        // 33 ends in the middle of a batch.
        run("parts", &["--budget", "33"]);
        run("parts", &["--budget", "40", "--resume"]);
        let trials = read(&out("one"), "trials.csv");
        assert_eq!(
            trials,
            read(&out("two"), "trials.csv"),
            "{optimizer}: threads"
        );
        assert_eq!(
            trials,
            read(&out("parts"), "trials.csv"),
            "{optimizer}: resumed"
        );
    }
}

#[test]
fn patience_and_a_spent_grid_end_a_run_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick(folder.path());
    let out = folder.path().join("patient");
    tune(
        &study,
        &out,
        &[
            "--optimizer",
            "random",
            "--budget",
            "200",
            "--patience",
            "10",
            "--score",
            "single",
        ],
    )
    .success();
    let patient = summary(&out);
    assert_eq!(patient["tuning"]["termination"], "no_improvement");
    assert!(patient["points"].as_u64().unwrap() < 200);
    let out = folder.path().join("grid");
    let grid = ["--optimizer", "grid", "--budget", "30", "--score", "single"];
    tune(&study, &out, &grid).success();
    let grid = summary(&out);
    assert_eq!(grid["tuning"]["termination"], "exhausted");
    assert_eq!(
        grid["points"], 27,
        "three points along each of three parameters"
    );
}

#[test]
fn an_impossible_tuning_is_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick(folder.path());
    let out = folder.path().join("out");
    let refused = |more: &[&str], words: &[&str]| {
        let output = tune(&study, &out, more).code(2);
        let message = text(&output.get_output().stderr);
        for word in words {
            assert!(message.contains(word), "{more:?}: {message}");
        }
    };
    refused(&["--optimizer", "simplex"], &["nelder-mead", "bayesian"]);
    refused(&["--budget", "5"], &["too small", "at least"]);
    refused(
        &["--metric", "pca", "--budget", "40"],
        &["design of 64", "--metric rms"],
    );
    refused(&["--folds", "1"], &["--folds", "2 up to"]);
    refused(&["--folds", "11"], &["11 folds of 10 recordings"]);
    refused(
        &["--limit-recordings", "1", "--folds", "2"],
        &["2 folds of 1 recordings"],
    );
    refused(&["--hold-out", "1.5"], &["between 0 and 1"]);
    // An unfinished or different run in the folder is not overwritten.
    tune(&study, &out, &["--budget", "44"]).success();
    let output = tune(&study, &out, &["--budget", "44", "--seed", "2"]).code(1);
    assert!(text(&output.get_output().stderr).contains("now 2, stored 1"));
}

#[test]
fn every_optimizer_finds_the_hidden_floor_of_the_stand_ins() {
    if !common::is_long_run("optimizers and a hidden floor") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let root = project().display();
    let study = study(
        folder.path(),
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    {STANDIN_NUMERICS}
    start: Settled,
    duration_s: 5.0,
    parameters: [
        (name: \"floor.friction\", from: 0.05, to: 1.0),
        (name: \"floor.restitution\", from: 0.0, to: 0.9),
    ],
    metric: \"rms\","
        ),
    );
    for optimizer in [
        "random",
        "nelder-mead",
        "particle-swarm",
        "cma-es",
        "bayesian",
    ] {
        let out = folder.path().join(optimizer);
        let more = [
            "--budget",
            "60",
            "--hold-out",
            "0.3",
            "--optimizer",
            optimizer,
        ];
        tune(&study, &out, &more).success();
        let summary = summary(&out);
        let verdicts = summary["verdicts"].as_array().unwrap();
        let friction = verdicts
            .iter()
            .find(|v| v["parameter"] == "floor.friction")
            .unwrap();
        // 0.43 is the truth; what cannot be told from the best reaches it to within a step of the study's grid.
        let (low, high) = (
            friction["low"].as_f64().unwrap(),
            friction["high"].as_f64().unwrap(),
        );
        assert!(
            low - 0.05 <= 0.43 && 0.43 <= high + 0.05 && high - low < 0.5,
            "{optimizer}: {low} to {high}"
        );
        assert_eq!(summary["validation"]["held_out_recordings"], 3);
    }
}

#[test]
fn the_best_of_single_runs_is_the_lowest_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick(folder.path());
    let out = folder.path().join("out");
    tune(&study, &out, &["--budget", "40", "--score", "single"]).success();
    let trials = read(&out, "trials.csv");
    let lowest = trials.lines().last().unwrap().rsplit(',').next().unwrap();
    let best = summary(&out)["best"]["score"].as_f64().unwrap();
    assert_eq!(best, lowest.parse::<f64>().unwrap());
}

#[test]
fn results_can_be_read_without_the_study() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    tune(
        &quick(folder.path()),
        &out,
        &["--optimizer", "random", "--budget", "20"],
    )
    .success();
    std::fs::remove_file(folder.path().join("study.ron")).unwrap();
    let list = |more: &[&str]| {
        let output = realgap()
            .args(["study", "results"])
            .arg(&out)
            .args(more)
            .assert()
            .success();
        text(&output.get_output().stdout)
    };
    let csv = list(&["--format", "csv", "--top", "3"]);
    let scores: Vec<f64> = csv
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(4).unwrap().parse().unwrap())
        .collect();
    assert!(scores.len() == 3 && scores.is_sorted(), "{csv}");
    let last = read(&out, "trials.csv");
    let last = last.lines().last().unwrap();
    assert!(last.ends_with(&format!(",{}", scores[0])), "{last}");
    let json: serde_json::Value = serde_json::from_str(&list(&[
        "--format",
        "json",
        "--sort",
        "servo.gain",
        "--per-recording",
    ]))
    .unwrap();
    let rows = json.as_array().unwrap();
    assert_eq!(rows.len(), 20);
    assert!(rows[0]["servo.gain"].as_f64() <= rows[1]["servo.gain"].as_f64());
    // The version of the form, then the columns.
    assert_eq!(rows[0].as_object().unwrap().len(), 1 + 8 + 10);
    assert!(list(&[]).contains("complete"));

    parquet_holds(&out, &folder.path().join("trials.parquet"), 20, scores[0]);

    let output = realgap()
        .args(["study", "results"])
        .arg(&out)
        .args(["--sort", "luck"])
        .assert()
        .code(2);
    assert!(text(&output.get_output().stderr).contains("servo.gain"));
    let output = realgap()
        .args(["study", "results"])
        .arg(&out)
        .args(["--format", "parquet"])
        .assert()
        .code(2);
    let needed = if cfg!(feature = "parquet") {
        "--output"
    } else {
        "default features"
    };
    assert!(text(&output.get_output().stderr).contains(needed));
    realgap()
        .args(["study", "results", "sweeps"])
        .assert()
        .code(1);
}

#[cfg(feature = "parquet")]
fn parquet_holds(results: &Path, file: &Path, trials: usize, best: f64) {
    use parquet::file::reader::SerializedFileReader;
    use parquet::record::RowAccessor;

    realgap()
        .args(["study", "results"])
        .arg(results)
        .args(["--format", "parquet", "-o"])
        .arg(file)
        .assert()
        .success();
    let reader = SerializedFileReader::new(std::fs::File::open(file).unwrap()).unwrap();
    let rows: Vec<_> = reader.into_iter().map(Result::unwrap).collect();
    assert_eq!(rows.len(), trials);
    assert_eq!(rows[0].get_double(4).unwrap(), best);
}

#[cfg(not(feature = "parquet"))]
fn parquet_holds(_: &Path, _: &Path, _: usize, _: f64) {}

#[test]
fn sensitivity_sorts_parameters_by_their_effect() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("bars.png");
    let output = realgap()
        .args(["study", "sensitivity"])
        .arg(quick(folder.path()))
        .args(["--set", "floor.friction=0.43", "--format", "json", "--plot"])
        .arg(&plot)
        .assert()
        .success();
    let found: serde_json::Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let effects = found["effects"].as_array().unwrap();
    let size = |effect: &serde_json::Value| {
        ["lower_change", "higher_change"]
            .iter()
            .filter_map(|key| effect[*key].as_f64())
            .fold(0.0, |size: f64, change| size.max(change.abs()))
    };
    assert!(
        effects.windows(2).all(|w| size(&w[0]) >= size(&w[1])),
        "sorted by size"
    );
    let named = |name: &str| effects.iter().find(|e| e["parameter"] == name).unwrap();
    assert!(size(named("gait.amplitude_scale")) > 0.0);
    assert_eq!(named("floor.friction")["value"], 0.43);
    // A walking robot's servos count; its limits come from its own file.
    assert!(named("servo.max_speed_rad_s")["value"].as_f64().unwrap() > 0.0);
    assert!(found["start_sd"].as_f64().unwrap() > 0.0);
    assert!(std::fs::metadata(&plot).unwrap().len() > 10_000);
}
