//! How much information each recording adds to the others (D-optimality; Atkinson & Donev 1992), from the finite differences that
//! least squares took.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use crate::calibration::Study;
use crate::calibration::study::case::Case;
use realgap_inference::added_information;
use realgap_optimization::{ErrorBlock, UnitPoint, slopes};
use realgap_path::comparison::{PoseSeries, joint_error_series, pose_error_series};
use realgap_path::trajectory::resolution;
use realgap_store::Trial;

/// Information that one recording adds to all others that are fitted, as if errors were independent noise and linear in the
/// parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InformationGain {
    /// Name of the recording.
    pub recording: String,
    /// Whether the recording was fitted. If so, this is what the fit would lose without it, otherwise what the fit would gain
    /// with it.
    pub is_fitted: bool,
    /// Half of the increase of log2 of the information matrix's determinant: one bit more halves the volume of the confidence
    /// region of the parameters.
    pub bits: f64,
    /// The same for each parameter by itself: one bit more halves the length of its interval.
    pub parameters: BTreeMap<&'static str, f64>,
}

/// The errors of one recording at a point.
pub(in crate::calibration) struct LogErrors<'a> {
    pub path: &'a Path,
    pub name: &'a str,
    pub is_fitted: bool,
    pub errors: Vec<f64>,
    /// The joints of the errors, in their order; the channel is the number of the robot's joint.
    pub blocks: Vec<ErrorBlock>,
}

/// Name of a recording, whether it is fitted, and its information matrix.
pub(in crate::calibration) type LogInformation = (String, bool, DMatrix<f64>);

/// What is known about the errors and parameters of a fit beside the runs.
#[derive(Debug, Clone)]
pub(in crate::calibration) struct FitPrecision {
    /// Variance of the errors of each channel that counts as one independent error; `None` where no fitted error is of the channel.
    pub channel_variances: Vec<Option<f64>>,
    /// Precision of each parameter's coordinate before the recordings.
    pub prior: Vec<f64>,
}

