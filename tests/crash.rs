//! Nothing is lost: kill −9, Ctrl-C, a full disk, a second process, a changed study.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::{quick_study, read, realgap, summary, text};
use realgap::store::{Store, Trial};

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
        if let Ok(store) = Store::<Trial>::look(folder)
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
    let kept = Store::<Trial>::read(&out)
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
