//! Comparison of an ensemble with recorded paths: whether its regions hold as many recordings as they state.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Ensemble, Forecast, LEVELS};
use crate::claim::{self, Claim, Conclusion};
use realgap_core::Result;
use realgap_core::statistics::{EnergyTest, Proportion, energy_test, mean_of};
use realgap_path::trajectory::{Prepared, rms_m};

/// Confidence level of the coverages' intervals.
const INTERVAL: f64 = 0.95;

/// One recorded run against the ensemble.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RealRun {
    /// Name of the recording.
    pub recording: String,
    /// Net displacement, metres.
    pub net_displacement_m: f64,
    /// Name of the behaviour that it shows: the one whose repeats are nearest on average. `None` where even these are farther
    /// away than behaviours are from each other, so that no such behaviour was predicted.
    pub behaviour: Option<String>,
    /// Mean RMS distance to the repeats of the nearest behaviour, metres.
    pub distance_m: f64,
    /// Share of the time that its position lies in the central region, by level.
    pub time_inside: [f64; 3],
    /// Whether its last position lies in the central region, by level.
    pub ends_inside: [bool; 3],
    /// Whether its whole path lies in the band for whole paths, by level; `None` without one.
    pub in_band: Option<[bool; 3]>,
    /// Energy score of the ensemble for this run, metres; lower is better.
    pub energy_score_m: f64,
}

/// How often reality lies in a central region that should hold it with probability `level`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// Stated probability of the region.
    pub level: f64,
    /// Share of the time, mean over the runs.
    pub over_time: f64,
    /// Runs that end in it, with the 95 % Wilson interval.
    pub at_end: Proportion,
    /// Whether `level` lies in that interval and in that of whole paths, so that the runs contradict neither statement.
    pub is_honest: bool,
    /// Runs that stay in the band for whole paths, with the 95 % Wilson interval; `None` without one.
    pub whole_path: Option<Proportion>,
}

/// An ensemble against recorded runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reality {
    /// Coverage at each of [`LEVELS`].
    pub coverage: Vec<Coverage>,
    /// Mean energy score (Gneiting & Raftery 2007, section 4.3), metres: E‖X − y‖ − ½ E‖X − X′‖ with X, X′ repeats, y
    /// reality and ‖·‖ the RMS distance of prepared paths.
    pub energy_score_m: f64,
    /// The score that reality would get on average if it were one more repeat: ½ E‖X − X′‖, metres.
    pub expected_energy_score_m: f64,
    /// Energy test of the RMS distances: whether recordings and repeats have the same distribution; `None` without several
    /// recordings of one start.
    pub alike: Option<EnergyTest>,
    /// The runs.
    pub runs: Vec<RealRun>,
}

/// Most repeats that take part in the energy test, which needs the distances of all pairs.
pub(in crate::prediction) const REPEATS_TESTED: usize = 400;

impl Coverage {
    /// The claim about the region.
    pub fn claim(&self) -> Claim {
        claim::region(self.level, &self.at_end, self.whole_path.as_ref())
    }
}

