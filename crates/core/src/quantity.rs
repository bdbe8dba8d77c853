//! A named number with its unit, its bounds, and the scale on which a search varies it.

use crate::error::{Error, Result};
use crate::unit::Unit;

/// A named number with unit, bounds and scale: the description of a parameter that a search needs.
///
/// ```
/// use realgap_core::quantity::{Quantity, Scale};
/// use realgap_core::unit::Unit;
///
/// let height = Quantity {
///     name: "height_m",
///     unit: Unit::Metre,
///     bounds: (0.0, 2.0),
///     whole: false,
///     scale: Scale::Linear,
/// };
/// assert!(height.check(1.5).is_ok() && height.check(2.5).is_err());
/// assert_eq!(height.label(), "height_m (m)");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name, e.g. `floor.friction`.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: Unit,
    /// Smallest and largest allowed value; both bounds are allowed.
    pub bounds: (f64, f64),
    /// True where only whole numbers make sense.
    pub whole: bool,
    /// The scale on which a search varies the value.
    pub scale: Scale,
}

/// The scale on which a search varies a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps of the search are equal differences of the value.
    Linear,
    /// Equal steps of the search are equal ratios of the value, if the searched range lies above 0.
    Log,
}

impl Quantity {
    /// Checks that `value` is allowed.
    ///
    /// # Errors
    /// A value that is out of bounds, not finite, or not whole although only whole numbers are allowed.
    pub fn check(&self, value: f64) -> Result<()> {
        let (low, high) = self.bounds;
        let in_bounds = value >= low && value <= high;
        if in_bounds && (!self.whole || value.fract() == 0.0) {
            return Ok(());
        }
        let kind = if self.whole {
            "whole numbers from "
        } else {
            ""
        };
        Err(Error::invalid("out of bounds")
            .field(self.name)
            .found(value)
            .allowed(format!("{kind}{low} to {high} {}", self.unit.symbol()).trim_end()))
    }

    /// Name and unit, as the title of an axis or a table column: `floor.friction` or `floor.height_m (m)`.
    pub fn label(&self) -> String {
        match self.unit {
            Unit::One => self.name.to_owned(),
            unit => format!("{} ({})", self.name, unit.symbol()),
        }
    }
}
