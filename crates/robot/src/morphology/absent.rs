//! What files leave out: limits that there are not, and what is zero.

use serde::{Deserialize, Deserializer};

/// The value of what has no limit.
pub(super) fn unlimited() -> f64 {
    f64::INFINITY
}

/// A limit, or `None` in so many words.
pub(super) fn limit<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_else(unlimited))
}

pub(super) fn is_unlimited(value: &f64) -> bool {
    *value == f64::INFINITY
}

pub(super) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
