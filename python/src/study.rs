//! Studies, and their sweeps and tunings.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use realgap::calibration::{
    self, BasisRule, CommandConsent, Commands, Overrides, Part, RecordedCommand, Repeatable,
    ScoreRule, Split, TuneOptions, recording_id,
};
use realgap::comparison::Metric;
use realgap::identification::StartState;
use realgap::optimization::optimizer_by_name;
use realgap::results::{self, Kind};
use realgap::simulation::Noise;
use realgap::simulation::parameter::ParameterSet;
use realgap::trajectory::{Reading, Recording};
use realgap::{Error, Result};
use serde::Deserialize;
use serde_json::json;

use crate::answer::Answer;
use crate::callback::{self, PythonOptimizer};
use crate::error::Raise;
use crate::finding::{self, Finding};
use crate::folder::{into_folder, mode_of, source};
use crate::robot::Robot;
use crate::running::{self, Way};
use crate::simulation::{fitted, values};
use crate::simulator;
use crate::text::{of_text, to_text};
use crate::trajectory::Trajectory;

/// Arguments that override the text of a study.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wishes {
    recordings: Vec<String>,
    every: Option<usize>,
    offset: usize,
    limit_recordings: Option<usize>,
    duration_s: Option<f64>,
    points: Option<usize>,
    seed: Option<u64>,
    score: Option<String>,
    basis: Option<String>,
    set: BTreeMap<String, f64>,
    parameters: Vec<PathBuf>,
    folds: Option<usize>,
    hold_out: Option<f64>,
    reading: Reading,
    allow_command: bool,
}

/// The fields of a study that is built from objects.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    name: String,
    vary: Vec<(String, f64, f64, usize)>,
    set: BTreeMap<String, f64>,
    duration_s: Option<f64>,
    start: String,
    score: Option<String>,
    seed: u64,
    folds: Option<usize>,
    hold_out: Option<f64>,
    noise: Option<Noise>,
    /// Whether servos follow the recorded commands; `None` where they do as soon as there are any.
    commands: Option<bool>,
}

/// Number of repeats of the rule `ensemble` without a number.
const REPEATS: usize = 16;

fn score_rule(text: &str) -> Result<ScoreRule> {
    let unknown = || {
        Error::usage("not a rule for the simulations of a score")
            .field("score")
            .found(text)
            .allowed("valid, ensemble, ensemble:N, single")
    };
    match text.split_once(':') {
        None if text == "valid" => Ok(ScoreRule::Valid),
        None if text == "single" => Ok(ScoreRule::Single),
        None if text == "ensemble" => Ok(ScoreRule::Ensemble { repeats: REPEATS }),
        Some(("ensemble", repeats)) => match repeats.parse() {
            Ok(repeats) => Ok(ScoreRule::Ensemble { repeats }),
            Err(_) => Err(unknown()),
        },
        _ => Err(unknown()),
    }
}

fn split(folds: Option<usize>, hold_out: Option<f64>) -> Result<Option<Split>> {
    match (folds, hold_out) {
        (Some(_), Some(_)) => Err(Error::usage("folds and hold_out exclude each other")),
        (Some(folds), None) => Ok(Some(Split::Folds(folds))),
        (None, Some(share)) => Ok(Some(Split::HoldOut(share))),
        (None, None) => Ok(None),
    }
}

impl Wishes {
    fn overrides(self, metric: Option<&'static dyn Metric>) -> Result<Overrides> {
        let fitted = fitted(&self.parameters, &self.set)?;
        Ok(Overrides {
            recordings: self.recordings,
            part: self
                .every
                .map(|every| Part::new(every, self.offset))
                .transpose()?,
            limit_recordings: self.limit_recordings,
            metric,
            basis: match self.basis.as_deref() {
                None => None,
                Some("recordings") => Some(BasisRule::Recordings),
                Some(file) => Some(BasisRule::read(file)?),
            },
            score: self.score.as_deref().map(score_rule).transpose()?,
            duration_s: self.duration_s,
            points: self.points,
            seed: self.seed,
            set: fitted.values,
            draws: fitted.draws,
            fitted_on: fitted.fitted_on,
            reading: self.reading,
            command: match self.allow_command {
                true => CommandConsent::Given,
                false => CommandConsent::Refused,
            },
            split: split(self.folds, self.hold_out)?,
            ..Overrides::default()
        })
    }
}

/// A study, ready to run.
#[pyclass(frozen, module = "realgap._native")]
pub struct Study {
    pub study: Arc<calibration::Study>,
}

#[pymethods]
impl Study {
    /// Parses a text, RON or JSON; its path is `path`, even where no such file exists.
    #[staticmethod]
    fn parse(
        py: Python<'_>,
        path: PathBuf,
        text: Option<String>,
        is_json: bool,
        metric: Option<Bound<'_, PyAny>>,
        wishes: &str,
    ) -> PyResult<Self> {
        let metric = metric.as_ref().map(callback::metric).transpose()?;
        let way = Way {
            jobs: None,
            progress: None,
        };
        let study = running::run(py, &way, |options| {
            let overrides = of_text::<Wishes>("a study", wishes)?.overrides(metric)?;
            let source = source(path, text, is_json, "study")?;
            options.install(|| calibration::Study::parse(&source, &overrides))?
        })?;
        Ok(Self {
            study: Arc::new(study),
        })
    }

