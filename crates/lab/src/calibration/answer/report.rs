//! The report of an answer: its numbers and sentences.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::calibration::answer::relation::{Correlation, Difference};
use crate::calibration::answer::uncertainty::own_score;
use crate::calibration::exploration::information_gain;
use crate::calibration::{
    Audit, EnginePreference, Fit, Method, PosteriorDraws, Reproduction, Scores, Study, Tables,
    Transfer, Tuned, Uncertainty, UncertaintySource, Validation, Verdict, by_name, few_recordings,
};
use crate::claim::{self, About, Claim, Conclusion};
use realgap_core::unit::{Unit, counted, quantity};
use realgap_core::{Code, Result, Warning};
use realgap_optimization::Ending;
use realgap_path::comparison::pose_errors;
use realgap_path::trajectory::Source;

/// The result of a sweep or a tuning with its uncertainty and provenance; its `Display` is a text for readers.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Report {
    /// Name of the study.
    pub study: String,
    /// Purpose of the study.
    pub description: String,
    /// True when every point was evaluated.
    pub complete: bool,
    /// Points of the grid, or that the optimizer asked for, that were evaluated.
    pub points: usize,
    /// Simulations of all cases: those of the first points, of the waves after them, and of the equally valid settings of the
    /// best point.
    pub runs: usize,
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
    pub unit: Unit,
    /// Whether joints or other channels are compared, and not where the robot goes.
    #[serde(skip)]
    pub is_of_joints: bool,
    /// The best point; `None` when every point diverged.
    pub best: Option<Best>,
    /// Whether the best point explains the recordings; `None` where too little is known to ask.
    pub fit: Option<Fit>,
    /// How sure the best point is.
    pub uncertainty: Option<BestPointUncertainty>,
    /// What the recordings say about each parameter.
    pub verdicts: Vec<Verdict>,
    /// Everything that is stated here about reality, the most important first.
    pub claims: Vec<Claim>,
    /// Correlation of each pair of parameters over the posterior draws.
    pub correlations: Vec<Correlation>,
    /// By how much one parameter differs between two sets of recordings, e.g. friction between two floors.
    pub differences: Vec<Difference>,
    /// The view of each of two engines on the answer, which is one of the claims; empty where there is one engine only.
    #[serde(skip)]
    pub engines: Vec<EnginePreference>,
    /// How much the numerical settings change the best score.
    pub audit: Option<Audit>,
    /// How the best point scores on recordings that were held out of the fit.
    pub validation: Option<Validation>,
    /// Of a study of many robots: each one's misfit, and what the others' answer does for it.
    pub transfer: Option<Transfer>,
    /// Of a study of many robots: in how many of them the shared answer does what was recorded.
    pub reproduction: Option<Reproduction>,
    /// Principal components kept and the share of the variance each explains, where the metric uses them.
    pub components: Option<Vec<f64>>,
    /// Pose errors of the best point, where the recordings have orientations.
    pub pose: Option<PoseErrors>,
    /// Versions, settings and input hashes.
    pub provenance: BTreeMap<String, String>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// The best point.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Best {
    /// Parameter values by name.
    pub parameters: BTreeMap<String, f64>,
    /// Score in the metric's unit: the mean over equally valid settings.
    pub score: f64,
    /// How many settings that is the mean of.
    pub settings: usize,
    /// The score with the study's own settings; its difference from `score` is chance.
    pub own_score: Option<f64>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
}

/// Uncertainty of the best point.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BestPointUncertainty {
    /// The sources of the uncertainty.
    pub source: UncertaintySource,
    /// Confidence level.
    pub level: f64,
    /// Standard deviation of the best score over repetitions of the recordings.
    pub best_score_sd: f64,
    /// Standard deviation of the best score over equally valid settings.
    pub simulation_sd: f64,
    /// Share of the variance between points and the best point that more runs would remove, 0 to 1.
    pub emulator_share: f64,
    /// Simulated points in the confidence set, the best point included.
    pub indistinguishable: usize,
    /// Number of simulated points.
    pub points: usize,
}

/// Mean over recordings of the pose errors of the best point.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PoseErrors {
    /// Mean position error, percent of the body length.
    pub position_percent: f64,
    /// Mean rotation error, degrees.
    pub rotation_deg: f64,
}

