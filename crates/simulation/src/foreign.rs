//! What a simulator of somebody else is asked: its own parameters, and what was recorded.

use std::collections::BTreeMap;
use std::sync::Arc;

/// The part of an experiment that only a simulator of somebody else uses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Foreign {
    /// Values of the simulator's parameters, by its own names.
    pub values: BTreeMap<String, f64>,
    /// Number of the equally valid setting; 0 is the study's own.
    pub setting: u64,
    /// What the recording says about the start and the commands of the run.
    pub start: Arc<ForeignStart>,
}

/// What a recording says about the start and the commands of a run, by the names of recorded columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ForeignStart {
    /// Name of the recording; empty where several recordings share the run.
    pub recording: String,
    /// First value of each recorded column; empty where the simulator starts by itself.
    pub values: Vec<(String, f64)>,
    /// Times of the commands, seconds since the start.
    pub times_s: Vec<f64>,
    /// The recorded commands, one value for each time.
    pub commands: Vec<(String, Vec<f64>)>,
}
