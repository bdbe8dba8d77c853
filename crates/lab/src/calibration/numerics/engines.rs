//! What each of two engines says to the answer of both, and where it would be best by itself.

use std::collections::BTreeMap;

use crate::calibration::{PointScore, Scores, Study, by_name};
use realgap_core::statistics::mean_of;
use realgap_inference::{Emulator, ObservationUncertainty, ScoreCovariance, implausibility};

/// One engine's part in an answer of two.
#[derive(Debug, Clone, PartialEq)]
pub struct EngineWish {
    /// Its name.
    pub engine: &'static str,
    /// Mean score of its settings at the answer of both, in the metric's unit.
    pub score: f64,
    /// Of so many settings.
    pub settings: usize,
    /// Of the points that were simulated, by either engine, the one that is expected to be best in this engine alone.
    pub parameters: BTreeMap<String, f64>,
    /// The score to be expected there.
    pub expected: f64,
    /// By how many standard deviations of everything unknown the answer of both is worse in this engine than another point.
    pub implausibility: f64,
    /// Up to so many it is allowed.
    pub limit: f64,
}

impl EngineWish {
    /// Whether the answer of both may be its own, too.
    pub fn allows(&self) -> bool {
        self.implausibility <= self.limit
    }
}

/// The engines of runs, as [`Settings::engine_of_trial`](crate::calibration::numerics::setting::Settings::engine_of_trial) tells them.
const ENGINES: [f64; 2] = [1.0, -1.0];
/// Points that an engine compares the answer with: those that it likes best.
const COMPARED: usize = 200;

impl Study {
    /// Name of the engine that such runs are of; `None` where there is one only.
    pub(in crate::calibration) fn engine_named(&self, engine: f64) -> Option<&'static str> {
        let second = self.settings().second?;
        let own = self.cases()[0].experiment.engine();
        Some(if engine < 0.0 { second.get() } else { own }.name())
    }

    /// What each engine says to the point at position `best`; nothing where there is one engine only.
    pub(in crate::calibration) fn wishes(
        &self,
        scores: &Scores,
        best: usize,
        emulator: &Emulator,
        (uncertainty, limit): (ObservationUncertainty, f64),
    ) -> Vec<EngineWish> {
        let grid = &self.definition().grid;
        let here = grid.place_of(&scores.points[best].values);
        let runs = scores.runs_by_engine(&self.settings(), best);
        let wish = |(engine, runs): (f64, &Vec<&PointScore>)| {
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
            Some(EngineWish {
                engine: engine_name,
                score: mean_of(runs.iter().filter_map(|run| run.score)),
                settings: runs.len(),
                parameters: by_name(&self.parameter_set(&grid.values_at(&own))),
                expected,
                implausibility: *all.last()?,
                limit,
            })
        };
        ENGINES.into_iter().zip(&runs).filter_map(wish).collect()
    }
}
