//! The search for a better robot.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use realgap::file::versioned_json;
use realgap::optimization::{Ending, RunOptions};
use realgap::results::{Kind, check_folder, write_search};
use realgap::search::{self, Baseline, Finalist, ParameterShare, Performance, SearchResults};
use realgap::{Error, Result};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::error::{Raise, raised};
use crate::folder::{into_folder, mode_of, source};
use crate::robot::Robot;
use crate::running::{self, Way};
use crate::simulation::fitted;
use crate::text::{of_text, to_text};

/// Arguments that override the text of a search.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wishes {
    set: BTreeMap<String, f64>,
    parameters: Vec<PathBuf>,
    posterior: Option<PathBuf>,
    seed: Option<u64>,
}

/// A search, ready to run.
#[pyclass(frozen, module = "realgap._native")]
pub struct Search {
    search: Arc<search::Search>,
}

#[pymethods]
impl Search {
    /// Parses a text, RON or JSON; its path is `path`, even where no such file exists.
    #[staticmethod]
    fn parse(
        py: Python<'_>,
        path: PathBuf,
        text: Option<String>,
        is_json: bool,
        wishes: &str,
    ) -> PyResult<Self> {
        let make = || {
            let wishes: Wishes = of_text("a search", wishes)?;
            let fitted = fitted(&wishes.parameters, &wishes.set)?;
            let overrides = search::Overrides {
                set: fitted.values,
                draws: fitted.draws,
                indistinguishable: wishes.posterior,
                seed: wishes.seed,
            };
            search::Search::parse(&source(path, text, is_json, "search")?, &overrides)
        };
        let search = make().or_raise(py)?;
        Ok(Self {
            search: Arc::new(search),
        })
    }

    fn info(&self, py: Python<'_>) -> PyResult<String> {
        let search = &self.search;
        let info = json!({
            "name": search.name(),
            "description": search.description(),
            "strategy": search.strategy().name(),
            "robots": search.strategy().budget(),
            "repeats": search.repeats(),
            "duration_s": search.duration_s(),
            "objective": search.objective().label(),
            "seed": search.seed(),
        });
        to_text(&info).or_raise(py)
    }

