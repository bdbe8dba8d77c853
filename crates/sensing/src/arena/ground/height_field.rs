//! A height field: heights of the ground over a grid of points, with two triangles in every cell.

use std::fmt;

use super::super::rectangle_m;
use realgap_core::error::{Error, Result};

/// Heights over a rectangle, above the floor. Rows lie as in a picture seen from above: the first row is the one with the largest
/// y, and columns go along +x. A cell is divided by the diagonal from its lower left to its upper right corner in that picture.
#[derive(Clone, PartialEq)]
pub struct HeightField {
    /// Name of the file that it was read from.
    pub file: String,
    /// Checksum of the file's bytes.
    pub sha256: String,
    /// Middle of the rectangle, metres.
    pub centre_m: [f64; 2],
    /// Width along its own x and depth along its own y, metres.
    pub size_m: [f64; 2],
    /// Rotation about its middle counter-clockwise, radians.
    pub turn_rad: f64,
    rows: usize,
    columns: usize,
    heights_m: Vec<f64>,
}

impl fmt::Debug for HeightField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "HeightField({} x {}, {:?}, {:?}, {}, {})",
            self.rows, self.columns, self.centre_m, self.size_m, self.turn_rad, self.sha256
        )
    }
}

impl HeightField {
    /// The smallest and largest number of rows and of columns.
    pub const COUNTS: (usize, usize) = (2, 2000);
    /// The range of heights, metres.
    pub const HEIGHTS_M: (f64, f64) = (-100.0, 100.0);
    /// The range of width and depth, metres.
    pub const SIZES_M: (f64, f64) = (1e-3, 1e4);

    /// A height field over a rectangle whose middle is the origin.
    ///
    /// # Errors
    /// Too few or too many rows or columns, rows of different lengths, heights and sizes out of range.
    pub fn new(rows: &[Vec<f64>], size_m: [f64; 2]) -> Result<Self> {
        let columns = rows.first().map_or(0, Vec::len);
        let (few, many) = Self::COUNTS;
        for (what, count) in [("rows", rows.len()), ("columns", columns)] {
            if !(few..=many).contains(&count) {
                return Err(
                    Error::invalid(format!("not a number of {what} of a height field"))
                        .found(format!("{} x {columns} heights", rows.len()))
                        .allowed(format!("{few} to {many} rows and columns")),
                );
            }
        }
        for (index, row) in rows.iter().enumerate() {
            if row.len() != columns {
                return Err(
                    Error::invalid("the rows of a height field differ in length")
                        .found(format!("{} heights in row {}", row.len(), index + 1))
                        .allowed(format!("{columns} heights, as in the first row")),
                );
            }
            let (low, high) = Self::HEIGHTS_M;
            let mut wrong = row.iter().enumerate();
            if let Some((column, value)) = wrong.find(|(_, v)| !(low..=high).contains(*v)) {
                return Err(Error::invalid("not a height")
                    .found(format!(
                        "{value} m in row {}, column {}",
                        index + 1,
                        column + 1
                    ))
                    .allowed(format!("{low} to {high} m")));
            }
        }
        let (least_m, most_m) = Self::SIZES_M;
        if !size_m.iter().all(|size| (least_m..=most_m).contains(size)) {
            return Err(Error::invalid("not a size of a height field")
                .field("size_m")
                .found(format!("{size_m:?} m"))
                .allowed(format!("{least_m} to {most_m} m")));
        }
        Ok(Self {
            file: String::new(),
            sha256: String::new(),
            centre_m: [0.0; 2],
            size_m,
            turn_rad: 0.0,
            rows: rows.len(),
            columns,
            heights_m: rows.concat(),
        })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Height of a point of the grid, metres.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.heights_m[row * self.columns + column]
    }

    /// Place of a point of the grid in the rectangle's own frame, whose origin is its middle, metres.
    pub fn place_m(&self, row: usize, column: usize) -> [f64; 2] {
        let share = |index: usize, count: usize| index as f64 / (count - 1) as f64 - 0.5;
        [
            self.size_m[0] * share(column, self.columns),
            -self.size_m[1] * share(row, self.rows),
        ]
    }