impl Study {
    /// Single errors by recording; windows of one recording are not independent and are put together. `None` where a case has no
    /// errors.
    pub(in crate::calibration) fn logs_of(&self, trial: &Trial) -> Option<Vec<LogErrors<'_>>> {
        let definition = self.definition();
        let mut logs: Vec<LogErrors<'_>> = Vec::new();
        for (case, row) in self.cases().iter().zip(&trial.cases) {
            let own = row.completed()?.scores.get(case.targets.len()..)?;
            let own_blocks = self.error_blocks(case);
            let is_fitted = case.targets.iter().any(|t| !self.is_held_out(t.recording));
            let recording = &definition.recordings[case.targets[0].recording];
            let path = recording.path.as_path();
            let name = definition.log_of(recording);
            let key = (path, name, is_fitted);
            let known = logs.iter_mut().rev();
            let mut known = known.filter(|log| (log.path, log.name, log.is_fitted) == key);
            match known.next() {
                Some(log) => {
                    log.errors.extend_from_slice(own);
                    log.blocks.extend(own_blocks);
                }
                None => logs.push(LogErrors {
                    path,
                    name,
                    is_fitted,
                    errors: own.to_vec(),
                    blocks: own_blocks,
                }),
            }
        }
        Some(logs)
    }

    /// The joints whose errors a case has, in their order.
    fn error_blocks(&self, case: &Case) -> Vec<ErrorBlock> {
        if let Some(channels) = self.scored_channels() {
            let targets = case.targets.iter();
            let series = targets.flat_map(|t| channels.series(&t.motion, self.most_errors()));
            let blocks = series.map(|series| ErrorBlock {
                channel: series.group,
                log: 0,
                count: series.count,
                resolution: series.step,
            });
            return blocks.collect();
        }
        let joints = self.simulator().joints(&case.experiment);
        let channel = |name: &str| joints.iter().position(|joint| joint == name);
        if self.definition().metric.is_pose() {
            return self.pose_blocks(case, channel);
        }
        let blocks = case.targets.iter().flat_map(|target| {
            let is_simulated = |name: &str| channel(name).is_some();
            let series = joint_error_series(&target.motion, is_simulated, self.most_errors());
            series.into_iter().map(|series| ErrorBlock {
                channel: channel(series.joint).unwrap_or(0),
                log: 0,
                count: series.count,
                resolution: series.resolution_rad,
            })
        });
        blocks.collect()
    }

    /// The quantities of a pose and the joints beside it whose errors a case has: the channels of joints come first.
    fn pose_blocks(&self, case: &Case, channel: impl Fn(&str) -> Option<usize>) -> Vec<ErrorBlock> {
        let joints = self.simulator().joints(&case.experiment).len();
        let mut blocks = Vec::new();
        for target in &case.targets {
            let is_simulated = |name: &str| channel(name).is_some();
            let (series, count) =
                pose_error_series(&target.motion, is_simulated, self.most_errors());
            blocks.extend(series.into_iter().map(|one| {
                let (channel, resolution) = match one {
                    PoseSeries::Pose(quantity) => (joints + quantity.number(), 0.0),
                    PoseSeries::Joint(joint) => (
                        channel(&joint.name).unwrap_or(0),
                        resolution(&joint.angles_rad).unwrap_or(0.0),
                    ),
                };
                ErrorBlock {
                    channel,
                    log: 0,
                    count,
                    resolution,
                }
            }));
        }
        blocks
    }

    /// Single errors of the fitted recordings in one list, with their joints and recordings; `None` where a case has none.
    pub(in crate::calibration) fn errors_of(
        &self,
        trial: &Trial,
    ) -> Option<(Vec<f64>, Vec<ErrorBlock>)> {
        let fitted = self.logs_of(trial)?.into_iter().filter(|log| log.is_fitted);
        let (mut errors, mut blocks) = (Vec::new(), Vec::new());
        for (log, known) in fitted.enumerate() {
            errors.extend(known.errors);
            blocks.extend(
                known
                    .blocks
                    .into_iter()
                    .map(|block| ErrorBlock { log, ..block }),
            );
        }
        (!errors.is_empty()).then_some((errors, blocks))
    }

    /// The information matrix of each recording, with its name and whether it is fitted. `around` is a point, followed by the points
    /// that differ from it in one coordinate each, as they were simulated. Empty where a run diverged.
    pub(in crate::calibration) fn informations(
        &self,
        channel_variances: &[Option<f64>],
        around: &[(&UnitPoint, &Trial)],
    ) -> Vec<LogInformation> {
        let Some(((at, trial), moved)) = around.split_first() else {
            return Vec::new();
        };
        let Some(here) = self.logs_of(trial) else {
            return Vec::new();
        };
        let there: Vec<_> = moved.iter().map(|(_, trial)| self.logs_of(trial)).collect();
        let informations = here.iter().enumerate().map(|(number, log)| {
            let points = moved.iter().map(|(point, _)| *point);
            let errors = there
                .iter()
                .map(|logs| Some(&*logs.as_ref()?[number].errors));
            let mut jacobian = slopes(at, &log.errors, points.zip(errors));
            let channels = log.blocks.iter();
            let channels =
                channels.flat_map(|block| std::iter::repeat_n(block.channel, block.count));
            for (mut row, channel) in jacobian.row_iter_mut().zip(channels) {
                let variance = channel_variances.get(channel).copied().flatten();
                row *= variance.map_or(0.0, |variance| 1.0 / variance.sqrt());
            }
            (
                log.name.to_owned(),
                log.is_fitted,
                jacobian.tr_mul(&jacobian),
            )
        });
        informations.collect()
    }

    /// The information gain of each recording, largest first. `around` is the point where least squares ended, followed by the
    /// points that differ from it in one coordinate each, as they were simulated.
    pub(in crate::calibration) fn motions(
        &self,
        known: &FitPrecision,
        around: &[(&UnitPoint, &Trial)],
    ) -> Vec<InformationGain> {
        let logs = self.informations(&known.channel_variances, around);
        let informations: Vec<(DMatrix<f64>, bool)> = logs
            .iter()
            .map(|(_, is_fitted, information)| (information.clone(), *is_fitted))
            .collect();
        let prior = DMatrix::from_diagonal(&DVector::from_column_slice(&known.prior));
        let added = added_information(&informations, &prior);
        let ranges = self.definition().grid.ranges();
        let gains = logs
            .iter()
            .zip(added)
            .filter_map(|((name, is_fitted, _), added)| {
                let added = added?;
                let names = ranges.iter().map(|range| range.parameter.name);
                Some(InformationGain {
                    recording: name.clone(),
                    is_fitted: *is_fitted,
                    bits: added.bits,
                    parameters: names.zip(added.parameters).collect(),
                })
            });
        let mut motions: Vec<InformationGain> = gains.collect();
        motions.sort_by(|a, b| b.bits.total_cmp(&a.bits));
        motions
    }
}

/// Most recordings that are listed.
const SAID: usize = 5;

/// Writes a line for each of the recordings with the largest gains, and for the one with the smallest.
pub(in crate::calibration) fn say(
    motions: &[InformationGain],
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    if motions.len() < 2 {
        return Ok(());
    }
    write!(f, "\n  what each recording tells that the others do not:")?;
    for (place, motion) in motions.iter().enumerate() {
        match place {
            place if place < SAID || place + 1 == motions.len() => write!(f, "\n    {motion}")?,
            SAID => write!(f, "\n    ...")?,
            _ => (),
        }
    }
    Ok(())
}

impl fmt::Display for InformationGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:.1} bits", self.recording, self.bits)?;
        let most = self.parameters.iter().max_by(|a, b| a.1.total_cmp(b.1));
        if let Some((name, bits)) = most {
            write!(f, ", {bits:.1} of {name}")?;
        }
        match self.is_fitted {
            true => Ok(()),
            false => write!(f, " (not fitted)"),
        }
    }
}
