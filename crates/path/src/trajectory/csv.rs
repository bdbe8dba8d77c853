//! The CSV format of trajectories.
//!
//! The header is `t_s,x_m,y_m[,z_m][,qw,qx,qy,qz][,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s]`, with joints by
//! name: `[,NAME_rad[,NAME_rad_s]]`, and commanded speeds and torques: `[,NAME_command_rad_s][,NAME_command_nm][,NAME_on]`.

use std::collections::HashMap;

use super::Trajectory;
use super::column::{Columns, Role};
use super::format::{Decoded, Format, Parsed, Rendered};
use super::mixed_robots::{explain, mixed_robots};
use super::reading::{QuaternionOrder, Reading};
use super::relabel::relabelled;
use super::sample::{Clock, Samples};
use super::stated_header::with_stated_header;
use super::table::{Table, header_line};
use super::text::{Cell, cells_of, decode_text, push_number};
use realgap_core::constant_methods;
use realgap_core::error::{Error, Result};

const QUATERNION: [&str; 4] = ["qw", "qx", "qy", "qz"];
const ANGULAR: [&str; 3] = ["wx_rad_s", "wy_rad_s", "wz_rad_s"];

/// Comma-separated values with a header; columns may have any order, extra columns are ignored with a warning.
///
/// Units are in the column names. Without z the trajectory is planar. Quaternions have the real part first and are
/// world from body. Linear velocities are in the world frame, angular velocities in the body frame.
///
/// Names end with their unit: `x_m`, `x_mm`, `t_ms`, `vx_cm_s`. A [`Reading`] describes files that differ from this. If it states the unit of
/// lengths, a column may be named `x` or `vx`; a unit in a name has priority, and only a mapping (`x_m in mm`) overrides it. A row of units
/// below the names states units, too. Lines that begin with `#` or `%` are comments. A header without commas may be separated by
/// semicolons, tabs or spaces; numbers may then have decimal commas.
#[derive(Debug, Clone, Copy)]
pub struct Csv;

impl Format for Csv {
    constant_methods! {
        name: &'static str = "csv";
        doc: &'static str = "comma-separated values with a header that names columns and units";
        extensions: &'static [&'static str] = &["csv", "tsv"];
    }

    fn decode(&self, bytes: Vec<u8>, reading: &Reading) -> Result<Decoded> {
        let text = without_separator_line(decode_text(bytes)?);
        relabelled(with_stated_header(text, reading)?, reading).map(Decoded::from)
    }

    fn is_table(&self) -> bool {
        true
    }

    fn takes_header(&self) -> bool {
        true
    }

    fn parse(&self, text: &str, reading: &Reading) -> Result<Parsed> {
        let explained = |error| explain(error, text, reading);
        let (table, samples) = samples(text, reading)?;
        let mut parsed = samples
            .finish(&table.layout, table.warnings)
            .map_err(explained)?;
        parsed.warnings.extend(mixed_robots(text, reading));
        Ok(parsed)
    }

    fn parse_split(&self, text: &str, reading: &Reading) -> Result<Vec<Parsed>> {
        let explained = |error| explain(error, text, reading);
        let (table, samples) = samples(text, reading)?;
        samples
            .finish_split(&table.layout, &table.warnings)
            .map_err(explained)
    }

    fn order(&self, text: &str, reading: &Reading) -> QuaternionOrder {
        let columns = self.columns(text, reading);
        let place = |role: Role| columns.iter().position(|name| *name == reading.label(role));
        let by_name = if place(Role::Qw) < place(Role::Qx) {
            QuaternionOrder::Wxyz
        } else {
            QuaternionOrder::Xyzw
        };
        reading.quaternion.unwrap_or(by_name)
    }

    fn columns<'a>(&self, text: &'a str, reading: &Reading) -> Vec<&'a str> {
        // Errors in the header are reported when the samples are read.
        let header = header_line(&mut text.lines().enumerate(), reading);
        header.map_or_else(Vec::new, |(_, line)| cells_of(line))
    }

    fn applied(&self, text: &str, reading: &Reading) -> Reading {
        let mut applied = Reading {
            topic: None,
            command_topic: None,
            child_frame: None,
            ..reading.clone()
        };
        let columns = self.columns(text, reading);
        let is_mapped = |column: &str| columns.contains(&column);
        if !reading.columns.is_empty() && !reading.columns.iter().any(|(_, c)| is_mapped(&c.name)) {
            // Units that are stated beside columns are those of a file with these columns.
            applied.columns = Columns::default();
            (applied.length, applied.scale) = (None, None);
            (applied.time, applied.angle) = (None, None);
            applied.only = reading.only.clone().filter(|only| is_mapped(&only.column));
        }
        // A sampling rate is for files without times.
        let clock = Table::open(text, &applied, &[]).map(|table| table.layout.clock);
        if let Ok(Clock::Column(_) | Clock::TwoColumns(..)) = clock {
            applied.rate_hz = None;
        }
        applied
    }

    fn parse_groups(
        &self,
        text: &str,
        reading: &Reading,
        group_columns: &[&str],
    ) -> Result<Vec<(Vec<String>, Parsed)>> {
        let mut table = Table::open(text, reading, group_columns)?;
        let mut groups: Vec<(Vec<String>, Samples)> = Vec::new();
        let mut index_of: HashMap<Vec<String>, usize> = HashMap::new();
        let mut current: Option<usize> = None;
        let key_columns = table.group_columns.clone();
        while let Some((line, cells)) = table.rows.next()? {
            let value = |&column: &usize| cells.get(column).map_or("", |cell: &Cell<'_>| cell.text);
            let same = current.is_some_and(|index| {
                let values = key_columns.iter().map(value);
                groups[index].0.iter().map(String::as_str).eq(values)
            });
            let index = match current {
                Some(index) if same => index,
                _ => {
                    let key: Vec<String> =
                        key_columns.iter().map(value).map(str::to_owned).collect();
                    *index_of.entry(key).or_insert_with_key(|key| {
                        groups.push((key.clone(), Samples::new(reading)));
                        groups.len() - 1
                    })
                }
            };
            current = Some(index);
            groups[index].1.push(&table.layout, cells, line)?;
        }
        if groups.is_empty() {
            return Err(table.rows.no_matching_robot().unwrap_or_else(|| {
                Error::invalid("too few points for a trajectory")
                    .at_line(1, 1)
                    .found("no sample")
                    .allowed("at least 2 samples")
            }));
        }
        let mut parsed = Vec::with_capacity(groups.len());
        for (key, samples) in groups {
            let group = samples
                .finish(&table.layout, table.warnings.clone())
                .map_err(|error| error.field(format!("group {}", key.join("/"))))?;
            parsed.push((key, group));
        }
        Ok(parsed)
    }

    fn render(&self, trajectory: &Trajectory) -> Result<Rendered> {
        Ok(Rendered {
            bytes: text_of(trajectory).into_bytes(),
            warnings: Vec::new(),
        })
    }
}

