//! Units that recorded files may use; inside the crate, all values are in metres, seconds and radians.

use std::fmt;

/// Declares an enum of units with their symbols and their sizes in SI units.
macro_rules! units {
    ($(#[$doc:meta])* $name:ident, $what:literal, $size:ident: $($(#[$about:meta])* $member:ident $symbol:literal $words:literal $factor:expr;)*) => {
        crate::string_enum! {
            $(#[$doc])*
            #[derive(Default)]
            $name.symbol, concat!("is no unit of ", $what);
            $($(#[$about])* $member $symbol;)*
        }

        impl $name {
            /// The size of one such unit in the SI unit.
            pub fn $size(self) -> f64 {
                match self {
                    $(Self::$member => $factor,)*
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $(Self::$member => $words,)*
                })
            }
        }
    };
}

units! {
    /// Unit of length of a file; everything inside the crate is metres.
    LengthUnit, "length", metres:
    /// Metres (the default).
    #[default]
    Metre "m" "metres" 1.0;
    /// Centimetres.
    Centimetre "cm" "centimetres" 0.01;
    /// Millimetres.
    Millimetre "mm" "millimetres" 0.001;
    /// International inches.
    Inch "in" "inches" 0.0254;
    /// International feet.
    Foot "ft" "feet" 0.3048;
}

impl LengthUnit {
    /// The units that a file without any statement may have; the others are read only where a file or a person states them.
    pub const METRIC: &[Self] = &[Self::Metre, Self::Centimetre, Self::Millimetre];

    /// The unit that a word in lower case names, e.g. `mm`, `millimeters` or `inch`.
    pub fn by_word(word: &str) -> Option<Self> {
        Some(match word {
            "m" | "meter" | "meters" | "metre" | "metres" => Self::Metre,
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Self::Centimetre,
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Self::Millimetre,
            "in" | "inch" | "inches" => Self::Inch,
            "ft" | "foot" | "feet" => Self::Foot,
            _ => return None,
        })
    }
}

units! {
    /// Unit of time of a file; everything inside the crate is seconds.
    TimeUnit, "time", seconds:
    /// Seconds (the default).
    #[default]
    Second "s" "seconds" 1.0;
    /// Milliseconds.
    Millisecond "ms" "milliseconds" 1e-3;
    /// Microseconds.
    Microsecond "us" "microseconds" 1e-6;
    /// Nanoseconds.
    Nanosecond "ns" "nanoseconds" 1e-9;
}

impl TimeUnit {
    /// The unit that a word in lower case names, e.g. `ns`, `nsec` or `nanoseconds`.
    pub fn by_word(word: &str) -> Option<Self> {
        Some(match word {
            "s" | "sec" | "secs" | "second" | "seconds" => Self::Second,
            "ms" | "msec" | "msecs" | "millis" | "millisec" | "millisecs" | "millisecond"
            | "milliseconds" => Self::Millisecond,
            "us" | "\u{b5}s" | "\u{3bc}s" | "usec" | "usecs" | "micros" | "microsec"
            | "microsecs" | "microsecond" | "microseconds" => Self::Microsecond,
            "ns" | "nsec" | "nsecs" | "nanos" | "nanosec" | "nanosecs" | "nanosecond"
            | "nanoseconds" => Self::Nanosecond,
            _ => return None,
        })
    }
}

units! {
    /// Unit of angle of a file; everything inside the crate is radians.
    AngleUnit, "angle", radians:
    /// Radians (the default).
    #[default]
    Radian "rad" "radians" 1.0;
    /// Degrees.
    Degree "deg" "degrees" std::f64::consts::PI / 180.0;
}

impl AngleUnit {
    /// The unit that a word in lower case names, e.g. `deg`, `degrees` or `radians`.
    pub fn by_word(word: &str) -> Option<Self> {
        Some(match word {
            "rad" | "rads" | "radian" | "radians" => Self::Radian,
            "deg" | "degs" | "degree" | "degrees" | "\u{b0}" => Self::Degree,
            _ => return None,
        })
    }
}
