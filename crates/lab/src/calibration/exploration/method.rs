//! How the points of an answer were chosen.

use serde::Serialize;

use crate::calibration::InformationGain;
use realgap_inference::{Agreement, LeastSquaresEstimate};

/// How the points of an answer were chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Every point of the study's grid.
    Sweep,
    /// An optimizer chose them.
    Tune(Tuned),
}

impl Method {
    /// Whether the points end where the method would have ended by itself; false for least squares whose budget ended before.
    pub(in crate::calibration) fn has_ended(&self) -> bool {
        match self {
            Self::Tune(tuned) => tuned.agreement.is_none_or(|known| known.has_ended()),
            Self::Sweep => true,
        }
    }

    /// Whether an optimizer chose the point of the run with this index because of scores. Such points crowd around the best
    /// point, so they are no random sample.
    pub(in crate::calibration) fn crowds(&self, run: usize) -> bool {
        match self {
            Self::Sweep => false,
            Self::Tune(tuned) => (tuned.design..tuned.evaluated).contains(&run),
        }
    }
}

/// Why tuning ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// The budget is spent.
    Budget,
    /// The optimizer has nothing more to try.
    Exhausted,
    /// `patience` points in a row were no better.
    NoImprovement,
    /// Stopped from outside; everything finished is stored.
    Interrupted,
}

/// How the points of a tuned study were chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Tuned {
    /// Name of the optimizer.
    pub optimizer: &'static str,
    /// Most points.
    pub budget: usize,
    /// Points of the space-filling first design.
    pub design: usize,
    /// Points evaluated; what is simulated after them completes the settings of the best one.
    pub evaluated: usize,
    /// Why it ended.
    pub termination: Termination,
    /// What least squares tell about each parameter where they ended; empty for other optimizers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub least_squares: Vec<LeastSquaresEstimate>,
    /// How well runs at some draws of the posterior of least squares fit, beside what the posterior promises; `None` for other
    /// optimizers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agreement: Option<Agreement>,
    /// Lowest score of all points, where least squares chose a point with a higher score: their robust loss weighs large errors
    /// less and contains prior knowledge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lowest_score: Option<f64>,
    /// Information that each recording adds to the others, largest first; empty for other optimizers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<InformationGain>,
}

impl Tuned {
    /// Whether the fit ended where it would have ended by itself; false for least squares whose budget ended before, or that may have
    /// ended in a wrong minimum.
    pub(in crate::calibration) fn has_converged(&self) -> bool {
        self.agreement.is_none_or(|known| known.has_converged())
    }
}
