//! The contract test: properties that every optimizer must have, whichever library implements it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use realgap_optimization::{
    EvaluatedPoint, History, OPTIMIZERS, OptimizationProblem, Optimizer, Proposal, UnitPoint,
    space_filling,
};

/// Runs an optimizer on a function until its budget is spent, as the driver does.
fn minimise(
    optimizer: &dyn Optimizer,
    dimensions: usize,
    budget: usize,
    seed: u64,
    target: &[f64],
    score: impl Fn(&UnitPoint) -> Option<f64>,
) -> Vec<EvaluatedPoint> {
    let evaluate = |point: UnitPoint| {
        let score = score(&point);
        EvaluatedPoint {
            errors: score.map_or_else(Vec::new, |_| errors(&point, target)),
            score,
            point,
        }
    };
    let design = optimizer.design(dimensions);
    let problem = OptimizationProblem {
        points: vec![11; dimensions],
        budget: budget - design,
        seed,
        priors: Vec::new(),
        error_blocks: Vec::new(),
        own: None,
    };
    let mut all: Vec<EvaluatedPoint> = space_filling(dimensions, 0, design, seed)
        .into_iter()
        .map(evaluate)
        .collect();
    while all.len() < budget {
        let (design, evaluated) = all.split_at(design);
        let proposal = optimizer
            .propose(&problem, &History { design, evaluated })
            .unwrap();
        let Proposal::Evaluate(batch) = proposal else {
            break;
        };
        assert!(!batch.is_empty(), "{} asks for nothing", optimizer.name());
        let remaining = budget - all.len();
        for point in batch.into_iter().take(remaining) {
            assert_eq!(point.len(), dimensions, "{}", optimizer.name());
            assert!(
                point.iter().all(|c| (0.0..=1.0).contains(c)),
                "{} leaves the bounds: {point:?}",
                optimizer.name()
            );
            all.push(evaluate(point));
        }
    }
    all
}

/// Errors whose score has its minimum near a point: one error for each parameter, with a ripple on all of them.
fn errors(point: &[f64], target: &[f64]) -> Vec<f64> {
    let ripple: f64 = point.iter().map(|c| (47.0 * c).sin()).product();
    let axes = point.iter().zip(target);
    axes.map(|(c, at)| c - at + 0.002 * ripple).collect()
}

fn best(evaluated: &[EvaluatedPoint]) -> &EvaluatedPoint {
    let scored = evaluated.iter().filter(|t| t.score.is_some());
    scored
        .min_by(|a, b| a.score.unwrap().total_cmp(&b.score.unwrap()))
        .unwrap()
}

