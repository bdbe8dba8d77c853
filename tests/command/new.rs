//! Templates and examples inside of the installed program.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::collections::BTreeSet;

use common::{files, project, realgap, text};

#[test]
fn every_template_is_sound_as_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let runs = folder.path().join("runs");
    std::fs::create_dir(&runs).unwrap();
    for (name, bytes) in files(&project().join("real_trajectories/two_module_mujoco")) {
        if name.extension().is_some_and(|ending| ending == "csv") {
            std::fs::write(runs.join(name), bytes).unwrap();
        }
    }
    let new = |kind: &str, place: &std::path::Path| {
        let file = place.join(format!("{kind}.ron"));
        realgap()
            .args(["study", "new", kind, "-o"])
            .arg(&file)
            .assert()
            .success();
        file
    };
    new("meta", &runs);
    for kind in ["robot", "arena", "noise", "search", "study"] {
        let file = new(kind, folder.path());
        // `check` does not know a noise file by itself.
        if kind == "noise" {
            continue;
        }
        let said = realgap().arg("check").arg(&file).output().unwrap();
        assert!(said.status.success(), "{kind}: {}", text(&said.stderr));
        // An existing file is not replaced.
        let before = std::fs::read(&file).unwrap();
        let said = realgap()
            .args(["study", "new", kind, "-o"])
            .arg(&file)
            .output()
            .unwrap();
        assert_eq!(said.status.code(), Some(1));
        assert_eq!(std::fs::read(&file).unwrap(), before);
    }
    let repeats = ["--repeats", "2", "--model-error", "off", "--noise"];
    let said = realgap()
        .arg("ensemble")
        .arg(folder.path().join("study.ron"))
        .args(repeats)
        .arg(folder.path().join("noise.ron"))
        .arg("-o")
        .arg(folder.path().join("out"))
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
}

#[test]
fn the_examples_in_the_program_equal_those_of_the_repository() {
    let folder = tempfile::tempdir().unwrap();
    let copy = |code: i32| {
        let said = realgap()
            .args(["study", "examples", "copy"])
            .arg(folder.path().join("mine"))
            .output()
            .unwrap();
        assert_eq!(said.status.code(), Some(code), "{}", text(&said.stderr));
    };
    copy(0);
    let copied = files(&folder.path().join("mine"));
    let mut there = BTreeSet::new();
    for name in [
        "morphologies",
        "sweeps",
        "arenas",
        "controllers",
        "radios",
        "sensors",
        "vehicles",
        "scenes",
        "real_trajectories/cube_pushes",
        "real_trajectories/cube_tosses",
        "real_trajectories/dart_car",
        "real_trajectories/double_pendulum",
        "real_trajectories/elbow_tosses",
        "real_trajectories/fleet_mujoco",
        "real_trajectories/radio_flat",
        "real_trajectories/servo_pendulum",
        "real_trajectories/so101_arm",
        "real_trajectories/so101_arm_standin",
        "real_trajectories/tripod_mujoco",
        "real_trajectories/tripod_standin",
        "real_trajectories/turtlebot3_burger_standin",
        "real_trajectories/two_wheel_runs",
        "real_trajectories/unitree_a1_standin",
        "real_trajectories/unitree_go2",
        "real_trajectories/worm4_mujoco",
        "genomes",
    ] {
        for (path, bytes) in files(&project().join(name)) {
            let path = std::path::Path::new(name).join(path);
            assert!(copied.get(&path) == Some(&bytes), "{}", path.display());
            there.insert(path);
        }
    }
    assert_eq!(copied.keys().cloned().collect::<BTreeSet<_>>(), there);
    // A second copy is refused, because it would replace files that the user may have changed.
    copy(1);
    // The copied examples contain all files that the studies read.
    let mine = folder.path().join("mine");
    let studies = there.iter().filter(|path| path.starts_with("sweeps"));
    let said = realgap()
        .arg("check")
        .args(studies)
        .current_dir(mine)
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", text(&said.stderr));
}
