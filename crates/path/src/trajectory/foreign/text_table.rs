//! Tables in files that end with `.txt`, `.dat`, `.log` or `.out`: they are read as CSV files are, whatever separates their columns. Text of
//! eight numbers (TUM) or twelve (KITTI) in a line is of those formats.

use super::ForeignTable;
use crate::trajectory::Reading;
use crate::trajectory::csv::Csv;
use crate::trajectory::format::{Decoded, Format as _};
use crate::trajectory::stated_header::separator_of_row;
use crate::trajectory::text::{Separator, cut};
use realgap_core::error::Result;

/// Tables with or without a line of names.
pub const TEXT_TABLE: ForeignTable = ForeignTable {
    name: "text-table",
    doc: "tables in text files, with a line of names as in CSV files, or with stated names",
    extensions: &["txt", "dat", "log", "out"],
    recognises: |bytes| {
        is_table(&String::from_utf8_lossy(
            &bytes[..bytes.len().min(LOOKED_AT)],
        ))
    },
    table,
    beside: None,
};

/// The first bytes in which a row is looked for.
const LOOKED_AT: usize = 100_000;
/// The numbers in a line of TUM and of KITTI.
const OF_POSES: [usize; 2] = [8, 12];

/// True unless the first row is one of numbers with the length of another format, or is no table.
fn is_table(start: &str) -> bool {
    let mut lines = start.lines();
    let row = lines.find(|line| {
        let line = line.trim_start();
        !line.is_empty() && !line.starts_with(['#', '%'])
    });
    let Some(row) = row else {
        return false;
    };
    let separator = separator_of_row(row);
    let mut cells = Vec::new();
    let is_cut = cut(row, 1, separator, &mut cells).is_ok();
    let is_number = cells
        .iter()
        .all(|cell| separator.number(cell.text).is_some());
    let is_of_poses = separator == Separator::Space && OF_POSES.contains(&cells.len());
    is_cut && cells.len() > 1 && !(is_number && is_of_poses)
}

fn table(bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
    // Names and lists of the reading are applied by the caller.
    let plain = Reading {
        names: Default::default(),
        lists: Default::default(),
        wheels: None,
        ..reading.clone()
    };
    Csv.decode(bytes, &plain)
}
