//! Tosses of two hinged boxes.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(dead_code, reason = "not every test uses all of it")]

use nalgebra::{UnitQuaternion, Vector3};
use realgap_path::trajectory::{Recording, State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::by_name;
use realgap_simulation::{Experiment, JointFormulation, JointState, Sampling, Start, run};

use crate::common;

pub fn elbow() -> Experiment {
    let path = common::project().join("morphologies/elbow.ron");
    Experiment::new(Morphology::read(path).unwrap().assemble())
}

/// A toss of number `k`, simulated with fine steps.
pub fn toss(mut experiment: Experiment, k: u32, seconds: f64) -> Trajectory {
    let turn = |a: f64| f64::from(k) * a;
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, 0.6),
        orientation_world_from_body: UnitQuaternion::from_scaled_axis(Vector3::new(
            turn(0.7).sin(),
            turn(1.3).cos(),
            turn(2.1).sin(),
        )),
        velocity_world_m_s: Vector3::new(0.3, 0.1 * turn(0.9).cos(), 0.4),
        angular_velocity_body_rad_s: Vector3::new(
            4.0 * turn(1.1).sin(),
            3.0 * turn(0.4).cos(),
            5.0 * turn(1.7).sin(),
        ),
    });
    experiment.start_joints = vec![JointState {
        angle_rad: turn(0.8),
        speed_rad_s: 6.0 * turn(2.3).sin(),
    }];
    if !experiment.assembly.is_compliant() {
        experiment.solver.joint = JointFormulation::Multibody;
    }
    experiment.solver.timestep_s = 1.0 / (148.0 * 32.0);
    experiment.duration_s = seconds;
    let samples = (seconds * 148.0).floor() as u32;
    let times: Vec<f64> = (0..=samples).map(|s| f64::from(s) / 148.0).collect();
    experiment.sampling = Sampling::Times(times.into());
    run(&experiment).unwrap().outcome.completed().unwrap()
}

pub fn recorded(name: &str, trajectory: Trajectory) -> Recording {
    Recording {
        name: name.to_owned(),
        path: name.into(),
        trajectory,
        log: None,
        bodies: Vec::new(),
        meta: None,
        reading: Default::default(),
        warnings: Vec::new(),
    }
}

pub fn set(experiment: &Experiment, values: &[(&str, f64)]) -> Experiment {
    values
        .iter()
        .fold(experiment.clone(), |experiment, (name, value)| {
            by_name(name).unwrap().apply(&experiment, *value).unwrap()
        })
}