impl Reality {
    /// Compares an ensemble and its forecast with named prepared recordings, in true lengths; `None` without recordings or
    /// repeats.
    ///
    /// # Errors
    /// Distances that are not finite.
    pub fn new(
        ensemble: &Ensemble,
        forecast: &Forecast,
        real: &[(&str, &Prepared)],
    ) -> Result<Option<Self>> {
        let repeats = ensemble
            .motions()
            .map(|(repeat, m)| (repeat.number, &m.path));
        let repeats: Vec<(u64, &Prepared)> = repeats.collect();
        let Some(envelope) = forecast.envelope.as_ref().filter(|_| !real.is_empty()) else {
            return Ok(None);
        };
        let behaviours = &forecast.behaviours;
        let paths: Vec<&Prepared> = repeats.iter().map(|(_, path)| *path).collect();
        let half_spread_m = 0.5 * mean_distance_m(&paths);
        let runs: Vec<RealRun> = real
            .par_iter()
            .map(|(name, path)| {
                let distances_m = repeats.iter().map(|(n, repeat)| (*n, rms_m(repeat, path)));
                let distances_m: Vec<(u64, f64)> = distances_m.collect();
                let nearest = behaviours.nearest(&distances_m);

                let distance_m = nearest.map_or(f64::NAN, |(distance_m, _)| distance_m);
                let last = path.xy_m().len() - 1;
                RealRun {
                    recording: (*name).to_owned(),
                    net_displacement_m: path.net_displacement_m(),
                    behaviour: nearest
                        .filter(|(distance_m, _)| *distance_m <= behaviours.cut_m)
                        .map(|(_, index)| behaviours.list[index].name.clone()),
                    distance_m,
                    time_inside: std::array::from_fn(|level| {
                        let inside = envelope.inside(level, &[path]);
                        inside.iter().sum::<usize>() as f64 / inside.len() as f64
                    }),
                    ends_inside: std::array::from_fn(|level| {
                        envelope.regions[last].contains(level, path.xy_m()[last])
                    }),
                    in_band: (forecast.band.as_ref())
                        .map(|band| std::array::from_fn(|level| band.holds(level, path))),
                    energy_score_m: mean_of(distances_m.iter().map(|(_, d)| *d)) - half_spread_m,
                }
            })
            .collect();
        let tested = repeats.iter().take(REPEATS_TESTED).map(|(_, path)| *path);
        let all: Vec<&Prepared> = real.iter().map(|(_, path)| *path).chain(tested).collect();
        let alike = match real.len() > 1 && repeats.len() > 1 {
            true => Some(energy_test(&pairs_m(&all), real.len(), ensemble.seed)?),
            false => None,
        };
        Ok(Some(Self::of_runs(runs, half_spread_m, alike)))
    }

    /// The comparisons of recorded runs with their own ensembles, put together; `None` for none.
    pub fn pooled(parts: &[&Self]) -> Option<Self> {
        if parts.is_empty() {
            return None;
        }
        let runs: Vec<RealRun> = parts.iter().flat_map(|part| part.runs.clone()).collect();
        let of_part = |part: &&Self| vec![part.expected_energy_score_m; part.runs.len()];
        let expected = mean_of(parts.iter().flat_map(of_part));
        let alike = match parts {
            [only] => only.alike,
            _ => None,
        };
        Some(Self::of_runs(runs, expected, alike))
    }

    fn of_runs(
        runs: Vec<RealRun>,
        expected_energy_score_m: f64,
        alike: Option<EnergyTest>,
    ) -> Self {
        let coverage = LEVELS
            .iter()
            .enumerate()
            .map(|(index, &level)| {
                let at_end =
                    Proportion::of(runs.iter().map(|run| run.ends_inside[index]), INTERVAL);
                let in_band = runs.iter().map(|run| Some(run.in_band?[index]));
                let in_band: Option<Vec<bool>> = in_band.collect();
                let whole_path = in_band.map(|held| Proportion::of(held, INTERVAL));
                let claim = claim::region(level, &at_end, whole_path.as_ref());
                Coverage {
                    is_honest: claim.conclusion == Conclusion::Supported,
                    whole_path,
                    level,
                    over_time: mean_of(runs.iter().map(|run| run.time_inside[index])),
                    at_end,
                }
            })
            .collect();

        Self {
            coverage,
            energy_score_m: mean_of(runs.iter().map(|run| run.energy_score_m)),
            expected_energy_score_m,
            alike,
            runs,
        }
    }

    /// How many runs show the behaviour of this name; `None` counts those that show none.
    pub fn showing(&self, behaviour: Option<&str>) -> usize {
        let shown = self.runs.iter().map(|run| run.behaviour.as_deref());
        shown.filter(|shown| *shown == behaviour).count()
    }
}

/// Distances of all pairs, metres: (0, 1), (0, 2), …, (1, 2), ….
fn pairs_m(paths: &[&Prepared]) -> Vec<f64> {
    let of = |i: usize| (i + 1..paths.len()).map(move |j| rms_m(paths[i], paths[j]));
    (0..paths.len()).flat_map(of).collect()
}

/// Mean distance over all pairs of different paths, metres; 0 for one.
pub(crate) fn mean_distance_m(paths: &[&Prepared]) -> f64 {
    let n = paths.len();
    if n < 2 {
        return 0.0;
    }
    // Summed in order, so that the bits do not depend on the threads.
    let sums: Vec<f64> = (0..n)
        .into_par_iter()
        .map(|i| (i + 1..n).map(|j| rms_m(paths[i], paths[j])).sum())
        .collect();
    2.0 * sums.iter().sum::<f64>() / (n * (n - 1)) as f64
}
