//! Coverage of the intervals: how often they hold a hidden truth, in worlds that are formulas. Hundreds of such studies cost as much as
//! one study of a robot.
#![allow(clippy::print_stdout, reason = "a table is printed")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod check;
mod world;

use rand::{RngExt, SeedableRng};

use check::{RANK_BINS, agree, rank_statistic};
use world::{Output, Shape, World, grid, normal};

use crate::{
    Emulator, HistoryMatching, INTERVAL_LEVEL, ObservationUncertainty, ScoredRun,
    variant_probabilities,
};
use realgap_core::random::Generator;
use realgap_core::statistics::{chi_squared_quantile, least_by};
use realgap_optimization::{
    EvaluatedPoint, History, OptimizationProblem, Proposal, UnitPoint, optimizer_by_name,
    space_filling,
};

/// Equally valid settings of a study.
const SETTINGS: usize = 16;

/// How the points of the first runs are chosen.
#[derive(Clone, Copy)]
enum First {
    /// On a grid with so many values along each parameter.
    Grid(usize),
    /// By this optimizer, after a first design of its own.
    Chosen(&'static str),
}

/// Runs of an optimizer, its first design included.
const BUDGET: usize = 100;

/// Evaluates the points that an optimizer proposes and passes the scores back to it, as tuning does.
fn chosen(optimizer: &str, seed: u64, mut score: impl FnMut(&UnitPoint) -> f64) {
    let optimizer = optimizer_by_name(optimizer).unwrap();
    let first = space_filling(2, 0, optimizer.design(2), seed);
    let problem = OptimizationProblem {
        points: vec![21; 2],
        budget: BUDGET - first.len(),
        seed,
        priors: Vec::new(),
        error_blocks: Vec::new(),
        own: None,
    };
    let mut evaluate = |point: UnitPoint| EvaluatedPoint {
        score: Some(score(&point)),
        point,
        errors: Vec::new(),
    };
    let design: Vec<EvaluatedPoint> = first.into_iter().map(&mut evaluate).collect();
    let mut told: Vec<EvaluatedPoint> = Vec::new();
    while told.len() < problem.budget {
        let (design, history) = (&design, &told);
        let history = History {
            design,
            evaluated: history,
        };
        let Proposal::Evaluate(mut points) = optimizer.propose(&problem, &history).unwrap() else {
            break;
        };
        points.truncate(problem.budget - told.len());
        told.extend(points.into_iter().map(&mut evaluate));
    }
}

struct Found {
    intervals: [bool; 2],
    set: [bool; 2],
    open: [bool; 2],
    /// Whether an interval holds the first parameter's mirror image, which gives the same output in a world of two modes.
    mirror: bool,
    /// Whether the second parameter is found to be active.
    active: bool,
    widths: [f64; 2],
    /// Share of the draws that are below the truth.
    ranks: [f64; 2],
}

/// History matching of a world whose truth is hidden: first runs, then three waves.
fn study(world: &World, first: First, observations: usize, seed: u64) -> Found {
    let grid = grid(match first {
        First::Grid(points) => points,
        First::Chosen(_) => 21,
    });
    let mut rng = Generator::seed_from_u64(1_000 + seed);
    let truth = [
        0.1 + 0.8 * rng.random::<f64>(),
        0.1 + 0.8 * rng.random::<f64>(),
    ];
    // Every study has sixteen settings of its own: with the same ones in all, the coverage of all would be too high or too low
    // together.
    let own_settings = 100 * (seed + 1);
    let (hidden, variants) = (1_000_000 + seed, 2_000_000 + seed);
    // Every third run is of the first variant, and every second reality is like it.
    let variant_of = |setting: usize| match setting % 3 {
        _ if world.variant == 0.0 => 0.0,
        0 => 1.0,
        _ => -1.0,
    };
    let like = [1.0, -1.0][seed as usize % 2];
    let real: Vec<Output> = (0..observations)
        .map(|_| {
            world.run(
                &truth,
                (hidden, variants, like),
                &mut rng,
                world.observation,
            )
        })
        .collect();
    let mut runs: Vec<ScoredRun> = Vec::new();
    let simulate_as =
        |runs: &mut Vec<ScoredRun>, (at, setting): (Vec<f64>, usize), rng: &mut Generator| {
            // Where there is a single observation, runs are made with its noise, because it cannot show any.
            let own = if observations == 1 {
                world.observation
            } else {
                world.run
            };
            let variant = variant_of(setting);
            let numbers = (own_settings + setting as u64, variants, variant);
            let output = world.run(&at, numbers, rng, own);
            let distance = |real: &Output| {
                let squares = real.iter().zip(&output).map(|(a, b)| (a - b).powi(2));
                squares.sum::<f64>().sqrt()
            };
            runs.push(ScoredRun {
                point: at,
                setting: setting as u64,
                variant,
                scores: real.iter().map(distance).collect(),
                surrogate_scores: Vec::new(),
            });
        };
    let simulate = |runs: &mut Vec<ScoredRun>, at: Vec<f64>, rng: &mut Generator| {
        let setting = runs.len() % SETTINGS;
        simulate_as(runs, (at, setting), rng);
    };
    match first {
        First::Grid(_) => {
            for index in 0..grid.len() {
                simulate(&mut runs, grid.place_of(&grid.values(index)), &mut rng);
            }
        }
        First::Chosen(optimizer) => chosen(optimizer, seed, |at| {
            simulate(&mut runs, at.clone(), &mut rng);
            runs[runs.len() - 1].score()
        }),
    }
    let uncertainty = ObservationUncertainty {
        observations,
        discrepancy: 0.0,
    };
    let (mut known, mut active) = (None, Vec::new());
    for wave in 0..=3 {
        let emulator = Emulator::new(&runs).unwrap().unwrap();
        let mut weights = emulator.equal_weights();
        if let (3, [first, second]) = (wave, emulator.variants()) {
            // All settings of each variant at its own best point, as studies simulate them.
            let scores = [*first, *second].map(|variant| {
                let places = runs.iter().map(|run| run.point.clone());
                let expected = places.map(|at| (emulator.mean_in(&at, variant), at));
                let (_, at) = least_by(expected, |(score, _)| *score).unwrap();
                let own = (0..SETTINGS).filter(|number| variant_of(*number) == variant);
                let mut there = Vec::new();
                for setting in own {
                    simulate_as(&mut there, (at.clone(), setting), &mut rng);
                }
                there.iter().map(ScoredRun::score).collect::<Vec<f64>>()
            });
            weights = variant_probabilities(scores.each_ref().map(Vec::as_slice)).to_vec();
        }
        let matching = HistoryMatching::new(
            (&emulator, &weights),
            &grid,
            &[],
            uncertainty,
            200 + 100 * (wave / 3),
            seed,
        );
        if wave < 3 {
            let chosen = matching.wave(16, &mut rng);
            let chosen: Vec<Vec<f64>> = chosen.iter().map(|place| place.to_vec()).collect();
            for at in chosen {
                simulate(&mut runs, at, &mut rng);
            }
        } else {
            active = emulator.active();
            known = Some(matching);
        }
    }
    let known = known.unwrap();
    let draws = known.draws(&grid, seed);
    let set: Vec<Vec<f64>> = known
        .unvisited(&grid)
        .into_iter()
        .filter(|point| point.indistinguishable)
        .map(|point| grid.place_of(&point.values))
        .collect();
    let ends = [0, 1].map(|axis| {
        let all = || set.iter().map(|place| place[axis]);
        (all().fold(1.0, f64::min), all().fold(0.0, f64::max))
    });
    let parts = [0, 1].map(|axis| draws.intervals(axis, INTERVAL_LEVEL));
    let axes = [0, 1];
    let drawn = axes.map(|axis| {
        draws
            .rows()
            .iter()
            .map(|row| row[axis])
            .collect::<Vec<f64>>()
    });
    for (axis, parts) in parts.iter().enumerate() {
        agree(axis, parts, &draws, set.iter().map(|point| point[axis]));
    }
    if std::env::var("REALGAP_VERBOSE").is_ok() {
        println!(
            "seed {seed}, truth {truth:?}: {parts:?}; {} of {} in the set",
            set.len(),
            known.unvisited(&grid).len()
        );
    }
    Found {
        intervals: axes.map(|a| parts[a].iter().any(|(l, h)| (*l..=*h).contains(&truth[a]))),
        set: axes.map(|a| (ends[a].0..=ends[a].1).contains(&truth[a])),
        ranks: axes.map(|axis| {
            let below = drawn[axis].iter().filter(|value| **value < truth[axis]);
            below.count() as f64 / drawn[axis].len() as f64
        }),
        mirror: parts[0]
            .iter()
            .any(|(l, h)| (*l..=*h).contains(&(1.0 - truth[0]))),
        active: active[1],
        open: axes.map(|a| ends[a].0 <= 0.05 && ends[a].1 >= 0.95),
        widths: axes.map(|a| parts[a].iter().map(|(l, h)| h - l).sum()),
    }
}

fn row(what: &str, world: &World, design: First, observations: usize, studies: u64) -> Row {
    let first: u64 = std::env::var("REALGAP_FIRST").map_or(0, |n| n.parse().unwrap());
    let all: Vec<Found> = (first..first + studies)
        .map(|seed| study(world, design, observations, seed))
        .collect();
    let share = |of: &dyn Fn(&Found) -> bool| {
        100.0 * all.iter().filter(|found| of(found)).count() as f64 / studies as f64
    };
    let width = |axis: usize| {
        let mut widths: Vec<f64> = all.iter().map(|found| found.widths[axis]).collect();
        widths.sort_by(f64::total_cmp);
        widths[widths.len() / 2]
    };
    let [a, b, set, open] = [
        share(&|f| f.intervals[0]),
        share(&|f| f.intervals[1]),
        0.5 * (share(&|f| f.set[0]) + share(&|f| f.set[1])),
        share(&|f| f.open[1]),
    ];
    let ranks = [0, 1].map(|axis| {
        all.iter()
            .map(|found| found.ranks[axis])
            .collect::<Vec<_>>()
    });
    let ranks = ranks.map(|ranks| rank_statistic(&ranks));
    println!(
        "{what} | {a:.0} {b:.0} | set {set:.0} | second open {open:.0}, acts {:.0} | mirror {:.0} | ranks {:.1} {:.1} | widths {:.4} {:.3}",
        share(&|f| f.active),
        share(&|f| f.mirror),
        ranks[0],
        ranks[1],
        width(0),
        width(1)
    );
    Row {
        held: [a, b],
        set,
        open,
        ranks,
        mirror: share(&|f| f.mirror),
        widths: [width(0), width(1)],
    }
}

/// Percentages over the studies of a row of the table.
struct Row {
    /// Intervals that hold the truth, by parameter.
    held: [f64; 2],
    /// Confidence sets that hold the truth.
    set: f64,
    /// Studies in which the second parameter's confidence set reaches both ends.
    open: f64,
    /// Statistic of the truth's ranks, by parameter.
    ranks: [f64; 2],
    mirror: f64,
    /// Median widths.
    widths: [f64; 2],
}

/// 20 studies with a true coverage of 0.90: fewer than 14 hold in 0.2 % of cases.
#[test]
fn intervals_hold_and_what_does_nothing_stays_open() {
    let world = World {
        second: 0.0,
        setting: 0.02,
        run: 0.005,
        observation: 0.05,
        variant: 0.0,
        shape: Shape::Bent,
    };
    let found = row("inert 7 3", &world, First::Grid(7), 3, 20);
    let Row { set, open, .. } = found;
    assert!(
        found.held[0] >= 70.0 && set >= 85.0,
        "{} {set}",
        found.held[0]
    );
    assert!(open >= 75.0, "{open}");
}

/// Two values of the first parameter give the same output. Both are found between the points of a coarse grid, each with an interval
/// of its own and nothing between the two.
#[test]
fn two_narrow_modes_get_an_interval_each() {
    let world = World {
        shape: Shape::TwoModes,
        second: 0.0,
        setting: 0.004,
        run: 0.0002,
        observation: 0.004,
        variant: 0.0,
    };
    let found = row("modes 7 3", &world, First::Grid(7), 3, 12);
    // At 0.9 each, fewer than 8 of 12 hold in 0.4 % of cases.
    assert!(
        found.held[0] >= 66.0 && found.mirror >= 66.0,
        "{} {}",
        found.held[0],
        found.mirror
    );
    assert!(found.widths[0] < 0.02, "{}", found.widths[0]);
    assert!(found.open >= 75.0, "{}", found.open);
}

/// Reality is like one of two variants of the black box. A mean over both would be wide, or prefer points that suit neither.
#[test]
fn of_two_variants_the_intervals_hold_the_one_that_reality_is_like() {
    let world = World {
        shape: Shape::Bent,
        second: 0.0,
        setting: 0.02,
        run: 0.005,
        observation: 0.05,
        variant: 0.1,
    };
    let found = row("engines 7 3", &world, First::Grid(7), 3, 12);
    assert!(found.held[0] >= 66.0, "{}", found.held[0]);
    assert!(found.widths[0] < 0.05, "{}", found.widths[0]);
}

/// The draws are drawn from the posterior distribution, not merely wide enough: at a level of 0.1 % the ranks are uniform.
#[test]
fn the_truth_has_any_rank_among_the_draws_equally_often() {
    let world = World {
        shape: Shape::Bent,
        second: 0.5,
        setting: 0.02,
        run: 0.005,
        observation: 0.05,
        variant: 0.0,
    };
    let found = row("both 7 3", &world, First::Grid(7), 3, 30);
    let most = chi_squared_quantile(0.999, (RANK_BINS - 1) as f64);
    assert!(
        found.ranks.iter().all(|ranks| *ranks < most),
        "{:?}",
        found.ranks
    );
}

/// The scores are noise alone. The emulator is then often flat up to rounding errors, and no point may be preferred to others.
#[test]
fn where_no_parameter_does_anything_all_values_stay_open() {
    let grid = grid(7);
    for seed in 0..20 {
        let mut rng = Generator::seed_from_u64(seed);
        let runs: Vec<ScoredRun> = (0..grid.len())
            .map(|index| ScoredRun {
                point: grid.place_of(&grid.values(index)),
                setting: (index % SETTINGS) as u64,
                variant: 0.0,
                scores: (0..3).map(|_| 1.0 + 0.1 * normal(&mut rng)).collect(),
                surrogate_scores: Vec::new(),
            })
            .collect();
        let emulator = Emulator::new(&runs).unwrap().unwrap();
        let uncertainty = ObservationUncertainty {
            observations: 3,
            discrepancy: 0.0,
        };
        let matching = HistoryMatching::new(
            (&emulator, &emulator.equal_weights()),
            &grid,
            &[],
            uncertainty,
            200,
            seed,
        );
        let draws = matching.draws(&grid, seed);
        let flat = !emulator.active().contains(&true);
        for axis in 0..2 {
            let parts = draws.intervals(axis, INTERVAL_LEVEL);
            let width: f64 = parts.iter().map(|(low, high)| high - low).sum();
            let least = if flat { 0.85 } else { 0.3 };
            assert!(
                width > least,
                "seed {seed}, axis {axis}, flat {flat}: {parts:?}"
            );
        }
    }
}

#[test]
#[ignore = "minutes: the table"]
fn the_table_of_worlds() {
    let studies = std::env::var("REALGAP_STUDIES").map_or(100, |n| n.parse().unwrap());
    let quiet = World {
        second: 0.0,
        setting: 0.02,
        run: 0.005,
        observation: 0.05,
        variant: 0.0,
        shape: Shape::Bent,
    };
    let both = World {
        second: 0.5,
        ..quiet
    };
    let loud = World {
        second: 0.5,
        setting: 0.1,
        run: 0.2,
        observation: 0.2,
        variant: 0.0,
        shape: Shape::Bent,
    };
    // Like a cube that slides down a slope: nearly no noise, and a kink at the truth.
    let slide = World {
        second: 0.0,
        setting: 0.004,
        run: 0.0002,
        observation: 0.004,
        variant: 0.0,
        shape: Shape::Straight,
    };
    let modes = World {
        shape: Shape::TwoModes,
        ..slide
    };
    let ridge = World {
        shape: Shape::Ridge,
        ..slide
    };
    let moved = World {
        setting: 0.15,
        observation: 0.02,
        ..quiet
    };
    let variants = World {
        variant: 0.1,
        ..quiet
    };
    let only = std::env::var("REALGAP_ROWS").unwrap_or_default();
    let worlds = [
        ("slide", &slide),
        ("moved", &moved),
        ("inert", &quiet),
        ("both", &both),
        ("loud", &loud),
        ("engines", &variants),
        ("modes", &modes),
        ("ridge", &ridge),
    ];
    for observations in [3, 1, 5, 10] {
        let chosen = ["cma-es", "nelder-mead", "bayesian"].map(|name| (name, First::Chosen(name)));
        let grids = [("7", First::Grid(7)), ("10", First::Grid(10))];
        for (search, first) in grids.into_iter().chain(chosen) {
            for (name, world) in worlds {
                let what = format!("{name} {search} {observations}");
                if what.contains(&only) {
                    row(&what, world, first, observations, studies);
                }
            }
        }
    }
}
