//! The options of `realgap gap` that compare two sets of recorded runs without a simulator.

use realgap::RunOptions;
use realgap::calibration::Overrides;
use realgap::prediction::gap::{Between, Sample, Scoring, read_sets};

use super::kit::*;

/// Default length of a window, seconds.
const WINDOW_S: f64 = 0.4;

/// Two sets of runs, and the commands in which their windows are alike.
#[derive(Debug, Args)]
pub struct TwoSets {
    /// Recorded runs of the first set, compared with those of --and without a simulator; quote the glob (repeatable)
    #[arg(long, value_name = "GLOB", requires = "and", conflicts_with = "study")]
    between: Vec<String>,
    /// Recorded runs of the second set; quote the glob (repeatable)
    #[arg(
        long,
        value_name = "GLOB",
        requires = "between",
        conflicts_with = "study"
    )]
    and: Vec<String>,
    /// Column of a command: windows that are alike in start and in these commands are compared in place of whole runs (repeatable)
    #[arg(long, value_name = "COLUMN", requires = "between")]
    command: Vec<String>,
    /// Length of a window, seconds [default: 0.4]
    #[arg(long, value_name = "S", requires = "command")]
    window: Option<f64>,
}

impl TwoSets {
    /// Whether two sets are to be compared.
    pub fn is_given(&self) -> bool {
        !self.between.is_empty()
    }

    /// Reads the sets and compares them.
    pub fn compare(
        &self,
        overrides: &Overrides,
        scoring: &Scoring,
        run: &RunOptions<'_>,
    ) -> Result<Between> {
        let mut reading = overrides.reading.clone();
        reading.unitless.extend(self.command.iter().cloned());
        let runs = |globs: &Vec<String>| -> Result<Vec<Sample>> {
            let overrides = Overrides {
                recordings: globs.clone(),
                reading: reading.clone(),
                ..overrides.clone()
            };
            let sets = read_sets(&overrides, None)?;
            Ok(sets.into_iter().flat_map(|set| set.runs).collect())
        };
        let (first, second) = (runs(&self.between)?, runs(&self.and)?);
        let window_s = self.window.unwrap_or(WINDOW_S);
        run.install(|| match self.command.is_empty() {
            true => Between::repeats(&first, &second, scoring),
            false => Between::windows(&first, &second, &self.command, window_s, scoring.seed),
        })?
    }
}
