//! Every parameter of the registry changes a run, is read back, and refuses what it must refuse.
//!
//! A parameter without a line in `case` is tried on both robots between two ends of its bounds, and fails
//! here if nothing moves: none can be added that is silently not applied.

#![allow(clippy::unwrap_used)] // a test may fail loudly

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use realgap::robot::morphology::Morphology;
use realgap::simulation::parameter::{self, Parameter};
use realgap::simulation::{Experiment, Start, run};
use realgap::trajectory::{State, Trajectory};

/// Less than this is no demonstration, metres.
const VISIBLE_M: f64 = 1e-4;

fn robot(name: &str) -> Experiment {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("morphologies/{name}.ron"));
    let mut experiment = Experiment::new(Morphology::read(path).unwrap().assemble());
    experiment.duration_s = 1.5;
    experiment
}

/// The tripod walks.
fn walk() -> Experiment {
    robot("tripod")
}

/// A cube flies, spins, hits the floor and slides.
fn toss() -> Experiment {
    let mut experiment = robot("cube");
    experiment.floor.restitution = 0.3;
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, 0.25),
        orientation_world_from_body: UnitQuaternion::from_scaled_axis(Vector3::new(0.4, 0.2, 0.1)),
        velocity_world_m_s: Vector3::new(0.8, 0.3, 0.0),
        angular_velocity_body_rad_s: Vector3::new(2.0, 5.0, 1.0),
    });
    experiment
}

/// Builds an experiment.
type Make = fn() -> Experiment;

/// Where a parameter is put to the test, and between which values.
fn case(parameter: &Parameter) -> (Vec<Make>, f64, f64) {
    let (low, high) = parameter.bounds;
    match parameter.name {
        "floor.friction" => (vec![toss, walk], 0.2, 0.6),
        "floor.restitution" => (vec![toss], 0.1, 0.6),
        "floor.height_m" => (vec![toss], 0.0, 0.01),
        "floor.slope_rad" => (vec![toss, walk], 0.0, 0.05),
        "gravity_m_s2" => (vec![toss, walk], 9.81, 9.6),
        "contact.prediction_m" => (vec![toss], 0.002, 0.01),
        "contact.natural_frequency_hz" => (vec![toss, walk], 60.0, 20.0),
        "contact.damping_ratio" => (vec![toss, walk], 10.0, 1.0),
        "contact.friction_model" => (vec![toss, walk], 0.0, 1.0),
        "timestep_s" => (vec![toss, walk], 1.0 / 240.0, 1.0 / 480.0),
        "solver.substeps" => (vec![toss, walk], 8.0, 16.0),
        "solver.sweeps" => (vec![toss, walk], 1.0, 4.0),
        "solver.relaxations" => (vec![walk], 0.0, 1.0),
        "solver.joint" => (vec![walk], 0.0, 1.0),
        // A lone cube moves the same whatever it weighs; a robot with servos does not.
        "body.mass_scale" => (vec![walk], 1.0, 2.0),
        "body.inertia_scale" => (vec![toss], 1.0, 1.5),
        "body.com_offset_x_m" | "body.com_offset_y_m" | "body.com_offset_z_m" => {
            (vec![toss], 0.0, 0.005)
        }
        "body.edge_radius_m" => (vec![toss], 0.0, 0.005),
        "servo.max_torque_nm" => (vec![walk], 0.2, 0.01),
        "servo.max_speed_rad_s" => (vec![walk], 8.0, 3.0),
        "servo.gain" => (vec![walk], 1.0, 0.5),
        "servo.latency_s" => (vec![walk], 0.0, 0.1),
        "servo.backlash_rad" => (vec![walk], 0.0, 0.1),
        "gait.frequency_scale" | "gait.amplitude_scale" => (vec![walk], 1.0, 0.7),
        _ => (
            vec![toss, walk],
            low + 0.01 * (high - low),
            low + 0.1 * (high - low),
        ),
    }
}

/// Parameters of recordings act on the comparison, not on a run; their own test has them.
fn simulated() -> impl Iterator<Item = &'static Parameter> {
    parameter::all().filter(|p| !p.name.starts_with("recording."))
}

fn path_of(experiment: &Experiment) -> Trajectory {
    let run = run(experiment).unwrap();
    run.outcome.completed().unwrap()
}

