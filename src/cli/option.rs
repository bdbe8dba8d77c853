//! Options that several commands share, as typed values.

use std::fmt::Display;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use realgap::calibration::{CommandConsent, Fitted, Mode, Overrides, Part};
use realgap::comparison::{self, Metric};
use realgap::identification::StartState;
use realgap::prediction::{ModelOptions, Mujoco, ThirdOpinion};
use realgap::search::read_posterior;
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::simulation::{ENGINES, Experiment, JointFormulation, Solver, engine_by_name};
use realgap::warning::Code;
use realgap::{Error, Result, RunOptions, Warning};

use super::consent::ConsentOption;
use super::reading::ReadingOptions;
use super::terminal::Answer;
use super::{interrupt, terminal};

/// Largest number of repeats: the distances of all pairs are held in memory.
pub const MOST_REPEATS: i64 = 5000;

/// How results are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Format {
    /// A table for people
    #[default]
    Table,
    /// JSON for machines
    Json,
}

/// The format of the output: a table for people, or JSON for machines.
#[derive(Debug, Clone, Copy, Args)]
pub struct Print {
    /// How to print
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Print {
    /// Whether the output is JSON.
    pub fn is_json(self) -> bool {
        self.format == Format::Json
    }

    /// Prints an answer: as JSON, or as this text.
    pub fn answer(self, answer: &impl Answer, text: impl FnOnce() -> String) -> Result<()> {
        match self.format {
            Format::Json => terminal::print_answer(answer)?,
            Format::Table => terminal::print(text()),
        }
        Ok(())
    }

    /// As [`Print::answer`], with the warnings below, so that an answer begins with its verdict.
    pub fn answer_above<'a>(
        self,
        warnings: impl IntoIterator<Item = &'a Warning>,
        answer: &impl Answer,
        text: impl FnOnce() -> String,
    ) -> Result<()> {
        self.answer(answer, text)?;
        terminal::print_warnings(warnings);
        Ok(())
    }

    /// As [`Print::answer`], for an answer that implements `Display`.
    pub fn value(self, answer: &(impl Answer + Display)) -> Result<()> {
        self.answer(answer, || answer.to_string())
    }
}

/// A choice of an option: its name, its value, and its line of help.
pub type Choice<T> = (&'static str, T, &'static str);

