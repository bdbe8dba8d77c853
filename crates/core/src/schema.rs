//! JSON Schemas of types that are serialised as one string although the Rust type is not a string.

/// Implements `JsonSchema` for each type as a string, with the list of allowed words where only some words are allowed.
#[macro_export]
macro_rules! string_schema {
    ($($type:ty, $name:literal, $doc:literal $(, $words:expr)?;)*) => {
        $(impl schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                $name.into()
            }

            fn inline_schema() -> bool {
                true
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let words: Vec<&str> = std::iter::empty()$(.chain($words))?.collect();
                match words.is_empty() {
                    true => schemars::json_schema!({ "description": $doc, "type": "string" }),
                    false => schemars::json_schema!({ "description": $doc, "type": "string", "enum": words }),
                }
            }
        })*
    };
}

use crate::unit::{AngleUnit, LengthUnit, TimeUnit, Unit};
use crate::warning::Code;

string_schema! {
    Unit, "Unit", "A unit, e.g. `m`; `1` for a plain number.";
    Code, "Code", "What a warning is about; docs/cli.md lists all of them.", Code::ALL.iter().map(|code| code.name());
    LengthUnit, "LengthUnit", "A unit of length.", LengthUnit::ALL.iter().map(|unit| unit.symbol());
    TimeUnit, "TimeUnit", "A unit of time.", TimeUnit::ALL.iter().map(|unit| unit.symbol());
    AngleUnit, "AngleUnit", "A unit of angles.", AngleUnit::ALL.iter().map(|unit| unit.symbol());
}
