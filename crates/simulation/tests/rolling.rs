//! Tests of robots of bodies: shapes and joints of all kinds against closed-form solutions.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use realgap_path::trajectory::{State, Trajectory};
use realgap_simulation::{Experiment, Sampling, Snapshot, Start, run, watch};

use crate::bodies::robot;

const GRAVITY_M_S2: f64 = 9.81;

fn experiment(text: &str) -> Experiment {
    Experiment::new(robot(text).assemble())
}

fn track(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

/// A body on the floor at rest, its centre at this height above it.
fn at_rest(experiment: &mut Experiment, height_m: f64) {
    let normal = experiment.floor.normal_world();
    experiment.start = Start::State(State {
        position_world_m: normal * height_m,
        orientation_world_from_body: nalgebra::UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::zeros(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
}

/// Acceleration of a body down a slope, as a fraction of g sin α.
fn share_of_free_fall(shape: &str) -> f64 {
    let text =
        format!(r#"(name: "ball", bodies: [(name: "ball", mass_kg: 0.5, shapes: [{shape}])])"#);
    let mut experiment = experiment(&text);
    experiment.floor.slope_rad = 0.2;
    experiment.floor.friction = 0.8;
    at_rest(&mut experiment, 0.05);
    experiment.duration_s = 1.0;
    let path = track(&experiment);
    let down = Vector3::new(0.2_f64.cos(), 0.0, -(0.2_f64.sin()));
    let way_m = path.net_displacement_world_m().dot(&down);
    2.0 * way_m / (GRAVITY_M_S2 * 0.2_f64.sin())
}

#[test]
fn a_ball_rolls_down_a_slope_at_five_sevenths_and_a_cylinder_at_two_thirds() {
    let ball = share_of_free_fall("(form: Sphere(radius_m: 0.05))");
    assert!((ball * 7.0 / 5.0 - 1.0).abs() < 0.01, "{ball}");
    let across = format!(
        "(form: Cylinder(radius_m: 0.05, length_m: 0.1), pose: (rpy_rad: ({}, 0, 0)))",
        PI / 2.0
    );
    let cylinder = share_of_free_fall(&across);
    assert!((cylinder * 1.5 - 1.0).abs() < 0.01, "{cylinder}");
}

/// A cart on two wheels with a ball as a caster, each wheel turning at its own constant speed.
fn cart(left_rad_s: f64, right_rad_s: f64) -> Experiment {
    let wheel = |name: &str, y: f64| {
        format!(
            r#"(name: "{name}", mass_kg: 0.05, shapes: [(form: Cylinder(radius_m: 0.04, length_m: 0.01), pose: (rpy_rad: (1.5707963267948966, 0, 0)))])|(name: "{name}_axle", parent: "chassis", child: "{name}", pose: (at_m: (0, {y}, 0)), kind: Turn(axis: (0, 1, 0)))"#
        )
    };
    let (left, right) = (wheel("left", 0.1), wheel("right", -0.1));
    let ((a, b), (c, d)) = (
        left.split_once('|').unwrap(),
        right.split_once('|').unwrap(),
    );
    // The sine is so slow that it is practically a straight line: the wheel's angle grows at a constant speed.
    let servo = |joint: &str, speed: f64| {
        format!(
            r#"(joint: "{joint}_axle", servo: (law: Velocity(gain_1_s: 50), max_torque_nm: 1), gait: (amplitude_rad: 1000, frequency_hz: {}))"#,
            speed / (TAU * 1000.0)
        )
    };
    let text = format!(
        r#"(name: "cart", bodies: [
            (name: "chassis", mass_kg: 1, centre_of_mass_m: (-0.01, 0, 0), inertia_kg_m2: (xx: 0.003, yy: 0.003, zz: 0.005),
                shapes: [(form: Sphere(radius_m: 0.01), pose: (at_m: (-0.1, 0, -0.03)))]), {a}, {c}],
            joints: [{b}, {d}], actuators: [{}, {}])"#,
        servo("left", left_rad_s),
        servo("right", right_rad_s)
    );
    experiment(&text)
}

#[test]
fn wheels_roll_at_omega_r_and_turn_on_the_circle_of_their_track_width() {
    let mut straight = cart(5.0, 5.0);
    straight.duration_s = 4.0;
    straight.floor.friction = 0.8;
    let path = track(&straight);
    let places = path.positions_world_m();
    let half = places.len() / 2;
    let speed_m_s = (places[places.len() - 1] - places[half]).norm() / (path.duration_s() / 2.0);
    assert!((speed_m_s / (5.0 * 0.04) - 1.0).abs() < 0.01, "{speed_m_s}");
    // With speeds of inner and outer wheel of 2 : 3, the middle moves on a circle of radius w/2 (3 + 2) / (3 − 2).
    let mut turning = cart(4.0, 6.0);
    turning.duration_s = 6.0;
    turning.floor.friction = 0.8;
    let path = track(&turning);
    let headings: Vec<f64> = path
        .orientations_world_from_body()
        .unwrap()
        .iter()
        .map(|q| q.euler_angles().2)
        .collect();
    let places = path.positions_world_m();
    let (mut way_m, mut turned_rad) = (0.0, 0.0);
    for k in places.len() / 3..places.len() {
        way_m += (places[k] - places[k - 1]).norm();
        let turn = headings[k] - headings[k - 1];
        turned_rad += turn - TAU * (turn / TAU).round();
    }
    let radius_m = way_m / turned_rad;
    assert!((radius_m / 0.5 - 1.0).abs() < 0.01, "{radius_m}");
}

/// A mass on a slide that is fixed to the world.
fn slide(kind: &str, axis: &str) -> Experiment {
    experiment(&format!(
        r#"(name: "slide", mount: (at_m: (0, 0, 2)), bodies: [(name: "rail"),
            (name: "mass", mass_kg: 0.5, shapes: [(form: Box(sides_m: (0.05, 0.05, 0.05)))])],
            joints: [(name: "slide", parent: "rail", child: "mass", kind: Slide(axis: {axis}, {kind}))], track: "mass")"#
    ))
}

#[test]
fn a_slide_stops_at_its_limit() {
    let mut falling = slide("limits_m: (-0.3, 0.1)", "(0, 0, 1)");
    falling.duration_s = 1.5;
    let path = track(&falling);
    let mut heights = path.positions_world_m().iter().map(|p| p.z - 2.0);
    let lowest_m = heights.clone().fold(f64::INFINITY, f64::min);
    let last_m = heights.next_back().unwrap();
    assert!(
        (last_m + 0.3).abs() < 1e-3 && lowest_m > -0.31,
        "{last_m} {lowest_m}"
    );
}

#[test]
fn a_spring_on_a_slide_swings_at_the_root_of_stiffness_over_mass() {
    // ω = √(200/0.5) = 20 rad/s about the rest at 0.05 m.
    let mut swinging = slide("spring: (stiffness_n_m: 200, rest_m: 0.05)", "(1, 0, 0)");
    swinging.duration_s = 3.0;
    swinging.sampling = Sampling::Rate(480.0);
    let path = track(&swinging);
    let away: Vec<f64> = path
        .positions_world_m()
        .iter()
        .map(|p| p.x - 0.05)
        .collect();
    let crossings: Vec<usize> = (1..away.len())
        .filter(|&k| away[k - 1] < 0.0 && away[k] >= 0.0)
        .collect();
    let periods = (crossings.len() - 1) as f64;
    let span_s = (crossings[crossings.len() - 1] - crossings[0]) as f64 / 480.0;
    let omega = TAU * periods / span_s;
    assert!((omega / 20.0 - 1.0).abs() < 0.005, "{omega}");
    let late = away[away.len() / 2..]
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!((late / 0.05 - 1.0).abs() < 0.01, "{late}");
}

#[test]
fn a_spring_on_a_hinge_swings_by_its_own_inertia() {
    let mut swinging = experiment(
        r#"(name: "wheel", mount: (at_m: (0, 0, 1)), bodies: [(name: "hub"),
            (name: "wheel", mass_kg: 1, inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.02))],
            joints: [(name: "axle", parent: "hub", child: "wheel",
                kind: Turn(axis: (0, 0, 1), armature_kg_m2: 0.005, spring: (stiffness_nm_rad: 2.5, rest_rad: 0.4)))], track: "wheel")"#,
    );
    swinging.duration_s = 2.0;
    // ω = √(2.5/0.025) = 10 rad/s: after half a period the wheel is at twice its rest.
    let mut angles = Vec::new();
    watch(&swinging, &[], &mut |now: &Snapshot| {
        angles.push((now.time_s, now.hinges[0].angle_rad))
    })
    .unwrap();
    for (time_s, angle_rad) in angles {
        let expected = 0.4 * (1.0 - (10.0 * time_s).cos());
        assert!(
            (angle_rad - expected).abs() < 0.02,
            "{time_s}: {angle_rad} {expected}"
        );
    }
}

