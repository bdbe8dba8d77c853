//! Probabilities of the final pose of a toss: their calibration, their limit without noise, and their independence of the number of
//! threads.
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use crate::common;

use common::project;
use nalgebra::{UnitQuaternion, Vector3};
use realgap_identification::StartState;
use realgap_lab::calibration::Study;
use realgap_lab::prediction::{Odds, OddsOptions};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::{State, Trajectory};
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::{Assignment, ParameterSet};
use realgap_simulation::{Distribution, Experiment, Noise, Start, run};

/// A cube that is thrown with a different spin for every number.
fn toss(number: u32) -> Experiment {
    let robot = Morphology::read(project().join("morphologies/cube.ron")).unwrap();
    let mut experiment = Experiment::new(robot.assemble());
    let spin = f64::from(number);
    experiment.start = Start::State(State {
        position_world_m: Vector3::new(0.0, 0.0, 0.2),
        orientation_world_from_body: UnitQuaternion::from_euler_angles(0.3 * spin, 0.2, 0.1),
        velocity_world_m_s: Vector3::new(0.6, 0.0, 0.0),
        angular_velocity_body_rad_s: Vector3::new(3.0 + spin, 5.0 - 2.0 * spin, 1.0),
    });
    experiment.duration_s = 1.5;
    experiment
}

fn with_noise() -> Noise {
    Noise {
        start_velocity_m_s: Distribution::Normal(0.05),
        start_spin_rad_s: Distribution::Normal(0.5),
        ..Noise::default()
    }
}

/// A study of simulated tosses whose starts are drawn with this noise.
fn study(count: u32, noise: &Noise) -> Study {
    let robot = Morphology::read(project().join("morphologies/cube.ron")).unwrap();
    let mut builder = Study::builder("tosses", robot);
    for number in 0..count {
        let thrown = toss(number);
        let drawn = noise.perturb(&thrown, 99, u64::from(number));
        let path: Trajectory = run(&drawn).unwrap().outcome.completed().unwrap();
        // The recording states the intended start and not the perturbed one.
        let Start::State(known) = thrown.start else {
            panic!("thrown")
        };
        builder = builder.trajectory(format!("toss_{number}"), starting_as(&path, &known));
    }
    builder
        .metric(realgap_path::comparison::by_name("pose").unwrap())
        .start_from_recordings(StartState::FirstSample)
        .vary("floor.friction", 0.4, 0.6, 2)
        .build()
        .unwrap()
}

/// The path with its first sample replaced by `first`.
fn starting_as(path: &Trajectory, first: &State) -> Trajectory {
    let mut positions = path.positions_world_m().to_vec();
    let mut turns = path.orientations_world_from_body().unwrap().to_vec();
    let mut linear = path.velocities_world_m_s().unwrap().to_vec();
    let mut angular = path.angular_velocities_body_rad_s().unwrap().to_vec();
    positions[0] = first.position_world_m;
    turns[0] = first.orientation_world_from_body;
    linear[0] = first.velocity_world_m_s;
    angular[0] = first.angular_velocity_body_rad_s;
    Trajectory::new(path.times_s().to_vec(), positions)
        .unwrap()
        .with_orientations(turns)
        .unwrap()
        .with_velocities(linear, angular)
        .unwrap()
}

fn odds(study: &Study, noise: Noise, runs: usize, jobs: usize) -> realgap_core::Result<Odds> {
    let options = OddsOptions {
        noise,
        runs,
        seed: 1,
    };
    let run = RunOptions {
        jobs,
        ..RunOptions::default()
    };
    Odds::new(study, &ParameterSet::new(), &options, &run)
}

