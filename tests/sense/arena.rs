//! Arenas in the commands: shipped ones are sound, and simulations and studies take them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

#[test]
fn shipped_arenas_and_vehicles_are_sound() {
    for name in [
        "arenas/paper000.ron",
        "arenas/cartons.ron",
        "arenas/pen.ron",
        "vehicles/two_wheel.ron",
        "sensors/ultrasonic.ron",
        "sensors/infrared.ron",
        "sensors/laser.ron",
    ] {
        common::realgap().args(["check", name]).assert().success();
    }
}

#[test]
fn simulate_and_studies_take_an_arena() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let box_at = |x: f64| {
        format!(
            "(name: \"a\", size_m: (4.0, 3.0), boundary: Solid, boxes: [(centre_m: ({x:?}, 1.5), half_m: (0.1, 1.0))], start: (x_m: 1.0, y_m: 1.5))"
        )
    };
    std::fs::write(path("near.ron"), box_at(1.35)).unwrap();
    std::fs::write(path("in.ron"), box_at(1.12)).unwrap();
    let simulate = |arena: &str| {
        let mut command = common::realgap();
        command.args([
            "simulate",
            "morphologies/tripod.ron",
            "--duration",
            "1",
            "--arena",
            arena,
        ]);
        command.output().unwrap()
    };
    assert!(simulate(&path("near.ron")).status.success());
    let output = simulate(&path("in.ron"));
    assert!(!output.status.success());
    assert!(common::text(&output.stderr).contains("starts in a wall"));
    let study = common::read(&common::project().join("sweeps"), "tripod_self.ron");
    let sweeps = common::project().join("sweeps");
    let written = |arena: &str| {
        let study = study
            .replacen("Study(", &format!("Study(\n    arena: {arena:?},"), 1)
            .replace(
                "\"../",
                &format!("\"{}/", sweeps.parent().unwrap().display()),
            );
        std::fs::write(path("study.ron"), study).unwrap();
        let output = common::realgap()
            .args(["check", &path("study.ron")])
            .output()
            .unwrap();
        (output.status.success(), common::text(&output.stderr))
    };
    let (is_sound, said) = written(&path("near.ron"));
    assert!(is_sound, "{said}");
    let (is_sound, said) = written(&path("nowhere.ron"));
    assert!(!is_sound && said.contains("nowhere.ron"), "{said}");
}