/// Everything from which a report is made.
pub(in crate::calibration) struct Evidence<'a> {
    pub method: &'a Method,
    pub ending: Ending,
    pub scores: &'a Scores,
    pub uncertainty: Option<&'a Uncertainty>,
    pub draws: Option<&'a PosteriorDraws>,
    pub engines: Vec<EnginePreference>,
    pub audit: Option<Audit>,
    pub fit: Option<Fit>,
    pub validation: Option<Validation>,
    pub reproduction: Option<Reproduction>,
}

impl Evidence<'_> {
    /// Points without a score.
    fn diverged(&self) -> usize {
        let points = self.scores.points.iter();
        points.filter(|point| point.diverged.is_some()).count()
    }

    /// The warnings of a report on a run of so many points.
    fn warnings(&self, study: &Study, points_total: usize) -> Vec<Warning> {
        let mut warnings = study.warnings().to_vec();
        let (scores, diverged) = (self.scores, self.diverged());
        if diverged > 0 {
            warnings.push(Code::Diverged.warning(format!(
                "{diverged} of {} points diverged and have no score",
                scores.points.len()
            )));
        }
        if self.ending == Ending::Interrupted {
            warnings.push(Code::Incomplete.warning(format!(
                "only {} of {points_total} points were evaluated: the best of these may not be the best of all",
                scores.points.len()
            )));
        }
        if self.ending == Ending::Complete && !study.is_audited() {
            warnings.push(Code::NotAudited.warning(
                "the answer is not audited: nothing tells whether the model explains the recordings and what finer timesteps change, so the intervals may be too narrow",
            ));
        }
        if let Some(audit) = &self.audit
            && !audit.unresolved.is_empty()
        {
            warnings.push(Code::Unresolved.warning(format!(
                "finer timesteps, more substeps or hard contact change the best score by {}, more than the whole range of {}: these scores do not determine it",
                quantity(audit.largest_change, scores.unit),
                match audit.unresolved.as_slice() {
                        [first, .., _] if audit.unresolved.len() > claim::NAMED =>
                            format!("{} parameters, such as {first}", audit.unresolved.len()),
                        few => few.join(", "),
                    }
            )));
        }
        let fitted = study.fitted_recordings();
        let metric = study.definition().metric;
        let engines = claim::engines(&self.engines, (metric.name(), metric.unit()), fitted);
        let differ = engines.filter(|claim| claim.conclusion == Conclusion::Rejected);
        warnings.extend(differ.map(|claim| Code::EnginesDiffer.warning(claim.text)));
        let fit = self.fit.as_ref();
        warnings.extend(fit.and_then(|fit| fit.warning(fitted)));
        let validation = self.validation.as_ref();
        warnings.extend(validation.and_then(Validation::warning));
        warnings.extend(few_recordings(fitted));
        if fitted == 1 {
            let (_, differ) = study.noise_of_repeats();
            warnings.push(Code::OneRecording.warning(format!(
                "one recording does not show how repeatable reality is: all intervals are of this run, and assume that repeats differ {differ}"
            )));
        }
        warnings
    }
}

