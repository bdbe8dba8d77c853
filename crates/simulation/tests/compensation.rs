//! Compensation of weight and scales of commands, against closed forms.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use realgap_robot::morphology::Morphology;
use realgap_simulation::export::{Robot, format_named};
use realgap_simulation::{
    CommandTrack, ENGINES, EngineChoice, Experiment, JointFormulation, JointState, Quantity, run,
};

use crate::bodies::robot;

const G: f64 = 9.81;

/// Every engine, and both kinds of joints of the engine that has two.
fn experiments(morphology: &Morphology, duration_s: f64) -> Vec<Experiment> {
    let kinds = [JointFormulation::Impulse, JointFormulation::Multibody];
    let all = ENGINES
        .iter()
        .flat_map(|engine| kinds.map(|kind| (*engine, kind)));
    let made = all.map(|(engine, kind): (EngineChoice, JointFormulation)| {
        let mut experiment = Experiment::new(morphology.assemble());
        experiment.solver.engine = engine;
        experiment.solver.joint = kind;
        experiment.solver.timestep_s = 1.0 / 2000.0;
        experiment.duration_s = duration_s;
        experiment.start_joints = vec![JointState {
            angle_rad: 0.0,
            speed_rad_s: 0.0,
        }];
        experiment
    });
    made.collect()
}

fn last(experiment: &Experiment, joint: &str) -> f64 {
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    *motion.joint(joint).unwrap().angles_rad.last().unwrap()
}

/// A weight on a vertical slide.
fn lift(share: f64) -> Morphology {
    robot(&format!(
        r#"(name: "lift", mount: (at_m: (0, 0, 9)), bodies: [
            (name: "rail", mass_kg: 1, inertia_kg_m2: (xx: 1, yy: 1, zz: 1)),
            (name: "weight", mass_kg: 2, inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.01), gravity_compensation: {share}),
        ], joints: [(name: "j", parent: "rail", child: "weight", kind: Slide(axis: (0, 0, 1)))])"#
    ))
}

#[test]
fn a_body_falls_with_the_share_of_its_weight_that_is_not_compensated() {
    for share in [0.0, 0.75, 1.0, 1.5] {
        for experiment in experiments(&lift(share), 0.5) {
            let fall_m = last(&experiment, "j");
            let expected_m = -0.5 * (1.0 - share) * G * 0.25;
            let engine = experiment.solver.engine.get().name();
            // The integrators are exact to half of a step.
            assert!(
                (fall_m - expected_m).abs() < 2e-3,
                "{engine} {share}: {fall_m} {expected_m}"
            );
        }
    }
}

#[test]
fn a_compensated_body_in_a_part_of_two_does_not_pull_at_their_joint() {
    // An arm along x of two balls, of which the farther one floats: the torque about the joint is that of the nearer one alone.
    let morphology = robot(
        r#"(name: "arm", mount: (at_m: (0, 0, 9)), bodies: [
            (name: "stand", mass_kg: 1, inertia_kg_m2: (xx: 1, yy: 1, zz: 1)),
            (name: "near", mass_kg: 2, centre_of_mass_m: (0.1, 0, 0), inertia_kg_m2: (xx: 0.02, yy: 0.02, zz: 0.02)),
            (name: "far", mass_kg: 1, inertia_kg_m2: (xx: 0.01, yy: 0.01, zz: 0.01), gravity_compensation: 1),
        ], joints: [
            (name: "j", parent: "stand", child: "near", kind: Turn(axis: (0, 1, 0))),
            (name: "tool", parent: "near", child: "far", pose: (at_m: (0.3, 0, 0)), kind: Fixed),
        ])"#,
    );
    let inertia = 0.02 + 2.0 * 0.01 + 0.01 + 1.0 * 0.09;
    let duration_s = 0.1;
    let expected_rad = 0.5 * (2.0 * G * 0.1 / inertia) * duration_s * duration_s;
    for experiment in experiments(&morphology, duration_s) {
        let angle_rad = last(&experiment, "j");
        assert!(
            (angle_rad / expected_rad - 1.0).abs() < 0.02,
            "{}: {angle_rad} {expected_rad}",
            experiment.solver.engine.get().name()
        );
    }
}

