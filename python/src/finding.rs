//! What a study finds without a search: how well its values predict the recordings, and what recordings say without a fit.

use std::path::PathBuf;

use pyo3::prelude::*;
use realgap::calibration::{self, BestFile};
use realgap::file::{versioned_json, write_atomic, write_ron};
use realgap::identification::LengthReading;
use realgap::optimization::RunOptions;
use realgap::simulation::parameter::ParameterSet;
use realgap::{Error, Result, Warning};

use crate::cli::evaluate::{metric_of, words, words_of_joints};
use crate::cli::identify::{self, Identified, IdentifiedKind};
use crate::error::Raise;

/// An answer without a folder: its text, its JSON, and the values that it found, if there are any.
#[pyclass(frozen, module = "realgap._native")]
pub struct Finding {
    text: String,
    report: String,
    warnings: Vec<Warning>,
    file: Option<BestFile>,
}

#[pymethods]
impl Finding {
    fn text(&self) -> &str {
        &self.text
    }

    fn report(&self) -> &str {
        &self.report
    }

    fn warnings(&self, py: Python<'_>) -> PyResult<String> {
        crate::text::to_text(&self.warnings).or_raise(py)
    }

    /// The values that were found, by name.
    fn parameters(&self, py: Python<'_>) -> PyResult<String> {
        let file = self.file.as_ref();
        let values = file.map(|file| file.parameters.clone()).unwrap_or_default();
        crate::text::to_text(&values).or_raise(py)
    }

    /// Writes the values as the command's `-o` does.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let write = || match &self.file {
            Some(file) => write_atomic(&path, write_ron(file)?.as_bytes()),
            None => Err(
                Error::usage("this answer holds no values that could be written")
                    .hint("Study.tune fits values"),
            ),
        };
        write().or_raise(py)
    }
}

/// The errors of a study's fixed values, as `realgap evaluate` reports them.
///
/// # Errors
/// Recordings without orientations, runs that all diverge, or the work was stopped.
pub fn evaluated(study: &calibration::Study, run: &RunOptions<'_>) -> Result<Finding> {
    let mut definition = study.definition().clone();
    definition.metric = metric_of(&definition, "Study.gap, Study.ensemble")?;
    let (is_of_joints, values) = (definition.is_of_joints(), ParameterSet::new());
    let whole = (definition.horizon.is_some()).then(|| calibration::Definition {
        horizon: None,
        ..definition.clone()
    });
    let study = calibration::Study::new(definition)?;
    if !is_of_joints {
        let found = study.evaluate(&values, run)?.with_claims(None);
        return Ok(Finding {
            text: words(&found, false),
            report: versioned_json(&found)?,
            warnings: found.warnings,
            file: None,
        });
    }
    let mut found = study.evaluate_joints(&values, run)?;
    if let Some(whole) = whole {
        let whole = calibration::Study::new(whole)?.evaluate_joints(&values, run)?;
        found.whole_mrad = Some(whole.angle_mrad);
    }
    Ok(Finding {
        text: words_of_joints(&found, false),
        report: versioned_json(&found)?,
        warnings: found.warnings,
        file: None,
    })
}

/// What the recordings of a study say without a fit, as `realgap study identify` reports it.
///
/// # Errors
/// An unknown explanation, recordings that do not fly, or the work was stopped.
pub fn identified(
    study: &calibration::Study,
    explain: &str,
    run: &RunOptions<'_>,
) -> Result<Finding> {
    let reading = match explain {
        "length-scale" => LengthReading::LengthScale,
        "gravity" => LengthReading::Gravity,
        other => {
            return Err(Error::usage("not an explanation of an apparent gravity")
                .field("explain")
                .found(other)
                .allowed("length-scale, gravity"));
        }
    };
    let found = identify::identified(study.definition().clone(), reading, run)?;
    let report = match &found.kind {
        IdentifiedKind::Flight(flight, odds) => {
            versioned_json(&Identified::new(flight, odds.as_ref()))
        }
        IdentifiedKind::JointedFlight(flight) => versioned_json(&**flight),
        IdentifiedKind::Joints(joints) => versioned_json(&**joints),
    }?;
    Ok(Finding {
        text: found.text(false),
        report,
        warnings: found.warnings,
        file: found.file,
    })
}
