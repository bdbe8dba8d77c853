//! Measures the cost of merging the shards of a plan, which should be linear in the number of rows and need little memory.
//!
//! Every size is measured once, because the time for a million rows is long compared with its noise; `cargo bench --bench merge`.
#![allow(clippy::unwrap_used)]
#![allow(clippy::print_stdout, reason = "it is a table for people")]

use std::path::Path;
use std::time::Instant;

use realgap::store::{CaseOutcome, CaseResult, CaseRow, Fingerprint, Merger, Store, Trial};

const SHARDS: usize = 10;
const AT_ONCE: usize = 10_000;

fn trial(index: usize) -> Trial {
    let number = (index as f64).sin();
    Trial {
        index,
        values: vec![number, 1.0 - number],
        cases: vec![CaseRow {
            steps: 4800,
            outcome: CaseOutcome::Completed(CaseResult {
                net_displacement_m: number,
                scores: vec![number; 10],
                path_xy_m: Vec::new(),
            }),
        }],
    }
}

/// Writes the shards of a run and returns the time that this took, seconds.
fn make(folder: &Path, print: &Fingerprint, rows: usize) -> f64 {
    let begun = Instant::now();
    for shard in 0..SHARDS {
        let mut store = Store::create(&folder.join(shard.to_string()), print).unwrap();
        let own: Vec<usize> = (shard..rows).step_by(SHARDS).collect();
        for some in own.chunks(AT_ONCE) {
            let trials: Vec<Trial> = some.iter().map(|index| trial(*index)).collect();
            store.insert(&trials).unwrap();
        }
        store.complete().unwrap();
    }
    begun.elapsed().as_secs_f64()
}

/// Largest resident memory of this process so far, megabytes; `None` if the system does not report it.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1e3)
}

fn main() {
    // `cargo test --benches` calls this program with `--test`, and then nothing is measured.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let print = Fingerprint::new().with("bench", "merge");
    println!("   rows  write shards, s  merge, s  rows/s of the merge  memory so far, MB");
    for rows in [10_000, 100_000, 1_000_000] {
        let folder = tempfile::tempdir().unwrap();
        let write_s = make(folder.path(), &print, rows);
        let begun = Instant::now();
        let mut merger: Merger = Merger::open(&folder.path().join("whole"), &print).unwrap();
        for shard in 0..SHARDS {
            merger
                .absorb(&folder.path().join(shard.to_string()))
                .unwrap();
        }
        assert_eq!(merger.rows(), rows);
        drop(merger);
        let merge_s = begun.elapsed().as_secs_f64();
        let memory = peak_mb().map_or("-".to_owned(), |mb| format!("{mb:.0}"));
        println!(
            "{rows:>7}  {write_s:>15.2}  {merge_s:>8.2}  {:>19.0}  {memory:>17}",
            rows as f64 / merge_s
        );
    }
}
