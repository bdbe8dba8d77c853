//! The noise floor: how far repeats of the same real run are from each other.

use rayon::prelude::*;
use serde::Serialize;

use super::estimate::{Estimate, RESAMPLES};
use super::sample::{Heard, Sample, Scoring, distance};
use crate::comparison::{Context, Metric};
use crate::error::Result;
use crate::statistics::{Resample, resamples};
use crate::unit::{Unit, as_label};
use crate::warning::{Code, Warning};

/// Below this many recordings an interval over them is a guess.
const FEW_RECORDINGS: usize = 5;

/// The noise floor by one metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MetricFloor {
    /// Name of the metric.
    pub metric: &'static str,
    /// Unit of the values.
    #[serde(serialize_with = "as_label")]
    pub unit: Unit,
    /// Mean distance over all pairs of different recordings.
    pub floor: Estimate,
}

/// The noise floor of one set of repeats.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Number of recordings.
    pub recordings: usize,
    /// Number of pairs of different recordings.
    pub pairs: usize,
    /// The floor by metric; empty for fewer than two recordings.
    pub metrics: Vec<MetricFloor>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Distances of all pairs of different recordings by one metric.
#[derive(Debug)]
pub(super) struct Pairs {
    recordings: usize,
    /// Of (0, 1), (0, 2), …, (1, 2), …
    values: Vec<f64>,
}

impl Pairs {
    fn measure(
        metric: &dyn Metric,
        context: &Context<'_>,
        runs: &[Sample],
    ) -> Result<(Self, Heard)> {
        let indices: Vec<(usize, usize)> = pairs_of(runs.len()).collect();
        // Collected in order, so that the bits do not depend on the threads.
        let measured: Vec<(f64, Heard)> = indices
            .into_par_iter()
            .map(|(i, j)| {
                let mut heard = Heard::default();
                let there = distance(metric, context, &runs[i], &runs[j], &mut heard)?;
                let value = if metric.is_symmetric() {
                    there
                } else {
                    let back = distance(metric, context, &runs[j], &runs[i], &mut heard)?;
                    0.5 * (there + back)
                };
                Ok((value, heard))
            })
            .collect::<Result<_>>()?;
        let mut all = Heard::default();
        let values = measured
            .into_iter()
            .map(|(value, heard)| {
                all.merge(heard);
                value
            })
            .collect();
        let recordings = runs.len();
        Ok((Self { recordings, values }, all))
    }

    fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// The mean over the pairs of a resample. A recording that was drawn twice is no pair with itself: its distance 0 says
    /// nothing about repeats. `None` where one recording was drawn every time.
    pub(super) fn mean_of(&self, resample: &Resample) -> Option<f64> {
        let weights = resample.weights();
        let (mut sum, mut total) = (0.0, 0.0);
        for ((i, j), value) in pairs_of(self.recordings).zip(&self.values) {
            let weight = weights[i] * weights[j];
            sum += weight * value;
            total += weight;
        }
        (total > 0.0).then(|| sum / total)
    }
}

fn pairs_of(recordings: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..recordings).flat_map(move |i| (i + 1..recordings).map(move |j| (i, j)))
}

/// The noise floor of repeats of one real run: real against real, all pairs, by each metric.
///
/// The interval resamples recordings, not pairs: pairs that share a recording go up and down together. The basis of the metric
/// `pca` is that of the recordings alone, so that the floor does not depend on any simulation.
///
/// # Errors
/// A metric that cannot compare the recordings.
pub fn noise_floor(recordings: &[Sample], scoring: &Scoring) -> Result<NoiseFloor> {
    measure(recordings, scoring).map(|(floor, _)| floor)
}

/// The floor, and the pairs behind it by metric.
pub(super) fn measure(
    recordings: &[Sample],
    scoring: &Scoring,
) -> Result<(NoiseFloor, Vec<Pairs>)> {
    let mut warnings = Vec::new();
    let count = recordings.len();
    if count < 2 {
        warnings.push(Warning::new(
            Code::OneRecording,
            "one recording has no repeat to be compared with: there is no noise floor, and no gap ratio",
        ));
    } else if count < FEW_RECORDINGS {
        warnings.push(Warning::new(
            Code::FewRecordings,
            format!("intervals over {count} recordings are guesses; {FEW_RECORDINGS} are the least, 20 are better"),
        ));
    }
    let mut metrics = Vec::new();
    let mut all_pairs = Vec::new();
    if count >= 2 {
        let basis = scoring.basis(recordings.iter())?;
        let draws = resamples(count, RESAMPLES, scoring.seed);
        let mut heard = Heard::default();
        for metric in &scoring.metrics {
            let context = scoring.context(basis.as_ref());
            let (pairs, said) = Pairs::measure(*metric, &context, recordings)?;
            heard.merge(said);
            metrics.push(MetricFloor {
                metric: metric.name(),
                unit: metric.unit(),
                floor: Estimate::new(pairs.mean(), &draws, |draw| pairs.mean_of(draw)),
            });
            all_pairs.push(pairs);
        }
        warnings.extend(heard.into_warnings("real against real"));
    }
    let floor = NoiseFloor {
        recordings: count,
        pairs: count * count.saturating_sub(1) / 2,
        metrics,
        warnings,
    };
    Ok((floor, all_pairs))
}
