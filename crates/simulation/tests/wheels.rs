//! Tests of driven wheels with tyres: a small car whose throttle and steering are commanded by numbers without a unit.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{
    CommandTrack, EngineChoice, Experiment, Quantity, RAPIER, Sampling, Start, run,
};

use crate::change::Change as _;

const RADIUS_M: f64 = 0.03;
const WHEELS: [&str; 4] = ["fl", "fr", "rl", "rr"];
/// Torque of a wheel at full throttle and standstill, N m, and the speed at which it vanishes, rad/s.
const STALL_NM: f64 = 0.1;
const TOP_RAD_S: f64 = 100.0;
const LONG_M: f64 = 0.2;

/// A car of 1.2 kg that drives by all wheels, at 1 m/s, with a throttle and a steering that are held.
pub fn car(throttle: f64, steering: f64) -> Experiment {
    let text = include_str!("../../../tests/common/small_car.ron");
    let robot = Morphology::parse(&Source::new("car.ron", text)).unwrap();
    // A written robot is read back to an equal value.
    let again = Morphology::parse(&Source::new("again.ron", robot.to_ron().unwrap()));
    assert_eq!(again.unwrap(), robot);
    let mut experiment = Experiment::new(robot.assemble());
    experiment.start = Start::State(State {
        position_world_m: Vector3::zeros(),
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::x(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    experiment.floor.friction = 0.8;
    experiment.floor.restitution = 0.0;
    experiment.solver.timestep_s = 0.005;
    experiment.duration_s = 1.0;
    experiment.sampling = Sampling::Rate(200.0);
    for name in WHEELS {
        commanded(&mut experiment, name, throttle, Quantity::Duty);
        if name.starts_with('f') {
            commanded(
                &mut experiment,
                &format!("steer_{name}"),
                steering,
                Quantity::Position,
            );
        }
    }
    experiment
}

fn commanded(experiment: &mut Experiment, joint: &str, value: f64, quantity: Quantity) {
    let track = CommandTrack::new(vec![0.0], vec![value], None).unwrap();
    (experiment.commands).insert(joint.to_owned(), Arc::new(track.of(quantity)));
}

fn path(experiment: &Experiment) -> Trajectory {
    run(experiment).unwrap().outcome.completed().unwrap()
}

/// Speed over the last tenth of a second.
fn last_speed_m_s(experiment: &Experiment) -> f64 {
    let motion = path(experiment);
    let places_m = motion.positions_world_m();
    let last = places_m.len() - 1;
    (places_m[last] - places_m[last - 20]).norm() / 0.1
}

#[test]
fn a_car_without_throttle_rolls_on_at_the_speed_of_its_start() {
    let speed_m_s = last_speed_m_s(&car(0.0, 0.0));
    assert!((speed_m_s - 1.0).abs() < 1e-3, "{speed_m_s}");
    // Half of the dead zone is no throttle, either.
    assert_eq!(last_speed_m_s(&car(0.05, 0.0)), speed_m_s);
}

#[test]
fn a_throttle_accelerates_by_its_torque_which_falls_with_the_speed() {
    // m v' = share · (stall - stall v / (r top)) · 4 / r, with the inertia of the wheels.
    let wheel_kg_m2 = 0.4 * 0.05 * RADIUS_M * RADIUS_M;
    let moved_kg = 1.2 + 4.0 * wheel_kg_m2 / (RADIUS_M * RADIUS_M);
    let share = 0.3 - 0.1;
    let (push_n, top_m_s) = (4.0 * share * STALL_NM / RADIUS_M, TOP_RAD_S * RADIUS_M);
    let rate_1_s = push_n / (top_m_s * moved_kg);
    let right = top_m_s - (top_m_s - 1.0) * (-rate_1_s * 0.95_f64).exp();
    let found = last_speed_m_s(&car(0.3, 0.0));
    println!("throttle 0.3: {found:.4} for {right:.4} m/s");
    // Driving needs slip: up to 3 % of the speed here.
    assert!((found / right - 1.0).abs() < 0.01, "{found} {right}");
    let switched_off = car(0.3, 0.0).with(|e| {
        for name in WHEELS {
            let track = CommandTrack::new(vec![0.0], vec![0.3], Some(0.0)).unwrap();
            (e.commands).insert(name.to_owned(), Arc::new(track.of(Quantity::Duty)));
        }
    });
    assert!((last_speed_m_s(&switched_off) - 1.0).abs() < 1e-3);
}

#[test]
fn a_steered_car_turns_on_the_circle_of_its_wheels_and_twice_the_command_turns_it_more() {
    let turned_rad = |steering: f64| {
        let motion = path(&car(0.0, steering));
        let turns = motion.orientations_world_from_body().unwrap();
        turns[0].angle_to(turns.last().unwrap())
    };
    // 1 m/s for 1 s on a circle of 0.2 m / tan(0.4 · 0.1), the car a little wide of it, as tyres slip.
    let right = (0.4 * 0.1_f64).tan() / LONG_M;
    let found = turned_rad(0.1);
    println!("turned {found:.4} for {right:.4} rad");
    assert!((found / right - 1.0).abs() < 0.05, "{found} {right}");
    assert!(turned_rad(0.2) > 1.8 * found);
}

#[test]
fn a_fast_turn_is_wider_on_slippery_floors_and_a_slow_one_is_not() {
    let turned = |speed_m_s: f64, friction: f64| {
        let fast = car(0.0, 0.6).with(|e| {
            e.floor.friction = friction;
            if let Start::State(state) = &mut e.start {
                state.velocity_world_m_s = Vector3::x() * speed_m_s;
            }
            e.duration_s = 0.4 / speed_m_s;
        });
        let motion = path(&fast);
        let turns = motion.orientations_world_from_body().unwrap();
        turns[0].angle_to(turns.last().unwrap())
    };
    let change = |speed_m_s: f64| turned(speed_m_s, 0.9) / turned(speed_m_s, 0.3);
    assert!((change(0.4) - 1.0).abs() < 0.02, "{}", change(0.4));
    assert!(change(3.0) > 1.5, "{}", change(3.0));
}

#[test]
fn an_engine_without_tyres_says_that_another_one_simulates() {
    let mut asked = car(0.3, 0.1);
    asked.solver.engine = EngineChoice::new(&RAPIER);
    let answer = run(&asked).unwrap();
    let said = answer.warnings.iter().any(|w| w.message.contains("tyres"));
    assert!(said, "{:?}", answer.warnings);
    assert_eq!(path(&asked), path(&car(0.3, 0.1)));
}

#[test]
fn tyres_and_throttles_with_wrong_numbers_are_refused() {
    for (wrong, said) in [
        ("tyre: (slip_stiffness_1_rad: 0)", "slip_stiffness_1_rad"),
        ("tyre: (slip_stiffness_1_rad: 5, shape: 2)", "shape"),
        ("tyre: (slip_stiffness_1_rad: 5, width_m: 0.1)", "width_m"),
    ] {
        let text = format!(
            "(name: \"ball\", bodies: [(name: \"ball\", mass_kg: 1, shapes: [(form: Sphere(radius_m: 0.1), {wrong})])])"
        );
        let error = Morphology::parse(&Source::new("ball.ron", text)).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
    let endless = "(name: \"w\", bodies: [(name: \"a\", mass_kg: 1, shapes: [(form: Sphere(radius_m: 0.1))]), (name: \"b\", mass_kg: 1, shapes: [(form: Sphere(radius_m: 0.1))])], joints: [(name: \"j\", parent: \"a\", child: \"b\", kind: Turn(axis: (0, 1, 0)))], actuators: [(joint: \"j\", servo: (law: Throttle, max_torque_nm: 1))])";
    let error = Morphology::parse(&Source::new("w.ron", endless)).unwrap_err();
    assert!(error.to_string().contains("max_speed_rad_s"), "{error}");
}
