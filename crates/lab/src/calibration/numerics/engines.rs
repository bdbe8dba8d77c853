//! The answer of a study of two engines, seen by each engine: how well it explains the recordings, whether it rejects the best
//! point, and which point it prefers.

use std::collections::BTreeMap;

use crate::calibration::exploration::wave::{VISITED, leading};
use crate::calibration::{PointScore, Scores, Study, by_name};
use realgap_core::statistics::mean_of;
use realgap_inference::{
    Emulator, HistoryMatching, ObservationUncertainty, ScoreCovariance, implausibility,
};

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

/// The recordings speak against an engine whose posterior probability is lower than this.
const REJECTED: f64 = 0.05;
/// Points from which the probabilities are computed before the best point is known.
const WEIGHED: usize = 200;

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

    /// The code of the engine that alone explains the recordings; 0 where both do, or where there is one engine only.
    pub(in crate::calibration) fn explaining_engine(
        &self,
        scores: &Scores,
        emulator: &Emulator,
    ) -> f64 {
        if !emulator.has_two_variants() {
            return 0.0;
        }
        let uncertainty = ObservationUncertainty {
            observations: self.fitted_recordings(),
            discrepancy: 0.0,
        };
        let (_, visited) = leading(self, scores, Some(emulator), VISITED);
        let definition = self.definition();
        let (grid, seed) = (&definition.grid, definition.seed);
        let matching = HistoryMatching::new(emulator, grid, &visited, uncertainty, WEIGHED, seed);
        match matching.variant_weights() {
            [_, second] if *second < REJECTED => 1.0,
            [own, _] if *own < REJECTED => -1.0,
            _ => 0.0,
        }
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
            let all = implausibility(&field, &ScoreCovariance::new(&field, uncertainty));
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