#[test]
fn the_balance_of_energy_counts_the_compensation() {
    for mut experiment in experiments(&lift(0.75), 0.5) {
        experiment.energy_from_s = Some(0.0);
        let balance = run(&experiment).unwrap().energy.unwrap();
        let expected_j = 2.0 * G * 0.25 * (0.5 * 0.25 * G * 0.25);
        assert!(
            (balance.gravity_j / expected_j - 1.0).abs() < 0.01,
            "{balance:?}"
        );
        assert!(balance.residual_j.abs() < 1e-3 * expected_j, "{balance:?}");
    }
}

fn geared(law: &str) -> Morphology {
    robot(&format!(
        r#"(name: "geared", mount: (at_m: (0, 0, 9)), bodies: [
            (name: "stand", mass_kg: 1, inertia_kg_m2: (xx: 1, yy: 1, zz: 1)),
            (name: "wheel", mass_kg: 1, inertia_kg_m2: (xx: 0.02, yy: 0.02, zz: 0.02)),
        ], joints: [(name: "j", parent: "stand", child: "wheel", kind: Turn(axis: (0, 1, 0)))],
        actuators: [(joint: "j", servo: (law: {law}, max_torque_nm: 100),
            command: (factor: 0.5, offset: 0.1, range: (-1, 1)))])"#
    ))
}

#[test]
fn recorded_commands_pass_through_the_scale_of_their_actuator() {
    let servo = geared("Torque(stiffness_nm_rad: 50, damping_nm_s_rad: 2)");
    // Commands beyond the range count as its end.
    for (command, expected_rad) in [(0.4, 0.3), (3.0, 0.6), (-3.0, -0.4)] {
        for mut experiment in experiments(&servo, 3.0) {
            let track = CommandTrack::new(vec![0.0], vec![command], None).unwrap();
            experiment.commands.insert("j".to_owned(), track.into());
            let angle_rad = last(&experiment, "j");
            assert!(
                (angle_rad - expected_rad).abs() < 1e-3,
                "{angle_rad} {expected_rad}"
            );
        }
    }
    let motor = geared("Direct");
    for mut experiment in experiments(&motor, 0.5) {
        let track = CommandTrack::new(vec![0.0], vec![0.4], None).unwrap();
        experiment
            .commands
            .insert("j".to_owned(), track.of(Quantity::Torque).into());
        // 0.3 N m turn 0.02 kg m² by half of 15 rad/s² times the square of the time.
        let angle_rad = last(&experiment, "j");
        assert!((angle_rad / 1.875 - 1.0).abs() < 0.01, "{angle_rad}");
    }
}

#[test]
fn compensation_and_scale_are_exported_to_mjcf() {
    let render = |morphology: &Morphology| {
        let experiment = Experiment::new(morphology.assemble());
        let format = format_named("mjcf").unwrap();
        format.render(&Robot::new(morphology, &experiment)).text
    };
    assert!(render(&lift(0.75)).contains("gravcomp=\"0.75\""));
    let text = render(&geared("Torque(stiffness_nm_rad: 50, damping_nm_s_rad: 2)"));
    for part in [
        "gainprm=\"25\"",
        "biasprm=\"5 -50 -2\"",
        "ctrlrange=\"-1 1\"",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn a_motor_without_commands_exerts_no_torque_where_its_joint_cannot_be_at_0() {
    let morphology = robot(
        r#"(name: "knee", mount: (at_m: (0, 0, 9)), bodies: [
            (name: "stand", mass_kg: 1, inertia_kg_m2: (xx: 1, yy: 1, zz: 1)),
            (name: "shank", mass_kg: 1, inertia_kg_m2: (xx: 0.02, yy: 0.02, zz: 0.02)),
        ], joints: [(name: "j", parent: "stand", child: "shank",
            kind: Turn(axis: (0, 1, 0), limits_rad: (-2.7, -0.8)))],
        actuators: [(joint: "j", servo: (law: Direct, max_torque_nm: 100))])"#,
    );
    for mut experiment in experiments(&morphology, 0.5) {
        experiment.start_joints[0].angle_rad = -1.7;
        let angle_rad = last(&experiment, "j");
        assert!((angle_rad + 1.7).abs() < 1e-6, "{angle_rad}");
    }
}
