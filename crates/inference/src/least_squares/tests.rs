//! Tests of the posterior on formulas whose exact posterior is known.
#![allow(clippy::print_stdout, reason = "a table is printed")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

mod budget;
mod time;

use super::*;
use realgap_core::quantity::{Quantity, Scale};
use realgap_core::unit::Unit;
use realgap_optimization::{ErrorBlock, History, Proposal, Range, optimizer_by_name};

/// A grid of parameters with these ranges.
fn grid(ranges: &[(&'static str, f64, f64)]) -> Grid {
    let range = |(name, from, to): &(&'static str, f64, f64)| {
        let parameter = Quantity {
            name,
            unit: Unit::One,
            bounds: (*from, *to),
            whole: false,
            scale: Scale::Linear,
        };
        Range::new(parameter, *from, *to, 7).unwrap()
    };
    Grid::new(ranges.iter().map(range).collect()).unwrap()
}

/// Fits a model by least squares with this budget and returns the estimates.
fn fitted(
    grid: &Grid,
    model: &dyn Fn(&[f64]) -> Vec<f64>,
    recorded: &[f64],
    blocks: Vec<ErrorBlock>,
    budget: usize,
) -> (Vec<LeastSquaresEstimate>, Agreement) {
    let known = |posterior: LeastSquaresPosterior| posterior;
    fitted_from(grid, model, recorded, (blocks, None), (budget, &known))
}

/// The same from own values, with what else is known of the posterior.
fn fitted_from(
    grid: &Grid,
    model: &dyn Fn(&[f64]) -> Vec<f64>,
    recorded: &[f64],
    (blocks, own): (Vec<ErrorBlock>, Option<UnitPoint>),
    (budget, with_more): (
        usize,
        &dyn Fn(LeastSquaresPosterior) -> LeastSquaresPosterior,
    ),
) -> (Vec<LeastSquaresEstimate>, Agreement) {
    let optimizer = optimizer_by_name("gauss-newton").unwrap();
    let problem = OptimizationProblem {
        points: vec![7; grid.ranges().len()],
        budget,
        seed: 1,
        priors: Vec::new(),
        error_blocks: blocks,
        own,
    };
    let errors = |point: &UnitPoint| -> Vec<f64> {
        let simulated = model(&grid.values_at(point));
        simulated.iter().zip(recorded).map(|(a, b)| a - b).collect()
    };
    let mut evaluated: Vec<EvaluatedPoint> = Vec::new();
    while evaluated.len() < budget {
        let history = History {
            design: &[],
            evaluated: &evaluated,
        };
        let Proposal::Evaluate(mut points) = optimizer.propose(&problem, &history).unwrap() else {
            break;
        };
        points.truncate(budget - evaluated.len());
        evaluated.extend(points.into_iter().map(|point| {
            let errors = errors(&point);
            let score = errors.iter().map(|e| e.abs()).sum::<f64>();
            EvaluatedPoint {
                score: Some(score),
                point,
                errors,
            }
        }));
    }
    let history = History {
        design: &[],
        evaluated: &evaluated,
    };
    let known = optimizer.linearisations(&problem, &history);
    let most = most_checks(grid.ranges().len(), evaluated.len());
    let mut runs = |points: &[UnitPoint]| Ok(points.iter().map(|p| Some(errors(p))).collect());
    let posterior =
        LeastSquaresPosterior::new(&problem, &evaluated, &known, (&mut runs, most)).unwrap();
    let posterior = with_more(posterior.unwrap());
    let draws = posterior.posterior(grid, 1);
    (
        LeastSquaresEstimate::all(grid, &posterior, &draws),
        posterior.agreement(),
    )
}

/// A swing that loses height by viscous and dry friction, which act through their ratios to the mass.
fn swing(values: &[f64]) -> Vec<f64> {
    let (viscous, dry) = (values[0] / values[2], values[1] / values[2]);
    let angle = |k: usize| {
        let t = 0.01 * k as f64;
        let height = libm::exp(-12.0 * viscous * t) - 4.0 * dry * t;
        height * libm::cos(7.0 * t * (1.0 + 0.05 * height * height))
    };
    (0..400).map(angle).collect()
}

#[test]
fn parameters_that_act_through_their_ratio_alone_are_not_determined_whatever_the_budget() {
    let grid = grid(&[
        ("viscous", 0.0, 0.03),
        ("dry", 0.0, 0.05),
        ("mass", 0.5, 2.0),
    ]);
    let truth = [0.021, 0.0345, 1.558];
    let numerics = |k: usize| 1e-4 * libm::sin(0.05 * k as f64);
    let recorded = swing(&truth);
    let recorded: Vec<f64> = recorded
        .iter()
        .enumerate()
        .map(|(k, a)| a + numerics(k))
        .collect();
    for budget in [20, 40, 100, 300] {
        let (estimates, agreement) = fitted(&grid, &swing, &recorded, Vec::new(), budget);
        assert!(agreement.checked > 0, "{budget}: {agreement:?}");
        for (known, truth) in estimates.iter().zip(truth) {
            assert!(!known.is_told, "{budget}: {known:?}");
            assert!(
                known.low < truth && truth < known.high,
                "{budget}: {known:?}"
            );
        }
        let ratio = estimates[2].combination.as_ref().unwrap();
        assert!(
            ["mass / viscous", "mass / dry"].contains(&ratio.name.as_str()),
            "{budget}: {ratio:?}"
        );
    }
}

#[test]
fn a_joint_that_stands_still_and_an_encoder_leave_intervals_that_hold_the_truth() {
    let names = [("stiffness", 10.0, 100.0), ("damping", 0.3, 5.0)];
    let grid = grid(&names);
    let step = std::f64::consts::TAU / 4096.0;
    let model = |values: &[f64]| -> Vec<f64> {
        let angle = |k: usize| {
            let t = 0.02 * k as f64;
            let frequency = values[0].sqrt();
            libm::exp(-values[1] * t) * libm::cos(frequency * t) * 0.3
        };
        // Two of three joints do not move.
        (0..150).map(angle).chain([0.0; 300]).collect()
    };
    let blocks: Vec<ErrorBlock> = (0..3)
        .map(|channel| ErrorBlock {
            channel,
            log: 0,
            count: 150,
            resolution: step,
        })
        .collect();
    let mut held = 0;
    for seed in 0..20 {
        let share = |k: u64| ((seed * 7 + k * 11) % 20) as f64 / 20.0;
        let truth = [10.0 + 90.0 * share(1), 0.3 + 4.7 * share(2)];
        let read = |angle: &f64| (angle / step).round() * step;
        let recorded: Vec<f64> = model(&truth).iter().map(read).collect();
        let (estimates, _) = fitted(&grid, &model, &recorded, blocks.clone(), 60);
        for (known, truth) in estimates.iter().zip(truth) {
            let width = known.high - known.low;
            assert!(width > 0.0 && width < 0.5 * 90.0, "{seed}: {known:?}");
            let outside = (known.low - truth).max(truth - known.high);
            assert!(outside < 3.0 * width, "{seed}: {known:?} {truth}");
            held += usize::from(outside <= 0.0);
        }
    }
    // Of forty intervals of 90 %, fewer than 31 hold with a probability of 1 in 200.
    assert!(held >= 31, "{held} of 40");
}

/// `count` readings of a smooth nonlinear model; each reading depends on all parameters.
fn readings(point: &[f64], count: usize) -> Vec<f64> {
    let reading = |index: usize| -> f64 {
        let axes = point.iter().enumerate();
        axes.map(|(axis, c)| {
            let phase = 0.37 * (index * (axis + 1)) as f64 + axis as f64;
            libm::sin(phase) * (c + 0.2 * c * c)
        })
        .sum()
    };
    (0..count).map(reading).collect()
}

/// Number of 90 % intervals that contain the truth, and number of intervals, for `fits` fits. The recorded values come from several
/// logs. In each log the true parameters differ by a standard deviation of `spread`, as they seem to do if a model lacks an effect.
fn covered(dimensions: usize, fits: u64, logs: usize, spread: f64) -> (usize, usize) {
    let (held, all, _) = covered_beside(dimensions, fits, (logs, spread), 1.0);
    (held, all)
}

/// The same where the last parameter moves all logs but the first by the share `elsewhere` only, and is not counted; also the mean width
/// of the intervals.
fn covered_beside(
    dimensions: usize,
    fits: u64,
    (logs, spread): (usize, f64),
    elsewhere: f64,
) -> (usize, usize, f64) {
    let name = |axis| &*Box::leak(format!("p{axis}").into_boxed_str());
    let ranges: Vec<_> = (0..dimensions).map(|axis| (name(axis), 0.0, 1.0)).collect();
    let grid = grid(&ranges);
    let count = 20 * dimensions;
    let counted = dimensions - usize::from(elsewhere < 1.0);
    let (mut held, mut width) = (0, 0.0);
    for seed in 0..fits {
        let mut random = Generator::seed_from_u64(1000 + seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let truth: UnitPoint = (0..dimensions).map(|_| 0.5 + 0.1 * normal()).collect();
        let each = count / logs;
        // Every log reads the parameters, the first one the last of them more than the others.
        let model = |values: &[f64]| -> Vec<f64> {
            let mut faint = values.to_vec();
            faint[dimensions - 1] = 0.5 + elsewhere * (values[dimensions - 1] - 0.5);
            let mut all = readings(&faint, each * logs);
            all[..each].copy_from_slice(&readings(values, each));
            all
        };
        let mut recorded: Vec<f64> = Vec::new();
        for log in 0..logs {
            let own: UnitPoint = truth.iter().map(|c| c + spread * normal()).collect();
            let clean = &model(&own)[log * each..(log + 1) * each];
            recorded.extend(clean.iter().map(|value| value + 0.05 * normal()));
        }
        let blocks = (0..logs).map(|log| ErrorBlock {
            channel: 0,
            log,
            count: each,
            resolution: 0.0,
        });
        let budget = 8 * (dimensions + 6);
        let (estimates, _) = fitted(&grid, &model, &recorded, blocks.collect(), budget);
        for (known, at) in estimates.iter().zip(&truth).take(counted) {
            held += usize::from((known.low..=known.high).contains(at));
            width += known.high - known.low;
        }
    }
    let all = counted * fits as usize;
    (held, all, width / all as f64)
}

#[test]
fn what_one_log_alone_tells_of_does_not_widen_the_intervals_of_the_other_parameters() {
    let (held, all, width) = covered_beside(5, 24, (5, 0.02), 0.02);
    assert!((78..=96).contains(&held), "{held} of {all}");
    let (_, _, plain) = covered_beside(5, 24, (5, 0.02), 1.0);
    assert!(width < 1.5 * plain, "{width} for {plain}");
}

#[test]
fn most_of_a_few_90_percent_intervals_contain_the_truth() {
    let (held, all) = covered(5, 12, 1, 0.0);
    assert!((46..=60).contains(&held), "{held} of {all}");
}

#[test]
fn intervals_are_wide_enough_for_logs_that_contradict_each_other() {
    let (held, all) = covered(5, 12, 10, 0.05);
    assert!((46..=60).contains(&held), "{held} of {all}");
}

/// 1,000 intervals and more: `cargo test --release -p realgap-inference least_squares -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn intervals_contain_the_truth_as_often_for_logs_that_contradict_each_other() {
    for (logs, spread) in [(3, 0.05), (5, 0.05), (10, 0.02), (10, 0.05), (20, 0.05)] {
        let (held, all) = covered(5, 400, logs, spread);
        let percent = 100.0 * held as f64 / all as f64;
        println!("{logs} logs, spread {spread}: {held} of {all}, {percent:.1} %");
        assert!(
            (86.0..=95.0).contains(&percent),
            "{logs}, {spread}: {percent}"
        );
    }
}

/// The same where one log alone tells of a parameter.
#[test]
#[ignore = "minutes"]
fn intervals_contain_the_truth_as_often_where_one_log_alone_tells_of_a_parameter() {
    for (logs, spread, elsewhere) in [
        (4, 0.0, 0.02),
        (4, 0.02, 0.1),
        (4, 0.05, 0.02),
        (10, 0.02, 0.02),
        (10, 0.05, 0.1),
    ] {
        let (held, all, width) = covered_beside(6, 300, (logs, spread), elsewhere);
        let percent = 100.0 * held as f64 / all as f64;
        println!(
            "{logs} logs, spread {spread}, {elsewhere} elsewhere: {held} of {all}, {percent:.1} %, mean width {width:.3}"
        );
        assert!(
            (86.0..=95.0).contains(&percent),
            "{logs}, {spread}, {elsewhere}: {percent}"
        );
    }
}

/// The same coverage for logs that agree.
#[test]
#[ignore = "minutes"]
fn intervals_of_90_percent_contain_the_truth_in_88_to_92_percent() {
    for (dimensions, fits, logs) in [(5, 400, 1), (30, 67, 1), (5, 400, 10), (30, 67, 20)] {
        let (held, all) = covered(dimensions, fits, logs, 0.0);
        let percent = 100.0 * held as f64 / all as f64;
        println!("{dimensions} parameters, {logs} logs: {held} of {all}, {percent:.1} %");
        assert!((88.0..=92.0).contains(&percent), "{dimensions}: {percent}");
    }
}

#[test]
fn weights_that_would_leave_one_draw_are_tempered_and_others_are_as_they_were() {
    let mild: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
    let plain: Vec<f64> = mild.iter().map(|e| libm::exp(-0.5 * e)).collect();
    assert_eq!(tempered(&mild, 24), plain);
    let steep: Vec<f64> = (0..200).map(|k| 5.0 * f64::from(k)).collect();
    let weights = tempered(&steep, 24);
    assert!(
        (24.0..24.1).contains(&effective(&weights)),
        "{}",
        effective(&weights)
    );
    // The better a draw, the more it counts, still.
    assert!(weights.windows(2).all(|w| w[0] > w[1]));
    // Draws that are alike cannot be told apart, whatever is asked for.
    assert_eq!(tempered(&[3.0; 10], 24), vec![1.0; 10]);
}
