//! A run that is ended by Ctrl-C, by the system, or by the loss of its folder keeps its results.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use common::{quick_study, read, start, start_on_one_thread, summary, text, wait_for_points};

/// Sends a signal.
fn signal(process: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &process.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// Waits until a process holds the folder.
fn wait_for_lock(folder: &Path) {
    let started = Instant::now();
    while !folder.join(".lock").exists() {
        assert!(started.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Whether these tests, and all that they start, ignore that a terminal is closed.
fn hang_up_is_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 == 1)
}

#[test]
fn ctrl_c_saves_draws_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 30);
    let out = folder.path().join("out");
    let process = start_on_one_thread("sweep", &study, &out);
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
fn sigterm_ends_the_program_in_the_middle_of_a_run_of_an_hour() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["-TERM", "-QUIT", "-HUP"] {
        // Under `nohup` the program goes on, as it should.
        if name == "-HUP" && hang_up_is_ignored() {
            continue;
        }
        let out = folder.path().join(name);
        // Minutes of CPU before the first run ends.
        let process = start(&[
            "predict",
            "morphologies/tripod.ron",
            "--duration",
            "3600",
            "--set",
            "timestep_s=0.0001",
            "--jobs",
            "1",
            "-o",
            &out.display().to_string(),
        ]);
        wait_for_lock(&out);
        signal(&process, name);
        let ended = process.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
    }
}

#[test]
fn repeats_that_are_finished_at_ctrl_c_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 2).display().to_string();
    let noise = folder.path().join("noise.ron");
    std::fs::write(&noise, "(start_heading_rad: Normal(0.02))").unwrap();
    let noise = noise.display().to_string();
    for (command, subject, report) in [
        ("ensemble", study.as_str(), "ensemble.json"),
        ("gap", &study, "gap.json"),
        ("predict", "morphologies/tripod.ron", "prediction.json"),
    ] {
        let out = folder.path().join(command);
        let process = start(&[
            command,
            subject,
            "--repeats",
            "5000",
            "--noise",
            &noise,
            "--jobs",
            "1",
            "-o",
            &out.display().to_string(),
        ]);
        wait_for_lock(&out);
        signal(&process, "-INT");
        let ended = process.wait_with_output().unwrap();
        assert_eq!(ended.status.code(), Some(130), "{}", text(&ended.stderr));
        assert!(
            text(&ended.stderr).contains("interrupted"),
            "{}",
            text(&ended.stderr)
        );
        let said: serde_json::Value = serde_json::from_str(&read(&out, report)).unwrap();
        assert!(
            said.to_string().contains("\"complete\":false"),
            "{command}: {said}"
        );
    }
}

#[test]
fn ctrl_c_while_another_engine_is_asked_keeps_the_repeats_and_says_what_is_missing() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    // In place of a Python with MuJoCo: it notes that it was asked, and ends without an answer.
    let (python, asked) = (folder.path().join("python"), folder.path().join("asked"));
    let script = format!("#!/bin/sh\ntouch {}\nsleep 3\n", asked.display());
    std::fs::write(&python, script).unwrap();
    std::fs::set_permissions(&python, std::fs::Permissions::from_mode(0o755)).unwrap();
    let root = common::project().display();
    let study = common::study(
        folder.path(),
        &format!(
            "morphology: \"{root}/morphologies/tripod.ron\",
    recordings: [\"{root}/real_trajectories/tripod_standin/*.csv\"],
    start: Settled, duration_s: 0.25,
    parameters: [(name: \"floor.friction\", from: 0.1, to: 0.9, points: 2)],"
        ),
    );
    let study = study.display().to_string();
    let noise = folder.path().join("noise.ron");
    std::fs::write(&noise, "(start_heading_rad: Normal(0.02))").unwrap();
    let noise = noise.display().to_string();
    for (command, subject) in [
        (
            "predict",
            vec!["morphologies/two_module.ron", "--duration", "0.25"],
        ),
        ("ensemble", vec![study.as_str()]),
    ] {
        let out = folder.path().join(command);
        let python = python.display().to_string();
        let out_text = out.display().to_string();
        let usual = ["--repeats", "4", "--noise", &noise, "--jobs", "1"];
        let engine = ["--other-engine", "mujoco", "--python", &python];
        let words = [
            &[command],
            &subject[..],
            &usual,
            &engine,
            &["-o", &out_text],
        ]
        .concat();
        let process = start(&words);
        let started = Instant::now();
        while !asked.exists() {
            assert!(started.elapsed() < Duration::from_secs(60), "{command}");
            std::thread::sleep(Duration::from_millis(5));
        }
        std::fs::remove_file(&asked).unwrap();
        signal(&process, "-INT");
        let ended = process.wait_with_output().unwrap();
        let error = text(&ended.stderr);
        assert_eq!(ended.status.code(), Some(130), "{command}: {error}");
        assert!(
            error.contains("before other models and engines had answered"),
            "{error}"
        );
        let report = match command {
            "predict" => "prediction.json",
            _ => "ensemble.json",
        };
        let said = read(&out, report);
        assert!(said.contains("\"incomplete\""), "{command}: {said}");
    }
}

#[test]
fn a_folder_that_is_removed_during_a_run_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    let study = quick_study(folder.path(), 100).display().to_string();
    for args in [
        vec!["sweep", &study],
        vec![
            "predict",
            "morphologies/tripod.ron",
            "--repeats",
            "5000",
            "--duration",
            "60",
        ],
    ] {
        let out = folder.path().join("out");
        let out_text = out.display().to_string();
        let process = start(&[&args[..], &["--jobs", "1", "-o", &out_text]].concat());
        wait_for_lock(&out);
        std::thread::sleep(Duration::from_millis(300));
        std::fs::remove_dir_all(&out).unwrap();
        // Many minutes of work were left.
        let ended = process.wait_with_output().unwrap();
        let error = text(&ended.stderr);
        assert_eq!(ended.status.code(), Some(1), "{error}");
        assert!(error.contains("removed during the run"), "{error}");
        assert!(!out.join("points.csv").exists() && !out.join("prediction.json").exists());
    }
}
