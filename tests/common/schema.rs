//! Validates JSON against the committed schemas. Only keywords that these schemas use are known; others are an error of the test.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::project;

/// Keywords that only describe.
const ANNOTATIONS: &[&str] = &[
    "$schema",
    "$defs",
    "title",
    "description",
    "default",
    "format",
];

/// The schema in `schemas/PATH.json`.
pub fn schema(path: &str) -> Value {
    let file = project().join("schemas").join(path).with_extension("json");
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{path}: {e}"));
    serde_json::from_str(&text).unwrap()
}

/// Validates the output of `--format json`, or a file of a results folder, against the schema of this answer.
pub fn answer(name: &str, text: &str) -> Value {
    let value: Value = serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    if let Err(fault) = held(&schema(&format!("answers/{name}")), &value) {
        panic!("answers/{name}: {fault}");
    }
    value
}

/// Whether a value is valid, and the schema describes all of its keys.
///
/// # Errors
/// The place in the value, and its fault.
pub fn held(schema: &Value, value: &Value) -> Result<(), String> {
    whole(&Checker { root: schema }, schema, value, "")
}

struct Checker<'a> {
    root: &'a Value,
}

/// Validates a value; every key must be described by a schema.
fn whole(checker: &Checker<'_>, schema: &Value, value: &Value, at: &str) -> Result<(), String> {
    let known = checker.look(schema, value, at)?;
    if let Value::Object(fields) = value {
        for name in fields.keys() {
            if !known.contains(name) {
                return Err(format!("{at}/{name} is not described"));
            }
        }
    }
    Ok(())
}

impl Checker<'_> {
    /// The keys that the schema describes.
    fn look(&self, schema: &Value, value: &Value, at: &str) -> Result<BTreeSet<String>, String> {
        let rules = match schema {
            Value::Bool(true) => return Ok(keys(value)),
            Value::Object(rules) => rules,
            other => return Err(format!("{at}: not a schema: {other}")),
        };
        let mut known = BTreeSet::new();
        for (rule, wanted) in rules {
            match rule.as_str() {
                "$ref" => {
                    let name = wanted.as_str().unwrap().trim_start_matches("#/$defs/");
                    let target = &self.root["$defs"][name];
                    assert!(
                        target.is_object() || target.is_boolean(),
                        "{name} is not defined"
                    );
                    known.extend(self.look(target, value, at)?);
                }
                "type" => has_type(wanted, value, at)?,
                "const" if !same(wanted, value) => {
                    return Err(format!("{at}: {value}, and not {wanted}"));
                }
                "enum" if !wanted.as_array().unwrap().contains(value) => {
                    return Err(format!("{at}: {value} is none of {wanted}"));
                }
                "const" | "enum" => {}
                "minimum" | "maximum" | "minItems" | "maxItems" | "minLength" | "maxLength" => {
                    within(rule, wanted, value, at)?;
                }
                "required" => {
                    for name in wanted.as_array().unwrap() {
                        let name = name.as_str().unwrap();
                        if value.is_object() && value.get(name).is_none() {
                            return Err(format!("{at}/{name} is missing"));
                        }
                    }
                }
                "properties" => {
                    for (name, field) in wanted.as_object().unwrap() {
                        if let Some(found) = value.get(name) {
                            whole(self, field, found, &format!("{at}/{name}"))?;
                            known.insert(name.clone());
                        }
                    }
                }
                "additionalProperties" => self.rest(rules, wanted, value, at, &mut known)?,
                "items" | "prefixItems" => self.items(rules, value, at)?,
                "oneOf" | "anyOf" | "allOf" => {
                    known.extend(self.choice(rule, wanted, value, at)?);
                }
                _ if ANNOTATIONS.contains(&rule.as_str()) => {}
                other => panic!("{at}: the test does not know `{other}`"),
            }
        }
        Ok(known)
    }

    fn rest(
        &self,
        rules: &Map<String, Value>,
        wanted: &Value,
        value: &Value,
        at: &str,
        known: &mut BTreeSet<String>,
    ) -> Result<(), String> {
        let named = rules.get("properties").and_then(Value::as_object);
        for (name, found) in value.as_object().into_iter().flatten() {
            if named.is_some_and(|named| named.contains_key(name)) {
                continue;
            }
            if *wanted == Value::Bool(false) {
                return Err(format!("{at}/{name} is not allowed"));
            }
            whole(self, wanted, found, &format!("{at}/{name}"))?;
            known.insert(name.clone());
        }
        Ok(())
    }

    fn items(&self, rules: &Map<String, Value>, value: &Value, at: &str) -> Result<(), String> {
        let first = rules.get("prefixItems").and_then(Value::as_array);
        let first = first.map_or(&[][..], Vec::as_slice);
        for (index, item) in value.as_array().into_iter().flatten().enumerate() {
            if let Some(schema) = first.get(index).or_else(|| rules.get("items")) {
                whole(self, schema, item, &format!("{at}/{index}"))?;
            }
        }
        Ok(())
    }

    fn choice(
        &self,
        rule: &str,
        wanted: &Value,
        value: &Value,
        at: &str,
    ) -> Result<BTreeSet<String>, String> {
        let all = wanted.as_array().unwrap();
        let (mut known, mut faults, mut fitting) = (BTreeSet::new(), Vec::new(), 0);
        for choice in all {
            match self.look(choice, value, at) {
                Ok(keys) => {
                    fitting += 1;
                    known.extend(keys);
                }
                Err(fault) => faults.push(fault),
            }
        }
        let is_enough = match rule {
            "oneOf" => fitting == 1,
            "anyOf" => fitting > 0,
            _ => fitting == all.len(),
        };
        match is_enough {
            true => Ok(known),
            false => Err(format!(
                "{at}: {fitting} of {rule} fit: {}",
                faults.join("; ")
            )),
        }
    }
}

fn keys(value: &Value) -> BTreeSet<String> {
    let fields = value.as_object().into_iter().flatten();
    fields.map(|(name, _)| name.clone()).collect()
}

fn same(a: &Value, b: &Value) -> bool {
    a == b || (a.is_number() && a.as_f64() == b.as_f64())
}

fn has_type(wanted: &Value, value: &Value, at: &str) -> Result<(), String> {
    let one = |name: &str| match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("{at}: the test does not know the type `{other}`"),
    };
    let fits = match wanted {
        Value::Array(names) => names.iter().any(|name| one(name.as_str().unwrap())),
        name => one(name.as_str().unwrap()),
    };
    match fits {
        true => Ok(()),
        false => Err(format!("{at}: {value} is not of type {wanted}")),
    }
}

fn within(rule: &str, wanted: &Value, value: &Value, at: &str) -> Result<(), String> {
    let limit = wanted.as_f64().unwrap();
    let measured = match value {
        Value::Number(number) => number.as_f64(),
        Value::Array(items) => Some(items.len() as f64),
        Value::String(text) => Some(text.chars().count() as f64),
        _ => None,
    };
    let holds = match (measured, rule.starts_with("min")) {
        (None, _) => true,
        (Some(measured), true) => measured >= limit,
        (Some(measured), false) => measured <= limit,
    };
    match holds {
        true => Ok(()),
        false => Err(format!("{at}: {value} against {rule} {wanted}")),
    }
}
