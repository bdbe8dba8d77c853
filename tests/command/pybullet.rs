//! The example of a study that PyBullet simulates (docs/simulator.md).
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::start_mujoco::{package, run};

use crate::common::{project, python_with, read};

#[test]
fn the_example_of_pybullet_finds_the_friction_of_real_tosses() {
    let Some(python) = python_with("pybullet") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    package(here);
    let example = project().join("examples/pybullet_cube.py");
    assert!(std::fs::read_to_string(&example).unwrap().lines().count() <= 60);
    std::fs::copy(example, here.join("pybullet_cube.py")).unwrap();
    for toss in ["toss_003.csv", "toss_015.csv"] {
        let from = project().join("real_trajectories/cube_tosses").join(toss);
        std::fs::copy(from, here.join(toss)).unwrap();
    }
    let study = format!(
        "Study(simulator: Command([{python:?}, \"pybullet_cube.py\"]), recordings: [\"toss_*.csv\"], start: FromRecording,
        set: {{\"restitution\": 0.02}}, parameters: [(name: \"friction\", from: 0.02, to: 0.62, points: 5)], metric: \"pose\")"
    );
    std::fs::write(here.join("study.ron"), study).unwrap();
    let sweep = [
        "sweep",
        "study.ron",
        "--allow-command",
        "--no-report",
        "-o",
        "out",
    ];
    let (done, said) = run(here, &sweep);
    assert!(done, "{said}");
    // The authors of the data name 0.18; a floor of ice and one of rubber are far off.
    let best = read(&here.join("out"), "best.ron");
    assert!(best.contains("\"sim.friction\": 0.17"), "{best}");
    assert!(!said.contains("not-reproducible"), "{said}");
}
