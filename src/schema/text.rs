//! What is written as one word or sentence, where the type itself is more.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use crate::calibration::StartUsed;
use crate::prediction::SuccessRule;
use crate::trajectory::{Axes, Columns, QuaternionOrder, Role};
use crate::unit::{AngleUnit, LengthUnit, TimeUnit, Unit};
use crate::warning::Code;

/// A text for each type; the words that are allowed where there are only so many.
macro_rules! as_text {
    ($($type:ty, $name:literal, $doc:literal $(, $words:expr)?;)*) => {
        $(impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }

            fn inline_schema() -> bool {
                true
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                let words: Vec<&str> = std::iter::empty()$(.chain($words))?.collect();
                match words.is_empty() {
                    true => json_schema!({ "description": $doc, "type": "string" }),
                    false => json_schema!({ "description": $doc, "type": "string", "enum": words }),
                }
            }
        })*
    };
}

as_text! {
    Unit, "Unit", "A unit, e.g. `m`; `1` for a plain number.";
    StartUsed, "StartUsed", "Where the runs of a study start, in words.";
    SuccessRule, "SuccessRule", "Who said what far enough is, in words.";
    Code, "Code", "What a warning is about; docs/cli.md explains each.", Code::ALL.iter().map(|code| code.name());
    QuaternionOrder, "QuaternionOrder", "Whether the real part of a quaternion comes first.",
        [QuaternionOrder::Wxyz, QuaternionOrder::Xyzw].into_iter().map(QuaternionOrder::name);
    Axes, "Axes", "Which way the axes of poses point.",
        [Axes::World, Axes::Camera].into_iter().map(Axes::name);
    LengthUnit, "LengthUnit", "A unit of length.", LengthUnit::ALL.iter().map(|unit| unit.symbol());
    TimeUnit, "TimeUnit", "A unit of time.", TimeUnit::ALL.iter().map(|unit| unit.symbol());
    AngleUnit, "AngleUnit", "A unit of angles.", AngleUnit::ALL.iter().map(|unit| unit.symbol());
}

impl JsonSchema for Columns {
    fn schema_name() -> Cow<'static, str> {
        "Columns".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let column = |role: &Role| {
            let column = json_schema!({
                "description": "Name of a column, `NAME` or `NAME in UNIT`.",
                "type": "string",
            });
            (role.name().to_owned(), serde_json::Value::from(column))
        };
        let columns: serde_json::Map<_, _> = Role::ALL.iter().map(column).collect();
        json_schema!({
            "description": "Which column holds what, where it is not called as here.",
            "type": "object",
            "additionalProperties": false,
            "properties": columns,
        })
    }
}
