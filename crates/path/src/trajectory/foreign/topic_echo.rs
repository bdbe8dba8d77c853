//! What `ros2 topic echo` and `rostopic echo` print: one message after another, as indented text with a line `---` behind each.
//!
//! People write it into a file with any ending (`ros2 topic echo /odom > odom.csv`). Only this subset of YAML is read: maps, lists, numbers
//! and texts.

use serde_json::{Map, Value};

use super::ForeignTable;
use super::flat::{Flat, plain};
use super::joint_rows::QUANTITIES;
use super::json_lines::{cell, flatten};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, excerpt};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;

/// Texts of messages with a header: joints by their names, one pose, or any other numbers.
pub const TOPIC_ECHO: ForeignTable = ForeignTable {
    name: "topic-echo",
    doc: "what `ros2 topic echo` or `rostopic echo` prints of messages with a header: joints, a pose, or other numbers",
    extensions: &["yaml", "yml", "csv", "txt"],
    recognises,
    table: |bytes, _| table(bytes),
    beside: None,
};

/// The first bytes in which the end of the first message is looked for.
const LOOKED_AT: usize = 100_000;
const DEEPEST: usize = 20;
const END: &str = "---";

fn recognises(bytes: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOKED_AT)]);
    let mut lines = start.lines().map(str::trim_end);
    let first = lines.find(|line| !line.is_empty() && *line != END);
    let is_key = first.is_some_and(|line| {
        let key = line.split(':').next().unwrap_or_default();
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        !key.is_empty() && key.len() < line.len() && key.chars().all(is_name)
    });
    is_key && start.lines().any(|line| line.trim_end() == END)
}

/// A line that is not blank: its number, the spaces before it, its text.
struct Line<'a> {
    number: usize,
    indent: usize,
    text: &'a str,
}

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut messages: Vec<(usize, Map<String, Value>)> = Vec::new();
    let mut lines: Vec<Line<'_>> = Vec::new();
    let mut end = |lines: &mut Vec<Line<'_>>| -> Result<()> {
        if let Some(first) = lines.first() {
            let number = first.number;
            if let Value::Object(message) = block(lines, &mut 0, 0)? {
                messages.push((number, message));
            }
        }
        lines.clear();
        Ok(())
    };
    for (index, line) in text.lines().enumerate() {
        let content = line.trim_end();
        let text = content.trim_start();
        if content == END {
            end(&mut lines)?;
        } else if !text.is_empty() && !text.starts_with('#') {
            let indent = content.len() - text.len();
            lines.push(Line {
                number: index + 1,
                indent,
                text,
            });
        }
    }
    // The last message may be cut off, as by Ctrl-C.
    let left = counted(lines.len(), "line");
    let mut decoded = written(&messages)?;
    if !lines.is_empty() {
        decoded.read_as(format!(
            "{left} behind the last `{END}` are left out: that message may not be whole"
        ));
    }
    Ok(decoded.decoded())
}

/// The table of these messages.
fn written(messages: &[(usize, Map<String, Value>)]) -> Result<Flat> {
    let rows = messages.iter().map(|(line, message)| {
        let mut cells = vec![("t_s".to_owned(), stamp(message, *line)?)];
        match (joints(message, *line)?, pose(message)) {
            (Some(joints), _) => cells.extend(joints),
            (None, Some(pose)) => cells.extend(pose),
            (None, None) => {
                let mut rest = message.clone();
                rest.remove("header");
                flatten("", Value::Object(rest), 0, &mut cells)?;
            }
        }
        Ok((*line, cells))
    });
    let rows: Vec<(usize, Vec<(String, String)>)> = rows.collect::<Result<_>>()?;
    let Some((_, first)) = rows.first() else {
        return Err(Error::invalid("there is no whole message")
            .allowed("messages as `ros2 topic echo` prints them, with a line --- behind each"));
    };
    let names: Vec<String> = first.iter().map(|(name, _)| name.clone()).collect();
    let mut flat = Flat::new(names.iter().cloned())?;
    for (line, row) in &rows {
        if !row.iter().map(|(name, _)| name).eq(&names) {
            return Err(Error::invalid("the messages have different parts")
                .at_line(*line, 1)
                .allowed("messages of one topic, with the same joints in the same order")
                .hint("record a bag instead: ros2 bag record TOPIC"));
        }
        flat.push(row.iter().map(|(_, cell)| cell))?;
    }
    flat.read_as(
        "text of `topic echo`: times are those of the headers, lengths metres and angles radians, as ROS defines them; poses and joints only",
    );
    Ok(flat)
}

/// The time in a message's header, seconds with all its digits.
fn stamp(message: &Map<String, Value>, line: usize) -> Result<String> {
    let stamp = message.get("header").and_then(|header| header.get("stamp"));
    let number = |names: [&str; 2]| {
        let found = names
            .iter()
            .find_map(|name| stamp.and_then(|stamp| stamp.get(*name)));
        found.and_then(Value::as_u64)
    };
    let seconds = number(["sec", "secs"]);
    let nanoseconds = number(["nanosec", "nsecs"]).filter(|nanos| *nanos < 1_000_000_000);
    match (seconds, nanoseconds) {
        (Some(seconds), Some(nanoseconds)) => Ok(format!("{seconds}.{nanoseconds:09}")),
        _ => Err(Error::invalid("a message without a time")
            .at_line(line, 1)
            .found("no header with a stamp of seconds and nanoseconds")
            .hint("record a bag, which holds the times of recording: ros2 bag record TOPIC")),
    }
}

