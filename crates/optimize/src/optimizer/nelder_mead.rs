//! The downhill simplex (Nelder & Mead 1965).

use std::convert::Infallible;

use super::replay::{Replay, Unknown};
use super::{Brief, History, Optimizer, Proposal, UnitPoint};
use realgap_core::error::Result;

/// Nelder–Mead with restarts from the best points of the first design.
pub(super) struct NelderMead;

/// Edge of the first simplex, share of the range.
const EDGE: f64 = 0.12;
/// A simplex whose scores differ by less than this share of the best score has arrived.
const ARRIVED: f64 = 1e-3;
/// Evaluations of one simplex per parameter; rough scores can keep it wandering for ever.
const PATIENCE: usize = 30;
/// How far a worst corner goes from the middle of the others, in multiples of its distance; all four are the paper's.
const REFLECTED: f64 = 1.0;
const EXPANDED: f64 = 2.0;
const CONTRACTED: f64 = 0.5;
/// How near to the best corner the others come where nothing else helps.
const SHRUNK: f64 = 0.5;

/// `start` and one more point along each axis, towards the middle.
fn corners(start: &UnitPoint) -> Vec<UnitPoint> {
    let mut corners = vec![start.clone()];
    for axis in 0..start.len() {
        let mut corner = start.clone();
        corner[axis] += if corner[axis] > 0.5 { -EDGE } else { EDGE };
        corners.push(corner);
    }
    corners
}

/// `from` and `factor` times the way to `to`.
fn along(from: &[f64], to: &[f64], factor: f64) -> UnitPoint {
    let pairs = from.iter().zip(to);
    pairs
        .map(|(from, to)| from + (to - from) * factor)
        .collect()
}

struct Corner {
    point: UnitPoint,
    score: f64,
}

/// The corners, best first.
struct Simplex(Vec<Corner>);

impl Simplex {
    fn begin(start: &UnitPoint, replay: &mut Replay<'_>) -> std::result::Result<Self, Unknown> {
        let points = corners(start);
        let scores = replay.scores(points.iter().map(Vec::as_slice))?;
        let corners = points.into_iter().zip(scores);
        let mut simplex = Self(
            corners
                .map(|(point, score)| Corner { point, score })
                .collect(),
        );
        simplex.sort();
        Ok(simplex)
    }

    fn sort(&mut self) {
        self.0.sort_by(|a, b| a.score.total_cmp(&b.score));
    }

    /// The middle of all corners but the worst.
    fn middle(&self) -> UnitPoint {
        let others = &self.0[..self.0.len() - 1];
        let share = 1.0 / others.len() as f64;
        (0..others[0].point.len())
            .map(|axis| {
                let first = others[0].point[axis];
                let sum = others[1..].iter().fold(first, |sum, c| sum + c.point[axis]);
                sum * share
            })
            .collect()
    }

    fn step(&mut self, replay: &mut Replay<'_>) -> std::result::Result<(), Unknown> {
        let middle = self.middle();
        let last = self.0.len() - 1;
        let (best, worst) = (self.0[0].score, self.0[last].score);
        let second_worst = self.0[last - 1].score;
        let mirrored: UnitPoint = middle
            .iter()
            .zip(&self.0[last].point)
            .map(|(middle, worst)| middle + (middle - worst) * REFLECTED)
            .collect();
        let mirrored_score = replay.score(&mirrored)?;
        let reflected = Corner {
            point: mirrored,
            score: mirrored_score,
        };
        if reflected.score < best {
            let point = along(&middle, &reflected.point, EXPANDED);
            let score = replay.score(&point)?;
            self.0[last] = if score < reflected.score {
                Corner { point, score }
            } else {
                reflected
            };
        } else if reflected.score < second_worst {
            self.0[last] = reflected;
        } else {
            let outside = reflected.score < worst;
            let towards = if outside {
                &reflected.point
            } else {
                &self.0[last].point
            };
            let point = along(&middle, towards, CONTRACTED);
            let score = replay.score(&point)?;
            let better = if outside {
                score <= reflected.score
            } else {
                score < worst
            };
            if better {
                self.0[last] = Corner { point, score };
            } else {
                let best = self.0[0].point.clone();
                for corner in &mut self.0[1..] {
                    corner.point = along(&best, &corner.point, SHRUNK);
                    corner.score = replay.score(&corner.point)?;
                }
            }
        }
        self.sort();
        Ok(())
    }

    /// Standard deviation of the scores.
    fn spread(&self) -> f64 {
        let n = self.0.len() as f64;
        let mean = self.0.iter().map(|corner| corner.score).sum::<f64>() / n;
        let squares = self.0.iter().map(|corner| (corner.score - mean).powi(2));
        (1.0 / (n - 1.0) * squares.sum::<f64>()).sqrt()
    }
}

fn search(dimensions: usize, history: &History<'_>) -> std::result::Result<Infallible, Unknown> {
    let mut replay = Replay::new(history.told);
    let middle = vec![0.5; dimensions];
    let starts = history.best_of_design();
    let scale = starts.first().map_or(1.0, |(_, score)| score.abs());
    let arrived = (ARRIVED * scale).max(f64::MIN_POSITIVE);
    let mut restart = 0;
    loop {
        let start = match starts.len() {
            0 => &middle,
            n => starts[restart % n].0,
        };
        let limit = replay.answered() + PATIENCE * dimensions;
        let mut simplex = Simplex::begin(start, &mut replay)?;
        while replay.answered() < limit && simplex.spread() >= arrived {
            simplex.step(&mut replay)?;
        }
        restart += 1;
    }
}

impl Optimizer for NelderMead {
    fn name(&self) -> &'static str {
        "nelder-mead"
    }

    fn doc(&self) -> &'static str {
        "Downhill simplex (Nelder & Mead 1965), restarted from the best points of a space-filling first design; one candidate at a time."
    }

    fn batch(&self, brief: &Brief) -> usize {
        brief.dimensions() + 1
    }

    fn propose(&self, brief: &Brief, history: &History<'_>) -> Result<Proposal> {
        let Err(Unknown(points)) = search(brief.dimensions(), history);
        Ok(Proposal::Evaluate(points))
    }
}