impl fmt::Display for Report {
    /// Writes the verdict in three lines, a line for the study, and one for each further statement of the report.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&claim::verdict_lines(&self.claims))?;
        write!(
            f,
            "{}: {} of {}, {}",
            self.study,
            self.points,
            counted(self.points_total, "point"),
            counted(self.recordings, "recording"),
        )?;
        let say = |f: &mut fmt::Formatter<'_>, about: About| {
            let mut claims = self.claims.iter().filter(|claim| claim.about == about);
            claims.try_for_each(|claim| write!(f, "\n  {claim}"))
        };
        say(f, About::Model)?;
        if let Some(best) = &self.best {
            let values: Vec<String> = best
                .parameters
                .iter()
                .map(|(name, value)| format!("{name} = {value:.4}"))
                .collect();
            write!(
                f,
                "\n  best: {}\n  {} discrepancy {}",
                match values.len() {
                    ..=claim::NAMED => values.join(", "),
                    many => format!("{many} parameters, each below"),
                },
                self.metric,
                quantity(best.score, self.unit)
            )?;
            if self.unit == Unit::One {
                f.write_str(" (dimensionless)")?;
            }
            let lowest = self.tuning.as_ref().and_then(|tuning| tuning.lowest_score);
            if let Some(lowest) = lowest {
                write!(
                    f,
                    ", at the point with the smallest robust loss; the lowest discrepancy of all points is {}",
                    quantity(lowest, self.unit)
                )?;
            }
            let spread = self.uncertainty.as_ref().map(|sure| sure.simulation_sd);
            if let (true, Some(own), Some(spread)) = (best.settings > 1, best.own_score, spread) {
                write!(
                    f,
                    ", mean over {} equally valid settings with a standard deviation of {}; {} with the study's own setting",
                    best.settings,
                    quantity(spread, self.unit),
                    quantity(own, self.unit)
                )?;
            }
        }
        say(f, About::Engines)?;
        if let Some(pose) = &self.pose {
            write!(
                f,
                "\n  mean position error {:.2} % of the body length, mean rotation error {:.2} deg",
                pose.position_percent, pose.rotation_deg
            )?;
        }
        if let Some(validation) = &self.validation {
            write!(
                f,
                "\n  held out ({}): {} where the fitted recordings have {} (difference {} +- {})",
                validation.split,
                quantity(validation.held_out_score, self.unit),
                quantity(validation.fit_score, self.unit),
                quantity(validation.held_out_score - validation.fit_score, self.unit),
                quantity(validation.difference_standard_error, self.unit),
            )?;
            if let Some(bands) = &validation.bands {
                write!(f, "\n  {}", bands.sentence())?;
            }
        }
        if let Some(transfer) = &self.transfer {
            write!(
                f,
                "\n  {} robots: {} untuned, {} with what the others say ({:.0} % closed), {} each at its own best ({:.0} %){}",
                transfer.robots.len(),
                quantity(transfer.untuned_misfit, self.unit),
                quantity(transfer.held_out_misfit, self.unit),
                100.0 * transfer.closed,
                quantity(transfer.own_misfit, self.unit),
                100.0 * transfer.closable,
                transfer.own_parameters.remark(),
            )?;
        }
        if let Some(reproduction) = &self.reproduction {
            write!(f, "\n  {reproduction}")?;
        }
        say(f, About::Set)?;
        say(f, About::Parameter)?;
        say(f, About::Difference)?;
        if let Some(tuning) = &self.tuning {
            information_gain::say(&tuning.motions, f)?;
        }
        if let Some(audit) = &self.audit {
            write!(
                f,
                "\n  finer timesteps, more substeps and hard contact change the score by up to {}, coarser settings by up to {}",
                quantity(audit.largest_change, self.unit),
                quantity(audit.largest_coarser_change, self.unit)
            )?;
        }
        Ok(())
    }
}

impl Report {
    pub(in crate::calibration) fn new(study: &Study, evidence: &Evidence<'_>) -> Result<Self> {
        let definition = study.definition();
        let (scores, grid) = (evidence.scores, &definition.grid);
        let best = scores.best.and_then(|best| {
            let point = &scores.points[best];
            point.score.map(|score| Best {
                parameters: by_name(&study.parameter_set(&point.values)),
                score,
                settings: scores.runs_of_mean(&study.settings(), best).len(),
                own_score: own_score(study, scores, best),
                displacement_error_m: point.displacement_error_m,
            })
        });
        let (points_total, known) = match evidence.method {
            Method::Sweep => (definition.grid.len(), Default::default()),
            Method::Tune(tuned) => (tuned.budget, tuned.least_squares.as_slice()),
        };
        let tables = Tables {
            ranges: definition.grid.ranges(),
            scores,
            uncertainty: evidence.uncertainty,
            draws: evidence.draws,
            audit: evidence.audit.as_ref(),
            recordings: study.fitted_recordings(),
        };
        let report = Self {
            study: definition.name.clone(),
            description: definition.description.clone(),
            complete: evidence.ending == Ending::Complete,
            points: match evidence.method {
                Method::Sweep => scores.points.len().min(points_total),
                Method::Tune(tuned) => tuned.evaluated,
            },
            runs: scores.runs.len(),
            points_total,
            tuning: match evidence.method {
                Method::Tune(tuned) => Some(tuned.clone()),
                Method::Sweep => None,
            },
            diverged: evidence.diverged(),
            recordings: definition.recordings.len(),
            metric: definition.metric.name(),
            unit: definition.metric.unit(),
            is_of_joints: definition.metric.needs().joints,
            best,
            fit: evidence.fit.clone(),
            uncertainty: evidence.uncertainty.map(|u| BestPointUncertainty {
                source: u.source,
                level: u.level,
                best_score_sd: u.best_score_sd,
                simulation_sd: u.simulation_sd,
                emulator_share: u.emulator_share,
                indistinguishable: u.indistinguishable.iter().filter(|is_in| **is_in).count(),
                points: u.indistinguishable.len(),
            }),
            verdicts: match evidence.ending {
                // Least squares fit the single errors, so they know more than an emulator of the mean error.
                Ending::Complete if !known.is_empty() => Verdict::of_least_squares(&tables, known),
                Ending::Complete => Verdict::all(&tables),
                // The best of some points may not be the best of all.
                Ending::Interrupted => Vec::new(),
            },
            claims: Vec::new(),
            correlations: Correlation::all(grid, evidence.draws),
            differences: match evidence.ending {
                Ending::Complete => Difference::all(grid, evidence.draws),
                Ending::Interrupted => Vec::new(),
            },
            engines: evidence.engines.clone(),
            audit: evidence.audit.clone(),
            validation: evidence.validation.clone(),
            transfer: match evidence.ending {
                Ending::Complete => Transfer::new(study, scores),
                Ending::Interrupted => None,
            },
            reproduction: evidence.reproduction.clone(),
            components: scores.basis.as_ref().map(|b| {
                b.explained_variance_ratio()
                    .iter()
                    .take(b.kept())
                    .copied()
                    .collect()
            }),
            pose: pose(study, scores)?,
            provenance: study.fingerprint().entries().iter().cloned().collect(),
            warnings: evidence.warnings(study, points_total),
        };
        Ok(report.with_claims(definition.source(), tables.recordings))
    }

