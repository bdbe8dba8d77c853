//! What turns an experiment into a run: the engines of this crate, or a simulator of somebody else.

use std::fmt;
use std::sync::{Arc, LazyLock};

use super::control::Log;
use super::experiment::Experiment;
use super::numerics::vary_engine;
use super::run::{Run, run_built_in};
use super::watch::{Push, RunHooks};
use realgap_core::error::Result;
use realgap_core::warning::Warning;

/// What turns an experiment into a run. Everything that studies, ensembles and predictions simulate goes through it, so that they
/// do not know whose simulator it is.
pub trait Simulator: fmt::Debug + Send + Sync {
    /// Name and version of what simulates this experiment. They determine the results bit for bit, and are part of fingerprints.
    fn version(&self, experiment: &Experiment) -> &'static str;

    /// Simulates an experiment that was checked.
    ///
    /// # Errors
    /// Settings that cannot be simulated. A run that diverges or fails is an [`Outcome`](crate::Outcome).
    fn run(
        &self,
        experiment: &Experiment,
        pushes: &[Push],
        hooks: RunHooks<'_>,
    ) -> Result<(Run, Log)>;

    /// Gives an experiment the equally valid numerical settings with this number; 0 stands for its own.
    fn vary(&self, experiment: &mut Experiment, number: u64);

    /// Shortens the timestep of an experiment with the usual settings by a factor; false where the simulator has no such setting.
    fn refine(&self, experiment: &mut Experiment, factor: f64) -> bool {
        experiment.solver.timestep_s *= factor;
        true
    }

    /// Number of equally valid settings over which a score is the mean, where there are `usual` ones for the engines.
    fn settings(&self, usual: usize) -> usize;

    /// Names of the joints that its runs have.
    fn joints(&self, experiment: &Experiment) -> Vec<String>;

    /// Asks for a first run before a study, and says what the reader should know about the simulator.
    ///
    /// # Errors
    /// A simulator that cannot be used at all.
    fn prepare(&self, experiment: &Experiment) -> Result<Vec<Warning>>;
}

/// The engines of this crate, and the equations of vehicles.
#[derive(Debug, Clone, Copy)]
pub struct BuiltIn;

impl Simulator for BuiltIn {
    fn version(&self, experiment: &Experiment) -> &'static str {
        match experiment.vehicle {
            Some(_) => "two-wheel vehicle, no engine",
            None => experiment.engine().version(),
        }
    }

    fn run(
        &self,
        experiment: &Experiment,
        pushes: &[Push],
        hooks: RunHooks<'_>,
    ) -> Result<(Run, Log)> {
        run_built_in(experiment, pushes, hooks)
    }

    fn vary(&self, experiment: &mut Experiment, number: u64) {
        vary_engine(experiment, number);
    }

    fn settings(&self, usual: usize) -> usize {
        usual
    }

    fn joints(&self, experiment: &Experiment) -> Vec<String> {
        let hinges = experiment.assembly.hinges.iter();
        hinges.map(|hinge| hinge.name.clone()).collect()
    }

    fn prepare(&self, _: &Experiment) -> Result<Vec<Warning>> {
        Ok(Vec::new())
    }
}

/// The engines of this crate, shared by all experiments.
static BUILT_IN: LazyLock<Arc<dyn Simulator>> = LazyLock::new(|| Arc::new(BuiltIn));

/// The simulator of an experiment: the engines of this crate by default. Two choices are equal where they are the same object.
#[derive(Clone)]
pub struct SimulatorChoice(Arc<dyn Simulator>);

impl SimulatorChoice {
    /// Any simulator.
    pub fn new(simulator: Arc<dyn Simulator>) -> Self {
        Self(simulator)
    }

    /// The simulator.
    pub fn get(&self) -> &dyn Simulator {
        &*self.0
    }

    /// Whether the engines of this crate simulate.
    pub fn is_built_in(&self) -> bool {
        Arc::ptr_eq(&self.0, &BUILT_IN)
    }
}

impl Default for SimulatorChoice {
    fn default() -> Self {
        Self(Arc::clone(&BUILT_IN))
    }
}

impl fmt::Debug for SimulatorChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq for SimulatorChoice {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
