//! The sweep as a user runs it: same bits however it was run, nothing lost, refusals that name the reason.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::{project, quick_study, realgap, shared_data, study, text};

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file))
        .unwrap_or_else(|e| panic!("{}: {e}", folder.join(file).display()))
}

fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&read(folder, "summary.json")).unwrap()
}

#[test]
fn a_sweep_leaves_everything_that_was_promised() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    realgap()
        .arg("sweep")
        .arg(quick_study(folder.path(), 3))
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    let points = read(&out, "points.csv");
    assert_eq!(
        points.lines().next(),
        Some("floor.friction,floor.restitution,score,unit,status,displacement_error_m")
    );
    assert_eq!(points.lines().count(), 1 + 9);
    assert_eq!(read(&out, "scores.csv").lines().count(), 1 + 9 * 10);
    for picture in ["heatmap.png", "heatmap.svg", "trajectories.png"] {
        assert!(
            std::fs::metadata(out.join(picture)).unwrap().len() > 5_000,
            "{picture}"
        );
    }
    let summary = summary(&out);
    assert_eq!(summary["complete"], true);
    assert_eq!(summary["points"], 9);
    assert!(summary["warnings"].to_string().contains("stand-in"));
    // The best values can be used wherever parameters can.
    realgap()
        .args([
            "simulate",
            "morphologies/tripod.ron",
            "--duration",
            "1",
            "--parameters",
        ])
        .arg(out.join("best.ron"))
        .assert()
        .success();
    realgap()
        .arg("check")
        .arg(out.join("best.ron"))
        .assert()
        .success();
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 4);
    let points = |jobs: &str| {
        let out = folder.path().join(jobs);
        realgap()
            .arg("sweep")
            .arg(&study)
            .args(["--jobs", jobs, "-o"])
            .arg(&out)
            .assert()
            .success();
        (
            read(&out, "points.csv"),
            read(&out, "scores.csv"),
            std::fs::read(out.join("heatmap.png")).unwrap(),
        )
    };
    let one = points("1");
    assert_eq!(one, points("2"));
    assert_eq!(one, points("5"));
}

#[test]
fn a_killed_sweep_goes_on_and_ends_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 12);
    let whole = folder.path().join("whole");
    realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&whole)
        .assert()
        .success();

    let killed = folder.path().join("killed");
    let mut process = Command::new(env!("CARGO_BIN_EXE_realgap"))
        .arg("sweep")
        .arg(&study)
        .args(["--jobs", "1", "-o"])
        .arg(&killed)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait_for_points(&killed, 5);
    process.kill().unwrap();
    process.wait().unwrap();

    // Without --resume the unfinished results are protected.
    let out = realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&killed)
        .assert()
        .code(1);
    assert!(
        text(&out.get_output().stderr).contains("--resume"),
        "{}",
        text(&out.get_output().stderr)
    );
    realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--resume", "-o"])
        .arg(&killed)
        .assert()
        .success();
    assert_eq!(read(&whole, "points.csv"), read(&killed, "points.csv"));
    assert_eq!(read(&whole, "best.ron"), read(&killed, "best.ron"));
}

/// Waits until the store holds at least `count` points.
fn wait_for_points(folder: &Path, count: usize) {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(60) {
        if let Ok(store) = realgap::store::Store::read(folder)
            && store
                .finished()
                .is_ok_and(|finished| finished.len() >= count)
        {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no {count} points in {} after a minute", folder.display());
}

#[cfg(unix)]
#[test]
fn ctrl_c_saves_draws_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 30);
    let out = folder.path().join("out");
    let process = Command::new(env!("CARGO_BIN_EXE_realgap"))
        .arg("sweep")
        .arg(&study)
        .args(["--jobs", "1", "-o"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for_points(&out, 5);
    Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status()
        .unwrap();
    let output = process.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("--resume"),
        "{}",
        text(&output.stderr)
    );
    let summary = summary(&out);
    assert_eq!(summary["complete"], false);
    let points = summary["points"].as_u64().unwrap();
    assert!((5..900).contains(&points), "{points}");
    assert_eq!(read(&out, "points.csv").lines().count() as u64, 1 + points);
    assert!(out.join("heatmap.png").exists());
}

#[test]
fn resuming_a_changed_study_names_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let study = quick_study(folder.path(), 2);
    realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    quick_study(folder.path(), 3);
    let refused = realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--resume", "-o"])
        .arg(&out)
        .assert()
        .code(1);
    let error = text(&refused.get_output().stderr);
    assert!(
        error.contains("parameter floor.friction")
            && error.contains("3 points")
            && error.contains("2 points"),
        "{error}"
    );
    realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--restart", "-o"])
        .arg(&out)
        .assert()
        .success();
}

