//! JSON Schemas of the types of a reading that are serialised as texts.

use std::borrow::Cow;

use realgap_core::string_schema;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use super::{Axes, Columns, QuaternionOrder, Role};

string_schema! {
    QuaternionOrder, "QuaternionOrder", "Order of the four numbers of a quaternion: real part first or last.",
        [QuaternionOrder::Wxyz, QuaternionOrder::Xyzw].into_iter().map(QuaternionOrder::name);
    Axes, "Axes", "Directions of the axes of poses.",
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
            "description": "Which column holds which quantity, if its name differs from realgap's own.",
            "type": "object",
            "additionalProperties": false,
            "properties": columns,
        })
    }
}
