//! Infers roles and units of columns from their names.

use super::super::body_column;
use super::super::column::{Columns, Measure, Role};
use super::super::column_name::{StatedUnit, unit_in_name, unit_in_row, words};
use super::super::csv::Csv;
use super::super::format::Format as _;
use super::super::joint_column;
use super::super::reading::{Reading, Ticks};
use super::super::stamp;
use super::super::table::Table;
use super::super::text::{Separator, cells_of, excerpt};
use super::lacking;
use super::role::{Named, named};
use super::{Candidate, InferredReading, Question};
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::{LengthUnit, counted};

const QUATERNION: [Role; 4] = [Role::Qw, Role::Qx, Role::Qy, Role::Qz];

/// The number of lines before the header line; `None` if no line of the first 60 looks like a header.
fn lines_before(text: &str) -> Option<usize> {
    let lines: Vec<&str> = text.lines().take(60).collect();
    let is_value = |cell: &&str| {
        let number = cell.replace(',', ".");
        cell.is_empty() || number.parse::<f64>().is_ok() || stamp::stamp(cell).is_some()
    };
    let is_header = |index: &usize, below: usize| {
        let Some(values) = lines.get(index + below) else {
            return false;
        };
        let (names, values) = (cells_of(lines[*index]), cells_of(values));
        let numbers = values.iter().filter(|cell| is_value(cell)).count();
        names.len() > 2
            && names.len() == values.len()
            && !names.iter().any(is_value)
            && 2 * numbers > values.len()
    };
    let first = (0..lines.len()).find(|index| is_header(index, 1));
    // A row of units may stand between names and numbers; then the names look like units to nobody.
    let above_units = (0..lines.len()).find(|index| {
        let units = lines
            .get(index + 1)
            .map(|line| cells_of(line))
            .unwrap_or_default();
        let is_units = super::super::column_name::is_row_of_units(units.into_iter());
        is_units && is_header(index, 2)
    });
    above_units.or(first)
}

/// Infers the roles of the columns, if their names differ from realgap's own names.
///
/// # Errors
/// No column of times or of positions.
pub(super) fn infer_columns(text: &str, guess: &mut InferredReading) -> Result<()> {
    let is_own = match Table::open(text, &guess.reading, &[]) {
        Ok(_) => true,
        Err(empty) if text.trim().is_empty() => return Err(empty),
        Err(_) => false,
    };
    if is_own {
        heading_beside(text, guess)?;
        return heading_in_degrees(text, guess);
    }
    if several_bodies(text, guess) {
        return Ok(());
    }
    let is_commented = text.trim_start().starts_with(['#', '%']);
    if guess.reading.skip_lines.is_none()
        && !is_commented
        && let Some(skipped @ 1..) = lines_before(text)
    {
        guess.reading.skip_lines = Some(skipped);
        let reason = "it is the first line of names above a line of numbers";
        guess.conclude(format!("line {} names the columns", skipped + 1), reason);
    }
    let names = Csv.columns(text, &guess.reading);
    let found: Vec<Named<'_>> = names.iter().filter_map(|name| named(name)).collect();
    let lacks = |what: &str| lacking::column(&names, &guess.reading, what);
    let is_mapped = |role: Role| guess.reading.columns.get(role).is_some();
    let has = |role: Role| found.iter().any(|column| column.role == role) || is_mapped(role);
    let is_number = |name: &str| Separator::of_header(name).number(name).is_some();
    let filled = names.iter().filter(|name| !name.is_empty()).count();
    let numbers = names.iter().filter(|name| is_number(name)).count();
    if filled > 1 && 3 * numbers >= 2 * filled {
        return Err(lacks("anything")
            .hint(format!(
                "the first line holds numbers: what is in each of the {}? Names are e.g. t_s,x_m,y_m,z_m,qw,qx,qy,qz or t_s,JOINT_rad,JOINT_command_rad",
                counted(names.len(), "column")
            ))
            .advise(Advice::NameColumns)
            .advise(Advice::SkipLines));
    }
    if !has(Role::Time) && guess.reading.rate_hz.is_none() {
        return Err(lacking::time(text, &names, &guess.reading));
    }
    let own_place = is_mapped(Role::X) && is_mapped(Role::Y);
    let sets = if own_place {
        Vec::new()
    } else {
        complete_sets(&found)
    };
    if sets.is_empty() && !own_place && !has_joints(&names, guess.reading.ticks) {
        return Err(lacking::place(text, &names, &guess.reading));
    }
    let plain = sets.iter().position(String::is_empty);
    if let (None, [_, _, ..]) = (plain, sets.as_slice()) {
        let candidates = sets.iter().map(|whose| {
            let columns = mapping(&found, Some(whose), &guess.reading.columns)?.0;
            Ok(Candidate {
                name: whose.clone(),
                columns,
            })
        });
        let candidates: Vec<Candidate> = candidates.collect::<Result<_>>()?;
        let options: Vec<String> = (candidates.iter())
            .map(|one| format!("{} (x from `{}`)", one.name, one.x()))
            .collect();
        guess.ask(
            Question::Body,
            format!("positions of {}", options.join(", ")),
        );
        if let Some(open) = guess.ambiguities.last_mut() {
            open.candidates = candidates;
        }
        return Ok(());
    }
    let whose = plain.map_or_else(|| sets.first().cloned(), |_| Some(String::new()));
    let (columns, times) = mapping(&found, whose.as_deref(), &guess.reading.columns)?;
    twice(&found, whose.as_deref(), &columns)?;
    let mapped: Vec<String> = columns
        .iter()
        .map(|(role, column)| format!("{} from `{column}`", role.name()))
        .collect();
    let mut reason = "the names of the columns".to_owned();
    if times.len() > 1 {
        reason += &format!("; further times are not used: {}", times[1..].join(", "));
    }
    let others: Vec<&str> = (sets.iter().map(String::as_str))
        .filter(|set| Some(*set) != whose.as_deref())
        .collect();
    if !others.is_empty() {
        reason += &format!(
            "; further positions are not used: those of {}",
            others.join(", ")
        );
    }
    guess.reading.columns = columns;
    guess.conclude(mapped.join(", "), reason);
    heading_in_degrees(text, guess)
}