#[test]
fn the_second_process_on_a_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let study = quick_study(folder.path(), 30);
    let mut first = Command::new(env!("CARGO_BIN_EXE_realgap"))
        .arg("sweep")
        .arg(&study)
        .args(["--jobs", "1", "-o"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait_for_points(&out, 1);
    let second = realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--resume", "-o"])
        .arg(&out)
        .assert()
        .code(1);
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(text(&second.get_output().stderr).contains("another process"));
}

#[test]
fn a_folder_that_cannot_be_made_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").unwrap();
    let out = realgap()
        .arg("sweep")
        .arg(quick_study(folder.path(), 2))
        .arg("-o")
        .arg(file.join("out"))
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert_eq!(error.matches("error:").count(), 1, "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    // A device that is always full.
    let full = folder.path().join("full.csv");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let out = realgap()
        .args(["simulate", "morphologies/cube.ron", "--duration", "1", "-o"])
        .arg(&full)
        .assert()
        .code(1);
    let error = text(&out.get_output().stderr);
    assert!(error.contains("free some disk space"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_sweep_that_runs_out_of_space_keeps_what_it_has_and_can_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 12);
    let out = folder.path().join("out");
    // No file may grow beyond 128 KiB: the store fails like on a full disk.
    let limited = format!(
        "trap '' XFSZ; ulimit -f 128; exec '{}' sweep '{}' --jobs 1 -o '{}'",
        env!("CARGO_BIN_EXE_realgap"),
        study.display(),
        out.display()
    );
    let output = Command::new("bash")
        .args(["-c", &limited])
        .output()
        .unwrap();
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert_eq!(error.matches("error:").count(), 1, "{error}");
    assert!(
        error.contains("free some space") || error.contains("free some disk space"),
        "{error}"
    );
    let kept = realgap::store::Store::read(&out)
        .unwrap()
        .finished()
        .unwrap()
        .len();
    assert!((1..144).contains(&kept), "{kept}");
    realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--resume", "-o"])
        .arg(&out)
        .assert()
        .success();
    assert_eq!(summary(&out)["points"], 144);
}

#[test]
fn one_parameter_gives_a_curve_and_three_give_slices() {
    let folder = tempfile::tempdir().unwrap();
    let root = project().display();
    let with = |parameters: &str| {
        study(
            folder.path(),
            &format!(
                "morphology: \"{root}/morphologies/two_module.ron\",
                 recordings: [\"{root}/real_trajectories/tripod_standin/run_00.csv\"],
                 start: Settled, duration_s: 0.5, metric: \"rms\", parameters: [{parameters}],"
            ),
        )
    };
    let friction = "(name: \"floor.friction\", from: 0.1, to: 0.9, points: 3)";
    let restitution = "(name: \"floor.restitution\", from: 0.0, to: 0.5, points: 3)";
    let mass = "(name: \"body.mass_scale\", from: 0.5, to: 1.5, points: 3)";
    let one = folder.path().join("one");
    let output = realgap()
        .arg("sweep")
        .arg(with(friction))
        .arg("-o")
        .arg(&one)
        .assert()
        .success();
    assert!(
        one.join("curve.png").exists()
            && one.join("curve.svg").exists()
            && !one.join("heatmap.png").exists()
    );
    // Recordings of another robot, and only one of them: said, not hidden.
    let warnings = text(&output.get_output().stderr);
    assert!(
        warnings.contains("other-robot") && warnings.contains("one-recording"),
        "{warnings}"
    );
    assert_eq!(summary(&one)["uncertainty"]["source"], "ensemble");
    let three = folder.path().join("three");
    realgap()
        .arg("sweep")
        .arg(with(&format!("{friction}, {restitution}, {mass}")))
        .arg("-o")
        .arg(&three)
        .assert()
        .success();
    for pair in [
        "floor_friction_floor_restitution",
        "floor_friction_body_mass_scale",
        "floor_restitution_body_mass_scale",
    ] {
        assert!(three.join(format!("heatmap_{pair}.png")).exists(), "{pair}");
    }
}

/// A cube on a slope of 0.7 rad for 20 s: without friction it slides more than a kilometre, which counts as
/// diverged; with friction 10 it stays.
fn slope(folder: &Path, to: f64) -> std::path::PathBuf {
    let root = project().display();
    study(
        folder,
        &format!(
            "morphology: \"{root}/morphologies/cube.ron\",
             recordings: [\"{root}/real_trajectories/tripod_standin/run_0[01].csv\"],
             start: Settled, metric: \"rms\", set: {{\"floor.slope_rad\": 0.7}},
             parameters: [(name: \"floor.friction\", from: 0.0, to: {to}, points: 2)],"
        ),
    )
}

#[test]
fn a_diverged_point_has_no_score_and_never_wins() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    realgap()
        .arg("sweep")
        .arg(slope(folder.path(), 10.0))
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    let points = read(&out, "points.csv");
    assert!(points.contains("\n0,,m,diverged,\n"), "{points}");
    assert_eq!(summary(&out)["best"]["parameters"]["floor.friction"], 10.0);
    assert_eq!(summary(&out)["diverged"], 1);
}

#[test]
fn when_every_point_diverges_there_is_no_best_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let assert = realgap()
        .arg("sweep")
        .arg(slope(folder.path(), 0.001))
        .arg("-o")
        .arg(&out)
        .assert()
        .code(1);
    assert!(text(&assert.get_output().stderr).contains("every point diverged"));
    assert!(!out.join("best.ron").exists());
    assert_eq!(summary(&out)["best"], serde_json::Value::Null);
}

#[test]
fn bad_studies_are_refused_with_line_and_reason() {
    let folder = tempfile::tempdir().unwrap();
    let root = project().display();
    let head = format!(
        "morphology: \"{root}/morphologies/cube.ron\", recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"], start: Settled,"
    );
    let friction = "parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9)],";
    for (body, expected) in [
        (format!("{head} parameters: [],"), "at least one parameter"),
        (
            format!("{head} parameters: [(name: \"floor.friction\", from: 0.9, to: 0.1)],"),
            "from below to",
        ),
        (
            format!("{head} parameters: [(name: \"floor.frition\", from: 0.1, to: 0.9)],"),
            "floor.friction",
        ),
        (
            format!("{head} parameters: [(name: \"floor.friction\", from: -1.0, to: 0.9)],"),
            "0 to 10",
        ),
        (format!("{head} {friction} metrc: \"pca\","), "metric"),
        (
            format!("{head} {friction} metric: \"pcaa\","),
            "pca-cluster",
        ),
        (format!("{head} {friction} duration_s: -3.0,"), "duration_s"),
        (
            format!("{head} {friction} set: {{\"floor.height\": 1.0}},"),
            "floor.height_m",
        ),
        (
            head.replace("tripod_standin", "nothing_here") + friction,
            "no file matches",
        ),
        (
            head.replace("cube.ron", "sphere.ron") + friction,
            "sphere.ron",
        ),
    ] {
        let path = study(folder.path(), &body);
        let out = realgap()
            .arg("sweep")
            .arg(&path)
            .arg("-o")
            .arg(folder.path().join("out"))
            .assert()
            .code(1);
        let error = text(&out.get_output().stderr);
        assert!(
            error.contains(expected),
            "expected \"{expected}\" in\n{error}\nfor {body}"
        );
    }
}

#[test]
fn two_hidden_floor_values_of_real_tosses_are_where_others_found_them() {
    let Some(data) = shared_data("cube_tosses") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    realgap()
        .args([
            "sweep",
            "sweeps/cube_toss.ron",
            "--limit-recordings",
            "40",
            "--points",
            "9",
            "--recordings",
        ])
        .arg(data.join("*.csv"))
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    let summary = summary(&out);
    let friction = summary["best"]["parameters"]["floor.friction"]
        .as_f64()
        .unwrap();
    // Others found 0.17 to 0.20 on all tosses; the grid of this quick check has a step of 0.05.
    assert!((0.15..=0.25).contains(&friction), "{friction}");
    let position = summary["pose"]["position_percent"].as_f64().unwrap();
    assert!(position < 18.0, "{position} %");
}

#[test]
fn another_unit_of_the_recordings_is_another_study() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let study = quick_study(folder.path(), 2);
    realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    let refused = realgap()
        .arg("sweep")
        .arg(&study)
        .args(["--unit", "cm", "--resume", "-o"])
        .arg(&out)
        .assert()
        .code(1);
    let error = text(&refused.get_output().stderr);
    assert!(
        error.contains("unit of the recordings") && error.contains("Centimetre"),
        "{error}"
    );
}

#[test]
fn pictures_do_not_outlive_their_study() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    realgap()
        .arg("sweep")
        .arg(quick_study(folder.path(), 2))
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    assert!(out.join("heatmap.png").exists() && out.join("scores.csv").exists());
    realgap()
        .arg("sweep")
        .arg(slope(folder.path(), 0.001))
        .args(["--restart", "-o"])
        .arg(&out)
        .assert()
        .code(1);
    for gone in ["heatmap.png", "heatmap.svg", "best.ron"] {
        assert!(
            !out.join(gone).exists(),
            "{gone} is left from another study"
        );
    }
}

#[test]
fn a_value_for_a_parameter_that_the_study_varies_is_not_silently_ignored() {
    let folder = tempfile::tempdir().unwrap();
    let assert = realgap()
        .arg("sweep")
        .arg(quick_study(folder.path(), 2))
        .args(["--set", "floor.friction=0.3", "-o"])
        .arg(folder.path().join("out"))
        .assert()
        .success();
    assert!(
        text(&assert.get_output().stderr)
            .contains("floor.friction was set, but the study varies it")
    );
}
