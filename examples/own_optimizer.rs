#![allow(clippy::print_stdout)]
//! An optimizer of your own: one type that implements `Optimizer`, a pure function of the history.
//!
//! `cargo run --example own_optimizer`

use realgap::Result;
use realgap::optimization::{History, OptimizationProblem, Optimizer, Proposal, minimise};

/// Looks to both sides of the best point along every axis, in steps that shrink.
struct Compass;

impl Optimizer for Compass {
    fn name(&self) -> &'static str {
        "compass"
    }
    fn doc(&self) -> &'static str {
        "Compass search (Kolda, Lewis and Torczon 2003), steps that shrink with every batch."
    }
    fn batch(&self, brief: &OptimizationProblem) -> usize {
        2 * brief.dimensions()
    }
    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let told = history.design.iter().chain(history.told);
        let scored = told.filter_map(|told| Some((told.score?, &told.point)));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        let centre = best.map_or(vec![0.5; brief.dimensions()], |(_, point)| point.clone());
        let step = 0.25 * 0.7_f64.powi((history.told.len() / self.batch(brief)) as i32);
        let sides = (0..brief.dimensions()).flat_map(|axis| [(axis, -step), (axis, step)]);
        let candidates = sides.map(|(axis, step)| {
            let mut point = centre.clone();
            point[axis] = (point[axis] + step).clamp(0.0, 1.0);
            point
        });
        Ok(Proposal::Evaluate(candidates.collect()))
    }
}

fn main() -> Result<()> {
    let hidden = [0.7, 0.2];
    let brief = OptimizationProblem {
        points: vec![21, 21],
        budget: 80,
        seed: 1,
        priors: Vec::new(),
    };
    // One line in OPTIMIZERS does the same for `realgap tune --optimizer compass`.
    let told = minimise(&Compass, &brief, |point| {
        let squares = point.iter().zip(hidden).map(|(x, h)| (x - h).powi(2));
        Some(squares.sum())
    })?;
    let scores = told.iter().filter_map(|told| told.score);
    let best = scores.fold(f64::INFINITY, f64::min);
    println!("{} points, the best {:.4} away", told.len(), best.sqrt());
    Ok(())
}
