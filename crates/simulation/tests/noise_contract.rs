//! Contract of the noise model: every kind of noise changes a run, does not affect the draws of the other kinds, and refuses
//! invalid distributions.
//!
//! The list of fields is that of the struct: a field that is added but not applied makes a test fail.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use realgap_core::file::{Source, parse_ron};
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{CommandTrack, Experiment, Noise, Perturbation, Start, run};

/// Smallest change that counts as an effect, metres or radians.
const VISIBLE: f64 = 1e-4;

fn walk() -> Experiment {
    let path = common::project().join("morphologies/tripod.ron");
    let mut experiment = Experiment::new(Morphology::read(path).unwrap().assemble());
    experiment.duration_s = 1.5;
    experiment
}

/// A flight, because noise of the start velocity has no effect on a settled start.
fn flight() -> Experiment {
    let mut experiment = walk();
    experiment.duration_s = 0.1;
    experiment.start = Start::State(State {
        position_world_m: Vector3::z(),
        orientation_world_from_body: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::zeros(),
        angular_velocity_body_rad_s: Vector3::zeros(),
    });
    experiment
}

/// The walk with one leg that follows a recorded track.
fn commanded() -> Experiment {
    let mut experiment = walk();
    let times_s: Vec<f64> = (0..60).map(|k| 0.025 * f64::from(k)).collect();
    let angles_rad = times_s.iter().map(|t| (4.0 * t).sin()).collect();
    let track = CommandTrack::new(times_s, angles_rad, None).unwrap();
    let leg = experiment.assembly.hinges[0].name.clone();
    experiment.commands.insert(leg, Arc::new(track));
    experiment
}

fn names() -> Vec<&'static str> {
    Noise::default().fields().iter().map(|(n, _)| *n).collect()
}

fn noise(text: &str) -> realgap_core::Result<Noise> {
    let noise: Noise = parse_ron(&Source::new("noise.ron", format!("({text})")))?;
    noise.check()?;
    Ok(noise)
}

/// The noise of one field alone, as strong as that field is in practice.
fn only(name: &str) -> Noise {
    let distribution = match name {
        "servo_latency_s" | "command_jitter_s" => "Uniform(0.01, 0.02)",
        "start_position_m" | "start_height_m" => "Uniform(0.001, 0.002)",
        _ if name.ends_with("_relative") => "LogNormal(0.05)",
        _ => "Normal(0.0175)",
    };
    let text = match name.split_once('.') {
        Some((part, field)) => format!("{part}: ({field}: {distribution})"),
        None => format!("{name}: {distribution}"),
    };
    noise(&text).unwrap()
}

#[test]
fn every_kind_of_noise_changes_a_run_and_is_reproducible() {
    for name in names() {
        let base = match name {
            "start_velocity_m_s" | "start_spin_rad_s" => flight(),
            "command_jitter_s" => commanded(),
            _ => walk(),
        };
        let intended = run(&base).unwrap().outcome.completed().unwrap();
        let of = |repeat| {
            let noise = only(name);
            let run = run(&noise.perturb(&base, 3, repeat)).unwrap();
            let motion = run.outcome.completed().unwrap();
            noise.record(motion, 3, repeat).unwrap()
        };
        let drawn = of(1);
        assert_eq!(drawn, of(1), "{name} is not repeatable");
        // Changes in metres and in radians are compared with the same threshold: a change of either is enough.
        let turns = |motion: &Trajectory| motion.orientations_world_from_body().unwrap().to_vec();
        let (drawn_turns, intended_turns) = (turns(&drawn), turns(&intended));
        let positions = drawn.positions_world_m().iter();
        let changes = positions
            .zip(intended.positions_world_m())
            .map(|(a, b)| (a - b).norm())
            .chain((drawn_turns.iter().zip(&intended_turns)).map(|(a, b)| a.angle_to(b)));
        let change = changes.fold(0.0, f64::max);
        assert!(
            change > VISIBLE,
            "{name} changes the run by {change:e} only"
        );
    }
}

#[test]
fn no_noise_changes_no_bit() {
    let base = walk();
    let drawn = Noise::default().perturb(&base, 3, 1);
    let (a, b) = (run(&base).unwrap(), run(&drawn).unwrap());
    assert_eq!(a.outcome, b.outcome);
    assert!(Noise::default().is_zero());
}

