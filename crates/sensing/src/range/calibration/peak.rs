//! Detects whether the readings at one distance have one peak or several.

use std::ops::Range;

use serde::Serialize;

use realgap_core::statistics::{median, quantile, standard_deviation};

/// A peak of the distribution of readings at one distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Peak {
    /// Median of the readings of the peak.
    pub centre: f64,
    /// Share of the readings at this distance, without outliers, that belong to the peak.
    pub share: f64,
    /// Standard deviation of the readings of the peak.
    pub sd: f64,
}

/// Smallest number of readings in which several peaks are searched for.
const LEAST: usize = 20;
/// Smallest number and share of readings of a peak; fewer readings may be outliers that agree by chance.
const LEAST_OF_PEAK: usize = 5;
const LEAST_SHARE: f64 = 0.05;
/// A peak must be higher than the valley next to it by this many standard deviations of the difference of two counts.
const CLEAR: f64 = 2.5;
/// Readings that are spread over more than this many times the half width of the narrowest peak are not a peak.
const WIDEST: f64 = 6.0;
/// Width, in standard deviations, of the narrowest interval that contains a quarter of normally distributed readings.
const QUARTER: f64 = 0.637;

/// The peaks of sorted readings, as ranges of indices in order; some readings may belong to no peak. If there are not several peaks,
/// the result is one range of all readings.
pub(super) fn peaks(sorted: &[f64], resolution: f64) -> Vec<Range<usize>> {
    let whole = 0..sorted.len();
    if sorted.len() < LEAST {
        return vec![whole];
    }
    let quarter = sorted.len() / 4;
    let narrowest = sorted
        .windows(quarter + 1)
        .map(|w| w[quarter] - w[0])
        .fold(f64::INFINITY, f64::min);
    // The half width is at least half of the resolution, so that neighbouring values of rounded readings belong to one peak.
    let half = (narrowest / QUARTER).max(0.51 * resolution);
    let counts: Vec<f64> = sorted
        .iter()
        .map(|v| {
            let (low, high) = (v - half, v + half);
            (sorted.partition_point(|w| *w <= high) - sorted.partition_point(|w| *w < low)) as f64
        })
        .collect();
    let least = LEAST_OF_PEAK.max((LEAST_SHARE * sorted.len() as f64).ceil() as usize);
    let mut parts = Vec::new();
    split(sorted, &counts, half, least, whole.clone(), &mut parts);
    parts.retain(|part| {
        let own = &sorted[part.clone()];
        quantile(own, 0.84) - quantile(own, 0.16) <= WIDEST * half
    });
    if parts.len() > 1 { parts } else { vec![whole] }
}

/// Splits a range at its clearest valley, and splits the parts in the same way.
fn split(
    sorted: &[f64],
    counts: &[f64],
    half: f64,
    least: usize,
    range: Range<usize>,
    parts: &mut Vec<Range<usize>>,
) {
    let top = range.clone().fold(
        range.start,
        |best, i| if counts[i] > counts[best] { i } else { best },
    );
    let mut best: Option<(f64, usize)> = None;
    let mut walk = |indices: &mut dyn Iterator<Item = usize>, is_right: bool| {
        // The lowest count since the top, and the first index to the right of it.
        let (mut valley, mut before) = ((counts[top], top), top);
        for i in indices {
            let border = if is_right { i } else { before };
            if (sorted[i] - sorted[before]).abs() > 2.0 * half {
                valley = (0.0, border);
            } else if counts[i] < valley.0 {
                valley = (counts[i], border);
            }
            before = i;
            let beyond = if is_right {
                range.end - valley.1
            } else {
                valley.1 - range.start
            };
            let clear = counts[i] - valley.0 - CLEAR * (counts[i] + valley.0).sqrt();
            let is_large = beyond >= least && range.len() - beyond >= least;
            if clear > 0.0 && is_large && best.is_none_or(|(most, _)| clear > most) {
                best = Some((clear, valley.1));
            }
        }
    };
    walk(&mut (top + 1..range.end), true);
    walk(&mut (range.start..top).rev(), false);
    match best {
        Some((_, border)) => {
            split(sorted, counts, half, least, range.start..border, parts);
            split(sorted, counts, half, least, border..range.end, parts);
        }
        None => parts.push(range),
    }
}

/// The peaks of readings without outliers, in order; empty if there is only one peak.
pub(super) fn described(values: &[f64], resolution: f64) -> Vec<Peak> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let parts = peaks(&sorted, resolution);
    if parts.len() < 2 {
        return Vec::new();
    }
    parts
        .into_iter()
        .map(|part| Peak {
            centre: median(&sorted[part.clone()]),
            share: part.len() as f64 / values.len() as f64,
            sd: standard_deviation(&sorted[part]),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt as _;
    use rand_distr::StandardNormal;
    use realgap_core::random::Numbered;

    fn drawn(seed: u64, of: &[(usize, f64, f64)], step: f64) -> Vec<f64> {
        let mut rng = Numbered::SensorReading.generator(seed, 0);
        let mut all = Vec::new();
        for (count, mean, sd) in of {
            for _ in 0..*count {
                let value: f64 = mean + sd * rng.sample::<f64, _>(StandardNormal);
                all.push(if step > 0.0 {
                    (value / step).round() * step
                } else {
                    value
                });
            }
        }
        all
    }

    #[test]
    fn readings_of_one_normal_distribution_are_one_peak_whether_rounded_or_not() {
        for step in [0.0, 0.2, 1.0, 3.0] {
            let several = (0..200)
                .filter(|seed| {
                    !described(&drawn(*seed, &[(200, 10.0, 1.0)], step), step).is_empty()
                })
                .count();
            assert!(several <= 4, "steps of {step}: {several} of 200");
        }
    }

    #[test]
    fn readings_of_two_normal_distributions_are_two_peaks_with_their_shares() {
        for (seed, step) in [(1, 0.0), (2, 0.5), (3, 1.0)] {
            let found = described(
                &drawn(seed, &[(140, 10.0, 0.5), (60, 14.0, 0.5)], step),
                step,
            );
            assert_eq!(found.len(), 2, "{found:?}");
            assert!((found[0].centre - 10.0).abs() < 0.2 && (found[1].centre - 14.0).abs() < 0.5);
            assert!((found[1].share - 0.3).abs() < 0.02, "{found:?}");
        }
    }
}
