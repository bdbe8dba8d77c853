//! Two sets of recorded runs without a simulator: do they move alike?

use nalgebra::{UnitQuaternion, Vector3};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use realgap_lab::calibration::Overrides;
use realgap_lab::prediction::gap::{Alike, Between, Sample, Scoring, read_sets};
use realgap_path::comparison::{Components, by_name};
use realgap_path::trajectory::{Signal, Trajectory};

fn scoring(metric: &str) -> Scoring {
    Scoring {
        metrics: vec![by_name(metric).unwrap()],
        components: Components::default(),
        body_length_m: None,
        seed: 1,
    }
}

/// The runs of one set of these files.
fn runs(glob: &str, set: Option<&str>) -> Vec<Sample> {
    let overrides = Overrides {
        recordings: vec![glob.to_owned()],
        ..Overrides::default()
    };
    let sets = read_sets(&overrides, None).unwrap().into_iter();
    let sets = sets.filter(|found| set.is_none_or(|name| found.name == name));
    sets.flat_map(|set| set.runs).collect()
}

/// How many of 20 random halvings of one set are said to differ.
fn false_alarms(mut runs: Vec<Sample>, metric: &str) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let differ = (0..20).filter(|_| {
        runs.shuffle(&mut rng);
        let (first, second) = runs.split_at(runs.len() / 2);
        let found = Between::repeats(first, second, &scoring(metric)).unwrap();
        found.answer == Alike::Differ
    });
    differ.count()
}

#[test]
fn halves_of_one_set_of_tosses_are_alike_and_longer_ones_differ() {
    let tosses = runs("../../real_trajectories/cube_tosses/toss_*.csv", None);
    let alarms = false_alarms(tosses.clone(), "pca");
    println!("{alarms} of 20 halvings of {} tosses differ", tosses.len());
    assert!(alarms <= 2, "{alarms} of 20");
    let (first, second) = tosses.split_at(8);
    let longer: Vec<Sample> = second
        .iter()
        .map(|run| Sample::new(run.name.clone(), run.motion.scaled(2.0).unwrap()).unwrap())
        .collect();
    let found = Between::repeats(first, &longer, &scoring("pca")).unwrap();
    println!("{found}");
    assert_eq!(found.answer, Alike::Differ);
}

#[test]
fn halves_of_one_condition_of_two_wheel_runs_are_alike_and_other_conditions_differ() {
    let of = |condition| {
        runs(
            "../../real_trajectories/two_wheel_runs/runs.csv",
            Some(condition),
        )
    };
    let alarms = false_alarms(of("ir"), "pca");
    println!("{alarms} of 20 halvings differ");
    assert!(alarms <= 2, "{alarms} of 20");
    let found = Between::repeats(&of("ir"), &of("us1"), &scoring("pca")).unwrap();
    println!("{found}");
    assert_eq!(found.answer, Alike::Differ);
}

#[test]
fn a_run_in_both_sets_and_too_few_repeats_are_refused() {
    let tosses = runs("../../real_trajectories/cube_tosses/toss_*.csv", None);
    let twice = Between::repeats(&tosses[..5], &tosses[4..], &scoring("pca")).unwrap_err();
    assert!(twice.to_string().contains("in both sets"), "{twice}");
    let few = Between::repeats(&tosses[..3], &tosses[3..], &scoring("pca")).unwrap_err();
    assert!(few.to_string().contains("4 or more"), "{few}");
}

