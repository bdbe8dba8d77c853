//! The report of a sweep or a tuning as a page reads it.

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::fleet;
use realgap_lab::calibration::{Audit, Best, Reproduction, Validation};
use realgap_lab::claim::Claim;

/// What a page shows of the report of a sweep or a tuning.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Report {
    pub(super) study: Option<String>,
    pub(super) complete: Option<bool>,
    pub(super) points: usize,
    pub(super) tuning: Option<IgnoredAny>,
    pub(super) metric: String,
    pub(super) unit: String,
    pub(super) best: Option<Best>,
    pub(super) verdicts: Vec<Verdict>,
    pub(super) claims: Vec<Claim>,
    pub(super) audit: Option<Audit>,
    pub(super) validation: Option<Validation>,
    pub(super) transfer: Option<fleet::Transfer>,
    pub(super) reproduction: Option<Reproduction>,
}

/// What a page shows of what is said of a parameter.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Verdict {
    pub(super) parameter: String,
    pub(super) unit: String,
    pub(super) best: Option<f64>,
    pub(super) interval: Option<[f64; 2]>,
    pub(super) intervals: Vec<[f64; 2]>,
    pub(super) text: String,
}