/// Reads one of these choices.
pub fn choice<T>(choices: &'static [Choice<T>]) -> impl TypedValueParser<Value = T>
where
    T: Clone + Send + Sync + 'static,
{
    let names = choices.iter().map(|(name, _, help)| {
        let name = PossibleValue::new(*name);
        if help.is_empty() {
            name
        } else {
            name.help(*help)
        }
    });
    PossibleValuesParser::new(names).map(move |typed| {
        let chosen = choices.iter().find(|(name, ..)| *name == typed);
        // The parser accepts no other names.
        chosen.unwrap_or(&choices[0]).1.clone()
    })
}

/// Formulations of joints.
pub const JOINTS: &[Choice<JointFormulation>] = &[
    (
        "auto",
        JointFormulation::Auto,
        "Multibody for robots of bodies, and for cubes where a light part carries a heavy one in at most 12 hinges; impulse otherwise",
    ),
    (
        "multibody",
        JointFormulation::Multibody,
        "Reduced coordinates",
    ),
    (
        "impulse",
        JointFormulation::Impulse,
        "Constraints between free bodies",
    ),
];

/// Help of `--timestep`, with the default that is used.
fn timestep_help() -> String {
    let default_s = Solver::default().timestep_s;
    format!(
        "Time per step, seconds [default: 1/{:.0}, or timestep_s where it is set]",
        1.0 / default_s
    )
}

/// Help of `--substeps`, with the default that is used.
fn substeps_help() -> String {
    format!(
        "Solver substeps per step [default: {}, or solver.substeps where it is set]",
        Solver::default().substeps
    )
}

/// Help of `--joint` of one run, with the default that is used.
fn joint_help() -> String {
    let default = format!("{:?}", Solver::default().joint).to_lowercase();
    format!("Formulation of joints [default: {default}, or solver.joint where it is set]")
}

/// Which state of a recording a run starts from.
pub const STARTS: &[Choice<StartState>] = &[
    (
        "first-sample",
        StartState::FirstSample,
        "The first sample as it is",
    ),
    (
        "half-sample",
        StartState::HalfSampleCorrected,
        "The first sample, its velocity corrected by half a sample of gravity",
    ),
    (
        "flight",
        StartState::Flight,
        "Fitted to the flight before the first contact of the same recording",
    ),
];

/// Headings of the help; options below one heading belong together.
const RECORDINGS: &str = "Which recordings";
const VALUES: &str = "Values of parameters";
const SOLVER: &str = "Settings of the solver";

/// Which recordings, and how they are read.
#[derive(Debug, Clone, Args)]
pub struct Recordings {
    /// Recordings in place of the study's own; quote the glob (repeatable)
    #[arg(long, help_heading = RECORDINGS, value_name = "GLOB")]
    recordings: Vec<String>,
    /// Use only every N-th recording in the order of their paths, e.g. to fit on some recordings and check on others
    #[arg(long, help_heading = RECORDINGS, value_name = "N", value_parser = parse_count)]
    every: Option<NonZeroUsize>,
    /// Where --every starts, 0 to N-1
    #[arg(long, help_heading = RECORDINGS, value_name = "K", default_value_t = 0, requires = "every")]
    offset: usize,
    /// Use only the first N recordings (after --every)
    #[arg(long, help_heading = RECORDINGS, value_name = "N", value_parser = parse_count)]
    limit_recordings: Option<NonZeroUsize>,
    #[command(flatten)]
    reading: ReadingOptions,
    #[command(flatten)]
    consent: ConsentOption,
}

fn parse_count(text: &str) -> std::result::Result<NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "allowed: a whole number, 1 or more".to_owned())
}

impl Recordings {
    /// Overrides with these recordings; everything else is as in the study.
    pub fn overrides(&self) -> Result<Overrides> {
        Ok(Overrides {
            recordings: self.recordings.clone(),
            part: self
                .every
                .map(|every| Part::new(every.get(), self.offset))
                .transpose()?,
            limit_recordings: self.limit_recordings.map(NonZeroUsize::get),
            reading: self.reading.reading()?,
            command: self.consent.or(CommandConsent::Refused),
            ..Overrides::default()
        })
    }
}

/// The metric that `--metric` names.
pub fn metric_option(name: Option<&str>) -> Result<Option<&'static dyn Metric>> {
    name.map(comparison::by_name)
        .transpose()
        .map_err(Error::into_usage)
}

/// Whether the model error is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Switch {
    /// Simulate other models
    #[default]
    On,
    /// Skip them, which saves time
    Off,
}

/// Options of the model error: how far the results of equally valid models differ.
#[derive(Debug, Clone, Args)]
pub struct ModelErrorOption {
    /// Also simulate equally valid models: other timesteps and substeps, contacts at the limit of hardness, the other formulation
    /// of joints (about as many runs again)
    #[arg(long, value_name = "SWITCH", value_enum, default_value_t)]
    model_error: Switch,
    /// Results folder of a sweep or tuning whose posterior draws (indistinguishable.csv) are simulated as further models
    #[arg(long, value_name = "DIR")]
    posterior: Option<PathBuf>,
    /// Who says what another engine would do: MuJoCo itself, with the draws of the first repeats, where a Python with the package
    /// mujoco is found, or a table of what it did with other robots. The answer names who it was [default: auto]
    #[arg(long, value_enum, value_name = "WHO")]
    other_engine: Option<OtherEngine>,
    /// The Python that has mujoco [default: REALGAP_PYTHON of the environment, else python3]
    #[arg(long, value_name = "PYTHON")]
    python: Option<String>,
}

