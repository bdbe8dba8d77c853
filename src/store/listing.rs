//! The trials of a results folder as a table, for people and other programs.

use std::path::Path;

use super::database::Store;
use crate::error::{Advice, Error, Result};
use crate::file::unknown_name;

/// One trial of a [`Listing`].
#[derive(Debug, Clone, PartialEq)]
pub struct ListedTrial {
    /// Index of the trial.
    pub trial: usize,
    /// Parameter values, in the listing's order.
    pub values: Vec<f64>,
    /// Why it diverged; `None` where it ran to its end.
    pub diverged: Option<String>,
    /// Mean score over the fitted recordings; `None` where it diverged, or where no run has scored it yet.
    pub score: Option<f64>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
    /// Score against each recording; empty where there is no score.
    pub recordings: Vec<f64>,
}

/// Everything that a store says about its trials, without the study's files.
#[derive(Debug, Clone, PartialEq)]
pub struct Listing {
    /// Name of the study.
    pub study: String,
    /// `sweep`, `tune` or `search`.
    pub kind: String,
    /// True where the run came to its end.
    pub complete: bool,
    /// Name of the metric.
    pub metric: String,
    /// Unit of the scores.
    pub unit: String,
    /// Parameters, in the order of the values.
    pub parameters: Vec<String>,
    /// Recordings, in the order of the scores.
    pub recordings: Vec<String>,
    /// The trials, by index.
    pub trials: Vec<ListedTrial>,
}

impl Listing {
    /// Reads the results in `folder`; a writer may be at work at the same time.
    ///
    /// # Errors
    /// No readable results there.
    pub fn read(folder: &Path) -> Result<Self> {
        let store = Store::read(folder)?;
        let described = store.description()?;
        let text = |name: &str| described.get(name).cloned().unwrap_or_default();
        let list = |name: &str| -> Result<Vec<String>> {
            serde_json::from_str(&text(name)).map_err(|e| {
                Error::invalid(format!("the results do not explain themselves: {e}"))
                    .at_file(folder)
                    .field(name)
                    .advise(Advice::Restart)
            })
        };
        let mut scores: std::collections::BTreeMap<usize, _> = store
            .scores()?
            .into_iter()
            .map(|score| (score.index, score))
            .collect();
        let trials = store.trials()?.into_iter().map(|trial| {
            let diverged = trial.diverged().map(str::to_owned);
            let scored = scores.remove(&trial.index);
            ListedTrial {
                trial: trial.index,
                diverged,
                score: scored.as_ref().and_then(|s| s.score),
                displacement_error_m: scored.as_ref().and_then(|s| s.displacement_error_m),
                recordings: scored.map(|s| s.recordings).unwrap_or_default(),
                values: trial.values,
            }
        });
        Ok(Self {
            study: text("study"),
            kind: text("kind"),
            complete: store.is_complete()?,
            metric: text("metric"),
            unit: text("unit"),
            parameters: list("parameters")?,
            recordings: list("recordings")?,
            trials: trials.collect(),
        })
    }

    /// The trials in the order of `column`, smallest first (scores: best first), those without a value last.
    ///
    /// # Errors
    /// A column that is not there.
    pub fn sorted(mut self, column: &str) -> Result<Self> {
        let key: Box<dyn Fn(&ListedTrial) -> f64> = match column {
            "trial" => Box::new(|trial| trial.trial as f64),
            "score" => Box::new(|trial| trial.score.unwrap_or(f64::INFINITY)),
            "displacement_error_m" => {
                Box::new(|trial| trial.displacement_error_m.unwrap_or(f64::INFINITY))
            }
            name => {
                let Some(place) = self.parameters.iter().position(|known| known == name) else {
                    let columns = ["score", "trial", "displacement_error_m"].into_iter();
                    let columns = columns.chain(self.parameters.iter().map(String::as_str));
                    return Err(unknown_name("column", name, columns)
                        .field("sort")
                        .into_usage());
                };
                Box::new(move |trial| trial.values[place])
            }
        };
        self.trials.sort_by(|a, b| key(a).total_cmp(&key(b)));
        Ok(self)
    }

    /// Names of the columns of [`Listing::cells`].
    pub fn columns(&self, per_recording: bool) -> Vec<String> {
        let mut columns = vec!["trial".to_owned()];
        columns.extend(self.parameters.iter().cloned());
        columns.extend(["score", "unit", "status", "displacement_error_m"].map(str::to_owned));
        if per_recording {
            columns.extend(self.recordings.iter().map(|name| format!("score {name}")));
        }
        columns
    }

    /// One row a trial.
    pub fn cells(&self, per_recording: bool) -> impl Iterator<Item = Vec<Cell>> + '_ {
        self.trials.iter().map(move |trial| {
            let mut row = vec![Cell::Whole(trial.trial as i64)];
            row.extend(trial.values.iter().map(|value| Cell::Number(Some(*value))));
            row.push(Cell::Number(trial.score));
            row.push(Cell::Text(self.unit.clone()));
            row.push(Cell::Text(match &trial.diverged {
                Some(why) => format!("diverged {why}"),
                None => "ok".to_owned(),
            }));
            row.push(Cell::Number(trial.displacement_error_m));
            if per_recording {
                let scores = (0..self.recordings.len()).map(|i| trial.recordings.get(i).copied());
                row.extend(scores.map(Cell::Number));
            }
            row
        })
    }
}

/// One value of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A whole number.
    Whole(i64),
    /// A number, or nothing.
    Number(Option<f64>),
    /// A text.
    Text(String),
}

impl Cell {
    /// As text: the shortest that reads back to the same bits; empty for nothing.
    pub fn text(&self) -> String {
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => number.map_or(String::new(), |number| number.to_string()),
            Self::Text(text) => text.clone(),
        }
    }

    /// As JSON.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Self::Whole(number) => serde_json::json!(number),
            Self::Number(number) => serde_json::json!(number),
            Self::Text(text) => serde_json::json!(text),
        }
    }
}
