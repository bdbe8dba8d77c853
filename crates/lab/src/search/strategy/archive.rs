//! An archive: the best robot of every cell of behaviour.

use serde::{Deserialize, Serialize};

use super::Evaluated;

/// One axis of an archive: a behaviour descriptor cut into equal cells. Values beyond the ends belong to the end cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Name of the descriptor, with its unit, e.g. `height_m`.
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

/// The elites of every cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Archive {
    axes: Vec<Axis>,
    cells: Vec<Option<usize>>,
}

impl Archive {
    /// The archive after a history. Failures, and robots without a number for every axis, belong to no cell; of equals the
    /// earlier one stays.
    pub fn new(axes: &[Axis], history: &[Evaluated]) -> Self {
        let count = axes.iter().map(|axis| axis.cells).product();
        let mut cells: Vec<Option<usize>> = vec![None; count];
        for (index, evaluated) in history.iter().enumerate() {
            let fitness = evaluated.comparable();
            let Some(cell) = cell_of(axes, &evaluated.descriptors) else {
                continue;
            };
            let is_better = cells[cell].is_none_or(|held| fitness > history[held].comparable());
            if fitness > f64::NEG_INFINITY && is_better {
                cells[cell] = Some(index);
            }
        }
        Self {
            axes: axes.to_vec(),
            cells,
        }
    }

    /// The axes; the first runs fastest.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Index into the history of the elite of each cell.
    pub fn cells(&self) -> &[Option<usize>] {
        &self.cells
    }

    /// The elites in the order of their cells: place of the cell along each axis, and index into the history.
    pub fn elites(&self) -> Vec<(Vec<usize>, usize)> {
        let cells = self.cells.iter().enumerate();
        cells
            .filter_map(|(cell, elite)| Some((self.along(cell), (*elite)?)))
            .collect()
    }

    fn along(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let places = self.axes.iter().map(|axis| {
            let here = rest % axis.cells;
            rest /= axis.cells;
            here
        });
        places.collect()
    }
}

fn cell_of(axes: &[Axis], descriptors: &[f64]) -> Option<usize> {
    if descriptors.len() != axes.len() {
        return None;
    }
    let mut cell = 0;
    for (axis, &value) in axes.iter().zip(descriptors).rev() {
        cell = cell * axis.cells + axis.cell(value)?;
    }
    Some(cell)
}
