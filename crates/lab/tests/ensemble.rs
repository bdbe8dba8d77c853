//! The statistics of an ensemble agree with values calculated by hand, and do not depend on the number of threads.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "a table is printed")]

use crate::common;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use nalgebra::Vector3;
use rayon::prelude::*;
use realgap_lab::prediction::UncertainParameters;
use realgap_lab::prediction::ensemble::{
    BEHAVIOURS, Ensemble, Envelope, Forecast, Kind, LEAST_PATHS, LEVELS, Motion, Quantiles,
    Reality, Repeat, behaviours, cut_m, repeat, rms_m, run,
};
use realgap_optimization::{Progress, RunOptions};
use realgap_path::trajectory::{Prepared, Trajectory, prepare};
use realgap_robot::morphology::Morphology;
use realgap_simulation::{Divergence, Experiment, Noise, Outcome, Perturbation};

const BODY_M: f64 = 0.06;

/// A path along x that ends at `far_m`, swung sideways by `bend_m` in its middle.
fn path(far_m: f64, bend_m: f64) -> Prepared {
    let times: Vec<f64> = (0..182).map(|i| f64::from(i) * 0.1).collect();
    let positions = (0..182)
        .map(|i| {
            let share = f64::from(i) / 181.0;
            let side = bend_m * (std::f64::consts::PI * share).sin();
            Vector3::new(far_m * share, side, 0.0)
        })
        .collect();
    prepare(&Trajectory::new(times, positions).unwrap()).unwrap()
}

fn motion(path: Prepared, turned_rad: f64) -> Outcome<Motion> {
    Outcome::Completed(Motion {
        path,
        turned_rad,
        servo_rms_rad: 0.0,
        energy: None,
    })
}

fn diverged() -> Outcome<Motion> {
    Outcome::Diverged(Divergence {
        at_s: 1.0,
        why: "a part is far away".to_owned(),
    })
}

fn hand_made(outcomes: Vec<Outcome<Motion>>, noise_free: Outcome<Motion>) -> Ensemble {
    Ensemble {
        uncertain: UncertainParameters::default(),
        noise: Noise::careful_repeat(),
        seed: 1,
        asked: outcomes.len(),
        repeats: outcomes
            .into_iter()
            .enumerate()
            .map(|(number, outcome)| Repeat {
                number: number as u64,
                perturbation: Perturbation::default(),
                outcome,
            })
            .collect(),
        noise_free,
        duration_s: 18.1,
        body_length_m: BODY_M,
        cpu: Duration::ZERO,
        engine: "none",
        warnings: Vec::new(),
    }
}

fn tripod(duration_s: f64) -> Experiment {
    let file = common::project().join("morphologies/tripod.ron");
    let mut experiment = Experiment::new(Morphology::read(file).unwrap().assemble());
    experiment.duration_s = duration_s;
    experiment
}

fn simulate(experiment: &Experiment, noise: &Noise, repeats: usize, jobs: usize) -> Ensemble {
    let options = RunOptions {
        jobs,
        ..RunOptions::default()
    };
    run(experiment, noise, 5, repeats, &options).unwrap()
}

