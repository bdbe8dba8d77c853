//! Metrics and optimizers that are written in Python. The interpreter's lock is taken for a call and given back after it.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use realgap::comparison::{self, Context, Measurement, Needs, Pair};
use realgap::optimization::{self, EvaluatedPoint, History, OptimizationProblem, Proposal};
use realgap::unit::Unit;
use realgap::{Error, Result};

use crate::array;
use crate::error::{Raise, raised};
use crate::trajectory::Trajectory;

/// The units that a metric in Python may have.
const UNITS: [Unit; 7] = [
    Unit::One,
    Unit::Metre,
    Unit::Second,
    Unit::Radian,
    Unit::Degree,
    Unit::MetrePerSecond,
    Unit::Joule,
];

/// Leaks a text, because metrics and optimizers are `'static` in the library; a program defines only a few.
fn kept(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

/// A metric in Python.
#[pyclass(frozen, module = "realgap._native")]
pub struct OwnMetric {
    pub metric: &'static PythonMetric,
}

/// The metric as the library uses it.
pub struct PythonMetric {
    name: &'static str,
    column: &'static str,
    unit: Unit,
    doc: &'static str,
    needs: Needs,
    /// Whether it is called with whole trajectories and not with prepared paths.
    is_of_trajectories: bool,
    call: Py<PyAny>,
}

#[pymethods]
impl OwnMetric {
    #[new]
    fn new(
        py: Python<'_>,
        name: String,
        unit: &str,
        doc: String,
        is_of_trajectories: bool,
        call: Py<PyAny>,
    ) -> PyResult<Self> {
        if comparison::by_name(&name).is_ok() {
            let taken = Error::usage("there is a metric of this name already")
                .field("name")
                .found(&name);
            return Err(taken).or_raise(py);
        }
        realgap::file::check_name(&name, "a metric").or_raise(py)?;
        let Some(unit) = UNITS.into_iter().find(|known| known.label() == unit) else {
            let known = UNITS.map(Unit::label).join(", ");
            return Err(Error::usage("not a unit of a metric")
                .field("unit")
                .found(unit)
                .allowed(known))
            .or_raise(py);
        };
        let column = format!("{name}_{}", unit.label().replace('/', "_")).replace('-', "_");
        let needs = Needs {
            preparation: true,
            ..Needs::default()
        };
        let metric = PythonMetric {
            name: kept(name),
            column: kept(column),
            unit,
            doc: kept(doc),
            needs,
            is_of_trajectories,
            call,
        };
        Ok(Self {
            metric: Box::leak(Box::new(metric)),
        })
    }
}

impl comparison::Metric for PythonMetric {
    fn name(&self) -> &'static str {
        self.name
    }
    fn column(&self) -> &'static str {
        self.column
    }
    fn unit(&self) -> Unit {
        self.unit
    }
    fn doc(&self) -> &'static str {
        self.doc
    }
    fn needs(&self) -> Needs {
        self.needs
    }
    fn measure(&self, pair: &Pair<'_>, _: &Context<'_>) -> Result<Measurement> {
        let (real, simulated) = (pair.real_prepared.xy_m(), pair.simulated_prepared.xy_m());
        let value = Python::attach(|py| {
            let value = if self.is_of_trajectories {
                let both = [pair.real, pair.simulated].map(|t| Trajectory::unnamed(t.clone()));
                let [real, simulated] = both;
                self.call.call1(py, (real, simulated))
            } else {
                let points = |xy: &[[f64; 2]]| {
                    PyBytes::new(py, &array::bytes(xy.iter().copied().flatten())).unbind()
                };
                self.call.call1(py, (points(real), points(simulated)))
            };
            value
                .and_then(|value| value.extract::<f64>(py))
                .map_err(|cause| raised(py, &format!("the metric `{}`", self.name), cause))
        })?;
        Ok(Measurement::new(value, real.len()))
    }
}

/// The metric of this name, or a metric in Python.
///
/// # Errors
/// An unknown name, or a value that is neither.
pub fn metric(asked: &Bound<'_, PyAny>) -> PyResult<&'static dyn comparison::Metric> {
    if let Ok(own) = asked.cast::<OwnMetric>() {
        return Ok(own.get().metric);
    }
    let name: String = asked.extract()?;
    comparison::by_name(&name)
        .map_err(Error::into_usage)
        .or_raise(asked.py())
}

/// An optimizer in Python, for one tuning.
pub struct PythonOptimizer {
    name: &'static str,
    design: Option<usize>,
    batch: usize,
    /// Empty once the tuning is over, because the leaked rest of the optimizer stays.
    propose: Mutex<Option<Py<PyAny>>>,
}

impl PythonOptimizer {
    /// An optimizer that calls `propose` with dimensions, budget and seed, the design, and the evaluated points, both with scores.
    ///
    /// # Errors
    /// The name of another optimizer.
    pub fn keep(
        name: &str,
        design: Option<usize>,
        batch: usize,
        propose: Py<PyAny>,
    ) -> Result<&'static Self> {
        if optimization::optimizer_by_name(name).is_ok() {
            return Err(Error::usage("there is an optimizer of this name already")
                .field("name")
                .found(name));
        }
        Ok(Box::leak(Box::new(Self {
            name: kept(name.to_owned()),
            design,
            batch,
            propose: Mutex::new(Some(propose)),
        })))
    }

    /// Releases the Python function.
    pub fn end(&self) {
        self.propose
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
    }
}

impl optimization::Optimizer for PythonOptimizer {
    fn name(&self) -> &'static str {
        self.name
    }
    fn doc(&self) -> &'static str {
        "written in Python"
    }
    fn design(&self, dimensions: usize) -> usize {
        self.design.unwrap_or(10 * dimensions)
    }
    fn batch(&self, _: &OptimizationProblem) -> usize {
        self.batch
    }
    fn depends_on_budget(&self) -> bool {
        // This is not known of an optimizer in Python.
        true
    }
    fn propose(&self, problem: &OptimizationProblem, history: &History<'_>) -> Result<Proposal> {
        let rows = |told: &[EvaluatedPoint]| -> Vec<(Vec<f64>, Option<f64>)> {
            told.iter()
                .map(|told| (told.point.clone(), told.score))
                .collect()
        };
        let (design, told) = (rows(history.design), rows(history.evaluated));
        let points = Python::attach(|py| {
            let propose = self.propose.lock().unwrap_or_else(PoisonError::into_inner);
            let propose = propose.as_ref().map(|propose| propose.clone_ref(py));
            let Some(propose) = propose else {
                return Ok(Vec::new());
            };
            let problem = (problem.dimensions(), problem.budget, problem.seed);
            propose
                .call1(py, (problem, design, told))
                .and_then(|points| points.extract::<Vec<Vec<f64>>>(py))
                .map_err(|cause| raised(py, &format!("the optimizer `{}`", self.name), cause))
        })?;
        if points.is_empty() {
            return Ok(Proposal::Exhausted);
        }
        let is_inside = |point: &Vec<f64>| {
            point.len() == problem.dimensions() && point.iter().all(|x| (0.0..=1.0).contains(x))
        };
        match points.iter().find(|point| !is_inside(point)) {
            None => Ok(Proposal::Evaluate(points)),
            Some(point) => Err(Error::invalid(
                "the optimizer asks for a point outside of the ranges",
            )
            .field(self.name)
            .found(format!("{point:?}"))
            .allowed(format!("{} coordinates from 0 to 1", problem.dimensions()))),
        }
    }
}
