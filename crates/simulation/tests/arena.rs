//! Tests of arenas as obstacles: where walls, boxes and circles stop a robot, and refused starts.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;
use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::State;
use realgap_robot::morphology::Morphology;
use realgap_sensing::arena::Arena;
use realgap_simulation::{Experiment, SceneBody, Start, run};

fn arena(body: &str) -> realgap_core::Result<Arena> {
    Arena::parse(&Source::new(
        "arena.ron",
        format!("(name: \"a\", size_m: (4.0, 3.0), {body})"),
    ))
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

/// Largest distance from the origin that the cube reaches, metres.
fn farthest_m(experiment: &Experiment) -> f64 {
    experiment.check().unwrap();
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    let far = motion.positions_world_m().iter().map(|p| p.xy().norm());
    far.fold(0.0, f64::max)
}

#[test]
fn walls_boxes_and_circles_stop_a_robot_at_the_distance_that_a_beam_measures() {
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
    // In arena coordinates the origin is a corner of the arena, so the robot starts in the surrounding walls.
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
