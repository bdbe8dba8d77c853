//! Coverage of the intervals: how often they hold a hidden truth, in worlds that are formulas. Hundreds of such studies cost as much as
//! one study of a robot.
#![allow(clippy::print_stdout, reason = "a table is printed")]
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

use crate::{Emulator, HistoryMatching, INTERVAL_LEVEL, ObservationUncertainty, ScoredRun};
use realgap_core::quantity::{Quantity, Scale};
use realgap_core::random::Generator;
use realgap_core::unit::Unit;
use realgap_optimization::{
    EvaluatedPoint, Grid, History, OptimizationProblem, Proposal, Range, UnitPoint,
    optimizer_by_name, space_filling,
};

/// Numbers of an output, and equally valid settings.
const OUTPUTS: usize = 12;
const SETTINGS: usize = 16;

/// A black box whose output has a closed form: the first parameter bends it, the second changes it by `second` times as much.
struct World {
    second: f64,
    /// Standard deviations of the deviations of a setting, a run and an observation, as shares of the output.
    setting: f64,
    run: f64,
    observation: f64,
    /// Standard deviation of either of two variants from their mean; reality is like one of them. 0 where there is one variant.
    variant: f64,
    shape: Shape,
}

/// How the output depends on the parameters.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    /// The first parameter bends the output, the second one changes it.
    Bent,
    /// Linear in the first parameter, so that the distance to reality has a kink.
    Straight,
    /// Linear in the distance of the first parameter from the middle, so that two values, on both sides of the middle, give the same
    /// output; both valleys of the score are narrow beside a coarse grid.
    TwoModes,
    /// Both parameters act through their sum alone.
    Ridge,
}

type Output = [f64; OUTPUTS];

fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}

fn noise(rng: &mut Generator, size: f64) -> Output {
    std::array::from_fn(|k| size * normal(rng) / (k + 1) as f64)
}

impl World {
    fn output(&self, at: &[f64]) -> Output {
        let line =
            |at: f64| std::array::from_fn(|k| at * ((k + 1) as f64 / OUTPUTS as f64).powi(2));
        match self.shape {
            Shape::Bent => {}
            Shape::Straight => return line(at[0]),
            Shape::TwoModes => return line(4.0 * (at[0] - 0.5).abs()),
            Shape::Ridge => return line(0.5 * (at[0] + at[1])),
        }
        std::array::from_fn(|k| {
            let bend = libm::sin(3.0 * at[0] * (1.0 + 0.2 * k as f64) + 0.3 * k as f64);
            let other = libm::cos(2.0 * at[1] + k as f64);
            (bend + self.second * other) / (1.0 + 0.3 * k as f64)
        })
    }

    /// A run with the setting and the variants of these numbers; the third number, 1 or −1, says which variant is run.
    fn run(
        &self,
        at: &[f64],
        (setting, variants, variant): (u64, u64, f64),
        rng: &mut Generator,
        size: f64,
    ) -> Output {
        let (output, rest) = (self.output(at), noise(rng, size));
        let own = deviation(setting, at, self.setting);
        let half_difference = deviation(variants, at, self.variant);
        std::array::from_fn(|k| output[k] + own[k] + rest[k] + variant * half_difference[k])
    }
}

/// Deviation of the setting or the variant with this number; it changes smoothly with the parameters.
fn deviation(number: u64, at: &[f64], size: f64) -> Output {
    let mut rng = Generator::seed_from_u64(number);
    let (a, b) = (noise(&mut rng, size), noise(&mut rng, size));
    std::array::from_fn(|k| a[k] + b[k] * libm::sin(2.0 * at[0]))
}

fn grid(points: usize) -> Grid {
    let range = |name| {
        let parameter = Quantity {
            name,
            unit: Unit::One,
            bounds: (0.0, 1.0),
            whole: false,
            scale: Scale::Linear,
        };
        Range::new(parameter, 0.0, 1.0, points).unwrap()
    };
    Grid::new(vec![range("first"), range("second")]).unwrap()
}

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
    let simulate = |runs: &mut Vec<ScoredRun>, at: Vec<f64>, rng: &mut Generator| {
        let setting = runs.len() % SETTINGS;
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
        let matching = HistoryMatching::new(
            &emulator,
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
        mirror: parts[0]
            .iter()
            .any(|(l, h)| (*l..=*h).contains(&(1.0 - truth[0]))),
        active: active[1],
        open: axes.map(|a| ends[a].0 <= 0.05 && ends[a].1 >= 0.95),
        widths: axes.map(|a| parts[a].iter().map(|(l, h)| h - l).sum()),
    }
}

fn row(what: &str, world: &World, design: First, observations: usize, studies: u64) -> [f64; 4] {
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
    println!(
        "{what} | {a:.0} {b:.0} | set {set:.0} | second open {open:.0}, acts {:.0} | mirror {:.0} | widths {:.4} {:.3}",
        share(&|f| f.active),
        share(&|f| f.mirror),
        width(0),
        width(1)
    );
    [a, b, set, open]
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
    let [first, _, set, open] = row("inert 7 3", &world, First::Grid(7), 3, 20);
    assert!(first >= 70.0 && set >= 85.0, "{first} {set}");
    assert!(open >= 75.0, "{open}");
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
        let matching = HistoryMatching::new(&emulator, &grid, &[], uncertainty, 200, seed);
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
