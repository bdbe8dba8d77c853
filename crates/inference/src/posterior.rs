//! Draws from the posterior distribution of the parameters, with intervals and correlations.

use realgap_core::statistics::{mean, percentile_interval, standard_deviation};

/// Confidence level of the interval of each parameter.
pub const INTERVAL_LEVEL: f64 = 0.90;
/// Confidence level of the interval beyond which values do not fit as well.
pub const POSSIBLE_LEVEL: f64 = 0.99;

/// Parameter values drawn from their posterior distribution; all draws have the same weight.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriorDraws {
    /// One row a draw, one value a parameter.
    draws: Vec<Vec<f64>>,
    /// By parameter: the middle of each rejected part of its range that lies between two parts that are not rejected.
    gaps: Vec<Vec<f64>>,
}

impl PosteriorDraws {
    /// From draws, one row each, and by parameter the middle of each rejected part of its range.
    pub fn new(draws: Vec<Vec<f64>>, gaps: Vec<Vec<f64>>) -> Self {
        Self { draws, gaps }
    }

    /// The draws, one row each, one value a parameter.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.draws
    }

    /// Central interval of one parameter at `level`, e.g. 0.9; a rejected part inside of it is not cut out.
    pub fn interval(&self, parameter: usize, level: f64) -> (f64, f64) {
        // There is at least one draw.
        let values = self.values(parameter);
        percentile_interval(&values, 0.5 * (1.0 - level)).unwrap_or((f64::NAN, f64::NAN))
    }

    /// Central intervals of one parameter at `level`, one for each part of its range between rejected parts, increasing.
    pub fn intervals(&self, parameter: usize, level: f64) -> Vec<(f64, f64)> {
        let values = self.values(parameter);
        let mut intervals = Vec::new();
        let mut from = f64::NEG_INFINITY;
        for to in self.gaps[parameter].iter().copied().chain([f64::INFINITY]) {
            let within = values.iter().copied().filter(|v| (from..to).contains(v));
            let within: Vec<f64> = within.collect();
            // A part with fewer draws than a tail of the whole interval leaves out gets no interval.
            if within.len() as f64 > 0.5 * (1.0 - level) * values.len() as f64 {
                intervals.extend(percentile_interval(&within, 0.5 * (1.0 - level)));
            }
            from = to;
        }
        match intervals.len() {
            // What lies beyond a rejected part is then a part of a tail.
            1 => vec![self.interval(parameter, level)],
            _ => intervals,
        }
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

    fn draws(values: impl Iterator<Item = f64>, gaps: Vec<f64>) -> PosteriorDraws {
        PosteriorDraws::new(values.map(|value| vec![value]).collect(), vec![gaps])
    }

    #[test]
    fn a_part_with_fewer_draws_than_a_tail_leaves_the_interval_a_quantile_of_all_draws() {
        let values = (0..1000).map(|n| {
            if n < 20 {
                0.1
            } else {
                0.5 + 1e-4 * f64::from(n)
            }
        });
        let parted = draws(values, vec![0.3]);
        let [one] = parted.intervals(0, 0.9)[..] else {
            panic!("{:?}", parted.intervals(0, 0.9));
        };
        assert_eq!(one, parted.interval(0, 0.9));
        assert!(one.0 > 0.5, "{one:?}");
    }

    #[test]
    fn two_parts_with_many_draws_have_an_interval_each() {
        let values = (0..1000).map(|n| 1e-4 * f64::from(n) + if n < 500 { 0.0 } else { 0.8 });
        let parts = draws(values, vec![0.5]).intervals(0, 0.9);
        let [(_, low), (high, _)] = parts[..] else {
            panic!("{parts:?}");
        };
        assert!(low < 0.05 && high > 0.85, "{parts:?}");
    }
}
