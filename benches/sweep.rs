//! Cost of a small sweep, on one thread and on two: the ratio is the parallel efficiency.
//!
//! `cargo bench --bench sweep`; an efficiency of 1 is half the time on two idle cores.

#![allow(
    clippy::expect_used,
    reason = "shipped files are sound, and a bench has nobody to report to"
)]

use std::sync::atomic::AtomicBool;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use realgap::calibration::{Definition, Mode, Overrides, Study, sweep};

fn sweeps(criterion: &mut Criterion) {
    let overrides = Overrides {
        points: Some(5),
        ..Overrides::default()
    };
    let path = format!("{}/sweeps/tripod_self.ron", env!("CARGO_MANIFEST_DIR"));
    let definition = Definition::read(path, &overrides).expect("a shipped study is sound");
    let study = Study::new(definition).expect("a shipped study is sound");
    let never = AtomicBool::new(false);
    let mut group = criterion.benchmark_group("sweep of 25 points, 20 s each");
    group.sample_size(10);
    for jobs in [1, 2] {
        group.bench_function(BenchmarkId::new("threads", jobs), |b| {
            b.iter(|| {
                let folder = tempfile::tempdir().expect("a temporary folder");
                sweep(&study, folder.path(), Mode::Start, jobs, &never, |_| ())
                    .expect("a sound sweep")
            });
        });
    }
    group.finish();
}

criterion_group!(benches, sweeps);
criterion_main!(benches);