/// Who says what another engine would do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum OtherEngine {
    /// MuJoCo; the table where it cannot answer, and the answer says why
    #[default]
    Auto,
    /// MuJoCo; an error where it cannot answer
    Mujoco,
    /// The table, which is the same on every machine
    Table,
}

impl ModelErrorOption {
    /// What the model error is computed from; `None` where it is off.
    pub fn options(&self) -> Result<Option<ModelOptions>> {
        let wanted = [
            ("--posterior", self.posterior.is_some()),
            ("--other-engine", self.other_engine.is_some()),
            ("--python", self.python.is_some()),
        ];
        let wanted = wanted.iter().find(|(_, is_given)| *is_given);
        if let (Switch::Off, Some((name, _))) = (self.model_error, wanted) {
            return Err(
                Error::usage(format!("{name} belongs to the model error, which is off"))
                    .field(*name)
                    .hint("leave --model-error on"),
            );
        }
        if self.model_error == Switch::Off {
            return Ok(None);
        }
        let points = self.posterior.as_deref().map(read_posterior).transpose()?;
        Ok(Some(ModelOptions {
            points: points.unwrap_or_default(),
            third_opinion: self.third_opinion(),
        }))
    }

    fn third_opinion(&self) -> ThirdOpinion {
        let python = self.python.clone();
        let python = python.or_else(|| std::env::var("REALGAP_PYTHON").ok());
        let python = python.unwrap_or_else(|| "python3".to_owned());
        // It is started elsewhere than here; a name alone is found along the search path.
        let python = match python.contains('/') {
            true => std::path::absolute(&python).map_or(python, |path| path.display().to_string()),
            false => python,
        };
        let mujoco = Mujoco::new(python);
        match self.other_engine.unwrap_or_default() {
            OtherEngine::Auto => ThirdOpinion::Mujoco(mujoco),
            OtherEngine::Mujoco => ThirdOpinion::OnlyMujoco(mujoco),
            OtherEngine::Table => ThirdOpinion::Table,
        }
    }
}

/// How many threads work in parallel.
#[derive(Debug, Clone, Args)]
pub struct Jobs {
    /// Number of threads, at most 256 or four per core [default: all cores]
    #[arg(short, long, value_name = "N", value_parser = parse_jobs)]
    jobs: Option<NonZeroUsize>,
}

/// More threads than this only compete for the cores.
fn most_jobs() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (4 * cores).max(256)
}

fn parse_jobs(text: &str) -> std::result::Result<NonZeroUsize, String> {
    let most = most_jobs();
    text.parse()
        .ok()
        .filter(|jobs: &NonZeroUsize| jobs.get() <= most)
        .ok_or_else(|| format!("allowed: 1 to {most}"))
}

impl Jobs {
    /// The number of `--jobs`; without this option one per core.
    pub fn count(&self) -> usize {
        self.jobs
            .or_else(|| std::thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get)
    }

    /// The options of a run on these threads, without progress.
    pub fn run(&self) -> RunOptions<'static> {
        RunOptions {
            jobs: self.count(),
            ..RunOptions::default()
        }
    }

    /// As [`Jobs::run`]; Ctrl-C ends the run, and its results so far are kept.
    pub fn stoppable(&self) -> RunOptions<'static> {
        RunOptions {
            stop: Some(interrupt::stop_flag()),
            ..self.run()
        }
    }
}

/// What to do with results that exist already.
#[derive(Debug, Clone, Copy, Args)]
pub struct Before {
    /// Continue an interrupted run
    #[arg(long, conflicts_with = "restart")]
    resume: bool,
    /// Delete old results in the folder and start again
    #[arg(long)]
    restart: bool,
}

impl Before {
    pub fn mode(self) -> Mode {
        match (self.resume, self.restart) {
            (true, _) => Mode::Resume,
            (_, true) => Mode::Restart,
            _ => Mode::Start,
        }
    }
}

