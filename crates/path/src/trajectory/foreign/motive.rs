//! Exports of OptiTrack Motive: several lines of names above the numbers (types, bodies, identities, Rotation or Position, axes).
//! Layout: <https://docs.optitrack.com/motive/data-export/data-export-csv>.

use super::ForeignTable;
use super::flat::{Flat, broken, cells};
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, first_line};
use realgap_core::error::Result;
use realgap_core::unit::{LengthUnit, counted};
use realgap_core::warning::Code;

/// CSV files that OptiTrack Motive exports. Rigid bodies and bones are read; markers only where the file has no bodies.
pub const MOTIVE: ForeignTable = ForeignTable {
    name: "motive",
    doc: "CSV exports of OptiTrack Motive: bodies or markers, with the units that the file states",
    extensions: &["csv"],
    recognises: |bytes| first_line(bytes).starts_with("Format Version,"),
    table,
    beside: None,
};

const PROGRAM: &str = "Motive";

/// A column that is read: its place, and its name in the table.
struct Kept {
    at: usize,
    name: String,
}

fn table(bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let lines: Vec<&str> = text.lines().collect();
    let row = |index: usize| cells(lines[index], index + 1, Separator::Comma);
    let said = row(0)?;
    let of = |key: &str| {
        let at = said.iter().position(|cell| *cell == key)?;
        said.get(at + 1).copied()
    };
    let is_axes = |line: &&str| line.trim_start_matches('"').starts_with("Frame");
    let axes_at = lines.iter().take(20).position(is_axes);
    let axes_at = axes_at.ok_or_else(|| broken(PROGRAM, 1, "no line that begins with Frame"))?;
    let first = (1..axes_at).find(|index| !lines[*index].replace(',', "").trim().is_empty());
    let first = first.ok_or_else(|| broken(PROGRAM, axes_at + 1, "no lines of names above it"))?;
    if axes_at < first + 3 {
        return Err(broken(
            PROGRAM,
            axes_at + 1,
            "too few lines of names above it",
        ));
    }
    let (types, names) = (row(first)?, row(first + 1)?);
    let (parts, axes) = (row(axes_at - 1)?, row(axes_at)?);
    let at = |row: &[&str], index: usize| row.get(index).map_or(String::new(), |c| (*c).to_owned());
    let is_body = |kind: &str| matches!(kind, "Rigid Body" | "Bone");
    let has_bodies = types.iter().any(|kind| is_body(kind));
    let unit = match of("Length Units").map(|unit| LengthUnit::by_word(&unit.to_lowercase())) {
        Some(Some(unit)) => format!(" ({})", unit.symbol()),
        _ => String::new(),
    };
    let is_quaternion = of("Rotation Type").is_some_and(|kind| kind == "Quaternion");
    let time_at = axes
        .iter()
        .position(|cell| cell.starts_with("Time (Seconds)"));
    let time_at =
        time_at.ok_or_else(|| broken(PROGRAM, axes_at + 1, "no column Time (Seconds)"))?;
    let mut kept = vec![Kept {
        at: time_at,
        name: "Time (Seconds)".to_owned(),
    }];
    let (mut markers, mut turns) = (Vec::new(), Vec::new());
    for (index, axis) in axes.iter().enumerate() {
        let (kind, body, part) = (at(&types, index), at(&names, index), at(&parts, index));
        let is_axis = matches!(*axis, "X" | "Y" | "Z" | "W");
        if !is_axis || !matches!(part.as_str(), "Position" | "Rotation") {
            continue;
        }
        if has_bodies && !is_body(&kind) {
            if !markers.contains(&body) {
                markers.push(body);
            }
            continue;
        }
        let is_turn = part == "Rotation";
        if is_turn && !is_quaternion {
            if !turns.contains(&body) {
                turns.push(body);
            }
            continue;
        }
        let unit = if is_turn { "" } else { &unit };
        kept.push(Kept {
            at: index,
            name: format!("{body} {part} {axis}{unit}"),
        });
    }
    let mut flat = Flat::new(kept.iter().map(|column| column.name.clone()))?;
    if reading.axes.is_none() {
        flat.doubt(Code::UnknownAxes.warning(
            "an export of Motive does not say which of its axes points up, and in most of them it is y: they are read as x, y, z with z up",
        ));
    }
    if !markers.is_empty() {
        flat.not_read(format!(
            "the positions of {} are not read, because the file has bodies",
            counted(markers.len(), "marker")
        ));
    }
    if !turns.is_empty() {
        flat.not_read(format!(
            "rotations of {} are not read, because they are Euler angles ({}): export them as quaternions",
            turns.join(", "),
            of("Rotation Type").unwrap_or("type not stated")
        ));
    }
    for (index, line) in lines.iter().enumerate().skip(axes_at + 1) {
        if line.trim().is_empty() {
            continue;
        }
        let row = row(index)?;
        flat.push(
            kept.iter()
                .map(|column| row.get(column.at).copied().unwrap_or_default()),
        )?;
    }
    Ok(flat.decoded())
}
