//! Writes JSON with the version of its schema in the field `schema_version`.

use serde::Serialize;
use serde_json::{Map, Value};

use crate::error::{Error, Result};
use crate::text::escaped_json;

/// Version of all JSON that is written for programs: it is increased when a field is removed or changes its meaning, not
/// when a field is added. The schemas are in `schemas/`.
pub const SCHEMA_VERSION: u32 = 1;

/// Indented JSON of a value, without control characters. `schema_version` is the first field of an object, and of every object in a
/// list.
///
/// # Errors
/// A value that JSON cannot hold.
pub fn versioned_json(value: &impl Serialize) -> Result<String> {
    let fail = |e| Error::invalid(format!("cannot write JSON: {e}"));
    let value = versioned_value(value)?;
    let text = serde_json::to_string_pretty(&value).map_err(fail)?;
    Ok(escaped_json(text))
}

/// The same as a value: what a reader of that text gets.
///
/// # Errors
/// As [`versioned_json`].
pub fn versioned_value(value: &impl Serialize) -> Result<Value> {
    let fail = |e| Error::invalid(format!("cannot write JSON: {e}"));
    Ok(match serde_json::to_value(value).map_err(fail)? {
        Value::Array(rows) => rows.into_iter().map(versioned).collect(),
        other => versioned(other),
    })
}

fn versioned(value: Value) -> Value {
    let Value::Object(fields) = value else {
        return value;
    };
    let version = ("schema_version".to_owned(), SCHEMA_VERSION.into());
    let all: Map<String, Value> = std::iter::once(version).chain(fields).collect();
    Value::Object(all)
}

#[cfg(test)]
mod tests {
    use super::versioned_json;

    #[test]
    fn an_object_and_every_object_in_a_list_begin_with_the_version() {
        let one = serde_json::json!({ "b": 1.0, "a": f64::NAN });
        assert_eq!(
            versioned_json(&one).unwrap(),
            "{\n  \"schema_version\": 1,\n  \"b\": 1.0,\n  \"a\": null\n}"
        );
        let rows = versioned_json(&[&one, &one]).unwrap();
        assert_eq!(rows.matches("\"schema_version\": 1").count(), 2);
        assert_eq!(versioned_json(&[1, 2]).unwrap(), "[\n  1,\n  2\n]");
    }
}
