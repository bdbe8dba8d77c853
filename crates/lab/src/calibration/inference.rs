//! Which parameter values the recordings leave possible: history matching of the score, with a discrepancy.
//!
//! A point is *implausible* as far as some other point scores better than everything that is unknown about the two explains,
//! I(θ) = max over θ′ of (S(θ) − S(θ′)) / sd(S(θ) − S(θ′)), with variances of emulator, numerics, recordings and model discrepancy
//! (Craig et al. 1997; Kennedy & O'Hagan 2001; Vernon, Goldstein & Bower 2010). Near the bottom of a valley I is Rao's score
//! statistic with the sandwich variance (Rao 1948; Huber 1967), so that quantiles of the density exp(−I²/2) over the parameters are
//! confidence limits, and what a parameter that does nothing leaves is its whole range: no score speaks against any value.

use rand::RngExt;

use super::BestDraws;
use super::sieve::Sieve;
use realgap_core::random::{Generator, Once};
use realgap_core::statistics::{chi_squared_quantile, ends_of};
use realgap_inference::{Doubt, Emulator, Variance, emulator_share, implausibility};
use realgap_optimization::Grid;

/// Confidence level of the set of points that are not implausible.
pub const LEVEL: f64 = 0.95;
/// Points that are more implausible than the set's by this have no part in anything.
const BEYOND: f64 = 1.0;
/// How often places are spread anew over what is not implausible, and by how much more than it.
const NARROWINGS: usize = 6;
const MARGIN: f64 = 0.25;
/// Of standardised scores.
const ROUNDING: f64 = 1e-6;
/// One in so many places has to be possible for them to be enough.
const ENOUGH: usize = 4;
/// Realities drawn.
const DRAWS: usize = 1000;
/// Bins along a parameter part two intervals where they hold so many places at least, and all of these have no part in anything.
const BINS: usize = 16;
const PLACES_A_BIN: usize = 10;

/// What may be, at places spread evenly over it.
#[derive(Debug)]
pub(super) struct Inference {
    /// Coordinates, 0 to 1.
    pub places: Vec<Vec<f64>>,
    /// How implausible each is.
    pub implausibility: Vec<f64>,
    /// The same of the points that were asked for.
    pub visited: Vec<f64>,
    /// Coordinates of other places, which were looked at on the way and are implausible.
    rejected: Vec<Vec<f64>>,
    /// Share of the emulator in the variance between the likeliest place and others that are not implausible.
    pub emulator_share: f64,
    /// Implausibility up to which a point is one of the set.
    pub limit: f64,
}

impl Inference {
    /// At `count` places, and at `visited`, which are coordinates of points that were simulated.
    pub fn new(
        emulator: &Emulator,
        grid: &Grid,
        visited: &[Vec<f64>],
        doubt: Doubt,
        count: usize,
        seed: u64,
    ) -> Self {
        let dimensions = grid.ranges().len();
        let limit = chi_squared_quantile(LEVEL, dimensions as f64).sqrt();
        let look = |places: Vec<Vec<f64>>| {
            let all: Vec<Vec<f64>> = places.iter().chain(visited).cloned().collect();
            let field = emulator.field(&all);
            let variance = Variance::new(&field, doubt);
            let implausibility = implausibility(&field, &variance);
            (all, field, variance, implausibility)
        };
        let sieve = Sieve {
            emulator,
            grid,
            seed,
        };
        // Anywhere, and in the lowest valleys however narrow; then in what of it may be.
        let mut parts = vec![vec![(0.0, 1.0)]; dimensions];
        let mut rejected = Vec::new();
        let few = count / 2;
        let mut places = sieve.spread(&parts, f64::INFINITY, few / 2);
        places.extend(sieve.lowest(&parts, few / 2));
        for narrowing in 0..NARROWINGS {
            let (all, field, _, implausibility) = look(places);
            let near = (0..all.len()).filter(|place| implausibility[*place] <= limit + BEYOND);
            let near: Vec<usize> = near.collect();
            let implausible = (0..all.len()).filter(|place| !near.contains(place));
            rejected.extend(implausible.map(|place| all[place].clone()));
            let (lowest, highest) = ends_of(near.iter().map(|place| field.means[*place]));
            // Where it expects the same everywhere, rounding must not part one place from the others.
            let level = highest + MARGIN * (highest - lowest) + ROUNDING;
            let near: Vec<&Vec<f64>> = near.iter().map(|place| &all[*place]).collect();
            parts = sieve.around(&near, &parts, few);
            let last = narrowing + 1 == NARROWINGS || near.len() * ENOUGH > all.len();
            places = sieve.spread(&parts, level, if last { count } else { few });
            if last {
                break;
            }
        }
        let count = places.len();
        let (mut places, field, variance, mut implausibility) = look(places);
        let emulator_share = emulator_share(&field, &variance, &implausibility, limit);
        let visited = implausibility.split_off(count);
        places.truncate(count);
        Self {
            places,
            implausibility,
            visited,
            rejected,
            emulator_share,
            limit,
        }
    }

