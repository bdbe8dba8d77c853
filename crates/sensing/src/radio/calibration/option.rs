//! Options of fitting a radio model to a log of strengths.

use crate::radio::model::LogBase;
use crate::radio::propagation::Propagation;
use realgap_core::error::{Error, Result};
use realgap_core::range::Range;

/// Options of fitting a radio model to a log of strengths.
#[derive(Debug, Clone)]
pub struct RadioOptions {
    /// The propagation model; with `None` it is chosen by cross-validation over places.
    pub propagation: Option<&'static dyn Propagation>,
    /// Reference distance d₀, metres.
    pub reference_distance_m: f64,
    /// Base of the logarithm.
    pub log_base: LogBase,
    /// Height of the robot's antenna, metres.
    pub robot_height_m: f64,
}

impl Default for RadioOptions {
    fn default() -> Self {
        Self {
            propagation: None,
            reference_distance_m: 1.0,
            log_base: LogBase::Ten,
            robot_height_m: 0.3,
        }
    }
}

impl RadioOptions {
    pub(super) fn check(&self) -> Result<()> {
        for (field, value, least) in [
            ("reference distance", self.reference_distance_m, 1e-3),
            ("robot height", self.robot_height_m, 0.0),
        ] {
            let range = Range::within(least, 1e3, "m");
            range.check(value, field).map_err(Error::into_usage)?;
        }
        Ok(())
    }
}