#[test]
fn bodies_fixed_to_each_other_are_one_rigid_part_and_swing_as_one_body() {
    let rod = |fixed: bool| {
        let joint = r#"(name: "pin", parent: "stand", child: "a", kind: Turn(axis: (0, 1, 0)))"#;
        match fixed {
            true => format!(
                r#"(name: "rod", mount: (at_m: (0, 0, 1)), bodies: [(name: "stand"),
                    (name: "a", mass_kg: 0.5, shapes: [(form: Box(sides_m: (0.2, 0.02, 0.02)), pose: (at_m: (0.1, 0, 0)))]),
                    (name: "b", mass_kg: 0.5, shapes: [(form: Box(sides_m: (0.2, 0.02, 0.02)))])],
                    joints: [{joint}, (name: "glue", parent: "a", child: "b", pose: (at_m: (0.3, 0, 0)), kind: Fixed)], track: "a")"#
            ),
            false => format!(
                r#"(name: "rod", mount: (at_m: (0, 0, 1)), bodies: [(name: "stand"),
                    (name: "a", mass_kg: 1, shapes: [(form: Box(sides_m: (0.4, 0.02, 0.02)), pose: (at_m: (0.2, 0, 0)))])],
                    joints: [{joint}], track: "a")"#
            ),
        }
    };
    let turned = |text: &str| {
        let mut experiment = experiment(text);
        experiment.duration_s = 0.3;
        assert_eq!(experiment.assembly.parts.len(), 2);
        let path = track(&experiment);
        path.orientations_world_from_body()
            .unwrap()
            .last()
            .unwrap()
            .angle()
    };
    let (two, one) = (turned(&rod(true)), turned(&rod(false)));
    assert!((two - one).abs() < 1e-9 && one > 0.5, "{two} {one}");
}

#[test]
fn a_commanded_torque_acts_at_the_joint() {
    let mut spun = experiment(
        r#"(name: "wheel", mount: (at_m: (0, 0, 1)), bodies: [(name: "hub"),
            (name: "wheel", mass_kg: 1, inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.02))],
            joints: [(name: "axle", parent: "hub", child: "wheel", kind: Turn(axis: (0, 0, 1)))],
            actuators: [(joint: "axle", servo: (law: Direct, max_torque_nm: 1), gait: (offset_rad: 0.01, amplitude_rad: 0, frequency_hz: 0))])"#,
    );
    spun.duration_s = 1.0;
    let mut last = 0.0;
    watch(&spun, &[], &mut |now: &Snapshot| {
        last = now.parts[1].angular_velocity_world_rad_s.z
    })
    .unwrap();
    // 0.01 N m on 0.02 kg m² for 1 s.
    assert!((last - 0.5).abs() < 0.005, "{last}");
}
