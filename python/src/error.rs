//! Errors of the library as exceptions, with the text that the command prints; advice is written as arguments of this package.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyString;
use realgap::{Advice, Error, ErrorKind};

/// Exceptions of callbacks, by the message of their error, until that error becomes an exception itself.
static CAUSES: Mutex<BTreeMap<String, PyErr>> = Mutex::new(BTreeMap::new());

/// The error for an exception in a callback; as an exception, it has that exception as its cause.
pub fn raised(py: Python<'_>, who: &str, cause: PyErr) -> Error {
    let kind = cause.get_type(py);
    let kind = kind
        .name()
        .map_or_else(|_| "an exception".to_owned(), |name| name.to_string());
    let said = cause.value(py).str().map(|text| text.to_string());
    let message = format!("{who} raised {kind}: {}", said.unwrap_or_default());
    CAUSES
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .insert(message.clone(), cause);
    Error::invalid(message)
}

/// The exception of an error.
pub fn exception(py: Python<'_>, error: Error) -> PyErr {
    let cause = CAUSES
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .remove(error.message());
    if let Some(cause) = &cause
        && cause.is_instance_of::<PyKeyboardInterrupt>(py)
    {
        // Ctrl-C in a callback ends the whole call.
        return cause.clone_ref(py);
    }
    let name = match (error.kind(), &cause) {
        (_, Some(_)) => "CallbackError",
        (ErrorKind::Io, _) => "FileError",
        (ErrorKind::Conflict, _) => "ConflictError",
        (ErrorKind::Usage, _) => "UsageError",
        (ErrorKind::Interrupted, _) => "Interrupted",
        _ => "InvalidError",
    };
    let made = made(py, name, &error.with_advice_as(argument));
    match (made, cause) {
        (Ok(made), cause) => {
            let exception = PyErr::from_value(made);
            if cause.is_some() {
                exception.set_cause(py, cause);
            }
            exception
        }
        (Err(failed), _) => failed,
    }
}

fn made<'py>(py: Python<'py>, name: &str, error: &Error) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("realgap._error")?.getattr(name)?;
    let made = class.call1((error.to_string(),))?;
    made.setattr("message", error.message())?;
    made.setattr(
        "file",
        error
            .file()
            .map(|file| PyString::new(py, &file.to_string_lossy())),
    )?;
    made.setattr("line", error.line_column().map(|(line, _)| line))?;
    made.setattr("column", error.line_column().map(|(_, column)| column))?;
    made.setattr("field", error.field_name())?;
    Ok(made)
}

/// The argument that follows an advice.
fn argument(advice: &Advice) -> String {
    match advice {
        Advice::Resume => "go on with resume=True".to_owned(),
        Advice::Restart => "start anew with restart=True".to_owned(),
        Advice::OtherFolder => "choose another folder=".to_owned(),
        Advice::FewerThreads => "use fewer jobs=".to_owned(),
        Advice::OtherOptimizer => "choose another optimizer=".to_owned(),
        Advice::OtherSeed => "choose another seed=".to_owned(),
        Advice::Unit(unit) => format!("read it with reading={{\"length\": \"{}\"}}", unit.symbol()),
        Advice::Recordings => "name them with recordings=[\"FOLDER/*.csv\"]".to_owned(),
        Advice::CalibratedValues => "give values with set={NAME: VALUE}".to_owned(),
        Advice::MetricWithoutBasis => {
            "a metric without a basis, e.g. metric=\"rms\", needs no first design of 64".to_owned()
        }
        Advice::LetOptimizerChoose => "let Study.tune choose the points".to_owned(),
        Advice::ListParameters => "realgap.parameters() lists all of them".to_owned(),
        other => other.to_string(),
    }
}

/// Turns results of the library into results for Python.
pub trait Raise<T> {
    /// The value, or the exception of the error.
    ///
    /// # Errors
    /// The exception.
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> Raise<T> for realgap::Result<T> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| exception(py, error))
    }
}
