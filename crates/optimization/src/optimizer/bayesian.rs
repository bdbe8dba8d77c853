//! Efficient global optimisation (Jones, Schonlau & Welch 1998): a model of what is known says where a better score may be.

use super::expected_improvement::log_expected_improvement;
use super::{
    EvaluatedPoint, History, OptimizationProblem, Optimizer, Proposal, UnitPoint, space_filling,
};
use crate::gaussian_process::GaussianProcess;
use realgap_core::error::Result;

/// Gaussian process with expected improvement.
pub(super) struct Bayesian;

/// Candidates in one batch.
const BATCH: usize = 2;
/// Points that the kernel is fitted to, and those that the process knows at most. Work grows with the cube of either.
const FITTED: usize = 80;
const KNOWN: usize = 300;
/// Places where improvement is computed: all over the range, and around each of the best points.
const ANYWHERE: usize = 256;
const NEARBY: usize = 32;
/// Points with surroundings, and their widths, share of the range.
const FAVOURITES: usize = 3;
const WIDTHS: [f64; 3] = [0.2, 0.05, 0.01];
/// Candidates that are improved upon, from which first step to which last.
const CLIMBERS: usize = 3;
const FIRST_STEP: f64 = 0.05;
const LAST_STEP: f64 = 1e-3;
/// A candidate nearer than this to a known point along every axis tells nothing new: a simulation has no noise of its own.
const APART: f64 = 1e-4;

/// At most `most` of what was scored: the better half by score, the others spread evenly over the rest.
pub fn thin<T: Clone>(mut scored: Vec<(T, f64)>, most: usize) -> Vec<(T, f64)> {
    if scored.len() <= most {
        return scored;
    }
    scored.sort_by(|a, b| a.1.total_cmp(&b.1));
    let rest = scored.split_off(most / 2);
    let wanted = most - scored.len();
    scored.extend((0..wanted).map(|index| rest[index * rest.len() / wanted].clone()));
    scored
}

/// Mean 0 and standard deviation 1.
fn standardised(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    let sd = (squares.sum::<f64>() / n).sqrt();
    let scale = if sd > 0.0 { sd } else { 1.0 };
    values.iter().map(|value| (value - mean) / scale).collect()
}

/// Log improvement over the best of what the process believes about the known points.
struct Promise<'a> {
    process: &'a GaussianProcess<'a>,
    known: &'a [UnitPoint],
    best: f64,
}

impl Promise<'_> {
    fn at(&self, point: &[f64]) -> f64 {
        let again = self.known.iter().any(|known| {
            let axes = known.iter().zip(point);
            axes.fold(0.0, |far: f64, (a, b)| far.max((a - b).abs())) < APART
        });
        if again {
            return f64::NEG_INFINITY;
        }
        let (mean, sd) = self.process.predict(point);
        log_expected_improvement(mean, sd, self.best)
    }

    /// The most promising place near `start`: steps along the axes, halved where none is better.
    fn climb(&self, mut start: UnitPoint, mut promise: f64) -> (UnitPoint, f64) {
        let mut step = FIRST_STEP;
        while step > LAST_STEP {
            let mut better = None;
            for axis in 0..start.len() {
                for change in [-step, step] {
                    let mut point = start.clone();
                    point[axis] = (point[axis] + change).clamp(0.0, 1.0);
                    let there = self.at(&point);
                    if there > promise {
                        (promise, better) = (there, Some(point));
                    }
                }
            }
            match better {
                Some(point) => start = point,
                None => step *= 0.5,
            }
        }
        (start, promise)
    }
}

