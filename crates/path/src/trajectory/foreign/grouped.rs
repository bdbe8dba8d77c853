//! Tables whose line of names is an outline: the name of a part stands above no numbers, before the names of its own parts.
//!
//! Scripts that write bags of ROS as CSV make them: `pose,pose,position,x,y,z,orientation,x,y,z,w`.

use std::collections::HashSet;

use super::ForeignTable;
use super::flat::{Flat, names_and_rows, plain};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, first_line};
use realgap_core::error::Result;

/// CSV files in which `x`, `y` and `z` occur several times, each behind the name of what they belong to.
pub const GROUPED: ForeignTable = ForeignTable {
    name: "grouped-names",
    doc: "CSV files whose names are an outline: position,x,y,z,orientation,x,y,z,w",
    extensions: &["csv"],
    recognises: |bytes| {
        let line = first_line(bytes).to_lowercase().replace(' ', "");
        line.contains(",position,x,y,z,orientation,x,y,z,w")
    },
    table: |bytes, _| table(bytes),
    beside: None,
};

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let (header, rows) = names_and_rows(&text)?;
    let rows = rows.map(|row| row.map(|(_, cells)| cells));
    let rows: Vec<Vec<&str>> = rows.collect::<Result<_>>()?;
    let is_empty = |at: usize| {
        let mut all = rows.iter();
        all.all(|row| row.get(at).is_none_or(|cell| cell.is_empty()))
    };
    let twice: HashSet<&str> = {
        let mut seen = HashSet::new();
        header
            .iter()
            .copied()
            .filter(|name| !seen.insert(*name))
            .collect()
    };
    let mut part = "";
    let mut kept = Vec::new();
    for (at, name) in header.iter().enumerate() {
        if is_empty(at) {
            part = name;
        } else if (twice.contains(name) || *name == "w") && !part.is_empty() {
            kept.push((at, format!("{}.{}", plain(part), plain(name))));
        } else {
            kept.push((at, plain(name)));
        }
    }
    let mut flat = Flat::new(kept.iter().map(|(_, name)| name.clone()))?;
    for row in &rows {
        flat.push(
            kept.iter()
                .map(|(at, _)| row.get(*at).copied().unwrap_or_default()),
        )?;
    }
    flat.read_as("names that occur several times belong to the part whose name stands before them");
    Ok(flat.decoded())
}
