//! Repeats under noise: ensembles, gaps and prediction cards.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use realgap::calibration::read_noise;
use realgap::comparison::Metric;
use realgap::file::{Source, parse_ron, versioned_json};
use realgap::optimization::RunOptions;
use realgap::prediction::ensemble;
use realgap::prediction::gap::{GapOptions, StudyGap};
use realgap::prediction::{
    Card, DivergenceRate, EnsembleOptions, EnsembleReport, ModelError, ModelOptions, Mujoco,
    SuccessRule, ThirdOpinion, UncertainParameters,
};
use realgap::results::{Kind, check_folder, write_ensemble, write_gap, write_prediction};
use realgap::search::read_posterior;
use realgap::simulation::{Experiment, Noise, Sampling};
use realgap::warning::Code;
use realgap::{Error, Result};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::callback;
use crate::error::Raise;
use crate::folder::into_folder;
use crate::robot::Robot;
use crate::running::{self, Way};
use crate::simulation::fitted;
use crate::study::Study;
use crate::text::{of_text, to_text};

/// Most repeats: the distances of all pairs are held in memory.
const MOST_REPEATS: usize = 5000;

/// How repeats are drawn.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Drawing {
    repeats: usize,
    seed: Option<u64>,
    noise: Option<Value>,
    noise_file: Option<PathBuf>,
    model_error: bool,
    posterior: Option<PathBuf>,
    other_engine: Option<String>,
    /// The Python that runs this package.
    python: Option<String>,
}

impl Drawing {
    fn check(self) -> Result<Self> {
        if (1..=MOST_REPEATS).contains(&self.repeats) {
            return Ok(self);
        }
        Err(Error::usage("not a number of repeats")
            .field("repeats")
            .found(self.repeats)
            .allowed(format!("1 to {MOST_REPEATS}")))
    }

    /// The given noise, and its source.
    fn noise(&self) -> Result<Option<(Noise, String)>> {
        if let Some(file) = &self.noise_file {
            return Ok(Some((read_noise(file)?, file.display().to_string())));
        }
        let Some(said) = &self.noise else {
            return Ok(None);
        };
        let noise: Noise = parse_ron(&Source::json("noise", said.to_string()))?;
        match noise.fault() {
            Some((field, error)) => Err(error.field(format!("noise.{field}")).into_usage()),
            None => Ok(Some((noise, "Python".to_owned()))),
        }
    }

    /// What the model error is computed from; `None` where it is off.
    fn model(&self) -> Result<Option<ModelOptions>> {
        let wanted = [
            ("posterior", self.posterior.is_some()),
            ("other_engine", self.other_engine.is_some()),
        ];
        let wanted = wanted.iter().find(|(_, is_given)| *is_given);
        if let (false, Some((name, _))) = (self.model_error, wanted) {
            return Err(
                Error::usage(format!("{name}= belongs to the model error, which is off"))
                    .field(*name)
                    .hint("leave model_error=True"),
            );
        }
        if !self.model_error {
            return Ok(None);
        }
        let points = self.posterior.as_deref().map(read_posterior).transpose()?;
        Ok(Some(ModelOptions {
            points: points.unwrap_or_default(),
            third_opinion: self.third_opinion()?,
        }))
    }

    fn third_opinion(&self) -> Result<ThirdOpinion> {
        let mujoco = || Mujoco::new(self.python.as_deref().unwrap_or("python3"));
        match self.other_engine.as_deref() {
            None | Some("auto") => Ok(ThirdOpinion::Mujoco(mujoco())),
            Some("mujoco") => Ok(ThirdOpinion::OnlyMujoco(mujoco())),
            Some("table") => Ok(ThirdOpinion::Table),
            Some(other) => Err(Error::usage("nobody who says what another engine would do")
                .field("other_engine")
                .found(other)
                .allowed("auto, mujoco, table")),
        }
    }
}

fn incomplete(done: usize, total: usize) -> Error {
    Error::interrupted(format!("interrupted after {done} of {total} repeats"))
        .hint("run it again; finished repeats come out the same")
}

/// Writes into a folder, if there is one, as the commands do.
fn kept<T>(
    folder: Option<&Path>,
    kind: Kind,
    run: &RunOptions<'_>,
    make: impl FnOnce() -> Result<T>,
    write: impl FnOnce(&Path, &T) -> Result<()>,
) -> Result<T> {
    let Some(folder) = folder else {
        return make();
    };
    into_folder(folder, kind, run, |lock| {
        let made = make()?;
        lock.check()?;
        write(lock.folder(), &made)?;
        Ok(made)
    })
}

