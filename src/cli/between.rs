//! The options of `realgap gap` that compare two sets of recorded runs without a simulator.

use realgap::RunOptions;
use realgap::calibration::Overrides;
use realgap::prediction::gap::{Between, Sample, Scoring, read_sets};

use super::kit::*;

/// Two sets of runs.
#[derive(Debug, Args)]
pub struct TwoSets {
    /// Recorded runs of the first set, compared with those of --and without a simulator: files or globs
    #[arg(
        long,
        num_args = 1..,
        value_name = "GLOB",
        requires = "and",
        conflicts_with = "study"
    )]
    between: Vec<String>,
    /// Recorded runs of the second set: files or globs
    #[arg(
        long,
        num_args = 1..,
        value_name = "GLOB",
        requires = "between",
        conflicts_with = "study"
    )]
    and: Vec<String>,
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
        let runs = |globs: &Vec<String>| -> Result<Vec<Sample>> {
            let overrides = Overrides {
                recordings: globs.clone(),
                ..overrides.clone()
            };
            let sets = read_sets(&overrides, None)?;
            Ok(sets.into_iter().flat_map(|set| set.runs).collect())
        };
        let (first, second) = (runs(&self.between)?, runs(&self.and)?);
        run.install(|| Between::repeats(&first, &second, scoring))?
    }
}
