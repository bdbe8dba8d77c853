//! The experiments of a study that an ensemble repeats, and the recordings that the ensemble is compared with.

use std::path::Path;

use crate::calibration::{Definition, Overrides, StartRule, Study};
use realgap_core::file::Source;
use realgap_core::{Code, Error, Result, Warning};
use realgap_path::trajectory::{Alignment, Prepared, prepare};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{Experiment, Noise, Sampling};

/// One experiment of a study that is repeated, with the recordings that its repeats are compared with.
#[derive(Debug, Clone)]
pub struct RepeatCase {
    /// The study's name, or the recording's where every recording has its own start.
    pub name: String,
    /// The experiment with the study's fixed values.
    pub experiment: Experiment,
    /// Name and prepared path of each recording, in true lengths.
    pub real: Vec<(String, Prepared)>,
}

/// A study whose experiments are repeated.
#[derive(Debug)]
pub struct Repeatable {
    /// The definition of the study.
    pub definition: Definition,
    /// Its experiments: one where the start is settled, otherwise one per recording.
    pub cases: Vec<RepeatCase>,
    /// What the reader should know.
    pub warnings: Vec<Warning>,
}

/// Samples per second of a run without recordings.
const RATE_HZ: f64 = 60.0;

impl Repeatable {
    /// Reads a study whose experiments are repeated. A study that names no recordings has to state the start and the length of
    /// the runs.
    ///
    /// # Errors
    /// As [`Study::read`].
    pub fn read(path: impl AsRef<Path>, overrides: &Overrides) -> Result<Self> {
        Self::parse(&Source::read(path, "study")?, overrides)
    }

    /// As [`Repeatable::read`], from a text.
    ///
    /// # Errors
    /// As [`Repeatable::read`].
    pub fn parse(source: &Source, overrides: &Overrides) -> Result<Self> {
        let alone = Definition::parse_without_recordings(source, overrides)?;
        if alone.recording_globs.is_empty() && overrides.recordings.is_empty() {
            Self::without_recordings(alone)
        } else {
            Self::new(Study::parse(source, overrides)?)
        }
    }

    /// A study with its recordings.
    ///
    /// # Errors
    /// A start state that cannot be refined as the study asks.
    pub fn new(study: Study) -> Result<Self> {
        Ok(Self {
            cases: study.repeat_cases(&ParameterSet::new())?,
            warnings: study.warnings().to_vec(),
            definition: study.into_definition(),
        })
    }

    fn without_recordings(definition: Definition) -> Result<Self> {
        let settled = definition.start == StartRule::Settled;
        let Some(duration_s) = definition.duration_s.filter(|_| settled) else {
            return Err(definition.at_file(
                Error::invalid(
                    "without recordings the study has to say itself where and how long the runs are",
                )
                .hint("add `duration_s` and `start: Settled` to the study, or name recordings"),
            ));
        };
        let mut experiment = definition.experiment();
        experiment.duration_s = duration_s;
        experiment.sampling = Sampling::Rate(RATE_HZ);
        experiment.check().map_err(|e| definition.at_file(e))?;
        let mut warnings = definition.robot_warnings();
        warnings.extend(experiment.warnings());
        warnings.push(Code::NoRecordings.warning(
            "the study names no recordings: nothing says whether these confidences are honest",
        ));
        Ok(Self {
            cases: vec![RepeatCase {
                name: definition.name.clone(),
                experiment,
                real: Vec::new(),
            }],
            warnings,
            definition,
        })
    }

    /// The noise of repeats that the study states.
    ///
    /// # Errors
    /// The study states no noise.
    pub fn noise(&self) -> Result<Noise> {
        self.definition.noise.ok_or_else(|| {
            self.definition.at_file(
                Error::invalid(
                    "the study does not say how repeats differ, so all of them would be the same run",
                )
                .field("noise")
                .found("no such section")
                .hint("add e.g. noise: (start_heading_rad: Normal(0.0175), friction_run_relative: LogNormal(0.05))"),
            )
        })
    }
}

impl Study {
    /// The experiments to repeat: one where the start is settled, otherwise one per recording.
    ///
    /// # Errors
    /// A start state that cannot be identified as the study asks.
    pub(in crate::calibration) fn repeat_cases(
        &self,
        set: &ParameterSet,
    ) -> Result<Vec<RepeatCase>> {
        let single = self.cases().len() == 1;
        (0..self.cases().len())
            .map(|index| {
                let experiment = self.experiment_with(index, set)?;
                let real = self.cases()[index]
                    .targets
                    .iter()
                    .map(|target| {
                        let name = self.definition().recordings[target.recording].name.clone();
                        let target = target.in_true_lengths(experiment.recording_length_scale)?;
                        // Repeats are turned by their own displacement, whatever the study's metric compares.
                        let path = match self.definition().align == Alignment::default() {
                            true => target.prepared.clone(),
                            false => prepare(&target.motion)?,
                        };
                        Ok((name, path))
                    })
                    .collect::<Result<Vec<_>>>()?;
                let name = match real.first() {
                    Some((recording, _)) if !single => recording.clone(),
                    _ => self.definition().name.clone(),
                };
                Ok(RepeatCase {
                    name,
                    experiment,
                    real,
                })
            })
            .collect()
    }
}
