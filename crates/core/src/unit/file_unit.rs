//! Units of what others have recorded; everything inside the crate is metres, seconds and radians.

use std::fmt;

/// Writes an enum of units with their symbols and sizes.
macro_rules! units {
    ($(#[$doc:meta])* $name:ident, $what:literal, $size:ident: $($(#[$variant_doc:meta])* $variant:ident $symbol:literal $words:literal $factor:expr;)*) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub enum $name {
            $($(#[$variant_doc])* $variant,)*
        }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// How it is written, e.g. in a study.
            pub fn symbol(self) -> &'static str {
                match self {
                    $(Self::$variant => $symbol,)*
                }
            }

            /// What one of it is in SI.
            pub fn $size(self) -> f64 {
                match self {
                    $(Self::$variant => $factor,)*
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $(Self::$variant => $words,)*
                })
            }
        }

        impl std::str::FromStr for $name {
            type Err = String;

            fn from_str(symbol: &str) -> Result<Self, String> {
                let known = Self::ALL.iter().find(|unit| unit.symbol() == symbol);
                known.copied().ok_or_else(|| {
                    let all: Vec<&str> = Self::ALL.iter().map(|unit| unit.symbol()).collect();
                    format!("`{symbol}` is no unit of {}; allowed: {}", $what, all.join(", "))
                })
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.symbol())
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let symbol = <String as serde::Deserialize>::deserialize(deserializer)?;
                symbol.parse().map_err(serde::de::Error::custom)
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

units! {
    /// Unit of angle of a file; everything inside the crate is radians.
    AngleUnit, "angle", radians:
    /// Radians (the default).
    #[default]
    Radian "rad" "radians" 1.0;
    /// Degrees.
    Degree "deg" "degrees" std::f64::consts::PI / 180.0;
}
