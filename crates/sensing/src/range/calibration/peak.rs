//! Where the readings of one distance crowd: in one place, or in several.

use std::ops::Range;

use serde::Serialize;

use realgap_core::statistics::{median, quantile, standard_deviation};

/// A crowd of readings at one distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Peak {
    /// Median of its readings.
    pub centre: f64,
    /// Its share of the readings of this distance that are not nonsense.
    pub share: f64,
    /// This is the standard deviation of its readings.
    pub sd: f64,
}

/// Fewest readings that are looked at for more than one peak.
const LEAST: usize = 20;
/// Fewest readings of a peak, and their least share: fewer are nonsense that happens to agree.
const LEAST_OF_PEAK: usize = 5;
const LEAST_SHARE: f64 = 0.05;
/// A peak stands above the valley before it by so many standard deviations of the difference of two counts.
const CLEAR: f64 = 2.5;
/// A crowd this many times wider than the narrowest is spread evenly rather than crowded.
const WIDEST: f64 = 6.0;
/// The narrowest interval that holds a quarter of normal readings is this many standard deviations wide.
const QUARTER: f64 = 0.637;

/// The peaks of sorted readings, as ranges of their indices in order; readings of no peak belong to none of them. One range, that of
/// all readings, where there are no several peaks.
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
    // Neighbouring steps of a rounded reading touch: they are one peak.
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

/// Splits a range at its clearest valley, and the parts again.
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
        // The lowest count since the top, and the first index on the right side of it.
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

/// The peaks of readings that are not nonsense, in order; empty where there is only one.
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
    fn one_crowd_is_one_peak_rounded_or_not() {
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
    fn two_crowds_are_two_peaks_with_their_shares() {
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
