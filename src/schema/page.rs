//! The page that lists every field of every file: docs/files.md, from the schemas.

use std::collections::{BTreeSet, VecDeque};
use std::fmt::Write as _;

use serde_json::{Map, Value};

use super::{FileKind, files};

/// Widest line.
const WIDTH: usize = 100;

const HEAD: &str = "\
# Files

Every field of every file, from the types that read them: this page is made together with the JSON
Schemas in `schemas/files/` (`realgap study schema NAME` prints one), and a test holds all three together.
`realgap study new robot|study|search|arena|noise|meta` writes a commented file to start from;
`realgap check FILE` says whether yours is sound.

Files are RON: `(name: value, ...)` with or without a name in front, lists in `[]`, maps in `{}`,
`//` before comments. What is optional can be left out and need not be wrapped in `Some(...)`. A field that is
not listed here is an error. The same file may be JSON: brackets with names become objects, other
brackets and lists become arrays, `Name` becomes `\"Name\"`, and `Name(...)` becomes
`{\"Name\": ...}`; that is what Python dictionaries are, and what the schemas describe.

Units are in the names: metres, seconds, radians, kilograms, newtons and what they make, unless a
name says otherwise (`_deg`, `_px`, `_db`).
";

/// The page.
pub fn page() -> String {
    let mut page = String::new();
    for line in HEAD.split("\n\n") {
        let heading = line.starts_with('#');
        let text = line.split_whitespace().collect::<Vec<_>>().join(" ");
        let text = if heading {
            text
        } else {
            wrapped(&text, "", "")
        };
        let _ = write!(page, "{}\n\n", text.trim_end());
    }
    let mut described = BTreeSet::new();
    let kinds = files();
    // A type that is a file of its own is described in its own section.
    let fields = |kind: &FileKind| kind.schema.get("properties").cloned();
    let roots: Vec<Value> = kinds.iter().filter_map(fields).collect();
    for kind in &kinds {
        one(&mut page, kind, &roots, &mut described);
    }
    format!("{}\n", page.trim_end())
}

fn one(page: &mut String, kind: &FileKind, roots: &[Value], described: &mut BTreeSet<String>) {
    let Value::Object(root) = Value::from(kind.schema.clone()) else {
        return;
    };
    let empty = Map::new();
    let definitions = root
        .get("$defs")
        .and_then(Value::as_object)
        .unwrap_or(&empty);
    let _ = write!(page, "## {}\n\n", capital(kind.name));
    let doc = match kind.is_ron {
        true => kind.doc.to_owned(),
        false => format!("{} It is JSON.", kind.doc),
    };
    let _ = write!(page, "{}\n\n", wrapped(&doc, "", "").trim_end());
    let mut waiting = VecDeque::new();
    describe(page, &root, &mut waiting);
    let mut here = BTreeSet::new();
    while let Some(name) = waiting.pop_front() {
        let Some(Value::Object(definition)) = definitions.get(&name) else {
            continue;
        };
        // A type that was described in the same words under an earlier file is not described again.
        let whole = format!("{name} {}", Value::Object(definition.clone()));
        if !here.insert(name.clone()) || described.contains(&whole) {
            continue;
        }
        described.insert(whole);
        if let Some(own) = definition.get("properties")
            && roots.iter().any(|root| root == own)
        {
            continue;
        }
        let _ = write!(page, "### *{}* of a {}\n\n", called(&name), kind.name);
        if let Some(doc) = text(definition, "description") {
            let _ = write!(page, "{}\n\n", wrapped(&plain(doc), "", "").trim_end());
        }
        describe(page, definition, &mut waiting);
    }
}

/// Fields or variants of a type, a line each.
fn describe(page: &mut String, schema: &Map<String, Value>, waiting: &mut VecDeque<String>) {
    if let Some(Value::Array(variants)) = schema.get("oneOf").or_else(|| schema.get("anyOf")) {
        for variant in variants.iter().filter_map(Value::as_object) {
            describe_variant(page, variant, waiting);
        }
    } else if let Some(Value::Array(names)) = schema.get("enum") {
        let names: Vec<String> = names
            .iter()
            .map(|name| format!("`{}`", bare(name)))
            .collect();
        let _ = writeln!(page, "{}", wrapped(&names.join(", "), "- ", "  "));
    } else if let Some(Value::Object(fields)) = schema.get("properties") {
        let required = required(schema);
        for (name, field) in fields {
            describe_field(
                page,
                "- ",
                name,
                field,
                required.contains(&name.as_str()),
                waiting,
            );
        }
    } else {
        let kind = kind_of(&Value::Object(schema.clone()), waiting);
        let _ = writeln!(page, "{}", wrapped(&kind, "- ", "  "));
    }
    page.push('\n');
}

fn describe_variant(
    page: &mut String,
    variant: &Map<String, Value>,
    waiting: &mut VecDeque<String>,
) {
    let doc = text(variant, "description").map(plain).unwrap_or_default();
    if let Some(names) = variant.get("enum").and_then(Value::as_array) {
        for name in names {
            let _ = writeln!(page, "- `{}`", bare(name));
        }
    } else if let Some(name) = variant.get("const") {
        let _ = writeln!(
            page,
            "{}",
            wrapped(&format!("`{}`: {doc}", bare(name)), "- ", "  ")
        );
    } else if let Some(Value::Object(content)) = variant.get("properties") {
        for (name, inner) in content {
            let fields = inner.get("properties").and_then(Value::as_object);
            let Some(fields) = fields else {
                let kind = kind_of(inner, waiting);
                let line = format!("`{name}(...)` of {kind}: {doc}");
                let _ = writeln!(page, "{}", wrapped(line.trim_end_matches(": "), "- ", "  "));
                continue;
            };
            let line = format!("`{name}(...)`: {doc}");
            let _ = writeln!(page, "{}", wrapped(line.trim_end_matches(": "), "- ", "  "));
            let required = inner.as_object().map(required).unwrap_or_default();
            for (field, schema) in fields {
                describe_field(
                    page,
                    "  - ",
                    field,
                    schema,
                    required.contains(&field.as_str()),
                    waiting,
                );
            }
        }
    }
}

