//! What an ensemble of a study repeats, and the recordings it is held against.

use super::study::Study;
use crate::error::Result;
use crate::simulation::Experiment;
use crate::simulation::parameter::ParameterSet;
use crate::trajectory::Prepared;

/// One experiment of a study to be repeated, with the recordings that should show what its repeats show.
#[derive(Debug, Clone)]
pub struct RepeatCase {
    /// The study's name, or the recording's where every recording has its own start.
    pub name: String,
    /// The experiment with the study's fixed values.
    pub experiment: Experiment,
    /// Name and prepared path of each recording, in true lengths.
    pub real: Vec<(String, Prepared)>,
}

impl Study {
    /// The experiments to repeat: one where the start is settled, else one a recording.
    ///
    /// # Errors
    /// A start state that cannot be refined as the study asks.
    pub fn repeat_cases(&self, set: &ParameterSet) -> Result<Vec<RepeatCase>> {
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
                        Ok((name, target.prepared.clone()))
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
