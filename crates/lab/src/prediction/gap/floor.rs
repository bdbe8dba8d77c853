//! The noise floor: the distance between repeats of the same real run.

use rayon::prelude::*;
use serde::Serialize;

use super::sample::{Heard, distance};
use super::{Estimate, Sample, Scoring};
use crate::calibration::few_recordings;
use realgap_core::statistics::{Degree, standard_deviation};
use realgap_core::unit::Unit;
use realgap_core::{Code, Result, Warning};
use realgap_path::comparison::{Context, Metric};

/// The noise floor by one metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MetricFloor {
    /// Name of the metric.
    pub metric: &'static str,
    /// Unit of the values.
    pub unit: Unit,
    /// Mean distance over all pairs of different recordings.
    pub floor: Estimate,
}

/// The noise floor of one set of repeats.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Of the pairs (0, 1), (0, 2), …, (1, 2), …
    pub(super) values: Vec<f64>,
}

impl Pairs {
    pub(super) fn measure(
        metric: &dyn Metric,
        context: &Context<'_>,
        runs: &[&Sample],
    ) -> Result<(Self, Heard)> {
        let indices: Vec<(usize, usize)> = pairs_of(runs.len()).collect();
        // Collected in order, so that the bits do not depend on the threads.
        let measured: Vec<(f64, Heard)> = indices
            .into_par_iter()
            .map(|(i, j)| {
                let mut heard = Heard::default();
                let there = distance(metric, context, runs[i], runs[j], &mut heard)?;
                let value = if metric.is_symmetric() {
                    there
                } else {
                    let back = distance(metric, context, runs[j], runs[i], &mut heard)?;
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

    /// The distance of two different recordings.
    pub(super) fn of(&self, i: usize, j: usize) -> f64 {
        let (low, high) = (i.min(j), i.max(j));
        let before = low * self.recordings - low * (low + 1) / 2;
        self.values[before + high - low - 1]
    }

    fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }

    /// Variance of a pair over the square of the mean.
    fn relative_variance(&self) -> f64 {
        (standard_deviation(&self.values) / self.mean()).powi(2)
    }

    /// The mean over the pairs without one recording; `None` where no pair is left.
    pub(super) fn mean_without(&self, left_out: usize) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0);
        for ((i, j), value) in pairs_of(self.recordings).zip(&self.values) {
            if i != left_out && j != left_out {
                sum += value;
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// All pairs of different recordings, in the order of [`Pairs`].
pub(super) fn pairs_of(recordings: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..recordings).flat_map(move |i| (i + 1..recordings).map(move |j| (i, j)))
}

/// The noise floor of repeats of one real run: the mean distance of all pairs of recordings, by each metric.
///
/// The interval leaves out recordings, not pairs, because pairs that share a recording are correlated. The basis of the metric
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
        warnings.push(Code::OneRecording.warning(
            "one recording has no repeat to be compared with: there is no noise floor, and no gap ratio",
        ));
    }
    warnings.extend(few_recordings(count));
    let mut metrics = Vec::new();
    let mut all_pairs = Vec::new();
    if count >= 2 {
        let basis = scoring.basis(recordings.iter())?;
        let runs: Vec<&Sample> = recordings.iter().collect();
        let mut heard = Heard::default();
        for metric in &scoring.metrics {
            let context = scoring.context(basis.as_ref());
            let (pairs, said) = Pairs::measure(*metric, &context, &runs)?;
            heard.merge(said);
            metrics.push(MetricFloor {
                metric: metric.name(),
                unit: metric.unit(),
                floor: Estimate::new(
                    pairs.mean(),
                    (0..count).map(|i| pairs.mean_without(i)),
                    Degree::Pairs {
                        variance: pairs.relative_variance(),
                    },
                ),
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
