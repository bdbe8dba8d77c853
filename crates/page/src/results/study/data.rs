//! What charts and pages show of a sweep or a tuning, as values: points with their paths, profiles, trials and joints.
//!
//! A command makes these values from its answer, `realgap report` from the files of the folder. Both come out the same,
//! because both go through the same tables.

use std::path::Path;

use super::joint::{self, JointSample};
use super::table;
use crate::results::kind::file;
use crate::results::table::CsvTable;
use realgap_core::error::{Error, Result};
use realgap_lab::calibration::{Answer, Method, Study};
use realgap_store::{CaseRow, STORE_FILE, Store, Trial};

/// One point of a sweep or a tuning.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Point {
    /// Values of the parameters, in order.
    pub values: Vec<f64>,
    /// The mean score over its runs; `None` where the simulation diverged.
    pub score: Option<f64>,
    /// How many runs that is the mean of.
    pub runs: usize,
    /// The number of the setting of a single run, where there are several settings.
    pub setting: Option<u64>,
    /// The mean score over all equally valid settings, simulated or expected; `None` where it is not known.
    pub mean_score: Option<f64>,
    /// The 90 % interval of that mean.
    pub band: Option<(f64, f64)>,
    /// Mean absolute difference of the net displacements, metres.
    pub displacement_error_m: Option<f64>,
    /// Whether the point cannot be told from the best.
    pub is_indistinguishable: bool,
}

impl Point {
    /// The mean score over all equally valid settings as far as it is known, otherwise over the runs.
    pub(crate) fn mean(&self) -> Option<f64> {
        self.mean_score.or(self.score)
    }

    /// Whether the point was simulated with all equally valid settings, so that its mean is not only expected.
    pub(crate) fn is_settled(&self) -> bool {
        self.mean_score.is_some() && self.mean_score == self.score
    }
}

/// The points, in the order of `points.csv`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Points {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// The points.
    pub points: Vec<Point>,
}

/// The lowest score along one parameter.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ProfileCurve {
    /// Name of the parameter.
    pub parameter: String,
    /// Values of the parameter, increasing.
    pub values: Vec<f64>,
    /// The lowest score to be expected at each value.
    pub scores: Vec<f64>,
    /// The range that holds that score with 90 %: lower and upper end.
    pub bands: [Vec<f64>; 2],
    /// Whether something at the value cannot be told from the best.
    pub indistinguishable: Vec<bool>,
}

/// One run that an optimizer asked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TrialRow {
    /// Whether it belongs to the space-filling first design.
    pub is_design: bool,
    /// Its score; `None` where it diverged.
    pub score: Option<f64>,
    /// The lowest score so far.
    pub best_so_far: Option<f64>,
}

/// A prepared path, metres.
pub(crate) type PathXy = Vec<[f64; 2]>;

/// What charts and pages show of a sweep or a tuning.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct StudyData {
    /// The points.
    pub points: Points,
    /// A stored path of every point, empty for a point without one; `None` where no paths are stored.
    pub paths: Option<Vec<PathXy>>,
    /// The lowest score along each parameter.
    pub profiles: Vec<ProfileCurve>,
    /// The runs of an optimizer in their order; empty for a sweep.
    pub trials: Vec<TrialRow>,
    /// Joints of the recordings beside those of the best point; empty where no joints were recorded.
    pub joints: Vec<JointSample>,
}

/// The tables that [`StudyData`] is made of.
#[derive(Debug, Clone, Default)]
pub(super) struct StudyTables {
    pub points: CsvTable,
    pub profiles: CsvTable,
    pub trials: CsvTable,
    pub joints: CsvTable,
}

impl StudyTables {
    /// The tables of an answer.
    ///
    /// # Errors
    /// A best point that cannot be simulated again.
    pub(super) fn new(study: &Study, answer: &Answer) -> Result<Self> {
        Ok(Self {
            points: table::points(study, answer),
            profiles: table::profiles(answer),
            trials: match &answer.method {
                Method::Sweep => CsvTable::default(),
                Method::Tune(tuned) => table::trials(study, answer, tuned),
            },
            joints: joint::table(study, answer)?,
        })
    }

