//! Resting faces: which face ends down how often in reality, and how often when every recording is simulated once.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::calibration::{Definition, StartRule, StartUsed, Study, by_name};
use realgap_core::{Code, Error, Result, Warning};
use realgap_identification::{face_down, is_at_rest};
use realgap_optimization::RunOptions;
use realgap_path::trajectory::Trajectory;
use realgap_robot::morphology::Face;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::ParameterSet;

/// How often a face ended down, in reality and in simulation, over the recordings that end at rest.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FaceOdds {
    /// Name of the face in the tracked module's frame.
    pub face: &'static str,
    /// Recordings that really ended on the face.
    pub real: usize,
    /// Recordings whose simulation ended on the face.
    pub simulated: usize,
    /// Recordings that ended on the face both really and in simulation.
    pub both: usize,
}

impl FaceOdds {
    /// Counts over (real, simulated) faces of recordings that end at rest, one entry a face in the order of
    /// [`Face::ALL`]. A simulation that diverged has no face.
    pub fn count(ends: &[(&'static str, Option<&'static str>)]) -> Vec<Self> {
        Face::ALL
            .iter()
            .map(|face| {
                let name = face.name();
                let real = ends.iter().filter(|(real, _)| *real == name);
                Self {
                    face: name,
                    real: real.clone().count(),
                    simulated: ends.iter().filter(|(_, s)| *s == Some(name)).count(),
                    both: real.filter(|(_, s)| *s == Some(name)).count(),
                }
            })
            .collect()
    }
}

/// Resting faces of recordings beside those of their simulations.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RestingOdds {
    /// Recordings that end at rest: each was simulated once, to its end.
    pub simulations: usize,
    /// Simulations that diverged; they have no face.
    pub diverged: usize,
    /// Recordings that end on the same face as their simulation.
    pub same_face: usize,
    /// Counts, in the order of the faces' names in files.
    pub faces: Vec<FaceOdds>,
    /// What was simulated: every value that was identified, that the study, files or command line fix, or that the
    /// study leaves free (at its default).
    pub values: BTreeMap<String, f64>,
    /// Which of the values were identified.
    pub identified: Vec<String>,
    /// Which of the values are defaults because the study leaves them free and none was given.
    pub at_default: Vec<String>,
    /// Which start state the runs have.
    pub start: StartUsed,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// The face that points down in the last sample; `None` without orientations.
pub(in crate::calibration) fn face_at_end(
    motion: &Trajectory,
    experiment: &Experiment,
) -> Option<&'static str> {
    let last = motion.orientations_world_from_body()?.last()?;
    Some(face_down(last, &experiment.floor.normal_world()).name())
}

impl Definition {
    /// Indices of the recordings that end at rest.
    ///
    /// # Errors
    /// Runs that do not start from recordings, or no recording that ends at rest.
    pub(crate) fn at_rest(&self) -> Result<Vec<usize>> {
        if self.start == StartRule::Settled {
            return Err(self.at_file(
                Error::invalid("a settled start says nothing about how tosses come to rest")
                    .field("start")
                    .hint("use `start: FromRecording`"),
            ));
        }
        let all = self.recordings.iter().enumerate();
        let resting = all.filter(|(_, recording)| is_at_rest(&recording.trajectory));
        let resting: Vec<usize> = resting.map(|(index, _)| index).collect();
        if resting.is_empty() {
            return Err(self.at_file(Error::invalid("no recording ends at rest")));
        }
        Ok(resting)
    }

    /// Simulates every recording that ends at rest once, from its start to its end, with the study's fixed values and then
    /// `identified`.
    ///
    /// # Errors
    /// A study whose runs do not start from recordings, no recording that ends at rest, settings that cannot be simulated, or
    /// the run was stopped.
    pub fn resting_odds(
        mut self,
        identified: &ParameterSet,
        run: &RunOptions<'_>,
    ) -> Result<RestingOdds> {
        self.at_rest()?;
        // As for the real counts, whole recordings count, even where the study compares a part of them.
        self.duration_s = None;
        let (recordings, sha256) = std::mem::take(&mut self.recordings)
            .into_iter()
            .zip(std::mem::take(&mut self.recordings_sha256))
            .filter(|(recording, _)| is_at_rest(&recording.trajectory))
            .unzip();
        (self.recordings, self.recordings_sha256) = (recordings, sha256);
        let fixed = self.set.clone().with_all(identified);
        let study = Study::new(self)?;
        let ends = run.each(study.cases().len(), |case| ends_of(&study, case, &fixed))?;
        let free = study
            .definition()
            .parameters
            .iter()
            .filter(|parameter| fixed.value(parameter.name).is_none());
        let (mut values, mut at_default) = (BTreeMap::new(), Vec::new());
        for parameter in free {
            if let Some(value) = parameter.value(&study.cases()[0].experiment) {
                values.insert(parameter.name.to_owned(), value);
                at_default.push(parameter.name.to_owned());
            }
        }
        values.extend(by_name(&fixed));
        let mut warnings = study.warnings().to_vec();
        if !at_default.is_empty() {
            warnings.push(Code::FreeParameter.warning(format!(
                "simulated resting faces: no value is given for {}; the defaults are used",
                at_default.join(", ")
            )));
        }
        Ok(RestingOdds {
            simulations: ends.len(),
            diverged: ends.iter().filter(|(_, s)| s.is_none()).count(),
            same_face: ends.iter().filter(|(real, s)| *s == Some(*real)).count(),
            faces: FaceOdds::count(&ends),
            values,
            identified: identified
                .iter()
                .map(|a| a.parameter.name.to_owned())
                .collect(),
            at_default,
            start: study.definition().start_used(),
            warnings,
        })
    }
}

/// The real and the simulated face of a case with a recording of its own.
fn ends_of(
    study: &Study,
    case: usize,
    set: &ParameterSet,
) -> Result<(&'static str, Option<&'static str>)> {
    let experiment = study.experiment_with(case, set)?;
    let target = &study.cases()[case].targets[0];
    let real = face_at_end(&target.motion, &experiment).ok_or_else(|| {
        Error::invalid("a recording without orientations has no face that is down")
            .at_file(&study.definition().recordings[target.recording].path)
    })?;
    let run = realgap_simulation::run(&experiment)?;
    let motion = run.outcome.completed();
    Ok((
        real,
        motion.and_then(|motion| face_at_end(&motion, &experiment)),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_counts_where_it_is_down_and_agreement_only_within_a_recording() {
        let ends = [
            ("PosX", Some("PosX")),
            ("PosX", Some("NegZ")),
            ("NegZ", Some("PosX")),
            ("NegZ", None),
        ];
        let odds = FaceOdds::count(&ends);
        let of = |name: &str| {
            let found = odds.iter().find(|o| o.face == name).unwrap();
            [found.real, found.simulated, found.both]
        };
        assert_eq!(of("PosX"), [2, 2, 1]);
        assert_eq!(of("NegZ"), [2, 1, 0]);
        assert_eq!(of("PosY"), [0, 0, 0]);
    }
}
