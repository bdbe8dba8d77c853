//! Compares the shipped search for walking robots with a random search of equal CPU time, and prints the table again.
//!
//! `WALKER_SEEDS=10 cargo test --release -p realgap-lab --test main the_table_of_walkers -- --ignored --nocapture`, with
//! `WALKER_ROBOTS=40` for searches of 40 robots. The finalists of a seed: `realgap search sweeps/best_robot.ron --seed N`.

use std::path::Path;

use realgap_core::file::Source;
use realgap_core::statistics::mann_whitney;
use realgap_lab::search::{Overrides, Search, Variation, generator};
use realgap_optimization::RunOptions;

use crate::common::project;

fn number(name: &str, default: usize) -> usize {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// Seconds that this process has spent in user mode.
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let after_name = stat.rsplit(") ").next().unwrap();
    after_name
        .split(' ')
        .nth(11)
        .unwrap()
        .parse::<f64>()
        .unwrap()
        / 100.0
}

fn search(path: &Path, text: &str, seed: usize) -> Search {
    let overrides = Overrides {
        seed: Some(seed as u64),
        ..Overrides::default()
    };
    Search::parse(&Source::new(path, text.to_owned()), &overrides).unwrap()
}

/// The text without the lines that begin with `begins`.
fn without(text: &str, begins: &str) -> String {
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with(begins));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
#[ignore = "hours of CPU time: the table of docs/validation/search.md"]
fn the_table_of_walkers() {
    let path = project().join("sweeps/best_robot.ron");
    let text = std::fs::read_to_string(&path).unwrap();
    let robots = number("WALKER_ROBOTS", 160);
    let text = text.replace("evaluations: 160", &format!("evaluations: {robots}"));
    let text = text.replace(
        "initial: 60",
        &format!("initial: {}", robots.min(60) / 2 * 2),
    );
    let options = RunOptions {
        jobs: 1,
        ..RunOptions::default()
    };
    let (mut found, mut drawn) = (Vec::new(), Vec::new());
    println!("seed | searched | CPU s | random, as much CPU | robots");
    for seed in number("WALKER_FIRST", 1)..=number("WALKER_SEEDS", 10) {
        let started_s = cpu_s();
        let ours = search(&path, &text, seed);
        let results = ours.run(&options).unwrap();
        let best = results
            .best()
            .and_then(|robot| robot.fitness())
            .unwrap_or(0.0);
        let spent_s = cpu_s() - started_s;
        // The random search has the same evaluation, objective and ranges, and uses random bodies and gaits without tuning the
        // gait.
        let plain = search(&path, &without(&text, "gait:"), seed);
        let (mut best_random, mut count) = (0.0_f64, 0);
        let started_s = cpu_s();
        while cpu_s() - started_s < spent_s {
            let mut rng = generator(seed as u64, (1 << 20) + count as u64);
            let genome = Variation::default().random(&mut rng).unwrap();
            let fitness = plain.evaluate(count, &genome).unwrap().fitness();
            best_random = best_random.max(fitness.unwrap_or(0.0));
            count += 1;
        }
        println!("{seed} | {best:.3} m | {spent_s:.0} | {best_random:.3} m | {count}");
        found.push(best);
        drawn.push(best_random);
    }
    let test = mann_whitney(&found, &drawn).unwrap();
    println!(
        "Mann-Whitney U = {}, p = {:.2e}",
        test.statistic, test.p_value
    );
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    assert!(
        mean(&found) > mean(&drawn) && test.p_value < 0.05,
        "{found:?} {drawn:?}"
    );
}
