//! MuJoCo in a Python of the user: the script that is part of the program runs the first repeats of a prediction there.

use std::path::Path;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::super::ensemble::Ensemble;
use realgap_core::Result;
use realgap_guest::{Answered, CommandLine, Failure, HELLO, Pool, Port, Question};
use realgap_optimization::RunOptions;
use realgap_simulation::Experiment;
use realgap_simulation::export::DrawnRobot;

/// The script: the robot of an exported file, and what answers questions about it.
const SCRIPT: &str = concat!(
    include_str!("../../../../../tools/standin.py"),
    "\n",
    include_str!("ask_mujoco.py")
);
/// Repeats that MuJoCo runs, at most; docs/validation/ensembles.md says what fewer and more would change.
const RUNS: usize = 12;
/// Fewer completed runs than this have no spread.
const FEWEST: usize = 3;

/// MuJoCo in a Python of the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mujoco {
    /// The command that starts Python, e.g. `python3`.
    pub python: String,
    /// Longest time for all runs together. It does not change what MuJoCo says, only whether it is waited for.
    pub limit: Duration,
}

impl Mujoco {
    /// Longest time for all runs together, unless something else is said.
    pub const LIMIT: Duration = Duration::from_secs(300);

    /// MuJoCo in this Python.
    pub fn new(python: impl Into<String>) -> Self {
        Self {
            python: python.into(),
            limit: Self::LIMIT,
        }
    }
}

/// What MuJoCo said.
pub(super) struct Asked {
    pub version: String,
    /// Net displacements of the first repeats, metres.
    pub runs_m: Vec<f64>,
}

/// A question: one repeat.
#[derive(Serialize)]
struct Asking<'a> {
    id: u64,
    duration_s: f64,
    #[serde(flatten)]
    robot: &'a DrawnRobot,
}

#[derive(Deserialize)]
struct Hello {
    version: String,
}

/// The answer to a question.
#[derive(Deserialize)]
struct Told {
    net_displacement_m: Option<f64>,
    failed: Option<String>,
}

impl Mujoco {
    /// The net displacements of the first repeats in MuJoCo, or why it did not say them. The outer error is one of the experiment,
    /// or that the run is stopped.
    pub(super) fn ask(
        &self,
        experiment: &Experiment,
        ensemble: &Ensemble,
        run: &RunOptions<'_>,
    ) -> Result<std::result::Result<Asked, String>> {
        if let Some(why) = DrawnRobot::cannot_say(experiment) {
            return Ok(Err(format!("MuJoCo cannot be told this run: {why}")));
        }
        let until = Instant::now() + self.limit;
        let pool = match self.pool() {
            Ok(pool) => pool,
            Err(error) => return Ok(Err(format!("MuJoCo was not asked: {error}"))),
        };
        let hello = pool.ask(HELLO, Question::Hello);
        let hello = hello.and_then(|line| parsed::<Hello>(&line));
        let version = match hello {
            Ok(hello) => hello.version,
            Err(failure) => return Ok(Err(self.without(&failure))),
        };
        let step = run.step("asking MuJoCo", RUNS.min(ensemble.asked));
        let quiet = RunOptions {
            progress: None,
            ..*run
        };
        let told = quiet.each(RUNS.min(ensemble.asked), |number| {
            let number = number as u64;
            let own = ensemble
                .uncertain
                .apply(experiment, ensemble.seed, number)?;
            let drawn = ensemble.noise.perturb(&own, ensemble.seed, number);
            let asking = Asking {
                id: number,
                duration_s: experiment.duration_s,
                robot: &DrawnRobot::new("robot", &drawn)?,
            };
            let line = serde_json::to_string(&asking)
                .map_err(|e| realgap_core::Error::invalid(format!("cannot ask MuJoCo: {e}")))?;
            let told = match Instant::now() < until {
                true => far_m(&pool, &line, number),
                false => Err(Failure::of_answer("was not asked in time")),
            };
            step.count();
            Ok(told)
        })?;
        let late = Instant::now() >= until;
        if late {
            return Ok(Err(format!(
                "MuJoCo did not run this within {} s",
                self.limit.as_secs_f64()
            )));
        }
        let first = told.iter().find_map(|told| told.as_ref().err()).cloned();
        let runs_m: Vec<f64> = told.into_iter().filter_map(|told| told.ok()).collect();
        match first {
            Some(failure) if runs_m.len() < FEWEST => Ok(Err(format!(
                "in MuJoCo {} runs were completed; it {}",
                runs_m.len(),
                shortly(&failure)
            ))),
            None if runs_m.len() < FEWEST => Ok(Err(format!(
                "{} runs in MuJoCo would say nothing about their spread",
                runs_m.len()
            ))),
            _ => Ok(Ok(Asked { version, runs_m })),
        }
    }

    fn pool(&self) -> Result<Pool> {
        let words = [self.python.as_str(), "-c", SCRIPT].map(str::to_owned);
        let folder = std::env::temp_dir();
        let mut command = CommandLine::new(words.into(), Path::new(&folder), &[])?;
        command.start_limit = command.start_limit.min(self.limit);
        command.answer_limit = self.limit;
        Ok(Pool::new(command))
    }

    /// Why MuJoCo did not say who it is.
    fn without(&self, failure: &Failure) -> String {
        let python = &self.python;
        // The command of a failure that names it holds the whole script.
        if let Some((_, why)) = failure.why().rsplit_once("cannot be started") {
            return format!("MuJoCo was not asked: `{python}` cannot be started{why}");
        }
        let words = failure.last_words().unwrap_or_default();
        match words.split_once("No module named '") {
            Some((_, rest)) => {
                let package = rest.split('\'').next().unwrap_or_default();
                format!("MuJoCo was not asked: `{python}` has no package {package}")
            }
            None => format!("MuJoCo was not asked: `{python}` {}", shortly(failure)),
        }
    }
}

/// What happened, with the last line that Python wrote.
fn shortly(failure: &Failure) -> String {
    let words = failure.last_words().unwrap_or_default();
    match words.lines().rfind(|line| !line.trim().is_empty()) {
        Some(last) => format!("{}: {}", failure.why(), last.trim()),
        None => failure.why().to_owned(),
    }
}

fn parsed<'a, T: Deserialize<'a>>(line: &'a str) -> Answered<T> {
    serde_json::from_str(line).map_err(|error| Failure::of_answer(format!("answered {error}")))
}

/// The net displacement of one repeat, metres.
fn far_m(pool: &Pool, line: &str, number: u64) -> Answered<f64> {
    let line = pool.ask(line, Question::Run(number))?;
    let told: Told = parsed(&line)?;
    match (told.net_displacement_m, told.failed) {
        (Some(far_m), None) if far_m.is_finite() && far_m >= 0.0 => Ok(far_m),
        (_, Some(why)) => Err(Failure::of_answer(format!("answered: {why}"))),
        _ => Err(Failure::of_answer("answered no displacement")),
    }
}