/// Repeats of a study.
#[pyclass(frozen, module = "realgap._native")]
pub struct Ensemble {
    report: EnsembleReport,
}

#[pyfunction]
pub fn repeat_study(
    py: Python<'_>,
    study: &Study,
    drawing: &str,
    jobs: Option<i64>,
    folder: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Ensemble> {
    let way = Way { jobs, progress };
    let report = running::run(py, &way, |run| {
        let drawing = of_text::<Drawing>("ensemble", drawing)?.check()?;
        let study = run.install(|| study.repeatable())??;
        let (noise, noise_from) = match drawing.noise()? {
            Some(said) => said,
            None => (study.noise()?, study.definition.name.clone()),
        };
        let options = EnsembleOptions {
            noise,
            noise_from,
            repeats: drawing.repeats,
            seed: drawing.seed.unwrap_or(study.definition.seed),
            model: drawing.model()?,
        };
        let total = study.cases.len() * options.repeats;
        let report = kept(
            folder.as_deref(),
            Kind::Ensemble,
            run,
            || EnsembleReport::new(&study, &options, run),
            |folder, report| write_ensemble(folder, report).map(drop),
        )?;
        if !report.complete {
            return Err(incomplete(report.repeats(), total));
        }
        if report.is_lost() {
            return Err(diverged());
        }
        Ok(report)
    })?;
    Ok(Ensemble { report })
}

fn diverged() -> Error {
    Error::invalid("every repeat diverged")
        .hint("check the robot with realgap.simulate, then try a shorter timestep or more substeps")
}

#[pymethods]
impl Ensemble {
    fn text(&self) -> String {
        self.report.to_string()
    }

    fn report(&self, py: Python<'_>) -> PyResult<String> {
        versioned_json(&self.report).or_raise(py)
    }

    /// One row per repeat, as columns.
    fn repeats(&self, py: Python<'_>) -> PyResult<String> {
        let cases = self.report.cases.iter();
        let cases: Vec<_> = cases
            .map(|case| (case.case.as_str(), &case.ensemble))
            .collect();
        to_text(&repeats(&cases)).or_raise(py)
    }

    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| {
            check_folder(&folder, Kind::Ensemble)?;
            write_ensemble(&folder, &self.report).map(drop)
        })
        .or_raise(py)
    }
}

/// Case, number and net displacement of every repeat, as columns.
fn repeats(cases: &[(&str, &ensemble::Ensemble)]) -> Map<String, Value> {
    let mut columns: [Vec<Value>; 3] = Default::default();
    for (name, case) in cases {
        for repeat in &case.repeats {
            columns[0].push(json!(name));
            columns[1].push(json!(repeat.number));
            let motion = repeat.outcome.get();
            columns[2].push(json!(motion.map(|motion| motion.net_displacement_m())));
        }
    }
    let names = ["case", "repeat", "net_displacement_m"].map(str::to_owned);
    names.into_iter().zip(columns.map(Value::Array)).collect()
}

/// How far a study's simulation is from its recordings.
#[pyclass(frozen, module = "realgap._native")]
pub struct Gap {
    gap: StudyGap,
}

#[pyfunction]
pub fn study_gap(
    py: Python<'_>,
    study: &Study,
    metrics: Option<Vec<Bound<'_, PyAny>>>,
    drawing: &str,
    jobs: Option<i64>,
    folder: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Gap> {
    let metrics: Option<Vec<&'static dyn Metric>> = match metrics {
        None => None,
        Some(asked) => Some(
            asked
                .iter()
                .map(callback::metric)
                .collect::<PyResult<_>>()?,
        ),
    };
    let way = Way { jobs, progress };
    let gap = running::run(py, &way, |run| {
        let drawing = of_text::<Drawing>("gap", drawing)?.check()?;
        let mut options = GapOptions::of(&study.study)?;
        options.repeats = drawing.repeats;
        if let Some(metrics) = metrics {
            options.metrics = metrics;
        }
        if let Some(seed) = drawing.seed {
            options.seed = seed;
        }
        if let Some((noise, _)) = drawing.noise()? {
            options.noise = Some(noise);
        }
        let make = || StudyGap::new(&study.study, &options, run);
        let gap = kept(folder.as_deref(), Kind::Gap, run, make, |folder, gap| {
            write_gap(folder, gap).map(drop)
        })?;
        if !gap.complete {
            return Err(Error::interrupted("interrupted before the last repeat")
                .hint("run it again; finished repeats come out the same"));
        }
        Ok(gap)
    })?;
    Ok(Gap { gap })
}

