//! How many readings until the histogram stops changing (paper 000, section 4.1)?

use rand::RngExt;
use serde::Serialize;

use realgap_core::random::Once;

/// How much the histogram of a log of some size still changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SizeStep {
    /// Readings.
    pub readings: usize,
    /// Share of readings that lie in another bin than in an endless log: the total variation distance between the two histograms,
    /// mean over random parts of the log of this size.
    pub change: f64,
}

/// The study of one distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleSize {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Readings there.
    pub readings: usize,
    /// Width of a bin, in the reading's unit.
    pub bin: f64,
    /// The sizes that were tried.
    pub steps: Vec<SizeStep>,
    /// The histogram counts as stopped below this change.
    pub tolerance: f64,
    /// Readings from which on it is (the change falls with the root of the readings); may be more than the log has.
    pub enough: usize,
    /// Relative standard error of the spread at that size, 1/√(2n).
    pub spread_error: f64,
}

/// The sizes of paper 000.
const SIZES: [usize; 14] = [
    10, 50, 100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1500, 2000,
];
/// Random parts of each size.
const PARTS: usize = 100;
/// A part must leave this share of the log to be compared with.
const MOST: f64 = 0.8;

/// Studies readings of one distance; `None` for fewer than 20 readings or a bin that is not positive.
///
/// The change of a part of n of the log's N readings against the whole log is that against an endless log times √(1 − n/N), since
/// the whole contains the part; it is divided by that.
pub(super) fn study(
    distance: f64,
    values: &[f64],
    bin: f64,
    tolerance: f64,
    seed: u64,
) -> Option<SampleSize> {
    let total = values.len();
    if total < 20 || !(bin > 0.0 && bin.is_finite()) {
        return None;
    }
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let places: Vec<usize> = values
        .iter()
        .map(|v| ((v - low) / bin).min(1e5) as usize)
        .collect();
    let bins = places.iter().max().map_or(1, |last| last + 1);
    let histogram = |places: &[usize]| {
        let mut shares = vec![0.0; bins];
        for place in places {
            shares[*place] += 1.0 / places.len() as f64;
        }
        shares
    };
    let whole = histogram(&places);
    let mut rng = Once::Subset.generator(seed);
    let mut order = places.clone();
    let sizes = SIZES
        .iter()
        .copied()
        .filter(|size| *size as f64 <= MOST * total as f64);
    let steps: Vec<SizeStep> = sizes
        .map(|readings| {
            let mut sum = 0.0;
            for _ in 0..PARTS {
                for place in 0..readings {
                    let with = rng.random_range(place..total);
                    order.swap(place, with);
                }
                let part = histogram(&order[..readings]);
                sum += 0.5
                    * part
                        .iter()
                        .zip(&whole)
                        .map(|(a, b)| (a - b).abs())
                        .sum::<f64>();
            }
            let share = readings as f64 / total as f64;
            SizeStep {
                readings,
                change: sum / PARTS as f64 / (1.0 - share).sqrt(),
            }
        })
        .collect();
    let last = steps.last()?;
    // Where the log itself is large enough, the first size that is; else by the root.
    let enough = match steps.iter().find(|step| step.change <= tolerance) {
        Some(step) => step.readings,
        None => (last.readings as f64 * (last.change / tolerance).powi(2)).ceil() as usize,
    };
    Some(SampleSize {
        distance,
        readings: total,
        bin,
        steps,
        tolerance,
        enough,
        spread_error: 1.0 / (2.0 * enough as f64).sqrt(),
    })
}
