//! Does the model explain the recordings at all? Judged before its numbers.

use std::fmt;

use serde::Serialize;

use super::score::{PointScore, Scores};
use super::study::Study;
use crate::prediction::ensemble::rms_m;
use realgap_core::error::Result;
use realgap_core::statistics::{energy_test, mean};
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};
use realgap_path::trajectory::Prepared;

/// The best point's runs against the recordings, both against what repeats differ by; distances are those of the metric `rms`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// Mean distance of the best point's runs to the recordings, in noise floors: mean distances between recordings of the same
    /// run.
    pub noise_floors: f64,
    /// How likely the runs are as unlike the recordings if both are drawn alike (energy test; Székely & Rizzo 2013); `None` for
    /// fewer than three recordings.
    pub p_value: Option<f64>,
    /// False where the recordings are farther from the runs than from each other and than any run is from the others, and chance
    /// does not explain it: no parameters of this model explain these recordings.
    pub explains: bool,
    /// Variance of the model's discrepancy in those of a recording, which widens the intervals; 0 where the model explains the
    /// recordings.
    pub discrepancy: f64,
}

/// Below this probability chance does not explain what parts runs and recordings.
const SIGNIFICANT: f64 = 0.05;
/// Fewer recordings than this cannot be told from anything.
const LEAST: usize = 3;

impl Fit {
    /// `None` without a best point, for fewer than two recordings of one start, or for recordings that do not differ.
    ///
    /// # Errors
    /// Paths that cannot be compared.
    pub(super) fn new(study: &Study, scores: &Scores) -> Result<Option<Self>> {
        let real = study.part_of(&study.real_paths(), false);
        let Some(best) = scores.best.map(|best| &scores.points[best]) else {
            return Ok(None);
        };
        if study.cases().len() != 1 || real.len() < 2 {
            return Ok(None);
        }
        let path = |run: &PointScore| Prepared::from_xy_m(run.path_xy_m.clone());
        let runs = scores.runs_at(&best.values).map(path);
        let runs = runs.collect::<Result<Vec<_>>>()?;
        let all: Vec<&Prepared> = real.iter().copied().chain(&runs).collect();
        let pairs = || (0..all.len()).flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)));
        let distances: Vec<f64> = pairs().map(|(i, j)| rms_m(all[i], all[j])).collect();
        // Within the recordings, across, within the runs.
        let over = |kind: usize, power: i32| {
            let kinds =
                pairs().map(|(i, j)| usize::from(i >= real.len()) + usize::from(j >= real.len()));
            let chosen = kinds.zip(&distances).filter(|(k, _)| *k == kind);
            mean(&chosen.map(|(_, d)| d.powi(power)).collect::<Vec<f64>>())
        };
        let floor_m = over(0, 1);
        if floor_m <= 0.0 || runs.is_empty() {
            return Ok(None);
        }
        let noise_floors = over(1, 1) / floor_m;
        let p_value = match real.len() >= LEAST && runs.len() > 1 {
            true => Some(energy_test(&distances, real.len(), study.definition().seed)?.p_value),
            false => None,
        };
        // Reality has one setting of its own: it may lie as far from the others as any of them does.
        let from_runs = |member: usize| {
            let others = (real.len()..all.len()).filter(|run| *run != member);
            mean(
                &others
                    .map(|run| rms_m(all[member], all[run]))
                    .collect::<Vec<f64>>(),
            )
        };
        let farthest_run = (real.len()..all.len()).map(from_runs).fold(0.0, f64::max);
        let explains = noise_floors <= 1.0
            || p_value.is_none_or(|p| p >= SIGNIFICANT)
            || over(1, 1) <= farthest_run;
        let within = over(0, 2);
        let excess = over(1, 2) - 0.5 * within - 0.5 * over(2, 2);
        Ok(Some(Self {
            noise_floors,
            p_value,
            explains,
            discrepancy: match explains {
                true => 0.0,
                false => (excess / (0.5 * within)).max(0.0),
            },
        }))
    }

    /// A warning where nothing explains the recordings.
    pub(super) fn warning(&self) -> Option<Warning> {
        (!self.explains).then(|| Warning::new(Code::ModelContradicted, self.to_string()))
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the best is {} noise floors away",
            number(self.noise_floors)
        )?;
        if let Some(p) = self.p_value {
            write!(f, "; drawn alike? p = {} (energy test)", number(p))?;
        }
        if !self.explains {
            f.write_str(
                ": NO PARAMETERS OF THIS MODEL EXPLAIN THESE RECORDINGS; intervals are widened by what is left",
            )?;
        }
        Ok(())
    }
}