/// The text with a comment in place of a first line `sep=;`, which tells spreadsheets the separator. The line of names shows it, too.
fn without_separator_line(text: String) -> String {
    let first = text.lines().next().unwrap_or_default();
    let is_separator = first
        .trim_matches('"')
        .to_ascii_lowercase()
        .starts_with("sep=");
    match is_separator && first.trim_matches('"').chars().count() <= 5 {
        true => format!("#{}", &text[first.len()..]),
        false => text,
    }
}

/// A trajectory as CSV text, without any loss.
pub(super) fn text_of(trajectory: &Trajectory) -> String {
    let mut header = vec!["t_s", "x_m", "y_m"];
    let orientations = trajectory.orientations_world_from_body();
    let velocities = trajectory.velocities();
    if !trajectory.is_planar() {
        header.push("z_m");
    }
    if orientations.is_some() {
        header.extend(QUATERNION);
    }
    if velocities.is_some() {
        header.extend(["vx_m_s", "vy_m_s", "vz_m_s"]);
        header.extend(ANGULAR);
    }
    let mut text = header.join(",");
    for joint in trajectory.joints() {
        text.push_str(&format!(",{}_rad", joint.name));
        if joint.speeds_rad_s.is_some() {
            text.push_str(&format!(",{}_rad_s", joint.name));
        }
    }
    for signal in trajectory.signals() {
        text.push_str(&format!(",{}", signal.name));
    }
    text.push('\n');
    let dimensions = if trajectory.is_planar() { 2 } else { 3 };
    for (index, (time_s, position)) in trajectory
        .times_s()
        .iter()
        .zip(trajectory.positions_world_m())
        .enumerate()
    {
        push_number(&mut text, *time_s);
        let mut push = |value: f64| {
            text.push(',');
            push_number(&mut text, value);
        };
        position
            .iter()
            .take(dimensions)
            .copied()
            .for_each(&mut push);
        if let Some(q) = orientations.map(|all| all[index]) {
            [q.w, q.i, q.j, q.k].into_iter().for_each(&mut push);
        }
        if let Some([linear, angular]) = velocities {
            linear[index].iter().copied().for_each(&mut push);
            angular[index].iter().copied().for_each(&mut push);
        }
        for joint in trajectory.joints() {
            push(joint.angles_rad[index]);
            if let Some(speeds) = &joint.speeds_rad_s {
                push(speeds[index]);
            }
        }
        for signal in trajectory.signals() {
            push(signal.values[index]);
        }
        text.push('\n');
    }
    text
}

/// The header and all samples of a text.
fn samples<'a>(text: &'a str, reading: &Reading) -> Result<(Table<'a>, Samples)> {
    let mut table = Table::open(text, reading, &[])?;
    let mut samples = Samples::new(reading);
    while let Some((line, cells)) = table.rows.next()? {
        samples.push(&table.layout, cells, line)?;
    }
    if samples.is_empty()
        && let Some(error) = table.rows.no_matching_robot()
    {
        return Err(error);
    }
    Ok((table, samples))
}
