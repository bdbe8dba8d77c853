//! Options that several commands share, as typed values.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use realgap::calibration::identification::StartState;
use realgap::calibration::{Overrides, Part, read_best, read_parameters};
use realgap::comparison::{self, Metric};
use realgap::search::read_indistinguishable;
use realgap::simulation::parameter::{Assignment, ParameterSet};
use realgap::simulation::{JointKind, Solver};
use realgap::warning::Code;
use realgap::{Error, Result, Warning};

use super::reading::ReadingOptions;

/// Most repeats: the distances of all pairs are held in memory.
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

/// At which times two trajectories are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum TimeOption {
    /// At equal fractions of their durations
    #[default]
    Relative,
    /// At equal times since their starts
    Absolute,
}

/// How parts are jointed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Joint {
    /// Multibody where a light part carries a heavy one, impulse for others and for more than 12 hinges
    Auto,
    /// Reduced coordinates
    Multibody,
    /// Constraints
    Impulse,
}

impl From<Joint> for JointKind {
    fn from(joint: Joint) -> Self {
        match joint {
            Joint::Auto => Self::Auto,
            Joint::Multibody => Self::Multibody,
            Joint::Impulse => Self::Impulse,
        }
    }
}

/// Help of `--timestep`, with the default that is used.
pub fn timestep_help() -> String {
    let default_s = Solver::default().timestep_s;
    format!(
        "Time per step, seconds [default: 1/{:.0}, or timestep_s where it is set]",
        1.0 / default_s
    )
}

/// Help of `--substeps`, with the default that is used.
pub fn substeps_help() -> String {
    format!(
        "Solver substeps per step [default: {}, or solver.substeps where it is set]",
        Solver::default().substeps
    )
}

/// Help of `--joint` of one run, with the default that is used.
pub fn joint_help() -> String {
    let default = format!("{:?}", Solver::default().joint).to_lowercase();
    format!("How parts are jointed [default: {default}, or solver.joint where it is set]")
}

/// Which state of a recording a run starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StartOption {
    /// The first sample as it is
    FirstSample,
    /// The first sample, its velocity corrected by half a sample of gravity
    HalfSample,
    /// Fitted to the flight before the first contact of the same recording
    Flight,
}

impl From<StartOption> for StartState {
    fn from(start: StartOption) -> Self {
        match start {
            StartOption::FirstSample => Self::FirstSample,
            StartOption::HalfSample => Self::HalfSampleCorrected,
            StartOption::Flight => Self::Flight,
        }
    }
}

/// Which recordings, and how they are read.
#[derive(Debug, Clone, Args)]
pub struct Recordings {
    /// Recordings in place of the study's own; quote the glob (repeatable)
    #[arg(long, value_name = "GLOB")]
    recordings: Vec<String>,
    /// Use only every N-th recording, in order of their paths: a part for fitting, the others for checking
    #[arg(long, value_name = "N", value_parser = parse_count)]
    every: Option<NonZeroUsize>,
    /// Where --every starts, 0 to N-1
    #[arg(long, value_name = "K", default_value_t = 0, requires = "every")]
    offset: usize,
    /// Use only the first N recordings (after --every)
    #[arg(long, value_name = "N", value_parser = parse_count)]
    limit_recordings: Option<NonZeroUsize>,
    #[command(flatten)]
    reading: ReadingOptions,
}

fn parse_count(text: &str) -> std::result::Result<NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "allowed: a whole number, 1 or more".to_owned())
}

impl Recordings {
    /// These recordings, everything else as the study says.
    pub fn overrides(&self) -> Result<Overrides> {
        Ok(Overrides {
            recordings: self.recordings.clone(),
            part: self
                .every
                .map(|every| Part::new(every.get(), self.offset))
                .transpose()?,
            limit_recordings: self.limit_recordings.map(NonZeroUsize::get),
            reading: self.reading.reading()?,
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

/// Whether other models are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Switch {
    /// Try them
    #[default]
    On,
    /// Spare their time
    Off,
}

/// How far models that are as valid part.
#[derive(Debug, Clone, Args)]
pub struct ModelErrorOption {
    /// Try models that are as valid: other steps, contacts at their limit, the other kind of joint (about as many runs again)
    #[arg(long, value_name = "SWITCH", value_enum, default_value_t)]
    model_error: Switch,
    /// Results folder of a sweep or tuning whose indistinguishable points take part as models, too
    #[arg(long, value_name = "DIR")]
    indistinguishable: Option<PathBuf>,
}

impl ModelErrorOption {
    /// The points that take part; `None` where no other model is to be tried.
    pub fn points(&self) -> Result<Option<Vec<ParameterSet>>> {
        match (self.model_error, &self.indistinguishable) {
            (Switch::Off, Some(_)) => Err(Error::usage(
                "nothing takes part in a model error that is off",
            )
            .field("--indistinguishable")
            .hint("leave --model-error on")),
            (Switch::Off, None) => Ok(None),
            (Switch::On, Some(folder)) => read_indistinguishable(folder).map(Some),
            (Switch::On, None) => Ok(Some(Vec::new())),
        }
    }
}

/// How many threads work in parallel.
#[derive(Debug, Clone, Args)]
pub struct Jobs {
    /// Threads, at most 256 or four a core [default: all cores]
    #[arg(short, long, value_name = "N", value_parser = parse_jobs)]
    jobs: Option<NonZeroUsize>,
}

/// More threads than this only fight for the cores.
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
    /// As asked for, or one a core.
    pub fn count(&self) -> usize {
        self.jobs
            .or_else(|| std::thread::available_parallelism().ok())
            .map_or(1, NonZeroUsize::get)
    }
}

/// Values for parameters, from files and from the command line.
#[derive(Debug, Clone, Args)]
pub struct Values {
    /// Set a parameter, e.g. `--set floor.friction=0.4` (repeatable; `realgap parameters` lists them)
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = parse_assignment)]
    set: Vec<Assignment>,
    /// Take parameters from a file such as the `best.ron` of a sweep (repeatable)
    #[arg(long = "parameters", value_name = "FILE")]
    parameters: Vec<PathBuf>,
}

/// clap prints the message itself, so the error is given as plain text.
fn parse_assignment(text: &str) -> std::result::Result<Assignment, String> {
    text.parse().map_err(|error: Error| error.to_string())
}

impl Values {
    /// The recordings that the values in the files were fitted on.
    pub fn fitted_on(&self) -> Result<Vec<String>> {
        let mut all = Vec::new();
        for path in &self.parameters {
            all.extend(read_best(path)?.1);
        }
        Ok(all)
    }

    /// All values: files first, in order, then `--set`.
    pub fn parameter_set(&self) -> Result<ParameterSet> {
        let mut all = ParameterSet::new();
        for path in &self.parameters {
            all = all.with_all(&read_parameters(path)?);
        }
        Ok(self
            .set
            .iter()
            .fold(all, |set, assignment| set.with(*assignment)))
    }
}

/// Values about recordings, where there are none.
pub fn recording_unused(values: &ParameterSet) -> Vec<Warning> {
    let idle = values
        .iter()
        .filter(|a| a.parameter.name.starts_with("recording."));
    idle.map(|a| {
        Warning::new(
            Code::NoEffect,
            format!(
                "{} has no effect: no recording is read here",
                a.parameter.name
            ),
        )
    })
    .collect()
}
