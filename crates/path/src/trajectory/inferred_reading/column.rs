//! Infers roles and units of columns from their names.

use super::super::body_column;
use super::super::column::{Columns, Measure, Role};
use super::super::csv::Csv;
use super::super::format::Format as _;
use super::super::reading::Reading;
use super::super::table::Table;
use super::super::text::{cells_of, excerpt};
use super::InferredReading;
use realgap_core::error::{Advice, Error, Result};

/// Words before the name of an axis that make the column a part of an orientation.
const ORIENTATION: [&str; 6] = ["q", "quat", "quaternion", "orientation", "rot", "rotation"];
/// Words before the name of an axis that make the column neither a position nor an orientation.
const OTHERS: [&str; 16] = [
    "v",
    "vel",
    "velocity",
    "twist",
    "linear",
    "angular",
    "speed",
    "acc",
    "accel",
    "acceleration",
    "omega",
    "gyro",
    "euler",
    "mag",
    "force",
    "w",
];

/// The words of a name in lower case: the name is split at every character that is neither a letter nor a digit, and between a lower-case and
/// an upper-case letter.
fn words(name: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut was_small = false;
    for c in name.chars() {
        let ends = !c.is_alphanumeric() || (was_small && c.is_uppercase());
        if ends && all.last().is_some_and(|word| !word.is_empty()) {
            all.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(word) = all.last_mut()
        {
            word.extend(c.to_lowercase());
        }
        was_small = c.is_lowercase();
    }
    all.retain(|word| !word.is_empty());
    all
}

/// The role of a column with this name, and the unit in the name; `None` if the name suggests no role.
fn role_of(name: &str) -> Option<(Role, Option<String>)> {
    let mut words = words(name);
    let unit = words.last().cloned().filter(|last| {
        let known = [
            "s", "ms", "us", "ns", "m", "cm", "mm", "rad", "deg", "sec", "secs", "seconds",
        ];
        words.len() > 1 && known.contains(&last.as_str())
    });
    if unit.is_some() {
        words.pop();
    }
    let unit = unit.map(|unit| match unit.as_str() {
        "sec" | "secs" | "seconds" => "s".to_owned(),
        _ => unit,
    });
    let last = words.last()?.as_str();
    let before = &words[..words.len() - 1];
    let is_of = |kinds: &[&str]| before.iter().any(|word| kinds.contains(&word.as_str()));
    let axis = |letter: &str| match (letter, is_of(&ORIENTATION)) {
        ("x", false) => Some(Role::X),
        ("y", false) => Some(Role::Y),
        ("z", false) => Some(Role::Z),
        ("x", true) => Some(Role::Qx),
        ("y", true) => Some(Role::Qy),
        ("z", true) => Some(Role::Qz),
        ("w", true) => Some(Role::Qw),
        _ => None,
    };
    let role = match last {
        "t" | "time" | "timestamp" | "stamp" | "elapsed" | "seconds" | "secs" => Some(Role::Time),
        "yaw" | "heading" | "theta" | "psi" => Some(Role::Heading),
        "run" | "trial" | "repeat" | "take" => Some(Role::Run),
        "qw" => Some(Role::Qw),
        "qx" => Some(Role::Qx),
        "qy" => Some(Role::Qy),
        "qz" => Some(Role::Qz),
        "tx" | "px" | "posx" => Some(Role::X),
        "ty" | "py" | "posy" => Some(Role::Y),
        "tz" | "pz" | "posz" => Some(Role::Z),
        letter if !is_of(&OTHERS) || is_of(&ORIENTATION) => axis(letter),
        _ => None,
    }?;
    let fits = |unit: &String| match role.measure() {
        Measure::Time => ["s", "ms", "us", "ns"].contains(&unit.as_str()),
        Measure::Length => ["m", "cm", "mm"].contains(&unit.as_str()),
        Measure::Angle => ["rad", "deg"].contains(&unit.as_str()),
        _ => false,
    };
    Some((role, unit.filter(fits)))
}

/// The number of lines before the header line; `None` if no line of the first 60 looks like a header.
fn lines_before(text: &str) -> Option<usize> {
    let lines: Vec<&str> = text.lines().take(60).collect();
    let is_number = |cell: &&str| {
        let cell = cell.replace(',', ".");
        cell.is_empty() || cell.parse::<f64>().is_ok()
    };
    (0..lines.len().saturating_sub(1)).find(|index| {
        let (names, values) = (cells_of(lines[*index]), cells_of(lines[*index + 1]));
        let numbers = values.iter().filter(|cell| is_number(cell)).count();
        names.len() > 2
            && names.len() == values.len()
            && !names.iter().any(is_number)
            && 2 * numbers > values.len()
    })
}

/// Infers the roles of the columns, if their names differ from realgap's own names.
///
/// # Errors
/// No column of times or of positions.
pub(super) fn infer_columns(text: &str, guess: &mut InferredReading) -> Result<()> {
    match Table::open(text, &guess.reading, &[]) {
        Ok(_) => return heading_in_degrees(text, guess),
        Err(empty) if text.trim().is_empty() => return Err(empty),
        Err(_) => {}
    }
    if several_bodies(text, guess) {
        return Ok(());
    }
    if guess.reading.skip_lines.is_none()
        && let Some(skipped @ 1..) = lines_before(text)
    {
        guess.reading.skip_lines = Some(skipped);
        let reason = "it is the first line of names above a line of numbers";
        guess.conclude(format!("line {} names the columns", skipped + 1), reason);
    }
    let names = Csv.columns(text, &guess.reading);
    let mut found: Vec<(Role, &str, Option<String>)> = Vec::new();
    let mut twice = Vec::new();
    for name in &names {
        let Some((role, unit)) = role_of(name) else {
            continue;
        };
        match found.iter().find(|(known, ..)| *known == role) {
            Some((_, first, _)) if *first != *name => {
                twice.push(format!("{} and {}", first, excerpt(name)))
            }
            Some(_) => {}
            None => found.push((role, name, unit)),
        }
    }
    let has = |role: Role| {
        found.iter().any(|(known, ..)| *known == role) || guess.reading.columns.get(role).is_some()
    };
    let lacks = |what: &str| {
        Error::invalid(format!("no column has a name for {what}"))
            .at_line(1 + guess.reading.skip_lines.unwrap_or(0), 1)
            .found(
                names
                    .iter()
                    .map(|n| excerpt(n))
                    .collect::<Vec<_>>()
                    .join(", "),
            )
            .advise(Advice::MapColumns)
    };
    if !has(Role::Time) {
        return Err(lacks("a time (t, time, stamp)")
            .hint("a path without times cannot be simulated: record times, or add a column t_s"));
    }
    if !has(Role::X) || !has(Role::Y) {
        return Err(lacks("both x and y")
            .hint("the angles of joints, and their commands, are columns NAME_rad or NAME_deg"));
    }
    if let Some(twice) = twice.first() {
        return Err(Error::invalid("two columns seem to hold the same quantity")
            .found(twice)
            .hint("in files of several bodies, each body has its own set of columns")
            .advise(Advice::MapColumns));
    }
    let quaternion = [Role::Qw, Role::Qx, Role::Qy, Role::Qz];
    let is_whole = quaternion.iter().all(|role| has(*role));
    let mut columns: Columns = guess.reading.columns.clone();
    for (role, name, unit) in found {
        if columns.get(role).is_some() || (quaternion.contains(&role) && !is_whole) {
            continue;
        }
        let suffix = unit.map(|unit| format!(" in {unit}"));
        columns = columns.with(role, &format!("{name}{}", suffix.unwrap_or_default()))?;
    }
    let mapping: Vec<String> = columns
        .iter()
        .map(|(role, column)| format!("{} from `{column}`", role.name()))
        .collect();
    guess.reading.columns = columns;
    guess.conclude(mapping.join(", "), "the names of the columns");
    heading_in_degrees(text, guess)
}

/// True if the file has columns of named bodies; then the first body is taken for the robot.
fn several_bodies(text: &str, guess: &mut InferredReading) -> bool {
    let names = Csv.columns(text, &guess.reading);
    let bodies = body_column::names(&names);
    let Some(first) = bodies.first() else {
        return false;
    };
    if !guess.reading.columns.is_empty()
        || body_column::has_plain(&names)
        || !names.contains(&"t_s")
    {
        return false;
    }
    let reason = match bodies.as_slice() {
        [_] => "columns are named after it".to_owned(),
        [_, .., last] => format!(
            "it is the first of the bodies {} with columns of their own; if the robot is another body, map its columns, e.g. x from {last}_x_m; the other bodies touch the robot only if the study's `scene` says so",
            bodies.join(", ")
        ),
        [] => String::new(),
    };
    guess.conclude(format!("the robot is `{first}`"), reason);
    true
}

/// Infers that headings are in degrees from their size: up to 361, or with jumps of about 360.
fn heading_in_degrees(text: &str, guess: &mut InferredReading) -> Result<()> {
    let Some(column) = guess.reading.columns.get(Role::Heading) else {
        return Ok(());
    };
    if column.factor.is_some() || guess.reading.angle.is_some() {
        return Ok(());
    }
    let names = Csv.columns(text, &guess.reading);
    let Some(at) = names.iter().position(|name| *name == column.name) else {
        return Ok(());
    };
    let skipped = guess.reading.skip_lines.unwrap_or(0) + 1;
    let rows = text
        .lines()
        .filter(|line| !line.trim().is_empty())
        .skip(skipped);
    let values: Vec<f64> = rows
        .filter_map(|line| cells_of(line).get(at)?.replace(',', ".").parse().ok())
        .collect();
    let largest = values
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let jump = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(0.0_f64, f64::max);
    // Wrapped angles jump by a whole turn.
    let is_degrees =
        (300.0..=361.0).contains(&jump) || (largest > 7.0 && largest <= 361.0 && jump < 60.0);
    if is_degrees {
        guess.reading.angle = Some(realgap_core::unit::AngleUnit::Degree);
        guess.conclude(
            "angles are in degrees",
            format!("`{}` has values up to {largest:.1}", column_name(guess)),
        );
    }
    Ok(())
}

fn column_name(guess: &InferredReading) -> String {
    let column = guess.reading.columns.get(Role::Heading);
    column.map(|column| column.name.clone()).unwrap_or_default()
}

/// Removes the units of length from a mapping, because they were wrong.
pub(super) fn without_length_units(reading: &mut Reading) {
    let mut columns = Columns::default();
    for (role, column) in reading.columns.iter() {
        let text = match role.measure() {
            Measure::Length => column.name.clone(),
            _ => column.to_string(),
        };
        // The name was valid before, so this cannot fail.
        if let Ok(with) = columns.clone().with(role, &text) {
            columns = with;
        }
    }
    reading.columns = columns;
}
