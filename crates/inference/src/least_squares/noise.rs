//! The noise of residuals: a variance for each channel, and the autocorrelation along each direction of the parameters.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use realgap_optimization::{ErrorBlock, robust_loss, robust_slope};

use crate::rough::rough_noise;

/// Variance of values that are rounded to steps of 1.
const ROUNDING: f64 = 1.0 / 12.0;
/// The least variance of an error in squares of its typical size: errors that are all zero show no noise, but not that there is none.
const LEAST_VARIANCE: f64 = 1e-4;
/// Mean absolute value of a normal number of standard deviation 1.
const NORMAL_MEAN: f64 = 0.797_88;
/// Errors of this share of those far from the best point are as good as none.
const NEGLIGIBLE: f64 = 0.003;
/// Autocorrelations are summed up to at most this share of a block.
const LARGEST_LAG: f64 = 0.25;
/// A log is cut into so many blocks of time, which show how parts of it disagree.
const BLOCKS: usize = 6;
/// A channel with so many series in a log is cut into windows.
const FEWEST_WINDOWS: usize = 2 * BLOCKS;

/// The noise of the errors at one point.
#[derive(Debug, Clone)]
pub(super) struct ResidualNoise {
    blocks: Vec<ErrorBlock>,
    /// Size of a typical error of each error's channel.
    scales: Vec<f64>,
    /// By error, the factor that turns its robust loss into a log-likelihood.
    likelihood: Vec<f64>,
    /// By error, the information about a parameter per squared derivative (in typical errors).
    information: Vec<f64>,
}

/// Sums over the errors of one channel, in typical errors.
#[derive(Debug, Clone, Copy, Default)]
struct ChannelSums {
    count: f64,
    /// Of the squared derivatives of the loss.
    slope_squares: f64,
    /// Of the second derivatives of the loss, and of their squares.
    curvatures: f64,
    curvature_squares: f64,
    /// Largest step of the sensor.
    step: f64,
}