/// The values of a draw, by field; the fields of the start share two vectors.
fn parts(p: &Perturbation) -> Vec<(&'static str, Vec<f64>)> {
    vec![
        (
            "start_position_m",
            p.shift_world_m.xy().iter().copied().collect(),
        ),
        ("start_height_m", vec![p.shift_world_m.z]),
        ("start_t", p.turn_world_rad.iter().copied().collect()),
        (
            "start_velocity_m_s",
            p.velocity_world_m_s.iter().copied().collect(),
        ),
        (
            "start_spin_rad_s",
            p.spin_world_rad_s.iter().copied().collect(),
        ),
        ("servo_zero_rad", p.servo_zero_rad.clone()),
        ("servo_gain_relative", p.servo_gain_factor.clone()),
        ("servo_phase_rad", p.servo_phase_rad.clone()),
        ("servo_latency_s", p.servo_latency_s.clone()),
        ("mass_relative", p.mass_factor.clone()),
        ("friction_cube_relative", p.friction_factor.clone()),
        ("friction_plate_relative", p.plate_friction_factor.clone()),
        ("friction_run_relative", vec![p.run_friction_factor]),
    ]
}

#[test]
fn a_kind_of_noise_does_not_change_the_draws_of_the_others() {
    let base = walk();
    let without = Noise::default().perturb(&base, 3, 1).perturbation;
    let all = Noise::unmeasured_robot().perturb(&base, 3, 1).perturbation;
    for name in names() {
        let alone = only(name).perturb(&base, 3, 1).perturbation;
        for (((part, drawn), (_, nothing)), (_, usual)) in
            parts(&alone).iter().zip(parts(&without)).zip(parts(&all))
        {
            let is_own = name == *part
                || (*part == "start_t" && matches!(name, "start_tilt_rad" | "start_heading_rad"));
            assert_eq!(*drawn != nothing, is_own, "{name} and {part}");
            // The default noise contains no velocities at the start.
            let is_thrown = matches!(*part, "start_velocity_m_s" | "start_spin_rad_s");
            assert_eq!(usual == nothing, is_thrown, "{part}");
        }
    }
    // A draw has one value per servo or module, and these values differ from each other.
    assert_eq!(all.servo_gain_factor.len(), base.assembly.hinges.len());
    assert_eq!(all.mass_factor.len(), base.assembly.module_names.len());
    assert_ne!(all.mass_factor[0], all.mass_factor[1]);
}

/// The stand-ins under `real_trajectories/tripod_standin` were drawn with these seeds, so their draws must not change.
#[test]
fn the_draws_of_pinned_seeds_do_not_change() {
    let degree = 1.0_f64.to_radians();
    let drawn = Noise::careful_repeat().perturb(&walk(), 7, 3).perturbation;
    let expected: Vec<f64> = PINNED.to_vec();
    let found: Vec<f64> = drawn
        .shift_world_m
        .iter()
        .map(|m| m / 1e-3)
        .chain(drawn.turn_world_rad.iter().map(|rad| rad / degree))
        .chain(drawn.servo_zero_rad.iter().map(|rad| rad / degree))
        .collect();
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// Shift in millimetres, turn and servo zeros in degrees, as drawn before noise had distributions.
const PINNED: [f64; 9] = [
    -0.299_483_946_912,
    0.029_812_698_978,
    -0.163_391_165_310,
    0.693_243_261_764,
    0.253_840_567_244,
    1.740_242_968_841,
    0.084_153_703_030,
    0.382_146_455_858,
    0.401_172_903_777,
];

#[test]
fn invalid_noise_is_refused_with_a_valid_alternative() {
    for (text, message) in [
        ("start_position_m: Normal(-0.001)", "0 or more"),
        ("start_position_m: Normal(NaN)", "0 or more"),
        ("start_tilt_rad: Uniform(0.2, 0.1)", "low <= high"),
        ("start_tilt_rad: Uniform(0.1, inf)", "two finite numbers"),
        ("start_height_m: LogNormal(0.1)", "Normal(sd)"),
        ("servo_latency_s: Normal(0.01)", "HalfNormal(sd)"),
        ("servo_latency_s: Uniform(-0.01, 0.01)", "low >= 0"),
        ("command_jitter_s: Normal(0.01)", "HalfNormal(sd)"),
        ("mass_relative: Normal(0.5)", "LogNormal(sd)"),
        ("mass_relative: Uniform(-1.0, 0.0)", "low > -1"),
        ("friction_run_relative: LogNormal(5.0)", "sd <= 2"),
        ("start_positon_m: Normal(0.001)", "start_position_m"),
        ("mass_relative: Gaussian(0.1)", "LogNormal"),
        ("camera: (position_m: Normal(-1.0))", "camera.position_m"),
        ("camera: (position_m: LogNormal(0.1))", "Normal(sd)"),
        ("camera: (orientation_rad: Normal(0.1))", "angle_rad"),
    ] {
        let error = noise(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }
}
