//! Joins the joints of a log with commands and sensors of other topics into one table.

use super::message::{Column, Quantity};
use super::series::{AtTimes, Clock, Role, Series};
use super::stream::push_seconds;
use crate::trajectory::Reading;
use crate::trajectory::format::Decoded;
use crate::trajectory::joint_column::plain_name;
use crate::trajectory::text::push_number;
use realgap_core::error::{Advice, Error, Result};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// A table in the making: the times, and the columns with their names.
pub(super) struct Joined {
    clock: Clock,
    times_ns: Vec<i64>,
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
    /// Rows at which every topic says something.
    is_known: Vec<bool>,
    warnings: Vec<Warning>,
}

impl Joined {
    /// A table with the rows of measured joints.
    ///
    /// # Errors
    /// Joints without angles.
    pub(super) fn of_joints(series: &Series) -> Result<Self> {
        let clock = series.clock();
        let mut made = Self {
            clock,
            times_ns: series.times_ns(clock),
            names: Vec::new(),
            columns: Vec::new(),
            is_known: vec![true; series.rows.len()],
            warnings: Vec::new(),
        };
        let rows: AtTimes = (series.rows.iter())
            .map(|row| Some(row.values.clone()))
            .collect();
        made.add_states(series, &rows);
        let has_angles = made.names.iter().any(|name| is_angle(name));
        if !has_angles {
            return Err(Error::invalid("the joints of this topic have no angles")
                .field(&series.topic)
                .allowed("messages whose `position` is filled")
                .hint("record the topic of the joint state broadcaster"));
        }
        Ok(made)
    }

    /// A table with the rows of poses, whose first columns are already text.
    pub(super) fn at(clock: Clock, times_ns: Vec<i64>) -> Self {
        Self {
            clock,
            is_known: vec![true; times_ns.len()],
            times_ns,
            names: Vec::new(),
            columns: Vec::new(),
            warnings: Vec::new(),
        }
    }

    fn add(&mut self, name: String, values: Vec<f64>) {
        self.names.push(name);
        self.columns.push(values);
    }

    /// Adds measured angles, speeds and efforts, and what a controller reports as its reference. Speeds and efforts that are missing
    /// in a row, or 0 in all of them, count as not recorded.
    fn add_states(&mut self, series: &Series, rows: &AtTimes) {
        let mut left_out: Vec<String> = Vec::new();
        for (index, column) in series.columns.iter().enumerate() {
            let Column::Joint(joint, quantity) = column else {
                continue;
            };
            let joint = plain_name(joint);
            let values = column_of(rows, index);
            let is_any = values.iter().any(|value| !value.is_nan());
            let is_said = values.iter().any(|value| !value.is_nan() && *value != 0.0);
            let is_whole = !values.iter().any(|value| value.is_nan());
            let (name, is_used) = match quantity {
                Quantity::Angle => (format!("{joint}_rad"), is_any),
                Quantity::Speed => (format!("{joint}_rad_s"), is_whole && is_said),
                Quantity::Effort => (format!("{joint}_effort_nm"), is_whole && is_said),
                Quantity::Reference => (format!("{joint}_command_rad"), is_whole),
            };
            match is_used {
                true => self.add(name, values),
                false if is_said => left_out.push(name),
                false => {}
            }
        }
        if !left_out.is_empty() {
            self.warnings.push(Code::ColumnsIgnored.warning(format!(
                "rows of {} without a number: {}",
                series.topic,
                left_out.join(", ")
            )));
        }
    }

    /// Adds further measured joints of the same topic, interpolated.
    pub(super) fn add_joints(&mut self, series: &Series) {
        let rows = series.interpolated(self.clock, &self.times_ns);
        self.know(&rows);
        self.add_states(series, &rows);
    }

    /// Adds what a sensor measured, interpolated; a sensor whose columns are already there is left out with a warning.
    pub(super) fn add_sensor(&mut self, series: &Series) {
        let rows = series.interpolated(self.clock, &self.times_ns);
        let names: Vec<String> = series.columns.iter().map(own_name).collect();
        let is_twice = names.iter().any(|name| self.names.contains(name));
        let is_seen = rows.iter().any(Option::is_some);
        if is_twice || !is_seen {
            self.warnings.push(Code::ColumnsIgnored.warning(format!(
                "the topic {} is not used, because {}",
                series.topic,
                match is_twice {
                    true => "another one has the same frame",
                    false => "it has no messages while joints were recorded",
                }
            )));
            return;
        }
        self.know(&rows);
        for (index, name) in names.into_iter().enumerate() {
            self.add(name, column_of(&rows, index));
        }
    }

    /// Adds commands: the last one before each row.
    ///
    /// # Errors
    /// Numbers without names; commands at other times than the rows; a kind of command that the table already has.
    pub(super) fn add_commands(&mut self, series: &Series, reading: &Reading) -> Result<()> {
        let rows = series.held(self.clock, &self.times_ns);
        if !rows.iter().any(Option::is_some) {
            return Err(Error::invalid("commands begin after the last state")
                .field(&series.topic)
                .found(format!("{} messages", series.count))
                .allowed("commands and states of one clock")
                .advise(Advice::CommandTopic));
        }
        self.know(&rows);
        let columns = command_columns(series, &rows, reading)?;
        for (name, values) in columns {
            if self.names.contains(&name) {
                return Err(Error::invalid("two topics command the same joint")
                    .field(&series.topic)
                    .found(name)
                    .advise(Advice::CommandTopic));
            }
            self.add(name, values);
        }
        let how = match series.plans.is_empty() {
            true => "each command is held until the next one",
            false => "plans are followed from point to point",
        };
        self.warnings.push(Code::ReadAs.warning(format!(
            "commands are those of {} ({}); {how}",
            series.topic, series.kind
        )));
        let is_stamped = series.has_stamps() || series.plans.iter().any(|plan| plan.stamp_ns != 0);
        if self.clock.has_stamps && !is_stamped {
            let ms = self.clock.shift_ns as f64 * 1e-6;
            self.warnings.push(Code::ReadAs.warning(format!(
                "commands of {} have no times of their own: they have the times of recording, moved by {ms:.1} ms, the usual difference between the stamps of the states and the recorder's clock",
                series.topic
            )));
        }
        Ok(())
    }

