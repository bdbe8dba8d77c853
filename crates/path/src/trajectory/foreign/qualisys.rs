//! Exports of Qualisys Track Manager: lines of keys above rows of numbers, with or without a line of names.
//! Layout: <https://docs.qualisys.com/qtm/>, "TSV file formats".

use super::ForeignTable;
use super::flat::{Flat, broken, cells, plain};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, first_line};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use realgap_core::error::{Error, Result};

/// TSV files that Qualisys Track Manager exports: markers (3D) and rigid bodies (6D). Lengths are in millimetres; places of markers and bodies
/// that were lost are exact zeros there, and count as missing.
pub const QUALISYS: ForeignTable = ForeignTable {
    name: "qualisys",
    doc: "TSV exports of Qualisys Track Manager: markers and rigid bodies, mm",
    extensions: &["tsv"],
    recognises: |bytes| first_line(bytes).starts_with("NO_OF_FRAMES\t"),
    table: |bytes, _| table(bytes),
    beside: None,
};

const PROGRAM: &str = "Qualisys Track Manager";
/// Numbers of a body in a row: place, three angles, residual, and nine elements of a rotation.
const OF_BODY: usize = 16;

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut keys: Vec<Vec<&str>> = Vec::new();
    let mut rows: Vec<(usize, Vec<&str>)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let row = cells(line, index + 1, Separator::Tab)?;
        let is_number = |cell: &&str| cell.replacen(',', ".", 1).parse::<f64>().is_ok();
        if rows.is_empty() && !row.first().is_some_and(is_number) {
            keys.push(row);
        } else {
            rows.push((index + 1, row));
        }
    }
    let of = |wanted: &str| {
        let mut all = keys.iter();
        let found = all.find(|key| key.first() == Some(&wanted))?;
        Some(
            found[1..]
                .iter()
                .copied()
                .filter(|cell| !cell.is_empty())
                .collect::<Vec<_>>(),
        )
    };
    let rate_hz =
        of("FREQUENCY").and_then(|rest| rest.first()?.replacen(',', ".", 1).parse::<f64>().ok());
    let rate_hz = rate_hz.filter(|rate_hz| *rate_hz > 0.0);
    let rate_hz = rate_hz.ok_or_else(|| broken(PROGRAM, 1, "no FREQUENCY"))?;
    let (names, each) = match (of("MARKER_NAMES"), of("BODY_NAMES")) {
        (Some(names), _) => (names, 3),
        (None, Some(names)) => (names, OF_BODY),
        (None, None) => {
            let found = of("DATA_INCLUDED").map_or_else(String::new, |kinds| kinds.join(" "));
            return Err(
                Error::invalid("this export of Qualisys Track Manager holds no places")
                    .found(format!("DATA_INCLUDED {found}"))
                    .allowed("3D data of markers, or 6D data of bodies"),
            );
        }
    };
    let width = names.len() * each;
    let Some((_, first)) = rows.first() else {
        return Err(broken(PROGRAM, 1, "no rows of numbers"));
    };
    let before = trimmed(first)
        .checked_sub(width)
        .filter(|before| *before <= 2);
    let before = before.ok_or_else(|| {
        broken(
            PROGRAM,
            rows[0].0,
            format!("{} columns for {} names", trimmed(first), names.len()),
        )
    })?;
    let axes = ["X", "Y", "Z"];
    let turns = ["qw", "qx", "qy", "qz"];
    let columns = names.iter().flat_map(|name| {
        let name = plain(name);
        let places = axes.map(|axis| format!("{name} {axis} (mm)"));
        let turns = turns.iter().filter(|_| each == OF_BODY);
        let turns: Vec<String> = turns.map(|turn| format!("{name} {turn}")).collect();
        places.into_iter().chain(turns).collect::<Vec<_>>()
    });
    let mut flat = Flat::new(std::iter::once("Time (s)".to_owned()).chain(columns))?;
    flat.read_as(format!(
        "lengths are in millimetres, as Qualisys Track Manager exports them, and times are those of {rate_hz} samples per second; zeros count as lost"
    ));
    for (index, (line, row)) in rows.iter().enumerate() {
        if trimmed(row) < before + width {
            return Err(broken(PROGRAM, *line, format!("{} columns", row.len())));
        }
        let mut cells = vec![match before {
            2 => row[1].to_owned(),
            _ => (index as f64 / rate_hz).to_string(),
        }];
        for body in row[before..before + width].chunks(each) {
            let number = |index: usize| body[index].replacen(',', ".", 1).parse::<f64>().ok();
            let is_lost = (0..3).all(|axis| number(axis).is_none_or(|value| value == 0.0));
            let place = body[..3].iter().map(|cell| cell.replacen(',', ".", 1));
            cells.extend(place.map(|cell| if is_lost { String::new() } else { cell }));
            if each == OF_BODY {
                let elements: Option<Vec<f64>> = (OF_BODY - 9..OF_BODY).map(number).collect();
                cells.extend(turn(elements.filter(|_| !is_lost)));
            }
        }
        flat.push(cells)?;
    }
    Ok(flat.decoded())
}

/// The number of cells without empty ones at the end.
fn trimmed(row: &[&str]) -> usize {
    let last = row.iter().rposition(|cell| !cell.is_empty());
    last.map_or(0, |last| last + 1)
}

/// The quaternion of a rotation whose elements stand column by column.
fn turn(elements: Option<Vec<f64>>) -> [String; 4] {
    let Some(elements) = elements else {
        return Default::default();
    };
    let matrix = Matrix3::from_column_slice(&elements);
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix));
    [turn.w, turn.i, turn.j, turn.k].map(|value| value.to_string())
}
