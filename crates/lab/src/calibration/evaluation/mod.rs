//! Evaluation of given parameter values on recordings that they may not have been fitted on: pose errors, flips and resting
//! faces.

pub(in crate::calibration) mod band;
pub(in crate::calibration) mod channels;
pub(super) mod determination;
pub(in crate::calibration) mod horizon_error;
pub(super) mod joints;
pub(super) mod prior_run;
pub(super) mod reproduction;
pub(super) mod resting;
pub(super) mod sensitivity;
pub(super) mod transfer;
pub(super) mod validation;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::calibration::evaluation::horizon_error::{HorizonError, WindowError};
use crate::calibration::evaluation::resting::face_at_end;
use crate::calibration::{
    Definition, FaceOdds, PoseErrors, StartUsed, Study, by_name, few_recordings,
};
use crate::claim::{self, Claim};
use crate::prediction::Odds;
use realgap_core::file::sha256;
use realgap_core::statistics::{mean, median, standard_deviation};
use realgap_core::unit::{Unit, counted};
use realgap_core::{Code, Error, Result, Warning};
use realgap_identification::is_at_rest;
use realgap_optimization::RunOptions;
use realgap_path::comparison::pose_errors;
use realgap_path::trajectory::{Source, Trajectory};
use realgap_simulation::Experiment;
use realgap_simulation::parameter::ParameterSet;

/// A final orientation further off than this is another face: a flip.
const FLIP_DEG: f64 = 45.0;

/// Mean, median and standard error over recordings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Average {
    /// Mean.
    pub mean: f64,
    /// Median (mean of the middle two).
    pub median: f64,
    /// Standard deviation / √n; 0 for a single recording, where it cannot be estimated.
    pub standard_error: f64,
}

/// Pose errors of one recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingErrors {
    /// Name of the recording.
    pub recording: String,
    /// Mean position error, percent of the body length; `None` where the simulation diverged.
    pub position_percent: Option<f64>,
    /// Mean rotation error, degrees.
    pub rotation_deg: Option<f64>,
    /// Mean error of the joints, degrees; `None` without joints, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hinge_deg: Option<f64>,
    /// Position error at the end, percent of the body length.
    pub final_position_percent: Option<f64>,
    /// Rotation error at the end, degrees.
    pub final_rotation_deg: Option<f64>,
    /// Error of the joints at the end, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub final_hinge_deg: Option<f64>,
    /// Face that ended down, where the recording ends at rest.
    pub real_face_down: Option<&'static str>,
    /// Face that points down at the end of the simulation.
    pub simulated_face_down: Option<&'static str>,
    /// Simulated seconds.
    pub simulated_s: f64,
    /// CPU seconds.
    pub cpu_s: f64,
    /// The error over time, of a window.
    #[serde(skip)]
    pub(in crate::calibration) window: Option<WindowError>,
}

/// Pose errors over recordings. Lengths are true ones ([`Experiment::recording_length_scale`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluation {
    /// Recordings compared with.
    pub recordings: usize,
    /// Mean position error of each recording, percent of the body length.
    pub position_percent: Average,
    /// Mean rotation error of each recording, degrees.
    pub rotation_deg: Average,
    /// Mean error of the joints of each recording, degrees; `None` without joints.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hinge_deg: Option<Average>,
    /// Position error at the end, percent of the body length.
    pub final_position_percent: Average,
    /// Rotation error at the end, degrees.
    pub final_rotation_deg: Average,
    /// Error of the joints at the end, degrees; `None` without joints.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub final_hinge_deg: Option<Average>,
    /// Recordings that end more than 45° off; diverged simulations count.
    pub over_45_deg: usize,
    /// How errors grow over the windows of each recording, where the study has a horizon.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub over_horizon: Vec<HorizonError>,
    /// Which face ends down.
    pub resting_faces: Vec<FaceOdds>,
    /// CPU milliseconds per simulated second.
    pub cpu_ms_per_s: f64,
    /// Which start state the runs have.
    pub start: StartUsed,
    /// Parameter values that the study, files and command line fix.
    pub parameters: BTreeMap<String, f64>,
    /// Versions, settings and input hashes.
    pub provenance: BTreeMap<String, String>,
    /// Every claim about reality, the most important first.
    pub claims: Vec<Claim>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
    /// One row a recording, in order; empty unless asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<RecordingErrors>,
    /// Where the recordings come from.
    #[serde(skip)]
    pub source: Source,
    /// How many of the recordings the values were fitted on; `None` where no fit is known.
    #[serde(skip)]
    pub seen_by_fit: Option<usize>,
}

