//! Which parameter values the observations do not rule out: history matching of the score, with a model discrepancy.
//!
//! A point is *implausible* by the largest standardised amount by which another point scores better, I(θ) = max over θ′ of
//! (S(θ) − S(θ′)) / sd(S(θ) − S(θ′)). The standard deviation contains the emulator, the settings, the observations and the model's
//! discrepancy (Craig et al. 1997; Kennedy & O'Hagan 2001; Vernon, Goldstein & Bower 2010). Near the bottom of a valley of the score,
//! I is Rao's score statistic with the sandwich variance (Rao 1948; Huber 1967). So the quantiles of the density exp(−I²/2) over the
//! parameters are confidence limits. A parameter without effect keeps its whole range, because no score speaks against any value.

use rand::RngExt;

use crate::candidate_sampler::CandidateSampler;
use crate::emulator::Emulator;
use crate::implausibility::{
    ObservationUncertainty, ScoreCovariance, emulator_share, implausibility,
};
use crate::posterior::PosteriorDraws;
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{chi_squared_quantile, ends_of};
use realgap_optimization::Grid;

/// Confidence level of the confidence set: the points that are not implausible.
pub const LEVEL: f64 = 0.95;
/// Points whose implausibility exceeds the limit of the confidence set by more than this are left out of every result.
const BEYOND: f64 = 1.0;
/// How often points are sampled anew around those that are not implausible, and the margin around these: a share of the range of
/// their expected scores.
const NARROWINGS: usize = 6;
const MARGIN: f64 = 0.25;
/// Rounding error of standardised scores.
const ROUNDING: f64 = 1e-6;
/// Narrowing ends when more than one in so many points is not implausible.
const ENOUGH: usize = 4;
/// Points that are drawn from the posterior density.
const DRAWS: usize = 1000;
/// Bins along a parameter, and points that a bin holds at least before it can separate two intervals; a bin does so where all of its
/// points are implausible.
const BINS: usize = 16;
const POINTS_PER_BIN: usize = 10;

/// A point of the search space where the black box was not evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Unvisited {
    /// Parameter values.
    pub values: Vec<f64>,
    /// Whether the point belongs to the confidence set.
    pub indistinguishable: bool,
}

/// The points that history matching does not rule out, and the implausibility of those that it was asked about.
#[derive(Debug)]
pub struct HistoryMatching {
    /// Coordinates, 0 to 1, of points that are spread evenly over the part of the search space that is not implausible.
    points: Vec<Vec<f64>>,
    /// Implausibility of each of these points.
    implausibility: Vec<f64>,
    /// Implausibility of the points that the caller asked about.
    visited: Vec<f64>,
    /// Coordinates of other points that were looked at on the way and are implausible.
    rejected: Vec<Vec<f64>>,
    emulator_share: f64,
    limit: f64,
}

impl HistoryMatching {
    /// Samples `count` points, and computes the implausibility of these and of `visited`, which are coordinates of evaluated points.
    pub fn new(
        emulator: &Emulator,
        grid: &Grid,
        visited: &[Vec<f64>],
        uncertainty: ObservationUncertainty,
        count: usize,
        seed: u64,
    ) -> Self {
        let dimensions = grid.ranges().len();
        let limit = chi_squared_quantile(LEVEL, dimensions as f64).sqrt();
        let look = |points: Vec<Vec<f64>>| {
            let all: Vec<Vec<f64>> = points.iter().chain(visited).cloned().collect();
            let field = emulator.field(&all);
            let covariance = ScoreCovariance::new(&field, uncertainty);
            let implausibility = implausibility(&field, &covariance);
            (all, field, covariance, implausibility)
        };
        let sampler = CandidateSampler {
            emulator,
            grid,
            seed,
        };
        // First points anywhere and in the lowest valleys, however narrow these are; then points around those that are not implausible.
        let mut axes = vec![vec![(0.0, 1.0)]; dimensions];
        let mut rejected = Vec::new();
        let few = count / 2;
        let mut points = sampler.spread(&axes, f64::INFINITY, few / 2);
        points.extend(sampler.lowest(&axes, few / 2));
        for narrowing in 0..NARROWINGS {
            let (all, field, _, implausibility) = look(points);
            let near = (0..all.len()).filter(|point| implausibility[*point] <= limit + BEYOND);
            let near: Vec<usize> = near.collect();
            let implausible = (0..all.len()).filter(|point| !near.contains(point));
            rejected.extend(implausible.map(|point| all[point].clone()));
            let (lowest, highest) = ends_of(near.iter().map(|point| field.means[*point]));
            // Where the expected score is the same everywhere, rounding errors must not separate one point from the others.
            let level = highest + MARGIN * (highest - lowest) + ROUNDING;
            let near: Vec<&Vec<f64>> = near.iter().map(|point| &all[*point]).collect();
            axes = sampler.around(&near, &axes, few);
            let last = narrowing + 1 == NARROWINGS || near.len() * ENOUGH > all.len();
            points = sampler.spread(&axes, level, if last { count } else { few });
            if last {
                break;
            }
        }
        let count = points.len();
        let (mut points, field, covariance, mut implausibility) = look(points);
        let emulator_share = emulator_share(&field, &covariance, &implausibility, limit);
        let visited = implausibility.split_off(count);
        points.truncate(count);
        Self {
            points,
            implausibility,
            visited,
            rejected,
            emulator_share,
            limit,
        }
    }

