//! Measures the cost of storing a trial, which must stay far below the cost of simulating one.
#![allow(clippy::unwrap_used)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use realgap::store::{CaseOutcome, CaseResult, CaseRow, Fingerprint, Store, Trial, TrialScore};

/// A trial with the prepared path of a walk and scores against ten recordings.
fn trial(index: usize) -> Trial {
    Trial {
        index,
        values: vec![0.3, 0.4],
        cases: vec![CaseRow {
            steps: 4800,
            outcome: CaseOutcome::Completed(CaseResult {
                net_displacement_m: 0.6,
                scores: vec![0.01; 10],
                path_xy_m: vec![[0.1, 0.2]; 182],
            }),
        }],
    }
}

fn keep(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let mut store = Store::create(folder.path(), &Fingerprint::new()).unwrap();
    let mut next = 0;
    criterion.bench_function(
        "store/one trial and its score, a transaction each",
        |bencher| {
            bencher.iter_batched(
                || {
                    next += 1;
                    let score = TrialScore {
                        index: next,
                        score: Some(0.01),
                        displacement_error_m: Some(0.02),
                        recordings: vec![0.01; 10],
                    };
                    (trial(next), score)
                },
                |(trial, score)| {
                    store.insert(&[trial]).unwrap();
                    store.insert_scores(&[score]).unwrap();
                },
                BatchSize::PerIteration,
            );
        },
    );
    criterion.bench_function("store/read 441 trials", |bencher| {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::create(folder.path(), &Fingerprint::new()).unwrap();
        let trials: Vec<Trial> = (0..441).map(trial).collect();
        store.insert(&trials).unwrap();
        bencher.iter(|| store.trials().unwrap());
    });
}

criterion_group!(benches, keep);
criterion_main!(benches);
