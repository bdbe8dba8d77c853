//! Coverage of intervals and sets: many studies with known true parameters, whose reality has numerical settings that the study
//! does not know.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(
    clippy::print_stdout,
    reason = "the numbers in docs/validation/intervals.md"
)]

use crate::common;

use realgap_core::statistics::Proportion;
use realgap_lab::calibration::{Answer, Study, TuneOptions};
use realgap_optimization::{RunOptions, optimizer_by_name};
use realgap_path::comparison;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::by_name;
use realgap_simulation::{Camera, Distribution, Experiment, Noise, Sampling, run};

/// The robot, and with it the parameters that the study has to find.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Robot {
    /// A cube that slides down a slope: its path determines the friction, and contains no information about the mass.
    Slide,
    /// Two modules that walk: friction and the amplitude of their gait.
    Walk,
    /// Two modules that walk for 10 s on a hidden floor, always recorded in Rapier: its friction, and its restitution, which the path
    /// hardly contains.
    Floor,
}

/// How the points of a study are chosen.
#[derive(Debug, Clone, Copy)]
enum Search {
    Sweep(usize, usize),
    Tune(&'static str, usize),
}

/// One kind of study.
#[derive(Debug, Clone, Copy)]
struct Plan {
    robot: Robot,
    search: Search,
    recordings: u64,
}

/// A parameter and its searched range; the true value may lie anywhere in this range.
type Varied = (&'static str, (f64, f64));

impl Robot {
    fn varied(self) -> [Varied; 2] {
        match self {
            Self::Slide => [
                ("floor.friction", (0.05, 0.6)),
                ("body.mass_scale", (0.5, 1.5)),
            ],
            Self::Walk => [
                ("floor.friction", (0.05, 1.0)),
                ("gait.amplitude_scale", (0.7, 1.3)),
            ],
            Self::Floor => [
                ("floor.friction", (0.05, 1.0)),
                ("floor.restitution", (0.0, 0.9)),
            ],
        }
    }

    fn duration_s(self) -> f64 {
        match self {
            Self::Slide => 0.8,
            Self::Walk => 2.0,
            Self::Floor => 10.0,
        }
    }

    /// Whether the parameter of this index has no effect.
    fn is_inert(self, parameter: usize) -> bool {
        self == Self::Slide && parameter == 1
    }

    fn morphology(self) -> Morphology {
        let name = match self {
            Self::Slide => "cube",
            Self::Walk | Self::Floor => "two_module",
        };
        Morphology::read(common::project().join(format!("morphologies/{name}.ron"))).unwrap()
    }

    /// Parameters that every study of this robot fixes.
    fn fixed(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Slide => &[("floor.slope_rad", 0.6)],
            Self::Walk | Self::Floor => &[],
        }
    }
}

/// The true values, which the study does not know: they spread evenly over the ranges, on and between the points of any grid.
fn truth(robot: Robot, seed: u64) -> [f64; 2] {
    // Roberts' R2 sequence.
    let steps = [0.754_877_666_246_693, 0.569_840_290_998_053];
    let varied = robot.varied();
    [0, 1].map(|axis| {
        let (low, high) = varied[axis].1;
        low + (high - low) * (0.5 + seed as f64 * steps[axis]).fract()
    })
}

/// Repeats of a run in that reality. The robot is put down by hand, has servos of one make and is recorded by a camera. Its engine,
/// timestep, substeps and contact stiffness differ from those of the study: up to twice as fine, and 1.4 times as soft or hard. Of
/// [`Robot::Floor`] timestep and substeps alone differ, and all recordings are of one robot.
fn reality(plan: Plan, seed: u64) -> Vec<Trajectory> {
    let robot = plan.robot;
    let mut hidden = Experiment::new(robot.morphology().assemble());
    hidden.duration_s = robot.duration_s();
    hidden.sampling = Sampling::Rate(60.0);
    let truth = truth(robot, seed);
    let share = |step: f64| (0.25 + seed as f64 * step).fract();
    let hertz = by_name("contact.natural_frequency_hz").unwrap();
    let factor = match robot {
        Robot::Floor => 1.0,
        _ => 2.0_f64.powf(share(0.324_717_957_244_746) - 0.5),
    };
    let stiffness = hertz.value(&hidden).unwrap() * factor;
    let named = [0, 1].map(|axis| (robot.varied()[axis].0, truth[axis]));
    let all = robot.fixed().iter().copied().chain(named);
    for (name, value) in all.chain([("contact.natural_frequency_hz", stiffness)]) {
        hidden = by_name(name).unwrap().apply(&hidden, value).unwrap();
    }
    // A study regards both engines as equally valid, so reality uses one and the other in turn.
    if robot != Robot::Floor {
        let engine = by_name("solver.engine").unwrap();
        hidden = engine.apply(&hidden, (seed % 2) as f64).unwrap();
    }
    hidden.solver.timestep_s *= 0.5_f64.powf(share(0.618_033_988_749_895));
    let more = 2.0_f64.powf(share(0.414_213_562_373_095));
    hidden.solver.substeps = (hidden.solver.substeps as f64 * more).round() as usize;
    let camera = Camera {
        position_m: Distribution::Normal(1e-3),
        ..Camera::default()
    };
    let noise = match robot {
        Robot::Floor => Noise::careful_start(),
        _ => Noise::careful_repeat(),
    };
    (0..plan.recordings)
        .map(|repeat| {
            let run = run(&noise.perturb(&hidden, 1000 + seed, repeat)).unwrap();
            let seen = run.outcome.completed().unwrap();
            camera.record(&seen, 1000 + seed, repeat).unwrap()
        })
        .collect()
}

fn answer(plan: Plan, seed: u64) -> Answer {
    let points = match plan.search {
        Search::Sweep(first, second) => [first, second],
        Search::Tune(..) => [21, 21],
    };
    let mut study = Study::builder("coverage", plan.robot.morphology())
        .duration_s(plan.robot.duration_s())
        .seed(seed);
    if plan.robot != Robot::Floor {
        study = study.metric(comparison::by_name("rms").unwrap());
    }
    for (axis, (name, (from, to))) in plan.robot.varied().into_iter().enumerate() {
        study = study.vary(name, from, to, points[axis]);
    }
    for (name, value) in plan.robot.fixed() {
        study = study.set(*name, *value);
    }
    for (index, recorded) in reality(plan, seed).into_iter().enumerate() {
        study = study.trajectory(format!("run_{index}"), recorded);
    }
    let study = study.build().unwrap();
    match plan.search {
        Search::Sweep(..) => study.sweep(&RunOptions::default()).unwrap(),
        Search::Tune(optimizer, budget) => {
            let options = TuneOptions {
                optimizer: optimizer_by_name(optimizer).unwrap(),
                budget,
                patience: None,
            };
            study.tune(&options, &RunOptions::default()).unwrap()
        }
    }
}

/// The result of a study for one parameter.
#[derive(Debug, Clone, Copy)]
struct ParameterResult {
    /// The 90 % interval, or one of several, holds the truth.
    interval: bool,
    /// The range of values that fit as well as the best holds the truth.
    range: bool,
    /// The study calls the parameter determined.
    determined: bool,
    /// Length of the intervals, as a share of the searched range.
    width: f64,
}

fn study(plan: Plan, seed: u64) -> ([ParameterResult; 2], bool) {
    let answer = answer(plan, seed);
    let (truth, varied) = (truth(plan.robot, seed), plan.robot.varied());
    let results = [0, 1].map(|axis| {
        let verdict = &answer.report.verdicts[axis];
        let parts: Vec<(f64, f64)> = verdict
            .interval
            .into_iter()
            .chain(verdict.intervals.clone())
            .collect();
        let (from, to) = varied[axis].1;
        ParameterResult {
            interval: parts
                .iter()
                .any(|(low, high)| (*low..=*high).contains(&truth[axis])),
            range: (verdict.low..=verdict.high).contains(&truth[axis]),
            determined: verdict.identified,
            width: parts.iter().map(|(low, high)| high - low).sum::<f64>() / (to - from),
        }
    });
    let is_wrong = |axis: usize| match plan.robot.is_inert(axis) {
        true => results[axis].determined,
        false => !results[axis].interval,
    };
    let contradicted = answer.report.fit.as_ref().is_some_and(|fit| !fit.explains);
    let says = std::env::var("REALGAP_VERBOSE").unwrap_or_default();
    if says == "all" || !says.is_empty() && (is_wrong(0) || is_wrong(1) || contradicted) {
        println!("seed {seed}, truth {truth:?}: {answer}");
    }
    (results, contradicted)
}

/// Counts over the studies of one plan.
struct Row {
    /// Intervals that hold the truth.
    held: usize,
    /// Ranges of values that fit as well as the best that hold the truth.
    ranges: usize,
    /// Number of intervals, and of ranges.
    of: usize,
    /// Studies that called a parameter without effect determined.
    inert: usize,
    /// Studies that found that no parameters explain the recordings.
    contradicted: usize,
    /// Median lengths of the intervals, as shares of the searched ranges.
    widths: [f64; 2],
}

/// Runs the studies with these seeds.
fn table_row(plan: Plan, seeds: std::ops::Range<u64>) -> Row {
    let all: Vec<([ParameterResult; 2], bool)> =
        seeds.clone().map(|seed| study(plan, seed)).collect();
    let each = || {
        all.iter()
            .flat_map(|(results, _)| results.iter().enumerate())
    };
    let with_effect = || each().filter(|(axis, _)| !plan.robot.is_inert(*axis));
    let width = |axis: usize| {
        let mut widths: Vec<f64> = all.iter().map(|(results, _)| results[axis].width).collect();
        widths.sort_by(f64::total_cmp);
        widths[widths.len() / 2]
    };
    let row = Row {
        held: with_effect().filter(|(_, result)| result.interval).count(),
        ranges: with_effect().filter(|(_, result)| result.range).count(),
        of: with_effect().count(),
        inert: each()
            .filter(|(axis, result)| plan.robot.is_inert(*axis) && result.determined)
            .count(),
        contradicted: all.iter().filter(|(_, contradicted)| *contradicted).count(),
        widths: [width(0), width(1)],
    };
    let held = Proportion::new(row.held, row.of, 0.95);
    println!(
        "| {:?}, {:?} | {} | {seeds:?} | {} of {} ({:.0} to {:.0} %) | {} of {} | {} | {} | {:.3}, {:.3} |",
        plan.robot,
        plan.search,
        plan.recordings,
        row.held,
        row.of,
        100.0 * held.low,
        100.0 * held.high,
        row.ranges,
        row.of,
        row.inert,
        row.contradicted,
        row.widths[0],
        row.widths[1],
    );
    row
}

/// 16 studies with a coarse grid of the friction of a sliding cube and of its mass, which has no effect. At a true coverage of
/// 0.90, fewer than 12 of 16 intervals hold the truth in 2 % of cases.
#[test]
fn a_coarse_sweep_determines_parameters_with_an_effect_and_no_others() {
    if !common::is_long_run("coverage of sixteen sweeps") {
        return;
    }
    let plan = Plan {
        robot: Robot::Slide,
        search: Search::Sweep(7, 5),
        recordings: 3,
    };
    let row = table_row(plan, 0..16);
    assert!(row.held >= 12, "{} of {}", row.held, row.of);
    assert!(row.ranges >= 14, "{} of {}", row.ranges, row.of);
    assert!(row.inert <= 2, "{} stated", row.inert);
    // An interval over the whole range would always hold the truth; a useful interval is shorter.
    assert!(row.widths[0] < 0.3, "{} of the range", row.widths[0]);
}

/// An optimizer ends in a crowd of points whose repeats are similar, as are those of one point with many settings. Reality differs
/// from them because of its numerical settings, and must not be rejected therefore. At one false alarm in twenty, more than 3 of 12
/// occur with a probability of 0.2 %.
#[test]
fn a_correct_model_is_not_contradicted_by_points_that_crowd_together() {
    if !common::is_long_run("coverage of twelve searches") {
        return;
    }
    let plan = Plan {
        robot: Robot::Walk,
        search: Search::Tune("cma-es", 100),
        recordings: 10,
    };
    let row = table_row(plan, 0..12);
    assert!(row.contradicted <= 3, "{} contradicted", row.contradicted);
    assert!(row.held >= 18, "{} of {}", row.held, row.of);
}

/// Prints how many frictions of floors are determined: `REALGAP_FIRST` and `REALGAP_STUDIES` choose the seeds, `REALGAP_ROWS` the
/// search, as in `cargo test -p realgap-lab the_table_of_floors -- --ignored --nocapture`.
#[test]
#[ignore = "eight sweeps and eight searches take a quarter of an hour"]
fn the_table_of_floors() {
    let text =
        |name: &str, default: &str| std::env::var(name).unwrap_or_else(|_| default.to_owned());
    let studies: u64 = text("REALGAP_STUDIES", "8").parse().unwrap();
    let first: u64 = text("REALGAP_FIRST", "0").parse().unwrap();
    let only = text("REALGAP_ROWS", "");
    println!("| search | parameter | seeds | determined | of these, intervals that hold |");
    println!("|---|---|---|---|---|");
    for search in [Search::Sweep(9, 9), Search::Tune("cma-es", 100)] {
        let plan = Plan {
            robot: Robot::Floor,
            search,
            recordings: 5,
        };
        if !format!("{plan:?}").contains(&only) {
            continue;
        }
        let seeds = first..first + studies;
        let all: Vec<[ParameterResult; 2]> =
            seeds.clone().map(|seed| study(plan, seed).0).collect();
        for (axis, (name, _)) in Robot::Floor.varied().into_iter().enumerate() {
            let stated = all.iter().filter(|found| found[axis].determined);
            let held = stated.clone().filter(|found| found[axis].interval).count();
            println!(
                "| {search:?} | {name} | {seeds:?} | {} of {studies} | {held} |",
                stated.count()
            );
        }
    }
}

/// Prints the table of docs/validation/intervals.md, which also has the command.
#[test]
#[ignore = "the whole table takes most of an hour"]
fn the_table_of_coverage() {
    let text =
        |name: &str, default: &str| std::env::var(name).unwrap_or_else(|_| default.to_owned());
    let studies: u64 = text("REALGAP_STUDIES", "16").parse().unwrap();
    let first: u64 = text("REALGAP_FIRST", "0").parse().unwrap();
    let only = text("REALGAP_ROWS", "");
    println!(
        "| robot, search | recordings | seeds | intervals (95 %) | ranges | inert, stated | contradicted | median widths |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let searches = [
        Search::Sweep(7, 7),
        Search::Sweep(12, 6),
        Search::Tune("cma-es", 100),
        Search::Tune("nelder-mead", 100),
        Search::Tune("bayesian", 100),
    ];
    let cells = [1, 3, 5, 10].map(|recordings| searches.map(|search| (recordings, search)));
    let cells = cells.as_flattened();
    for (cell, &(recordings, search)) in (0_u64..).zip(cells) {
        // Every cell has its own realities, because with shared ones all cells would have the same errors.
        let first = first * cells.len() as u64 + cell * studies;
        for robot in [Robot::Slide, Robot::Walk] {
            let plan = Plan {
                robot,
                search,
                recordings,
            };
            if format!("{plan:?}").contains(&only) {
                table_row(plan, first..first + studies);
            }
        }
    }
}