    /// The corners of the rectangle, seen from above, metres.
    pub fn outline_m(&self) -> [[f64; 2]; 4] {
        let (sin, cos) = self.turn_rad.sin_cos();
        rectangle_m(
            self.centre_m,
            self.size_m.map(|size| 0.5 * size),
            [cos, sin],
        )
    }

    /// A point seen in the rectangle's own frame.
    pub fn own_m(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn_rad.sin_cos();
        let (dx, dy) = (x - self.centre_m[0], y - self.centre_m[1]);
        [cos * dx + sin * dy, cos * dy - sin * dx]
    }

    /// Whether a point lies over the rectangle.
    pub fn covers(&self, point_m: [f64; 2]) -> bool {
        let [x, y] = self.own_m(point_m);
        x.abs() <= 0.5 * self.size_m[0] && y.abs() <= 0.5 * self.size_m[1]
    }

    /// Smallest and largest height, metres.
    pub fn range_m(&self) -> (f64, f64) {
        let heights = || self.heights_m.iter().copied();
        (
            heights().fold(f64::INFINITY, f64::min),
            heights().fold(f64::NEG_INFINITY, f64::max),
        )
    }

    /// Height of the surface at a point, metres; `None` beside the rectangle.
    pub fn height_m(&self, point_m: [f64; 2]) -> Option<f64> {
        if !self.covers(point_m) {
            return None;
        }
        let [x, y] = self.own_m(point_m);
        let cell = |share: f64, count: usize| {
            let at = (share + 0.5) * (count - 1) as f64;
            let first = (at.floor().max(0.0) as usize).min(count - 2);
            (first, at - first as f64)
        };
        let (column, right) = cell(x / self.size_m[0], self.columns);
        let (row, down) = cell(-y / self.size_m[1], self.rows);
        let [a, b] = [self.at(row, column), self.at(row, column + 1)];
        let [c, d] = [self.at(row + 1, column), self.at(row + 1, column + 1)];
        // The diagonal joins the corners b and c.
        Some(if right + down <= 1.0 {
            a + (b - a) * right + (c - a) * down
        } else {
            d + (c - d) * (1.0 - right) + (b - d) * (1.0 - down)
        })
    }

    /// The largest height within a distance of a point along both axes, metres; `None` if the field is farther away.
    pub fn highest_m(&self, point_m: [f64; 2], reach_m: f64) -> Option<f64> {
        let [x, y] = self.own_m(point_m);
        let range = |share: f64, reach: f64, count: usize| {
            let cells = (count - 1) as f64;
            let (low, high) = ((share - reach + 0.5) * cells, (share + reach + 0.5) * cells);
            (low <= cells && high >= 0.0)
                .then(|| (low.floor().max(0.0) as usize)..=(high.ceil().min(cells) as usize))
        };
        let columns = range(x / self.size_m[0], reach_m / self.size_m[0], self.columns)?;
        let rows = range(-y / self.size_m[1], reach_m / self.size_m[1], self.rows)?;
        let heights = rows.flat_map(|row| columns.clone().map(move |column| self.at(row, column)));
        Some(heights.fold(f64::NEG_INFINITY, f64::max))
    }

    /// The same surface, seen from a frame that is turned by an angle and moved: `place` is where the present origin is, and
    /// `turn_rad` how far the present x axis is turned, in the new frame.
    #[must_use]
    pub fn moved(&self, place_m: [f64; 2], turn_rad: f64) -> Self {
        let (sin, cos) = turn_rad.sin_cos();
        let [x, y] = self.centre_m;
        Self {
            centre_m: [
                place_m[0] + cos * x - sin * y,
                place_m[1] + sin * x + cos * y,
            ],
            turn_rad: self.turn_rad + turn_rad,
            ..self.clone()
        }
    }
}
