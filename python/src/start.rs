//! A study of somebody's own files, as `realgap start` makes it.

use std::path::PathBuf;

use pyo3::prelude::*;
use realgap::optimization::RunOptions;
use realgap::trajectory::{Ambiguity, Reading};
use realgap::{Error, Result, Warning};
use serde::Deserialize;
use serde_json::json;

use crate::cli::start::{Caller, Request};
use crate::error::Raise;
use crate::running::{self, Way};
use crate::text::{of_text, to_text};

/// What is known about the files.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    files: Vec<PathBuf>,
    cube: Option<[f64; 2]>,
    joints: Vec<String>,
    /// Gains as the command takes them: `JOINT=KP,KD`.
    pd: Vec<String>,
    track_m: Option<f64>,
    /// Commands as the command takes them: `JOINT=COLUMN:SWITCH`.
    commanded: Vec<String>,
    own_gait: bool,
    reading: Reading,
    output: PathBuf,
}

/// A program, which cannot be asked.
struct Program<'a>(&'a RunOptions<'a>);

impl Caller for Program<'_> {
    fn answer(&self, _doubts: &[Warning], open: &Ambiguity, _known: &mut Reading) -> Result<()> {
        Err(open.error())
    }

    fn during<T>(
        &self,
        _total: usize,
        work: impl FnOnce(&RunOptions<'_>) -> Result<T>,
    ) -> Result<T> {
        work(self.0)
    }
}

/// Makes a study of recordings and a robot, and writes it; returns how the files were read, and warnings.
#[pyfunction]
pub fn start(py: Python<'_>, said: &str, progress: Option<Bound<'_, PyAny>>) -> PyResult<String> {
    let way = Way {
        jobs: None,
        progress,
    };
    let started = running::run(py, &way, |run| {
        let said: Said = of_text("start", said)?;
        let gains = said.pd.iter().map(|text| {
            let wrong = |why: String| Error::usage(why).field("pd").found(text);
            text.parse().map_err(wrong)
        });
        let commanded = said.commanded.iter().map(|text| {
            let wrong = |why: String| Error::usage(why).field("commands").found(text);
            text.parse().map_err(wrong)
        });
        let request = Request {
            commanded: commanded.collect::<Result<_>>()?,
            pd: gains.collect::<Result<_>>()?,
            files: said.files,
            cube: said.cube.map(|cube| cube.to_vec()),
            joints: said.joints,
            track: said.track_m,
            own_gait: said.own_gait,
            engine: None,
            python: None,
            reading: said.reading,
            output: said.output,
        };
        request.study(&Program(run))
    })?;
    to_text(&json!({"lines": started.lines, "warnings": started.warnings})).or_raise(py)
}
