//! The half of the Python package that is written in Rust: objects of the library, arrays as bytes, everything else as JSON. The
//! public half is in `realgap/`.

mod answer;
mod array;
mod callback;
/// The command, from the same files as the program, so that a wheel holds the library only once.
#[path = "../../src/cli/mod.rs"]
mod cli;
mod error;
mod feedback;
mod finding;
mod folder;
mod prediction;
mod replay;
mod robot;
mod running;
mod search;
mod simulation;
mod simulator;
mod start;
mod study;
mod text;
mod trajectory;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    use std::path::PathBuf;

    use pyo3::prelude::*;
    use realgap::comparison::METRICS;
    use realgap::optimization::OPTIMIZERS;
    use realgap::simulation::{ENGINE_VERSION, parameter};
    use serde_json::{Value, json};

    use crate::error::Raise;
    use crate::text::to_text;

    #[pymodule_export]
    use crate::answer::Answer;
    #[pymodule_export]
    use crate::callback::OwnMetric;
    #[pymodule_export]
    use crate::finding::Finding;
    #[pymodule_export]
    use crate::prediction::{Ensemble, Gap, Prediction, predict, repeat_study, study_gap};
    #[pymodule_export]
    use crate::replay::replay;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::search::{Found, Search};
    #[pymodule_export]
    use crate::simulation::{Simulation, simulate};
    #[pymodule_export]
    use crate::start::start;
    #[pymodule_export]
    use crate::study::Study;
    #[pymodule_export]
    use crate::trajectory::{Trajectory, compare};

    /// Runs the command with these arguments, the program's name first, and returns its exit code.
    #[pyfunction]
    fn command(py: Python<'_>, words: Vec<std::ffi::OsString>) -> u8 {
        py.detach(|| crate::cli::run(words.into_iter()))
    }

    /// Versions of the package and of the engine.
    #[pyfunction]
    fn versions() -> (&'static str, &'static str) {
        (env!("CARGO_PKG_VERSION"), ENGINE_VERSION)
    }

    /// One row per parameter.
    #[pyfunction]
    fn parameters(py: Python<'_>) -> PyResult<String> {
        let rows: Vec<Value> = parameter::all()
            .chain(parameter::families())
            .map(|p| {
                json!({"name": p.name, "unit": p.unit, "lowest": p.bounds.0, "highest": p.bounds.1,
                       "default": p.default_value(), "doc": p.doc})
            })
            .collect();
        to_text(&rows).or_raise(py)
    }

    /// One row per metric.
    #[pyfunction]
    fn metrics(py: Python<'_>) -> PyResult<String> {
        let row = |m: &&dyn realgap::comparison::Metric| json!({"name": m.name(), "column": m.column(), "unit": m.unit(), "doc": m.doc()});
        to_text(&METRICS.iter().map(row).collect::<Vec<_>>()).or_raise(py)
    }

    /// One row per optimizer.
    #[pyfunction]
    fn optimizers(py: Python<'_>) -> PyResult<String> {
        let row =
            |o: &&dyn realgap::optimization::Optimizer| json!({"name": o.name(), "doc": o.doc()});
        to_text(&OPTIMIZERS.iter().map(row).collect::<Vec<_>>()).or_raise(py)
    }

    /// The values of a parameter file.
    #[pyfunction]
    fn read_parameters(py: Python<'_>, path: PathBuf) -> PyResult<String> {
        let set = realgap::calibration::read_parameters(path).or_raise(py)?;
        let values: serde_json::Map<String, Value> = set
            .iter()
            .map(|a| (a.parameter.name.to_owned(), json!(a.value)))
            .collect();
        to_text(&values).or_raise(py)
    }

    /// A results folder as one page.
    #[pyfunction]
    fn folder_page(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
        py.detach(|| realgap::report::folder_page(&folder, "realgap.report"))
            .or_raise(py)
    }
}
