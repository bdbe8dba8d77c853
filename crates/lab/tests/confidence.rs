//! Confidence over time, tests of equal distribution and intervals have their nominal error rates, and detect known differences.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
#![allow(clippy::print_stdout, reason = "a table is printed")]

use crate::common;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use rayon::prelude::*;
use realgap_core::statistics::{PERMUTATIONS, energy_test};
use realgap_lab::prediction::ensemble;
use realgap_lab::prediction::gap::{CaseRuns, Confidence, Sample, Scoring, distances, noise_floor};
use realgap_path::comparison::{Components, by_name};
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Morphology;
use realgap_simulation::parameter::by_name as parameter;
use realgap_simulation::{Camera, Distribution, Experiment, Noise, Sampling};

const BODY_M: f64 = 0.06;

fn scoring(metrics: &[&str]) -> Scoring {
    Scoring {
        metrics: metrics.iter().map(|name| by_name(name).unwrap()).collect(),
        components: Components::default(),
        body_length_m: Some(BODY_M),
        channels: None,
        seed: 1,
    }
}

fn one_case(real: &[Sample], repeats: Vec<Sample>) -> Vec<CaseRuns> {
    vec![CaseRuns {
        recordings: (0..real.len()).collect(),
        ideal: None,
        repeats,
    }]
}

/// A run of the tripod for two seconds, with cheap contact settings, because these tests are about statistics and not about
/// physics.
fn walk(friction: f64) -> Experiment {
    let robot = Morphology::read(common::project().join("morphologies/tripod.ron")).unwrap();
    let mut walk = Experiment::new(robot.assemble());
    walk.duration_s = 2.0;
    walk.sampling = Sampling::Rate(30.0);
    walk.floor.friction = friction;
    for (name, value) in [
        ("timestep_s", 1.0 / 240.0),
        ("solver.substeps", 4.0),
        ("solver.sweeps", 1.0),
        ("solver.joint", 0.0),
        ("contact.natural_frequency_hz", 60.0),
    ] {
        walk = parameter(name).unwrap().apply(&walk, value).unwrap();
    }
    walk
}

fn repeats(experiment: &Experiment, noise: &Noise, seed: u64, count: u64) -> Vec<Sample> {
    (0..count)
        .into_par_iter()
        .map(|number| {
            let run = ensemble::repeat(experiment, noise, seed, number).unwrap();
            Sample::new("run", run.outcome.completed().unwrap()).unwrap()
        })
        .collect()
}

fn seen_by_a_camera() -> Noise {
    Noise {
        camera: Camera {
            position_m: Distribution::Normal(1e-3),
            angle_rad: Distribution::Normal(5e-3),
            time_s: Distribution::Normal(2e-3),
        },
        ..Noise::careful_repeat()
    }
}

#[test]
fn the_confidence_drops_significantly_with_a_wrong_floor_and_not_with_the_true_model() {
    let noise = seen_by_a_camera();
    let reality: Vec<Vec<Sample>> = (100..105)
        .map(|seed| repeats(&walk(0.45), &noise, seed, 10))
        .collect();
    let confidences = |friction: f64, noise: &Noise| -> Vec<Confidence> {
        let simulated = repeats(&walk(friction), noise, 1, 60);
        let of = |real: &Vec<Sample>| {
            let cases = one_case(real, simulated.clone());
            Confidence::new(real, &cases, BODY_M).unwrap().unwrap()
        };
        reality.iter().map(of).collect()
    };
    let truth = confidences(0.45, &noise);
    for confidence in &truth {
        assert_eq!(confidence.surely_below_half_s, None, "{confidence:?}");
    }
    let over_time: f64 = truth.iter().map(|c| c.over_time).sum::<f64>() / truth.len() as f64;
    assert!((over_time - 0.9).abs() < 0.06, "{over_time}");
    for confidence in confidences(0.1, &noise) {
        assert!(confidence.surely_below_half_s.is_some(), "{confidence:?}");
    }
    // The camera has to be a part of the noise: without measurement noise, simulated repeats are nearer to each other at the
    // beginning than recordings are, so that the true model would be rejected, too.
    let without_camera = confidences(0.45, &noise.without_camera());
    assert!(
        without_camera
            .iter()
            .all(|c| c.surely_below_half_s.is_some()),
        "{without_camera:?}"
    );
}