fn has_joints(names: &[&str], ticks: Option<Ticks>) -> bool {
    let (mut used, mut factors) = (vec![false; names.len()], vec![1.0; names.len()]);
    !joint_column::find(names, &mut used, &mut factors, ticks).is_empty()
}

/// Whose positions are in the file: those with both x and y.
fn complete_sets(found: &[Named<'_>]) -> Vec<String> {
    let has = |role: Role, whose: &str| {
        let mut all = found.iter();
        all.any(|column| column.role == role && column.whose == whose)
    };
    let mut sets: Vec<String> = Vec::new();
    for column in found.iter().filter(|column| column.role == Role::X) {
        if has(Role::Y, &column.whose) && !sets.contains(&column.whose) {
            sets.push(column.whose.clone());
        }
    }
    sets
}

/// The columns of one body beside those that are known, and the names of all times, the used one first.
fn mapping(
    found: &[Named<'_>],
    whose: Option<&str>,
    known: &Columns,
) -> Result<(Columns, Vec<String>)> {
    let mut columns = known.clone();
    let mut put = |role: Role, column: &Named<'_>| -> Result<()> {
        if columns.get(role).is_none() {
            let unit = match column.unit {
                Some(StatedUnit::Known(symbol, _)) => format!(" in {symbol}"),
                _ => String::new(),
            };
            columns = columns
                .clone()
                .with(role, &format!("{}{unit}", column.name))?;
        }
        Ok(())
    };
    // The part below a second that belongs to a time: the same name in a smaller unit.
    let size = |column: &Named<'_>| match column.unit {
        Some(StatedUnit::Known(_, size)) => Some(size),
        _ => None,
    };
    let all_times = found.iter().filter(|column| column.role == Role::Time);
    let part_of = |time: &Named<'_>| {
        all_times.clone().find(|part| {
            let is_beside = part.whose == time.whose && part.rank == time.rank;
            let is_part = matches!(size(part), Some(size) if size < 1e-4);
            is_beside && is_part && size(time) == Some(1.0) && same_base(part.name, time.name)
        })
    };
    let is_part = |column: &&Named<'_>| {
        let mut all = all_times.clone();
        all.any(|time| part_of(time).is_some_and(|part| part.name == column.name))
    };
    let mut times: Vec<&Named<'_>> = all_times.clone().filter(|time| !is_part(time)).collect();
    let of_other = |time: &Named<'_>| {
        let is_own = whose.is_some_and(|whose| time.whose == whose);
        !is_own && !time.whose.is_empty()
    };
    times.sort_by_key(|time| (of_other(time), time.rank));
    if let Some(time) = times.first() {
        put(Role::Time, time)?;
        if let Some(part) = part_of(time) {
            put(Role::Nanos, part)?;
        }
    }
    if let Some(run) = found.iter().find(|column| column.role == Role::Run) {
        put(Role::Run, run)?;
    }
    let Some(whose) = whose else {
        return Ok((
            columns,
            times.iter().map(|time| time.name.to_owned()).collect(),
        ));
    };
    let of = |role: Role| {
        let mut all = found.iter();
        all.find(|column| column.role == role && column.whose == whose)
    };
    for role in [Role::X, Role::Y, Role::Z] {
        if let Some(column) = of(role) {
            put(role, column)?;
        }
    }
    let turns: Vec<&Named<'_>> = QUATERNION.iter().filter_map(|role| of(*role)).collect();
    let is_turned = turns.len() == QUATERNION.len();
    if is_turned {
        for column in turns {
            put(column.role, column)?;
        }
    } else if let Some(heading) = of(Role::Heading) {
        put(Role::Heading, heading)?;
    }
    Ok((
        columns,
        times.iter().map(|time| time.name.to_owned()).collect(),
    ))
}

