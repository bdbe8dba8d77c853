#![allow(clippy::print_stdout)]
//! Shows how to write your own optimizer: one type that implements `Optimizer`, a pure function of the history.
//!
//! `cargo run --example own_optimizer`

use realgap::Result;
use realgap::optimization::{History, OptimizationProblem, Optimizer, Proposal, minimise};

/// Compass search: evaluates points on both sides of the best point along every axis, with steps that shrink.
struct Compass;

impl Optimizer for Compass {
    fn name(&self) -> &'static str {
        "compass"
    }
    fn doc(&self) -> &'static str {
        "Compass search (Kolda, Lewis and Torczon 2003), steps that shrink with every batch."
    }
    fn batch(&self, problem: &OptimizationProblem) -> usize {
        2 * problem.dimensions()
    }
    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let evaluated = history.design.iter().chain(history.evaluated);
        let scored = evaluated.filter_map(|one| Some((one.score?, &one.point)));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        let centre = best.map_or(vec![0.5; problem.dimensions()], |(_, point)| point.clone());
        let step = 0.25 * 0.7_f64.powi((history.evaluated.len() / self.batch(problem)) as i32);
        let sides = (0..problem.dimensions()).flat_map(|axis| [(axis, -step), (axis, step)]);
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
    let problem = OptimizationProblem {
        points: vec![21, 21],
        budget: 80,
        seed: 1,
        priors: Vec::new(),
        error_blocks: Vec::new(),
        own: None,
    };
    // One line in OPTIMIZERS does the same for `realgap tune --optimizer compass`.
    let evaluated = minimise(&Compass, &problem, |point| {
        let squares = point.iter().zip(hidden).map(|(x, h)| (x - h).powi(2));
        Some(squares.sum())
    })?;
    let scores = evaluated.iter().filter_map(|one| one.score);
    let best = scores.fold(f64::INFINITY, f64::min);
    println!(
        "{} points, the best {:.4} away",
        evaluated.len(),
        best.sqrt()
    );
    Ok(())
}
