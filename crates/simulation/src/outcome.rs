//! Outcome of a simulation: a result, or a divergence.

use std::fmt;

use serde::Serialize;

use realgap_core::error::{Error, Result};

/// The result `T` of a completed simulation, or the reason why the simulation diverged.
///
/// ```
/// use realgap_simulation::{Divergence, Outcome};
///
/// let far: Outcome<f64> = Outcome::Completed(0.4);
/// assert_eq!(far.map(|m| 100.0 * m).completed(), Some(40.0));
/// let lost: Outcome<f64> = Outcome::Diverged(Divergence { at_s: 1.5, why: "it flew away".to_owned() });
/// assert_eq!(lost.into_result().unwrap_err().message(), "the simulation diverged at 1.500 s: it flew away");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Outcome<T> {
    /// The whole duration was simulated.
    Completed(T),
    /// The state became non-finite or implausible; such a run has no result and cannot be selected as best.
    Diverged(Divergence),
}

/// Time and reason of a simulation that was stopped because it diverged, or that failed as a whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Divergence {
    /// Time of the divergence, seconds from the start (negative while the robot settles); 0 where the run failed as a whole.
    pub at_s: f64,
    /// Description of the implausible state, or of the failure.
    pub why: String,
}

impl Divergence {
    /// The failure of a whole run.
    pub fn failure(why: impl Into<String>) -> Self {
        Self {
            at_s: 0.0,
            why: why.into(),
        }
    }
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at_s {
            0.0 => f.write_str(&self.why),
            at_s => write!(f, "at {at_s:.3} s: {}", self.why),
        }
    }
}

impl<T> Outcome<T> {
    /// The result, if the simulation was completed.
    pub fn completed(self) -> Option<T> {
        match self {
            Self::Completed(result) => Some(result),
            Self::Diverged(_) => None,
        }
    }

    /// A reference to the result, if the simulation was completed.
    pub fn get(&self) -> Option<&T> {
        self.as_ref().completed()
    }

    /// The divergence, if the simulation diverged.
    pub fn divergence(&self) -> Option<&Divergence> {
        match self {
            Self::Completed(_) => None,
            Self::Diverged(divergence) => Some(divergence),
        }
    }

    /// Whether the simulation was completed.
    pub fn is_completed(&self) -> bool {
        self.divergence().is_none()
    }

    /// The same outcome, its result borrowed.
    pub fn as_ref(&self) -> Outcome<&T> {
        match self {
            Self::Completed(result) => Outcome::Completed(result),
            Self::Diverged(divergence) => Outcome::Diverged(divergence.clone()),
        }
    }

    /// The same outcome with the function `of` applied to the result.
    pub fn map<U>(self, of: impl FnOnce(T) -> U) -> Outcome<U> {
        match self {
            Self::Completed(result) => Outcome::Completed(of(result)),
            Self::Diverged(divergence) => Outcome::Diverged(divergence),
        }
    }

    /// As [`Self::map`], for a function that can fail.
    ///
    /// # Errors
    /// The errors of `of`.
    pub fn try_map<U>(self, of: impl FnOnce(T) -> Result<U>) -> Result<Outcome<U>> {
        Ok(match self {
            Self::Completed(result) => Outcome::Completed(of(result)?),
            Self::Diverged(divergence) => Outcome::Diverged(divergence),
        })
    }

    /// The result; a divergence becomes an error.
    ///
    /// # Errors
    /// The run diverged; the error states the time and the reason.
    pub fn into_result(self) -> Result<T> {
        match self {
            Self::Completed(result) => Ok(result),
            Self::Diverged(divergence) => Err(divergence.into()),
        }
    }
}

impl From<Divergence> for Error {
    fn from(divergence: Divergence) -> Self {
        if divergence.at_s == 0.0 {
            return Self::invalid(format!("the simulation failed: {divergence}"));
        }
        Self::invalid(format!("the simulation diverged {divergence}"))
            .hint("try a shorter timestep or more substeps; check masses, sizes and servo limits")
    }
}