/// True if two names differ in their last word only.
fn same_base(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(words);
    one.len() == other.len() && one[..one.len() - 1] == other[..other.len() - 1]
}

/// Refuses two columns of one quantity of one body.
fn twice(found: &[Named<'_>], whose: Option<&str>, columns: &Columns) -> Result<()> {
    let places = found.iter().filter(|column| {
        let is_place = !matches!(column.role, Role::Time | Role::Run);
        is_place && Some(column.whose.as_str()) == whose
    });
    for column in places {
        let used = columns.get(column.role);
        if let Some(used) = used
            && used.name != column.name
            && found
                .iter()
                .any(|other| other.name == used.name && other.whose == column.whose)
        {
            return Err(Error::invalid("two columns seem to hold the same quantity")
                .found(format!(
                    "{} and {}",
                    excerpt(&used.name),
                    excerpt(column.name)
                ))
                .hint("in files of several bodies, each body has its own set of columns")
                .advise(Advice::MapColumns));
        }
    }
    Ok(())
}

/// Maps a column of headings beside x and y, if nothing else tells the orientation.
fn heading_beside(text: &str, guess: &mut InferredReading) -> Result<()> {
    let Ok(table) = Table::open(text, &guess.reading, &[]) else {
        return Ok(());
    };
    let is_turned = table.layout.quaternion.is_some() || table.layout.heading.is_some();
    if table.layout.place.is_none() || is_turned {
        return Ok(());
    }
    let names = Csv.columns(text, &guess.reading);
    let headings = names.iter().filter_map(|name| named(name));
    let headings: Vec<Named<'_>> = headings
        .filter(|column| column.role == Role::Heading && column.whose.is_empty())
        .collect();
    if let [heading] = headings.as_slice() {
        let unit = match heading.unit {
            Some(StatedUnit::Known(symbol, _)) => format!(" in {symbol}"),
            _ => String::new(),
        };
        let column = format!("{}{unit}", heading.name);
        let columns = guess.reading.columns.clone();
        // Other columns keep their own names, because a mapping replaces single names only.
        guess.reading.columns = columns.with(Role::Heading, &column)?;
        guess.conclude(
            format!("heading from `{column}`"),
            "it stands beside x and y, and no quaternion tells the orientation",
        );
    }
    Ok(())
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
    let is_stated = unit_in_name(&column.name, Measure::Angle).is_some();
    if column.factor.is_some() || is_stated || guess.reading.angle.is_some() {
        return Ok(());
    }
    let values = values(text, &guess.reading, &column.name);
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
        let finding = format!("`{}` has values up to {largest:.1}", column.name);
        guess.reading.angle = Some(realgap_core::unit::AngleUnit::Degree);
        guess.conclude("angles are in degrees", finding);
    }
    Ok(())
}

/// The numbers in a column.
pub(super) fn values(text: &str, reading: &Reading, name: &str) -> Vec<f64> {
    cells(text, reading, name)
        .filter_map(|cell| cell.replace(',', ".").parse().ok())
        .collect()
}

