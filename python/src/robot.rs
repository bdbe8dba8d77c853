//! Robots.

use std::path::PathBuf;

use pyo3::prelude::*;
use realgap::file::Source;
use realgap::results::portrait;
use realgap::robot::morphology::Morphology;
use serde_json::json;

use crate::error::Raise;
use crate::text::to_text;

/// A robot.
#[pyclass(frozen, module = "realgap._native")]
pub struct Robot {
    pub morphology: Morphology,
}

#[pymethods]
impl Robot {
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let morphology = Morphology::read(path).or_raise(py)?;
        Ok(Self { morphology })
    }

    /// A text, RON or JSON; `name` is what errors call it.
    #[staticmethod]
    fn parse(py: Python<'_>, name: String, text: String, is_json: bool) -> PyResult<Self> {
        let source = match is_json {
            true => Source::json(name, text),
            false => Source::new(name, text),
        };
        let morphology = Morphology::parse(&source).or_raise(py)?;
        Ok(Self { morphology })
    }

    fn ron(&self, py: Python<'_>) -> PyResult<String> {
        self.morphology.to_ron().or_raise(py)
    }

    fn info(&self, py: Python<'_>) -> PyResult<String> {
        let robot = &self.morphology;
        let summary = robot.summary();
        let assembly = robot.assemble();
        let modules: Vec<&str> = robot.modules().iter().map(|m| m.name.as_str()).collect();
        let hinges: Vec<&str> = assembly.hinges.iter().map(|h| h.name.as_str()).collect();
        let parts: Vec<Vec<&str>> = assembly
            .parts
            .iter()
            .map(|part| {
                let mut names: Vec<&str> = part
                    .solids
                    .iter()
                    .map(|solid| modules[solid.module])
                    .collect();
                names.dedup();
                names
            })
            .collect();
        let size_m: [f64; 3] = summary.size_m().into();
        let centre_m: [f64; 3] = summary.centre_of_mass_robot_m.into();
        let info = json!({
            "name": robot.name(),
            "description": robot.description(),
            "modules": modules,
            "parts": parts,
            "hinges": hinges,
            "servos": summary.servos,
            "track": modules[robot.track()],
            "mass_kg": summary.mass_kg,
            "body_length_m": summary.body_length_m,
            "size_m": size_m,
            "centre_of_mass_robot_m": centre_m,
            "warnings": robot.warnings(),
        });
        to_text(&info).or_raise(py)
    }

    /// Draws it into a PNG or SVG file.
    fn draw(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        portrait::draw(&self.morphology, path).or_raise(py)
    }
}