fn largest_distance_m(a: &Trajectory, b: &Trajectory) -> f64 {
    assert_eq!(a.len(), b.len());
    a.positions_world_m()
        .iter()
        .zip(b.positions_world_m())
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max)
}

#[test]
fn every_parameter_changes_a_run() {
    for parameter in simulated() {
        let (experiments, one, other) = case(parameter);
        for experiment in experiments {
            let base = experiment();
            let at = |value| path_of(&parameter.apply(&base, value).unwrap());
            let first = at(one);
            // A difference shows something only where the same value gives the same run.
            assert_eq!(first, at(one), "{} is not repeatable", parameter.name);
            let distance_m = largest_distance_m(&first, &at(other));
            assert!(
                distance_m > VISIBLE_M,
                "{} from {one} to {other} moves the run by {distance_m:.1e} m only",
                parameter.name
            );
        }
    }
}

#[test]
fn what_is_set_is_read_back_and_nothing_else_changes() {
    for parameter in parameter::all() {
        let (_, one, other) = case(parameter);
        let base = walk();
        for value in [one, other] {
            let changed = parameter.apply(&base, value).unwrap();
            assert_eq!((parameter.get)(&changed), Some(value), "{}", parameter.name);
            for unrelated in parameter::all().filter(|p| *p != parameter) {
                assert_eq!(
                    (unrelated.get)(&changed),
                    (unrelated.get)(&base),
                    "{} changes {}",
                    parameter.name,
                    unrelated.name
                );
            }
        }
    }
}

#[test]
fn values_out_of_bounds_are_refused_with_the_bounds_in_the_message() {
    for parameter in parameter::all() {
        let (low, high) = parameter.bounds;
        let mut refused = vec![low - 1.0, high + 1.0, f64::NAN, f64::INFINITY];
        if parameter.whole {
            refused.push(low + 0.5);
        }
        for value in refused {
            let error = parameter.apply(&walk(), value).unwrap_err().to_string();
            assert!(error.contains(parameter.name), "{error}");
            assert!(error.contains(&high.to_string()), "{error}");
        }
        for value in [low, high] {
            assert!(parameter.check(value).is_ok(), "{} {value}", parameter.name);
        }
    }
}

#[test]
fn defaults_are_allowed_values() {
    for parameter in parameter::all() {
        if let Some(value) = parameter.default_value() {
            assert!(parameter.check(value).is_ok(), "{} {value}", parameter.name);
        }
    }
}

/// The amplitude of a servo's answer falls with its gain for the torque law too.
#[test]
fn the_gain_means_something_for_both_servo_laws() {
    // chain3 has torque servos, the tripod velocity servos.
    for name in ["chain3", "tripod"] {
        let base = robot(name);
        let gain = parameter::by_name("servo.gain").unwrap();
        let lag = |value| {
            let run = run(&gain.apply(&base, value).unwrap()).unwrap();
            run.servo_rms_rad
        };
        assert!(
            lag(0.3) > 1.2 * lag(1.0),
            "{name}: {} {}",
            lag(0.3),
            lag(1.0)
        );
    }
}

#[test]
fn latency_shifts_the_answer_by_exactly_its_time() {
    use realgap::simulation::watch;
    let angles = |latency_s: f64| {
        let base = walk();
        let latency = parameter::by_name("servo.latency_s").unwrap();
        let mut experiment = latency.apply(&base, latency_s).unwrap();
        // In free space: no floor that mixes in.
        experiment.gravity_m_s2 = 0.0;
        experiment.floor.height_m = -5.0;
        experiment.start = Start::State(State {
            position_world_m: Vector3::zeros(),
            orientation_world_from_body: UnitQuaternion::identity(),
            velocity_world_m_s: Vector3::zeros(),
            angular_velocity_body_rad_s: Vector3::zeros(),
        });
        let mut angles = Vec::new();
        watch(&experiment, &[], &mut |s| {
            angles.push(s.hinges[0].angle_rad)
        })
        .unwrap();
        angles
    };
    let (steps, timestep_s) = (24, walk().solver.timestep_s);
    let (now, late) = (angles(0.0), angles(steps as f64 * timestep_s));
    for (index, angle) in late.iter().enumerate().skip(steps + 120) {
        // The first command begins inside a step, hence not bit for bit.
        assert!((angle - now[index - steps]).abs() < 2e-3, "at step {index}");
    }
}