/// The texts in a column below its name.
pub(super) fn cells<'a>(
    text: &'a str,
    reading: &Reading,
    name: &str,
) -> impl Iterator<Item = &'a str> {
    let names = Csv.columns(text, reading);
    let at = names.iter().position(|known| *known == name);
    let skipped = reading.skip_lines.unwrap_or(0);
    let rows = text
        .lines()
        .skip(skipped)
        .filter(|line| !line.trim().is_empty());
    let header = rows.clone().next().map(Separator::of_header);
    rows.filter_map(move |line| {
        let mut cells = Vec::new();
        super::super::text::cut(line, 1, header?, &mut cells).ok()?;
        cells.get(at?).map(|cell| cell.text)
    })
    .skip(1)
}

/// True if times are dates or times of day, which need no unit.
pub(super) fn has_dates(text: &str, reading: &Reading) -> bool {
    let Some(time) = reading.columns.get(Role::Time) else {
        return false;
    };
    let mut first = cells(text, reading, &time.name);
    first.any(|cell| stamp::stamp(cell).is_some())
}

/// The columns of a kind of quantity that are read, each with its role.
fn read_columns(text: &str, reading: &Reading, measure: Measure) -> Vec<(Role, String)> {
    let names = Csv.columns(text, reading);
    let roles = Role::ALL
        .iter()
        .filter(|role| role.measure() == measure && **role != Role::Nanos);
    let of = |role: &Role| match reading.columns.get(*role) {
        Some(column) => names
            .contains(&column.name.as_str())
            .then(|| column.name.clone()),
        None => (names.iter())
            .find(|name| {
                let rest = name.strip_prefix(role.name());
                rest == Some("")
                    || (rest.is_some_and(|rest| rest.starts_with('_'))
                        && unit_in_name(name, measure).is_some())
            })
            .map(|name| (*name).to_owned()),
    };
    roles.filter_map(|role| Some((*role, of(role)?))).collect()
}

/// True if the name of the column of times states their unit.
pub(super) fn names_time_unit(text: &str, reading: &Reading) -> bool {
    let columns = read_columns(text, reading, Measure::Time);
    let mut names = columns.iter().map(|(_, name)| name);
    names.any(|name| unit_in_name(name, Measure::Time).is_some())
}

/// The size in metres of the unit in which x is written, if its mapping, its name or a row of units states it.
pub(super) fn stated_length_m(text: &str, reading: &Reading) -> Option<f64> {
    if let Some(factor) = reading
        .columns
        .get(Role::X)
        .and_then(|column| column.factor)
    {
        return Some(factor);
    }
    let columns = read_columns(text, reading, Measure::Length);
    let (_, name) = columns.iter().find(|(role, _)| *role == Role::X)?;
    let in_row = || {
        let first = cells(text, reading, name).next()?;
        unit_in_row(first, Measure::Length)
    };
    match unit_in_name(name, Measure::Length).or_else(in_row)? {
        StatedUnit::Known(_, size_m) => Some(size_m),
        StatedUnit::Pixel => reading.scale,
    }
}

/// States the unit of a kind of quantity: for the whole file, and by a mapping for columns whose names state another unit.
pub(super) fn restate(
    text: &str,
    reading: &mut Reading,
    measure: Measure,
    unit: &str,
) -> Result<()> {
    let kinds = match measure {
        Measure::Length => vec![(Measure::Length, ""), (Measure::Velocity, "/s")],
        measure => vec![(measure, "")],
    };
    let mut columns = reading.columns.clone();
    for (kind, per) in kinds {
        for (role, name) in read_columns(text, reading, kind) {
            let is_named = unit_in_name(&name, kind).is_some();
            let is_mapped = columns.get(role).is_some();
            if is_named {
                columns = columns.with(role, &format!("{name} in {unit}{per}"))?;
            } else if is_mapped {
                columns = columns.with(role, &name)?;
            }
        }
    }
    reading.columns = columns;
    Ok(())
}

/// The length unit of this size.
pub(super) fn unit_of_size(metres: f64) -> Option<LengthUnit> {
    let mut all = LengthUnit::ALL.iter().copied();
    all.find(|unit| (unit.metres() / metres - 1.0).abs() < 1e-6)
}
