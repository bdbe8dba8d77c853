//! Physical units, their symbols, and the constant of gravity.
//!
//! Inside the library, all values are in SI units: metres, seconds, kilograms, radians. Values are
//! converted where they are read and written, through the types of this module. The z axis of the
//! world frame points up. Quaternions have the real part first in files (`qw, qx, qy, qz`) and rotate from the
//! body frame into the world frame.

mod file_unit;
mod number;

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Mutex;

pub use file_unit::{AngleUnit, LengthUnit, TimeUnit};
pub use number::{DisplayUnit, decimals, number, percent_change_range, percent_range, quantity};

/// The default acceleration of gravity, in m/s², along −z of the world.
pub const GRAVITY_M_S2: f64 = 9.81;

/// Declares the enum of units with their symbols.
macro_rules! symbols {
    ($($unit:ident $symbol:literal $doc:literal;)*) => {
        /// Unit of a score, parameter or column. Values are stored in the unit named here.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Unit {
            $(#[doc = $doc] $unit,)*
            /// A unit that a simulator of somebody else declares, by its symbol.
            Other(&'static str),
        }

        impl Unit {
            /// The symbol, empty for [`Unit::One`].
            pub fn symbol(self) -> &'static str {
                match self {
                    $(Self::$unit => $symbol,)*
                    Self::Other(symbol) => symbol,
                }
            }

            /// The unit with this [label](Unit::label), as it stands in a report; `None` for any other text.
            pub fn by_label(label: &str) -> Option<Self> {
                let all = [$(Self::$unit,)*];
                all.into_iter().find(|unit| unit.label() == label)
            }
        }
    };
}

symbols! {
    One "" "Dimensionless (a ratio, a coefficient, a count).";
    Metre "m" "Metre.";
    Second "s" "Second.";
    Hertz "Hz" "Hertz.";
    Kilogram "kg" "Kilogram.";
    Radian "rad" "Radian.";
    Degree "deg" "Degree; only for scores and displayed values.";
    MetrePerSecond "m/s" "Metre per second.";
    Joule "J" "Joule.";
    MetrePerJoule "m/J" "Metre per joule: distance per energy, which is speed per power.";
    RadianPerSecond "rad/s" "Radian per second.";
    NewtonPerMetre "N/m" "Newton per metre: the stiffness of a spring that slides.";
    NewtonMetre "N m" "Newton metre.";
    NewtonMetreSecondPerRadian "N m s/rad" "Newton metre second per radian: a torque per speed.";
    MetrePerSecondSquared "m/s^2" "Metre per second squared.";
    PerSecond "1/s" "Per second (a servo gain).";
    PerRadian "1/rad" "Per radian.";
    NewtonMetrePerRadian "N m/rad" "Newton metre per radian: the stiffness of a spring.";
    Volt "V" "Volt.";
    Ohm "ohm" "Ohm.";
    NewtonMetrePerAmpere "N m/A" "Newton metre per ampere: a motor's torque constant.";
    PerNewtonMetre "1/(N m)" "Per newton metre.";
    KilogramSquareMetre "kg m^2" "Kilogram square metre: an inertia.";
}

/// Units that are not of this crate are compared and stored by reference, so each symbol lives as long as the program.
static OTHERS: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

impl Unit {
    /// The unit with this symbol, which may be one that this crate does not have; an empty text and `1` are [`Unit::One`].
    pub fn named(symbol: &str) -> Self {
        let symbol = symbol.trim();
        if let Some(unit) = Self::by_label(if symbol.is_empty() { "1" } else { symbol }) {
            return unit;
        }
        let mut others = OTHERS
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(known) = others.get(symbol) {
            return Self::Other(known);
        }
        let known: &'static str = Box::leak(symbol.to_owned().into_boxed_str());
        others.insert(known);
        Self::Other(known)
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

/// A unit is serialised as its label, e.g. `m`, which is the text that people read in a report.
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

/// A number with its noun in singular or plural: `1 recording`, `3 recordings`.
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
