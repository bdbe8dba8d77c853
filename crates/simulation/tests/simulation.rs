//! Tests of basic properties of a simulation: reproducibility, start state, free fall, sampling, and divergence.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_path::trajectory::State;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{
    Camera, Distribution, Experiment, JointFormulation, Noise, Sampling, Start, run,
};

fn experiment(robot: &str) -> Experiment {
    let path = common::project()
        .join("morphologies")
        .join(robot)
        .with_extension("ron");
    Experiment::new(Morphology::read(path).unwrap().assemble())
}

fn flying(robot: &str, joint: JointFormulation) -> Experiment {
    let mut flying = experiment(robot);
    flying.solver.joint = joint;
    flying.floor.height_m = -10.0;
    flying.duration_s = 0.4;
    flying.start = Start::State(State {
        position_world_m: Vector3::new(0.1, -0.2, 1.0),
        orientation_world_from_body: UnitQuaternion::from_euler_angles(0.3, -0.4, 0.5),
        velocity_world_m_s: Vector3::new(1.0, 0.5, 2.0),
        angular_velocity_body_rad_s: Vector3::new(0.4, -0.3, 0.2),
    });
    flying
}

#[test]
fn the_same_experiment_gives_the_same_bits() {
    let mut walk = experiment("tripod");
    walk.duration_s = 2.0;
    let first = run(&walk).unwrap();
    let elsewhere = std::thread::scope(|scope| scope.spawn(|| run(&walk).unwrap()).join().unwrap());
    assert_eq!(first.outcome, elsewhere.outcome);
}

#[test]
fn a_run_does_not_change_its_experiment() {
    let walk = experiment("tripod");
    let before = walk.clone();
    run(&Experiment {
        duration_s: 0.1,
        ..walk.clone()
    })
    .unwrap();
    assert_eq!(walk, before);
}

#[test]
fn a_run_starts_with_the_stated_state() {
    for joint in [JointFormulation::Impulse, JointFormulation::Multibody] {
        for robot in ["cube", "tripod", "chain5"] {
            let flying = flying(robot, joint);
            let Start::State(state) = flying.start else {
                unreachable!()
            };
            let motion = run(&flying).unwrap().outcome.completed().unwrap();
            assert!(
                (motion.positions_world_m()[0] - state.position_world_m).norm() < 1e-12,
                "{robot}"
            );
            let turn = motion.orientations_world_from_body().unwrap()[0]
                .angle_to(&state.orientation_world_from_body);
            assert!(turn < 1e-7, "{robot}: {turn}");
            let linear = motion.velocities_world_m_s().unwrap()[0] - state.velocity_world_m_s;
            assert!(linear.norm() < 1e-12, "{robot} {joint:?}: {linear}");
            let angular = motion.angular_velocities_body_rad_s().unwrap()[0]
                - state.angular_velocity_body_rad_s;
            assert!(angular.norm() < 1e-12, "{robot} {joint:?}: {angular}");
        }
    }
}

/// z(t) = z0 + v t − g t²/2; symplectic Euler with timestep h is off by g t h / 2.
#[test]
fn a_cube_in_free_flight_follows_the_parabola() {
    let mut flying = flying("cube", JointFormulation::Impulse);
    flying.solver.timestep_s = 1.0 / 2000.0;
    flying.sampling = Sampling::Rate(100.0);
    let motion = run(&flying).unwrap().outcome.completed().unwrap();
    for (t, p) in motion.times_s().iter().zip(motion.positions_world_m()) {
        let expected = Vector3::new(0.1 + t, -0.2 + 0.5 * t, 1.0 + 2.0 * t - 0.5 * 9.81 * t * t);
        assert!(
            (p - expected).norm() <= 9.81 * t * 0.5 / 2000.0 + 1e-9,
            "t {t}: {p} instead of {expected}"
        );
    }
}

/// Internal torques of servos cannot move the centre of mass, so both formulations of joints must agree about its path.
#[test]
fn both_joint_formulations_give_the_same_flight() {
    let end = |joint| {
        let mut flying = flying("tripod", joint);
        flying.duration_s = 0.2;
        flying.adjustment.amplitude_scale = 0.0;
        let motion = run(&flying).unwrap().outcome.completed().unwrap();
        motion.positions_world_m()[motion.len() - 1]
    };
    let distance_m = (end(JointFormulation::Impulse) - end(JointFormulation::Multibody)).norm();
    assert!(distance_m < 1e-3, "a distance of {distance_m} m");
}

