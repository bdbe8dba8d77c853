//! The log of libfranka (`franka::logToCSV`): times in milliseconds, seven joints by their numbers, and what was sent to them.
//! Layout: libfranka, `src/log.cpp` and `src/logging/robot_state_log.cpp`.

use super::ForeignTable;
use super::flat::{Flat, names_and_rows};
use crate::trajectory::format::Decoded;
use crate::trajectory::text::{decode_text, first_line};
use realgap_core::error::{Error, Result};

/// Logs of libfranka, old (`duration, success rate`) and new (`time,success_rate`).
pub const FRANKA: ForeignTable = ForeignTable {
    name: "libfranka",
    doc: "logs of libfranka: angles, speeds and torques of the joints by number, and the commands that were sent",
    extensions: &["csv", "txt"],
    recognises: |bytes| {
        let line = first_line(bytes).replace(' ', "");
        line.starts_with("duration,successrate,q[0],")
            || line.starts_with("time,success_rate,state.q[0],")
    },
    table: |bytes, _| table(bytes),
    beside: None,
};

const JOINTS: usize = 7;
/// What is read of a state: the name there, and the name here.
const STATES: [(&str, &str); 3] = [("q", "q"), ("dq", "dq"), ("tau_J", "tau")];
/// What may have been sent; what was not used is 0 throughout.
const SENT: [(&str, &str, &str); 3] = [
    ("q_d", "q_cmd", "angles"),
    ("dq_d", "dq_cmd", "speeds"),
    ("tau_J_d", "tau_cmd", "torques"),
];

fn table(bytes: Vec<u8>) -> Result<Decoded> {
    let text = decode_text(bytes)?;
    let (header, rows) = names_and_rows(&text)?;
    let rows: Vec<(usize, Vec<&str>)> = rows.collect::<Result<_>>()?;
    // Old logs have one name for what a state desires and for what was sent, which stands behind it.
    let of_state = |name: &str| {
        let wanted = [format!("{name}[0]"), format!("state.{name}[0]")];
        header
            .iter()
            .position(|cell| wanted.iter().any(|w| w == cell))
    };
    let of_command = |name: &str| {
        let wanted = [format!("{name}[0]"), format!("cmd.{name}[0]")];
        let sent_at = header
            .iter()
            .position(|cell| *cell == "sent commands")
            .unwrap_or(0);
        let found = header
            .iter()
            .rposition(|cell| wanted.iter().any(|w| w == cell));
        found.filter(|at| *at > sent_at && (sent_at > 0 || header[*at].starts_with("cmd.")))
    };
    let is_used = |at: usize| {
        let number =
            |row: &[&str], at: usize| row.get(at).and_then(|cell| cell.parse::<f64>().ok());
        let mut all = rows.iter();
        all.any(|(_, row)| (at..at + JOINTS).any(|at| number(row, at).is_some_and(|v| v != 0.0)))
    };
    let mut kept: Vec<(usize, &str)> = (STATES.iter())
        .filter_map(|(theirs, ours)| Some((of_state(theirs)?, *ours)))
        .collect();
    let sent = SENT.iter().find_map(|(theirs, ours, words)| {
        let at = of_command(theirs).filter(|at| is_used(*at))?;
        Some((at, *ours, *words))
    });
    kept.extend(sent.map(|(at, ours, _)| (at, ours)));
    let names = kept
        .iter()
        .flat_map(|(_, name)| (0..JOINTS).map(move |joint| format!("{name}[{joint}]")));
    let mut flat = Flat::new(std::iter::once("t_ms".to_owned()).chain(names))?;
    for (number, row) in &rows {
        let mut cells = vec![row.first().copied().unwrap_or_default()];
        for (at, _) in &kept {
            let own = row.get(*at..at + JOINTS).ok_or_else(|| {
                Error::invalid("the row ends before its last column")
                    .at_line(*number, 1)
                    .hint("the log was cut off: leave its last row out")
            })?;
            cells.extend(own);
        }
        flat.push(cells)?;
    }
    flat.read_as(format!(
        "a log of libfranka: times are milliseconds, angles radians; commands are {}",
        sent.map_or(
            "not in it, or 0 throughout".to_owned(),
            |(_, _, words)| format!("the {words} that were sent")
        )
    ));
    Ok(flat.decoded())
}
