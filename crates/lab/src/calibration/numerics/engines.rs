//! The answer of a study of two engines, seen by each engine: how well it explains the recordings, whether it rejects the best
//! point, and which point it prefers.

use std::collections::BTreeMap;

use crate::calibration::exploration::wave::{next_trial, scored_runs, simulated};
use crate::calibration::numerics::setting::Setting;
use crate::calibration::{PointScore, Scores, Study, by_name};
use crate::prediction::ensemble::{mean_distance_m, rms_m};
use realgap_core::Result;
use realgap_core::statistics::{least_by, mean_of, mean_of_any};
use realgap_inference::{
    Emulator, ObservationUncertainty, ScoreCovariance, implausibility, variant_probabilities,
};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::Prepared;

/// Runs that are farther from the recordings than so many noise floors do not explain them.
const NEAR_FLOORS: f64 = 2.0;

/// The view of one engine on the answer of both.
#[derive(Debug, Clone, PartialEq)]
pub struct EnginePreference {
    /// Name of the engine.
    pub engine: &'static str,
    /// Posterior probability of this engine, when both are equally probable beforehand. The posterior of the parameters is the
    /// mixture of both engines' posteriors with these weights.
    pub weight: f64,
    /// False where the recordings speak against this engine beside the other one. The best point is then the other engine's, and
    /// its score the mean over the other engine's settings.
    pub explains: bool,
    /// Mean score of the engine's settings at the common best point, in the metric's unit.
    pub score: f64,
    /// Number of these settings.
    pub settings: usize,
    /// The point with the lowest expected score in this engine alone, among all simulated points.
    pub parameters: BTreeMap<String, f64>,
    /// The expected score of that point.
    pub expected: f64,
    /// Implausibility of the common best point in this engine: by how many standard deviations of everything uncertain another
    /// point scores better.
    pub implausibility: f64,
    /// Largest implausibility of a point that the engine does not reject.
    pub limit: f64,
}

impl EnginePreference {
    /// Whether the engine does not reject the common best point.
    pub fn allows(&self) -> bool {
        self.implausibility <= self.limit
    }
}

/// The recordings speak against an engine whose posterior probability is lower than this: odds of 19 to 1, at the border of what
/// is called strong evidence (Kass & Raftery 1995).
const REJECTED: f64 = 0.05;
/// How often the best point of each engine is looked for, each time with the runs of the time before.
const LOOKS: usize = 2;

/// The code of the engine that alone explains the recordings by these probabilities; 0 where both do, or where there is one engine
/// only.
pub(in crate::calibration) fn explaining_engine(weights: &[f64]) -> f64 {
    match weights {
        [_, second] if *second < REJECTED => 1.0,
        [own, _] if *own < REJECTED => -1.0,
        _ => 0.0,
    }
}

/// The weights of the engines in the posterior: their probabilities, or all of it for the one that alone explains.
pub(in crate::calibration) fn posterior_weights(weights: &[f64]) -> Vec<f64> {
    match explaining_engine(weights) {
        0.0 => weights.to_vec(),
        engine => ENGINES
            .map(|own| f64::from(u8::from(own == engine)))
            .to_vec(),
    }
}

/// The codes of the two engines, as
/// [`Settings::engine_of_trial`](crate::calibration::numerics::setting::Settings::engine_of_trial) gives them.
const ENGINES: [f64; 2] = [1.0, -1.0];
/// Points that the common best point is compared with: those with the lowest expected scores in the engine.
const COMPARED: usize = 200;

