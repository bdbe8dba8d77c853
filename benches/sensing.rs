//! Measures the cost of beams, of runs of a two-wheel robot, and of a sensorgraph.
//!
//! `cargo bench --bench sensing`; compare ratios, because absolute times differ between machines.

#![allow(
    clippy::expect_used,
    reason = "settings are sound, and a benchmark has no user to report an error to"
)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use realgap::file::Source;
use realgap::random::Numbered;
use realgap::robot::morphology::Morphology;
use realgap::sensing::arena::Arena;
use realgap::sensing::graph::regression::{Stop, count, estimate, monomial, monomials, order};
use realgap::simulation::{Experiment, Noise, Vehicle, run};

/// A hundred walls in a field of 10 × 10 m.
fn arena() -> Arena {
    let wall = |k: usize| {
        let (x, y) = ((k * 37 % 100) as f64 / 10.0, (k * 61 % 100) as f64 / 10.0);
        let (dx, dy) = ((k as f64).cos(), (k as f64).sin());
        format!(
            "(from_m: ({x:?}, {y:?}), to_m: ({:?}, {:?}))",
            x + dx,
            y + dy
        )
    };
    let walls: Vec<String> = (0..100).map(wall).collect();
    let text = format!(
        "(name: \"walls\", size_m: (10.0, 10.0), boundary: Open, walls: [{}])",
        walls.join(", ")
    );
    Arena::parse(&Source::new("walls.ron", text)).expect("sound walls")
}

fn beams(criterion: &mut Criterion) {
    let arena = arena();
    let mut group = criterion.benchmark_group("arena of 100 walls");
    group.sample_size(10);
    group.throughput(Throughput::Elements(1_000_000));
    group.bench_function("a million beams", |b| {
        b.iter(|| {
            let cast = |k: u32| {
                let k = f64::from(k);
                arena.cast(
                    [(0.37 * k).rem_euclid(10.0), (0.61 * k).rem_euclid(10.0)],
                    k,
                )
            };
            (0..1_000_000)
                .filter_map(cast)
                .map(|hit| hit.distance_m)
                .sum::<f64>()
        });
    });
    group.finish();
}

fn runs(criterion: &mut Criterion) {
    let vehicle = Vehicle::read("vehicles/two_wheel.ron", None).expect("a shipped vehicle");
    let cube = Morphology::read("morphologies/cube.ron").expect("a shipped robot");
    let mut experiment = Experiment::new(cube.assemble());
    experiment.drive = vehicle.drive;
    experiment.vehicle = Some(Arc::new(vehicle));
    experiment.duration_s = 5.0;
    let mut group = criterion.benchmark_group("two wheels");
    group.sample_size(10);
    group.bench_function("1000 runs of 5 s", |b| {
        b.iter(|| {
            for repeat in 0..1000 {
                let drawn = Noise::default().perturb(&experiment, 1, repeat);
                black_box(run(&drawn).expect("a sound run"));
            }
        });
    });
    group.finish();
}

fn polynomials(criterion: &mut Criterion) {
    let mut rng = Numbered::SensorReading.generator(1, 0);
    let powers = monomials(4);
    let places: Vec<[f64; 2]> = (0..1400)
        .map(|_| [0; 2].map(|_| 2.0 * rng.random::<f64>() - 1.0))
        .collect();
    let regressors = DMatrix::from_fn(1400, powers.len(), |row, term| {
        monomial(powers[term], places[row])
    });
    let ranges = DVector::from_fn(1400, |_, _| 3.0 + rng.random::<f64>());
    let mut group = criterion.benchmark_group("forward regression");
    group.sample_size(10);
    group.bench_function("72 models of 15 terms from 1400 samples", |b| {
        b.iter(|| {
            for _ in 0..72 {
                let mut chosen = order(&regressors, &ranges, 15).expect("enough samples");
                chosen.truncate(count(Stop::Bic, &chosen, &ranges));
                black_box(estimate(&regressors, &ranges, &chosen).expect("independent terms"));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, beams, runs, polynomials);
criterion_main!(benches);
