//! Sensitivity of a study's score to small changes of its parameters, one parameter at a time around a point.

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use crate::calibration::answer::score::result_scores;
use crate::calibration::{StartRule, Study};
use realgap_core::statistics::{mean, standard_deviation};
use realgap_core::{Advice, Error, Result, Warning};
use realgap_inference::sensitivity::{Effect, Perturbation, effects, evaluations};
use realgap_optimization::RunOptions;
use realgap_path::comparison::Basis;
use realgap_simulation::parameter::{Assignment, Parameter, ParameterSet};
use realgap_simulation::{Experiment, Noise};
use realgap_store::CaseRow;

/// One-at-a-time sensitivity of the score around a point (the "nominal range" method of Saltelli et al. 2004, section 2).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sensitivity {
    /// The metric.
    pub metric: &'static str,
    /// Unit of the scores.
    pub unit: &'static str,
    /// Score of the point itself.
    pub score: f64,
    /// Standard deviation of that score when the simulated start varies by 1 mm and 1°: smaller changes may be chance; `None`
    /// where every recording has its own start.
    pub start_sd: Option<f64>,
    /// Every parameter that acts on this robot, largest effect first.
    pub effects: Vec<Effect>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Perturbed repeats of the point.
const REPEATS: u64 = 16;

impl Study {
    /// Tries a small change of every registered parameter around the study's fixed values.
    ///
    /// # Errors
    /// A point that itself diverges, a metric that cannot compare, or the run was stopped.
    pub fn sensitivity(&self, run: &RunOptions<'_>) -> Result<Sensitivity> {
        run.install(|| sensitivity(self, run))?
    }
}

/// Every parameter that acts on an experiment, with the values next to its own.
fn perturbations(
    experiment: &Experiment,
    parameters: Vec<&'static Parameter>,
) -> Vec<(&'static Parameter, Perturbation)> {
    let all = parameters.into_iter().filter_map(|parameter| {
        let value = parameter.value(experiment)?;
        let one = ParameterSet::new().with(Assignment { parameter, value });
        let acts = one.without_effect(experiment).is_empty();
        let perturbation = Perturbation {
            parameter: parameter.name,
            unit: parameter.unit.label(),
            value,
            tried: parameter.nudged(value),
        };
        acts.then_some((parameter, perturbation))
    });
    all.collect()
}

/// The mean score over the recordings of all cases; `None` where one of these diverged.
fn mean_score(
    study: &Study,
    basis: Option<&Basis>,
    length_scale: f64,
    rows: &[CaseRow],
) -> Result<Option<f64>> {
    let mut all = Vec::new();
    for (case, row) in rows.iter().enumerate() {
        let Some(result) = row.completed() else {
            return Ok(None);
        };
        all.extend(result_scores(study, basis, length_scale, case, result)?);
    }
    Ok(Some(mean(&all)))
}

fn sensitivity(study: &Study, run: &RunOptions<'_>) -> Result<Sensitivity> {
    let base = ParameterSet::new();
    let experiment = study.experiment_with(0, &base)?;
    let (parameters, perturbed): (Vec<_>, Vec<_>) =
        perturbations(&experiment, study.definition().known_parameters())
            .into_iter()
            .unzip();
    let mut tasks = vec![base];
    let evaluations = evaluations(&perturbed);
    tasks.extend(evaluations.iter().map(|(number, value)| {
        let (parameter, value) = (parameters[*number], *value);
        ParameterSet::new().with(Assignment { parameter, value })
    }));
    let repeats = match study.definition().start {
        StartRule::Settled => REPEATS,
        StartRule::FromRecording => 0,
    };
    let total = tasks.len() + repeats as usize;
    let done = AtomicUsize::new(0);
    let report = || run.tell(done.fetch_add(1, Ordering::Relaxed) + 1, total, None);
    // A value that cannot be simulated (such as a radius wider than the cube) is no failure; its effect stays unknown.
    let outcomes: Vec<Option<Vec<CaseRow>>> = tasks
        .par_iter()
        .map(|task| {
            run.go_on()?;
            let outcomes = study.simulate_set(task).ok();
            report();
            Ok(outcomes)
        })
        .collect::<Result<_>>()?;
    let starts: Vec<CaseRow> = (0..repeats)
        .into_par_iter()
        .map(|repeat| {
            let noise = Noise::careful_start();
            let outcome = study.simulate_perturbed(&tasks[0], &noise, repeat);
            report();
            outcome
        })
        .collect::<Result<_>>()?;
    let basis = study.basis(outcomes.iter().flatten().flatten().chain(&starts))?;
    let score = |set: &ParameterSet, rows: &[CaseRow]| {
        let length_scale = set.apply(&experiment).recording_length_scale;
        mean_score(study, basis.as_ref(), length_scale, rows)
    };
    let scores: Vec<Option<f64>> = tasks
        .iter()
        .zip(&outcomes)
        .map(|(task, outcomes)| match outcomes {
            Some(outcomes) => score(task, outcomes),
            None => Ok(None),
        })
        .collect::<Result<_>>()?;
    let Some(at_point) = scores[0] else {
        return Err(study.definition().at_file(
            Error::invalid("the point itself diverges, so nothing can be said about changes of it")
                .hint("try a shorter timestep or more substeps")
                .advise(Advice::CalibratedValues),
        ));
    };
    // A parameter of which no other value can be simulated, such as contacts that a walking robot needs, has no effect to show.
    let possible: HashSet<&str> = evaluations
        .iter()
        .zip(&outcomes[1..])
        .filter(|(_, outcome)| outcome.is_some())
        .map(|((number, _), _)| parameters[*number].name)
        .collect();
    let mut effects = effects(&perturbed, at_point, &scores[1..]);
    effects.retain(|effect| possible.contains(effect.parameter));
    let starts: Vec<f64> = starts
        .iter()
        .filter_map(|outcome| score(&tasks[0], std::slice::from_ref(outcome)).transpose())
        .collect::<Result<_>>()?;
    let metric = study.definition().metric;
    Ok(Sensitivity {
        metric: metric.name(),
        unit: metric.unit().label(),
        score: at_point,
        start_sd: (repeats > 0).then(|| standard_deviation(&starts)),
        effects,
        warnings: study.warnings().to_vec(),
    })
}
