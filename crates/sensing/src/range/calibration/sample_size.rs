//! Estimates how many readings are needed until the histogram of readings hardly changes any more (paper 000, section 4.1).

use rand::RngExt;
use serde::Serialize;

use realgap_core::random::Once;

/// The change of the histogram for one number of readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SizeStep {
    /// Number of readings.
    pub readings: usize,
    /// Total variation distance between the histogram of this number of readings and that of an infinitely long log, averaged over
    /// random parts of the log of this size.
    pub change: f64,
}

/// The number of readings that is needed at one distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SampleSize {
    /// Distance, in the log's unit.
    pub distance: f64,
    /// Number of readings of the log at this distance.
    pub readings: usize,
    /// Width of a bin, in the reading's unit.
    pub bin: f64,
    /// The sizes that were tried.
    pub steps: Vec<SizeStep>,
    /// Largest change at which the histogram counts as stable.
    pub tolerance: f64,
    /// Number of readings from which on the histogram is stable. It may be extrapolated beyond the readings of the log, because the
    /// change is inversely proportional to the square root of the number of readings.
    pub enough: usize,
    /// Relative standard error of the standard deviation of readings at that number of readings, 1/√(2n).
    pub spread_error: f64,
}

/// The sizes of paper 000.
const SIZES: [usize; 14] = [
    10, 50, 100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1500, 2000,
];
/// Number of random parts of each size.
const PARTS: usize = 100;
/// Largest share of the log that a part may have, so that it can be compared with the whole log.
const MOST: f64 = 0.8;

/// Studies readings of one distance; `None` for fewer than 20 readings or a bin that is not positive.
///
/// The whole log of N readings contains the part of n readings. Therefore the change of the part against the whole log is smaller by
/// the factor √(1 − n/N) than its change against an infinitely long log, and it is divided by that factor.
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
    // If the log is large enough, this is the first size with a change within the tolerance; otherwise it is extrapolated.
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
