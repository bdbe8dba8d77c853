//! Exports of DeepLabCut: three lines of names (scorer, body parts, coordinates), then one row for each picture.

use super::ForeignTable;
use super::flat::{Flat, broken, cells};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{Separator, decode_text, first_line};
use realgap_core::error::Result;
use realgap_core::unit::counted;

/// CSV files that DeepLabCut writes: places in pixels, and pictures that are counted. Rate and scale have to be stated.
pub const DEEPLABCUT: ForeignTable = ForeignTable {
    name: "deeplabcut",
    doc: "CSV files of DeepLabCut: body parts in pixels; rate and scale are asked for",
    extensions: &["csv"],
    recognises: |bytes| first_line(bytes).starts_with("scorer,"),
    table: |bytes, _| table(bytes),
    beside: None,
};

/// The likelihood below which DeepLabCut's own plots leave a place out.
const LIKELY: f64 = 0.6;

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let lines: Vec<&str> = text.lines().collect();
    let row = |index: usize| cells(lines[index], index + 1, Separator::Comma);
    let is_coords = |line: &&str| line.starts_with("coords,");
    let coords_at = lines.iter().take(5).position(is_coords);
    let coords_at = coords_at.ok_or_else(|| broken("DeepLabCut", 1, "no line `coords`"))?;
    let coords = row(coords_at)?;
    // Files of several animals have a line of individuals above the body parts.
    let above: Vec<Vec<&str>> = (1..coords_at).map(row).collect::<Result<_>>()?;
    let names = coords.iter().enumerate().skip(1).map(|(index, coord)| {
        let whose = above.iter().filter_map(|row| row.get(index).copied());
        let whose = whose.collect::<Vec<_>>().join(" ");
        match *coord {
            "x" | "y" => format!("{whose} {coord} (px)"),
            other => format!("{whose} {other}"),
        }
    });
    let mut flat = Flat::new(std::iter::once("frame".to_owned()).chain(names))?;
    let mut doubtful = 0;
    for (index, line) in lines.iter().enumerate().skip(coords_at + 1) {
        if line.trim().is_empty() {
            continue;
        }
        let cells = row(index)?;
        let likelihoods = coords.iter().zip(&cells);
        let mut likelihoods = likelihoods.filter(|(coord, _)| **coord == "likelihood");
        let is_doubtful = |cell: &str| cell.parse::<f64>().is_ok_and(|value| value < LIKELY);
        doubtful += usize::from(likelihoods.any(|(_, cell)| is_doubtful(cell)));
        flat.push(cells)?;
    }
    if doubtful > 0 {
        flat.read_as(format!(
            "{} with a likelihood below {LIKELY} are read as they are",
            counted(doubtful, "row")
        ));
    }
    Ok(flat.decoded())
}
