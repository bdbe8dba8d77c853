//! Studies of many robots: every robot has its own recordings, and all robots share the varied parameters, mainly those of the
//! floor.

use std::ops::Range;

use crate::calibration::{Definition, StartRule, Steering};
use realgap_core::{Error, Result};
use realgap_robot::morphology::Morphology;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{Parameter, ParameterSet};
use realgap_store::Fingerprint;

/// One of the robots of a study of many.
#[derive(Debug, Clone)]
pub struct Member {
    /// The robot with its gait.
    pub morphology: Morphology,
    /// SHA-256 of its file.
    pub sha256: String,
    /// Globs of its recordings, relative to the study's file.
    pub recording_globs: Vec<String>,
    /// Which of the study's recordings are its own.
    pub recordings: Range<usize>,
    /// Parameters that are fixed for it alone, after those of the study.
    pub set: ParameterSet,
    /// Where its runs start.
    pub start: StartRule,
    /// Its controller: its own, or else that of the study.
    pub steering: Option<Steering>,
    /// How many times each of its recordings counts.
    pub weight: f64,
}

impl Definition {
    /// The study of this robot alone.
    pub(in crate::calibration) fn of_member(&self, member: &Member) -> Self {
        Self {
            morphology: member.morphology.clone(),
            morphology_sha256: member.sha256.clone(),
            recording_globs: member.recording_globs.clone(),
            recordings: (self.recordings.get(member.recordings.clone()))
                .map(<[_]>::to_vec)
                .unwrap_or_default(),
            set: self.set.clone().with_all(&member.set),
            start: member.start,
            steering: member.steering.clone(),
            robots: Vec::new(),
            ..self.clone()
        }
    }

    /// The values that are fixed for a robot: all but those of other robots.
    pub(in crate::calibration) fn set_of(&self, robot: &Morphology) -> ParameterSet {
        let own = self.set.iter().filter(|assignment| {
            let about = assignment.parameter.robot();
            about.is_none_or(|name| name == robot.name())
        });
        own.fold(ParameterSet::new(), |set, assignment| set.with(*assignment))
    }

    /// An experiment in which the parameter has its default value.
    pub(in crate::calibration) fn untuned(&self, parameter: &Parameter) -> Experiment {
        let mut members = self.robots.iter();
        let owner = members.find(|member| parameter.robot() == Some(member.morphology.name()));
        match owner {
            Some(member) => self.of_member(member).experiment(),
            None => self.experiment(),
        }
    }

    /// The weights of the recordings' scores, 1 on average.
    pub(in crate::calibration) fn weights(&self) -> Vec<f64> {
        let mut weights = vec![1.0; self.recordings.len()];
        for member in &self.robots {
            weights[member.recordings.clone()].fill(member.weight);
        }
        let total: f64 = weights.iter().sum();
        let count = weights.len() as f64;
        weights
            .iter()
            .map(|weight| weight * count / total)
            .collect()
    }

    /// The fingerprint with an entry for every robot.
    pub(in crate::calibration) fn with_robots(&self, print: Fingerprint) -> Fingerprint {
        self.robots
            .iter()
            .enumerate()
            .fold(print, |print, (index, member)| {
                let controller = member.steering.as_ref().map(Steering::sha256);
                let print = controller.into_iter().fold(print, |print, sha256| {
                    print.with(format!("robot {index} controller sha256"), sha256)
                });
                print.with(
                    format!("robot {index} {}", member.morphology.name()),
                    format!(
                        "{}, recordings {:?}, {}, {:?}, weight {}",
                        member.sha256, member.recordings, member.set, member.start, member.weight
                    ),
                )
            })
    }
}

/// Checks that every parameter of a single robot names a robot of the study.
///
/// # Errors
/// A parameter of a robot that is not in the study.
pub(in crate::calibration) fn check_owners(definition: &Definition) -> Result<()> {
    let mut names = vec![definition.morphology.name()];
    let others = definition.robots.iter().skip(1);
    names.extend(others.map(|member| member.morphology.name()));
    let fixed = definition.set.iter().map(|assignment| assignment.parameter);
    for parameter in fixed.chain(definition.parameters.iter().copied()) {
        let Some(robot) = parameter.robot() else {
            continue;
        };
        if !names.contains(&robot) {
            return Err(Error::invalid("the study has no robot of this name")
                .field(parameter.name)
                .found(robot)
                .allowed(names.join(", ")));
        }
    }
    Ok(())
}
