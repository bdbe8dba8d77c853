//! How well one setting predicts the joints of recordings that hold nothing else.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::definition::StartUsed;
use super::evaluation::{Average, provenance};
use super::study::Study;
use realgap_core::error::{Error, Result};
use realgap_core::warning::{Code, Warning};
use realgap_engine::parameter::ParameterSet;
use realgap_optimize::RunOptions;
use realgap_path::comparison::joint_error_rad;

/// One recording and its simulation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointErrors {
    /// Name of the recording.
    pub recording: String,
    /// Mean absolute error of the joints, milliradians; `None` where the simulation diverged.
    pub angle_mrad: Option<f64>,
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
    /// CPU milliseconds per simulated second.
    pub cpu_ms_per_s: f64,
    /// Which start state the runs have.
    pub start: StartUsed,
    /// Parameter values that the study, files and command line fix.
    pub parameters: BTreeMap<String, f64>,
    /// Versions, settings and input hashes.
    pub provenance: BTreeMap<String, String>,
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
        let (done, total) = (AtomicUsize::new(0), self.cases().len());
        let cases: Vec<Vec<(usize, JointErrors)>> = run.install(|| {
            (0..total)
                .into_par_iter()
                .map(|case| {
                    run.go_on()?;
                    let rows = self.joint_errors(case, set);
                    run.tell(done.fetch_add(1, Ordering::Relaxed) + 1, total, None);
                    rows
                })
                .collect::<Result<_>>()
        })??;
        let mut rows: Vec<(usize, JointErrors)> = cases.into_iter().flatten().collect();
        rows.sort_by_key(|(recording, _)| *recording);
        let rows: Vec<JointErrors> = rows.into_iter().map(|(_, row)| row).collect();
        let definition = self.definition();
        let angles = rows.iter().filter_map(|row| row.angle_mrad).collect();
        let angle_mrad = Average::of(angles).ok_or_else(|| {
            definition.at_file(
                Error::invalid("every simulation diverged, so there are no errors to report")
                    .hint("try a shorter timestep or more substeps"),
            )
        })?;
        let mut warnings = self.warnings().to_vec();
        let diverged = rows.iter().filter(|row| row.angle_mrad.is_none()).count();
        if diverged > 0 {
            warnings.push(Warning::new(
                Code::Diverged,
                format!(
                    "{diverged} of {} simulations diverged: they are missing from the mean",
                    rows.len()
                ),
            ));
        }
        let fixed = definition.set.clone().with_all(set);
        let cpu_s: f64 = rows.iter().map(|row| row.cpu_s).sum();
        let simulated_s: f64 = rows.iter().map(|row| row.simulated_s).sum();
        Ok(JointEvaluation {
            recordings: rows.len(),
            angle_mrad,
            cpu_ms_per_s: 1e3 * cpu_s / simulated_s,
            start: definition.start_used(),
            parameters: fixed
                .iter()
                .map(|a| (a.parameter.name.to_owned(), a.value))
                .collect(),
            provenance: provenance(self),
            warnings,
            rows,
        })
    }

    fn joint_errors(&self, case: usize, set: &ParameterSet) -> Result<Vec<(usize, JointErrors)>> {
        let experiment = self.experiment_with(case, set)?;
        let run = realgap_engine::run(&experiment)?;
        let targets = self.cases()[case].targets.iter();
        targets
            .map(|target| {
                let recording = &self.definition().recordings[target.recording];
                let error_rad = run
                    .outcome
                    .get()
                    .map(|motion| {
                        joint_error_rad(&target.motion, motion)
                            .map_err(|e| e.at_file(&recording.path))
                    })
                    .transpose()?;
                let row = JointErrors {
                    recording: recording.name.clone(),
                    angle_mrad: error_rad.map(|(error_rad, _)| 1e3 * error_rad),
                    simulated_s: experiment.duration_s,
                    cpu_s: run.cpu.as_secs_f64(),
                };
                Ok((target.recording, row))
            })
            .collect()
    }
}
