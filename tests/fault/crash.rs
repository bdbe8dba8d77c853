//! Results survive kill −9, a full disk, a second process and a changed study.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use common::{
    crude_study, quick_study, read, realgap, start, start_on_one_thread, summary, text,
    wait_for_points,
};
use realgap::store::{FolderLock, Store, Trial};

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
    let mut process = start_on_one_thread("sweep", &study, &killed);
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

#[test]
fn resuming_a_changed_study_names_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let study = crude_study(folder.path(), 2);
    realgap()
        .arg("sweep")
        .arg(&study)
        .arg("-o")
        .arg(&out)
        .assert()
        .success();
    crude_study(folder.path(), 3);
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
    let mut first = start_on_one_thread("sweep", &study, &out);
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
    let study = crude_study(folder.path(), 2);
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

/// Every command that writes into a folder, with quick work.
fn writers(folder: &Path, out: &Path) -> Vec<Vec<String>> {
    let study = quick_study(folder, 2).display().to_string();
    let search = folder.join("search.ron");
    std::fs::write(
        &search,
        "Search(strategy: Evolution(population: 2, generations: 1, elites: 0), duration_s: 0.1, repeats: 1)",
    )
    .unwrap();
    let noise = folder.join("noise.ron");
    std::fs::write(&noise, "(start_heading_rad: Normal(0.02))").unwrap();
    let [search, noise] = [search, noise].map(|path| path.display().to_string());
    let robot = "morphologies/tripod.ron";
    [
        vec!["sweep", &study],
        vec!["tune", &study, "--metric", "rms", "--budget", "30"],
        vec!["search", &search],
        vec!["ensemble", &study, "--repeats", "2", "--noise", &noise],
        vec!["gap", &study, "--repeats", "2", "--noise", &noise],
        vec!["predict", robot, "--repeats", "2", "--duration", "0.1"],
        vec![
            "study",
            "record",
            robot,
            "--repeats",
            "2",
            "--duration",
            "0.1",
        ],
    ]
    .map(|args| {
        let args = args.into_iter().map(str::to_owned);
        args.chain(["-o".to_owned(), out.display().to_string()])
            .collect()
    })
    .to_vec()
}

#[test]
fn every_command_refuses_a_locked_folder_and_names_the_process_that_holds_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let _held = FolderLock::make(&out).unwrap();
    for args in writers(folder.path(), &out) {
        let refused = realgap().args(&args).assert().code(1);
        let error = text(&refused.get_output().stderr);
        assert!(
            error.contains(&format!("process {} (", std::process::id()))
                && error.contains("since 2")
                && error.contains("another folder"),
            "{args:?}: {error}"
        );
        let left: Vec<_> = std::fs::read_dir(&out).unwrap().collect();
        assert_eq!(
            left.len(),
            1,
            "{args:?} wrote into a locked folder: {left:?}"
        );
    }
}

#[test]
fn a_run_killed_in_its_first_moments_can_be_started_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let study = crude_study(folder.path(), 2);
    let sweep = |out: &Path, more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_realgap"));
        command.arg("sweep").arg(&study).args(["--jobs", "1", "-o"]);
        command.arg(out).args(more);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    };
    let whole = folder.path().join("whole");
    assert!(sweep(&whole, &[]).status().unwrap().success());
    // `tools/faults.sh` does this at many more moments.
    for delay_ms in [5, 30, 75] {
        for resumes in [false, true] {
            let out = folder.path().join(format!("{delay_ms}_{resumes}"));
            let mut process = sweep(&out, &[]).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(delay_ms));
            process.kill().unwrap();
            process.wait().unwrap();
            // A folder that is not even there has nothing to resume.
            let options: &[&str] = if resumes && out.exists() {
                &["--resume"]
            } else {
                &[]
            };
            let mut done = sweep(&out, options).output().unwrap();
            let error = text(&done.stderr);
            if !done.status.success() && error.contains("unfinished") {
                // The killed run had stored its first points, which a start without --resume protects.
                assert!(!resumes, "{error}");
                done = sweep(&out, &["--resume"]).output().unwrap();
            }
            if !done.status.success() && error.contains("there is nothing to resume") {
                // The folder existed, but its store did not.
                assert!(resumes && error.contains("start the run first"), "{error}");
                done = sweep(&out, &[]).output().unwrap();
            }
            assert!(done.status.success(), "after {delay_ms} ms: {error}");
            assert_eq!(read(&whole, "points.csv"), read(&out, "points.csv"));
        }
    }
}

#[test]
fn complete_results_are_used_again_and_survive_a_killed_second_run() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 3);
    let out = folder.path().join("out");
    let run = |command: &str, more: &[&str]| {
        let mut process = realgap();
        process
            .arg(command)
            .arg(&study)
            .args(more)
            .arg("-o")
            .arg(&out);
        process.assert()
    };
    run("sweep", &[]).success();
    let first = (
        read(&out, "points.csv"),
        read(&out, "summary.json"),
        read(&out, "best.ron"),
    );
    let stored = || realgap::store::Listing::read(&out).unwrap();
    let rows = stored().rows.len();
    assert!(rows > 9, "{rows}");
    // Killed at any moment, the second run leaves a complete store.
    for delay_ms in [0, 30, 100, 300, 700] {
        let mut process = start(&[
            "sweep",
            study.to_str().unwrap(),
            "-o",
            out.to_str().unwrap(),
        ]);
        std::thread::sleep(Duration::from_millis(delay_ms));
        process.kill().unwrap();
        process.wait().unwrap();
        assert!(stored().complete && stored().rows.len() == rows);
    }
    std::fs::remove_file(out.join("heatmap.png")).unwrap();
    run("sweep", &[]).success();
    // The pictures are drawn again, with the same bytes.
    assert!(out.join("heatmap.png").exists());
    let again = (
        read(&out, "points.csv"),
        read(&out, "summary.json"),
        read(&out, "best.ron"),
    );
    assert_eq!(first, again);
}

#[test]
fn a_smaller_budget_uses_all_stored_points() {
    let folder = tempfile::tempdir().unwrap();
    let study = crude_study(folder.path(), 3);
    let out = folder.path().join("out");
    let tune = |budget: &str| {
        let mut command = realgap();
        command
            .arg("tune")
            .arg(&study)
            .args([
                "--metric",
                "rms",
                "--optimizer",
                "cma-es",
                "--budget",
                budget,
                "-o",
            ])
            .arg(&out);
        command.assert().success();
        (read(&out, "points.csv"), summary(&out))
    };
    let (points, first) = tune("40");
    let (again, second) = tune("30");
    assert_eq!(points, again);
    assert_eq!(first["best"], second["best"]);
    assert_eq!(
        (&second["points"], &second["points_total"]),
        (&40.into(), &40.into())
    );
    assert_eq!(second["complete"], true);
    let (_, third) = tune("52");
    let trials = read(&out, "trials.csv");
    assert!(
        trials.lines().count() == 53 && third["points"] == 52,
        "{third}"
    );
}