    /// Searches as the command does.
    fn run(
        &self,
        py: Python<'_>,
        jobs: Option<i64>,
        folder: Option<PathBuf>,
        mode: &str,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Found> {
        let mode = mode_of(mode);
        let way = Way { jobs, progress };
        let search = &self.search;
        let found = running::run(py, &way, |run| match folder {
            None => {
                let results = search.run(run)?;
                self.look_again(results, run)
            }
            Some(folder) => into_folder(&folder, Kind::Search, run, |lock| {
                let results = search.run_in(lock, mode, run)?;
                lock.check()?;
                if results.ending == Ending::Interrupted {
                    write_search(lock.folder(), search, &results, &[], (None, None))?;
                }
                let found = self.look_again(results, run)?;
                found.write_into(lock.folder())?;
                Ok(found)
            }),
        })?;
        Ok(found)
    }

    /// Searches with a fitness in Python, a function of the repeats of a robot. There are no finalists, because these are ranked by the
    /// objective of the file.
    fn run_for(
        &self,
        py: Python<'_>,
        fitness: Py<PyAny>,
        jobs: Option<i64>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Found> {
        let way = Way { jobs, progress };
        let ask = |performance: &Performance| -> Result<f64> {
            let repeats: Vec<Value> = performance
                .repeats
                .iter()
                .map(|travel| {
                    json!({
                        "displacement_m": travel.displacement_m,
                        "path_length_m": travel.path_length_m,
                        "turned_rad": travel.turned_rad,
                        "servo_j": travel.servo_j,
                    })
                })
                .collect();
            let repeats = to_text(&repeats)?;
            Python::attach(|py| {
                let value = fitness.call1(py, (repeats,));
                value
                    .and_then(|value| value.extract::<f64>(py))
                    .map_err(|cause| raised(py, "the objective", cause))
            })
        };
        let results = running::run(py, &way, |run| finished(self.search.run_for(ask, run)?))?;
        Ok(Found {
            search: Arc::clone(&self.search),
            results,
            finalists: Vec::new(),
            baseline: None,
            share: None,
        })
    }
}

/// Results of a search that came to its end.
fn finished(results: SearchResults) -> Result<SearchResults> {
    match results.ending {
        Ending::Complete => Ok(results),
        Ending::Interrupted => Err(Error::interrupted(format!(
            "interrupted after {} robots; the robots in a folder are saved",
            results.robots.len()
        ))
        .hint("go on with the same call, folder and resume=True")),
    }
}

impl Search {
    fn look_again(&self, results: SearchResults, run: &RunOptions<'_>) -> Result<Found> {
        let results = finished(results)?;
        let quiet = RunOptions {
            progress: None,
            ..*run
        };
        let finalists = self.search.finalists(&results, &quiet)?;
        let share = match finalists.first() {
            Some(best) => self.search.parameter_share(best, &quiet)?,
            None => None,
        };
        Ok(Found {
            finalists,
            share,
            baseline: self.search.baseline(&quiet)?,
            search: Arc::clone(&self.search),
            results,
        })
    }
}

/// What a search found.
#[pyclass(frozen, module = "realgap._native")]
pub struct Found {
    search: Arc<search::Search>,
    results: SearchResults,
    finalists: Vec<Finalist>,
    baseline: Option<Baseline>,
    share: Option<ParameterShare>,
}

impl Found {
    fn write_into(&self, folder: &Path) -> Result<()> {
        let (search, results) = (&self.search, &self.results);
        write_search(
            folder,
            search,
            results,
            &self.finalists,
            (self.baseline.as_ref(), self.share),
        )?;
        Ok(())
    }
}

#[pymethods]
impl Found {
    /// One row per robot, as columns.
    fn robots(&self, py: Python<'_>) -> PyResult<String> {
        let mut columns = Map::new();
        let robots = &self.results.robots;
        let mut put = |name: &str, column: Vec<Value>| {
            columns.insert(name.to_owned(), Value::Array(column));
        };
        put(
            "robot",
            robots
                .iter()
                .map(|r| json!(self.search.robot_name(r.index)))
                .collect(),
        );
        put(
            "batch",
            robots
                .iter()
                .map(|r| json!(self.results.batch_of(r.index)))
                .collect(),
        );
        put(
            "modules",
            robots.iter().map(|r| json!(r.genome.len())).collect(),
        );
        put(
            "fitness",
            robots.iter().map(|r| json!(r.fitness())).collect(),
        );
        put(
            "mean_displacement_m",
            robots
                .iter()
                .map(|r| json!(r.mean_displacement_m()))
                .collect(),
        );
        let failure = |r: &search::EvaluatedRobot| json!(r.failure().map(|f| f.reason.code()));
        put("failure", robots.iter().map(failure).collect());
        to_text(&columns).or_raise(py)
    }

    /// The robot with the largest fitness in the search.
    fn best(&self, py: Python<'_>) -> PyResult<Option<Robot>> {
        let Some(best) = self.results.best() else {
            return Ok(None);
        };
        let name = self.search.robot_name(best.index);
        let morphology = self.search.body().build(&name, &best.genome);
        let morphology = morphology.map_err(Error::from).or_raise(py)?;
        Ok(Some(Robot { morphology }))
    }

    /// The finalists, best first: each with its card.
    fn finalists(&self, py: Python<'_>) -> PyResult<Vec<(Robot, String, String)>> {
        let all = self.finalists.iter().map(|finalist| {
            let card = finalist.card();
            let robot = Robot {
                morphology: finalist.robot.clone(),
            };
            Ok((robot, versioned_json(&card)?, card.to_string()))
        });
        all.collect::<Result<_>>().or_raise(py)
    }

    /// Writes the files of the command.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| {
            check_folder(&folder, Kind::Search)?;
            self.write_into(&folder)
        })
        .or_raise(py)
    }
}