fn distance(point: &[f64], target: &[f64]) -> f64 {
    point
        .iter()
        .zip(target)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// A curved valley with ripples, as rough as a walking robot's score.
fn rough(point: &UnitPoint, target: &[f64]) -> f64 {
    let far = distance(point, target);
    let ripple: f64 = point.iter().map(|c| (47.0 * c).sin()).product();
    1.0 + far + 0.02 * ripple
}

#[test]
fn every_optimizer_finds_a_hidden_point() {
    let target = [0.31, 0.74];
    for optimizer in OPTIMIZERS {
        let evaluated = minimise(*optimizer, 2, 100, 3, &target, |point| {
            Some(rough(point, &target))
        });
        let found = distance(&best(&evaluated).point, &target);
        // With a hundred evenly spread points, the nearest may be as far away as half their spacing.
        let promised = match optimizer.name() {
            "grid" | "random" => 0.1,
            _ => 0.05,
        };
        assert!(found < promised, "{} ends {found} away", optimizer.name());
    }
}

#[test]
fn every_optimizer_beats_space_filling_points_in_four_dimensions() {
    let target = [0.2, 0.6, 0.45, 0.8];
    let score = |point: &UnitPoint| Some(rough(point, &target));
    let even = OPTIMIZERS.iter().find(|o| o.name() == "random").unwrap();
    let baseline = distance(
        &best(&minimise(*even, 4, 150, 5, &target, score)).point,
        &target,
    );
    for optimizer in OPTIMIZERS {
        if !["grid", "random"].contains(&optimizer.name()) {
            let evaluated = minimise(*optimizer, 4, 150, 5, &target, score);
            let found = distance(&best(&evaluated).point, &target);
            assert!(
                found < baseline,
                "{} ends {found} away, space-filling points {baseline}",
                optimizer.name()
            );
        }
    }
}

#[test]
fn candidates_that_fail_do_not_stop_the_search() {
    let target = [0.3, 0.3];
    for optimizer in OPTIMIZERS {
        // More than half of the space diverges.
        let evaluated = minimise(*optimizer, 2, 100, 7, &target, |point| {
            (point[0] + point[1] < 0.9).then(|| rough(point, &target))
        });
        let found = distance(&best(&evaluated).point, &target);
        assert!(found < 0.12, "{} ends {found} away", optimizer.name());
    }
}

#[test]
fn a_search_in_which_every_candidate_fails_does_not_end_in_an_error() {
    for optimizer in OPTIMIZERS {
        let evaluated = minimise(*optimizer, 2, 60, 1, &[0.5; 2], |_| None);
        assert!(
            evaluated.len() >= 49,
            "{}: {}",
            optimizer.name(),
            evaluated.len()
        );
    }
}

#[test]
fn the_same_history_and_seed_give_the_same_bits() {
    let target = [0.5, 0.1, 0.9];
    for optimizer in OPTIMIZERS {
        let run = |seed| {
            minimise(*optimizer, 3, 70, seed, &target, |point| {
                Some(rough(point, &target))
            })
        };
        assert_eq!(run(11), run(11), "{}", optimizer.name());
        if optimizer.name() != "grid" {
            assert_ne!(run(11), run(12), "{} ignores its seed", optimizer.name());
        }
    }
}

#[test]
fn one_parameter_is_enough() {
    for optimizer in OPTIMIZERS {
        let evaluated = minimise(*optimizer, 1, 40, 2, &[0.62], |point| {
            Some((point[0] - 0.62).powi(2))
        });
        let found = (best(&evaluated).point[0] - 0.62).abs();
        assert!(found < 0.03, "{} ends {found} away", optimizer.name());
    }
}

/// A function of arithmetic operations only, so that it has the same bits on every platform.
fn bumpy(point: &UnitPoint) -> f64 {
    let axes = point.iter().enumerate();
    axes.map(|(axis, c)| {
        let off = c - 0.3 - 0.1 * axis as f64;
        let tooth = (7.0 * c) % 1.0;
        (1.0 + axis as f64) * off * off + 0.05 * tooth * (1.0 - tooth)
    })
    .sum()
}

/// tests/golden/optimizer_points.csv holds what argmin 0.11.0 chose, its swarm with rand 0.9 and rand_xoshiro 0.7.
#[test]
fn simplex_and_swarm_choose_the_same_points_as_argmin() {
    let text = include_str!("golden/optimizer_points.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows: Vec<csv::StringRecord> = table.records().map(|row| row.unwrap()).collect();
    let mut searches = 0;
    for rows in rows.chunk_by(|a, b| (0..5).all(|column| a[column] == b[column])) {
        let optimizer = OPTIMIZERS.iter().find(|o| o.name() == &rows[0][0]).unwrap();
        let number = |column: usize| rows[0][column].parse::<usize>().unwrap();
        let (dimensions, seed, design) = (number(1), number(2) as u64, number(3));
        let fails = &rows[0][4] == "true";
        let evaluate = |point: UnitPoint| EvaluatedPoint {
            score: (!fails || point[0] < 0.85).then(|| bumpy(&point)),
            point,
            errors: Vec::new(),
        };
        let problem = OptimizationProblem {
            points: vec![11; dimensions],
            budget: rows.len(),
            seed,
            priors: Vec::new(),
            error_blocks: Vec::new(),
            own: None,
        };
        let design: Vec<EvaluatedPoint> = space_filling(dimensions, 0, design, seed)
            .into_iter()
            .map(evaluate)
            .collect();
        let mut evaluated = Vec::new();
        while evaluated.len() < rows.len() {
            let history = History {
                design: &design,
                evaluated: &evaluated,
            };
            let Proposal::Evaluate(batch) = optimizer.propose(&problem, &history).unwrap() else {
                panic!("{} ends", optimizer.name());
            };
            evaluated.extend(batch.into_iter().map(evaluate));
        }
        for (index, (row, chosen)) in rows.iter().zip(&evaluated).enumerate() {
            let golden: Vec<f64> = row[5].split(' ').map(|c| c.parse().unwrap()).collect();
            assert_eq!(chosen.point, golden, "{} point {index}", optimizer.name());
        }
        searches += 1;
    }
    assert_eq!(searches, 7);
}
