//! `summary.json`: the answer with its uncertainty and where it comes from.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::verdict::{Verdict, verdicts};
use crate::calibration::UncertaintySource;
use crate::calibration::{Answer, Audit, Method, Study, Tuned, Validation};
use crate::comparison::pose_errors;
use crate::error::{Error, Result};
use crate::file::write_atomic;
use crate::optimization::Ending;
use crate::plot::quantity;
use crate::simulation;
use crate::warning::{Code, Warning};

/// The answer of a answer.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// Name of the study.
    pub study: String,
    /// What it is for.
    pub description: String,
    /// True when every point was evaluated.
    pub complete: bool,
    /// Points evaluated.
    pub points: usize,
    /// Points of the study's grid, or the optimizer's budget.
    pub points_total: usize,
    /// How an optimizer chose the points; `None` for a sweep.
    pub tuning: Option<Tuned>,
    /// Points without a score.
    pub diverged: usize,
    /// Recordings compared with.
    pub recordings: usize,
    /// The metric.
    pub metric: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The best point; `None` when every point diverged.
    pub best: Option<Best>,
    /// How sure the best point is.
    pub uncertainty: Option<UncertaintySummary>,
    /// What the recordings say about each parameter.
    pub verdicts: Vec<Verdict>,
    /// How the best values of two parameters move together when reality is sampled again.
    pub correlations: Vec<Correlation>,
    /// What the numerical settings change.
    pub audit: Option<Audit>,
    /// How the fit does on recordings that it has not seen.
    pub validation: Option<Validation>,
    /// Principal components kept and the share of the variance each explains, where the metric uses them.
    pub components: Option<Vec<f64>>,
    /// Pose errors of the best point, where the recordings have orientations.
    pub pose: Option<PoseSummary>,
    /// Versions, settings and input hashes.
    pub provenance: BTreeMap<String, String>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// The best point.
#[derive(Debug, Clone, Serialize)]
pub struct Best {
    /// Parameter values by name.
    pub parameters: BTreeMap<String, f64>,
    /// Score in the metric's unit.
    pub score: f64,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
}

/// Correlation of two parameters over the bootstrap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// One parameter.
    pub first: &'static str,
    /// The other.
    pub second: &'static str,
    /// Pearson's coefficient.
    pub value: f64,
}

/// How sure the best point is.
#[derive(Debug, Clone, Serialize)]
pub struct UncertaintySummary {
    /// Where it comes from.
    pub source: UncertaintySource,
    /// Confidence level.
    pub level: f64,
    /// Standard deviation of the best score when reality is sampled again.
    pub best_score_sd: f64,
    /// Standard deviation of the best score when the simulated start and timestep are varied.
    pub simulation_sd: f64,
    /// Points that cannot be told apart from the best, itself included.
    pub indistinguishable: usize,
}

/// Mean over recordings of the pose errors of the best point.
#[derive(Debug, Clone, Serialize)]
pub struct PoseSummary {
    /// Mean position error, percent of the body length.
    pub position_percent: f64,
    /// Mean rotation error, degrees.
    pub rotation_deg: f64,
}

