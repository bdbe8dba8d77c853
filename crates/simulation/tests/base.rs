//! A base that is led along a recorded pose, against closed forms.

#![allow(clippy::unwrap_used)] // a test may fail loudly

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::Source;
use realgap_core::warning::Code;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Experiment, Instrument, JointState, run};

use crate::change::Change as _;

const G_M_S2: f64 = 9.81;
/// How far the bob is below the joint, metres.
const ARM_M: f64 = 0.3;

/// A pendulum about y under a stand that its file holds, or not; the bob is small.
fn pendulum(mount: &str) -> Experiment {
    let text = format!(
        r#"(name: "pendulum", {mount} bodies: [
    (name: "stand", mass_kg: 2, shapes: [(form: Box(sides_m: (0.1, 0.1, 0.1)))]),
    (name: "bob", mass_kg: 1, centre_of_mass_m: (0, 0, -{ARM_M}), inertia_kg_m2: (xx: 1e-5, yy: 1e-5, zz: 1e-5)),
], joints: [(name: "swing", parent: "stand", child: "bob", kind: Turn(axis: (0, 1, 0)))], track: "stand")"#
    );
    let robot = Morphology::parse(&Source::new("pendulum", text)).unwrap();
    Experiment::new(robot.assemble())
        .lasting(2.0)
        .with(|e| e.solver.timestep_s = 1e-3)
}

/// Poses of a stand at 100 Hz for 3 s.
fn recorded(
    place_m: impl Fn(f64) -> Vector3<f64>,
    turn: impl Fn(f64) -> Vector3<f64>,
) -> Trajectory {
    let times_s: Vec<f64> = (0..=300).map(|k| 0.01 * f64::from(k)).collect();
    let places = times_s.iter().map(|t| place_m(*t)).collect();
    let turns = times_s
        .iter()
        .map(|t| UnitQuaternion::from_scaled_axis(turn(*t)));
    let motion = Trajectory::new(times_s.clone(), places).unwrap();
    motion.with_orientations(turns.collect()).unwrap()
}

fn led(mut experiment: Experiment, motion: &Trajectory) -> Experiment {
    experiment.lead_base(motion).unwrap();
    experiment
}

fn swing_rad(experiment: &Experiment) -> Vec<f64> {
    let motion = run(experiment).unwrap().outcome.completed().unwrap();
    motion.joint("swing").unwrap().angles_rad.clone()
}

#[test]
fn under_a_stand_that_accelerates_a_pendulum_hangs_at_the_angle_of_both_accelerations_and_rapier_says_that_it_cannot()
 {
    let a_m_s2 = 2.0;
    let still = |_: f64| Vector3::zeros();
    let hangs_rad = (a_m_s2 / G_M_S2).atan();
    for mount in ["mount: (at_m: (0, 0, 2)),", ""] {
        let motion = recorded(
            |t| Vector3::new(0.5 * a_m_s2 * t * t + 3.0, -1.0, 2.0),
            still,
        );
        let mut experiment = led(pendulum(mount), &motion);
        experiment.start_joints = vec![JointState {
            angle_rad: hangs_rad,
            speed_rad_s: 0.0,
        }];
        let angles = swing_rad(&experiment);
        let off = angles
            .iter()
            .fold(0.0_f64, |most, a| most.max((a - hangs_rad).abs()));
        assert!(off < 1e-4, "{off}");
        let done = run(&experiment).unwrap();
        assert!(done.warnings.iter().any(|w| w.code == Code::EngineFallback));
        let path = done.outcome.completed().unwrap();
        let end = path.positions_world_m()[path.len() - 1];
        assert!((end - Vector3::new(7.0, -1.0, 2.0)).norm() < 1e-9, "{end}");
        assert_eq!(experiment.second_engine(), None);
    }
}

#[test]
fn twice_the_recorded_shake_is_twice_the_swing_and_a_stand_that_turns_takes_its_pendulum_along() {
    let still = |_: f64| Vector3::zeros();
    let shaken = |far_m: f64| {
        let motion = recorded(|t| Vector3::new(far_m * (9.0 * t).sin(), 0.0, 2.0), still);
        let angles = swing_rad(&led(pendulum(""), &motion));
        angles.iter().fold(0.0_f64, |most, a| most.max(a.abs()))
    };
    let (once, twice) = (shaken(2e-3), shaken(4e-3));
    assert!((twice / once - 2.0).abs() < 0.01, "{once} {twice}");
    // The stand turns slowly about the axis of the joint: the bob hangs on, so that the joint turns back.
    let motion = recorded(
        |_| Vector3::new(0.0, 0.0, 2.0),
        |t| Vector3::y() * 0.3 * (1.0 - (0.5 * t).cos()),
    );
    let angles = swing_rad(&led(pendulum(""), &motion));
    let turned = 0.3 * (1.0 - 1.0_f64.cos());
    let last = angles[angles.len() - 1];
    assert!((last + turned).abs() < 0.03 * turned, "{last} {turned}");
}

#[test]
fn what_a_led_stand_feels_is_what_was_recorded() {
    // An accelerometer and a gyroscope on the stand read the second derivative of the recorded place and the recorded rate.
    let motion = recorded(
        |t| Vector3::new(0.05 * (6.0 * t).sin(), 0.0, 2.0),
        |t| Vector3::z() * 0.4 * (2.0 * t).sin(),
    );
    let mut experiment = led(pendulum("").set("gravity_m_s2", 0.0), &motion);
    experiment.instruments = ["stand_gyro_z_rad_s", "stand_accel_x_m_s2"]
        .map(|column| Instrument::of_column(column, &experiment.assembly).unwrap())
        .to_vec();
    let path = run(&experiment).unwrap().outcome.completed().unwrap();
    let times_s = path.times_s();
    let read = |column: &str| path.signal(column).unwrap().values.clone();
    let (rates, pulls) = (read("stand_gyro_z_rad_s"), read("stand_accel_x_m_s2"));
    // A reading is a mean over the last step.
    let middle = |k: usize| times_s[k] - 5e-4;
    for k in 10..times_s.len() - 1 {
        let rate = 0.8 * (2.0 * middle(k)).cos();
        assert!(
            (rates[k] - rate).abs() < 2e-3,
            "{}: {} {rate}",
            times_s[k],
            rates[k]
        );
        let heading = 0.4 * (2.0 * middle(k)).sin();
        let pull = -1.8 * (6.0 * middle(k)).sin() * heading.cos();
        // Between samples 0.01 s apart, the cubics' second derivative is off by the third one times 0.01 s at most, 0.11 m/s².
        assert!(
            (pulls[k] - pull).abs() < 0.12,
            "{}: {} {pull}",
            times_s[k],
            pulls[k]
        );
    }
}

#[test]
fn a_base_that_cannot_be_led_is_refused_with_what_can_be_done() {
    let still = |_: f64| Vector3::zeros();
    let motion = recorded(|t| Vector3::new(t, 0.0, 2.0), still);
    let without = Trajectory::new(
        motion.times_s().to_vec(),
        motion.positions_world_m().to_vec(),
    );
    let said = pendulum("")
        .lead_base(&without.unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("orientations") && said.contains("qw"),
        "{said}"
    );
    let on_spring = led(pendulum(""), &motion).set("mount.stiffness_n_m", 1e3);
    let said = on_spring.check().unwrap_err().to_string();
    assert!(said.contains("spring"), "{said}");
    let mut other = led(pendulum(""), &motion);
    std::sync::Arc::make_mut(&mut other.assembly).track_part = 1;
    let said = other.check().unwrap_err().to_string();
    assert!(said.contains("root"), "{said}");
}
