//! Tests of the energy balance against closed-form solutions, and of its residual for walking robots.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;

use std::f64::consts::PI;

use common::project;
use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{
    EnergyBalance, Experiment, FrictionModel, JointFormulation, JointState, Sampling, Start, run,
};

const G: f64 = 9.81;
const KINDS: [JointFormulation; 2] = [JointFormulation::Impulse, JointFormulation::Multibody];

/// Runs an experiment with and without the energy balance, checks that both runs are bit-identical, and returns the balance and
/// the path.
fn balance(experiment: &Experiment) -> (EnergyBalance, Trajectory) {
    let plain = run(experiment).unwrap();
    assert!(plain.energy.is_none());
    let mut counted = experiment.clone();
    counted.energy_from_s = Some(0.0);
    let counted = run(&counted).unwrap();
    assert_eq!(plain.outcome, counted.outcome);
    let path = counted.outcome.get().unwrap().clone();
    let energy = counted.energy.unwrap();
    let sum = energy.servo_j
        + energy.gravity_j
        + energy.contact_j
        + energy.friction_j
        + energy.joint_j
        + energy.slack_j
        + energy.residual_j;
    assert!((sum - energy.kinetic_j).abs() < 1e-12);
    (energy, path)
}

#[track_caller]
fn assert_near(value: f64, expected: f64, share: f64) {
    let error = (value - expected).abs();
    assert!(
        error <= share * expected.abs(),
        "{value} instead of {expected}"
    );
}

/// A stand, and a bar on a hinge at the stand; `hinge` states further fields of the hinge.
fn pendulum(kind: JointFormulation, hinge: &str) -> Experiment {
    let text = format!(
        r#"(
        name: "pendulum",
        mount_m: (0, 0, 1),
        modules: [
            (name: "stand", kind: Passive(side_m: 0.05, mass_kg: 1)),
            (name: "bar", kind: Passive(sides_m: (0.02, 0.01, 0.2), mass_kg: 0.3)),
        ],
        hinges: [(name: "shoulder", parent: "stand", child: "bar", anchor_m: (0, 0.05, 0), child_anchor_m: (0, 0, 0.1),
            axis: (0, 1, 0), {hinge})],
    )"#
    );
    let robot = Morphology::parse(&Source::new("pendulum.ron", text)).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    experiment.solver.joint = kind;
    experiment.duration_s = 1.0;
    // A quarter of the usual timestep, because a servo's command is constant during a step.
    experiment.solver.timestep_s = 1.0 / 1920.0;
    experiment.sampling = Sampling::Rate(480.0);
    experiment
}

/// Inertia of the bar about the hinge, kg m², and its mass times the distance of its centre, kg m.
const INERTIA_KG_M2: f64 = 0.3 * ((0.02 * 0.02 + 0.2 * 0.2) / 12.0 + 0.01);
const MOMENT_KG_M: f64 = 0.3 * 0.1;

/// A servo that raises the bar by a quarter turn in one second and then stands still for a moment.
const LIFT: &str = "servo: (max_torque_nm: 5, max_speed_rad_s: 20, law: Velocity(gain_1_s: 40)),
    gait: (amplitude_rad: 1.5707963, frequency_hz: 0.25)";

fn last(path: &Trajectory) -> JointState {
    let joint = &path.joints()[0];
    JointState {
        angle_rad: *joint.angles_rad.last().unwrap(),
        speed_rad_s: *joint.speeds_rad_s.as_ref().unwrap().last().unwrap(),
    }
}

#[test]
fn the_work_of_lifting_a_pendulum_is_its_weight_times_the_height() {
    for kind in KINDS {
        let (energy, path) = balance(&pendulum(kind, LIFT));
        let end = last(&path);
        let height_j = MOMENT_KG_M * G * (1.0 - end.angle_rad.cos());
        let speed_j = 0.5 * INERTIA_KG_M2 * end.speed_rad_s.powi(2);
        assert!(height_j > 0.25, "{height_j}");
        assert_near(energy.servo_j, height_j + speed_j, 0.005);
        assert_near(energy.gravity_j, -height_j, 0.005);
        assert!(energy.residual_share() < 0.005, "{energy:?}");
    }
}