impl Summary {
    pub(super) fn new(study: &Study, answer: &Answer) -> Result<Self> {
        let definition = study.definition();
        let scores = &answer.scores;
        let best = scores.best.and_then(|best| {
            let point = &scores.points[best];
            point.score.map(|score| Best {
                parameters: study
                    .parameter_set(&point.values)
                    .iter()
                    .map(|a| (a.parameter.name.to_owned(), a.value))
                    .collect(),
                score,
                displacement_error_m: point.displacement_error_m,
            })
        });
        let points_total = match &answer.method {
            Method::Sweep => definition.grid.len(),
            Method::Tune(tuned) => tuned.budget,
        };
        let mut warnings = study.warnings().to_vec();
        let diverged = scores
            .points
            .iter()
            .filter(|point| point.diverged.is_some())
            .count();
        if diverged > 0 {
            warnings.push(Warning::new(
                Code::Diverged,
                format!(
                    "{diverged} of {} points diverged and have no score",
                    scores.points.len()
                ),
            ));
        }
        if answer.ending == Ending::Interrupted {
            warnings.push(Warning::new(
                Code::Incomplete,
                format!("only {} of {points_total} points were evaluated: the best of these may not be the best of all", scores.points.len()),
            ));
        }
        if let Some(audit) = &answer.audit
            && !audit.unresolved.is_empty()
        {
            warnings.push(Warning::new(
                Code::Unresolved,
                format!(
                    "timestep or substeps change the best score by {}, more than the whole range of {}: these scores cannot tell",
                    quantity(audit.largest_change, scores.unit),
                    audit.unresolved.join(", ")
                ),
            ));
        }
        warnings.extend(
            answer
                .validation
                .as_ref()
                .and_then(|validation| validation.warning()),
        );
        if study.fitted_recordings() == 1 {
            warnings.push(Warning::new(
                Code::OneRecording,
                "one recording says nothing about how repeatable reality is; the uncertainty is that of perturbed simulated starts",
            ));
        }
        Ok(Self {
            study: definition.name.clone(),
            description: definition.description.clone(),
            complete: answer.ending == Ending::Complete,
            points: scores.points.len(),
            points_total,
            tuning: match &answer.method {
                Method::Tune(tuned) => Some(tuned.clone()),
                Method::Sweep => None,
            },
            diverged,
            recordings: definition.recordings.len(),
            metric: definition.metric.name(),
            unit: definition.metric.unit().label(),
            best,
            uncertainty: answer.uncertainty.as_ref().map(|u| UncertaintySummary {
                source: u.source,
                level: u.level,
                best_score_sd: u.best_score_sd,
                simulation_sd: u.simulation_sd,
                indistinguishable: u.indistinguishable.iter().filter(|is_in| **is_in).count(),
            }),
            verdicts: verdicts(study, answer),
            correlations: correlations(study, answer),
            audit: answer.audit.clone(),
            validation: answer.validation.clone(),
            components: scores.basis.as_ref().map(|b| {
                b.explained_variance_ratio()
                    .iter()
                    .take(b.kept())
                    .copied()
                    .collect()
            }),
            pose: pose(study, answer)?,
            provenance: study.fingerprint().entries().iter().cloned().collect(),
            warnings,
        })
    }

    pub(super) fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join("summary.json");
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|e| Error::invalid(format!("cannot write JSON: {e}")).at_file(&path))?;
        text.push('\n');
        write_atomic(&path, text.as_bytes())
    }
}

fn correlations(study: &Study, answer: &Answer) -> Vec<Correlation> {
    let Some(draws) = &answer.draws else {
        return Vec::new();
    };
    let ranges = study.definition().grid.ranges();
    let pairs = (0..ranges.len()).flat_map(|a| (a + 1..ranges.len()).map(move |b| (a, b)));
    pairs
        .map(|(a, b)| Correlation {
            first: ranges[a].parameter.name,
            second: ranges[b].parameter.name,
            value: draws.correlation(a, b),
        })
        .collect()
}

/// Simulates the best point once more and measures its pose errors.
fn pose(study: &Study, answer: &Answer) -> Result<Option<PoseSummary>> {
    let Some(best) = answer.scores.best else {
        return Ok(None);
    };
    if !study.definition().metric.is_pose() {
        return Ok(None);
    }
    let values = &answer.scores.points[best].values;
    let (mut position, mut rotation_rad, mut count) = (0.0, 0.0, 0.0);
    for (index, case) in study.cases().iter().enumerate() {
        let experiment = study.experiment(index, values)?;
        let run = simulation::run(&experiment)?;
        let Some(simulated) = run.outcome.completed() else {
            return Ok(None);
        };
        for target in &case.targets {
            let target = target.in_true_lengths(experiment.recording_length_scale)?;
            let errors = pose_errors(
                &target.motion,
                &simulated,
                case.experiment.assembly.body_length_m,
            )?;
            position += errors.position_fraction_mean;
            rotation_rad += errors.rotation_rad_mean;
            count += 1.0;
        }
    }
    Ok(Some(PoseSummary {
        position_percent: 100.0 * position / count,
        rotation_deg: (rotation_rad / count).to_degrees(),
    }))
}
