//! Arenas: what beams meet, what is refused, and walls that robots bump into.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod common;

use std::f64::consts::FRAC_PI_4;

use nalgebra::{UnitQuaternion, Vector3};
use realgap::file::Source;
use realgap::robot::morphology::Morphology;
use realgap::sensing::arena::Arena;
use realgap::simulation::{Experiment, SceneBody, Start, run};
use realgap::trajectory::State;

fn arena(body: &str) -> realgap::Result<Arena> {
    Arena::parse(&Source::new(
        "arena.ron",
        format!("(name: \"a\", size_m: (4.0, 3.0), {body})"),
    ))
}

#[test]
fn a_beam_meets_what_a_ruler_says() {
    let arena = arena(
        "boundary: Solid,
        boxes: [(centre_m: (2.0, 1.0), half_m: (0.1, 0.5)), (centre_m: (3.0, 2.0), half_m: (0.2, 0.2), turn_deg: 45)],
        circles: [(centre_m: (1.0, 2.5), radius_m: 0.25)],
        walls: [(from_m: (0.0, 0.2), to_m: (4.0, 0.2), thickness_m: 0.02)]",
    )
    .unwrap();
    let hit = |x: f64, y: f64, degrees: f64| {
        let hit = arena.cast([x, y], degrees.to_radians()).unwrap();
        (hit.distance_m, hit.incidence_rad)
    };
    let near = |(a, b): (f64, f64), (c, d): (f64, f64)| {
        assert!(
            (a - c).abs() < 1e-9 && (b - d).abs() < 1e-7,
            "{a} {b}, not {c} {d}"
        )
    };
    near(hit(1.0, 1.0, 0.0), (0.9, 0.0));
    near(hit(1.0, 1.0, 90.0), (1.25, 0.0));
    near(hit(1.0, 1.0, 180.0), (1.0, 0.0));
    near(hit(1.0, 1.0, -90.0), (0.79, 0.0));
    // The corner of the turned box, and its side.
    near(hit(2.5, 2.0, 0.0), (0.5 - 0.2 * 2f64.sqrt(), FRAC_PI_4));
    near(hit(2.5, 1.5, 45.0), (0.5 * 2f64.sqrt() - 0.2, 0.0));
    // Off the middle of a circle: sin θ = offset / radius.
    near(
        hit(0.3, 2.5 - 0.125, 0.0),
        (
            0.7 - (0.25_f64.powi(2) - 0.125_f64.powi(2)).sqrt(),
            30f64.to_radians(),
        ),
    );
    let oblique = arena.cast([1.0, 1.0], 20f64.to_radians()).unwrap();
    assert!((oblique.incidence_rad - 20f64.to_radians()).abs() < 1e-7);
    // From inside of an object it is at the surface already.
    assert_eq!(arena.cast([2.0, 1.0], 0.3).unwrap().distance_m, 0.0);
    assert_eq!(
        arena
            .object_at([2.0, 1.0])
            .map(|k| arena.clearance_m([2.0, 1.0]) < 0.0 && k > 3),
        Some(true)
    );
    // A cone sees what its line misses.
    let line = arena.cast([0.5, 2.1], 0.0).unwrap();
    let cone = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 9).unwrap();
    assert!(cone.distance_m < line.distance_m && cone.offset_rad > 0.0);
    let same = arena.cast_cone([0.5, 2.1], 0.0, 0.35, 1).unwrap();
    assert_eq!(same.distance_m, line.distance_m);
}

#[test]
fn an_open_field_returns_nothing_and_steps_along_a_beam_reach_the_object() {
    let arena = arena("boundary: Open, circles: [(centre_m: (2.0, 1.5), radius_m: 0.3)]").unwrap();
    assert!(arena.cast([0.5, 1.5], std::f64::consts::PI).is_none());
    for k in 0..400 {
        let angle = f64::from(k) / 400.0 * std::f64::consts::TAU;
        let Some(hit) = arena.cast([0.5, 1.2], angle) else {
            continue;
        };
        let (sin, cos) = angle.sin_cos();
        let at = [0.5 + hit.distance_m * cos, 1.2 + hit.distance_m * sin];
        assert!(arena.clearance_m(at).abs() < 1e-9);
    }
}