impl Evaluation {
    /// The evaluation with the claims that follow from its numbers, and from the odds of the same recordings where these are known.
    #[must_use]
    pub fn with_claims(mut self, odds: Option<&Odds>) -> Self {
        let errors = PoseErrors {
            position_percent: self.position_percent.mean,
            rotation_deg: self.rotation_deg.mean,
        };
        let gap = claim::gap(
            (f64::NAN, None, Some(&errors)),
            ("pose", Unit::One),
            None,
            (claim::called(self.source), self.recordings),
        );
        let given = Given {
            values: &self.parameters,
            seen_by_fit: self.seen_by_fit,
            recordings: self.recordings,
        };
        self.claims = given.verdict(gap, odds);
        self
    }
}

/// Given values that were compared with recordings.
pub(in crate::calibration) struct Given<'a> {
    pub values: &'a BTreeMap<String, f64>,
    pub seen_by_fit: Option<usize>,
    pub recordings: usize,
}

impl Given<'_> {
    /// The verdict with this gap. Only odds test whether a right model would differ from the recordings as much.
    pub(in crate::calibration) fn verdict(self, gap: Claim, odds: Option<&Odds>) -> Vec<Claim> {
        let odds = odds.filter(|odds| odds.recordings >= claim::FEW);
        let coverage = odds.iter().flat_map(|odds| &odds.end_coverage);
        let regions = coverage.map(|one| claim::region(one.level, &one.observed, None));
        let against = claim::contradictions(&regions.collect::<Vec<_>>(), None, Source::Real);
        let trust = claim::trust_of(&claim::Comparison {
            complete: true,
            against,
            tested: odds.map(|odds| {
                format!(
                    "the regions of its odds hold the ends of {} as often as they state",
                    counted(odds.recordings, "recording")
                )
            }),
            would_tell: "single runs do not show how far a right model would be from the recordings; repeat them under `noise`, or fit the study, which judges what remains".to_owned(),
            seen_by_fit: self.seen_by_fit,
            recordings: self.recordings,
        });
        let values = claim::values(self.values, self.seen_by_fit, self.recordings);
        vec![gap, values, trust]
    }
}

impl Study {
    /// How well the study's fixed values and `set` predict its recordings: simulates every start once and measures pose errors.
    ///
    /// # Errors
    /// Recordings without orientations, not a single simulation that ends, or the run was stopped.
    pub fn evaluate(&self, set: &ParameterSet, run: &RunOptions<'_>) -> Result<Evaluation> {
        let rows = by_recording(run.each(self.cases().len(), |case| {
            evaluate_case(self, case, &self.experiment_with(case, set)?)
        })?);
        summarise(self, set, rows)
    }
}

/// Rows of all cases, each with the index of its recording, in the order of the recordings.
pub(in crate::calibration) fn by_recording<T>(cases: Vec<Vec<(usize, T)>>) -> Vec<T> {
    let mut rows: Vec<(usize, T)> = cases.into_iter().flatten().collect();
    rows.sort_by_key(|(recording, _)| *recording);
    rows.into_iter().map(|(_, row)| row).collect()
}

/// The error of a study whose simulations all diverged.
pub(in crate::calibration) fn all_diverged(definition: &Definition) -> Error {
    definition.at_file(
        Error::invalid("every simulation diverged, so there are no errors to report")
            .hint("try a shorter timestep or more substeps"),
    )
}

fn evaluate_case(
    study: &Study,
    case: usize,
    experiment: &Experiment,
) -> Result<Vec<(usize, RecordingErrors)>> {
    let run = realgap_simulation::run(experiment)?;
    let face_at_end = |motion: &Trajectory| face_at_end(motion, experiment);
    let simulated = run.outcome.get();
    study.cases()[case]
        .targets
        .iter()
        .map(|target| {
            let target = target.in_true_lengths(experiment.recording_length_scale)?;
            let recording = &study.definition().recordings[target.recording];
            let errors = simulated
                .map(|motion| {
                    pose_errors(&target.motion, motion, experiment.assembly.body_length_m)
                        .map_err(|e| e.at_file(&recording.path))
                })
                .transpose()?;
            let row = RecordingErrors {
                recording: recording.name.clone(),
                position_percent: errors.as_ref().map(|e| 100.0 * e.position_fraction_mean),
                rotation_deg: errors.as_ref().map(|e| e.rotation_rad_mean.to_degrees()),
                hinge_deg: (errors.as_ref().and_then(|e| e.joint_rad_mean)).map(f64::to_degrees),
                final_position_percent: errors.as_ref().map(|e| 100.0 * e.position_fraction_final),
                final_rotation_deg: errors.as_ref().map(|e| e.rotation_rad_final.to_degrees()),
                final_hinge_deg: (errors.as_ref().and_then(|e| e.joint_rad_final))
                    .map(f64::to_degrees),
                real_face_down: is_at_rest(&target.motion)
                    .then(|| face_at_end(&target.motion))
                    .flatten(),
                simulated_face_down: simulated.and_then(face_at_end),
                simulated_s: experiment.duration_s,
                cpu_s: run.cpu.as_secs_f64(),
                window: simulated
                    .and_then(|motion| WindowError::new(recording, &target.motion, motion)),
            };
            Ok((target.recording, row))
        })
        .collect()
}

