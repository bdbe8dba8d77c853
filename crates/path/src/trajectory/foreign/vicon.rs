//! Exports of Vicon Nexus and Tracker: sections, each with a name, a rate, a line of bodies or markers, a line of axes and one of units.
//! Layout: <https://help.vicon.com/>, "Export ASCII".

use super::ForeignTable;
use super::flat::{Flat, broken, cells, plain};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, first_line};
use realgap_core::error::{Error, Result};

/// CSV files that Vicon Nexus and Tracker export. The first section with places is read: bodies (`Objects`, `Segments`) before markers
/// (`Trajectories`, `Markers`).
pub const VICON: ForeignTable = ForeignTable {
    name: "vicon",
    doc: "CSV exports of Vicon Nexus and Tracker: bodies or markers, with the units that the file states",
    extensions: &["csv"],
    recognises: |bytes| section(first_line(bytes)).is_some(),
    table: |bytes, _| table(bytes),
    beside: None,
};

const PROGRAM: &str = "Vicon";
/// Sections by their first lines; the first four hold places.
const SECTIONS: [&str; 9] = [
    "Objects",
    "Segments",
    "Trajectories",
    "Markers",
    "Devices",
    "Joints",
    "Model Outputs",
    "Events",
    "Global Angle",
];
const WITH_PLACES: usize = 4;

/// The section whose first line this is; Workstation and the first versions of Nexus wrote it in capitals.
fn section(line: &str) -> Option<&'static str> {
    let name = line.trim_end_matches([',', ' ', '\r']);
    let mut all = SECTIONS.into_iter();
    all.find(|known| *known == name || known.to_uppercase() == name)
}

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let lines: Vec<&str> = text.lines().collect();
    let name = |index: usize| section(lines[index]).unwrap_or_default();
    let starts: Vec<usize> = (0..lines.len())
        .filter(|index| section(lines[*index]).is_some())
        .collect();
    let with_places = SECTIONS[..WITH_PLACES].iter();
    let mut found = with_places.filter_map(|wanted| {
        let mut all = starts.iter().copied();
        all.find(|start| name(*start) == *wanted)
    });
    let Some(start) = found.next() else {
        let all: Vec<&str> = starts.iter().map(|start| name(*start)).collect();
        return Err(Error::invalid("this export of Vicon holds no places")
            .found(all.join(", "))
            .allowed(SECTIONS[..WITH_PLACES].join(", ")));
    };
    let end = starts
        .iter()
        .copied()
        .find(|other| *other > start)
        .unwrap_or(lines.len());
    if start + 5 > end {
        return Err(broken(PROGRAM, start + 1, "a section without rows"));
    }
    let row = |index: usize| cells(lines[index], index + 1, Separator::Comma);
    let rate_hz: Option<f64> = row(start + 1)?.first().and_then(|cell| cell.parse().ok());
    let rate_hz = rate_hz.filter(|rate_hz| *rate_hz > 0.0);
    let rate_hz = rate_hz.ok_or_else(|| broken(PROGRAM, start + 2, "no rate"))?;
    let (bodies, axes, units) = (row(start + 2)?, row(start + 3)?, row(start + 4)?);
    // Older exports number fields, which are frames, and have no line of units: theirs are millimetres.
    let is_old = axes.first() == Some(&"Field #");
    if !is_old && axes.first() != Some(&"Frame") {
        return Err(broken(PROGRAM, start + 4, "no line that begins with Frame"));
    }
    let has_units = units
        .first()
        .is_none_or(|cell| cell.parse::<f64>().is_err());
    // The name of a body stands above the first of its columns.
    let mut whose = String::new();
    let (mut kept, mut turns) = (Vec::new(), Vec::new());
    let has_w = axes.contains(&"RW");
    for (index, axis) in axes.iter().enumerate().skip(1) {
        if let Some(body) = bodies.get(index).filter(|body| !body.is_empty()) {
            whose = plain(body);
        }
        let unit = match has_units {
            true => units.get(index).copied().unwrap_or_default(),
            false if is_old => "mm",
            false => "",
        };
        let axis_name = match *axis {
            "X" | "Y" | "Z" => Some(*axis),
            "TX" => Some("X"),
            "TY" => Some("Y"),
            "TZ" => Some("Z"),
            _ => None,
        };
        if let Some(axis) = axis_name {
            let unit = if unit.is_empty() {
                String::new()
            } else {
                format!(" ({unit})")
            };
            kept.push((index, format!("{whose} {axis}{unit}")));
        } else if axis.len() == 2 && axis.starts_with('R') {
            match has_w {
                true => kept.push((index, format!("{whose} q{}", axis[1..].to_lowercase()))),
                false if !turns.contains(&whose) => turns.push(whose.clone()),
                false => {}
            }
        }
    }
    let names = kept.iter().map(|(_, name)| name.clone());
    let mut flat = Flat::new(std::iter::once("Time (s)".to_owned()).chain(names))?;
    flat.read_as(format!("times are frames at {rate_hz} samples per second"));
    if is_old && !has_units {
        flat.read_as(
            "lengths are in millimetres, as in every export of Vicon that states no units",
        );
    }
    if !turns.is_empty() {
        flat.not_read(format!(
            "rotations of {} are not read, because the file does not say whether they are Euler angles or a helical axis: export quaternions",
            turns.join(", ")
        ));
    }
    let others = starts.iter().filter(|other| **other != start);
    let others: Vec<&str> = others.map(|other| name(*other)).collect();
    if !others.is_empty() {
        flat.not_read(format!("sections that are not read: {}", others.join(", ")));
    }
    for index in start + 4 + usize::from(has_units)..end {
        let row = row(index)?;
        let Some(frame) = row.first().and_then(|cell| cell.parse::<f64>().ok()) else {
            continue;
        };
        let time_s = (frame / rate_hz).to_string();
        let cells = kept
            .iter()
            .map(|(at, _)| row.get(*at).copied().unwrap_or_default());
        flat.push(std::iter::once(time_s.as_str()).chain(cells))?;
    }
    Ok(flat.decoded())
}