    /// Share of the emulator in the variance of the difference between the best point and others of the confidence set: the share that
    /// more runs would remove, 0 to 1.
    pub fn emulator_share(&self) -> f64 {
        self.emulator_share
    }

    /// Largest implausibility of a point of the confidence set.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Whether each of the points that the caller asked about belongs to the confidence set.
    pub fn visited_in_set(&self) -> impl Iterator<Item = bool> {
        self.visited.iter().map(|i| *i <= self.limit)
    }

    /// The sampled points, where the black box was not evaluated.
    pub fn unvisited(&self, grid: &Grid) -> Vec<Unvisited> {
        let points = self.points.iter().zip(&self.implausibility);
        points
            .map(|(point, implausibility)| Unvisited {
                values: grid.values_at(point),
                indistinguishable: *implausibility <= self.limit,
            })
            .collect()
    }

    /// Posterior density of each sampled point, without its constant.
    fn densities(&self) -> Vec<f64> {
        let squares = self.implausibility.iter().map(|i| i * i);
        squares.map(|square| libm::exp(-0.5 * square)).collect()
    }

    /// Points for the next runs: about half of them drawn from the posterior density, the others evenly from all that is not
    /// implausible.
    pub fn wave(&self, count: usize, rng: &mut Generator) -> Vec<&[f64]> {
        let mut likely = self.densities();
        let mut possible: Vec<f64> = (self.implausibility.iter())
            .map(|i| f64::from(u8::from(*i <= self.limit + BEYOND)))
            .collect();
        let mut chosen = Vec::new();
        for _ in 0..count.min(self.points.len()) {
            // The kind of point is chosen at random: settings come in turn, and must not coincide with one kind.
            let weights = match rng.random() {
                true => &likely,
                false => &possible,
            };
            let Some(point) = pick(weights, rng.random()) else {
                break;
            };
            (likely[point], possible[point]) = (0.0, 0.0);
            chosen.push(self.points[point].as_slice());
        }
        chosen
    }

    /// Parameter values drawn from the posterior density.
    pub fn draws(&self, grid: &Grid, seed: u64) -> PosteriorDraws {
        let weights = self.densities();
        let total: f64 = weights.iter().sum();
        let mut rng = Once::BestPoint.generator(seed);
        // Systematic resampling: one random number, then equal steps through the cumulated weights.
        let first: f64 = rng.random();
        let (mut draws, mut sum) = (Vec::with_capacity(DRAWS), 0.0);
        for (point, weight) in self.points.iter().zip(&weights) {
            sum += weight / total * DRAWS as f64;
            while (draws.len() as f64 + first) < sum {
                draws.push(grid.values_at(point));
            }
        }
        if draws.is_empty() {
            draws.push(grid.values_at(&self.points[0]));
        }
        let gaps = (0..grid.ranges().len()).map(|axis| self.gaps(axis, grid));
        PosteriorDraws::new(draws, gaps.collect())
    }

    /// Values in the middle of each implausible part along a parameter that lies between two parts that are not implausible.
    fn gaps(&self, axis: usize, grid: &Grid) -> Vec<f64> {
        let along = || self.points.iter().map(|point| point[axis]);
        let (low, high) = ends_of(along());
        let (mut counts, mut open) = ([0; BINS], [false; BINS]);
        let bin = |at: f64| {
            let share = (at - low) / (high - low).max(f64::MIN_POSITIVE);
            ((share * BINS as f64) as usize).min(BINS - 1)
        };
        for (at, implausibility) in along().zip(&self.implausibility) {
            counts[bin(at)] += 1;
            open[bin(at)] |= *implausibility <= self.limit + BEYOND;
        }
        let rejected = self.rejected.iter().map(|point| point[axis]);
        for at in rejected.filter(|at| (low..=high).contains(at)) {
            counts[bin(at)] += 1;
        }
        let (mut gaps, mut last_open) = (Vec::new(), None);
        for bin in (0..BINS).filter(|bin| open[*bin]) {
            let closed = last_open.map_or(bin..bin, |last: usize| last + 1..bin);
            last_open = Some(bin);
            if !closed.is_empty() && closed.clone().all(|bin| counts[bin] >= POINTS_PER_BIN) {
                let middle = 0.5 * (closed.start + closed.end) as f64 / BINS as f64;
                gaps.push(grid.ranges()[axis].at(low + middle * (high - low)));
            }
        }
        gaps
    }
}

/// The first index whose cumulated weight exceeds `share` of the total; `None` where all weights are 0.
fn pick(weights: &[f64], share: f64) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let mut left = share * total;
    weights.iter().position(|weight| {
        left -= weight;
        *weight > 0.0 && left <= 0.0
    })
}
