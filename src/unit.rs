//! Units, and the few constants that every room shares.
//!
//! Inside the crate everything is SI: metres, seconds, kilograms, radians. Conversions happen at
//! the edges, through the types of this module. World frame: z up. Quaternions: real part first
//! in files (`qw, qx, qy, qz`), world from body.

mod number;

use std::fmt;

pub use number::{DisplayUnit, number, quantity};

/// Writes a unit as its label, e.g. `m`: for fields of reports.
pub(crate) fn as_label<S: serde::Serializer>(
    unit: &Unit,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(unit.label())
}

/// Standard magnitude of gravity used by default, in m/s², along −z of the world.
pub const GRAVITY_M_S2: f64 = 9.81;

/// Unit of a score, parameter or column. Values are stored in the unit named here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum Unit {
    /// Dimensionless (a ratio, a coefficient, a count).
    One,
    /// Metre.
    Metre,
    /// Second.
    Second,
    /// Hertz.
    Hertz,
    /// Kilogram.
    Kilogram,
    /// Radian.
    Radian,
    /// Degree; only for scores and for people.
    Degree,
    /// Metre per second.
    MetrePerSecond,
    /// Radian per second.
    RadianPerSecond,
    /// Newton metre.
    NewtonMetre,
    /// Metre per second squared.
    MetrePerSecondSquared,
    /// Per second (a servo gain).
    PerSecond,
}

impl Unit {
    /// The symbol, empty for [`Unit::One`].
    pub fn symbol(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Metre => "m",
            Self::Second => "s",
            Self::Hertz => "Hz",
            Self::Kilogram => "kg",
            Self::Radian => "rad",
            Self::Degree => "deg",
            Self::MetrePerSecond => "m/s",
            Self::RadianPerSecond => "rad/s",
            Self::NewtonMetre => "N m",
            Self::MetrePerSecondSquared => "m/s^2",
            Self::PerSecond => "1/s",
        }
    }

    /// The symbol, or `1` for a dimensionless quantity: for CSV and JSON, where a field may not be empty.
    pub fn label(self) -> &'static str {
        if self == Self::One {
            "1"
        } else {
            self.symbol()
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.label())
    }
}

/// Unit of length of a file; everything inside the crate is metres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum LengthUnit {
    /// Metres (the default).
    #[default]
    Metre,
    /// Centimetres.
    Centimetre,
    /// Millimetres.
    Millimetre,
}

impl LengthUnit {
    /// Metres per unit: 1, 0.01 or 0.001.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
        }
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Metre => "metres",
            Self::Centimetre => "centimetres",
            Self::Millimetre => "millimetres",
        })
    }
}

/// A number of things in words: `1 recording`, `3 recordings`.
///
/// ```
/// use realgap::unit::counted;
///
/// assert_eq!(counted(1, "recording"), "1 recording");
/// assert_eq!(counted(0, "recording"), "0 recordings");
/// ```
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