#[test]
fn an_arena_that_cannot_be_is_refused() {
    for (body, said) in [
        (
            "boundary: Open, boxes: [(centre_m: (1.0, 1.0), half_m: (0.0, 1.0))]",
            "not a box",
        ),
        (
            "boundary: Open, circles: [(centre_m: (1.0, 1.0), radius_m: -1.0)]",
            "not a circle",
        ),
        (
            "boundary: Open, walls: [(from_m: (1.0, 1.0), to_m: (1.0, 1.0))]",
            "not a wall",
        ),
        (
            "boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]",
            "do not close",
        ),
        (
            "boundary: Solid, boxes: [(centre_m: (1.0, 1.0), half_m: (0.5, 0.5))], start: (x_m: 1.0, y_m: 1.0)",
            "cannot start here",
        ),
        (
            "boundary: Solid, start: (x_m: 9.0, y_m: 1.0)",
            "inside of the field",
        ),
        ("boundary: Closed", "Solid, Open"),
    ] {
        let error = arena(body).unwrap_err().to_string();
        assert!(
            error.contains(said) && error.contains("arena.ron:1:"),
            "{error}"
        );
    }
    let closed =
        arena("boundary: Open, outline_m: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)]")
            .unwrap();
    assert_eq!(closed.objects.len(), 3);
}

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

/// A cube of 0.1 m that slides from the origin at 1 m/s along `heading_rad`, without friction.
fn sliding(heading_rad: f64) -> Experiment {
    let path = common::project().join("morphologies/cube.ron");
    let mut experiment = Experiment::new(Morphology::read(path).unwrap().assemble());
    experiment.floor.friction = 0.0;
    experiment.duration_s = 3.0;
    let half_m = 0.5 * experiment.assembly.body_length_m;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, half_m),
        orientation_world_from_body: turn,
        velocity_world_m_s: turn * Vector3::x(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    experiment
}

/// How far out it comes, metres.
fn farthest_m(experiment: &Experiment) -> f64 {
    experiment.check().unwrap();
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    let far = motion.positions_world_m().iter().map(|p| p.xy().norm());
    far.fold(0.0, f64::max)
}

#[test]
fn walls_boxes_and_circles_stop_a_robot_where_beams_meet_them() {
    let plan = arena(
        "boundary: Open,
        walls: [(from_m: (2.0, 0.5), to_m: (2.0, 2.5), thickness_m: 0.1)],
        boxes: [(centre_m: (1.0, 2.5), half_m: (0.3, 0.3), turn_deg: 45)],
        circles: [(centre_m: (0.2, 1.5), radius_m: 0.2)],
        start: (x_m: 1.0, y_m: 1.5, heading_deg: 0.0)",
    )
    .unwrap();
    let scene = SceneBody::of_arena(&plan, true).unwrap();
    for heading_deg in [0.0_f64, 90.0, 180.0] {
        let mut experiment = sliding(heading_deg.to_radians());
        assert!(
            farthest_m(&experiment) > 2.5,
            "nothing stops it without walls"
        );
        let half_m = 0.5 * experiment.assembly.body_length_m;
        experiment.scene.push(scene.clone());
        let beam = plan.cast([1.0, 1.5], heading_deg.to_radians()).unwrap();
        let off_m = farthest_m(&experiment) - (beam.distance_m - half_m);
        // A circle is a polygon whose sides lie 2 % of its radius inside of it; a turned box is met by an edge of the cube.
        assert!((-0.01..0.01).contains(&off_m), "{heading_deg}: {off_m}");
    }
}

#[test]
fn a_robot_that_starts_in_a_wall_is_refused_before_it_runs() {
    let plan = |x: f64| {
        let text = format!(
            "boundary: Solid, boxes: [(centre_m: ({x:?}, 1.5), half_m: (0.1, 0.1))], start: (x_m: 1.0, y_m: 1.5)"
        );
        SceneBody::of_arena(&arena(&text).unwrap(), true).unwrap()
    };
    let mut experiment = sliding(0.0);
    let half_m = 0.5 * experiment.assembly.body_length_m;
    experiment.scene = vec![plan(1.0 + 0.1 + 0.5 * half_m)];
    let error = experiment.check().unwrap_err().to_string();
    assert!(error.contains("starts in a wall"), "{error}");
    experiment.start = Start::Settled;
    assert!(experiment.check().is_err());
    experiment.scene = vec![plan(1.0 + 0.1 + 1.1 * half_m)];
    experiment.check().unwrap();
    // In the coordinates of the arena the origin is its corner, and the walls around it are there.
    let nowhere = arena("boundary: Solid").unwrap();
    assert!(
        SceneBody::of_arena(&nowhere, true)
            .unwrap_err()
            .to_string()
            .contains("where robots start")
    );
    experiment.scene = vec![SceneBody::of_arena(&nowhere, false).unwrap()];
    assert!(experiment.check().is_err());
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
