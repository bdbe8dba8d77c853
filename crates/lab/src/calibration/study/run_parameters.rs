//! Parameters that differ between runs: `each: Run` stands for one parameter per fitted recording.

use serde::Deserialize;

use crate::calibration::{Definition, Horizon};
use realgap_core::text::fits;
use realgap_core::{Error, Result};
use realgap_optimization::{Grid, Range};
use realgap_path::trajectory::Recording;
use realgap_simulation::Experiment;
use realgap_simulation::parameter::{Parameter, run_name};

/// What shares one value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Each {
    /// All runs of the study.
    #[default]
    Study,
    /// Every recording has a value of its own, e.g. the trim of a steering that was adjusted between the runs. Windows of a recording
    /// share it. A recording that was not fitted has the median of the others.
    Run,
}

impl Definition {
    /// The name of a recording, of which this one may be a window.
    pub(in crate::calibration) fn log_of<'a>(&self, recording: &'a Recording) -> &'a str {
        match self.horizon {
            Some(_) => Horizon::log_of(&recording.name),
            None => &recording.name,
        }
    }

    /// Whether a parameter differs between runs.
    fn has_runs(&self) -> bool {
        let fixed = self.set.iter().map(|assignment| assignment.parameter);
        let mut all = fixed.chain(self.parameters.iter().copied());
        all.any(|parameter| parameter.run().is_some())
    }

    /// Says to an experiment which run it is, where parameters differ between runs.
    pub(in crate::calibration) fn name_run(
        &self,
        experiment: &mut Experiment,
        recording: &Recording,
    ) {
        if self.has_runs() {
            experiment.run = Some(run_name(self.log_of(recording)).into());
        }
    }

    /// The names of the runs that are fitted, in the order of their recordings.
    fn fitted_runs(&self) -> Result<Vec<String>> {
        let held_out = match self.split {
            Some(split) => split.held_out(self.recordings.len(), self.seed)?,
            None => vec![false; self.recordings.len()],
        };
        let fitted = self.recordings.iter().zip(held_out);
        let mut names: Vec<String> = Vec::new();
        for (recording, _) in fitted.filter(|(_, held_out)| !held_out) {
            let name = run_name(self.log_of(recording));
            if !names.contains(&name) {
                names.push(name);
            }
        }
        Ok(names)
    }

    /// The definition with one parameter per fitted run in place of each that is [`Each::Run`].
    ///
    /// # Errors
    /// A parameter that is one of a robot or run already, or of a run that no recording is of.
    pub(in crate::calibration) fn with_runs(self) -> Result<Self> {
        if self.each.iter().all(|each| *each == Each::Study) {
            return self.with_known_runs();
        }
        let runs = self.fitted_runs()?;
        let (mut ranges, mut parameters, mut priors) = (Vec::new(), Vec::new(), Vec::new());
        let all = self
            .grid
            .ranges()
            .iter()
            .zip(&self.parameters)
            .zip(&self.priors);
        for (((range, parameter), prior), each) in all.zip(&self.each) {
            let own: Vec<&'static Parameter> = match each {
                Each::Study => vec![*parameter],
                Each::Run => runs
                    .iter()
                    .map(|run| parameter.of_run(run))
                    .collect::<Result<_>>()?,
            };
            for parameter in own {
                ranges.push(Range::new(parameter, range.from, range.to, range.points)?);
                parameters.push(parameter);
                priors.push(*prior);
            }
        }
        Self {
            grid: Grid::new(ranges)?,
            parameters,
            priors,
            each: Vec::new(),
            ..self
        }
        .with_known_runs()
    }

    /// Refuses a varied parameter of a run that no recording is of.
    fn with_known_runs(self) -> Result<Self> {
        let recordings = self.recordings.iter();
        let mut names: Vec<String> = recordings.map(|r| run_name(self.log_of(r))).collect();
        names.dedup();
        for parameter in &self.parameters {
            let Some(form) = parameter.run() else {
                continue;
            };
            if !names.iter().any(|name| fits(form, name)) {
                return Err(Error::invalid("no recording of this name")
                    .field(parameter.name)
                    .found(form)
                    .allowed(names.join(", ")));
            }
        }
        Ok(self)
    }
}