/// The joints of a message that names them.
fn joints(message: &Map<String, Value>, line: usize) -> Result<Option<Vec<(String, String)>>> {
    let list = |name: &str| match message.get(name) {
        Some(Value::Array(list)) => list.as_slice(),
        _ => &[],
    };
    let names = list("name");
    if names.is_empty() {
        return Ok(None);
    }
    let mut cells = Vec::new();
    for (quantity, unit) in QUANTITIES {
        let values = list(quantity);
        if values.is_empty() {
            continue;
        }
        if values.len() != names.len() {
            return Err(Error::invalid("a list has another length than the names")
                .at_line(line, 1)
                .field(quantity)
                .found(counted(values.len(), "number"))
                .allowed(counted(names.len(), "number"))
                .hint("lists that are shortened cannot be read: record a bag, which never shortens them"));
        }
        let of = names.iter().zip(values);
        cells.extend(of.map(|(name, value)| {
            let name = plain(name.as_str().unwrap_or_default());
            (format!("{name}_{unit}"), cell(value))
        }));
    }
    Ok(Some(cells))
}

/// The only pose in a message, at most three levels deep.
fn pose(message: &Map<String, Value>) -> Option<Vec<(String, String)>> {
    let mut level: Vec<&Map<String, Value>> = vec![message];
    for _ in 0..3 {
        let inner: Vec<&Map<String, Value>> = (level.iter())
            .flat_map(|map| map.values())
            .filter_map(Value::as_object)
            .collect();
        let is_pose = |map: &&&Map<String, Value>| {
            map.contains_key("position") && map.contains_key("orientation")
        };
        let mut poses = inner.iter().filter(is_pose);
        if let Some(pose) = poses.next() {
            if poses.next().is_some() {
                return None;
            }
            let part = |group: &str, axis: &str| Some(cell(pose.get(group)?.get(axis)?));
            let place = ["x", "y", "z"].map(|axis| (format!("{axis}_m"), part("position", axis)));
            let turn =
                ["w", "x", "y", "z"].map(|axis| (format!("q{axis}"), part("orientation", axis)));
            let all = place.into_iter().chain(turn);
            return all.map(|(name, value)| Some((name, value?))).collect();
        }
        level = inner;
    }
    None
}

fn broken(line: &Line<'_>, what: &str) -> Error {
    Error::invalid(what)
        .at_line(line.number, line.indent + 1)
        .found(excerpt(line.text))
        .allowed("messages as `ros2 topic echo` prints them")
}

/// The value of the lines that begin at this column or further to the right.
fn block(lines: &[Line<'_>], at: &mut usize, depth: usize) -> Result<Value> {
    let first = &lines[*at];
    if depth > DEEPEST {
        return Err(broken(first, "the message is nested too deeply"));
    }
    let indent = first.indent;
    if is_item(first) {
        let mut list = Vec::new();
        while let Some(line) = lines.get(*at)
            && line.indent == indent
            && is_item(line)
        {
            let content = line.text[1..].trim_start();
            *at += 1;
            let is_nested = lines.get(*at).is_some_and(|next| next.indent > indent);
            list.push(match (content.is_empty(), is_nested) {
                (true, true) => block(lines, at, depth + 1)?,
                // A map inside of a list begins on the line of its dash.
                _ if entry(content).is_some() => {
                    let indent = line.indent + line.text.len() - content.len();
                    let mut inner = vec![Line {
                        number: line.number,
                        indent,
                        text: content,
                    }];
                    while let Some(next) = lines.get(*at)
                        && next.indent >= indent
                    {
                        inner.push(Line {
                            number: next.number,
                            ..*next
                        });
                        *at += 1;
                    }
                    block(&inner, &mut 0, depth + 1)?
                }
                _ => scalar(content),
            });
        }
        return Ok(Value::Array(list));
    }
    let mut map = Map::new();
    while let Some(line) = lines.get(*at)
        && line.indent == indent
        && !is_item(line)
    {
        let Some((key, rest)) = entry(line.text) else {
            return Err(broken(line, "a line that is no `name: value`"));
        };
        *at += 1;
        let below = lines
            .get(*at)
            .filter(|next| next.indent > indent || (next.indent == indent && is_item(next)));
        let value = match (rest.is_empty(), below) {
            (true, Some(_)) => block(lines, at, depth + 1)?,
            _ => scalar(rest),
        };
        map.insert(key.to_owned(), value);
    }
    match lines.get(*at) {
        Some(line) if line.indent > indent => {
            Err(broken(line, "a line that is moved to the right"))
        }
        _ => Ok(Value::Object(map)),
    }
}

fn is_item(line: &Line<'_>) -> bool {
    line.text == "-" || line.text.starts_with("- ")
}

/// The name and the value in `name: value`.
fn entry(text: &str) -> Option<(&str, &str)> {
    let (key, rest) = text.split_once(':')?;
    let is_name = |c: char| c.is_ascii_alphanumeric() || "_./".contains(c);
    let is_entry = rest.is_empty() || rest.starts_with(' ');
    (is_entry && !key.is_empty() && key.chars().all(is_name)).then_some((key, rest.trim()))
}

fn scalar(text: &str) -> Value {
    if let Some(list) = text.strip_prefix('[').and_then(|t| t.strip_suffix(']')) {
        let parts = list.split(',').map(str::trim);
        return Value::Array(parts.filter(|part| !part.is_empty()).map(scalar).collect());
    }
    if let Ok(number) = serde_json::from_str::<serde_json::Number>(text) {
        return Value::Number(number);
    }
    match text {
        "" | "null" | "nan" | ".nan" | "inf" | ".inf" | "-inf" | "-.inf" => Value::Null,
        "true" | "True" => Value::Bool(true),
        "false" | "False" => Value::Bool(false),
        text => Value::String(text.trim_matches(['\'', '"']).to_owned()),
    }
}