#[test]
fn a_camera_changes_the_recording_and_not_the_motion() {
    let (blind, seen) = (Noise::careful_repeat(), seen_by_a_camera());
    let base = walk(0.45);
    assert_eq!(blind.perturb(&base, 3, 1), seen.perturb(&base, 3, 1));
    let motion = |noise: &Noise| {
        let run = ensemble::repeat(&base, noise, 3, 1).unwrap();
        run.outcome.completed().unwrap()
    };
    let (truth, recorded) = (motion(&blind), motion(&seen));
    assert_eq!(truth.times_s(), recorded.times_s());
    let errors = |recorded: &Trajectory| -> Vec<Vector3<f64>> {
        let pairs = recorded.positions_world_m().iter();
        pairs
            .zip(truth.positions_world_m())
            .map(|(a, b)| a - b)
            .collect()
    };
    let worst = |errors: &[Vector3<f64>]| errors.iter().fold(0.0_f64, |w, e| w.max(e.norm()));
    let found = worst(&errors(&recorded));
    assert!((1e-3..2e-2).contains(&found), "{found}");
    // Errors of position and of time add up: position errors do not depend on the clock, and a late sample adds the distance
    // that the robot has moved by then.
    let only = |camera: Camera| {
        motion(&Noise {
            camera,
            ..Noise::careful_repeat()
        })
    };
    let position = Camera {
        time_s: Distribution::default(),
        ..seen.camera
    };
    let time = Camera {
        time_s: seen.camera.time_s,
        ..Camera::default()
    };
    let (by_position, by_time) = (errors(&only(position)), errors(&only(time)));
    assert!(worst(&by_time) > 1e-4, "{by_time:?}");
    let both = errors(&recorded);
    for ((a, b), sum) in by_position.iter().zip(&by_time).zip(&both) {
        assert!((a + b - sum).norm() < 1e-12);
    }
}

/// One line of the golden file: points row by row.
struct Golden {
    x: Vec<Vec<f64>>,
    y: Vec<Vec<f64>>,
    distance: f64,
    ratio: f64,
    p_value: f64,
}

fn golden() -> Vec<Golden> {
    let text = common::read(&common::golden(), "energy.csv");
    text.lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let dimensions: usize = cells[0].parse().unwrap();
            let points = |cell: &str| -> Vec<Vec<f64>> {
                let numbers: Vec<f64> = cell.split(' ').map(|w| w.parse().unwrap()).collect();
                numbers.chunks(dimensions).map(<[f64]>::to_vec).collect()
            };
            let number = |index: usize| cells[index].parse().unwrap();
            Golden {
                x: points(cells[1]),
                y: points(cells[2]),
                distance: number(3),
                ratio: number(4),
                p_value: number(5),
            }
        })
        .collect()
}

fn pair_distances(points: &[Vec<f64>]) -> Vec<f64> {
    let euclid = |a: &[f64], b: &[f64]| -> f64 {
        let squares = a.iter().zip(b).map(|(p, q)| (p - q).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let pairs = (0..points.len()).flat_map(|i| (i + 1..points.len()).map(move |j| (i, j)));
    pairs.map(|(i, j)| euclid(&points[i], &points[j])).collect()
}

/// The golden file is made by tools/golden_energy.py with scipy and numpy; its p values count all permutations.
#[test]
fn the_energy_test_agrees_with_scipy_and_its_p_value_with_the_exact_one() {
    let lines = golden();
    assert!(lines.len() >= 5);
    for line in lines {
        let points = [line.x.clone(), line.y].concat();
        let found = energy_test(&pair_distances(&points), line.x.len(), 1).unwrap();
        assert!((found.distance - line.distance).abs() < 1e-9, "{found:?}");
        assert!(
            (found.ratio.unwrap() - line.ratio).abs() < 1e-9,
            "{found:?}"
        );
        // Four standard errors of the share of random permutations, and 1e-3 for the observed arrangement, which is counted, too.
        let p = line.p_value;
        let slack = 4.0 * (p * (1.0 - p) / PERMUTATIONS as f64).sqrt() + 1e-3;
        assert!((found.p_value - p).abs() < slack, "{found:?} {p}");
    }
}

/// `count` normal points in a plane.
fn cloud(rng: &mut ChaCha8Rng, count: usize, spread: f64) -> Vec<Vec<f64>> {
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    (0..count)
        .map(|_| vec![spread * normal(), spread * normal()])
        .collect()
}

#[test]
fn p_values_are_uniform_where_both_samples_have_one_distribution() {
    let studies = 300;
    let mut p_values: Vec<f64> = (0..studies)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let points = cloud(&mut rng, 30, 1.0);
            energy_test(&pair_distances(&points), 8, seed)
                .unwrap()
                .p_value
        })
        .collect();
    p_values.sort_by(f64::total_cmp);
    // Kolmogorov's distance from uniform: 1.63 / √n is exceeded once in a hundred times.
    let worst = p_values.iter().enumerate().fold(0.0_f64, |worst, (k, p)| {
        let [below, above] = [k, k + 1].map(|k| k as f64 / studies as f64);
        worst.max((p - below).abs()).max((p - above).abs())
    });
    assert!(worst < 1.63 / (studies as f64).sqrt(), "{worst}");
}

/// A path along x that ends at `far_m`, swung sideways by `bend_m` in its middle.
fn path(far_m: f64, bend_m: f64) -> Sample {
    let times: Vec<f64> = (0..182).map(|i| f64::from(i) * 0.1).collect();
    let positions = (0..182)
        .map(|i| {
            let share = f64::from(i) / 181.0;
            let side = bend_m * (std::f64::consts::PI * share).sin();
            Vector3::new(far_m * share, side, 0.0)
        })
        .collect();
    Sample::new("path", Trajectory::new(times, positions).unwrap()).unwrap()
}

