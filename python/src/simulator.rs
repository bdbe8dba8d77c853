//! A simulator written in Python: a function that answers lines of the protocol.

use std::sync::Arc;

use pyo3::prelude::*;
use realgap::calibration::OwnSimulator;
use realgap::guest::{Answered, Failure, Guest, Port, Question};

/// A function of Python that takes a line and returns one.
#[derive(Debug)]
struct Function {
    respond: Py<PyAny>,
    identity: String,
}

impl Port for Function {
    fn identity(&self) -> String {
        self.identity.clone()
    }

    fn ask(&self, line: &str, _: Question) -> Answered<String> {
        let answer = Python::attach(|py| self.respond.call1(py, (line,))?.extract::<String>(py));
        answer.map_err(|error| Failure::of_answer(format!("raised {error}")))
    }
}

/// The simulator of a function; `identity` says what decides its answers.
pub fn own(respond: Py<PyAny>, identity: String) -> realgap::Result<OwnSimulator> {
    let guest = Guest::new(Arc::new(Function { respond, identity }))?;
    Ok(OwnSimulator::of_guest(Arc::new(guest)))
}