    fn read(folder: &Path) -> Result<Self> {
        let read = |name: &str| CsvTable::read(folder, name);
        Ok(Self {
            points: read(file::POINTS)?,
            profiles: read(file::PROFILES)?,
            trials: read(file::TRIALS)?,
            joints: read(file::JOINTS)?,
        })
    }

    /// The values in the tables; `folder` is for the message.
    fn data(&self, folder: &Path) -> Result<StudyData> {
        let points = Points::in_folder(&self.points, folder)?;
        Ok(StudyData {
            points,
            paths: None,
            profiles: profiles(&self.profiles),
            trials: trials(&self.trials),
            joints: joint::samples(&self.joints),
        })
    }
}

impl StudyData {
    /// What an answer says, with its tables.
    ///
    /// # Errors
    /// None for tables of an answer.
    pub(super) fn of(answer: &Answer, tables: &StudyTables) -> Result<Self> {
        // A folder stores the runs that were asked for; what completes the settings of an optimizer's best is not there.
        let stored = match &answer.method {
            Method::Sweep => answer.scores.runs.as_slice(),
            Method::Tune(tuned) => table::asked_for(answer, tuned),
        };
        let runs = stored.iter().map(|run| StoredRun {
            values: &run.values,
            has_score: run.score.is_some(),
            path_xy_m: &run.path_xy_m,
        });
        let runs: Vec<StoredRun<'_>> = runs.collect();
        let data = tables.data(Path::new(""))?;
        Ok(data.with_paths(&runs))
    }

    /// What the files of a folder say.
    ///
    /// # Errors
    /// A file that is not what was written there; a damaged store.
    pub(crate) fn read(folder: &Path) -> Result<Self> {
        let data = StudyTables::read(folder)?.data(folder)?;
        if data.points.points.is_empty() || !folder.join(STORE_FILE).is_file() {
            return Ok(data);
        }
        let trials = Store::<Trial>::read(folder)?.trials()?;
        let runs = trials.iter().map(|trial| StoredRun {
            values: &trial.values,
            has_score: trial.diverged().is_none(),
            path_xy_m: (trial.cases.first())
                .and_then(CaseRow::completed)
                .map_or(&[], |result| result.path_xy_m.as_slice()),
        });
        let runs: Vec<StoredRun<'_>> = runs.collect();
        Ok(data.with_paths(&runs))
    }

    /// The same with the path of each point: that of its first run with a score, which is the run with the study's own
    /// settings or the nearest to it.
    fn with_paths(mut self, runs: &[StoredRun<'_>]) -> Self {
        let path = |point: &Point| {
            let own = || runs.iter().filter(|run| run.values == point.values);
            let run = own().find(|run| run.has_score).or(own().next());
            run.map_or_else(Vec::new, |run| run.path_xy_m.to_vec())
        };
        let paths: Vec<PathXy> = self.points.points.iter().map(path).collect();
        let is_any = paths.iter().any(|path| !path.is_empty());
        self.paths = is_any.then_some(paths);
        self
    }
}

/// One run as a folder stores it.
struct StoredRun<'a> {
    values: &'a [f64],
    has_score: bool,
    path_xy_m: &'a [[f64; 2]],
}

impl Points {
    /// The points of a table; the line of the first value that is no number as an error.
    pub(crate) fn of(table: &CsvTable) -> std::result::Result<Self, usize> {
        let Some(score) = table.column("score") else {
            return Ok(Self::default());
        };
        let [in_set, error, runs, setting] = [
            "indistinguishable",
            "displacement_error_m",
            "runs",
            "setting",
        ]
        .map(|n| table.column(n));
        let [mean, low, high] = ["mean_score", "low", "high"].map(|n| table.column(n));
        let point = |(index, row): (usize, &Vec<String>)| -> std::result::Result<Point, usize> {
            let values = row[..score].iter().map(|cell| cell.parse().ok());
            let values: Option<Vec<f64>> = values.collect();
            Ok(Point {
                values: values.ok_or(index + 2)?,
                score: row[score].parse().ok(),
                runs: runs.and_then(|at| row[at].parse().ok()).unwrap_or(1),
                setting: setting.and_then(|at| row[at].parse().ok()),
                mean_score: mean.and_then(|at| row[at].parse().ok()),
                band: low
                    .and_then(|at| row[at].parse().ok())
                    .zip(high.and_then(|at| row[at].parse().ok())),
                displacement_error_m: error.and_then(|column| row[column].parse().ok()),
                is_indistinguishable: in_set.is_some_and(|column| row[column] == "true"),
            })
        };
        let header = table.header();
        let names = header[..score].iter().map(|name| (*name).to_owned());
        Ok(Self {
            names: names.collect(),
            points: (table.rows().iter().enumerate())
                .map(point)
                .collect::<std::result::Result<_, _>>()?,
        })
    }

