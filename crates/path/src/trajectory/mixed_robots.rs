//! Detects tables in which the rows of several robots or several runs are mixed.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::header::excerpt_list;
use super::reading::Reading;
use super::table::Table;
use super::text::excerpt;
use realgap_core::error::{Advice, Error};
use realgap_core::warning::{Code, Warning};

/// A column with more different values than this does not name robots.
const MAX_VALUES: usize = 32;
/// Rows of several robots are assumed if the robots' own paths together are shorter than this share of the path through all rows.
const SHORTER: f64 = 0.5;

/// A column that may name the robot or run of each row.
struct Label<'a> {
    column: usize,
    name: String,
    values: BTreeMap<&'a str, Follower>,
}

/// The path through the rows with one value of the column, up to its last sample.
struct Follower {
    time: f64,
    position: Vector3<f64>,
    samples: usize,
    path: f64,
    increases: bool,
}

/// The columns with few different values that each have several samples; and the length of the path through all rows in their order.
fn labels<'a>(text: &'a str, reading: &Reading) -> Option<(Vec<Label<'a>>, f64)> {
    let mut table = Table::open(text, reading, &[]).ok()?;
    if table.unused.is_empty() {
        return None;
    }
    let mut labels: Vec<Label<'a>> = table
        .unused
        .iter()
        .map(|column| Label {
            column: *column,
            name: table.layout.names[*column].clone(),
            values: BTreeMap::new(),
        })
        .collect();
    let (mut path, mut last) = (0.0, None);
    while let Some((_, cells)) = table.rows.next().ok()? {
        let number = |column: usize| {
            let cell = cells.get(column)?;
            cell.number("").ok()
        };
        let layout = &table.layout;
        let [x, y] = layout.place?;
        let time = layout.clock.columns().next().map_or(Some(0.0), number);
        let (Some(time), Some(x), Some(y)) = (time, number(x), number(y)) else {
            continue;
        };
        let z = layout.z.and_then(number).unwrap_or(0.0);
        let position = Vector3::new(x, y, z);
        path += last.map_or(0.0, |last: Vector3<f64>| (position - last).norm());
        last = Some(position);
        labels.retain_mut(|label| {
            let Some(cell) = cells.get(label.column) else {
                return false;
            };
            let is_new = !label.values.contains_key(cell.text);
            if is_new && label.values.len() == MAX_VALUES {
                return false;
            }
            let follower = label.values.entry(cell.text).or_insert(Follower {
                time: f64::NEG_INFINITY,
                position,
                samples: 0,
                path: 0.0,
                increases: true,
            });
            follower.increases &= time > follower.time;
            follower.path += (position - follower.position).norm();
            follower.time = time;
            follower.position = position;
            follower.samples += 1;
            true
        });
        if labels.is_empty() {
            return None;
        }
    }
    labels.retain(|label| {
        label.values.len() > 1 && label.values.values().all(|value| value.samples > 1)
    });
    Some((labels, path))
}

impl Label<'_> {
    fn values(&self) -> String {
        excerpt_list(&self.values.keys().copied().collect::<Vec<_>>())
    }

    fn path(&self) -> f64 {
        self.values.values().map(|value| value.path).sum()
    }
}

/// Adds a hint to an error about times that do not increase, if a column explains them.
pub(super) fn explain(error: Error, text: &str, reading: &Reading) -> Error {
    if error.message() != super::sample::TIME_GOES_BACK {
        return error;
    }
    let Some((labels, _)) = labels(text, reading) else {
        return error;
    };
    let increases = |label: &&Label<'_>| label.values.values().all(|value| value.increases);
    match labels.iter().find(increases) {
        Some(label) => error
            .hint(format!(
                "the column `{}` says that this file holds several recordings ({}): choose one",
                excerpt(&label.name),
                label.values()
            ))
            .without_advice()
            .advise(Advice::ChooseRobot),
        None => error,
    }
}

/// The beginning of a warning about a column that tells robots apart.
const JUMPS: &str = "the path jumps whenever the column";

/// True if a warning about several robots names the column that tells them apart.
pub(super) fn names_column(warning: &Warning) -> bool {
    warning.message.starts_with(JUMPS)
}

/// A warning if the path jumps between several robots whose rows alternate in time.
pub(super) fn mixed_robots(text: &str, reading: &Reading) -> Option<Warning> {
    let (labels, path) = labels(text, reading)?;
    let shorter = labels.iter().find(|label| label.path() < SHORTER * path)?;
    Some(Code::SeveralRobots.warning(format!(
        "{JUMPS} `{}` changes ({}): if these are several robots, read one of them with `only: (column: \"{}\", value: ...)`",
        excerpt(&shorter.name),
        shorter.values(),
        excerpt(&shorter.name)
    )))
}
