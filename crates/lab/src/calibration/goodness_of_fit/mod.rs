//! Goodness of fit: whether the model explains the recordings at all, which is judged before its numbers.

mod bench;
mod channel;
mod imitation;
mod layout;
pub(super) mod misfit;
pub(super) mod path;
pub(super) mod pattern;
mod refit;
mod repeat_noise;
pub(super) mod residual;
mod systematic_part;
pub(super) mod two_sample;
pub(super) mod visible_noise;

use serde::Serialize;

use crate::calibration::answer::score::{PointScore, Scores};
use crate::calibration::exploration::method::Method;
use crate::calibration::goodness_of_fit::misfit::Misfit;
use crate::calibration::goodness_of_fit::path::Nearest;
use crate::calibration::goodness_of_fit::residual::{Judgement, ResidualFit};
use crate::calibration::goodness_of_fit::two_sample::two_sample_p_value;
use crate::calibration::study::Study;
use crate::calibration::study::definition::StartRule;
use crate::claim::{self, SIGNIFICANT};
use crate::prediction::ensemble::rms_m;
use realgap_core::error::Result;
use realgap_core::statistics::{energy_test, mean};
use realgap_core::unit::number;
use realgap_core::warning::{Code, Warning};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::Prepared;

/// Comparison of the best point's runs with the recordings, and of both with the differences between repeats, or, where runs start
/// from recordings, with the noise of the recordings. Distances are those of the metric `rms`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fit {
    /// False where nothing tells how much a right model would differ from the recordings: no recording was repeated, the study
    /// states no noise, and the recordings show none.
    pub judged: bool,
    /// Mean distance of the best point's runs to the recordings, in noise floors; the noise floor is the mean distance between
    /// recordings of the same run. `None` without repeats.
    pub noise_floors: Option<f64>,
    /// Energy test (Székely & Rizzo 2013): probability of so large a difference between runs and recordings if both have the same
    /// distribution; `None` for fewer than three recordings.
    pub p_value: Option<f64>,
    /// Two-sample test: probability that the recordings differ so much from every set of repeats of the runs near them, if they
    /// are one more such set; `None` where the test is not needed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours_p_value: Option<f64>,
    /// False where no parameters of this model explain these recordings. This is so where the energy test rejects the best
    /// point's runs and no run of any point is as near to the recordings as one more recording would be; it is also so where the
    /// two-sample test rejects every set of repeats near the recordings, and where residuals are not noise. True where it cannot
    /// be judged.
    pub explains: bool,
    /// Variance of the model's discrepancy, in variances of a recording, which widens the intervals; 0 where the model explains
    /// the recordings.
    pub discrepancy: f64,
    /// Where there are two engines, the engine of these runs: the one that explains the recordings better.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engine: Option<&'static str>,
    /// Where the misfit is largest, and which change would reduce it most; `None` where the model explains the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub misfit: Option<Misfit>,
    /// What the residuals of the best point say, where runs start from recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residuals: Option<ResidualFit>,
}

/// The energy test has no power with fewer recordings than this.
const LEAST: usize = 3;
/// From this p-value of the energy test on, the best point's runs fit the recordings and no further test is made.
const ALIKE: f64 = 0.2;