    /// The likelihood of each place.
    fn weights(&self) -> Vec<f64> {
        let squares = self.implausibility.iter().map(|i| i * i);
        squares.map(|square| libm::exp(-0.5 * square)).collect()
    }

    /// Places for the next runs: one half as probable as they are likely, the others anywhere that is not implausible.
    pub fn wave(&self, count: usize, rng: &mut Generator) -> Vec<&[f64]> {
        let mut likely = self.weights();
        let mut possible: Vec<f64> = (self.implausibility.iter())
            .map(|i| f64::from(u8::from(*i <= self.limit + BEYOND)))
            .collect();
        let mut chosen = Vec::new();
        for _ in 0..count.min(self.places.len()) {
            // At random: settings come in turn, and must not come with one kind of place.
            let weights = match rng.random() {
                true => &likely,
                false => &possible,
            };
            let Some(place) = pick(weights, rng.random()) else {
                break;
            };
            (likely[place], possible[place]) = (0.0, 0.0);
            chosen.push(self.places[place].as_slice());
        }
        chosen
    }

    /// Values of as many realities as are drawn, as often as they are likely.
    pub fn draws(&self, grid: &Grid, seed: u64) -> BestDraws {
        let weights = self.weights();
        let total: f64 = weights.iter().sum();
        let mut rng = Once::BestPoint.generator(seed);
        // Systematic: one random number, then equal steps through the weights.
        let first: f64 = rng.random();
        let (mut draws, mut sum) = (Vec::with_capacity(DRAWS), 0.0);
        for (place, weight) in self.places.iter().zip(&weights) {
            sum += weight / total * DRAWS as f64;
            while (draws.len() as f64 + first) < sum {
                draws.push(grid.values_at(place));
            }
        }
        if draws.is_empty() {
            draws.push(grid.values_at(&self.places[0]));
        }
        let gaps = (0..grid.ranges().len()).map(|axis| self.gaps(axis, grid));
        BestDraws::new(draws, gaps.collect())
    }

    /// Values in the middle of what is implausible along a parameter, between what is not.
    fn gaps(&self, axis: usize, grid: &Grid) -> Vec<f64> {
        let along = || self.places.iter().map(|place| place[axis]);
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
        let rejected = self.rejected.iter().map(|place| place[axis]);
        for at in rejected.filter(|at| (low..=high).contains(at)) {
            counts[bin(at)] += 1;
        }
        let (mut gaps, mut last_open) = (Vec::new(), None);
        for bin in (0..BINS).filter(|bin| open[*bin]) {
            let closed = last_open.map_or(bin..bin, |last: usize| last + 1..bin);
            last_open = Some(bin);
            if !closed.is_empty() && closed.clone().all(|bin| counts[bin] >= PLACES_A_BIN) {
                let middle = 0.5 * (closed.start + closed.end) as f64 / BINS as f64;
                gaps.push(grid.ranges()[axis].at(low + middle * (high - low)));
            }
        }
        gaps
    }
}

/// The first whose cumulated share exceeds `share` of all; `None` where all are 0.
fn pick(weights: &[f64], share: f64) -> Option<usize> {
    let total: f64 = weights.iter().sum();
    let mut left = share * total;
    weights.iter().position(|weight| {
        left -= weight;
        *weight > 0.0 && left <= 0.0
    })
}