#[test]
fn at_the_usual_timestep_the_work_of_lifting_is_exact_within_two_percent() {
    for kind in KINDS {
        let mut experiment = pendulum(kind, LIFT);
        experiment.solver.timestep_s = 1.0 / 480.0;
        let (energy, _) = balance(&experiment);
        assert_near(energy.servo_j, MOMENT_KG_M * G, 0.02);
        assert!(energy.residual_share() < 0.02, "{energy:?}");
    }
}

#[test]
fn in_free_space_all_work_of_a_servo_becomes_kinetic_energy() {
    for kind in KINDS {
        let mut experiment = pendulum(kind, LIFT);
        experiment.gravity_m_s2 = 0.0;
        // The bar swings back through its middle position at the commanded speed.
        experiment.duration_s = 2.0;
        let (energy, _) = balance(&experiment);
        let fastest_rad_s = 0.25 * PI * PI;
        let kinetic_j = 0.5 * INERTIA_KG_M2 * fastest_rad_s.powi(2);
        assert_near(energy.kinetic_j, kinetic_j, 0.015);
        assert_near(energy.servo_j, energy.kinetic_j, 0.005);
        // In between the bar had stopped, so the servo did negative work of the same size first.
        assert_near(energy.servo_positive_j, 2.0 * kinetic_j, 0.05);
    }
}

#[test]
fn the_loss_of_a_gear_is_the_work_of_its_motor_minus_that_on_the_load() {
    let motor = "servo: (max_torque_nm: 10, law: Motor(position_gain: 800, duty_1_rad: 0.003, supply_v: 7.2,
        torque_constant_nm_a: 0.4, resistance_ohm: 3.2, armature_kg_m2: 0.002, friction: (dry_nm: 0.05, viscous_nm_s_rad: 0.02))),
        gait: (amplitude_rad: 1.5707963, frequency_hz: 0.25)";
    for kind in KINDS {
        let (energy, path) = balance(&pendulum(kind, motor));
        let speeds = path.joints()[0].speeds_rad_s.clone().unwrap();
        let step_s = 1.0 / 480.0;
        let lost_j: f64 = speeds
            .iter()
            .map(|speed| (0.05 * speed.abs() + 0.02 * speed * speed) * step_s)
            .sum();
        assert!(lost_j > 0.1, "{lost_j}");
        assert_near(energy.joint_j, -lost_j, 0.03);
        let height_j = MOMENT_KG_M * G * (1.0 - last(&path).angle_rad.cos());
        assert_near(energy.servo_j, height_j + lost_j, 0.03);
        assert!(energy.residual_share() < 0.02, "{energy:?}");
    }
}

#[test]
fn the_work_of_hinge_friction_is_the_energy_that_the_swing_loses() {
    for kind in KINDS {
        let mut experiment = pendulum(kind, "viscous_nm_s_rad: 0.004");
        experiment.start_joints = vec![JointState {
            angle_rad: 1.2,
            speed_rad_s: 0.0,
        }];
        let (energy, path) = balance(&experiment);
        let end = last(&path);
        let fallen_j = MOMENT_KG_M * G * (end.angle_rad.cos() - 1.2_f64.cos());
        let lost_j = fallen_j - 0.5 * INERTIA_KG_M2 * end.speed_rad_s.powi(2);
        // An impulse joint opens a little, which also dissipates energy.
        assert_near(energy.joint_j + energy.slack_j, -lost_j, 0.01);
        assert!(energy.slack_j.abs() < 0.05 * lost_j);
        assert_eq!((energy.servo_j, energy.contact_j), (0.0, 0.0));
        assert!(energy.residual_j.abs() < 0.02 * lost_j, "{energy:?}");
    }
}

/// A cube at a height above the floor, with a speed.
fn cube(height_m: f64, velocity_world_m_s: Vector3<f64>) -> (Experiment, f64) {
    let robot = Morphology::read(project().join("morphologies/cube.ron")).unwrap();
    let mass_kg = robot.summary().mass_kg;
    let mut experiment = Experiment::new(robot.assemble());
    let half_m = 0.5 * experiment.assembly.body_length_m;
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, half_m + height_m),
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s,
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    (experiment, mass_kg)
}