impl Fit {
    /// `None` without a best point, for a fit that has not ended, for settled starts of several robots, for recordings of one start that do not differ, and where
    /// there are too few points for a test of one recording.
    ///
    /// # Errors
    /// Paths that cannot be compared, runs that cannot be simulated.
    pub(in crate::calibration) fn new(
        (study, run): (&Study, &RunOptions<'_>),
        scores: &Scores,
        method: &Method,
    ) -> Result<Option<Self>> {
        // Where a fit has not ended, better parameters may explain the recordings. One that ended in a minimum that is doubted is judged:
        // what is said is said of the best point.
        let Some(best) = scores.best.filter(|_| method.has_ended()) else {
            return Ok(None);
        };
        if study.definition().start == StartRule::FromRecording {
            return Ok(Self::of_residuals(Judgement::new((study, run), scores)?));
        }
        if study.cases().len() == 1 && study.fitted_recordings() == 1 {
            return Self::of_one_recording((study, run), scores, method);
        }
        let settings = study.settings();
        let path = |run: &PointScore| Prepared::from_xy_m(run.path_xy_m.clone());
        let mut engines = Vec::new();
        for runs in scores.runs_by_engine(&settings, best) {
            let paths = runs.iter().map(|run| path(run));
            let engine = runs.first().map(|run| settings.engine_of_trial(run.index));
            engines.push((paths.collect::<Result<Vec<_>>>()?, engine));
        }
        let mut fits = Vec::new();
        // Reality is neither of the two engines: the model explains the recordings where the runs of one engine do.
        for (runs, engine) in &engines {
            let engine = engine.and_then(|engine| study.engine_named(engine));
            let fit = Self::of_runs(study, runs)?;
            fits.extend(fit.map(|fit| Self { engine, ..fit }));
        }
        let order = |a: &Self, b: &Self| {
            let floors = |fit: &Self| fit.noise_floors.unwrap_or(f64::INFINITY);
            let by_distance = floors(a).total_cmp(&floors(b));
            b.explains.cmp(&a.explains).then(by_distance)
        };
        let fit = fits.into_iter().min_by(order);
        // Two recordings are too few for the energy test.
        let is_doubted = |fit: &Self| fit.p_value.is_none_or(|p| p < ALIKE);
        let fit = match fit {
            Some(fit) if is_doubted(&fit) => fit,
            fit => {
                return Ok(fit.map(|fit| Self {
                    discrepancy: 0.0,
                    ..fit
                }));
            }
        };
        let runs = scores.runs.iter().filter(|run| run.score.is_some());
        let paths = runs.clone().map(path).collect::<Result<Vec<_>>>()?;
        let real = study.part_of(&study.real_paths(), false);
        let nearest = Nearest::new(&real, &paths).filter(|_| real.len() >= LEAST);
        let is_far = nearest.is_some_and(|nearest| nearest.p_value < SIGNIFICANT);
        // A model is not rejected for noise that nobody stated, so that a careful noise has to have been tried, too.
        let is_stated = study.definition().noise.is_some();
        let neighbours_p_value = match !fit.explains && is_far && is_stated {
            true => None,
            false => {
                let all = runs.zip(&paths);
                let spread = all.filter(|(run, _)| !method.crowds(run.index));
                two_sample_p_value((study, run), &real, &spread.collect::<Vec<_>>())?
            }
        };
        let explains = match neighbours_p_value {
            Some(p) if !is_stated => p >= SIGNIFICANT,
            p => p.is_none_or(|p| p >= SIGNIFICANT) && (fit.explains || !is_far),
        };
        let misfit = nearest.filter(|_| !explains).map(|nearest| {
            let duration_s = study.cases()[0].experiment.duration_s;
            Misfit::new(nearest, &paths[nearest.run], &real, duration_s)
        });
        Ok(Some(Self {
            explains,
            neighbours_p_value,
            discrepancy: if explains { 0.0 } else { fit.discrepancy },
            misfit,
            ..fit
        }))
    }

    /// The fit to a single recording of a settled start: only the study can say how much one more recording would differ.
    fn of_one_recording(
        (study, run): (&Study, &RunOptions<'_>),
        scores: &Scores,
        method: &Method,
    ) -> Result<Option<Self>> {
        let has_noise = study
            .definition()
            .noise
            .is_some_and(|noise| !noise.is_zero());
        let p_value = match has_noise {
            false => None,
            true => {
                let runs = scores.runs.iter();
                let runs = runs.filter(|run| run.score.is_some() && !method.crowds(run.index));
                let path = |run: &PointScore| Prepared::from_xy_m(run.path_xy_m.clone());
                let paths = runs.clone().map(path).collect::<Result<Vec<_>>>()?;
                let real = study.part_of(&study.real_paths(), false);
                two_sample_p_value((study, run), &real, &runs.zip(&paths).collect::<Vec<_>>())?
            }
        };
        if has_noise && p_value.is_none() {
            return Ok(None);
        }
        Ok(Some(Self {
            judged: has_noise,
            noise_floors: None,
            p_value: None,
            neighbours_p_value: p_value,
            explains: p_value.is_none_or(|p| p >= SIGNIFICANT),
            discrepancy: 0.0,
            engine: None,
            misfit: None,
            residuals: None,
        }))
    }

    /// The fit of runs that start from recordings.
    fn of_residuals(judgement: Judgement) -> Option<Self> {
        let (judged, residuals) = match judgement {
            Judgement::Nothing => return None,
            Judgement::Unknown => (false, None),
            Judgement::Fit(fit) => (true, Some(fit)),
        };
        let is_misfit = residuals.as_ref().is_some_and(|fit| fit.misfit.is_some());
        Some(Self {
            judged,
            noise_floors: None,
            p_value: None,
            neighbours_p_value: None,
            explains: !is_misfit,
            discrepancy: 0.0,
            engine: None,
            misfit: None,
            residuals,
        })
    }

    /// The comparison of these runs of the best point alone.
    fn of_runs(study: &Study, runs: &[Prepared]) -> Result<Option<Self>> {
        let real = study.part_of(&study.real_paths(), false);
        if study.cases().len() != 1 || real.len() < 2 {
            return Ok(None);
        }
        let all: Vec<&Prepared> = real.iter().copied().chain(runs).collect();
        let pairs = || (0..all.len()).flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)));
        let distances: Vec<f64> = pairs().map(|(i, j)| rms_m(all[i], all[j])).collect();
        // Distances within the recordings, between recordings and runs, and within the runs.
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
        let (recordings, simulated) = (0.5 * over(0, 2), 0.5 * over(2, 2));
        let excess = over(1, 2) - recordings - simulated;
        Ok(Some(Self {
            judged: true,
            noise_floors: Some(noise_floors),
            p_value,
            neighbours_p_value: None,
            explains: p_value.is_none_or(|p| p >= SIGNIFICANT),
            discrepancy: (excess / recordings).max(0.0),
            engine: None,
            misfit: None,
            residuals: None,
        }))
    }

    /// How far the best point is from the recordings, and whether any point explains them, in a few words for a picture; `None` where
    /// that was not judged, or nothing is to be said.
    pub fn headline(&self) -> Option<String> {
        let far = self.noise_floors.filter(|_| self.judged);
        let far = far.map(|floors| format!("best point {} noise floors away", number(floors)));
        let explains = self.explains || !self.judged;
        match (far, explains) {
            (far, true) => far,
            (Some(far), false) => Some(format!("NOT EXPLAINED: {far}")),
            (None, false) => Some("NOT EXPLAINED by any point".to_owned()),
        }
    }

    /// A warning where no parameters explain these recordings.
    pub(in crate::calibration) fn warning(&self, recordings: usize) -> Option<Warning> {
        let said = claim::model(self, recordings).text;
        (!self.explains).then(|| Code::ModelContradicted.warning(said))
    }
}
