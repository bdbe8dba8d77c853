//! Units, and the few constants that every room shares.
//!
//! Inside the crate everything is SI: metres, seconds, kilograms, radians. Conversions happen at
//! the edges, through the types of this module. World frame: z up. Quaternions: real part first
//! in files (`qw, qx, qy, qz`), world from body.

mod file_unit;
mod number;

use std::fmt;

pub use file_unit::{AngleUnit, LengthUnit, TimeUnit};
pub use number::{DisplayUnit, decimals, number, quantity};

/// Standard magnitude of gravity used by default, in m/s², along −z of the world.
pub const GRAVITY_M_S2: f64 = 9.81;

/// Unit of a score, parameter or column. Values are stored in the unit named here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
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
    /// Joule.
    Joule,
    /// Metre per joule: speed per power.
    MetrePerJoule,
    /// Radian per second.
    RadianPerSecond,
    /// Newton metre.
    NewtonMetre,
    /// Newton metre second per radian: a torque per speed.
    NewtonMetreSecondPerRadian,
    /// Metre per second squared.
    MetrePerSecondSquared,
    /// Per second (a servo gain).
    PerSecond,
    /// Per radian.
    PerRadian,
    /// Volt.
    Volt,
    /// Ohm.
    Ohm,
    /// Newton metre per ampere: a motor's torque constant.
    NewtonMetrePerAmpere,
    /// Per newton metre.
    PerNewtonMetre,
    /// Kilogram square metre: an inertia.
    KilogramSquareMetre,
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
            Self::Joule => "J",
            Self::MetrePerJoule => "m/J",
            Self::RadianPerSecond => "rad/s",
            Self::NewtonMetre => "N m",
            Self::NewtonMetreSecondPerRadian => "N m s/rad",
            Self::MetrePerSecondSquared => "m/s^2",
            Self::PerSecond => "1/s",
            Self::PerRadian => "1/rad",
            Self::Volt => "V",
            Self::Ohm => "ohm",
            Self::NewtonMetrePerAmpere => "N m/A",
            Self::PerNewtonMetre => "1/(N m)",
            Self::KilogramSquareMetre => "kg m^2",
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

/// As its label, e.g. `m`: what stands in a report is what people read.
impl serde::Serialize for Unit {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.label())
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.label())
    }
}

/// A number of things in words: `1 recording`, `3 recordings`.
///
/// ```
/// use realgap_core::unit::counted;
///
/// assert_eq!(counted(1, "recording"), "1 recording");
/// assert_eq!(counted(0, "recording"), "0 recordings");
/// ```
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
