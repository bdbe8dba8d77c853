//! A bearing that gives way, against a mass on a spring and a damper.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::f64::consts::TAU;

use realgap_core::file::Source;
use realgap_engine::{Experiment, JointKind, engine_by_name, watch};
use realgap_robot::morphology::Morphology;

use crate::change::Change as _;

const FREQUENCY_HZ: f64 = 8.0;
const RATIO: f64 = 0.25;
const G: f64 = 9.81;

/// A weight under a stand that is held, its hinge upright and through both centres: all that it can do is sink.
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
    let robot = Morphology::parse(&Source::new("hanging.ron", text.to_owned())).unwrap();
    Experiment::new(robot.assemble())
        .with(|e| {
            e.solver.timestep_s = 0.001;
            e.solver.substeps = 8;
        })
        .lasting(1.0)
}

fn compliant() -> Experiment {
    hanging()
        .set("hinge.compliance_hz", FREQUENCY_HZ)
        .set("hinge.compliance_ratio", RATIO)
}

/// How far the weight has sunk over time, metres.
fn sunk_m(experiment: &Experiment) -> Vec<(f64, f64)> {
    let mut film = Vec::new();
    let run = watch(experiment, &[], &mut |s| {
        let heights = [0, 1].map(|part: usize| s.parts[part].centre_world_m.z);
        film.push((s.time_s, heights[0] - heights[1]));
    });
    assert!(run.unwrap().outcome.is_completed());
    let apart_m = film[0].1;
    film.iter().map(|(t, z)| (*t, z - apart_m)).collect()
}

#[test]
fn a_weight_on_a_bearing_that_gives_way_swings_as_on_a_spring_and_a_damper() {
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
fn a_bearing_that_does_not_give_way_holds() {
    let (_, sunk_m) = *sunk_m(&hanging()).last().unwrap();
    assert!(sunk_m.abs() < 1e-6, "{sunk_m}");
}

#[test]
fn a_bearing_gives_way_only_where_hinges_are_constraints() {
    let robot = compliant();
    assert_eq!(robot.joint_kind(), JointKind::Impulse);
    assert!(robot.second_engine().is_none());
    let error = robot
        .clone()
        .joined(JointKind::Multibody)
        .check()
        .unwrap_err()
        .to_string();
    assert!(error.contains("hinge.compliance_hz"), "{error}");
    let tree = engine_by_name("tree").unwrap().get();
    assert!(
        tree.refusal(&robot)
            .is_some_and(|why| why.contains("hinge.compliance_hz"))
    );
    assert!(tree.refusal(&hanging()).is_none());
    let counted = robot.with(|e| e.energy_from_s = Some(0.1));
    assert!(counted.check().unwrap_err().to_string().contains("energy"));
}
