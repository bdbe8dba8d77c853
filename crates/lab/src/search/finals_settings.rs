//! Settings of the finals.

use serde::{Deserialize, Serialize};

/// How the best robots of a search are judged again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct FinalsSettings {
    /// How many robots.
    pub count: usize,
    /// Repeats of each with draws that the search has not seen, for its prediction card and its rank.
    pub repeats: usize,
    /// Largest change of the mean displacement under other solver settings with which a robot survives, as a share.
    pub tolerance: f64,
}

impl Default for FinalsSettings {
    fn default() -> Self {
        Self {
            count: 5,
            repeats: 50,
            tolerance: 0.25,
        }
    }
}
