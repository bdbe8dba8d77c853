//! Where the best point lies when reality is sampled again: intervals and correlations.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::optimization::Grid;
use crate::random::Once;
use crate::statistics::{mean, percentile_interval, resamples, standard_deviation};

/// Best parameter values of many resamples of the recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct BestDraws {
    /// One row a resample, one value a parameter.
    draws: Vec<Vec<f64>>,
}

/// Confidence level of the interval of each parameter.
pub const INTERVAL_LEVEL: f64 = 0.90;
/// Resamples.
const DRAWS: usize = 2000;

/// A point with its score against each recording.
#[derive(Debug, Clone, Copy)]
pub struct ScoredPoint<'a> {
    /// Parameter values.
    pub values: &'a [f64],
    /// One score a recording.
    pub recordings: &'a [f64],
}

impl BestDraws {
    /// Bootstrap of the argmin (Efron & Tibshirani 1993, chapter 13).
    ///
    /// Each draw resamples the recordings, lets every point's score vary by `simulation_sd` as an equally valid start and
    /// timestep would, and takes the best point. Points are first thinned to the best of each cell of `grid`: an optimizer
    /// crowds around its favourite, and a crowd would win by its number. The winner is then moved at random within its
    /// cell, because a grid cannot say more than its step.
    ///
    /// `None` where no point has a score.
    pub fn new(
        grid: &Grid,
        points: &[ScoredPoint<'_>],
        simulation_sd: f64,
        seed: u64,
    ) -> Option<Self> {
        let cells = thin(grid, points);
        let recordings = cells.first()?.recordings.len();
        let mut rng = Once::BestPoint.generator(seed);
        let draws = resamples(recordings, DRAWS, seed)
            .iter()
            .map(|resample| {
                let mut best = (f64::INFINITY, 0);
                for (index, cell) in cells.iter().enumerate() {
                    let noise: f64 = StandardNormal.sample(&mut rng);
                    let score = resample.mean(cell.recordings) + simulation_sd * noise;
                    if score < best.0 {
                        best = (score, index);
                    }
                }
                let within = cells[best.1].values.iter().zip(grid.ranges());
                within
                    .map(|(value, range)| {
                        let moved = value + range.step() * (rng.random::<f64>() - 0.5);
                        moved.clamp(range.from, range.to)
                    })
                    .collect()
            })
            .collect();
        Some(Self { draws })
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

/// The best point of each cell of the grid, in the order of the cells.
fn thin<'a>(grid: &Grid, points: &[ScoredPoint<'a>]) -> Vec<ScoredPoint<'a>> {
    let mut cells: std::collections::BTreeMap<Vec<usize>, ScoredPoint<'a>> = Default::default();
    for point in points {
        let coordinates: Vec<usize> = grid
            .ranges()
            .iter()
            .zip(point.values)
            .map(|(range, value)| range.nearest(*value))
            .collect();
        cells
            .entry(coordinates)
            .and_modify(|known| {
                if mean(point.recordings) < mean(known.recordings) {
                    *known = *point;
                }
            })
            .or_insert(*point);
    }
    cells.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimization::Range;
    use crate::simulation::parameter::by_name;

    fn line() -> Grid {
        let friction = by_name("floor.friction").unwrap();
        Grid::new(vec![Range::new(friction, 0.0, 1.0, 11).unwrap()]).unwrap()
    }

    #[test]
    fn recordings_that_agree_give_an_interval_of_one_step() {
        let grid = line();
        let values: Vec<Vec<f64>> = grid.ranges()[0].values().iter().map(|v| vec![*v]).collect();
        let scores: Vec<Vec<f64>> = values.iter().map(|v| vec![(v[0] - 0.4).abs(); 5]).collect();
        let points: Vec<ScoredPoint<'_>> = values
            .iter()
            .zip(&scores)
            .map(|(values, recordings)| ScoredPoint { values, recordings })
            .collect();
        let draws = BestDraws::new(&grid, &points, 0.0, 3).unwrap();
        let (low, high) = draws.interval(0, 0.9);
        assert!(
            (low - 0.355).abs() < 0.01 && (high - 0.445).abs() < 0.01,
            "{low} {high}"
        );
        let wide = BestDraws::new(&grid, &points, 0.3, 3)
            .unwrap()
            .interval(0, 0.9);
        assert!(wide.1 - wide.0 > 0.3, "{wide:?}");
    }

    #[test]
    fn a_crowd_of_points_does_not_win_by_its_number() {
        let grid = line();
        // Two equally good places; one of them visited once, the other two hundred times.
        let values: Vec<Vec<f64>> = (0..201)
            .map(|i| {
                vec![if i == 0 {
                    0.2
                } else {
                    0.8 + 1e-5 * f64::from(i)
                }]
            })
            .collect();
        let scores = vec![vec![1.0, 1.0]; 201];
        let points: Vec<ScoredPoint<'_>> = values
            .iter()
            .zip(&scores)
            .map(|(values, recordings)| ScoredPoint { values, recordings })
            .collect();
        let (low, high) = BestDraws::new(&grid, &points, 0.1, 5)
            .unwrap()
            .interval(0, 0.9);
        assert!(low < 0.25 && high > 0.75, "{low} {high}");
    }
}