#[test]
fn a_sliding_cube_loses_friction_times_weight_times_distance() {
    let (mut experiment, mass_kg) = cube(0.0, Vector3::new(0.8, 0.0, 0.0));
    experiment.floor.friction = 0.3;
    experiment.floor.restitution = 0.0;
    experiment.duration_s = 1.0;
    let (energy, path) = balance(&experiment);
    let distance_m = path.net_displacement_world_m().xy().norm();
    assert_near(energy.friction_j, -0.3 * mass_kg * G * distance_m, 0.01);
    assert_near(energy.friction_j, -0.5 * mass_kg * 0.64, 0.01);
    assert!(energy.residual_share() < 0.01, "{energy:?}");
}

#[test]
fn a_bouncing_cube_loses_one_minus_e_squared_of_its_fall() {
    let (mut experiment, mass_kg) = cube(0.2, Vector3::zeros());
    experiment.floor.restitution = 0.5;
    // The cube lands after 0.2 s and is in the air again at the end.
    experiment.duration_s = 0.25;
    let (energy, path) = balance(&experiment);
    let impact_j = mass_kg * G * 0.2;
    assert_near(energy.contact_j, -impact_j * (1.0 - 0.25), 0.05);
    let speed_m_s = path.velocities_world_m_s().unwrap().last().unwrap().norm();
    let spin_rad_s = path
        .angular_velocities_body_rad_s()
        .unwrap()
        .last()
        .unwrap();
    let kinetic_j =
        0.5 * mass_kg * speed_m_s.powi(2) + 0.5 * 8.099992e-4 * spin_rad_s.norm_squared();
    assert_near(energy.kinetic_j, kinetic_j, 1e-6);
    assert!(energy.friction_j.abs() < 1e-3 * impact_j);
    assert!(energy.residual_share() < 0.02, "{energy:?}");
}

fn walker(name: &str, kind: JointFormulation) -> Experiment {
    let path = project().join(format!("morphologies/{name}.ron"));
    let mut experiment = Experiment::new(Morphology::read(path).unwrap().assemble());
    experiment.solver.joint = kind;
    experiment.duration_s = 5.0;
    experiment
}

#[test]
fn the_balance_of_walkers_closes_and_both_joint_formulations_agree() {
    for name in ["tripod", "spider8", "chain5"] {
        let [impulse, multibody] = KINDS.map(|kind| {
            let (energy, _) = balance(&walker(name, kind));
            assert!(energy.servo_positive_j > 0.5, "{name} {energy:?}");
            assert!(energy.residual_share() < 0.02, "{name} {energy:?}");
            assert!(energy.contact_j < 0.0 && energy.friction_j < 0.0);
            energy
        });
        assert_near(impulse.servo_positive_j, multibody.servo_positive_j, 0.1);
    }
}

#[test]
fn shorter_steps_give_the_same_energy() {
    let experiment = walker("spider8", JointFormulation::Impulse);
    let mut fine = experiment.clone();
    fine.solver.timestep_s *= 0.25;
    let [coarse, fine] = [experiment, fine].map(|experiment| balance(&experiment).0);
    assert_near(coarse.servo_positive_j, fine.servo_positive_j, 0.05);
    assert!(fine.residual_share() <= coarse.residual_share() + 0.002);
}

#[test]
fn the_energy_balance_begins_at_the_stated_time() {
    let mut experiment = pendulum(JointFormulation::Impulse, LIFT);
    experiment.energy_from_s = Some(0.5);
    let late = run(&experiment).unwrap();
    let angles_rad = &late.outcome.get().unwrap().joints()[0].angles_rad;
    let height_j = |angle_rad: f64| -MOMENT_KG_M * G * angle_rad.cos();
    // There are 480 samples per second.
    let lifted_j = height_j(angles_rad[480]) - height_j(angles_rad[240]);
    assert_near(late.energy.unwrap().gravity_j, -lifted_j, 0.005);
}

#[test]
fn an_impossible_energy_balance_is_refused() {
    let mut experiment = walker("chain3", JointFormulation::Impulse);
    experiment.energy_from_s = Some(5.0);
    let error = run(&experiment).unwrap_err().to_string();
    assert!(error.contains("energy_from_s"), "{error}");
    experiment.energy_from_s = Some(0.0);
    experiment.contact.friction_model = FrictionModel::Simplified;
    let error = run(&experiment).unwrap_err().to_string();
    assert!(error.contains("friction"), "{error}");
    // Multibody contacts have friction at every point, for every friction model.
    experiment.solver.joint = JointFormulation::Multibody;
    assert!(run(&experiment).unwrap().energy.is_some());
}
