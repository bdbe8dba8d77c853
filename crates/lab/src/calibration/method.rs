//! How the points of an answer were chosen.

use serde::Serialize;

/// How the points of an answer were chosen.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// Every point of the study's grid.
    Sweep,
    /// An optimizer chose them.
    Tune(Tuned),
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
}
