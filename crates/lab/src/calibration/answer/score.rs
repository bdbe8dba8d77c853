//! Scores of simulated outcomes: the basis where the metric needs one, the mean over recordings, and the best point.

use std::collections::HashMap;

use crate::calibration::Study;
use crate::calibration::numerics::setting::Settings;
use realgap_core::Result;
use realgap_core::statistics::mean_of_any;
use realgap_core::unit::Unit;
use realgap_path::comparison::Basis;
use realgap_path::trajectory::Prepared;
use realgap_store::{CaseResult, CaseRow, Trial};

/// The code that stands for both engines, or for the only one.
const BOTH_ENGINES: f64 = 0.0;

/// Score of one run of a study, or the mean score of all runs at one point: the mean of both engines' means where both ran there,
/// unless [`Scores::engine`] names one of them.
#[derive(Debug, Clone, PartialEq)]
pub struct PointScore {
    /// Index of the run, or of the first run at the point.
    pub index: usize,
    /// How many runs with a score it is the mean of.
    pub runs: usize,
    /// Parameter values, in the study's order.
    pub values: Vec<f64>,
    /// Why it has no score, where a case diverged.
    pub diverged: Option<String>,
    /// Score against each recording times its weight, in order; empty when diverged.
    pub recordings: Vec<f64>,
    /// Mean score over the recordings that are fitted; `None` when diverged.
    pub score: Option<f64>,
    /// Mean score over the recordings that are held out; `None` when diverged or none are.
    pub held_out: Option<f64>,
    /// Mean absolute difference of the net displacements, metres; `None` when diverged.
    pub displacement_error_m: Option<f64>,
    /// Prepared path of the first case, metres; empty when diverged.
    pub path_xy_m: Vec<[f64; 2]>,
}

/// Scores of all points evaluated so far.
#[derive(Debug, Clone)]
pub struct Scores {
    /// Every run, by its index.
    pub runs: Vec<PointScore>,
    /// Every point, by the index of its first run, with the mean over its runs; a point not evaluated yet is missing.
    pub points: Vec<PointScore>,
    /// Position in `points` of the best point; `None` when every point diverged. In an [`Answer`](crate::calibration::Answer) it
    /// is the point with the lowest mean over all equally valid settings. Before, it is the point with the lowest mean over its
    /// runs so far; the first of equals counts.
    pub best: Option<usize>,
    /// Unit of the scores.
    pub unit: Unit,
    /// The basis, where the metric needs one.
    pub basis: Option<Basis>,
    /// Whose runs the score of a point is the mean of: 0 for both engines, or the only one; 1 for the study's own engine and −1 for
    /// the second, where the recordings speak against the other one.
    pub engine: f64,
}

impl Scores {
    /// Scores all trials.
    ///
    /// # Errors
    /// Paths from which no basis can be built.
    pub fn new(study: &Study, trials: &[Trial]) -> Result<Self> {
        let basis = study.basis(trials.iter().flat_map(|trial| &trial.cases))?;
        Self::with_basis(study, trials, basis)
    }

    /// Scores all trials with a basis that was fitted before; one that the metric does not need is ignored.
    ///
    /// # Errors
    /// Paths that do not fit the basis.
    pub fn with_basis(study: &Study, trials: &[Trial], basis: Option<Basis>) -> Result<Self> {
        let metric = study.definition().metric;
        let real = study.real_paths();
        let runs = trials
            .iter()
            .map(|trial| score(study, &real, basis.as_ref(), trial))
            .collect::<Result<Vec<_>>>()?;
        let engine = BOTH_ENGINES;
        Ok(Self::of_runs(
            runs,
            (metric.unit(), basis),
            (engine, &study.settings()),
        ))
    }

    /// These scores and those of more trials.
    ///
    /// # Errors
    /// Paths that do not fit the basis.
    pub(in crate::calibration) fn with_more(
        &self,
        study: &Study,
        trials: &[Trial],
    ) -> Result<Self> {
        let more = Self::with_basis(study, trials, self.basis.clone())?;
        let runs = self.runs.iter().cloned().chain(more.runs).collect();
        let basis = (self.unit, self.basis.clone());
        Ok(Self::of_runs(runs, basis, (self.engine, &study.settings())))
    }

    /// The same runs, where the score of a point is the mean over the settings of one engine; 0 means both.
    #[must_use]
    pub(in crate::calibration) fn in_engine(self, study: &Study, engine: f64) -> Self {
        match engine == self.engine {
            true => self,
            false => Self::of_runs(
                self.runs,
                (self.unit, self.basis),
                (engine, &study.settings()),
            ),
        }
    }

    fn of_runs(
        runs: Vec<PointScore>,
        (unit, basis): (Unit, Option<Basis>),
        (engine, settings): (f64, &Settings),
    ) -> Self {
        let points = points(&runs, engine, settings);
        let mut scores = Self {
            runs,
            points,
            best: None,
            unit,
            basis,
            engine,
        };
        scores.best = scores.ranked().first().copied();
        scores
    }

    /// Positions of the points that have a score, the lowest first, ties by order.
    pub(in crate::calibration) fn ranked(&self) -> Vec<usize> {
        let scored = self.points.iter().enumerate();
        let mut ranked: Vec<(usize, f64)> = scored
            .filter_map(|(position, point)| Some((position, point.score?)))
            .collect();
        ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
        ranked.into_iter().map(|(position, _)| position).collect()
    }

