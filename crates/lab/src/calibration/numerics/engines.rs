//! The answer of a study of two engines, seen by each engine: whether the engine rejects the common best point, and which point
//! it prefers.

use std::collections::BTreeMap;

use crate::calibration::{PointScore, Scores, Study, by_name};
use realgap_core::statistics::mean_of;
use realgap_inference::{Emulator, ObservationUncertainty, ScoreCovariance, implausibility};

/// The view of one engine on the answer of both.
#[derive(Debug, Clone, PartialEq)]
pub struct EnginePreference {
    /// Name of the engine.
    pub engine: &'static str,
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

    /// The view of each engine on the point at position `best`; empty where there is one engine only.
    pub(in crate::calibration) fn engine_preferences(
        &self,
        scores: &Scores,
        best: usize,
        emulator: &Emulator,
        (uncertainty, limit): (ObservationUncertainty, f64),
    ) -> Vec<EnginePreference> {
        let grid = &self.definition().grid;
        let here = grid.place_of(&scores.points[best].values);
        let runs = scores.runs_by_engine(&self.settings(), best);
        let preference = |(engine, runs): (f64, &Vec<&PointScore>)| {
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
            .filter_map(preference)
            .collect()
    }
}
