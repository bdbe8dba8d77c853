//! Arenas on the command line: the shipped arenas are valid, and simulations and studies can use them.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

#[test]
fn shipped_arenas_and_vehicles_are_valid() {
    for name in [
        "arenas/paper000.ron",
        "arenas/cartons.ron",
        "arenas/pen.ron",
        "vehicles/two_wheel.ron",
        "sensors/ultrasonic.ron",
        "sensors/infrared.ron",
        "sensors/laser.ron",
        "controllers/tripod_avoid.ron",
        "controllers/two_tripods.ron",
        "radios/paper002.ron",
    ] {
        common::realgap().args(["check", name]).assert().success();
    }
}

#[test]
fn simulations_and_studies_use_an_arena() {
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

#[test]
fn check_reads_a_controller_alone_and_for_a_robot() {
    let shipped = "controllers/tripod_avoid.ron";
    let said = |args: &[&str]| {
        let done = common::realgap().arg("check").args(args).output().unwrap();
        let code = done.status.code().unwrap();
        (
            code,
            common::text(&done.stdout) + &common::text(&done.stderr),
        )
    };
    let (code, alone) = said(&[shipped]);
    assert_eq!(code, 0, "{alone}");
    for words in [
        "10 decisions a second of 1 robot",
        "\"front\" on \"core\": 1 to 21 cm",
        "front < 0.2 m, for 3 s: leg_a, leg_b, leg_c",
        "--robot",
    ] {
        assert!(alone.contains(words), "{words}: {alone}");
    }
    let (code, fits) = said(&[shipped, "--robot", "morphologies/tripod.ron"]);
    assert!(code == 0 && fits.contains("fits"), "{fits}");
    let (code, misfit) = said(&[shipped, "--robot", "morphologies/chain5.ron"]);
    assert_eq!(code, 1, "{misfit}");
    assert!(misfit.contains("sensors.front.on"), "{misfit}");
    assert!(misfit.contains("tripod_avoid.ron:"), "{misfit}");

    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let arena = common::project().join("arenas/paper000.ron");
    let write = |start: &str| {
        let text = format!("(arena: {arena:?}, rate_hz: 5, start: {start})");
        std::fs::write(path("start.ron"), text).unwrap();
    };
    for (start, words) in [
        ("(x_m: 0.87, y_m: 0.5)", "cannot start here"),
        ("(x_m: inf, y_m: 0.5)", "cannot start here"),
        ("(x_m: 0.3, y_m: 0.5, heading_deg: NaN)", "not a heading"),
    ] {
        write(start);
        let (code, error) = said(&[&path("start.ron")]);
        assert!(code == 1 && error.contains(words), "{start}: {error}");
        assert!(error.contains("start.ron:1:"), "{start}: {error}");
    }
    // The middle of the robot is beside the box, but its body overlaps the box.
    write("(x_m: 0.84, y_m: 0.5)");
    assert_eq!(said(&[&path("start.ron")]).0, 0);
    let robot = ["--robot", "morphologies/tripod.ron"];
    let (code, error) = said(&[&path("start.ron"), robot[0], robot[1]]);
    assert!(code == 1 && error.contains("starts in a wall"), "{error}");
    let picture = path("start.svg");
    let plot = [shipped, "--plot", &picture, robot[0], robot[1]];
    assert_eq!(said(&plot).0, 0);
    let drawn = std::fs::read_to_string(&picture).unwrap();
    assert_eq!(said(&[shipped, "--plot", &path("arena.svg")]).0, 0);
    let bare = std::fs::read_to_string(path("arena.svg")).unwrap();
    assert!(drawn.len() > bare.len(), "the robot is in the picture");
}