/// A point that turns and accelerates as commanded, up to the friction of its floor, with noise of measurement and of the commands.
fn driven(friction: f64, most_m_s2: f64, seed: u64) -> Sample {
    const STEP_S: f64 = 0.02;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut place: Vector3<f64> = Vector3::zeros();
    let mut velocity: Vector3<f64> = Vector3::new(1.0, 0.0, 0.0);
    let (mut ahead_m_s2, mut left_m_s2) = (0.0, 0.0);
    let mut samples: Vec<(f64, Vector3<f64>, f64, f64, f64)> = Vec::new();
    let mut heading_rad = 0.0_f64;
    for k in 0..1000 {
        if k % 20 == 0 {
            left_m_s2 = rng.random_range(-most_m_s2..most_m_s2);
            // The speed stays near 2 m/s.
            ahead_m_s2 = rng.random_range(-1.0..1.0) + 2.0 * (2.0 - velocity.norm());
        }
        if velocity.norm() > 1e-3 {
            heading_rad = velocity.y.atan2(velocity.x);
        }
        let noise = |rng: &mut ChaCha8Rng| rng.random_range(-2e-4..2e-4);
        let seen = place + Vector3::new(noise(&mut rng), noise(&mut rng), 0.0);
        samples.push((
            f64::from(k) * STEP_S,
            seen,
            heading_rad,
            ahead_m_s2,
            left_m_s2,
        ));
        let ahead = velocity / velocity.norm().max(1e-6);
        let left = Vector3::new(-ahead.y, ahead.x, 0.0);
        let mut push = ahead * ahead_m_s2 + left * left_m_s2;
        push *= (friction * 9.81 / push.norm().max(1e-9)).min(1.0);
        push += Vector3::new(
            rng.random_range(-0.3..0.3),
            rng.random_range(-0.3..0.3),
            0.0,
        );
        velocity += push * STEP_S;
        place += velocity * STEP_S;
    }
    let column =
        |of: fn(&(f64, Vector3<f64>, f64, f64, f64)) -> f64| samples.iter().map(of).collect();
    let turns = samples
        .iter()
        .map(|s| UnitQuaternion::from_euler_angles(0.0, 0.0, s.2));
    let signal = |name: &str, values| Signal {
        name: name.to_owned(),
        values,
    };
    let motion = Trajectory::new(column(|s| s.0), samples.iter().map(|s| s.1).collect())
        .and_then(|motion| motion.with_orientations(turns.collect()))
        .and_then(|motion| {
            motion.with_signals(vec![
                signal("throttle", column(|s| s.3)),
                signal("steering", column(|s| s.4)),
            ])
        })
        .unwrap();
    Sample::new(format!("run {seed}"), motion).unwrap()
}

fn of_windows(first: &Sample, second: &Sample) -> Between {
    let commands = ["throttle".to_owned(), "steering".to_owned()];
    let sets = [first, second].map(std::slice::from_ref);
    Between::windows(sets[0], sets[1], &commands, 0.4, 1).unwrap()
}

#[test]
fn a_slippery_floor_is_told_by_windows_alike_in_start_and_command() {
    let (mut alarms, mut told) = (0, 0);
    for seed in 0..20 {
        let rubber = driven(0.9, 8.0, 2 * seed);
        let again = of_windows(&rubber, &driven(0.9, 8.0, 2 * seed + 1));
        alarms += usize::from(again.answer == Alike::Differ);
        let ice = of_windows(&rubber, &driven(0.3, 8.0, 1000 + seed));
        told += usize::from(ice.answer == Alike::Differ);
        if seed == 0 {
            println!("{again}\n{ice}");
        }
    }
    println!("false alarms {alarms} of 20, told {told} of 20");
    assert!(alarms <= 2, "{alarms} of 20");
    assert!(told >= 18, "{told} of 20");
}

#[test]
fn slow_runs_cannot_tell_two_floors() {
    let found = of_windows(&driven(0.9, 1.5, 1), &driven(0.6, 1.5, 2));
    assert_eq!(found.answer, Alike::CannotTell, "{found}");
    assert!(found.text.contains("0.4 g is needed"), "{found}");
    let unknown = Between::windows(
        &[driven(0.9, 1.5, 1)],
        &[driven(0.9, 1.5, 2)],
        &["brake".to_owned()],
        0.4,
        1,
    );
    let unknown = unknown.unwrap_err().to_string();
    assert!(unknown.contains("throttle, steering"), "{unknown}");
}