    /// As [`Points::of`]; the error names the file in this folder.
    fn in_folder(table: &CsvTable, folder: &Path) -> Result<Self> {
        Self::of(table).map_err(|line| {
            let error = Error::invalid("a value is not a number");
            error.at_file(folder.join(file::POINTS)).at_line(line, 1)
        })
    }

    /// The positions of the points, the best first: those that were simulated with all settings, then the others, each by their mean
    /// score. A mean that is only expected does not put a point above the best.
    pub(crate) fn ranked(&self) -> Vec<usize> {
        let key = |at: &usize| {
            let point = &self.points[*at];
            let mean = point.mean().unwrap_or(f64::INFINITY);
            (!point.is_settled(), mean)
        };
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        order
    }

    /// The position of the best point; `None` where no point has a score.
    pub(crate) fn lowest(&self) -> Option<usize> {
        let first = *self.ranked().first()?;
        self.points[first].mean().map(|_| first)
    }
}

/// The points of a sweep or a tuning, the best first.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedPoints {
    /// The names of the columns.
    pub header: Vec<String>,
    /// The rows as they stand in `points.csv`.
    pub rows: Vec<Vec<String>>,
}

/// The table of the points of a sweep or a tuning, the best first. `None` for a folder that has no means over settings.
///
/// # Errors
/// A file that cannot be read, or a value that is not a number.
pub fn ranked_points(folder: &Path) -> Result<Option<RankedPoints>> {
    let table = CsvTable::read(folder, file::POINTS)?;
    if table.column("mean_score").is_none() {
        return Ok(None);
    }
    let points = Points::in_folder(&table, folder)?;
    let header = table.header().into_iter().map(str::to_owned).collect();
    let rows = points.ranked().into_iter();
    let rows = rows.map(|position| table.rows()[position].clone());
    Ok(Some(RankedPoints {
        header,
        rows: rows.collect(),
    }))
}

/// The profiles of a table: its rows up to the next parameter are one curve.
fn profiles(table: &CsvTable) -> Vec<ProfileCurve> {
    let names = table.texts("parameter");
    let in_set = table.texts("indistinguishable");
    let columns = ["value", "lowest_score", "low", "high"].map(|name| table.numbers(name));
    let mut all: Vec<ProfileCurve> = Vec::new();
    for (row, name) in names.into_iter().enumerate() {
        if all.last().is_none_or(|last| last.parameter != name) {
            all.push(ProfileCurve {
                parameter: name.to_owned(),
                ..ProfileCurve::default()
            });
        }
        let [value, score, low, high] = columns
            .each_ref()
            .map(|column| column.get(row).copied().unwrap_or(f64::NAN));
        if let Some(curve) = all.last_mut() {
            curve.values.push(value);
            curve.scores.push(score);
            curve.bands[0].push(low);
            curve.bands[1].push(high);
            curve
                .indistinguishable
                .push(in_set.get(row) == Some(&"true"));
        }
    }
    all
}

/// The trials of a table.
fn trials(table: &CsvTable) -> Vec<TrialRow> {
    let scores = table.numbers("score").into_iter();
    let both = scores.zip(table.numbers("best_so_far"));
    let known = |value: f64| Some(value).filter(|value| value.is_finite());
    let rows = both.zip(table.texts("phase"));
    let rows = rows.map(|((score, best), phase)| TrialRow {
        is_design: phase == "design",
        score: known(score),
        best_so_far: known(best),
    });
    rows.collect()
}