fn describe_field(
    page: &mut String,
    bullet: &str,
    name: &str,
    field: &Value,
    is_required: bool,
    waiting: &mut VecDeque<String>,
) {
    let kind = kind_of(field, waiting);
    let doc = field.get("description").and_then(Value::as_str).map(plain);
    let default = field.get("default").and_then(shown);
    let need = match (is_required, default) {
        (true, _) => ", **needed**".to_owned(),
        (false, Some(default)) => format!(", default `{default}`"),
        (false, None) => String::new(),
    };
    let line = format!("`{name}`: {kind}{need}. {}", doc.unwrap_or_default());
    let indent = " ".repeat(bullet.len());
    let _ = writeln!(page, "{}", wrapped(line.trim_end(), bullet, &indent));
}

/// The kind of a value, in words.
fn kind_of(schema: &Value, waiting: &mut VecDeque<String>) -> String {
    if let Some(target) = schema.get("$ref").and_then(Value::as_str) {
        let name = target.trim_start_matches("#/$defs/");
        waiting.push_back(name.to_owned());
        return format!("*{}*", called(name));
    }
    for key in ["anyOf", "oneOf", "allOf"] {
        if let Some(Value::Array(choices)) = schema.get(key) {
            let mut kinds: Vec<String> = Vec::new();
            for choice in choices {
                if choice.get("type") != Some(&Value::from("null")) {
                    kinds.push(kind_of(choice, waiting));
                }
            }
            return kinds.join(" or ");
        }
    }
    if let Some(Value::Array(names)) = schema.get("enum") {
        let names: Vec<String> = names
            .iter()
            .filter(|name| !name.is_null())
            .map(|name| format!("`\"{}\"`", bare(name)))
            .collect();
        return format!("one of {}", names.join(", "));
    }
    let kind = match schema.get("type") {
        Some(Value::Array(kinds)) => kinds.iter().find(|kind| *kind != "null"),
        other => other,
    };
    match kind.and_then(Value::as_str) {
        Some("number") => "number".to_owned(),
        Some("integer") => "whole number".to_owned(),
        Some("boolean") => "true or false".to_owned(),
        Some("string") => "text".to_owned(),
        Some("array") => match (schema.get("prefixItems"), schema.get("items")) {
            (Some(Value::Array(items)), _) => {
                let kinds: Vec<String> = items.iter().map(|item| kind_of(item, waiting)).collect();
                match kinds.split_first() {
                    Some((first, rest)) if rest.iter().all(|kind| kind == first) => {
                        format!("{} {first}s in brackets", kinds.len())
                    }
                    _ => format!("({})", kinds.join(", ")),
                }
            }
            (_, Some(item)) => format!("list of {}", kind_of(item, waiting)),
            _ => "list".to_owned(),
        },
        Some("object") => match schema.get("additionalProperties") {
            Some(value @ Value::Object(_)) => {
                format!("map from names to {}", kind_of(value, waiting))
            }
            _ => "object".to_owned(),
        },
        _ => "value".to_owned(),
    }
}

/// The text of a default; `None` for an empty one, which is not shown.
fn shown(default: &Value) -> Option<String> {
    match default {
        Value::Null | Value::Object(_) => None,
        Value::Array(all) if all.is_empty() => None,
        Value::Array(all) => {
            let all: Option<Vec<String>> = all.iter().map(shown).collect();
            all.map(|all| format!("({})", all.join(", ")))
        }
        Value::String(text) if text.is_empty() => None,
        other => Some(other.to_string()),
    }
}

fn required(schema: &Map<String, Value>) -> Vec<&str> {
    let names = schema.get("required").and_then(Value::as_array);
    names
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect()
}

fn text<'a>(schema: &'a Map<String, Value>, key: &str) -> Option<&'a str> {
    schema.get(key).and_then(Value::as_str)
}

fn bare(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// A comment of the code as a sentence: the first paragraph, links as what they show.
fn plain(doc: &str) -> String {
    let first = doc
        .split("\n\n")
        .next()
        .unwrap_or_default()
        .replace('\n', " ");
    first.replace("[`", "`").replace("`]", "`")
}

/// The name of a type for readers: without the suffixes of the code.
fn called(name: &str) -> String {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    letters.trim_end_matches("File").to_lowercase()
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

fn wrapped(text: &str, first: &str, indent: &str) -> String {
    let mut lines = vec![first.to_owned()];
    let mut is_empty = true;
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if !is_empty && line + 1 + word.chars().count() > WIDTH {
            lines.push(indent.to_owned());
            is_empty = true;
        }
        if let Some(line) = lines.last_mut() {
            if !is_empty {
                line.push(' ');
            }
            line.push_str(word);
            is_empty = false;
        }
    }
    lines.join("\n")
}