    fn know(&mut self, rows: &AtTimes) {
        for (is_known, row) in self.is_known.iter_mut().zip(rows) {
            *is_known &= row.is_some();
        }
    }

    /// Names topics that are not read.
    pub(super) fn not_read(&mut self, topics: &[String]) {
        if !topics.is_empty() {
            self.warnings.push(
                Code::ColumnsIgnored
                    .warning(format!("topics that are not read: {}", topics.join("; "))),
            );
        }
    }

    /// The table as a text. `heads` are the first columns of each row beside the time, with their names first.
    ///
    /// # Errors
    /// No time at which all topics have messages.
    pub(super) fn table(mut self, heads: Option<(&str, &[String])>) -> Result<Decoded> {
        let left_out = self.is_known.iter().filter(|is_known| !**is_known).count();
        if left_out == self.is_known.len() && left_out > 0 {
            return Err(Error::invalid("the topics have no time in common")
                .found(counted(left_out, "row"))
                .allowed("commands, sensors and states of one clock")
                .advise(Advice::CommandTopic));
        }
        if left_out > 0 {
            self.warnings.push(Code::ReadAs.warning(format!(
                "{} left out (of {}), because not every topic has a message for these times",
                counted(left_out, "row"),
                self.is_known.len()
            )));
        }
        let mut text = String::from("t_s");
        if let Some((names, _)) = heads {
            text.push_str(names);
        }
        for name in &self.names {
            text.push(',');
            text.push_str(name);
        }
        text.push('\n');
        for (row, time_ns) in self.times_ns.iter().enumerate() {
            if !self.is_known[row] {
                continue;
            }
            push_seconds(&mut text, *time_ns);
            if let Some((_, cells)) = heads {
                text.push_str(&cells[row]);
            }
            for column in &self.columns {
                text.push(',');
                push_number(&mut text, column[row]);
            }
            text.push('\n');
        }
        Ok(Decoded {
            text,
            warnings: self.warnings,
        })
    }
}

fn is_angle(name: &str) -> bool {
    name.ends_with("_rad") && !name.ends_with("_command_rad")
}

fn column_of(rows: &AtTimes, index: usize) -> Vec<f64> {
    let value = |row: &Option<Vec<f64>>| row.as_ref().map_or(f64::NAN, |row| row[index]);
    rows.iter().map(value).collect()
}

fn own_name(column: &Column) -> String {
    match column {
        Column::Joint(joint, _) => plain_name(joint),
        Column::Named(name) => plain_name(name),
        Column::Numbered(index) => index.to_string(),
    }
}

/// The columns of a topic that is read as commands: of joints the first quantity that it states: angles, speeds, efforts.
fn command_columns(
    series: &Series,
    rows: &AtTimes,
    reading: &Reading,
) -> Result<Vec<(String, Vec<f64>)>> {
    let numbered = series.columns.iter();
    let numbered = numbered.filter(|column| matches!(column, Column::Numbered(_)));
    if numbered.count() > 0 {
        let stated = reading.lists.iter();
        let mut stated =
            stated.filter(|(topic, _)| super::stream::same_topic(topic, &series.topic));
        let names = stated.next().map(|(_, names)| names.as_slice());
        let names = names.unwrap_or_default();
        if names.len() != series.columns.len() {
            let found = counted(series.columns.len(), "number");
            return Err(Error::usage("the commands of this topic have no names")
                .field(&series.topic)
                .found(match names.len() {
                    0 => found,
                    count => format!("{found}, and {count} names"),
                })
                .allowed(format!(
                    "one name with a unit for each number: `lists: {{\"{}\": [\"JOINT_command_rad\", ...]}}` in `reading`",
                    series.topic
                )));
        }
        let names = names.iter().enumerate();
        return Ok(names
            .map(|(index, name)| (name.clone(), column_of(rows, index)))
            .collect());
    }
    if series.role == Role::Command && series.joints().is_empty() {
        let columns = series.columns.iter().enumerate();
        return Ok(columns
            .map(|(index, column)| match column {
                Column::Named(name) => (name.clone(), column_of(rows, index)),
                other => (own_name(other), column_of(rows, index)),
            })
            .collect());
    }
    let endings = [
        (Quantity::Reference, "_command_rad"),
        (Quantity::Angle, "_command_rad"),
        (Quantity::Speed, "_command_rad_s"),
        (Quantity::Effort, "_command_nm"),
    ];
    for (wanted, ending) in endings {
        let mut found = Vec::new();
        for (index, column) in series.columns.iter().enumerate() {
            let Column::Joint(joint, quantity) = column else {
                continue;
            };
            let is_known = |row: &Vec<f64>| !row[index].is_nan();
            if *quantity == wanted && rows.iter().flatten().all(is_known) {
                found.push((
                    format!("{}{ending}", plain_name(joint)),
                    column_of(rows, index),
                ));
            }
        }
        if !found.is_empty() {
            return Ok(found);
        }
    }
    Err(
        Error::invalid("the commands of this topic have rows without a number")
            .field(&series.topic)
            .allowed("angles, speeds or efforts in every message"),
    )
}
