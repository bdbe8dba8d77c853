//! Tables of OpenSim: coordinates and states (`.mot`, `.sto`) below a line `endheader`, and markers (`.trc`).
//! Layout: <https://simtk-confluence.stanford.edu/display/OpenSim/Preparing+Your+Data>.

use super::ForeignTable;
use super::flat::{Flat, broken, cells, plain};
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text};
use realgap_core::error::Result;
use realgap_core::unit::LengthUnit;
use realgap_core::warning::Code;

/// Coordinates, speeds and states of OpenSim.
pub const OPENSIM: ForeignTable = ForeignTable {
    name: "opensim",
    doc: "tables of OpenSim: coordinates and states, whose angles are in degrees or radians as the file states",
    extensions: &["mot", "sto"],
    recognises: |bytes| String::from_utf8_lossy(bytes).contains(END),
    table: |bytes, _| motion(bytes),
    beside: None,
};

/// Markers of OpenSim.
pub const TRC: ForeignTable = ForeignTable {
    name: "trc",
    doc: "markers as OpenSim and Motion Analysis write them, with the unit that the file states",
    extensions: &["trc"],
    recognises: |bytes| bytes.starts_with(b"PathFileType"),
    table: markers,
    beside: None,
};

const PROGRAM: &str = "OpenSim";
/// The line above the names.
const END: &str = "endheader";

/// What a column holds, by the title of the file or by its own name.
enum Quantity {
    Angle,
    Speed,
    /// A length of a slide, as the names of coordinates end by custom.
    Slide,
    Other,
}

/// The name of a coordinate, without the path in which the states of a model have it, and what its column holds.
fn coordinate<'a>(name: &'a str, title: &str) -> (&'a str, Quantity) {
    let parts: Vec<&str> = name.split('/').collect();
    let is_slide = |name: &str| ["_tx", "_ty", "_tz"].iter().any(|end| name.ends_with(end));
    let (bare, quantity) = match parts.as_slice() {
        [.., coordinate, "value"] => (*coordinate, Quantity::Angle),
        [.., coordinate, "speed"] => (*coordinate, Quantity::Speed),
        _ if title.eq_ignore_ascii_case("Coordinates") => (name, Quantity::Angle),
        _ if title.eq_ignore_ascii_case("Speeds") => (name, Quantity::Speed),
        _ => (name, Quantity::Other),
    };
    match quantity {
        Quantity::Angle | Quantity::Speed if is_slide(bare) => (bare, Quantity::Slide),
        quantity => (bare, quantity),
    }
}

fn motion(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let mut lines = text.lines().enumerate();
    let title = lines.next().map_or("", |(_, line)| line.trim());
    let mut angle = None;
    for (_, line) in lines.by_ref() {
        let line = line.trim();
        if line.eq_ignore_ascii_case(END) {
            break;
        }
        if let Some((key, value)) = line.split_once('=')
            && key.trim().eq_ignore_ascii_case("inDegrees")
        {
            angle = match value.trim().to_ascii_lowercase().as_str() {
                "yes" => Some("deg"),
                "no" => Some("rad"),
                _ => None,
            };
        }
    }
    let mut rows = lines.filter(|(_, line)| !line.trim().is_empty());
    let Some((index, names)) = rows.next() else {
        return Err(broken(PROGRAM, 1, format!("nothing below `{END}`")));
    };
    let names = cells(names, index + 1, Separator::of_header(names))?;
    let mut columns = Vec::new();
    let (mut has_angles, mut has_slides) = (false, false);
    for name in &names {
        let (bare, quantity) = coordinate(name, title);
        let bare = plain(bare);
        columns.push(match (quantity, angle) {
            _ if *name == "time" => "t_s".to_owned(),
            (Quantity::Angle, Some(unit)) => {
                has_angles = true;
                format!("{bare}_{unit}")
            }
            (Quantity::Speed, Some(unit)) => format!("{bare}_{unit}_s"),
            (Quantity::Slide, _) => {
                has_slides = true;
                bare
            }
            _ => bare,
        });
    }
    let mut flat = Flat::new(columns)?;
    if has_angles {
        flat.read_as(format!(
            "the file states that its angles are in {}",
            if angle == Some("deg") {
                "degrees"
            } else {
                "radians"
            }
        ));
    }
    if has_slides {
        flat.not_read(
            "coordinates whose names end with _tx, _ty or _tz are lengths, and are not read",
        );
    }
    for (index, line) in rows {
        flat.push(cells(line, index + 1, Separator::of_header(line))?)?;
    }
    Ok(flat.decoded())
}

fn markers(bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let lines: Vec<&str> = text.lines().collect();
    let row = |index: usize| match lines.get(index) {
        Some(line) => cells(line, index + 1, Separator::Tab),
        None => Err(broken(PROGRAM, index + 1, "the file ends in its names")),
    };
    let (keys, values) = (row(1)?, row(2)?);
    let of = |key: &str| {
        let at = keys.iter().position(|cell| *cell == key)?;
        values.get(at).copied()
    };
    let unit = match of("Units").map(|unit| LengthUnit::by_word(&unit.to_lowercase())) {
        Some(Some(unit)) => format!(" ({})", unit.symbol()),
        _ => String::new(),
    };
    let names = row(3)?;
    let is_time = names
        .get(1)
        .is_some_and(|name| name.eq_ignore_ascii_case("Time"));
    if !is_time {
        return Err(broken(PROGRAM, 4, "no column Time"));
    }
    // The name of a marker stands above x; the two cells behind it are empty.
    let named: Vec<(usize, &str)> = (names.iter().enumerate().skip(2))
        .filter(|(_, name)| !name.is_empty())
        .map(|(at, name)| (at, *name))
        .collect();
    let columns = named
        .iter()
        .flat_map(|(_, name)| ["X", "Y", "Z"].map(|axis| format!("{} {axis}{unit}", plain(name))));
    let mut flat = Flat::new(std::iter::once("Time (s)".to_owned()).chain(columns))?;
    if reading.axes.is_none() {
        flat.doubt(Code::UnknownAxes.warning(
            "a file of markers does not say which of its axes points up, and in OpenSim it is y: they are read as x, y, z with z up",
        ));
    }
    for (index, line) in lines.iter().enumerate().skip(5) {
        if line.trim().is_empty() {
            continue;
        }
        let row = cells(line, index + 1, Separator::Tab)?;
        let cell = |at: usize| row.get(at).copied().unwrap_or_default();
        let places = named
            .iter()
            .flat_map(|(at, _)| [cell(*at), cell(at + 1), cell(at + 2)]);
        flat.push(std::iter::once(cell(1)).chain(places))?;
    }
    Ok(flat.decoded())
}