    /// The report with the claims that follow from its numbers; `recordings` is the number of fitted recordings, which are of
    /// this source.
    #[must_use]
    pub fn with_claims(mut self, source: Source, recordings: usize) -> Self {
        let reality = claim::called(source);
        let of_metric = (self.metric, self.unit);
        let model = self.fit.as_ref().map(|fit| claim::model(fit, recordings));
        let best = self.best.as_ref();
        let best = best.map(|best| claim::nearest(best, of_metric, (reality, recordings)));
        let each: Vec<Claim> = self.verdicts.iter().map(|v| v.claim.clone()).collect();
        let sure = self.uncertainty.as_ref();
        let set = sure.map(|sure| claim::set(sure, recordings));
        let engines = claim::engines(&self.engines, of_metric, recordings);
        let floors = self.fit.as_ref().and_then(|fit| fit.noise_floors);
        let gap = self.best.as_ref().map(|best| {
            let pose = self.pose.as_ref();
            let displacement_m = best.displacement_error_m.filter(|_| !self.is_of_joints);
            let distances = (best.score, displacement_m, pose);
            claim::gap(distances, of_metric, floors, (reality, recordings))
        });
        let has_converged = self.tuning.as_ref().is_none_or(Tuned::has_converged);
        let trust = claim::trust(&claim::Ground {
            complete: self.complete,
            has_converged,
            is_audited: !self.warnings.iter().any(|w| w.code == Code::NotAudited),
            fit: self.fit.as_ref(),
            validation: self.validation.as_ref(),
            recordings,
        });
        let trust = self.best.is_some().then_some(trust);
        let verdict = gap.into_iter().chain(claim::summary(&each)).chain(trust);
        let between = self.differences.iter();
        let between = between.map(|known| claim::difference(known, has_converged, recordings));
        let first = verdict.chain(model).chain(best).chain(engines);
        self.claims = first.chain(set).chain(each).chain(between).collect();
        self
    }
}

/// Simulates the best point once more and measures its pose errors, where the metric is about poses.
fn pose(study: &Study, scores: &Scores) -> Result<Option<PoseErrors>> {
    let Some(best) = scores.best else {
        return Ok(None);
    };
    if !study.definition().metric.is_pose() {
        return Ok(None);
    }
    let values = &scores.points[best].values;
    let (mut position, mut rotation_rad, mut count) = (0.0, 0.0, 0.0);
    for (index, case) in study.cases().iter().enumerate() {
        let experiment = study.experiment(index, values)?;
        let run = realgap_simulation::run(&experiment)?;
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
    Ok(Some(PoseErrors {
        position_percent: 100.0 * position / count,
        rotation_deg: (rotation_rad / count).to_degrees(),
    }))
}
