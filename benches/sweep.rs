//! Measures the cost of a small sweep on one thread and on two; their ratio gives the parallel efficiency.
//!
//! `cargo bench --bench sweep`; at an efficiency of 1, the sweep takes half the time on two idle cores.

#![allow(
    clippy::expect_used,
    reason = "shipped files are sound, and a benchmark has no user to report an error to"
)]

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use realgap::calibration::{Mode, Overrides, Study};
use realgap::optimization::RunOptions;

fn sweeps(criterion: &mut Criterion) {
    let overrides = Overrides {
        points: Some(5),
        ..Overrides::default()
    };
    let path = format!("{}/sweeps/tripod_self.ron", env!("CARGO_MANIFEST_DIR"));
    let study = Study::read(path, &overrides).expect("a shipped study is sound");
    let mut group = criterion.benchmark_group("sweep of 25 points, 20 s each");
    group.sample_size(10);
    for jobs in [1, 2] {
        group.bench_function(BenchmarkId::new("threads", jobs), |b| {
            b.iter(|| {
                let folder = tempfile::tempdir().expect("a temporary folder");
                let run = RunOptions {
                    jobs,
                    ..RunOptions::default()
                };
                study
                    .sweep_into(folder.path(), Mode::Start, &run)
                    .expect("a sound sweep")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
