//! Measures how fast recordings are read, with every check and doubt. `tools/reading_pairs.py` reads the same files with evo and pandas.
#![allow(clippy::unwrap_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use realgap::trajectory::{Reading, read};
use std::fmt::Write as _;

/// The samples of one file.
const ROWS: usize = 100_000;

/// A winding path as lines of eight numbers with six decimals.
fn table(separator: char) -> String {
    let mut text = String::new();
    for row in 0..ROWS {
        let t_s = row as f64 * 0.01;
        let half_rad = (t_s / 50.0).sin() / 2.0;
        let (x_m, y_m) = ((0.3 * t_s).sin() + 0.01 * t_s, (0.7 * t_s).cos());
        let values = [
            t_s,
            x_m,
            y_m,
            0.1 + 1e-4 * t_s.sin(),
            0.0,
            0.0,
            half_rad.sin(),
            half_rad.cos(),
        ];
        for (column, value) in values.iter().enumerate() {
            if column > 0 {
                text.push(separator);
            }
            write!(text, "{value:.6}").unwrap();
        }
        text.push('\n');
    }
    text
}

fn reading(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    let mut group = criterion.benchmark_group("read 100,000 poses");
    group.sample_size(20);
    for (name, separator, header) in [
        ("path.tum", ' ', ""),
        ("path.csv", ',', "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n"),
    ] {
        let path = folder.path().join(name);
        let text = format!("{header}{}", table(separator));
        std::fs::write(&path, &text).unwrap();
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function(name, |b| {
            b.iter(|| read(&path, Reading::default()).unwrap());
        });
        // The part that no reader can avoid: numbers from text, with the parser of the standard library.
        group.bench_function(format!("{name}, numbers alone"), |b| {
            b.iter(|| {
                let lines = text.lines().skip(usize::from(!header.is_empty()));
                let cells = lines.flat_map(|line| line.split(separator));
                cells
                    .map(|cell| cell.parse::<f64>().unwrap())
                    .collect::<Vec<f64>>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