/// Places all over the range, and around the points whose mean is best.
fn places(known: &[UnitPoint], means: &[f64], seed: u64) -> Vec<UnitPoint> {
    let dimensions = known[0].len();
    let mut order: Vec<usize> = (0..known.len()).collect();
    order.sort_by(|a, b| means[*a].total_cmp(&means[*b]));
    let mut places = space_filling(dimensions, 0, ANYWHERE, seed);
    for (rank, index) in order.into_iter().take(FAVOURITES).enumerate() {
        let around = &known[index];
        for width in WIDTHS {
            let offsets = space_filling(dimensions, 0, NEARBY, seed.wrapping_add(1 + rank as u64));
            places.extend(offsets.into_iter().map(|offset| {
                let axes = around.iter().zip(offset);
                axes.map(|(centre, offset)| (centre + width * (2.0 * offset - 1.0)).clamp(0.0, 1.0))
                    .collect()
            }));
        }
    }
    places
}

/// Where improvement is most to be expected; `None` where the process knows every place already.
fn most_promising(
    process: &GaussianProcess<'_>,
    known: &[UnitPoint],
    seed: u64,
) -> Option<UnitPoint> {
    let means: Vec<f64> = known.iter().map(|point| process.predict(point).0).collect();
    let best = means.iter().copied().fold(f64::INFINITY, f64::min);
    let promise = Promise {
        process,
        known,
        best,
    };
    let mut ranked: Vec<(UnitPoint, f64)> = places(known, &means, seed)
        .into_iter()
        .map(|point| {
            let there = promise.at(&point);
            (point, there)
        })
        .collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let climbed = ranked
        .into_iter()
        .take(CLIMBERS)
        .map(|(point, there)| promise.climb(point, there));
    let (point, there) = climbed.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    there.is_finite().then_some(point)
}

impl Optimizer for Bayesian {
    fn name(&self) -> &'static str {
        "bayesian"
    }

    fn doc(&self) -> &'static str {
        "Gaussian process with expected improvement (Jones et al. 1998): fewest simulations, most thought between them; for budgets of a few hundred."
    }

    fn batch(&self, _brief: &OptimizationProblem) -> usize {
        BATCH
    }

    fn propose(&self, brief: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let all: Vec<&EvaluatedPoint> = history.design.iter().chain(history.evaluated).collect();
        let seed = brief.seed.wrapping_add(all.len() as u64);
        let further = || {
            let from = all.len();
            space_filling(brief.dimensions(), from, from + BATCH, brief.seed)
        };
        let scores: Vec<f64> = all.iter().filter_map(|told| told.score).collect();
        let worst = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if scores.len() < 2 {
            // Nothing to model yet: fill space further.
            return Ok(Proposal::Evaluate(further()));
        }
        // A failed candidate counts as bad as the worst seen: a huge penalty would spoil the process.
        let scored = all
            .iter()
            .map(|told| (told.point.clone(), told.score.unwrap_or(worst)))
            .collect();
        let (mut known, scores): (Vec<UnitPoint>, Vec<f64>) =
            thin(scored, KNOWN).into_iter().unzip();
        let mut values = standardised(&scores);
        let pairs = known.iter().cloned().zip(values.iter().copied()).collect();
        let (points, heights): (Vec<UnitPoint>, Vec<f64>) = thin(pairs, FITTED).into_iter().unzip();
        let Some(hyperparameters) =
            GaussianProcess::fit(&points, &heights).map(|p| p.hyperparameters().clone())
        else {
            return Ok(Proposal::Evaluate(further()));
        };
        let mut batch = Vec::new();
        for place in 0..BATCH {
            let Some(process) = GaussianProcess::new(&known, &values, hyperparameters.clone())
            else {
                break;
            };
            let Some(point) = most_promising(&process, &known, seed) else {
                break;
            };
            if place + 1 < BATCH {
                // The next candidate is chosen as if this one had turned out as expected (Ginsbourger et al. 2010).
                let believed = process.predict(&point).0;
                known.push(point.clone());
                values.push(believed);
            }
            batch.push(point);
        }
        if batch.is_empty() {
            batch = further();
        }
        Ok(Proposal::Evaluate(batch))
    }
}
