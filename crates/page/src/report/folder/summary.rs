//! What a page shows of `summary.json` of a sweep or a tuning.
//!
//! The whole report is a type of the crate `realgap-lab`, which is written and never read back. These are the fields of it that
//! a page needs; files of other versions may lack any of them.

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::fleet;
use realgap_lab::calibration::{Audit, Best, Reproduction, Validation};
use realgap_lab::claim::Claim;

/// What a page shows of the report of a sweep or a tuning.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct StudySummary {
    pub(in crate::report) study: Option<String>,
    pub(in crate::report) complete: Option<bool>,
    pub(in crate::report) points: usize,
    pub(in crate::report) recordings: Option<usize>,
    pub(in crate::report) tuning: Option<IgnoredAny>,
    pub(in crate::report) metric: String,
    pub(in crate::report) unit: String,
    pub(in crate::report) best: Option<Best>,
    pub(in crate::report) verdicts: Vec<VerdictRow>,
    pub(in crate::report) claims: Vec<Claim>,
    pub(in crate::report) audit: Option<Audit>,
    pub(in crate::report) validation: Option<Validation>,
    pub(in crate::report) transfer: Option<fleet::Transfer>,
    pub(in crate::report) reproduction: Option<Reproduction>,
}

/// What a page shows of the verdict on a parameter.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(in crate::report) struct VerdictRow {
    pub(in crate::report) parameter: String,
    pub(in crate::report) unit: String,
    pub(in crate::report) best: Option<f64>,
    pub(in crate::report) identified: Option<bool>,
    pub(in crate::report) interval: Option<[f64; 2]>,
    pub(in crate::report) intervals: Vec<[f64; 2]>,
    pub(in crate::report) text: String,
}