#[pymethods]
impl Gap {
    fn text(&self) -> String {
        self.gap.to_string()
    }

    fn report(&self, py: Python<'_>) -> PyResult<String> {
        versioned_json(&self.gap).or_raise(py)
    }

    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| {
            check_folder(&folder, Kind::Gap)?;
            write_gap(&folder, &self.gap).map(drop)
        })
        .or_raise(py)
    }
}

/// What a robot will do.
#[pyclass(frozen, module = "realgap._native")]
pub struct Prediction {
    card: Card,
    ensemble: ensemble::Ensemble,
}

/// What is predicted.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Question {
    duration_s: f64,
    success_m: Option<f64>,
    set: BTreeMap<String, f64>,
    parameters: Vec<PathBuf>,
}

#[pyfunction]
pub fn predict(
    py: Python<'_>,
    robot: &Robot,
    question: &str,
    drawing: &str,
    jobs: Option<i64>,
    folder: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Prediction> {
    let way = Way { jobs, progress };
    let (card, ensemble) = running::run(py, &way, |run| {
        let question: Question = of_text("predict", question)?;
        let drawing = of_text::<Drawing>("predict", drawing)?.check()?;
        let (card, repeats) = kept(
            folder.as_deref(),
            Kind::Prediction,
            run,
            || card(robot, &question, &drawing, run),
            |folder, (card, repeats)| write_prediction(folder, card, repeats).map(drop),
        )?;
        if !repeats.is_complete() {
            return Err(incomplete(repeats.repeats.len(), repeats.asked));
        }
        if card.prediction.displacement_m.is_none() {
            return Err(diverged());
        }
        Ok((card, repeats))
    })?;
    Ok(Prediction { card, ensemble })
}

/// The prediction card, as the command makes it.
fn card(
    robot: &Robot,
    question: &Question,
    drawing: &Drawing,
    run: &RunOptions<'_>,
) -> Result<(Card, ensemble::Ensemble)> {
    let rule = match question.success_m {
        Some(least_m) => SuccessRule::AtLeast(least_m),
        None => SuccessRule::HalfOfNoiseFree,
    };
    let robot = &robot.morphology;
    let fitted = fitted(&question.parameters, &question.set)?;
    let (values, uncertain) = (fitted.values, UncertainParameters::of_draws(&fitted.draws));
    let mut experiment = Experiment::new(robot.assemble());
    experiment.duration_s = question.duration_s;
    experiment.sampling = Sampling::Rate(60.0);
    let mut warnings = robot.warnings();
    warnings.extend(values.without_effect(&experiment));
    let experiment = values.apply(&experiment);
    experiment.check().map_err(Error::into_usage)?;
    let (noise, noise_from) = match drawing.noise()? {
        Some(said) => said,
        None => {
            warnings.push(Code::EstimatedNoise.warning(
                "the noise is a default preset for robots without measurements; give your own with noise=",
            ));
            (Noise::unmeasured_robot(), "estimate".to_owned())
        }
    };
    let seed = drawing.seed.unwrap_or(1);
    let draws = ensemble::Draws {
        noise: &noise,
        uncertain: &uncertain,
        seed,
        repeats: drawing.repeats,
        recall: &|_| Ok(None),
    };
    let repeats = run.install(|| ensemble::run_each(&experiment, &draws, run))??;
    let growth = match repeats.is_complete() {
        true => DivergenceRate::of(&experiment)?,
        false => None,
    };
    let card = run.install(|| Card::new(robot.name(), &repeats, rule))??;
    let quiet = RunOptions {
        progress: None,
        ..*run
    };
    let model = match drawing.model()? {
        Some(options) => {
            ModelError::new(&experiment, &repeats, &card.prediction, &options, &quiet)?
        }
        None => None,
    };
    let card = card
        .with_model(&repeats, model)
        .with_parameters(&values)
        .with_noise_from(noise_from)
        .with_growth(growth)
        .with_warnings(warnings);
    Ok((card, repeats))
}

#[pymethods]
impl Prediction {
    fn text(&self) -> String {
        self.card.to_string()
    }

    fn report(&self, py: Python<'_>) -> PyResult<String> {
        versioned_json(&self.card).or_raise(py)
    }

    fn repeats(&self, py: Python<'_>) -> PyResult<String> {
        to_text(&repeats(&[(self.card.robot.as_str(), &self.ensemble)])).or_raise(py)
    }

    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| {
            check_folder(&folder, Kind::Prediction)?;
            write_prediction(&folder, &self.card, &self.ensemble).map(drop)
        })
        .or_raise(py)
    }
}