    /// The runs of the point at this position that have a score: of the study's own engine, and of the second.
    pub(in crate::calibration) fn runs_by_engine(
        &self,
        settings: &Settings,
        position: usize,
    ) -> [Vec<&PointScore>; 2] {
        let runs = self.runs_at(&self.points[position].values);
        let (own, second) = runs.partition(|run| settings.engine_of_trial(run.index) >= 0.0);
        [own, second]
    }

    /// The runs that the score of the point at this position is the mean of.
    pub(in crate::calibration) fn runs_of_mean(
        &self,
        settings: &Settings,
        position: usize,
    ) -> Vec<&PointScore> {
        let [own, second] = self.runs_by_engine(settings, position);
        match self.engine {
            1.0 if !own.is_empty() => own,
            -1.0 if !second.is_empty() => second,
            _ => own.into_iter().chain(second).collect(),
        }
    }

    /// The runs at a point that have a score.
    pub(in crate::calibration) fn runs_at(
        &self,
        values: &[f64],
    ) -> impl Iterator<Item = &PointScore> {
        let here = self.runs.iter().filter(move |run| run.values == values);
        here.filter(|run| run.score.is_some())
    }
}

/// Every point once, with the mean over its runs that did not diverge.
fn points(runs: &[PointScore], engine: f64, settings: &Settings) -> Vec<PointScore> {
    let mut positions: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut members: Vec<Vec<&PointScore>> = Vec::new();
    for run in runs {
        let bits = run.values.iter().map(|value| value.to_bits()).collect();
        let position = *positions.entry(bits).or_insert(members.len());
        match members.get_mut(position) {
            Some(known) => known.push(run),
            None => members.push(vec![run]),
        }
    }
    let means = members.iter().map(|runs| mean_of(runs, engine, settings));
    means.collect()
}

fn mean_of(runs: &[&PointScore], engine: f64, settings: &Settings) -> PointScore {
    let scored: Vec<&&PointScore> = runs.iter().filter(|run| run.score.is_some()).collect();
    let Some(first) = scored.first() else {
        return runs[0].clone();
    };
    let over = |value: &dyn Fn(&PointScore) -> Option<f64>| -> Option<f64> {
        let values = scored.iter().filter_map(|r| Some((r.index, value(r)?)));
        let values: Vec<(usize, f64)> = values.collect();
        (!values.is_empty()).then(|| settings.mean(engine, &values))
    };
    let recordings = 0..first.recordings.len();
    PointScore {
        index: runs[0].index,
        runs: scored.len(),
        values: first.values.clone(),
        diverged: None,
        recordings: recordings
            .map(|r| over(&|run| Some(run.recordings[r])).unwrap_or(f64::NAN))
            .collect(),
        score: over(&|run| run.score),
        held_out: over(&|run| run.held_out),
        displacement_error_m: over(&|run| run.displacement_error_m),
        path_xy_m: first.path_xy_m.clone(),
    }
}

fn score(
    study: &Study,
    real: &[&Prepared],
    basis: Option<&Basis>,
    trial: &Trial,
) -> Result<PointScore> {
    let mut point = PointScore {
        index: trial.index,
        runs: 0,
        values: trial.values.clone(),
        diverged: trial.diverged().map(str::to_owned),
        recordings: Vec::new(),
        score: None,
        held_out: None,
        displacement_error_m: None,
        path_xy_m: Vec::new(),
    };
    let results: Option<Vec<&CaseResult>> = trial.cases.iter().map(CaseRow::completed).collect();
    if let Some(first) = trial.cases.first().and_then(CaseRow::completed) {
        point.path_xy_m.clone_from(&first.path_xy_m);
    }
    let Some(results) = results else {
        return Ok(point);
    };
    let count = real.len();
    point.runs = 1;
    let length_scale = study.recording_length_scale(&trial.values);
    point.recordings = vec![f64::NAN; count];
    let mut displacement_error_m = 0.0;
    for (case, result) in results.into_iter().enumerate() {
        let scores = result_scores(study, basis, length_scale, case, result)?;
        for (target, score) in study.cases()[case].targets.iter().zip(scores) {
            // The weight is applied here, so that every mean and every resampling over recordings contains it.
            point.recordings[target.recording] = study.weight(target.recording) * score;
            displacement_error_m += (result.net_displacement_m
                - target.prepared.net_displacement_m() / length_scale)
                .abs();
        }
    }
    let part = |held_out: bool| mean_of_any(study.part_of(&point.recordings, held_out));
    (point.score, point.held_out) = (part(false), part(true));
    point.displacement_error_m = Some(displacement_error_m / count as f64);
    Ok(point)
}

/// Scores of one result against the recordings of its case; `length_scale` is recorded lengths over true ones.
pub(in crate::calibration) fn result_scores(
    study: &Study,
    basis: Option<&Basis>,
    length_scale: f64,
    case: usize,
    result: &CaseResult,
) -> Result<Vec<f64>> {
    let Some(basis) = basis else {
        let targets = study.cases()[case].targets.len();
        return Ok(result.scores[..targets].to_vec());
    };
    let simulated = Prepared::from_xy_m(result.path_xy_m.clone())?;
    // Both paths are in recorded lengths, and the score is in true lengths.
    Ok(study.cases()[case]
        .targets
        .iter()
        .map(|target| basis.discrepancy_m(&target.prepared, &simulated) / length_scale)
        .collect())
}
