//! The report of a sweep or a tuning as a page reads it.

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::report::folder::fleet;
use realgap_lab::calibration::{Audit, Best, Reproduction, Validation};
use realgap_lab::claim::Claim;

/// What a page shows of the report of a sweep or a tuning.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Report {
    pub(in crate::report) study: Option<String>,
    pub(in crate::report) complete: Option<bool>,
    pub(in crate::report) points: usize,
    pub(in crate::report) tuning: Option<IgnoredAny>,
    pub(in crate::report) metric: String,
    pub(in crate::report) unit: String,
    pub(in crate::report) best: Option<Best>,
    pub(in crate::report) verdicts: Vec<Verdict>,
    pub(in crate::report) claims: Vec<Claim>,
    pub(in crate::report) audit: Option<Audit>,
    pub(in crate::report) validation: Option<Validation>,
    pub(in crate::report) transfer: Option<fleet::Transfer>,
    pub(in crate::report) reproduction: Option<Reproduction>,
}

/// What a page shows of what is said of a parameter.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct Verdict {
    pub(in crate::report) parameter: String,
    pub(in crate::report) unit: String,
    pub(in crate::report) best: Option<f64>,
    pub(in crate::report) interval: Option<[f64; 2]>,
    pub(in crate::report) intervals: Vec<[f64; 2]>,
    pub(in crate::report) text: String,
}
