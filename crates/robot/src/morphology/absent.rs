//! Serde defaults and `skip_serializing_if` predicates for optional fields: absent limits and values of zero.

use serde::{Deserialize, Deserializer};

/// Default of a limit that is left out: infinity.
pub(super) fn unlimited() -> f64 {
    f64::INFINITY
}

/// Reads a limit; an explicit `None` means no limit.
pub(super) fn limit<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_else(unlimited))
}

pub(super) fn is_unlimited(value: &f64) -> bool {
    *value == f64::INFINITY
}

pub(super) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
