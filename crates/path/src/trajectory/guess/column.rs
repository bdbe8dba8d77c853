//! Roles and units in the names of columns.

use super::super::body_column;
use super::super::column::{Columns, Measure, Role};
use super::super::csv::Csv;
use super::super::format::Format as _;
use super::super::reading::Reading;
use super::super::table::Table;
use super::super::text::{cells_of, excerpt};
use super::InferredReading;
use realgap_core::error::{Advice, Error, Result};

/// Words before the name of an axis that make it something else than a place.
const ORIENTATION: [&str; 6] = ["q", "quat", "quaternion", "orientation", "rot", "rotation"];
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

/// Words of a name: cut at everything that is no letter or digit, and where a capital follows a small letter.
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

/// What a column of this name holds, and the unit that the name says.
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

/// How many lines stand before the one that names the columns.
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

/// Says which columns hold what, where the names are others than ours.
///
/// # Errors
/// No column of times or of positions.
pub(super) fn name(text: &str, guess: &mut InferredReading) -> Result<()> {
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
        let because = "the first line whose cells are names above numbers";
        guess.say(format!("line {} names the columns", skipped + 1), because);
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
        Error::invalid(format!("no column is called like {what}"))
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
            .hint("a path without times cannot be simulated: record them, or add a column t_s"));
    }
    if !has(Role::X) || !has(Role::Y) {
        return Err(lacks("both x and y")
            .hint("angles of joints, and what they were told, are columns NAME_rad or NAME_deg"));
    }
    if let Some(twice) = twice.first() {
        return Err(Error::invalid("two columns look like the same thing")
            .found(twice)
            .hint("files of several bodies have one set of columns each")
            .advise(Advice::MapColumns));
    }
    let quaternion = [Role::Qw, Role::Qx, Role::Qy, Role::Qz];
    let is_whole = quaternion.iter().all(|role| has(*role));
    let mut columns: Columns = guess.reading.columns.clone();
    for (role, name, unit) in found {
        if columns.get(role).is_some() || (quaternion.contains(&role) && !is_whole) {
            continue;
        }
        let said = unit.map(|unit| format!(" in {unit}"));
        columns = columns.with(role, &format!("{name}{}", said.unwrap_or_default()))?;
    }
    let said: Vec<String> = columns
        .iter()
        .map(|(role, column)| format!("{} from `{column}`", role.name()))
        .collect();
    guess.reading.columns = columns;
    guess.say(said.join(", "), "names of the columns");
    heading_in_degrees(text, guess)
}

/// Whether the file has a set of columns for each of several bodies, as they are read here: the first is the robot then.
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
    let because = match bodies.as_slice() {
        [_] => "columns are called after it".to_owned(),
        [_, .., last] => format!(
            "first of the bodies {} with columns of their own; were it another, name that one's, x from {last}_x_m and so on; the others touch it only where the study's `scene` says so",
            bodies.join(", ")
        ),
        [] => String::new(),
    };
    guess.say(format!("the robot is `{first}`"), because);
    true
}

/// The unit of headings, which no whole number of turns of radians explains where they go on to hundreds.
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
    // Where angles begin again they jump by a whole turn.
    let is_degrees =
        (300.0..=361.0).contains(&jump) || (largest > 7.0 && largest <= 361.0 && jump < 60.0);
    if is_degrees {
        guess.reading.angle = Some(realgap_core::unit::AngleUnit::Degree);
        guess.say(
            "angles are in degrees",
            format!("`{}` goes up to {largest:.1}", column_name(guess)),
        );
    }
    Ok(())
}

fn column_name(guess: &InferredReading) -> String {
    let column = guess.reading.columns.get(Role::Heading);
    column.map(|column| column.name.clone()).unwrap_or_default()
}

/// Takes units of length out of a mapping, for they were wrong.
pub(super) fn without_length_units(reading: &mut Reading) {
    let mut columns = Columns::default();
    for (role, column) in reading.columns.iter() {
        let text = match role.measure() {
            Measure::Length => column.name.clone(),
            _ => column.to_string(),
        };
        // It was a name of a column before.
        if let Ok(with) = columns.clone().with(role, &text) {
            columns = with;
        }
    }
    reading.columns = columns;
}