    /// Builds a study from objects.
    #[staticmethod]
    fn build(
        py: Python<'_>,
        robot: Option<&Robot>,
        respond: Option<(Py<PyAny>, String)>,
        recordings: Vec<Bound<'_, Trajectory>>,
        metric: Option<Bound<'_, PyAny>>,
        said: &str,
    ) -> PyResult<Self> {
        let metric = metric.as_ref().map(callback::metric).transpose()?;
        let recordings: Vec<_> = recordings
            .iter()
            .map(|r| (*r.get().recording).clone())
            .collect();
        let way = Way {
            jobs: None,
            progress: None,
        };
        let study = running::run(py, &way, |options| {
            let said: Said = of_text("a study", said)?;
            let builder = match (robot, respond) {
                (Some(robot), None) => {
                    calibration::Study::builder(said.name, robot.morphology.clone())
                }
                (None, Some((respond, identity))) => {
                    let own = simulator::own(respond, identity)?;
                    calibration::Study::builder_of(said.name, own)?
                }
                _ => {
                    return Err(Error::usage("a study is of a robot or of a simulator")
                        .allowed("robot, or simulate"));
                }
            };
            let mut builder = builder.seed(said.seed);
            let given = recordings.clone();
            for recording in recordings {
                builder = builder.recording(recording);
            }
            for (name, from, to, points) in said.vary {
                builder = builder.vary(name, from, to, points);
            }
            for (name, value) in said.set {
                builder = builder.set(name, value);
            }
            if let Some(metric) = metric {
                builder = builder.metric(metric);
            }
            if let Some(duration_s) = said.duration_s {
                builder = builder.duration_s(duration_s);
            }
            if let Some(score) = &said.score {
                builder = builder.score(score_rule(score)?);
            }
            if let Some(split) = split(said.folds, said.hold_out)? {
                builder = builder.split(split);
            }
            if let Some(noise) = said.noise {
                builder = builder.noise(noise);
            }
            if let Some(robot) = robot
                && follows_commands(robot, &given, said.commands)?
            {
                builder = builder.commands(Commands::default());
            }
            builder = match said.start.as_str() {
                "settled" => builder,
                "first-sample" => builder.start_from_recordings(StartState::FirstSample),
                "half-sample" => builder.start_from_recordings(StartState::HalfSampleCorrected),
                "flight" => builder.start_from_recordings(StartState::Flight),
                other => {
                    return Err(Error::usage("not a way to start")
                        .field("start")
                        .found(other)
                        .allowed("settled, first-sample, half-sample, flight"));
                }
            };
            options.install(|| builder.build())?
        })?;
        Ok(Self {
            study: Arc::new(study),
        })
    }

    fn info(&self, py: Python<'_>) -> PyResult<String> {
        let definition = self.study.definition();
        let ranges = definition.grid.ranges().iter();
        let ranges = ranges.map(|range| {
            json!({"name": range.parameter.name, "from": range.from, "to": range.to, "points": range.points})
        });
        let recordings = definition.recordings.iter();
        let set: BTreeMap<&str, f64> = definition
            .set
            .iter()
            .map(|a| (a.parameter.name, a.value))
            .collect();
        let info = json!({
            "name": definition.name,
            "description": definition.description,
            "robot": definition.morphology.name(),
            "parameters": ranges.collect::<Vec<_>>(),
            "set": set,
            "metric": definition.metric.name(),
            "unit": definition.metric.unit(),
            "seed": definition.seed,
            "points": definition.grid.len(),
            "recordings": recordings.clone().map(|r| &r.name).collect::<Vec<_>>(),
            "recording_ids": recordings.map(recording_id).collect::<Vec<_>>(),
            "has_noise": definition.noise.is_some(),
            "warnings": self.study.warnings(),
        });
        to_text(&info).or_raise(py)
    }

    fn recordings(&self) -> Vec<Trajectory> {
        let recordings = self.study.definition().recordings.iter();
        recordings
            .map(|recording| Trajectory {
                recording: Arc::new(recording.clone()),
            })
            .collect()
    }

    /// The same study with these values fixed.
    fn at(&self, py: Python<'_>, set: BTreeMap<String, f64>) -> PyResult<Self> {
        at(py, &self.study, &set, Vec::new(), &[])
    }

    /// The values of parameters at a point of coordinates from 0 to 1.
    fn values(&self, point: Vec<f64>) -> Vec<f64> {
        self.study.definition().grid.values_at(&point)
    }

