//! Measures how many simulations each optimizer needs to reach the set of points of a grid that are indistinguishable from the best.
//!
//! ```sh
//! cargo run --release --example optimizer_race -- sweeps/tripod_floor.ron 5
//! cargo run --release --example optimizer_race -- sweeps/cube_toss.ron 3 'real_trajectories/cube_tosses/*.csv' 40
//! ```
//!
//! Arguments: study, number of seeds, glob of recordings ("" for the study's own), number of recordings, names of optimizers (by
//! default all). A sweep determines which points of its grid are indistinguishable from the best; an optimizer has reached the set
//! with the first point whose nearest point of the grid belongs to it.

#![allow(clippy::print_stdout)]

use std::path::Path;

use realgap::calibration::{Answer, Overrides, Study, TuneOptions};
use realgap::optimization::{Grid, OPTIMIZERS, RunOptions};
use realgap::{Error, Result};

const BUDGET: usize = 100;

fn overrides(seed: u64, arguments: &[String]) -> Overrides {
    Overrides {
        recordings: arguments
            .get(3)
            .filter(|glob| !glob.is_empty())
            .cloned()
            .into_iter()
            .collect(),
        limit_recordings: arguments.get(4).and_then(|text| text.parse().ok()),
        seed: Some(seed),
        ..Overrides::default()
    }
}

fn cell(grid: &Grid, values: &[f64]) -> usize {
    grid.index(&grid.nearest(values))
}

/// Cells of the grid that are indistinguishable from the best.
fn target(grid: &Grid, answer: &Answer) -> Vec<bool> {
    let mut cells = vec![false; grid.len()];
    if let Some(uncertainty) = &answer.uncertainty {
        for (point, inside) in answer
            .scores
            .points
            .iter()
            .zip(&uncertainty.indistinguishable)
        {
            cells[cell(grid, &point.values)] = *inside;
        }
    }
    cells
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().collect();
    let usage = || Error::usage("usage: optimizer_race STUDY SEEDS [GLOB [RECORDINGS]]");
    let path = Path::new(arguments.get(1).ok_or_else(usage)?);
    let seeds: u64 = arguments
        .get(2)
        .and_then(|n| n.parse().ok())
        .ok_or_else(usage)?;
    let study = Study::read(path, &overrides(1, &arguments))?;
    let whole = study.sweep(&RunOptions::default())?;
    let grid = &study.definition().grid;
    let cells = target(grid, &whole);
    let count = cells.iter().filter(|inside| **inside).count();
    println!(
        "{}: {count} of {} points of the grid are indistinguishable from its best",
        path.display(),
        grid.len()
    );
    println!(
        "{:<15} points until the set is reached and best score after {BUDGET}, by seed 1 to {seeds}",
        "optimizer"
    );
    let named = arguments.get(5..).unwrap_or_default();
    let wanted = |name: &str| named.is_empty() || named.iter().any(|n| n == name);
    for optimizer in OPTIMIZERS.iter().filter(|o| wanted(o.name())) {
        let mut arrivals = Vec::new();
        for seed in 1..=seeds {
            let study = Study::read(path, &overrides(seed, &arguments))?;
            let options = TuneOptions {
                optimizer: *optimizer,
                budget: BUDGET,
                patience: None,
            };
            let answer = study.tune(&options, &RunOptions::default())?;
            let arrival = answer
                .scores
                .points
                .iter()
                .position(|point| cells[cell(grid, &point.values)]);
            let best = answer.scores.best.map(|best| &answer.scores.points[best]);
            let arrived = arrival.map_or("not".to_owned(), |index| (index + 1).to_string());
            let outside = match best {
                Some(best) if arrival.is_some() && !cells[cell(grid, &best.values)] => {
                    " (but its best lies outside)"
                }
                _ => "",
            };
            let score = best.and_then(|best| best.score).unwrap_or(f64::NAN);
            arrivals.push(format!("{arrived}: {score:.4}{outside}"));
        }
        println!("{:<15} {}", optimizer.name(), arrivals.join(", "));
    }
    Ok(())
}
