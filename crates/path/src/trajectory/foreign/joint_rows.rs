//! Tables of joints whose names stand in cells: a row for each joint at each time, or the columns `field.name0` beside `field.position0`
//! that `rostopic echo -p` writes.

use std::collections::HashMap;

use super::ForeignTable;
use super::flat::{Flat, cells, names_and_rows, plain};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, first_line};
use realgap_core::error::{Error, Result};
use realgap_core::unit::counted;

/// Tables with a row for each joint (`time,name,position,velocity,effort`).
pub const JOINT_ROWS: ForeignTable = ForeignTable {
    name: "joint-rows",
    doc: "CSV files with a row for each joint at each time, whose column `name` says which",
    extensions: &["csv", "tsv"],
    recognises: |bytes| Rows::of(first_line(bytes)).is_some(),
    table: |bytes, _| rows(bytes),
    beside: None,
};

/// Tables of `rostopic echo -p` with the names of joints in cells.
pub const NAMED_FIELDS: ForeignTable = ForeignTable {
    name: "rostopic-joints",
    doc: "CSV files of `rostopic echo -p` with joints, whose names stand in the cells of `field.name0`, ...",
    extensions: &["csv"],
    recognises: |bytes| {
        let line = first_line(bytes);
        line.starts_with("%time,") && line.contains(",field.name0,")
    },
    table: |bytes, _| fields(bytes),
    beside: None,
};

/// Quantities of a joint in ROS, each with the unit that its column gets.
pub(super) const QUANTITIES: [(&str, &str); 3] = [
    ("position", "rad"),
    ("velocity", "rad_s"),
    ("effort", "effort_nm"),
];

/// The columns of a table with a row for each joint.
struct Rows {
    separator: Separator,
    time: usize,
    name: usize,
    /// Quantities with their columns.
    quantities: Vec<(&'static str, usize)>,
}

impl Rows {
    fn of(header: &str) -> Option<Self> {
        let separator = Separator::of_header(header);
        let names = cells(header, 1, separator).ok()?;
        let names: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
        let at = |wanted: &[&str]| {
            names
                .iter()
                .position(|name| wanted.contains(&name.as_str()))
        };
        let quantities: Vec<(&str, usize)> = (QUANTITIES.iter())
            .filter_map(|(quantity, _)| Some((*quantity, at(&[quantity])?)))
            .collect();
        let has_place = quantities
            .first()
            .is_some_and(|(name, _)| *name == "position");
        let found = Self {
            separator,
            time: at(&["t", "time", "timestamp", "stamp", "t_s", "time_s"])?,
            name: at(&["name", "joint", "joint_name", "names"])?,
            quantities,
        };
        has_place.then_some(found)
    }
}

fn rows(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut lines = text.lines().enumerate();
    let header = lines.next().map_or("", |(_, line)| line);
    let Some(columns) = Rows::of(header) else {
        return Ok(Decoded::from(text));
    };
    // The joints, and the cells of each time, in the order in which they come first.
    let mut joints: Vec<String> = Vec::new();
    let mut times: Vec<(&str, HashMap<String, Vec<&str>>)> = Vec::new();
    for (index, line) in lines {
        if line.trim().is_empty() {
            continue;
        }
        let row = cells(line, index + 1, columns.separator)?;
        let cell = |at: usize| row.get(at).copied().unwrap_or_default();
        let joint = plain(cell(columns.name));
        // A list of names in one cell is a row for all joints.
        if joint.is_empty() || joint.contains(['[', '(']) || joint.parse::<f64>().is_ok() {
            return Ok(Decoded::from(text));
        }
        let time = cell(columns.time);
        let is_new = times
            .last()
            .is_none_or(|(last, own)| *last != time || own.contains_key(&joint));
        if is_new {
            times.push((time, HashMap::new()));
        }
        if !joints.contains(&joint) {
            joints.push(joint.clone());
        }
        let values = columns.quantities.iter().map(|(_, at)| cell(*at)).collect();
        if let Some((_, own)) = times.last_mut() {
            own.insert(joint, values);
        }
    }
    if joints.len() < 2 || times.len() < 2 {
        return Ok(Decoded::from(text));
    }
    let time = cells(header, 1, columns.separator)?[columns.time];
    let names = columns.quantities.iter().flat_map(|(quantity, _)| {
        let unit = unit(quantity);
        joints.iter().map(move |joint| format!("{joint}_{unit}"))
    });
    let mut flat = Flat::new(std::iter::once(time.to_owned()).chain(names))?;
    let mut lost = 0;
    for (time, own) in &times {
        lost += usize::from(own.len() != joints.len());
        let values = (0..columns.quantities.len()).flat_map(|quantity| {
            joints.iter().map(move |joint| {
                let values = own.get(joint);
                values
                    .and_then(|values| values.get(quantity))
                    .copied()
                    .unwrap_or_default()
            })
        });
        flat.push(std::iter::once(*time).chain(values))?;
    }
    let listed: Vec<&str> = joints.iter().map(String::as_str).take(16).collect();
    flat.read_as(format!(
        "the table has a row for each of {} at each time ({}); positions are taken for radians, as ROS defines them",
        counted(joints.len(), "joint"),
        listed.join(", ")
    ));
    if lost > 0 {
        flat.read_as(format!(
            "{} of {} without every joint",
            counted(lost, "time"),
            times.len()
        ));
    }
    Ok(flat.decoded())
}

fn unit(quantity: &str) -> &'static str {
    let mut all = QUANTITIES.iter();
    all.find(|(name, _)| *name == quantity)
        .map_or("", |(_, unit)| *unit)
}

fn fields(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let (header, rows) = names_and_rows(&text)?;
    let place = |name: String| header.iter().position(|cell| *cell == name);
    let named: Vec<usize> = (0..)
        .map_while(|k| place(format!("field.name{k}")))
        .collect();
    let mut joints: Vec<String> = Vec::new();
    let mut names: Vec<String> = header.iter().map(|name| (*name).to_owned()).collect();
    let mut flat = None;
    for row in rows {
        let (number, row) = row?;
        let own = named
            .iter()
            .map(|at| plain(row.get(*at).copied().unwrap_or_default()));
        let own: Vec<String> = own.collect();
        let flat = match &mut flat {
            Some(flat) => flat,
            None => {
                joints.clone_from(&own);
                for (number, joint) in joints.iter().enumerate() {
                    for (quantity, unit) in QUANTITIES {
                        if let Some(at) = place(format!("field.{quantity}{number}")) {
                            names[at] = format!("{joint}_{unit}");
                        }
                    }
                }
                let kept = (0..names.len()).filter(|at| !named.contains(at));
                flat.insert(Flat::new(kept.map(|at| names[at].clone()))?)
            }
        };
        if own != joints {
            return Err(Error::invalid("the joints change their order")
                .at_line(number, 1)
                .found(own.join(", "))
                .allowed(joints.join(", "))
                .hint("read the bag itself: rosbags-convert --src FILE.bag --dst FOLDER"));
        }
        let kept = row.iter().enumerate().filter(|(at, _)| !named.contains(at));
        flat.push(kept.map(|(_, cell)| *cell))?;
    }
    let Some(mut flat) = flat else {
        return Ok(Decoded::from(text));
    };
    flat.read_as(format!(
        "joints have the names in the cells of field.name0, ...: {}; positions are radians, as ROS defines them",
        joints.join(", ")
    ));
    Ok(flat.decoded())
}
