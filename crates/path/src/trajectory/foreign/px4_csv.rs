//! CSV files that `ulog2csv` writes of a vehicle's path: north, east, down, as in the log itself, which no name in them says.

use super::ForeignTable;
use super::flat::{Flat, names_and_rows};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, excerpt, first_line};
use realgap_core::error::{Error, Result};

/// The topic `vehicle_local_position` of PX4 as a table.
pub const PX4_CSV: ForeignTable = ForeignTable {
    name: "px4-csv",
    doc: "CSV files that ulog2csv writes of vehicle_local_position: turned from north, east, down to z up",
    extensions: &["csv"],
    recognises: |bytes| {
        let line = first_line(bytes);
        line.starts_with("timestamp,") && line.contains(",xy_valid,") && line.contains(",z_deriv,")
    },
    table: |bytes, _| table(bytes),
    beside: None,
};

/// The columns that are read, with the sign that turns each.
const KEPT: [(&str, &str, f64); 4] = [
    ("x", "x_m", 1.0),
    ("y", "y_m", -1.0),
    ("z", "z_m", -1.0),
    ("heading", "heading", -1.0),
];

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let (header, rows) = names_and_rows(&text)?;
    let kept: Vec<(usize, &str, f64)> = (KEPT.iter())
        .filter_map(|(theirs, ours, sign)| {
            let at = header.iter().position(|name| name == theirs)?;
            Some((at, *ours, *sign))
        })
        .collect();
    let names = kept.iter().map(|(_, name, _)| (*name).to_owned());
    let mut flat = Flat::new(std::iter::once("t_us".to_owned()).chain(names))?;
    for row in rows {
        let (number, row) = row?;
        let mut own = vec![row.first().copied().unwrap_or_default().to_owned()];
        for (at, name, sign) in &kept {
            let cell = row.get(*at).copied().unwrap_or_default();
            own.push(match cell.parse::<f64>() {
                Ok(value) => (sign * value).to_string(),
                Err(_) if cell.is_empty() => String::new(),
                Err(_) => {
                    return Err(Error::invalid("not a number")
                        .at_line(number, 1)
                        .field(*name)
                        .found(excerpt(cell)));
                }
            });
        }
        flat.push(own)?;
    }
    flat.read_as(
        "a path of PX4: its axes north, east, down are turned to x north, y west, z up; other columns than the place and the heading are not read",
    );
    Ok(flat.decoded())
}
