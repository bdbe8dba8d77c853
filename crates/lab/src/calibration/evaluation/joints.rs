//! Evaluation of given parameter values on recordings of joints alone.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::calibration::evaluation::channels::ChannelSummary;
use crate::calibration::evaluation::{Given, all_diverged, by_recording, provenance};
use crate::calibration::{Average, StartUsed, Study, by_name};
use crate::claim::{self, Claim};
use realgap_core::statistics::{mean, mean_of};
use realgap_core::unit::Unit;
use realgap_core::{Code, Result, Warning};
use realgap_optimization::RunOptions;
use realgap_path::comparison::{ChannelError, JointError, joint_error_rad, joint_errors};
use realgap_simulation::parameter::ParameterSet;

/// One recording and its simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointErrors {
    /// Name of the recording.
    pub recording: String,
    /// Mean absolute error of the joints, milliradians; `None` where the simulation diverged.
    pub angle_mrad: Option<f64>,
    /// Mean over the joints of the absolute error at the end, milliradians.
    pub end_mrad: Option<f64>,
    /// Mean absolute error of each joint, milliradians; empty where the simulation diverged.
    pub joints_mrad: BTreeMap<String, f64>,
    /// Mean absolute error of each scored channel, in the unit of its column; empty where the study names none.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub channels: BTreeMap<String, f64>,
    #[serde(skip)]
    channel_errors: Vec<ChannelError>,
    #[serde(skip)]
    simulated_s: f64,
    #[serde(skip)]
    cpu_s: f64,
}

/// Errors of joints over the recordings of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEvaluation {
    /// Number of recordings.
    pub recordings: usize,
    /// Mean absolute error of the joints of each recording, milliradians.
    pub angle_mrad: Average,
    /// Median over the recordings (windows of them where the study has a horizon) of the joints' mean error at the end, milliradians.
    pub end_mrad_median: f64,
    /// Mean absolute error of the joints over whole recordings, milliradians, beside that over windows; only where the study has a
    /// horizon.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole_mrad: Option<Average>,
    /// Mean over the recordings of each joint's absolute error, milliradians.
    pub joints_mrad: BTreeMap<String, f64>,
    /// Errors of the channels that the study scores; empty where it names none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<ChannelSummary>,
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
    pub rows: Vec<JointErrors>,
}

impl Study {
    /// How well the study's fixed values and `set` predict the joints of its recordings, each simulated once.
    ///
    /// # Errors
    /// A recording without a joint of the robot, not a single simulation that ends, or the run was stopped.
    pub fn evaluate_joints(
        &self,
        set: &ParameterSet,
        run: &RunOptions<'_>,
    ) -> Result<JointEvaluation> {
        let cases = run.each(self.cases().len(), |case| self.joint_errors(case, set))?;
        let rows = by_recording(cases);
        let definition = self.definition();
        let angles = rows.iter().filter_map(|row| row.angle_mrad).collect();
        let angle_mrad = Average::of(angles).ok_or_else(|| all_diverged(definition))?;
        let mut ends: Vec<f64> = rows.iter().filter_map(|row| row.end_mrad).collect();
        ends.sort_by(f64::total_cmp);
        let mut by_joint: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (name, mrad) in rows.iter().flat_map(|row| &row.joints_mrad) {
            by_joint.entry(name.clone()).or_default().push(*mrad);
        }
        let by_joint = by_joint.into_iter();
        let mut warnings = self.warnings().to_vec();
        let diverged = rows.iter().filter(|row| row.angle_mrad.is_none()).count();
        if diverged > 0 {
            warnings.push(Code::Diverged.warning(format!(
                "{diverged} of {} simulations diverged: they are missing from the mean",
                rows.len()
            )));
        }
        let fixed = definition.set.clone().with_all(set);
        let parameters = by_name(&fixed);
        let reality = claim::called(definition.source());
        let gap = claim::gap(
            (1e-3 * angle_mrad.mean, None, None),
            ("joints", Unit::Radian),
            None,
            (reality, rows.len()),
        );
        let given = Given {
            values: &parameters,
            seen_by_fit: definition.seen_by_fit,
            recordings: rows.len(),
        };
        let cpu_s: f64 = rows.iter().map(|row| row.cpu_s).sum();
        let simulated_s: f64 = rows.iter().map(|row| row.simulated_s).sum();
        Ok(JointEvaluation {
            recordings: rows.len(),
            angle_mrad,
            end_mrad_median: 0.5 * (ends[(ends.len() - 1) / 2] + ends[ends.len() / 2]),
            whole_mrad: None,
            joints_mrad: by_joint.map(|(name, all)| (name, mean(&all))).collect(),
            channels: ChannelSummary::all(rows.iter().flat_map(|row| &row.channel_errors)),
            cpu_ms_per_s: 1e3 * cpu_s / simulated_s,
            start: definition.start_used(),
            claims: given.verdict(gap, None),
            parameters,
            provenance: provenance(self),
            warnings,
            rows,
        })
    }

    fn joint_errors(&self, case: usize, set: &ParameterSet) -> Result<Vec<(usize, JointErrors)>> {
        let experiment = self.experiment_with(case, set)?;
        let run = realgap_simulation::run(&experiment)?;
        let targets = self.cases()[case].targets.iter();
        targets
            .map(|target| {
                let recording = &self.definition().recordings[target.recording];
                let simulated = run.outcome.get();
                let error_rad = simulated.map(|motion| joint_error_rad(&target.motion, motion));
                let error_rad = error_rad.transpose();
                let error_rad = error_rad.map_err(|e| e.at_file(&recording.path))?;
                let errors = simulated.map(|simulated| joint_errors(&target.motion, simulated));
                let end_rad = |errors: &Vec<JointError>| mean_of(errors.iter().map(|e| e.end_rad));
                let end_rad = errors.as_ref().map(end_rad);
                let errors = errors.into_iter().flatten();
                let channels = &self.definition().channels;
                let channels = simulated.map(|own| channels.compare(&target.motion, own));
                let channels = channels.transpose();
                let channels = channels.map_err(|e| e.at_file(&recording.path))?;
                let channels = channels.unwrap_or_default();
                let row = JointErrors {
                    recording: recording.name.clone(),
                    end_mrad: end_rad.map(|end_rad| 1e3 * end_rad),
                    joints_mrad: errors.map(|e| (e.name, 1e3 * e.mean_rad)).collect(),
                    angle_mrad: error_rad.map(|(error_rad, _)| 1e3 * error_rad),
                    channels: channels
                        .iter()
                        .map(|error| (error.channel.column.clone(), error.mean))
                        .collect(),
                    channel_errors: channels,
                    simulated_s: experiment.duration_s,
                    cpu_s: run.cpu.as_secs_f64(),
                };
                Ok((target.recording, row))
            })
            .collect()
    }
}
