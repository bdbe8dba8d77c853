//! The gap between simulation and reality, and the gap ratio.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::floor::{self, Pairs};
use super::sample::{Heard, distance};
use super::{CaseRuns, Estimate, NoiseFloor, Sample, Scoring};
use crate::prediction::ensemble::REPEATS_TESTED;
use realgap_core::statistics::{Degree, EnergyTest, energy_test, mean};
use realgap_core::unit::Unit;
use realgap_core::{Code, Error, Result, Warning};

/// A gap, and its ratio to the noise floor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GapAndRatio {
    /// Mean distance over the recordings.
    pub gap: Estimate,
    /// Gap over noise floor, both without the same recordings; 1 means as near to a recording as another recording is. `None`
    /// without a noise floor.
    pub ratio: Option<Estimate>,
}

/// Noise floor, gap and gap ratio by one metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MetricGap {
    /// Name of the metric.
    pub metric: &'static str,
    /// Unit of floor and gaps.
    pub unit: Unit,
    /// Real against real.
    pub floor: Option<Estimate>,
    /// The run without noise against reality.
    pub ideal: Option<GapAndRatio>,
    /// Repeats under noise against reality, mean over the repeats.
    pub repeats: Option<GapAndRatio>,
    /// Energy test: whether recordings and repeats have the same distribution. A gap ratio of 1 does not show this, because
    /// repeats that are nearer to each other may be biased. `None` unless there are several of both from the same start.
    pub alike: Option<EnergyTest>,
}

/// All gaps of a set of recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Distances {
    /// Number of recordings.
    pub recordings: usize,
    /// By metric, in the order asked for.
    pub metrics: Vec<MetricGap>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Noise floor, gap and gap ratio of recordings and the simulations of their starts.
///
/// There is a noise floor where all recordings share one start. The basis of the metric `pca` is fitted on the compared paths: on
/// recordings alone for the floor, on recordings and the respective runs for a gap.
///
/// # Errors
/// No recordings, a metric that cannot compare them.
pub fn distances(real: &[Sample], cases: &[CaseRuns], scoring: &Scoring) -> Result<Distances> {
    if real.is_empty() {
        return Err(Error::invalid("a gap needs recordings to be compared with"));
    }
    let mut warnings = Vec::new();
    let (floor, pairs) = match cases {
        [_] => floor::measure(real, scoring)?,
        _ => (no_common_start(real.len()), Vec::new()),
    };
    warnings.extend(floor.warnings);
    let ideal = gaps(real, cases, scoring, "without noise", |case| {
        case.ideal.as_slice()
    })?;
    let repeats = gaps(real, cases, scoring, "repeats", |case| &case.repeats)?;
    let alike = match cases {
        [case] => alike(real, case, scoring)?,
        _ => Vec::new(),
    };
    let mut metrics = Vec::new();
    for (index, metric) in scoring.metrics.iter().enumerate() {
        let side = |of: &Option<Gaps>| {
            let gaps = &of.as_ref()?.by_metric[index];
            let value = mean(gaps);
            let total: f64 = gaps.iter().sum();
            let others = gaps.len() as f64 - 1.0;
            let without = |i: usize| (others > 0.0).then(|| (total - gaps[i]) / others);
            let at = |pairs: &Pairs, i: usize| {
                let floor = pairs.mean_without(i).filter(|floor| *floor > 0.0)?;
                Some(without(i)? / floor)
            };
            Some(GapAndRatio {
                gap: Estimate::new(value, (0..gaps.len()).map(without), Degree::Items),
                ratio: floor
                    .metrics
                    .get(index)
                    .zip(pairs.get(index))
                    .filter(|(floor, _)| floor.floor.value > 0.0)
                    .map(|(floor, pairs)| {
                        let ratios = (0..gaps.len()).map(|i| at(pairs, i));
                        Estimate::new(value / floor.floor.value, ratios, Degree::Items)
                    }),
            })
        };
        metrics.push(MetricGap {
            metric: metric.name(),
            unit: metric.unit(),
            floor: floor.metrics.get(index).map(|floor| floor.floor),
            ideal: side(&ideal),
            repeats: side(&repeats),
            alike: alike.get(index).copied(),
        });
    }
    for gaps in [ideal, repeats].into_iter().flatten() {
        warnings.extend(gaps.warnings);
    }
    Ok(Distances {
        recordings: real.len(),
        metrics,
        warnings,
    })
}

/// The energy test of recordings and repeats by each metric; empty where there are fewer than two of either.
fn alike(real: &[Sample], case: &CaseRuns, scoring: &Scoring) -> Result<Vec<EnergyTest>> {
    if real.len() < 2 || case.repeats.len() < 2 {
        return Ok(Vec::new());
    }
    let runs: Vec<&Sample> = real
        .iter()
        .chain(case.repeats.iter().take(REPEATS_TESTED))
        .collect();
    let basis = scoring.basis(runs.iter().copied())?;
    let context = scoring.context(basis.as_ref());
    scoring
        .metrics
        .iter()
        .map(|metric| {
            let (pairs, _) = Pairs::measure(*metric, &context, &runs)?;
            energy_test(&pairs.values, real.len(), scoring.seed)
        })
        .collect()
}

fn no_common_start(recordings: usize) -> NoiseFloor {
    NoiseFloor {
        recordings,
        pairs: 0,
        metrics: Vec::new(),
        warnings: vec![Code::NoRepeats.warning(
            "every recording has a start of its own, so that none repeats another: a noise floor (and a gap ratio) needs several \
             recordings of the same start",
        )],
    }
}

/// Distances to each recording, by metric.
struct Gaps {
    by_metric: Vec<Vec<f64>>,
    warnings: Vec<Warning>,
}

/// Mean distance of each recording to the runs of its start; `None` where a start has no run.
fn gaps(
    real: &[Sample],
    cases: &[CaseRuns],
    scoring: &Scoring,
    what: &str,
    runs: impl Fn(&CaseRuns) -> &[Sample] + Sync,
) -> Result<Option<Gaps>> {
    let mut case_of = vec![None; real.len()];
    for (index, case) in cases.iter().enumerate() {
        for &recording in &case.recordings {
            case_of[recording] = Some(index);
        }
    }
    let Some(case_of) = case_of
        .into_iter()
        .map(|case| case.filter(|&index| !runs(&cases[index]).is_empty()))
        .collect::<Option<Vec<usize>>>()
    else {
        return Ok(None);
    };
    let basis = scoring.basis(real.iter().chain(cases.iter().flat_map(&runs)))?;
    let context = scoring.context(basis.as_ref());
    let mut heard = Heard::default();
    let mut by_metric = Vec::new();
    for metric in &scoring.metrics {
        let measured: Vec<(f64, Heard)> = real
            .par_iter()
            .zip(&case_of)
            .map(|(recording, &case)| {
                let mut heard = Heard::default();
                let distances = runs(&cases[case])
                    .iter()
                    .map(|run| distance(*metric, &context, recording, run, &mut heard))
                    .collect::<Result<Vec<f64>>>()?;
                Ok((mean(&distances), heard))
            })
            .collect::<Result<_>>()?;
        let mut values = Vec::new();
        for (value, said) in measured {
            values.push(value);
            heard.merge(said);
        }
        by_metric.push(values);
    }
    Ok(Some(Gaps {
        by_metric,
        warnings: heard.into_warnings(what),
    }))
}
