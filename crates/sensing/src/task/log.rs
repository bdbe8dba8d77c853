//! Reads logs of task times.

use std::path::Path;

use realgap_core::error::{Error, Result};
use realgap_core::file::{LogTable, read_log_text};
use realgap_core::statistics::Duration;
use realgap_core::text::shown;
use realgap_core::warning::{Code, Warning};

/// One trial of a task.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The level of each factor, in the order of [`TaskLog::factors`].
    pub levels: Vec<String>,
    /// Time until the task was finished or given up.
    pub duration: Duration,
}

/// Trials of a task.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskLog {
    /// Names of the columns that state the conditions of a trial.
    pub factors: Vec<String>,
    /// The trials, in the order of the log.
    pub trials: Vec<Trial>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// Names of columns that number trials and are not conditions.
const NUMBERS: [&str; 8] = [
    "trial",
    "run",
    "subject",
    "participant",
    "operator",
    "id",
    "repeat",
    "session",
];
/// Durations above this (a week) give a warning, because they are probably not in seconds.
const LONG_S: f64 = 604_800.0;
/// Durations above this (thirty years) are refused.
const LONGEST_S: f64 = 1e9;

impl TaskLog {
    /// Reads a log.
    ///
    /// # Errors
    /// A missing file, no column `duration_s`, durations that are not above 0 or are above thirty years, a `finished` that is neither
    /// yes nor no, no rows.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(path, &read_log_text(path)?)
    }

    /// Parses a log from a text; errors name it by `path`.
    ///
    /// # Errors
    /// As [`TaskLog::read`].
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        let path = path.as_ref();
        let table = LogTable::parse(path, text)?;
        let hint = "a log of task times has the column duration_s (seconds), the column finished (1 or 0) if some trials were given up, and any columns \
             that name conditions";
        let duration = table.require("duration_s", hint)?;
        let finished = table.column("finished");
        let factors: Vec<usize> = (0..table.header().len())
            .filter(|column| *column != duration && Some(*column) != finished)
            .filter(|column| !NUMBERS.contains(&table.header()[*column].as_str()))
            .collect();
        let mut trials = Vec::with_capacity(table.row_count());
        for row in 0..table.row_count() {
            let time_s = table.number(row, duration)?;
            if !(time_s > 0.0 && time_s <= LONGEST_S) {
                let error = Error::invalid("not a duration")
                    .field("duration_s")
                    .found(time_s)
                    .allowed(format!("seconds above 0, at most {LONGEST_S}"));
                return Err(table.at(row, error));
            }
            let finished = match finished.map(|column| table.text(row, column)) {
                None | Some("1" | "true" | "yes") => true,
                Some("0" | "false" | "no") => false,
                Some(other) => {
                    let error = Error::invalid("neither finished nor given up")
                        .field("finished")
                        .found(shown(other, 40))
                        .allowed("1 or 0, true or false, yes or no");
                    return Err(table.at(row, error));
                }
            };
            trials.push(Trial {
                levels: factors
                    .iter()
                    .map(|c| table.text(row, *c).to_owned())
                    .collect(),
                duration: Duration { time_s, finished },
            });
        }
        if trials.is_empty() {
            return Err(Error::invalid("the log has no trials").at_file(path));
        }
        let mut warnings = Vec::new();
        if trials.iter().any(|t| t.duration.time_s > LONG_S) {
            warnings.push(Code::LongTask.warning(format!(
                "{}: a task of more than a week; durations are read as seconds",
                path.display()
            )));
        }
        Ok(Self {
            factors: factors.iter().map(|c| table.header()[*c].clone()).collect(),
            trials,
            warnings,
        })
    }

    /// The durations of the trials with these levels of these factors.
    pub(super) fn durations(&self, wanted: &[(&str, &str)]) -> Vec<Duration> {
        let is_wanted = |trial: &&Trial| {
            wanted.iter().all(|(factor, level)| {
                let column = self.factors.iter().position(|name| name == factor);
                column.is_some_and(|column| trial.levels[column] == *level)
            })
        };
        self.trials
            .iter()
            .filter(is_wanted)
            .map(|t| t.duration)
            .collect()
    }
}
