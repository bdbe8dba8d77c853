//! Tables of programs for drones whose axes point north, east and down, which no name in them says: AirSim, QGroundControl, and the log of
//! ArduPilot that `mavlogdump.py` writes. They are turned to x north, y west, z up.

use super::ForeignTable;
use super::flat::{Flat, cells, plain};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, excerpt, first_line};
use realgap_core::error::{Error, Result};

/// Tables of AirSim, QGroundControl and ArduPilot.
pub const NORTH_EAST_DOWN: ForeignTable = ForeignTable {
    name: "north-east-down",
    doc: "recordings of AirSim, telemetry of QGroundControl and positions of ArduPilot: turned from north, east, down to z up",
    extensions: &["csv", "txt", "tsv"],
    recognises: |bytes| Program::of(first_line(bytes)).is_some(),
    table: |bytes, _| table(bytes),
    beside: None,
};

/// A program, and what its columns are called.
struct Program {
    name: &'static str,
    separator: Separator,
    /// The columns that are read, with their names here and the sign that turns each; 0 for a cell that is kept as it is.
    columns: &'static [(&'static str, &'static str, f64)],
    /// How many of these columns a header must have.
    needed: usize,
}

const PROGRAMS: [Program; 3] = [
    // https://microsoft.github.io/AirSim/settings/#recording
    Program {
        name: "AirSim",
        separator: Separator::Tab,
        columns: &[
            ("TimeStamp", "t_ms", 0.0),
            ("POS_X", "x_m", 1.0),
            ("POS_Y", "y_m", -1.0),
            ("POS_Z", "z_m", -1.0),
            ("Q_W", "qw", 1.0),
            ("Q_X", "qx", 1.0),
            ("Q_Y", "qy", -1.0),
            ("Q_Z", "qz", -1.0),
            ("VehicleName", "robot", 0.0),
        ],
        needed: 9,
    },
    // Facts of the vehicle by their names; the local position is that of MAVLink.
    Program {
        name: "QGroundControl",
        separator: Separator::Comma,
        columns: &[
            ("Timestamp", "time", 0.0),
            ("localPosition.x", "x_m", 1.0),
            ("localPosition.y", "y_m", -1.0),
            ("localPosition.z", "z_m", -1.0),
        ],
        needed: 4,
    },
    Program {
        name: "ArduPilot",
        separator: Separator::Comma,
        columns: &[
            ("timestamp", "t_s", 0.0),
            ("PN", "x_m", 1.0),
            ("PE", "y_m", -1.0),
            ("PD", "z_m", -1.0),
        ],
        needed: 4,
    },
];

impl Program {
    fn of(header: &str) -> Option<&'static Self> {
        PROGRAMS.iter().find(|program| {
            let names = cells(header, 1, program.separator).unwrap_or_default();
            let is_there = |(theirs, ..): &&(&str, &str, f64)| names.contains(theirs);
            program.columns.iter().filter(is_there).count() == program.needed
        })
    }
}

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let names = first_line(text.as_bytes());
    let Some(program) = Program::of(names) else {
        return Ok(Decoded::from(text));
    };
    let header = cells(names, 1, program.separator)?;
    let kept: Vec<(usize, &str, f64)> = (program.columns.iter())
        .filter_map(|(theirs, ours, sign)| {
            let at = header.iter().position(|name| name == theirs)?;
            Some((at, *ours, *sign))
        })
        .collect();
    let mut flat = Flat::new(kept.iter().map(|(_, name, _)| (*name).to_owned()))?;
    // A recording that goes on after a stop has its names again.
    let rows = text.lines().enumerate();
    let rows = rows.filter(|(_, line)| !line.trim().is_empty() && line.trim() != names);
    for (index, line) in rows {
        let row = cells(line, index + 1, program.separator)?;
        let turned = kept.iter().map(|(at, name, sign)| {
            let cell = row.get(*at).copied().unwrap_or_default();
            match cell.parse::<f64>() {
                _ if *sign == 0.0 => Ok(plain(cell)),
                Ok(value) => Ok((sign * value).to_string()),
                Err(_) if cell.is_empty() => Ok(String::new()),
                Err(_) => Err(Error::invalid("not a number")
                    .at_line(index + 1, 1)
                    .field(*name)
                    .found(excerpt(cell))),
            }
        });
        flat.push(turned.collect::<Result<Vec<_>>>()?)?;
    }
    flat.read_as(format!(
        "a file of {}: its axes north, east, down are turned to x north, y west, z up, and its lengths are metres; other columns are not read",
        program.name
    ));
    Ok(flat.decoded())
}
