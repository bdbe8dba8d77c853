//! Measures the cost of preparing and comparing trajectories: every metric on two trajectories, and the basis of a whole sweep.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{UnitQuaternion, Vector3};
use realgap::comparison::{Basis, Components, Context, METRICS, Pair};
use realgap::trajectory::{POINTS, Prepared, Trajectory, prepare};
use std::hint::black_box;

/// A winding path of `points` samples, different for every `seed`.
fn path(seed: usize, points: usize) -> Trajectory {
    let s = seed as f64;
    let at = |index: usize| 20.0 * index as f64 / (points - 1) as f64;
    let positions = (0..points)
        .map(|index| {
            let t = at(index);
            Vector3::new(
                0.05 * t * (1.0 + 0.1 * (s * 0.37).sin()) + 0.02 * (3.0 * t + s).sin(),
                0.03 * ((1.0 + 0.01 * s) * t).sin() + 0.01 * (7.3 * t * (s * 0.11).cos()).cos(),
                0.05 + 0.005 * (5.0 * t).sin(),
            )
        })
        .collect();
    let turns = (0..points)
        .map(|index| {
            UnitQuaternion::from_euler_angles(0.1 * (at(index) + s).sin(), 0.05, 0.2 * at(index))
        })
        .collect();
    Trajectory::new((0..points).map(at).collect(), positions)
        .and_then(|trajectory| trajectory.with_orientations(turns))
        .expect("a valid path")
}

fn compare(criterion: &mut Criterion) {
    let (real, simulated) = (path(0, POINTS), path(1, POINTS));
    criterion.bench_function("prepare 182 samples", |b| {
        b.iter(|| prepare(black_box(&real)));
    });
    let long = path(3, 4800);
    criterion.bench_function("prepare 4800 samples", |b| {
        b.iter(|| prepare(black_box(&long)));
    });
    let all: Vec<Prepared> = (0..451)
        .map(|seed| prepare(&path(seed, POINTS)).expect("a path that can be prepared"))
        .collect();
    let all: Vec<&Prepared> = all.iter().collect();
    let basis = Basis::fit(&all, Components::default()).expect("a basis");
    let pair = Pair::new((&real, all[0]), (&simulated, all[1]));
    let context = Context {
        spread: None,
        channels: None,
        basis: Some(&basis),
        body_length_m: Some(0.1),
    };
    criterion.bench_function("all metrics, two trajectories of 182 points", |b| {
        b.iter(|| {
            for metric in METRICS {
                let _score = black_box(metric.compare(black_box(&pair), &context));
            }
        });
    });
    for metric in METRICS {
        criterion.bench_function(metric.name(), |b| {
            b.iter(|| metric.compare(black_box(&pair), &context));
        });
    }
    let mut slow = criterion.benchmark_group("basis");
    slow.sample_size(10);
    slow.bench_function("451 trajectories", |b| {
        b.iter(|| Basis::fit(black_box(&all), Components::default()));
    });
    slow.finish();
}

criterion_group!(benches, compare);
criterion_main!(benches);
