//! Tables that PlotJuggler exports: one column for each number of each topic, and a row for each time at which any of them came, so that
//! most cells are empty.

use super::super::relabel::split;
use super::ForeignTable;
use super::flat::Flat;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, first_line};
use realgap_core::error::Result;
use realgap_core::unit::counted;

/// CSV files whose first column is `__time`. Commands are held until the next one; rows with nothing but commands are left out.
pub const PLOTJUGGLER: ForeignTable = ForeignTable {
    name: "plotjuggler",
    doc: "CSV exports of PlotJuggler: the topics of a log in one table; commands are held until the next one",
    extensions: &["csv"],
    recognises: |bytes| {
        let line = first_line(bytes).trim_start_matches('"');
        line.starts_with(TIME) && line[TIME.len()..].starts_with([',', '"'])
    },
    table: |bytes, _| table(bytes),
    beside: None,
};

const TIME: &str = "__time";
/// Words in the names of commands.
const COMMANDS: [&str; 9] = [
    "cmd",
    "command",
    "commands",
    "goal",
    "target",
    "setpoint",
    "desired",
    "reference",
    "action",
];

fn is_command(name: &str) -> bool {
    let lower = name.to_lowercase();
    let mut words = lower.split(|c: char| !c.is_ascii_alphanumeric());
    words.any(|word| COMMANDS.contains(&word))
}

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let header = split(lines.next().unwrap_or_default(), ',');
    let names: Vec<&str> = header.iter().map(|name| name.trim_matches('"')).collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| split(line, ',')).collect();
    let commands: Vec<usize> = (1..names.len())
        .filter(|index| is_command(names[*index]))
        .collect();
    let is_there = |row: &[&str], index: usize| row.get(index).is_some_and(|cell| !cell.is_empty());
    let is_sparse = |index: &usize| !rows.iter().all(|row| is_there(row, *index));
    let are_held = commands.iter().any(is_sparse);
    if !are_held {
        return Ok(Decoded::from(text));
    }
    let mut flat = Flat::new(names.iter().map(|name| (*name).to_owned()))?;
    let mut last = vec![""; names.len()];
    let (mut before, mut alone) = (0, 0);
    // A command that never comes is not waited for.
    let awaited: Vec<usize> = commands
        .iter()
        .copied()
        .filter(|index| rows.iter().any(|row| is_there(row, *index)))
        .collect();
    for row in &rows {
        let mut own = row.clone();
        for index in &commands {
            if is_there(row, *index) {
                last[*index] = row[*index];
            } else if let Some(cell) = own.get_mut(*index) {
                *cell = last[*index];
            }
        }
        let is_alone = (1..names.len()).all(|i| commands.contains(&i) || !is_there(row, i));
        if is_alone {
            alone += 1;
        } else if awaited.iter().any(|index| last[*index].is_empty()) {
            before += 1;
        } else {
            flat.push(own)?;
        }
    }
    let held: Vec<&str> = commands.iter().map(|index| names[*index]).collect();
    flat.read_as(format!(
        "each command is held until the next one ({}); {} with commands alone, and {} before the first command, are left out",
        held.join(", "),
        counted(alone, "row"),
        before
    ));
    Ok(flat.decoded())
}