impl ResidualNoise {
    /// Of these errors after a fit of so many parameters. The variance of each channel is that of a robust estimate (Huber 1981,
    /// section 7.6), at least that of the sensor's steps.
    pub fn new(errors: &[f64], scales: &[f64], blocks: &[ErrorBlock], parameters: usize) -> Self {
        let count = errors.len() as f64;
        let freedom = count / (count - parameters as f64).max(1.0);
        let channels = blocks.iter().map(|block| block.channel + 1).max();
        let mut sums = vec![ChannelSums::default(); channels.unwrap_or(0)];
        for (block, range) in ranges(blocks) {
            let sums = &mut sums[block.channel];
            for (error, scale) in errors[range.clone()].iter().zip(&scales[range]) {
                let (ratio, slope) = (error / scale, robust_slope(error / scale));
                let curvature = (1.0 + ratio * ratio).powf(-1.5);
                sums.count += 1.0;
                sums.slope_squares += slope * slope;
                sums.curvatures += curvature;
                sums.curvature_squares += curvature * curvature;
                sums.step = sums.step.max(block.resolution / scale);
            }
        }
        let of_channel = |sums: &ChannelSums| {
            let curvature = sums.curvatures / sums.count;
            let spread = sums.curvature_squares / sums.count / curvature.powi(2) - 1.0;
            let few = 1.0 + parameters as f64 / count * spread;
            let variance = freedom * sums.slope_squares / sums.count * (few / curvature).powi(2);
            let variance = variance
                .max(ROUNDING * sums.step.powi(2))
                .max(LEAST_VARIANCE);
            (1.0 / (variance * curvature), 1.0 / variance)
        };
        let channels: Vec<(f64, f64)> = sums.iter().map(of_channel).collect();
        let by_error = |of: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
            let blocks = blocks.iter();
            let values = blocks
                .flat_map(|block| std::iter::repeat_n(of(&channels[block.channel]), block.count));
            values.collect()
        };
        Self {
            blocks: blocks.to_vec(),
            scales: scales.to_vec(),
            likelihood: by_error(&|(likelihood, _)| *likelihood),
            information: by_error(&|(_, information)| *information),
        }
    }

    /// Variance of each error, as if errors were independent.
    pub fn variances(&self) -> Vec<f64> {
        let all = self.scales.iter().zip(&self.information);
        all.map(|(scale, information)| scale * scale / information)
            .collect()
    }

    /// Mean size of the errors, each in sizes of the noise that differences of the errors of its block show; 1 for normal errors
    /// without anything systematic. Noise is at least that of the sensor's steps, and a small share of `far`, the size of errors far
    /// from the best point.
    pub fn systematic(&self, errors: &[f64], far: f64) -> f64 {
        let sizes = ranges(&self.blocks).map(|(block, range)| {
            let own = &errors[range];
            let rounding = ROUNDING.sqrt() * block.resolution;
            let least = rounding.max(NEGLIGIBLE * far).max(f64::MIN_POSITIVE);
            let noise = rough_noise(own).max(least);
            own.iter().map(|error| error.abs()).sum::<f64>() / (NORMAL_MEAN * noise)
        });
        sizes.sum::<f64>() / errors.len().max(1) as f64
    }

    /// The factor by which each error is divided by its standard deviation.
    fn whitening(&self) -> impl Iterator<Item = f64> {
        let all = self.scales.iter().zip(&self.information);
        all.map(|(scale, information)| information.sqrt() / scale)
    }

    /// The factors by which errors are divided by their standard deviations.
    pub fn whitening_factors(&self) -> Vec<f64> {
        self.whitening().collect()
    }

    /// Derivatives of errors that were whitened by this noise, whitened by another.
    pub fn whitened_by(&self, other: &Self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let mut whitened = jacobian.clone();
        let factors = self.whitening().zip(other.whitening());
        for (mut row, (own, other)) in whitened.row_iter_mut().zip(factors) {
            row *= other / own;
        }
        whitened
    }

    /// Twice the negative log-likelihood of these errors, as if they were independent.
    pub fn deviance(&self, errors: &[f64]) -> f64 {
        let all = errors.iter().zip(&self.scales).zip(&self.likelihood);
        all.map(|((error, scale), factor)| 2.0 * factor * robust_loss(error / scale))
            .sum()
    }

    /// The errors, each divided by its standard deviation.
    pub fn whitened_errors(&self, errors: &[f64]) -> DVector<f64> {
        let all = errors.iter().zip(self.whitening());
        DVector::from_iterator(errors.len(), all.map(|(error, factor)| error * factor))
    }

    /// The derivatives, each divided by the standard deviation of its error.
    pub fn whitened(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let mut whitened = jacobian.clone();
        for (mut row, factor) in whitened.row_iter_mut().zip(self.whitening()) {
            row *= factor;
        }
        whitened
    }

    /// The derivative of half the deviance by every error, in whitened errors.
    pub fn slopes(&self, errors: &[f64]) -> DVector<f64> {
        let factors = self.likelihood.iter().zip(&self.information);
        let all = errors.iter().zip(&self.scales).zip(factors);
        let slopes = all.map(|((error, scale), (likelihood, information))| {
            likelihood * robust_slope(error / scale) / information.sqrt()
        });
        DVector::from_iterator(errors.len(), slopes)
    }

    /// By how much the variance of an estimate along one direction exceeds that of independent errors of equal variance. `scores` are
    /// the products of each error's slope and derivative along the direction, and `information` the sum of the squared derivatives.
    /// Autocorrelations within blocks are summed up to the first one that is not significantly positive (Geyer 1992).
    pub fn inflation(&self, scores: &DVector<f64>, information: f64) -> f64 {
        let product = |lag: usize| -> f64 {
            let blocks = ranges(&self.blocks).map(|(_, range)| {
                let own = &scores.as_slice()[range];
                let pairs = own.iter().zip(own.iter().skip(lag));
                pairs.map(|(a, b)| a * b).sum::<f64>()
            });
            blocks.sum()
        };
        let variance = product(0);
        if variance <= 0.0 || information <= 0.0 {
            return 1.0;
        }
        let longest = self.blocks.iter().map(|block| block.count).max();
        let longest = (LARGEST_LAG * longest.unwrap_or(0) as f64) as usize;
        let significant = 2.0 / (scores.len() as f64).sqrt();
        let mut sum = variance;
        for lag in 1..longest.max(1) {
            let covariance = product(lag);
            if covariance < significant * variance {
                break;
            }
            sum += 2.0 * covariance;
        }
        (sum / information).max(1.0)
    }

    /// Index ranges of the errors of each log, in order.
    pub fn logs(&self) -> Vec<Vec<Range<usize>>> {
        let logs = self.blocks.iter().map(|block| block.log + 1).max();
        let mut all = vec![Vec::new(); logs.unwrap_or(0)];
        for (block, range) in ranges(&self.blocks) {
            all[block.log].push(range);
        }
        all.retain(|ranges| !ranges.is_empty());
        all
    }

    /// Index ranges of the errors of each of some disjoint blocks of time of a log, which has this place in [`Self::logs`]: whole windows
    /// where a channel has enough of them, otherwise parts of every series.
    pub fn blocks_of_time(&self, log: usize) -> Vec<Vec<Range<usize>>> {
        let mut all = vec![Vec::new(); BLOCKS];
        for series in self.series(log) {
            let count = series.len();
            for (place, range) in series.into_iter().enumerate() {
                if count >= FEWEST_WINDOWS {
                    all[place * BLOCKS / count].push(range);
                    continue;
                }
                let at = |block: usize| range.start + block * range.len() / BLOCKS;
                (0..BLOCKS).for_each(|block| all[block].push(at(block)..at(block + 1)));
            }
        }
        all
    }

    /// The blocks of time of all logs, if all of them are cut into windows.
    pub fn blocks_of_windows(&self) -> Option<Vec<Vec<Range<usize>>>> {
        let logs = 0..self.logs().len();
        let is_cut = |log: usize| {
            self.series(log)
                .iter()
                .all(|own| own.len() >= FEWEST_WINDOWS)
        };
        logs.clone()
            .all(is_cut)
            .then(|| logs.flat_map(|log| self.blocks_of_time(log)).collect())
    }

    /// The ranges of the errors of a log, a list for each channel, in order.
    fn series(&self, log: usize) -> Vec<Vec<Range<usize>>> {
        let mut logs: Vec<usize> = self.blocks.iter().map(|block| block.log).collect();
        logs.sort_unstable();
        logs.dedup();
        let mut channels: BTreeMap<usize, Vec<Range<usize>>> = BTreeMap::new();
        for (block, range) in ranges(&self.blocks) {
            if logs.get(log) == Some(&block.log) {
                channels.entry(block.channel).or_default().push(range);
            }
        }
        channels.into_values().collect()
    }
}

/// Each block with the range of its errors.
fn ranges(blocks: &[ErrorBlock]) -> impl Iterator<Item = (&ErrorBlock, Range<usize>)> {
    blocks.iter().scan(0, |first, block| {
        let range = *first..*first + block.count;
        *first = range.end;
        Some((block, range))
    })
}
