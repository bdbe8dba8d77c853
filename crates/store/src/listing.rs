//! Lists the rows of a results folder as a table, for people and other programs.

use std::collections::BTreeMap;
use std::path::Path;

use super::database::Store;
use super::robot::{RobotOutcome, RobotRow};
use super::trial::{Trial, TrialScore};
use realgap_core::error::{Error, Result};
use realgap_core::file::unknown_name;

/// All information that a store holds about its rows; the files of the study or search are not needed.
#[derive(Debug, Clone, PartialEq)]
pub struct Listing {
    /// Name of the study or search.
    pub name: String,
    /// `sweep`, `tune` or `search`.
    pub kind: String,
    /// True if the run is complete.
    pub complete: bool,
    /// The number of rows that the run will have, as far as it is known.
    pub asked: Option<usize>,
    /// The criterion for the best row: the metric that is minimised, or the objective that is maximised.
    pub measure: String,
    /// The columns of the table.
    pub columns: Vec<Column>,
    /// The rows, sorted by index, with one cell per column.
    pub rows: Vec<Vec<Cell>>,
    /// Name of the column by which the best row is chosen.
    best: String,
}

/// A column of a [`Listing`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name of the column; it ends with the unit if the column has its own unit.
    pub name: String,
    /// Kind of value in the cells.
    pub kind: ColumnKind,
    /// True for a column that most readers do not need: a score against a single recording.
    pub is_detail: bool,
}

/// The kind of value in the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Whole numbers ([`Cell::Whole`]).
    Whole,
    /// Numbers that may be missing ([`Cell::Number`]).
    Number,
    /// Texts ([`Cell::Text`]).
    Text,
}

/// One value of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A whole number.
    Whole(i64),
    /// A number; `None` if it is missing.
    Number(Option<f64>),
    /// A text.
    Text(String),
}

impl Cell {
    /// The value as text: for a number, the shortest text that is parsed to the same bits; empty for a missing number.
    pub fn text(&self) -> String {
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => number.map_or(String::new(), |number| number.to_string()),
            Self::Text(text) => text.clone(),
        }
    }

    /// The value as JSON.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Self::Whole(number) => serde_json::json!(number),
            Self::Number(number) => serde_json::json!(number),
            Self::Text(text) => serde_json::json!(text),
        }
    }
}

/// The named texts of a store, which describe its rows.
struct Described<'a> {
    folder: &'a Path,
    entries: BTreeMap<String, String>,
}

impl Described<'_> {
    fn text(&self, name: &str) -> String {
        self.entries.get(name).cloned().unwrap_or_default()
    }

    fn list(&self, name: &str) -> Result<Vec<String>> {
        serde_json::from_str(&self.text(name)).map_err(|e| {
            Error::invalid(format!(
                "the description of the results cannot be read: {e}"
            ))
            .at_file(self.folder)
            .field(name)
        })
    }
}

fn column(name: impl Into<String>, kind: ColumnKind) -> Column {
    Column {
        name: name.into(),
        kind,
        is_detail: false,
    }
}

impl Listing {
    /// Reads the results in `folder`; another process may write into it at the same time.
    ///
    /// # Errors
    /// No readable results in the folder, or damaged results.
    pub fn read(folder: &Path) -> Result<Self> {
        if Store::<RobotRow>::is_in(folder)? {
            return Self::of_search(folder);
        }
        Self::of_study(folder)
    }

    fn of_study(folder: &Path) -> Result<Self> {
        let store = Store::<Trial>::read(folder)?;
        let described = Described {
            folder,
            entries: store.description()?,
        };
        let (parameters, recordings) =
            (described.list("parameters")?, described.list("recordings")?);
        let unit = described.text("unit");
        let mut columns = vec![column("trial", ColumnKind::Whole)];
        columns.extend(parameters.iter().map(|p| column(p, ColumnKind::Number)));
        columns.extend([
            column("score", ColumnKind::Number),
            column("unit", ColumnKind::Text),
            column("status", ColumnKind::Text),
            column("displacement_error_m", ColumnKind::Number),
        ]);
        columns.extend(recordings.iter().map(|name| Column {
            is_detail: true,
            ..column(format!("score {name}"), ColumnKind::Number)
        }));
        let scores = store.scores()?.into_iter();
        let mut scores: BTreeMap<usize, TrialScore> =
            scores.map(|score| (score.index, score)).collect();
        let rows = store.trials()?.into_iter().map(|trial| {
            let scored = scores.remove(&trial.index);
            let mut row = vec![Cell::Whole(trial.index as i64)];
            let values = (0..parameters.len()).map(|i| trial.values.get(i).copied());
            row.extend(values.map(Cell::Number));
            row.extend([
                Cell::Number(scored.as_ref().and_then(|s| s.score)),
                Cell::Text(unit.clone()),
                Cell::Text(match trial.diverged() {
                    Some(why) => format!("diverged {why}"),
                    None => "ok".to_owned(),
                }),
                Cell::Number(scored.as_ref().and_then(|s| s.displacement_error_m)),
            ]);
            let scores = scored.map(|s| s.recordings).unwrap_or_default();
            row.extend((0..recordings.len()).map(|i| Cell::Number(scores.get(i).copied())));
            row
        });
        Ok(Self {
            name: described.text("study"),
            kind: described.text("kind"),
            complete: store.is_complete()?,
            asked: store.asked(),
            measure: format!("metric {}", described.text("metric")),
            columns,
            rows: rows.collect(),
            best: "score".to_owned(),
        })
    }

