//! JSON lines: one object for each sample; also a JSON array of such objects, and one object whose lists are columns.

use serde_json::{Map, Value};

use super::ForeignTable;
use super::flat::Flat;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, excerpt};
use realgap_core::error::{Error, Result};

/// Files with a JSON object for each sample, as robots and servers log them. Names of nested objects are joined by dots; a place of three
/// numbers becomes `NAME.x`, `NAME.y`, `NAME.z`; other lists stay lists.
pub const JSON_LINES: ForeignTable = ForeignTable {
    name: "json-lines",
    doc: "JSON lines, or an array of JSON objects: one object for each sample; or one object of lists of equal length: one list for each column",
    extensions: &["jsonl", "ndjson", "json"],
    recognises: |_| false,
    table: |bytes, _| table(bytes),
    beside: None,
};

/// The deepest nesting of objects that is read.
const DEEPEST: usize = 8;
/// Names of lists of three numbers that are a place.
const PLACES: [&str; 7] = [
    "position",
    "pos",
    "xyz",
    "translation",
    "location",
    "place",
    "p",
];
const AXES: [&str; 3] = ["x", "y", "z"];

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut samples: Vec<(usize, Map<String, Value>)> = Vec::new();
    let mut inside = None;
    // Not an object in files with a line for each sample: those end at their second line.
    let whole: Option<Map<String, Value>> = serde_json::from_str(&text).ok();
    if text.trim_start().starts_with('[') {
        let all: Value =
            serde_json::from_str(&text).map_err(|error| broken(error.line(), &error))?;
        for (index, value) in all.as_array().into_iter().flatten().enumerate() {
            samples.push((index + 1, object(index + 1, value.clone())?));
        }
    } else if let Some((name, list)) = whole.as_ref().and_then(list_inside) {
        for (index, value) in list.iter().enumerate() {
            samples.push((index + 1, object(index + 1, value.clone())?));
        }
        inside = Some(format!(
            "samples are the objects of the list `{}`",
            excerpt(name)
        ));
    } else if let Some((count, columns)) = whole
        .as_ref()
        .and_then(|all| Some((columns_inside(all)?, all)))
    {
        for index in 0..count {
            samples.push((index + 1, sample_of_all(columns, index, count)));
        }
        inside = Some(format!(
            "the lists of {count} values in one object are columns; nothing else in it is read"
        ));
    } else {
        for (index, line) in text.lines().enumerate() {
            if line.trim().is_empty() {
                continue;
            }
            let value = serde_json::from_str(line).map_err(|error| broken(index + 1, &error))?;
            samples.push((index + 1, object(index + 1, value)?));
        }
    }
    let mut names: Vec<String> = Vec::new();
    let mut known = std::collections::HashSet::new();
    let mut rows: Vec<Vec<(String, String)>> = Vec::new();
    for (line, sample) in samples {
        let mut cells = Vec::new();
        flatten("", Value::Object(sample), 0, &mut cells)
            .map_err(|error| error.at_line(line, 1))?;
        for (name, _) in &cells {
            if known.insert(name.clone()) {
                names.push(name.clone());
            }
        }
        rows.push(cells);
    }
    let mut flat = Flat::new(names.iter().cloned())?;
    for row in rows {
        let mut own: std::collections::HashMap<String, String> = row.into_iter().collect();
        flat.push(
            names
                .iter()
                .map(|name| own.remove(name).unwrap_or_default()),
        )?;
    }
    if let Some(how) = inside {
        flat.read_as(how);
    }
    Ok(flat.decoded())
}

/// The only list of objects in a file that is one object, with its name: what is beside it describes the recording.
fn list_inside(all: &Map<String, Value>) -> Option<(&String, &Vec<Value>)> {
    let mut lists = all.iter().filter_map(|(name, value)| {
        let list = value.as_array()?;
        (list.len() > 1 && list.iter().all(Value::is_object)).then_some((name, list))
    });
    match (lists.next(), lists.next()) {
        (only, None) => only,
        _ => None,
    }
}