#[test]
fn repeats_with_too_little_spread_have_ratio_1_and_are_still_found_to_differ() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut spread = |count: usize, far_m: f64, sd_m: f64| -> Vec<Sample> {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        (0..count)
            .map(|_| path(far_m + sd_m * normal(), sd_m * normal()))
            .collect()
    };
    let real = spread(15, 1.0, 0.05);
    // All repeats are nearly the same, and they have an offset by which they are as far from the recordings as the recordings are
    // from each other.
    let cases = one_case(&real, spread(60, 1.04, 0.005));
    let found = distances(&real, &cases, &scoring(&["rms"])).unwrap();
    let row = found.metrics[0];
    let ratio = row.repeats.unwrap().ratio.unwrap();
    assert!(
        ratio.low.unwrap() < 1.0 && 1.0 < ratio.high.unwrap(),
        "{ratio:?}"
    );
    let alike = row.alike.unwrap();
    assert!(
        alike.p_value < 0.01 && alike.ratio.unwrap() > 1.1,
        "{alike:?}"
    );
    // Where both have the same distribution, the test finds no difference.
    let cases = one_case(&real, spread(60, 1.0, 0.05));
    let found = distances(&real, &cases, &scoring(&["rms"])).unwrap();
    assert!(found.metrics[0].alike.unwrap().p_value > 0.05);
}

/// How the recordings of a study of the noise floor are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Drawn {
    /// Only the length varies, with a normal distribution: one dimension.
    Length,
    /// The length, the bend and six finer wiggles of the path are normal, each smaller than the one before.
    Path,
    /// Like `Path`, but one run in ten deviates four times as far.
    Outliers,
}

/// Number of wiggles of a drawn path, its length among them.
const WIGGLES: usize = 8;

fn drawn_paths(kind: Drawn, rng: &mut ChaCha8Rng, count: usize) -> Vec<Sample> {
    (0..count)
        .map(|_| {
            let far_off = kind == Drawn::Outliers && rng.random_range(0..10) == 0;
            let scale = if far_off { 0.04 } else { 0.01 };
            let sizes: [f64; WIGGLES] = std::array::from_fn(|k| {
                let normal: f64 = StandardNormal.sample(rng);
                match (kind, k) {
                    (Drawn::Length, 1..) => 0.0,
                    _ => scale * normal / (k + 1) as f64,
                }
            });
            let times: Vec<f64> = (0..60).map(|i| f64::from(i) * 0.1).collect();
            let positions = times.iter().map(|t| {
                let share = t / 5.9;
                let side: f64 = (1..WIGGLES)
                    .map(|k| sizes[k] * (std::f64::consts::PI * k as f64 * share).sin())
                    .sum();
                Vector3::new((1.0 + sizes[0]) * share, side, 0.0)
            });
            let positions = positions.collect();
            Sample::new("drawn", Trajectory::new(times, positions).unwrap()).unwrap()
        })
        .collect()
}

/// The share of 95 % intervals of the noise floor that hold the true floor, and the median ratio of their upper to their lower end.
fn floor_coverage(kind: Drawn, recordings: usize, studies: u64) -> (f64, f64) {
    let metric = if kind == Drawn::Length {
        "displacement"
    } else {
        "rms"
    };
    let scoring = scoring(&[metric]);
    let floor_of = |runs: &[Sample]| noise_floor(runs, &scoring).unwrap().metrics[0].floor;
    // The true floor is the mean over 40 sets of 100 runs each.
    let sets: Vec<f64> = (0..40)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(1_000_000 + seed);
            floor_of(&drawn_paths(kind, &mut rng, 100)).value
        })
        .collect();
    let truth = sets.iter().sum::<f64>() / sets.len() as f64;
    let found: Vec<(bool, f64)> = (0..studies)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let floor = floor_of(&drawn_paths(kind, &mut rng, recordings));
            let (low, high) = (floor.low.unwrap(), floor.high.unwrap());
            ((low..=high).contains(&truth), high / low)
        })
        .collect();
    let covered = found.iter().filter(|(holds, _)| *holds).count();
    let mut widths: Vec<f64> = found.iter().map(|(_, width)| *width).collect();
    widths.sort_by(f64::total_cmp);
    (covered as f64 / studies as f64, widths[widths.len() / 2])
}

#[test]
fn the_interval_of_a_noise_floor_of_few_recordings_has_its_nominal_coverage() {
    for recordings in [3, 5, 10] {
        let (covered, _) = floor_coverage(Drawn::Path, recordings, 1000);
        // The standard error of the share is 0.7 %.
        assert!((0.93..=0.97).contains(&covered), "{recordings}: {covered}");
    }
}

/// The table of docs/validation/gap.md.
#[test]
#[ignore = "a minute"]
fn the_table_of_noise_floor_intervals() {
    println!("| recordings | drawn | covered | upper over lower end, median |");
    for kind in [Drawn::Path, Drawn::Length, Drawn::Outliers] {
        for recordings in [3, 5, 10, 20] {
            let (covered, width) = floor_coverage(kind, recordings, 4000);
            println!(
                "| {recordings} | {kind:?} | {:.1} % | {width:.1} |",
                100.0 * covered
            );
        }
    }
}