#[test]
fn statistics_of_a_small_ensemble_agree_with_values_calculated_by_hand() {
    let outcomes = (1..=5)
        .map(|i| motion(path(f64::from(i), 0.0), 0.1 * f64::from(i)))
        .chain([diverged()])
        .collect();
    let summary = Forecast::new(&hand_made(outcomes, motion(path(3.0, 0.0), 0.0))).unwrap();
    let expected = Quantiles {
        mean: 3.0,
        standard_deviation: 2.5_f64.sqrt(),
        q05: 1.2,
        q25: 2.0,
        q50: 3.0,
        q75: 4.0,
        q95: 4.8,
    };
    let found = summary.displacement_m.unwrap();
    for (found, expected) in [
        (found.mean, expected.mean),
        (found.standard_deviation, expected.standard_deviation),
        (found.q05, expected.q05),
        (found.q25, expected.q25),
        (found.q50, expected.q50),
        (found.q75, expected.q75),
        (found.q95, expected.q95),
        (summary.speed_m_s.unwrap().mean, 3.0 / 18.1),
        (summary.turned_rad.unwrap().mean, 0.3),
        (summary.noise_free_displacement_m.unwrap(), 3.0),
    ] {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // Wilson interval of 1 of 6: statsmodels.stats.proportion.proportion_confint(1, 6, method="wilson").
    assert_eq!((summary.diverged.count, summary.diverged.trials), (1, 6));
    assert!(
        (summary.diverged.low - 0.030_053).abs() < 1e-6,
        "{}",
        summary.diverged.low
    );
    assert!(
        (summary.diverged.high - 0.563_503).abs() < 1e-6,
        "{}",
        summary.diverged.high
    );
}

#[test]
fn a_diverged_repeat_counts_as_a_failure() {
    let outcomes = vec![
        motion(path(1.0, 0.0), 0.0),
        motion(path(2.0, 0.0), 0.0),
        diverged(),
        motion(path(0.5, 0.0), 0.0),
    ];
    let success = hand_made(outcomes, diverged()).success(1.0);
    assert_eq!((success.count, success.trials), (2, 4));
}

/// Three groups: 15 % move as predicted, 60 % take another path, 25 % turn in place, as in paper 003.
fn three_behaviours() -> Ensemble {
    let wobble = |i: usize| 0.004 * (i as f64 * 0.7).sin();
    let outcomes = (0..20)
        .map(|i| match i {
            0..3 => motion(path(1.0 + wobble(i), 0.02), 0.1),
            3..15 => motion(path(0.9 + wobble(i), 0.6 + wobble(i)), 0.5),
            _ => motion(path(0.01, 0.02), 3.0),
        })
        .collect();
    hand_made(outcomes, motion(path(1.0, 0.02), 0.1))
}

#[test]
fn three_groups_of_repeats_are_found_as_behaviours_with_names_and_counts() {
    let found = behaviours(&three_behaviours());
    let list: Vec<_> = found
        .list
        .iter()
        .map(|b| (b.name.as_str(), b.kind, b.repeats.len()))
        .collect();
    assert_eq!(
        list,
        [
            ("as predicted", Kind::AsPredicted, 3),
            ("other path", Kind::OtherPath, 12),
            ("turns in place", Kind::TurnsInPlace, 5),
        ]
    );
    let odds = found.list[0].probability;
    assert!((odds.share - 0.15).abs() < 1e-12);
    // statsmodels: proportion_confint(3, 20, method="wilson").
    assert!((odds.low - 0.052_368).abs() < 1e-6 && (odds.high - 0.360_419).abs() < 1e-6);
    // The representative is a member of its group.
    assert!(
        found.list[1]
            .repeats
            .contains(&found.list[1].representative.unwrap())
    );
    assert_eq!(found.of_repeat(16), Some(2));
    assert_eq!(found.of_repeat(99), None);
}

#[test]
fn a_predicted_behaviour_that_no_repeat_shows_is_listed_with_probability_0() {
    let ensemble = hand_made(
        (0..10).map(|_| motion(path(1.0, 0.8), 0.0)).collect(),
        motion(path(1.0, -0.8), 0.0),
    );
    let found = behaviours(&ensemble);
    assert_eq!(found.list[0].kind, Kind::AsPredicted);
    assert_eq!(found.list[0].probability.count, 0);
    assert_eq!(found.list[0].representative, None);
    assert_eq!(found.list[1].probability.count, 10);
}

#[test]
fn the_number_of_behaviours_is_limited() {
    let outcomes = (0..40)
        .map(|i| motion(path(1.0, f64::from(i)), 0.0))
        .collect();
    let found = behaviours(&hand_made(outcomes, diverged()));
    assert_eq!(found.list.len(), BEHAVIOURS);
    assert!(found.cut_m > cut_m(BODY_M, &[1.0]), "{}", found.cut_m);
    let repeats: usize = found.list.iter().map(|b| b.repeats.len()).sum();
    assert_eq!(repeats, 40);
}

#[test]
fn the_distance_of_two_paths_is_the_metric_rms() {
    let (a, b) = (path(1.0, 0.0), path(2.0, 0.0));
    let n = 182.0_f64;
    // Σ (i / 181)² / 182
    let expected = ((181.0 * 182.0 * 363.0 / 6.0) / (181.0 * 181.0) / n).sqrt();
    assert!((rms_m(&a, &b) - expected).abs() < 1e-12);
}

/// Independent repeats with a random length and bend; two groups where `split`.
fn drawn(count: usize, seed: u64, split: bool) -> Vec<Prepared> {
    use rand::{RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let side = if split && rng.random_range(0..4) == 0 {
                3.0
            } else {
                0.0
            };
            let uniform = |rng: &mut rand_chacha::ChaCha8Rng| rng.random_range(0.0..1.0_f64);
            let far_m = 1.0 + 0.2 * (uniform(&mut rng) + uniform(&mut rng)) - 0.15 * side;
            path(far_m, side + 0.3 * (uniform(&mut rng) + uniform(&mut rng)))
        })
        .collect()
}