impl Study {
    /// Name of the engine with this code; `None` where there is one engine only.
    pub(in crate::calibration) fn engine_named(&self, engine: f64) -> Option<&'static str> {
        let second = self.settings().second?;
        let own = self.cases()[0].experiment.engine();
        Some(if engine < 0.0 { second.get() } else { own }.name())
    }

    /// The scores with all settings of each engine at its own best point, and the probability of each engine; one of 1 where there
    /// is one engine only. The point is looked for again once these runs are known.
    ///
    /// # Errors
    /// As [`Study::simulate`].
    pub(in crate::calibration) fn with_engines_weighed(
        &self,
        run: &RunOptions<'_>,
        mut scores: Scores,
        mut emulator: Emulator,
    ) -> Result<(Scores, Emulator, Vec<f64>)> {
        if !emulator.has_two_variants() {
            return Ok((scores, emulator, vec![1.0]));
        }
        let settings = self.settings();
        for _ in 0..LOOKS {
            let from = next_trial(self, &scores);
            let mut missing = Vec::new();
            for engine in ENGINES {
                let Some(best) = self.best_in(&scores, &emulator, engine) else {
                    continue;
                };
                let values = &scores.points[best].values;
                let there = scores.runs.iter().filter(|run| run.values == *values);
                let seen: Vec<Setting> = there.map(|run| settings.of_trial(run.index)).collect();
                let own = (0..settings.count).filter(|number| {
                    settings.engine_of_trial(from + number) == engine
                        && !seen.contains(&Setting::new(*number))
                });
                missing.extend(own.map(|number| (from + number, values.clone())));
            }
            if missing.is_empty() {
                break;
            }
            let step = run.step("comparing the engines", missing.len());
            scores = scores.with_more(self, &simulated(self, missing, &step)?)?;
            emulator = emulator.conditioned_on(&scored_runs(self, &scores));
        }
        // The best point of an engine is the lowest mean over all of its settings, never a point with fewer runs.
        let first = next_trial(self, &scores);
        let of = |engine: f64| -> Vec<&PointScore> {
            let is_own = |index: usize| settings.engine_of_trial(index) == engine;
            let all = (first..first + settings.count).filter(|index| is_own(*index));
            let all = all.count();
            let points = scores.points.iter().filter_map(|point| {
                let runs = scores.runs.iter().filter(|run| run.values == point.values);
                let runs: Vec<&PointScore> = runs.filter(|run| is_own(run.index)).collect();
                let has_all = runs.len() >= all;
                let scored: Vec<&PointScore> =
                    runs.into_iter().filter(|run| run.score.is_some()).collect();
                let score = mean_of_any(scored.iter().filter_map(|run| run.score))?;
                has_all.then_some((score, scored))
            });
            least_by(points, |(score, _)| *score).map_or(Vec::new(), |(_, scored)| scored)
        };
        let own = ENGINES.map(of);
        // Where neither engine comes near the recordings, being nearer is no reason to believe one of them.
        let [own_is_near, second_is_near] = own.each_ref().map(|runs| self.comes_near(runs));
        let weights = match own_is_near? || second_is_near? {
            true => {
                let own = own
                    .each_ref()
                    .map(|runs| -> Vec<f64> { runs.iter().filter_map(|run| run.score).collect() });
                variant_probabilities(own.each_ref().map(Vec::as_slice)).to_vec()
            }
            false => vec![0.5, 0.5],
        };
        Ok((scores, emulator, weights))
    }

    /// Whether these runs are about as far from the recordings as these are from each other; true where nothing tells how far that is.
    fn comes_near(&self, runs: &[&PointScore]) -> Result<bool> {
        let real = self.part_of(&self.real_paths(), false);
        if self.cases().len() != 1 || real.len() < 2 {
            return Ok(true);
        }
        let floor_m = mean_distance_m(&real);
        let mut distances_m = Vec::new();
        for run in runs {
            let path = Prepared::from_xy_m(run.path_xy_m.clone())?;
            distances_m.extend(real.iter().map(|real| rms_m(real, &path)));
        }
        let nearest = mean_of_any(distances_m.iter().copied());
        Ok(floor_m <= 0.0 || nearest.is_some_and(|m| m < NEAR_FLOORS * floor_m))
    }

    /// Position of the point with the lowest expected score in this engine.
    fn best_in(&self, scores: &Scores, emulator: &Emulator, engine: f64) -> Option<usize> {
        let grid = &self.definition().grid;
        let expected = scores.ranked().into_iter().map(|position| {
            let place = grid.place_of(&scores.points[position].values);
            (emulator.standardised_in(&place, &[engine])[0], position)
        });
        least_by(expected, |(score, _)| *score).map(|(_, position)| position)
    }

    /// The view of each engine on the point at position `best`; empty where there is one engine only. `weights` are the engines'
    /// posterior probabilities.
    pub(in crate::calibration) fn engine_preferences(
        &self,
        scores: &Scores,
        best: usize,
        (emulator, weights): (&Emulator, &[f64]),
        (uncertainty, limit): (ObservationUncertainty, f64),
    ) -> Vec<EnginePreference> {
        let grid = &self.definition().grid;
        let here = grid.place_of(&scores.points[best].values);
        let runs = scores.runs_by_engine(&self.settings(), best);
        let preference = |((engine, runs), weight): ((f64, &Vec<&PointScore>), &f64)| {
            let engine_name = self.engine_named(engine)?;
            let ranked = scores.ranked().into_iter().map(|position| {
                let place = grid.place_of(&scores.points[position].values);
                (emulator.mean_in(&place, engine), place)
            });
            let mut ranked: Vec<(f64, Vec<f64>)> = ranked.collect();
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
            ranked.truncate(COMPARED);
            let (expected, own) = ranked.first().cloned()?;
            let places = ranked.into_iter().map(|(_, place)| place);
            let places: Vec<Vec<f64>> = places.chain([here.clone()]).collect();
            let field = emulator.field_in(&places, engine);
            let all = implausibility(&field, &ScoreCovariance::new(&field, uncertainty, None));
            Some(EnginePreference {
                engine: engine_name,
                weight: *weight,
                explains: scores.engine == 0.0 || scores.engine == engine,
                score: mean_of(runs.iter().filter_map(|run| run.score)),
                settings: runs.len(),
                parameters: by_name(&self.parameter_set(&grid.values_at(&own))),
                expected,
                implausibility: *all.last()?,
                limit,
            })
        };
        ENGINES
            .into_iter()
            .zip(&runs)
            .zip(weights)
            .filter_map(preference)
            .collect()
    }
}
