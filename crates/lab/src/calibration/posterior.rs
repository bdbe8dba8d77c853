//! Where the best point lies when reality is sampled again: intervals and correlations.

use rand::RngExt;

use realgap_core::random::Once;
use realgap_core::statistics::{mean, percentile_interval, standard_deviation};
use realgap_optimize::Grid;

/// Best parameter values of many realities that the recordings and runs allow: recordings drawn again (bootstrap of the
/// argmin, Efron & Tibshirani 1993, chapter 13), another setting of reality's own, and what the runs leave open.
#[derive(Debug, Clone, PartialEq)]
pub struct BestDraws {
    /// One row a reality, one value a parameter.
    draws: Vec<Vec<f64>>,
}

/// Confidence level of the interval of each parameter.
pub const INTERVAL_LEVEL: f64 = 0.90;
impl BestDraws {
    /// From the best point of each reality that was drawn, moved at random within its cell of `grid`, because a grid cannot
    /// say more than its step.
    pub(super) fn new<'a>(grid: &Grid, best: impl Iterator<Item = &'a [f64]>, seed: u64) -> Self {
        let mut rng = Once::WithinCell.generator(seed);
        let draws = best
            .map(|values| {
                let axes = values.iter().zip(grid.ranges());
                axes.map(|(value, range)| {
                    let moved = value + range.step() * (rng.random::<f64>() - 0.5);
                    moved.clamp(range.from, range.to)
                })
                .collect()
            })
            .collect();
        Self { draws }
    }

    /// Central interval of one parameter at `level`, e.g. 0.9.
    pub fn interval(&self, parameter: usize, level: f64) -> (f64, f64) {
        // There is at least one draw.
        let values = self.values(parameter);
        percentile_interval(&values, 0.5 * (1.0 - level)).unwrap_or((f64::NAN, f64::NAN))
    }

    /// Pearson's correlation of two parameters over the draws; 0 where one of them does not vary.
    pub fn correlation(&self, first: usize, second: usize) -> f64 {
        let (a, b) = (self.values(first), self.values(second));
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        let spread = standard_deviation(&a) * standard_deviation(&b);
        if spread == 0.0 {
            return 0.0;
        }
        let products = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b));
        products.sum::<f64>() / (a.len() - 1) as f64 / spread
    }

    fn values(&self, parameter: usize) -> Vec<f64> {
        self.draws.iter().map(|draw| draw[parameter]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_engine::parameter::by_name;
    use realgap_optimize::Range;

    fn line() -> Grid {
        let friction = by_name("floor.friction").unwrap();
        Grid::new(vec![Range::new(friction, 0.0, 1.0, 11).unwrap()]).unwrap()
    }

    #[test]
    fn realities_that_agree_give_an_interval_of_one_step() {
        let draws = BestDraws::new(&line(), [[0.4].as_slice(); 2000].into_iter(), 3);
        let (low, high) = draws.interval(0, 0.9);
        assert!(
            (low - 0.355).abs() < 0.01 && (high - 0.445).abs() < 0.01,
            "{low} {high}"
        );
    }
}