#[test]
fn envelopes_cover_new_draws_of_the_same_distribution_at_their_nominal_level() {
    for split in [false, true] {
        let mut inside = [0_usize; 3];
        let (ensembles, trials) = (20, 100);
        for seed in 0..ensembles {
            let repeats = drawn(100, 2 * seed, split);
            let envelope =
                Envelope::new(&repeats.iter().collect::<Vec<_>>(), 18.1, BODY_M).unwrap();
            let new = drawn(trials, 2 * seed + 1, split);
            for (level, count) in inside.iter_mut().enumerate() {
                *count += envelope.inside(level, &new.iter().collect::<Vec<_>>())[90];
            }
        }
        for (level, count) in LEVELS.iter().zip(inside) {
            let share = count as f64 / (ensembles as usize * trials) as f64;
            // 20 ensembles of 100 repeats: the share itself has a standard deviation of about 0.015.
            assert!(
                (share - level).abs() < 0.045,
                "{split}: {share} for {level}"
            );
        }
    }
}

/// Shares by level: of whole paths in the band for whole paths, of points in the region in the middle of the run, and of whole
/// paths in the regions of all times.
fn band_coverage(repeats: usize, split: bool, ensembles: u64) -> [[f64; 3]; 3] {
    let trials = 20;
    let counts: Vec<[[usize; 3]; 3]> = (0..ensembles)
        .into_par_iter()
        .map(|seed| {
            let known = drawn(repeats, 2 * seed, split);
            let known: Vec<&Prepared> = known.iter().collect();
            let band = Envelope::of_whole_paths(&known, 18.1, BODY_M).unwrap();
            let (band, envelope) = (band.unwrap(), Envelope::new(&known, 18.1, BODY_M).unwrap());
            let new = drawn(trials, 2 * seed + 1, split);
            let count = |of: &dyn Fn(usize, &Prepared) -> bool| {
                std::array::from_fn(|level| new.iter().filter(|path| of(level, path)).count())
            };
            [
                count(&|level, path| band.holds(level, path)),
                count(&|level, path| envelope.regions[90].contains(level, path.xy_m()[90])),
                count(&|level, path| envelope.holds(level, path)),
            ]
        })
        .collect();
    let all = (ensembles * trials as u64) as f64;
    std::array::from_fn(|what| {
        std::array::from_fn(|level| {
            counts.iter().map(|c| c[what][level]).sum::<usize>() as f64 / all
        })
    })
}

#[test]
fn the_band_for_whole_paths_has_its_nominal_coverage() {
    for (repeats, split) in [(20, false), (50, false), (50, true)] {
        let [band, _, _] = band_coverage(repeats, split, 600);
        for (share, level) in band.iter().zip(LEVELS) {
            // The coverage of one band has a standard deviation of up to 0.14, so that the mean over 600 bands has one of 0.006.
            assert!((share - level).abs() < 0.025, "{repeats}: {band:?}");
        }
    }
    let few = drawn(LEAST_PATHS - 1, 1, false);
    let few: Vec<&Prepared> = few.iter().collect();
    assert!(
        Envelope::of_whole_paths(&few, 18.1, BODY_M)
            .unwrap()
            .is_none()
    );
}

/// Prints the table of docs/validation/ensembles.md.
#[test]
#[ignore = "a minute"]
fn the_table_of_envelopes() {
    println!(
        "| repeats | drawn | whole paths in the band | points in the regions, middle | whole paths in the regions |"
    );
    for split in [false, true] {
        for repeats in [20, 50, 100, 200] {
            let shares = band_coverage(repeats, split, 2000);
            let cells =
                shares.map(|by_level| by_level.map(|s| format!("{:.1}", 100.0 * s)).join(", "));
            let drawn = if split { "two groups" } else { "one group" };
            println!("| {repeats} | {drawn} | {} |", cells.join(" | "));
        }
    }
}

fn ensemble_of(paths: Vec<Prepared>) -> Ensemble {
    let first = paths[0].clone();
    hand_made(
        paths.into_iter().map(|p| motion(p, 0.0)).collect(),
        motion(first, 0.0),
    )
}

fn against(ensemble: &Ensemble, real: &[Prepared]) -> Reality {
    let summary = Forecast::new(ensemble).unwrap();
    let real: Vec<(&str, &Prepared)> = real.iter().map(|p| ("real", p)).collect();
    Reality::new(ensemble, &summary, &real).unwrap().unwrap()
}

#[test]
fn coverage_is_accepted_for_recordings_of_the_same_distribution_and_rejected_for_others() {
    let ensemble = ensemble_of(drawn(200, 1, false));
    let same = against(&ensemble, &drawn(60, 2, false));
    for coverage in &same.coverage {
        assert!(coverage.is_honest, "{coverage:?}");
        assert!(
            (coverage.over_time - coverage.level).abs() < 0.15,
            "{coverage:?}"
        );
    }
    assert!(same.energy_score_m < 1.3 * same.expected_energy_score_m);
    assert_eq!(same.showing(Some("as predicted")), 60);
    let short: Vec<Prepared> = (0..60)
        .map(|i| path(0.3 + 0.001 * f64::from(i), 0.1))
        .collect();
    let other = against(&ensemble, &short);
    assert!(other.coverage.iter().all(|coverage| !coverage.is_honest));
    assert!(other.energy_score_m > 3.0 * same.energy_score_m);
    assert_eq!(other.showing(None), 60);
}

