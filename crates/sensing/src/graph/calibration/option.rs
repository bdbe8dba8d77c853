//! Options of fitting a sensorgraph to a log.

use super::regression::Stop;
use crate::graph::model::Frame;
use realgap_core::error::Result;
use realgap_core::range::Range;

/// Options of fitting a sensorgraph to a log.
#[derive(Debug, Clone, PartialEq)]
pub struct GraphOptions {
    /// Largest degree of the polynomials.
    pub degree: u32,
    /// Number of ranges of headings, or of directions of the world.
    pub headings: usize,
    /// Width of a segment of the scan, degrees.
    pub width_deg: f64,
    /// The criterion by which the number of terms is chosen.
    pub stop: Stop,
    /// How scans are predicted. With `None`, the fit chooses between the two kinds of polynomials by cross-validation over parts
    /// of the path.
    pub frame: Option<Frame>,
}

impl Default for GraphOptions {
    fn default() -> Self {
        Self {
            degree: 4,
            headings: 12,
            width_deg: 30.0,
            stop: Stop::Validation,
            frame: None,
        }
    }
}

impl GraphOptions {
    pub(super) fn check(&self) -> Result<()> {
        let range = |field: &str, found: f64, low: f64, high: f64, unit: &'static str| {
            Range::within(low, high, unit).check(found, field)
        };
        range("degree", f64::from(self.degree), 0.0, 8.0, "")?;
        range("headings", self.headings as f64, 1.0, 360.0, "")?;
        range("width", self.width_deg, 1.0, 180.0, "degrees")?;
        match self.stop {
            Stop::Err(share) => range("error reduction ratio", share, 0.0, 1.0, ""),
            Stop::Terms(terms) => range("terms", terms as f64, 1.0, 100.0, ""),
            _ => Ok(()),
        }
    }
}