#[test]
fn odds_of_simulated_tosses_are_calibrated_and_score_better_than_one_run() {
    let study = study(36, &with_noise());
    let found = odds(&study, with_noise(), 16, 2).unwrap();
    assert!(found.recordings >= 30, "{found}");
    assert!(found.brier.mean < found.brier_one_run.mean, "{found}");
    assert!(found.brier.low <= found.brier.mean && found.brier.mean <= found.brier.high);
    for coverage in &found.end_coverage {
        let held = &coverage.observed;
        assert!(
            held.low <= coverage.level + 0.05 && coverage.level - 0.05 <= held.high,
            "{found}"
        );
    }
    for row in &found.rows {
        let sum: f64 = row.probabilities.values().sum();
        assert!(0.9 < sum && sum <= 1.0 + 1e-12, "{row:?}");
    }
    assert_eq!(found, odds(&study, with_noise(), 16, 1).unwrap());
}

#[test]
fn without_noise_the_odds_come_from_other_numerical_settings_only() {
    let study = study(3, &Noise::default());
    let found = odds(&study, Noise::default(), 1, 1).unwrap();
    // The single run with the study's own numerical settings is the run without noise. The pose that occurred has a probability of
    // 7/6 of 1/2, that is 7/12, and every other pose 1/12.
    for row in &found.rows {
        assert_eq!(row.one_run.as_ref(), Some(&row.real));
        assert!((row.probabilities[&row.real] - 7.0 / 12.0).abs() < 1e-12);
    }
    assert_eq!(found.brier_one_run.mean, 0.0);
    let off = found.run_errors.unwrap();
    assert!(off.position_percent.mean < 1e-6 && off.rotation_deg.mean < 1e-3);
    assert!(off.hinge_deg.is_none());
    let by_hand = (5.0_f64 / 12.0).powi(2) + 5.0 / 144.0;
    assert!((found.brier.mean - by_hand).abs() < 1e-12);
}

#[test]
fn a_single_run_without_noise_has_the_errors_of_an_evaluation() {
    let study = study(3, &Noise::default());
    let floor = Assignment::new("floor.friction", 0.3).unwrap();
    let (set, run) = (ParameterSet::from_iter([floor]), RunOptions::default());
    let options = OddsOptions {
        noise: Noise::default(),
        runs: 1,
        seed: 1,
    };
    let off = Odds::new(&study, &set, &options, &run).unwrap().run_errors;
    let (off, one) = (off.unwrap(), study.evaluate(&set, &run).unwrap());
    assert!(off.position_percent.mean > 1.0);
    assert_eq!(off.position_percent.mean, one.position_percent.mean);
    assert_eq!(off.rotation_deg.mean, one.rotation_deg.mean);
}

#[test]
fn odds_without_runs_are_refused() {
    let study = study(1, &Noise::default());
    let error = odds(&study, Noise::default(), 0, 1)
        .unwrap_err()
        .to_string();
    assert!(error.contains("runs"), "{error}");
}

#[test]
fn an_uncertain_fit_spreads_the_odds_over_more_poses() {
    let odds_of = |drawn: &[f64]| {
        let bounce = |value: &f64| Assignment::new("floor.restitution", *value).unwrap();
        let drawn = drawn
            .iter()
            .map(|value| ParameterSet::new().with(bounce(value)));
        let known = ParameterSet::new().with(bounce(&0.1));
        let study = study(4, &Noise::default());
        let study = study.at(&known, vec![drawn.collect()], &[]).unwrap();
        let options = OddsOptions {
            noise: Noise::default(),
            runs: 24,
            seed: 1,
        };
        Odds::new(
            &study,
            &ParameterSet::new(),
            &options,
            &RunOptions::default(),
        )
        .unwrap()
    };
    let poses =
        |odds: &Odds| -> usize { odds.rows.iter().map(|row| row.probabilities.len()).sum() };
    let (point, wide) = (odds_of(&[0.1]), odds_of(&[0.0, 0.3, 0.6, 0.8, 0.9]));
    assert!(poses(&wide) > poses(&point), "{point}\n{wide}");
    let carried = |odds: &Odds| {
        odds.warnings
            .iter()
            .any(|w| w.code.name() == "uncertain-parameters")
    };
    assert!(carried(&wide));
}
