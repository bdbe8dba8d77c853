//! MAP-Elites: the best robot of every kind of behaviour.
//!
//! J.-B. Mouret and J. Clune, "Illuminating search spaces by mapping elites", arXiv 1504.04909, 2015.

use rand::RngExt as _;
use serde::{Deserialize, Serialize};

use super::{Evaluated, Strategy, Variation};
use crate::robot::genome::Genome;
use crate::search::generator;
use crate::{Error, Result};

/// One axis of an archive: a behaviour descriptor cut into equal cells. Values beyond the ends belong to the end cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// What is described, with its unit, e.g. `height_m`.
    pub name: String,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Number of cells, 1 or more.
    pub cells: usize,
}

impl Axis {
    /// The cell of a value; `None` for NaN.
    pub fn cell(&self, value: f64) -> Option<usize> {
        if value.is_nan() {
            return None;
        }
        let share = (value - self.from) / (self.to - self.from);
        let cell = (share * self.cells as f64).floor().max(0.0) as usize;
        Some(cell.min(self.cells - 1))
    }
}

/// Random robots first, then children of the elites of randomly chosen cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapElites {
    /// The axes of the archive, at least one.
    pub axes: Vec<Axis>,
    /// Random robots at the beginning.
    pub initial: usize,
    /// Robots proposed at once after that.
    pub batch: usize,
    /// Robots of the whole search.
    pub evaluations: usize,
    /// How children are made.
    #[serde(default)]
    pub variation: Variation,
    /// Seed of every random choice.
    #[serde(default)]
    pub seed: u64,
}

/// The elites of every cell, by index into the history.
#[derive(Debug, Clone, PartialEq)]
pub struct Archive {
    cells: Vec<Option<usize>>,
}

impl Archive {
    /// Index into the history of the elite of each cell; the first axis runs fastest.
    pub fn cells(&self) -> &[Option<usize>] {
        &self.cells
    }

    /// The elites, in the order of the cells.
    pub fn elites(&self) -> Vec<usize> {
        self.cells.iter().filter_map(|cell| *cell).collect()
    }
}

/// Most cells of one archive.
const CELLS_AT_MOST: usize = 1_000_000;

impl MapElites {
    /// Checks every setting.
    ///
    /// # Errors
    /// The first that cannot be used.
    pub fn check(&self) -> Result<()> {
        if self.axes.is_empty() {
            return Err(Error::invalid("an archive without descriptors")
                .field("axes")
                .allowed("at least one axis")
                .hint(
                    "name what tells robots apart, e.g. the number of modules and of driven faces",
                ));
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let span = axis.to - axis.from;
            if !(span.is_finite() && span > 0.0) || axis.cells == 0 {
                return Err(Error::invalid("not a usable axis")
                    .field(format!("axes[{index}]"))
                    .found(format!(
                        "{} cells from {} to {}",
                        axis.cells, axis.from, axis.to
                    ))
                    .allowed("at least one cell, `from` below `to`, both finite"));
            }
        }
        let cells = self
            .axes
            .iter()
            .try_fold(1_usize, |all, axis| all.checked_mul(axis.cells));
        if cells.is_none_or(|cells| cells > CELLS_AT_MOST) {
            return Err(Error::invalid("too many cells")
                .field("axes")
                .allowed(format!("at most {CELLS_AT_MOST} in all")));
        }
        for (field, value) in [
            ("initial", self.initial),
            ("batch", self.batch),
            ("evaluations", self.evaluations),
        ] {
            if value == 0 {
                return Err(Error::invalid("must not be 0")
                    .field(field)
                    .found(value)
                    .allowed("1 or more"));
            }
        }
        self.variation.check()
    }

    /// The archive after a history. Failures, and robots without a number for every axis, are in no cell; of
    /// equals the earlier stays.
    ///
    /// # Errors
    /// As [`MapElites::check`].
    pub fn archive(&self, history: &[Evaluated]) -> Result<Archive> {
        self.check()?;
        let count = self.axes.iter().map(|axis| axis.cells).product();
        let mut cells: Vec<Option<usize>> = vec![None; count];
        for (index, evaluated) in history.iter().enumerate() {
            let fitness = evaluated.comparable();
            let Some(cell) = self.cell(&evaluated.descriptors) else {
                continue;
            };
            let is_better = cells[cell].is_none_or(|held| fitness > history[held].comparable());
            if fitness > f64::NEG_INFINITY && is_better {
                cells[cell] = Some(index);
            }
        }
        Ok(Archive { cells })
    }

    fn cell(&self, descriptors: &[f64]) -> Option<usize> {
        if descriptors.len() != self.axes.len() {
            return None;
        }
        let mut cell = 0;
        for (axis, &value) in self.axes.iter().zip(descriptors).rev() {
            cell = cell * axis.cells + axis.cell(value)?;
        }
        Some(cell)
    }
}

impl Strategy for MapElites {
    fn propose(&self, history: &[Evaluated]) -> Result<Vec<Genome>> {
        self.check()?;
        if history.len() >= self.evaluations {
            return Ok(Vec::new());
        }
        let (step, done, size) = match history.len().checked_sub(self.initial) {
            None => (0, history.len(), self.initial),
            Some(later) => (1 + later / self.batch, later % self.batch, self.batch),
        };
        let mut rng = generator(self.seed, step as u64);
        // What the batch knew when it began, however much of it is done.
        let known = &history[..history.len() - done];
        let elites = self.archive(known)?.elites();
        let mut batch = Vec::with_capacity(size);
        for _ in 0..size {
            // As long as everything fails, keep on drawing.
            batch.push(if elites.is_empty() {
                self.variation.random(&mut rng)?
            } else {
                let first = elites[rng.random_range(0..elites.len())];
                let second = elites[rng.random_range(0..elites.len())];
                let (first, second) = (&known[first].genome, &known[second].genome);
                self.variation.child(first, second, &mut rng)?
            });
        }
        let left = self.evaluations - known.len();
        batch.truncate(left);
        Ok(batch.split_off(done))
    }
}