/// The usual length of the columns of a file that is one object of lists, which at least two of them have; `None` for anything else.
fn columns_inside(all: &Map<String, Value>) -> Option<usize> {
    let mut lengths = std::collections::BTreeMap::new();
    for value in all.values() {
        count_lists(value, 0, &mut lengths);
    }
    let (length, lists) = lengths
        .into_iter()
        .max_by_key(|(length, lists)| (*lists, *length))?;
    (length > 1 && lists > 1).then_some(length)
}

/// Counts the lists of each length that are values of objects.
fn count_lists(
    value: &Value,
    depth: usize,
    lengths: &mut std::collections::BTreeMap<usize, usize>,
) {
    match value {
        Value::Array(list) => *lengths.entry(list.len()).or_default() += 1,
        Value::Object(map) if depth < DEEPEST => {
            for value in map.values() {
                count_lists(value, depth + 1, lengths);
            }
        }
        _ => {}
    }
}

/// The value of a column, or of an object of columns, in a sample; `None` for what has no value for each sample.
fn sample_of(column: &Value, index: usize, count: usize) -> Option<Value> {
    match column {
        Value::Array(list) if list.len() == count => list.get(index).cloned(),
        Value::Object(map) => {
            let inside = sample_of_all(map, index, count);
            (!inside.is_empty()).then_some(Value::Object(inside))
        }
        _ => None,
    }
}

/// The values of an object of columns in a sample.
fn sample_of_all(columns: &Map<String, Value>, index: usize, count: usize) -> Map<String, Value> {
    let all = columns.iter();
    all.filter_map(|(name, column)| Some((name.clone(), sample_of(column, index, count)?)))
        .collect()
}

fn broken(line: usize, error: &serde_json::Error) -> Error {
    Error::invalid("this is no JSON")
        .at_line(line.max(1), error.column().max(1))
        .found(error)
        .allowed("one JSON object on each line, an array of objects, or one object of lists")
}

fn object(line: usize, value: Value) -> Result<Map<String, Value>> {
    match value {
        Value::Object(map) => Ok(map),
        other => Err(Error::invalid("a sample is no JSON object")
            .at_line(line, 1)
            .found(excerpt(&other.to_string()))
            .allowed("an object such as {\"t_s\": 0.0, \"x_m\": 0.1, \"y_m\": 0.2}")),
    }
}

/// Adds the cells of a value with their names.
pub(super) fn flatten(
    name: &str,
    value: Value,
    depth: usize,
    cells: &mut Vec<(String, String)>,
) -> Result<()> {
    if depth > DEEPEST {
        return Err(Error::invalid("the objects are nested too deeply")
            .field(name)
            .allowed(format!("at most {DEEPEST} levels")));
    }
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let name = match name {
                    "" => key,
                    name => format!("{name}.{key}"),
                };
                flatten(&name, value, depth + 1, cells)?;
            }
        }
        Value::Array(list) => {
            let are_numbers = list
                .iter()
                .all(|value| value.is_number() || value.is_null());
            let last = name.rsplit(['.', '_']).next().unwrap_or_default();
            if are_numbers && list.len() == AXES.len() && PLACES.contains(&last) {
                let axes = AXES.iter().zip(list);
                cells.extend(axes.map(|(axis, value)| (format!("{name}.{axis}"), cell(&value))));
            } else if are_numbers {
                let numbers: Vec<String> = list.iter().map(cell).collect();
                cells.push((name.to_owned(), format!("[{}]", numbers.join(" "))));
            } else {
                for (index, value) in list.into_iter().enumerate() {
                    flatten(&format!("{name}.{index}"), value, depth + 1, cells)?;
                }
            }
        }
        other => cells.push((name.to_owned(), cell(&other))),
    }
    Ok(())
}

pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::Bool(is) => u8::from(*is).to_string(),
        Value::String(text) => super::flat::plain(text),
        other => other.to_string(),
    }
}
