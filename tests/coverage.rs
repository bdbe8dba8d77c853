//! Are the intervals honest? Many small studies with a truth that we know.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "the numbers in docs/fidelity.md")]

mod common;

use std::path::Path;

use realgap::calibration::{INTERVAL_LEVEL, Overrides, Study, TuneOptions};
use realgap::optimization::{RunOptions, optimizer_by_name};
use realgap::robot::morphology::Morphology;
use realgap::simulation::{Camera, Experiment, JointKind, Noise, Solver, run};
use realgap::trajectory::write;

const STUDIES: u64 = 60;
const RECORDINGS: u64 = 6;
const DURATION_S: f64 = 2.0;

/// Repeats of a run on a hidden floor: put down by hand, with servos of one make, seen by a camera.
fn record(folder: &Path, friction: f64, seed: u64) {
    let robot = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    let mut truth = Experiment::new(robot.assemble());
    truth.duration_s = DURATION_S;
    truth.floor.friction = friction;
    // As common::STANDIN_NUMERICS: the question is one of statistics, and these are cheap.
    truth.solver = Solver {
        timestep_s: 1.0 / 240.0,
        substeps: 8,
        sweeps: 1,
        joint: JointKind::Impulse,
        ..Solver::default()
    };
    truth.contact.natural_frequency_hz = 60.0;
    truth.contact.damping_ratio = 10.0;
    let noise = Noise::careful_repeat();
    let camera = Camera {
        position_m: 1e-3,
        orientation_rad: 0.0,
    };
    for repeat in 0..RECORDINGS {
        let run = run(&noise.perturb(&truth, seed, repeat)).unwrap();
        let seen = camera
            .record(&run.outcome.completed().unwrap(), seed, repeat)
            .unwrap();
        write(folder.join(format!("run_{repeat}.csv")), &seen).unwrap();
    }
}

/// How the points of a study are chosen.
#[derive(Clone, Copy)]
enum Search {
    Sweep,
    Tune(&'static str),
}

/// Whether the interval of one study holds its truth.
fn covers(seed: u64, search: Search) -> bool {
    let folder = tempfile::tempdir().unwrap();
    // Truths spread evenly over the range, on and between the points of the grid.
    let friction = 0.15 + 0.7 * (seed as f64 * 0.618_033_988_749_895).fract();
    record(folder.path(), friction, seed);
    let path = common::study(
        folder.path(),
        &format!(
            "morphology: \"{}/morphologies/tripod.ron\",
    recordings: [\"run_*.csv\"],
    start: Settled,
    parameters: [(name: \"floor.friction\", from: 0.05, to: 0.95, points: 19)],
    metric: \"rms\",
    seed: {seed},
    {}",
            common::project().display(),
            common::STANDIN_NUMERICS
        ),
    );
    let study = Study::read(path, &Overrides::default()).unwrap();
    let answer = match search {
        Search::Sweep => study.sweep(&RunOptions::default()).unwrap(),
        Search::Tune(optimizer) => {
            let options = TuneOptions {
                optimizer: optimizer_by_name(optimizer).unwrap(),
                budget: 24,
                patience: None,
            };
            study.tune(&options, &RunOptions::default()).unwrap()
        }
    };
    let (low, high) = answer.draws.unwrap().interval(0, INTERVAL_LEVEL);
    low <= friction && friction <= high
}

fn check(what: &str, search: Search) {
    let covered = (0..STUDIES).filter(|seed| covers(*seed, search)).count();
    let share = covered as f64 / STUDIES as f64;
    println!("90 % intervals of {what}: {covered} of {STUDIES} hold the truth");
    assert!((0.85..=0.95).contains(&share), "{covered} of {STUDIES}");
}

#[test]
fn a_ninety_percent_interval_of_a_sweep_covers_the_truth_in_about_ninety_percent_of_studies() {
    check("sweeps", Search::Sweep);
}

#[test]
fn so_does_the_interval_of_an_optimizer() {
    check("cma-es", Search::Tune("cma-es"));
}