/// Three paths, calculated by hand: E‖X − y‖ − ½ E‖X − X′‖ with ‖·‖ proportional to the difference in length.
#[test]
fn the_energy_score_agrees_with_a_value_calculated_by_hand() {
    let ensemble = ensemble_of([1.0, 2.0, 4.0].map(|far_m| path(far_m, 0.0)).to_vec());
    let unit = rms_m(&path(1.0, 0.0), &path(2.0, 0.0));
    let found = against(&ensemble, &[path(3.0, 0.0)]);
    // Distances to 3: 2, 1, 1; between repeats: 1, 3, 2.
    let expected = unit * (4.0 / 3.0 - 0.5 * 2.0);
    assert!((found.energy_score_m - expected).abs() < 1e-12);
    assert!((found.expected_energy_score_m - unit).abs() < 1e-12);
}

#[test]
fn repeats_are_bitwise_equal_on_one_thread_on_two_and_when_run_alone() {
    let experiment = tripod(1.5);
    let noise = Noise::unmeasured_robot();
    let one = simulate(&experiment, &noise, 6, 1);
    let two = simulate(&experiment, &noise, 6, 2);
    assert_eq!(one.repeats, two.repeats);
    assert_eq!(one.noise_free, two.noise_free);
    let alone = repeat(&experiment, &noise, 5, 4)
        .unwrap()
        .outcome
        .completed()
        .unwrap();
    let fourth = two.repeats[4].outcome.get().unwrap();
    assert_eq!(prepare(&alone).unwrap(), fourth.path);
    // A larger number of repeats does not change the first ones.
    let more = simulate(&experiment, &noise, 8, 2);
    assert_eq!(more.repeats[..6], one.repeats[..]);
}

#[test]
fn a_stopped_ensemble_is_reported_as_incomplete() {
    let stop = AtomicBool::new(false);
    let report = |progress: Progress| stop.store(progress.done >= 2, Ordering::Relaxed);
    let options = RunOptions {
        jobs: 1,
        stop: Some(&stop),
        progress: Some(&report),
    };
    let simulate = || run(&tripod(0.5), &Noise::careful_repeat(), 1, 10, &options);
    let found = simulate().unwrap();
    assert_eq!((found.is_complete(), found.repeats.len()), (false, 2));
    assert!(Forecast::new(&found).unwrap().displacement_m.is_some());
    // The flag is still set, so the second ensemble stops at once.
    let found = simulate().unwrap();
    assert!(!found.is_complete() && found.repeats.is_empty());
    let summary = Forecast::new(&found).unwrap();
    assert!(!summary.complete && summary.displacement_m.is_none());
    assert!(
        summary
            .warnings
            .iter()
            .any(|w| w.code.name() == "incomplete")
    );
}

#[test]
fn an_ensemble_without_noise_has_a_warning_and_no_spread() {
    let found = simulate(&tripod(0.5), &Noise::default(), 3, 2);
    assert!(found.warnings.iter().any(|w| w.code.name() == "no-noise"));
    assert_eq!(found.repeats[0].outcome, found.noise_free);
    let spread = Forecast::new(&found).unwrap().displacement_m.unwrap();
    // The spread is not exactly zero, because the mean of equal numbers is rounded.
    assert!(
        spread.standard_deviation < 1e-15,
        "{}",
        spread.standard_deviation
    );
}

#[test]
fn an_ensemble_without_repeats_and_an_envelope_without_paths_are_refused() {
    let options = RunOptions::default();
    assert!(run(&tripod(0.5), &Noise::careful_repeat(), 1, 0, &options).is_err());
    let error = Envelope::new(&[], 1.0, BODY_M).unwrap_err().to_string();
    assert!(error.contains("diverged"), "{error}");
}

#[test]
fn a_run_without_noise_that_is_far_from_all_repeats_is_called_atypical() {
    let outcomes = || {
        (1..=9)
            .map(|i| motion(path(1.0 + 0.01 * f64::from(i), 0.0), 0.0))
            .collect()
    };
    for (far_m, is_typical) in [(1.05, true), (1.5, false), (0.5, false)] {
        let summary = Forecast::new(&hand_made(outcomes(), motion(path(far_m, 0.0), 0.0))).unwrap();
        let warned = summary
            .warnings
            .iter()
            .any(|w| w.code.name() == "atypical-prediction");
        assert_eq!(warned, !is_typical, "{far_m}");
    }
}
