//! Schemas of what readings of files are written as.

use std::borrow::Cow;

use realgap_core::string_schema;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use super::{Axes, Columns, QuaternionOrder, Role};

string_schema! {
    QuaternionOrder, "QuaternionOrder", "Whether the real part of a quaternion comes first.",
        [QuaternionOrder::Wxyz, QuaternionOrder::Xyzw].into_iter().map(QuaternionOrder::name);
    Axes, "Axes", "Which way the axes of poses point.",
        [Axes::World, Axes::Camera].into_iter().map(Axes::name);
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
