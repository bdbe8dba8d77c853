//! Answers of sweeps and tunings.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use realgap::calibration::{self, recording_id};
use realgap::file::versioned_json;
use realgap::inference::Profile;
use realgap::optimization::Ending;
use realgap::results::{self, JointSample, Kind, check_folder};
use realgap::{Error, Result};
use serde_json::{Map, Value, json};

use crate::error::Raise;
use crate::running::{self, Way};
use crate::study::{Study, at};
use crate::text::to_text;

/// The answer of a sweep or a tuning.
#[pyclass(frozen, module = "realgap._native")]
pub struct Answer {
    study: Arc<calibration::Study>,
    answer: calibration::Answer,
}

impl Answer {
    /// The answer for Python.
    ///
    /// # Errors
    /// An answer that was interrupted, or has no best point.
    pub fn new(study: &Arc<calibration::Study>, answer: calibration::Answer) -> Result<Self> {
        let report = &answer.report;
        if answer.ending == Ending::Interrupted {
            return Err(Error::interrupted(format!(
                "interrupted after {} of {} points; the points in a folder are saved",
                report.points, report.points_total
            ))
            .hint("go on with the same call, folder and resume=True"));
        }
        if report.best.is_none() {
            return Err(Error::invalid("every point diverged, so there is no best one").hint(
                "check the robot with realgap.simulate, then try a shorter timestep or more substeps",
            ));
        }
        Ok(Self {
            study: Arc::clone(study),
            answer,
        })
    }
}

#[pymethods]
impl Answer {
    fn text(&self) -> String {
        self.answer.to_string()
    }

    fn report(&self, py: Python<'_>) -> PyResult<String> {
        versioned_json(&self.answer.report).or_raise(py)
    }

    /// The columns of `points.csv`, each as a list.
    fn points(&self, py: Python<'_>) -> PyResult<String> {
        let points = &self.answer.scores.points;
        let ranges = self.study.definition().grid.ranges().iter().enumerate();
        let mut columns = Map::new();
        for (index, range) in ranges {
            let column: Vec<f64> = points.iter().map(|point| point.values[index]).collect();
            columns.insert(range.parameter.name.to_owned(), json!(column));
        }
        let mut put = |name: &str, column: Vec<Value>| {
            columns.insert(name.to_owned(), Value::Array(column));
        };
        let uncertainty = self.answer.uncertainty.as_ref();
        let inside = |index: usize| uncertainty.is_some_and(|u| u.indistinguishable[index]);
        put(
            "score",
            points.iter().map(|point| json!(point.score)).collect(),
        );
        put(
            "displacement_error_m",
            points
                .iter()
                .map(|point| json!(point.displacement_error_m))
                .collect(),
        );
        put(
            "indistinguishable",
            (0..points.len())
                .map(|index| json!(inside(index)))
                .collect(),
        );
        put(
            "runs",
            points.iter().map(|point| json!(point.runs)).collect(),
        );
        put(
            "diverged",
            points.iter().map(|point| json!(point.diverged)).collect(),
        );
        to_text(&columns).or_raise(py)
    }

    /// Draws from the posterior: a list for each parameter that varies, and nothing where no point has a score.
    fn posterior(&self, py: Python<'_>) -> PyResult<String> {
        let mut columns = Map::new();
        if let Some(draws) = &self.answer.draws {
            let ranges = self.study.definition().grid.ranges().iter().enumerate();
            for (index, range) in ranges {
                let column: Vec<f64> = draws.rows().iter().map(|row| row[index]).collect();
                columns.insert(range.parameter.name.to_owned(), json!(column));
            }
        }
        to_text(&columns).or_raise(py)
    }

    /// The lowest expected score along each parameter.
    fn profiles(&self, py: Python<'_>) -> PyResult<String> {
        let one = |profile: &Profile| {
            let (low, high): (Vec<f64>, Vec<f64>) = profile.bands.iter().copied().unzip();
            json!({
                "parameter": profile.parameter.name, "unit": profile.parameter.unit,
                "values": profile.values, "lowest_score": profile.scores, "low": low, "high": high,
                "indistinguishable": profile.indistinguishable,
            })
        };
        let profiles: Vec<Value> = self.answer.profiles.iter().map(one).collect();
        to_text(&profiles).or_raise(py)
    }

    /// The expected score at points, with the ends of its 90 % interval; null where it is not known.
    fn expected(&self, py: Python<'_>, points: Vec<Vec<f64>>) -> PyResult<String> {
        let expected = |point: &Vec<f64>| match self.answer.expected_with_band(point) {
            Some((mean, (low, high))) => json!([mean, low, high]),
            None => json!([self.answer.expected_score(point), null, null]),
        };
        let found: Vec<Value> = py.detach(|| points.iter().map(expected).collect());
        to_text(&found).or_raise(py)
    }

    /// Joints or scored channels of the recordings beside those of the best point, one row a sample.
    fn joints(&self, py: Python<'_>) -> PyResult<String> {
        let way = Way {
            jobs: None,
            progress: None,
        };
        let rows = running::run(py, &way, |options| {
            options.install(|| results::joint_samples(&self.study, &self.answer))?
        })?;
        let column =
            |of: &dyn Fn(&JointSample) -> Value| -> Vec<Value> { rows.iter().map(of).collect() };
        let columns = json!({
            "recording": column(&|row| json!(row.recording)),
            "joint": column(&|row| json!(row.joint)),
            "quantity": column(&|row| json!(row.quantity.0)),
            "unit": column(&|row| json!(row.quantity.1)),
            "t_s": column(&|row| json!(row.time_s)),
            "recorded": column(&|row| json!(row.recorded)),
            "simulated": column(&|row| json!(row.simulated)),
        });
        to_text(&columns).or_raise(py)
    }

    /// The study with the values of the best point fixed; it knows which of its recordings they were fitted on.
    fn fitted(&self, py: Python<'_>) -> PyResult<Study> {
        let best = self.answer.report.best.as_ref();
        let best = best.map(|best| best.parameters.clone()).unwrap_or_default();
        let recordings = self.study.definition().recordings.iter().enumerate();
        let fitted_on: Vec<String> = recordings
            .filter(|(index, _)| !self.study.is_held_out(*index))
            .map(|(_, recording)| recording_id(recording))
            .collect();
        let draws = results::draws(&self.study, &self.answer);
        at(py, &self.study, &best, draws, &fitted_on)
    }

    /// Writes tables and pictures into a folder.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        py.detach(|| {
            check_folder(&folder, Kind::Study)?;
            results::write(&folder, &self.study, &self.answer).map(drop)
        })
        .or_raise(py)
    }
}
