//! A discrete Bayes filter over the distance (paper 000, algorithm 1), computed in logarithms.

mod cell;
#[cfg(feature = "papers")]
mod experiment;

use super::range::{Beam, RangeSensor};

#[cfg(feature = "papers")]
pub use experiment::{BeliefOptions, BeliefReport, DistanceBelief, TrialSet};

/// Probabilities of distances on a grid.
///
/// The computation in logarithms avoids underflow of products of many small densities. If a reading has density 0 at every distance
/// (or the weights are not finite), the belief is set to the uniform distribution again, and the restart is counted.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    distances_m: Vec<f64>,
    log_weights: Vec<f64>,
    restarts: usize,
}

impl Belief {
    /// A uniform belief over `cells` evenly spaced distances from `near_m` to `far_m`.
    pub fn uniform(near_m: f64, far_m: f64, cells: usize) -> Self {
        let cells = cells.max(2);
        let step = (far_m - near_m) / (cells - 1) as f64;
        Self::on((0..cells).map(|k| near_m + step * k as f64).collect())
    }

    /// A uniform belief over these distances, which may be any grid.
    pub fn on(distances_m: Vec<f64>) -> Self {
        Self {
            log_weights: vec![0.0; distances_m.len()],
            distances_m,
            restarts: 0,
        }
    }

    /// The grid, metres.
    pub fn distances_m(&self) -> &[f64] {
        &self.distances_m
    }

    /// Number of times that the belief was set to the uniform distribution because a reading was impossible at every distance.
    pub fn restarts(&self) -> usize {
        self.restarts
    }

    /// Updates the belief by a reading: p ← constant · p(z | d) p.
    pub fn observe(&mut self, sensor: &dyn RangeSensor, reading: f64) {
        for (weight, distance_m) in self.log_weights.iter_mut().zip(&self.distances_m) {
            *weight += sensor.log_density(reading, &Beam::straight(*distance_m));
        }
        self.normalise();
    }

    /// Updates the belief by a reading of a sensor that may resolve distances within one cell: p(z | cell) is the mean over the cell
    /// (a histogram filter; Thrun, Burgard & Fox 2005, section 4.1.2). With the density at the middle of each cell alone, a reading
    /// from a distance between two middles would seem impossible, and cells with the largest standard deviation of readings would be
    /// preferred, however far away they are.
    pub fn observe_within(&mut self, sensor: &dyn RangeSensor, reading: f64) {
        let half_m = 0.5 * self.cell_m();
        let (low_m, high_m) = self.ends_m();
        for (weight, middle_m) in self.log_weights.iter_mut().zip(&self.distances_m) {
            let edges_m = [
                (middle_m - half_m).max(low_m),
                (middle_m + half_m).min(high_m),
            ];
            *weight += cell::log_density(sensor, reading, *middle_m, edges_m);
        }
        self.normalise();
    }

    /// Updates the belief by a motion that reduces the distance by `closer_m` with this standard deviation. Probability that would
    /// leave the grid stays in its last cell.
    pub fn move_by(&mut self, closer_m: f64, sd_m: f64) {
        let old = self.probabilities();
        let least = self.cell_m() * 0.3;
        let sd = sd_m.max(least);
        let mut new = vec![0.0; old.len()];
        let (low, high) = self.ends_m();
        for (p, from) in old.iter().zip(&self.distances_m).filter(|(p, _)| **p > 0.0) {
            let centre = (from - closer_m).clamp(low, high);
            let weights: Vec<f64> = self
                .distances_m
                .iter()
                .map(|to| libm::exp(-0.5 * ((to - centre) / sd).powi(2)))
                .collect();
            let sum: f64 = weights.iter().sum();
            for (target, weight) in new.iter_mut().zip(weights) {
                *target += p * weight / sum;
            }
        }
        self.log_weights = new.iter().map(|p| libm::log(*p)).collect();
        self.normalise();
    }

    /// The first and the last distance of the grid, metres.
    fn ends_m(&self) -> (f64, f64) {
        (
            self.distances_m[0],
            self.distances_m[self.distances_m.len() - 1],
        )
    }

    /// Mean width of a cell, metres.
    fn cell_m(&self) -> f64 {
        let (low, high) = self.ends_m();
        (high - low) / (self.distances_m.len() - 1) as f64
    }

    fn normalise(&mut self) {
        let most = self
            .log_weights
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        if !most.is_finite() {
            self.log_weights.iter_mut().for_each(|w| *w = 0.0);
            self.restarts += 1;
            return;
        }
        self.log_weights.iter_mut().for_each(|w| *w -= most);
    }

    /// Probability of each distance; they sum to 1.
    pub fn probabilities(&self) -> Vec<f64> {
        let weights: Vec<f64> = self.log_weights.iter().map(|w| libm::exp(*w)).collect();
        let sum: f64 = weights.iter().sum();
        weights.iter().map(|w| w / sum).collect()
    }

    /// Mean distance, metres.
    pub fn mean_m(&self) -> f64 {
        self.probabilities()
            .iter()
            .zip(&self.distances_m)
            .map(|(p, d)| p * d)
            .sum()
    }

    /// Standard deviation, metres.
    pub fn sd_m(&self) -> f64 {
        let mean = self.mean_m();
        let variance: f64 = self
            .probabilities()
            .iter()
            .zip(&self.distances_m)
            .map(|(p, d)| p * (d - mean).powi(2))
            .sum();
        variance.sqrt()
    }
}