    /// Simulates every recording once with the values of the study.
    fn evaluate(
        &self,
        py: Python<'_>,
        jobs: Option<i64>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Finding> {
        let way = Way { jobs, progress };
        running::run(py, &way, |run| finding::evaluated(&self.study, run))
    }

    /// What the recordings say without a fit.
    fn identify(
        &self,
        py: Python<'_>,
        explain: &str,
        jobs: Option<i64>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Finding> {
        let way = Way { jobs, progress };
        running::run(py, &way, |run| {
            finding::identified(&self.study, explain, run)
        })
    }

    #[pyo3(signature = (jobs, folder, mode, progress, audit))]
    fn sweep(
        &self,
        py: Python<'_>,
        jobs: Option<i64>,
        folder: Option<PathBuf>,
        mode: &str,
        progress: Option<Bound<'_, PyAny>>,
        audit: bool,
    ) -> PyResult<Answer> {
        let mode = mode_of(mode);
        let way = Way { jobs, progress };
        let study = &Arc::new(self.asked(audit));
        running::run(py, &way, |run| {
            let answer = match folder {
                None => study.sweep(run),
                Some(folder) => into_folder(&folder, Kind::Study, run, |lock| {
                    let answer = study.sweep_into(lock, mode, run)?;
                    lock.check()?;
                    results::write(lock.folder(), study, &answer)?;
                    Ok(answer)
                }),
            };
            Answer::new(study, answer?)
        })
    }

    /// `own` is the size of the first design, the size of a batch, and the function that proposes points, of an optimizer in Python.
    #[allow(
        clippy::too_many_arguments,
        reason = "the keyword arguments of one call"
    )]
    #[allow(
        clippy::type_complexity,
        reason = "what an optimizer in Python is made of"
    )]
    fn tune(
        &self,
        py: Python<'_>,
        optimizer: &str,
        own: Option<(Option<usize>, usize, Py<PyAny>)>,
        budget: usize,
        patience: Option<usize>,
        jobs: Option<i64>,
        folder: Option<PathBuf>,
        mode: &str,
        progress: Option<Bound<'_, PyAny>>,
        audit: bool,
    ) -> PyResult<Answer> {
        let mode = mode_of(mode);
        let mut options = TuneOptions {
            budget,
            patience,
            ..TuneOptions::default()
        };
        let mut kept = None;
        match own {
            None => {
                options.optimizer = optimizer_by_name(optimizer)
                    .map_err(Error::into_usage)
                    .or_raise(py)?;
            }
            Some((design, batch, propose)) => {
                let own = PythonOptimizer::keep(optimizer, design, batch, propose).or_raise(py)?;
                options.optimizer = own;
                kept = Some(own);
            }
        }
        let way = Way { jobs, progress };
        let study = &Arc::new(self.asked(audit));
        let answer = running::run(py, &way, |run| {
            let answer = match folder {
                None => study.tune(&options, run),
                Some(folder) => into_folder(&folder, Kind::Study, run, |lock| {
                    let answer = study.tune_into(lock, mode, &options, run)?;
                    lock.check()?;
                    results::write(lock.folder(), study, &answer)?;
                    Ok(answer)
                }),
            };
            Answer::new(study, answer?)
        });
        if let Some(own) = kept {
            own.end();
        }
        answer
    }
}

/// Whether the servos of a robot follow commands that were recorded: where that was asked, and otherwise where a recording has any.
///
/// # Errors
/// It was asked, and no recording has commands.
fn follows_commands(robot: &Robot, recordings: &[Recording], asked: Option<bool>) -> Result<bool> {
    let hinges = robot.morphology.assemble().hinges;
    let has_commands = |r: &Recording| !RecordedCommand::all_of(&hinges, &r.trajectory).is_empty();
    let are_there = recordings.iter().any(has_commands);
    match (asked, are_there) {
        (Some(true), false) => {
            let names: Vec<&str> = hinges.iter().map(|hinge| hinge.name.as_str()).collect();
            Err(
                Error::usage("no recording has commands of the robot's joints")
                    .field("commands")
                    .allowed(format!("commanded angles of {}", names.join(", ")))
                    .hint("give them with Trajectory(..., commands={NAME: angles_rad})"),
            )
        }
        (asked, are_there) => Ok(asked.unwrap_or(are_there)),
    }
}

impl Study {
    /// The study, or one whose answers are not checked by further runs.
    fn asked(&self, audit: bool) -> calibration::Study {
        let study = calibration::Study::clone(&self.study);
        match audit {
            true => study,
            false => study.unaudited(),
        }
    }
}

/// A study with values fixed.
pub fn at(
    py: Python<'_>,
    study: &calibration::Study,
    set: &BTreeMap<String, f64>,
    draws: Vec<Vec<ParameterSet>>,
    fitted_on: &[String],
) -> PyResult<Study> {
    let way = Way {
        jobs: None,
        progress: None,
    };
    let study = running::run(py, &way, |options| {
        let set = values(&[], set)?;
        options.install(|| study.at(&set, draws, fitted_on))?
    })?;
    Ok(Study {
        study: Arc::new(study),
    })
}

impl Study {
    /// The study with its repeats.
    pub fn repeatable(&self) -> Result<Repeatable> {
        Repeatable::new((*self.study).clone())
    }
}