#[test]
fn samples_are_taken_at_the_stated_times() {
    let mut still = experiment("cube");
    still.duration_s = 0.51;
    still.sampling = Sampling::Rate(10.0);
    let motion = run(&still).unwrap().outcome.completed().unwrap();
    assert_eq!(motion.times_s(), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.51]);
}

#[test]
fn a_settled_robot_starts_at_rest_on_the_floor() {
    for height_m in [0.0, 0.7] {
        let mut still = experiment("cube");
        still.floor.height_m = height_m;
        still.duration_s = 0.5;
        let run = run(&still).unwrap();
        assert_eq!(run.warnings, []);
        for p in run.outcome.completed().unwrap().positions_world_m() {
            assert!((p.z - height_m - 0.0524).abs() < 5e-4, "{p}");
        }
    }
}

#[test]
fn a_diverged_run_is_an_outcome_without_a_trajectory() {
    let mut thrown = flying("cube", JointFormulation::Impulse);
    thrown.floor.height_m = -9.0;
    let Start::State(state) = &mut thrown.start else {
        unreachable!()
    };
    state.velocity_world_m_s = Vector3::new(0.0, 0.0, 2e3);
    let run = run(&thrown).unwrap();
    assert!(run.outcome.divergence().is_some(), "{:?}", run.outcome);
}

#[test]
fn settings_that_cannot_be_simulated_are_refused() {
    let base = experiment("cube");
    for bad in [
        Experiment {
            duration_s: 0.0,
            ..base.clone()
        },
        Experiment {
            duration_s: f64::NAN,
            ..base.clone()
        },
        Experiment {
            sampling: Sampling::Rate(0.0),
            ..base.clone()
        },
        Experiment {
            sampling: Sampling::Times([1.0, 0.5].into()),
            ..base.clone()
        },
    ] {
        assert!(run(&bad).is_err(), "{:?}", (bad.duration_s, bad.sampling));
    }
}

#[test]
fn a_repeat_can_be_replayed_alone() {
    let base = experiment("tripod");
    let noise = Noise::unmeasured_robot();
    let camera = Camera {
        position_m: Distribution::Normal(1e-3),
        angle_rad: Distribution::Normal(1e-2),
        time_s: Distribution::Normal(2e-3),
    };
    assert_eq!(noise.perturb(&base, 7, 3), noise.perturb(&base, 7, 3));
    assert_ne!(noise.perturb(&base, 7, 3), noise.perturb(&base, 7, 4));
    assert_ne!(noise.perturb(&base, 7, 3), noise.perturb(&base, 8, 3));
    let truth = run(&Experiment {
        duration_s: 0.2,
        ..base.clone()
    })
    .unwrap()
    .outcome
    .completed()
    .unwrap();
    assert_eq!(
        camera.record(&truth, 7, 3).unwrap(),
        camera.record(&truth, 7, 3).unwrap()
    );
}

/// The sample standard deviation of many draws is within 5 standard errors of the stated value.
#[test]
fn the_camera_error_has_the_stated_size() {
    let base = Experiment {
        duration_s: 20.0,
        sampling: Sampling::Rate(200.0),
        ..experiment("cube")
    };
    let truth = run(&base).unwrap().outcome.completed().unwrap();
    let camera = Camera {
        position_m: Distribution::Normal(2e-3),
        ..Camera::default()
    };
    let seen = camera.record(&truth, 1, 0).unwrap();
    let errors: Vec<f64> = truth
        .positions_world_m()
        .iter()
        .zip(seen.positions_world_m())
        .flat_map(|(a, b)| (b - a).iter().copied().collect::<Vec<_>>())
        .collect();
    let sd = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    let standard_error = 2e-3 / (2.0 * errors.len() as f64).sqrt();
    assert!((sd - 2e-3).abs() < 5.0 * standard_error, "{sd}");
}
