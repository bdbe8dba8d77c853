//! Errors about columns that a file does not have, with the columns that may stand for them.

use super::super::column_name::{counts_samples, words};
use super::super::reading::Reading;
use super::super::text::excerpt;
use super::column::{cells, values};
use super::role::is_geographic;
use realgap_core::error::{Advice, Error};
use realgap_core::unit::number;

/// Words in the names of columns that hold angles of joints, in files without places.
const OF_JOINTS: [&str; 8] = [
    "q", "qpos", "pos", "position", "angle", "joint", "present", "setpoint",
];

/// The error that no column has a name for `what`.
pub(super) fn column(names: &[&str], reading: &Reading, what: &str) -> Error {
    let shown: Vec<String> = names.iter().map(|n| excerpt(n)).collect();
    Error::invalid(format!("no column has a name for {what}"))
        .at_line(1 + reading.skip_lines.unwrap_or(0), 1)
        .found(shown.join(", "))
}

/// The error that no column has a name for a time, with the first column that grows as one.
pub(super) fn time(text: &str, names: &[&str], reading: &Reading) -> Error {
    let error = column(names, reading, "a time (t, time, stamp)");
    if let Some(counter) = names.iter().find(|name| counts_samples(name)) {
        return error
            .hint(format!("`{}` counts samples", excerpt(counter)))
            .advise(Advice::Rate)
            .advise(Advice::MapColumns);
    }
    let growing = names.iter().find_map(|name| {
        let step = step_of(&values(text, reading, name))?;
        Some(format!(
            "`{}` grows with every row, mostly by {}: if it is the time, map it with its unit, e.g. t={} in ms; if it counts samples, state their rate",
            excerpt(name),
            number(step),
            excerpt(name)
        ))
    });
    let hint = growing.unwrap_or_else(|| {
        "a path without times cannot be simulated: record times, or add a column t_s".to_owned()
    });
    error
        .hint(hint)
        .advise(Advice::MapColumns)
        .advise(Advice::Rate)
}

/// The usual step of numbers that grow from each row to the next, as times do; `None` for others, and for fewer than three.
fn step_of(values: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let grows = steps.len() > 1 && steps.iter().all(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    let middle = steps.get(steps.len() / 2).copied()?;
    // A quantity that was measured grows unevenly.
    let is_even = |step: &&f64| **step < 2.0 * middle;
    let even = steps.iter().filter(is_even).count();
    (grows && 10 * even >= 9 * steps.len()).then_some(middle)
}

/// The error that columns have names for neither a place nor joints.
pub(super) fn place(text: &str, names: &[&str], reading: &Reading) -> Error {
    let error = column(names, reading, "both x and y");
    if is_geographic(names) {
        return error.hint("latitude and longitude are angles on the globe, not lengths: convert them to metres east and north of a point, e.g. with pymap3d or in UTM, and name these columns x_m and y_m");
    }
    let lists: Vec<String> = (names.iter())
        .filter(|name| {
            let mut column = cells(text, reading, name);
            column.next().is_some_and(|cell| cell.starts_with('['))
        })
        .map(|name| format!("`{}`", excerpt(name)))
        .collect();
    if !lists.is_empty() {
        return error.hint(format!(
            "{} hold lists of numbers: name each number with its unit, e.g. `lists: {{\"action\": [\"JOINT_command_deg\", ...]}}` in `reading`",
            lists.join(", ")
        ));
    }
    match names.iter().any(|name| is_of_joint(name)) {
        true => error
            .hint("columns of joints are found with the robot, whose file names its joints; without it, call the angles of joints and their commands NAME_rad or NAME_deg, NAME_command_rad")
            .advise(Advice::NameRobot),
        false => error
            .hint("the angles of joints, and their commands, are columns NAME_rad or NAME_deg")
            .advise(Advice::MapColumns),
    }
}

/// True if a column seems to hold the angle of a joint, which only the names of the robot's joints can show.
fn is_of_joint(name: &str) -> bool {
    let words = words(name);
    words.iter().any(|word| {
        let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
        OF_JOINTS.contains(&word)
    })
}
