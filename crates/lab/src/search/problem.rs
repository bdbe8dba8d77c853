//! A search: its space, its strategy and its objective.

use std::sync::Arc;

use super::{
    Body, FailureRules, FinalsSettings, GaitTuning, Objective, SettingsChoice, Space, Strategy,
};
use crate::prediction::UncertainParameters;
use realgap_robot::morphology::{Assembly, Morphology};
use realgap_simulation::parameter::ParameterSet;
use realgap_simulation::{EngineChoice, Experiment, Noise, Sampling};
use realgap_store::Fingerprint;

/// A search whose settings have been checked. It is made by [`Search::builder`] or read from a file by [`Search::read`].
#[derive(Debug, Clone)]
pub struct Search {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) description: String,
    pub(super) strategy: Arc<dyn Strategy>,
    pub(super) space: Space,
    pub(super) duration_s: f64,
    pub(super) set: ParameterSet,
    pub(super) uncertain: UncertainParameters,
    /// The middle of what repeats draw.
    pub(super) centre: ParameterSet,
    /// Name of the folder whose posterior is drawn from.
    pub(super) posterior_from: Option<String>,
    pub(super) noise: Noise,
    pub(super) noise_from: String,
    pub(super) objective: Objective,
    pub(super) repeats: usize,
    pub(super) failures: FailureRules,
    pub(super) settings: SettingsChoice,
    pub(super) gait: Option<GaitTuning>,
    pub(super) finals: FinalsSettings,
}

impl Search {
    /// Its name: the stem of its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Purpose of the search.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The strategy that chooses the robots.
    pub fn strategy(&self) -> &dyn Strategy {
        self.strategy.as_ref()
    }

    /// How genomes become robots.
    pub fn body(&self) -> &Body {
        self.space.body()
    }

    /// Length of each run, seconds.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Name of the folder whose posterior is drawn from, as it was given.
    pub fn posterior_from(&self) -> Option<&str> {
        self.posterior_from.as_deref()
    }

    /// Parameters whose values differ from repeat to repeat.
    pub fn uncertain(&self) -> &UncertainParameters {
        &self.uncertain
    }

    /// Noise of the repeats.
    pub fn noise(&self) -> &Noise {
        &self.noise
    }

    /// The objective.
    pub fn objective(&self) -> &Objective {
        &self.objective
    }

    /// Runs of every robot.
    pub fn repeats(&self) -> usize {
        self.repeats
    }

    /// How the best robots are judged again.
    pub fn finals(&self) -> &FinalsSettings {
        &self.finals
    }

    /// Seed of everything random.
    pub fn seed(&self) -> u64 {
        self.space.seed()
    }

    /// Name of a robot.
    pub fn robot_name(&self, index: usize) -> String {
        format!("robot_{index:05}")
    }

    /// The experiment of a robot without noise: with the fixed values, and with the middle of those that repeats draw.
    pub fn experiment(&self, robot: &Morphology) -> Experiment {
        let mut experiment = Experiment::new(robot.assemble());
        experiment.duration_s = self.duration_s;
        experiment.sampling = Sampling::Rate(60.0);
        self.centre.apply(&self.set.apply(&experiment))
    }

    /// The experiment of a robot with which the search explores: in the second engine, which is cheap, unless the search fixes
    /// `solver.engine` or a parameter that only Rapier has. Its finalists are judged in both.
    pub(crate) fn exploring(&self, robot: &Morphology) -> Experiment {
        let mut experiment = self.experiment(robot);
        if let Some(second) = self.explorer() {
            experiment.solver.engine = second;
        }
        experiment
    }

    /// The engine that explores, where another one judges.
    pub(super) fn explorer(&self) -> Option<EngineChoice> {
        let is_free = self.set.value("solver.engine").is_none();
        self.judge().second_engine().filter(|_| is_free)
    }

    /// Engines with their versions: the one that judges, and the one that explores.
    pub fn engines(&self) -> String {
        let judge = self.judge().engine_version();
        match self.explorer() {
            Some(explorer) => format!("{judge}, explored in {}", explorer.get().version()),
            None => judge.to_owned(),
        }
    }

    /// The fixed values, which do not depend on the robot.
    pub(super) fn judge(&self) -> Experiment {
        self.set.apply(&Experiment::new(Assembly::empty()))
    }

    /// Everything that decides the results.
    pub fn fingerprint(&self) -> Fingerprint {
        Fingerprint::new()
            .with("realgap", env!("CARGO_PKG_VERSION"))
            .with("engine", self.engines())
            .with("search", &self.name)
            .with("strategy", format!("{:?}", self.strategy))
            .with("body", format!("{:?}", self.body()))
            .with("duration_s", self.duration_s)
            .with("set", &self.set)
            .with("uncertain parameters", format!("{:?}", self.uncertain))
            .with("noise", format!("{:?}", self.noise))
            .with("objective", self.objective.label())
            .with("repeats", self.repeats)
            .with("failures", format!("{:?}", self.failures))
            .with("settings", format!("{:?}", self.settings))
            .with("gait", format!("{:?}", self.gait))
            .with("seed", self.seed())
    }
}
