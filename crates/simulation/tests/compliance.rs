//! Tests of compliant bearings against a mass on a spring and a damper.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::TAU;
use std::sync::Arc;

use realgap_simulation::{Experiment, JointFormulation, engine_by_name, watch};

use crate::bodies::robot;
use crate::change::Change as _;

const FREQUENCY_HZ: f64 = 8.0;
const RATIO: f64 = 0.25;
const G: f64 = 9.81;

/// A weight under a fixed stand, with a vertical hinge through both centres: the weight can only move down.
fn hanging() -> Experiment {
    let text = r#"(
        name: "hanging",
        mount_m: (0, 0, 1),
        modules: [
            (name: "stand", kind: Passive(side_m: 0.05, mass_kg: 1)),
            (name: "weight", kind: Passive(side_m: 0.04, mass_kg: 0.3)),
        ],
        hinges: [(name: "shaft", parent: "stand", child: "weight", anchor_m: (0, 0, -0.05), child_anchor_m: (0, 0, 0.05),
            axis: (0, 0, 1))],
    )"#;
    Experiment::new(robot(text).assemble())
        .with(|e| {
            e.solver.timestep_s = 0.001;
            e.solver.substeps = 8;
        })
        .lasting(1.0)
}

fn compliant() -> Experiment {
    hanging()
        .set("hinge.bearing_hz", FREQUENCY_HZ)
        .set("hinge.bearing_ratio", RATIO)
}

/// Downward displacement of the weight over time, metres.
fn sunk_m(experiment: &Experiment) -> Vec<(f64, f64)> {
    let mut film = Vec::new();
    let run = watch(experiment, &[], &mut |s| {
        let heights = [0, 1].map(|part: usize| s.parts[part].centre_world_m.z);
        film.push((s.time_s, heights[0] - heights[1]));
    });
    assert!(run.unwrap().outcome.is_completed());
    let initial_m = film[0].1;
    film.iter().map(|(t, z)| (*t, z - initial_m)).collect()
}

#[test]
fn a_weight_on_a_compliant_bearing_swings_as_on_a_spring_and_a_damper() {
    let omega = TAU * FREQUENCY_HZ;
    let damped = omega * (1.0_f64 - RATIO * RATIO).sqrt();
    let sag_m = G / (omega * omega);
    let sunk = sunk_m(&compliant());
    let worst_m = sunk
        .iter()
        .map(|(t, z)| {
            let swing = (damped * t).cos() + RATIO * omega / damped * (damped * t).sin();
            let expected_m = sag_m * (1.0 - (-RATIO * omega * t).exp() * swing);
            (z - expected_m).abs()
        })
        .fold(0.0, f64::max);
    assert!(
        worst_m < 0.03 * sag_m,
        "{worst_m} of a sag of {sag_m}; at the end {:?}",
        sunk.last()
    );
}

#[test]
fn a_rigid_bearing_holds_the_weight() {
    let (_, sunk_m) = *sunk_m(&hanging()).last().unwrap();
    assert!(sunk_m.abs() < 1e-6, "{sunk_m}");
}

#[test]
fn the_oscillating_mass_at_a_bearing_is_the_reduced_mass_of_its_parts() {
    // The stand lies on the floor, and the equally heavy weight is above it: the reduced mass is half of one mass, but the spring
    // carries the weight of a whole one.
    let text = r#"(
        name: "standing",
        modules: [
            (name: "stand", kind: Passive(side_m: 0.2, mass_kg: 1)),
            (name: "weight", kind: Passive(side_m: 0.04, mass_kg: 1)),
        ],
        hinges: [(name: "shaft", parent: "stand", child: "weight", anchor_m: (0, 0, 0.2), child_anchor_m: (0, 0, 0),
            axis: (0, 0, 1))],
    )"#;
    let standing = Experiment::new(robot(text).assemble())
        .set("hinge.bearing_hz", FREQUENCY_HZ)
        .set("hinge.bearing_ratio", 1.0)
        .lasting(1.0);
    let mut sunk_m = 0.0;
    watch(&standing, &[], &mut |s| sunk_m = s.hinges[0].opening_m).unwrap();
    let expected_m = 2.0 * G / (TAU * FREQUENCY_HZ).powi(2);
    assert!(
        (sunk_m / expected_m - 1.0).abs() < 0.02,
        "{sunk_m} is not {expected_m}"
    );
}

/// The error with which an experiment is refused.
fn refusal(experiment: &Experiment) -> String {
    experiment.check().unwrap_err().to_string()
}

#[test]
fn bearings_are_compliant_with_impulse_joints_only() {
    let robot = compliant();
    robot.check().unwrap();
    assert_eq!(robot.joint_kind(), JointFormulation::Impulse);
    assert!(robot.second_engine().is_none() && hanging().second_engine().is_some());
    let tree = engine_by_name("tree").unwrap().get();
    assert!(
        tree.refusal(&robot)
            .is_some_and(|why| why.contains("hinge.bearing_hz"))
    );
    assert!(tree.refusal(&hanging()).is_none());
    assert!(refusal(&robot.clone().joined(JointFormulation::Multibody)).contains("multibody"));
    assert!(refusal(&robot.clone().with(|e| e.solver.relaxations = 1)).contains("relaxations"));
    assert!(refusal(&robot.clone().with(|e| e.energy_from_s = Some(0.1))).contains("energy"));
    let stopped = robot.clone().with(|e| {
        Arc::make_mut(&mut e.assembly).hinges[0].bearing.limits_rad = Some((-1.0, 1.0));
    });
    assert!(refusal(&stopped).contains("limits"));
    let light = robot.with(|e| {
        let weight = &mut Arc::make_mut(&mut e.assembly).parts[1];
        weight.solids[0].mass_kg = 1e-6;
    });
    assert!(refusal(&light).contains("almost no mass"));
}