fn summarise(study: &Study, set: &ParameterSet, rows: Vec<RecordingErrors>) -> Result<Evaluation> {
    let definition = study.definition();
    let average = |value: fn(&RecordingErrors) -> Option<f64>| {
        let known = rows.iter().filter_map(value).collect();
        Average::of(known).ok_or_else(|| all_diverged(definition))
    };
    let mut warnings = study.warnings().to_vec();
    let diverged = rows.iter().filter(|r| r.rotation_deg.is_none()).count();
    if diverged > 0 {
        warnings.push(Code::Diverged.warning(format!(
            "{diverged} of {} simulations diverged: they are missing from the means and count as over 45 degrees",
            rows.len()
        )));
    }
    let fixed = definition.set.clone().with_all(set);
    for range in definition.grid.ranges() {
        let name = range.parameter.name;
        if fixed.value(name).is_none() {
            warnings.push(Code::FreeParameter.warning(format!(
                "{name} is free in the study and no value is given: its default is used"
            )));
        }
    }
    warnings.extend(few_recordings(rows.len()));
    if rows.len() == 1 {
        warnings.push(
            Code::OneRecording
                .warning("one recording does not know its standard error; 0 is written"),
        );
    }
    let is_over = |deg: f64| deg > FLIP_DEG;
    let over = rows
        .iter()
        .filter(|row| row.final_rotation_deg.is_none_or(is_over));
    let ends = rows.iter();
    let ends = ends.filter_map(|row| Some((row.real_face_down?, row.simulated_face_down)));
    let cpu_s: f64 = rows.iter().map(|row| row.cpu_s).sum();
    let simulated_s: f64 = rows.iter().map(|row| row.simulated_s).sum();
    let found = Evaluation {
        recordings: rows.len(),
        position_percent: average(|row| row.position_percent)?,
        rotation_deg: average(|row| row.rotation_deg)?,
        hinge_deg: Average::of(rows.iter().filter_map(|row| row.hinge_deg).collect()),
        final_position_percent: average(|row| row.final_position_percent)?,
        final_rotation_deg: average(|row| row.final_rotation_deg)?,
        final_hinge_deg: Average::of(rows.iter().filter_map(|row| row.final_hinge_deg).collect()),
        over_45_deg: over.count(),
        over_horizon: HorizonError::all(
            &rows
                .iter()
                .filter_map(|row| row.window.as_ref())
                .collect::<Vec<_>>(),
            study.cases()[0].body_length_m().unwrap_or(0.0),
        ),
        resting_faces: FaceOdds::count(&ends.collect::<Vec<_>>()),
        cpu_ms_per_s: 1e3 * cpu_s / simulated_s,
        start: definition.start_used(),
        parameters: by_name(&fixed),
        provenance: provenance(study),
        claims: Vec::new(),
        warnings,
        rows,
        source: definition.source(),
        seen_by_fit: definition.seen_by_fit,
    };
    Ok(found.with_claims(None))
}

/// The study's fingerprint with the hashes of hundreds of recordings folded into one.
pub(in crate::calibration) fn provenance(study: &Study) -> BTreeMap<String, String> {
    let digest = sha256(study.definition().recordings_sha256.concat());
    study
        .fingerprint()
        .entries()
        .iter()
        .filter(|(name, _)| !name.starts_with("recording ") && !name.starts_with("parameter "))
        .cloned()
        .chain([("recordings sha256".to_owned(), digest)])
        .collect()
}

impl Average {
    /// The average of at least one value.
    pub(in crate::calibration) fn of(values: Vec<f64>) -> Option<Self> {
        let root = (values.len() as f64).sqrt();
        (!values.is_empty()).then(|| Self {
            mean: mean(&values),
            median: median(&values),
            standard_error: standard_deviation(&values) / root,
        })
    }
}