/// Values for parameters, from files and from the command line.
#[derive(Debug, Clone, Args)]
pub struct Values {
    /// Set a parameter, e.g. `--set floor.friction=0.4` (repeatable; `realgap study parameters` lists them)
    #[arg(long = "set", help_heading = VALUES, value_name = "NAME=VALUE", value_parser = parse_assignment)]
    set: Vec<Assignment>,
    /// Take parameters from a file such as the `best.ron` of a sweep (repeatable)
    #[arg(long = "parameters", help_heading = VALUES, value_name = "FILE")]
    parameters: Vec<PathBuf>,
    /// Physics engine by name, the same as --set solver.engine [default: tree for a robot of bodies with more than 12 joints, rapier for others, unless the file says otherwise]
    #[arg(long, help_heading = VALUES, value_name = "NAME", value_parser = engine)]
    engine: Option<Assignment>,
}

/// The engine of this name; otherwise an error that lists the engines.
fn engine(name: &str) -> std::result::Result<Assignment, String> {
    let chosen = engine_by_name(name).map_err(|error| error.to_string())?;
    let index = ENGINES.iter().position(|engine| *engine == chosen);
    parse_assignment(&format!("solver.engine={}", index.unwrap_or_default()))
}

/// clap prints the message itself, so the error is returned as plain text.
fn parse_assignment(text: &str) -> std::result::Result<Assignment, String> {
    text.parse().map_err(|error: Error| error.to_string())
}

impl Values {
    /// The values of the files, overridden by `--set` and `--engine`, with the posterior draws and the fitted recordings of the files.
    pub fn fitted(&self) -> Result<Fitted> {
        let set = self.set.iter().chain(&self.engine).copied();
        Ok(Fitted::read(&self.parameters)?.with_values(&set.collect()))
    }

    /// Overrides with these values in place of the study's.
    pub fn over(&self, overrides: Overrides) -> Result<Overrides> {
        let Fitted {
            values: set,
            draws,
            fitted_on,
        } = self.fitted()?;
        Ok(Overrides {
            set,
            draws,
            fitted_on,
            ..overrides
        })
    }

    /// The experiment with all values, and warnings about values without effect; no recording is read.
    pub fn apply(&self, experiment: &Experiment) -> Result<(Experiment, Vec<Warning>)> {
        let values = self.parameter_set()?;
        let mut warnings = values.without_effect(experiment);
        warnings.extend(recording_unused(&values));
        Ok((values.apply(experiment), warnings))
    }

    /// All values: files first, in order, then `--set` and `--engine`.
    pub fn parameter_set(&self) -> Result<ParameterSet> {
        Ok(self.fitted()?.values)
    }
}

/// Settings of one run in place of the robot's own.
#[derive(Debug, Clone, Args)]
pub struct SolverOptions {
    #[arg(long, help_heading = SOLVER, value_name = "S", help = timestep_help())]
    timestep: Option<f64>,
    #[arg(long, help_heading = SOLVER, value_name = "N", help = substeps_help())]
    substeps: Option<usize>,
    #[arg(long, help_heading = SOLVER, value_parser = choice(JOINTS), help = joint_help())]
    pub joint: Option<JointFormulation>,
}

impl SolverOptions {
    /// The experiment with these settings.
    pub fn apply(&self, mut experiment: Experiment) -> Experiment {
        let solver = &mut experiment.solver;
        solver.timestep_s = self.timestep.unwrap_or(solver.timestep_s);
        solver.substeps = self.substeps.unwrap_or(solver.substeps);
        solver.joint = self.joint.unwrap_or(solver.joint);
        experiment
    }
}

/// Warnings about values `recording.*` where no recording is read.
pub fn recording_unused(values: &ParameterSet) -> Vec<Warning> {
    let idle = values
        .iter()
        .filter(|a| a.parameter.name.starts_with("recording."));
    idle.map(|a| {
        Code::NoEffect.warning(format!(
            "{} has no effect: no recording is read here",
            a.parameter.name
        ))
    })
    .collect()
}
