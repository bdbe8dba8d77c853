//! Measures the cost of a robot before it is simulated: its development, the next generation of a search, and its picture.
//!
//! `cargo bench --bench develop`; compare ratios, because absolute times differ between machines.

#![allow(
    clippy::expect_used,
    reason = "settings are sound, and a benchmark has no user to report an error to"
)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use realgap::plot::{Caption, Gallery, draw_gallery};
use realgap::results::portrait::portrait;
use realgap::robot::genome::{Development, Genome};
use realgap::robot::morphology::Morphology;
use realgap::search::{Evaluated, Evolution, Strategy, generator};

fn genomes(modules: usize) -> Vec<Genome> {
    (0..100)
        .map(|seed| Genome::random(modules, &mut generator(seed, 0)).expect("few modules"))
        .collect()
}

fn settings() -> Development {
    Development {
        max_modules: 100,
        ..Development::default()
    }
}

fn develop(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("develop 100 genomes");
    group.throughput(Throughput::Elements(100));
    for modules in [1, 3, 5, 20] {
        let genomes = genomes(modules);
        let settings = settings();
        group.bench_function(BenchmarkId::from_parameter(modules), |b| {
            b.iter(|| {
                let robots = genomes
                    .iter()
                    .filter_map(|g| settings.develop("robot", g).ok());
                robots.count()
            });
        });
    }
    group.finish();

    let evolution = Evolution {
        population: 100,
        generations: 100,
        ..Evolution::default()
    };
    let mut history: Vec<Evaluated> = Vec::new();
    while history.len() < 9000 {
        let proposed = evolution.propose(&history).expect("sound settings");
        history.extend(
            proposed
                .into_iter()
                .enumerate()
                .map(|(index, genome)| Evaluated {
                    genome,
                    fitness: Some(index as f64),
                    descriptors: Vec::new(),
                }),
        );
    }
    criterion.bench_function("propose a generation of 100 after 9000 robots", |b| {
        b.iter(|| evolution.propose(&history));
    });

    let robots: Vec<Morphology> = genomes(5)
        .iter()
        .filter_map(|g| settings().develop("robot", g).ok())
        .take(12)
        .collect();
    let gallery = Gallery {
        gait_s: 2.0,
        caption: Caption::new("twelve robots of five modules", ""),
        columns: 4,
        robots: robots
            .iter()
            .map(|robot| portrait(robot, "a note"))
            .collect(),
    };
    let folder = std::env::temp_dir();
    let mut group = criterion.benchmark_group("draw 12 robots");
    group.sample_size(10);
    for extension in ["png", "svg"] {
        let path = folder.join(format!("realgap_bench_{}.{extension}", std::process::id()));
        group.bench_function(extension, |b| b.iter(|| draw_gallery(&gallery, &path)));
        let _ignored = std::fs::remove_file(path);
    }
    group.finish();
}

criterion_group!(benches, develop);
criterion_main!(benches);