    fn of_search(folder: &Path) -> Result<Self> {
        let store = Store::<RobotRow>::read(folder)?;
        let described = Described {
            folder,
            entries: store.description()?,
        };
        let names = described.list("descriptors")?;
        let unit = described.text("unit");
        let mut columns = vec![
            column("robot", ColumnKind::Whole),
            column("modules", ColumnKind::Whole),
            column("fitness", ColumnKind::Number),
            column("unit", ColumnKind::Text),
            column("status", ColumnKind::Text),
            column("mean_displacement_m", ColumnKind::Number),
        ];
        columns.extend(names.iter().map(|name| column(name, ColumnKind::Number)));
        let rows = store.rows()?.into_iter().map(|robot| {
            let (fitness, status, mean_m, descriptors) = match robot.outcome {
                RobotOutcome::Failed { reason, seen } => {
                    (None, format!("{reason} {seen}"), None, Vec::new())
                }
                RobotOutcome::Walked {
                    fitness,
                    repeats,
                    descriptors,
                } => {
                    let sum_m: f64 = repeats.iter().map(|travel| travel.displacement_m).sum();
                    let mean_m = sum_m / repeats.len() as f64;
                    (
                        Some(fitness),
                        "walked".to_owned(),
                        Some(mean_m),
                        descriptors,
                    )
                }
            };
            let mut row = vec![
                Cell::Whole(robot.index as i64),
                Cell::Whole(robot.genome.len() as i64 / 10),
                Cell::Number(fitness),
                Cell::Text(unit.clone()),
                Cell::Text(status),
                Cell::Number(mean_m),
            ];
            row.extend((0..names.len()).map(|i| Cell::Number(descriptors.get(i).copied())));
            row
        });
        Ok(Self {
            name: described.text("search"),
            kind: described.text("kind"),
            complete: store.is_complete()?,
            asked: store.asked(),
            measure: format!("objective {}", described.text("objective")),
            columns,
            rows: rows.collect(),
            best: "fitness".to_owned(),
        })
    }

    /// The table sorted by `column`, smallest value first (for fitness, largest first), rows without a value last. Without a column, the best
    /// row comes first.
    ///
    /// # Errors
    /// A column that does not exist, or that holds texts.
    pub fn sorted(mut self, column: Option<&str>) -> Result<Self> {
        let name = column.unwrap_or(&self.best);
        let sortable = |c: &&Column| c.kind != ColumnKind::Text && !c.is_detail;
        let place = self
            .columns
            .iter()
            .position(|known| known.name == name && sortable(&known));
        let Some(place) = place else {
            let known = self.columns.iter().filter(sortable);
            let known = known.map(|c| c.name.as_str());
            return Err(unknown_name("column", name, known)
                .field("sort")
                .into_usage());
        };
        let sign = if name == "fitness" { -1.0 } else { 1.0 };
        let key = |row: &Vec<Cell>| match &row[place] {
            Cell::Whole(number) => *number as f64,
            Cell::Number(Some(number)) => sign * number,
            Cell::Number(None) | Cell::Text(_) => f64::INFINITY,
        };
        self.rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
        Ok(self)
    }

    /// The table without the columns that are details.
    #[must_use]
    pub fn without_details(mut self) -> Self {
        let keep: Vec<bool> = self.columns.iter().map(|c| !c.is_detail).collect();
        for row in &mut self.rows {
            let mut kept = keep.iter();
            row.retain(|_| kept.next().copied().unwrap_or(true));
        }
        self.columns.retain(|column| !column.is_detail);
        self
    }
}
