//! Integer lattice on which a robot is developed: cubes in cells, turned by quarter turns. The arithmetic is exact because all
//! coordinates are whole numbers.

use crate::morphology::Face;

/// A cell or a direction, in whole cells along x, y and z.
pub(super) type Cell = [i32; 3];

/// One module and its position on the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placed {
    pub(super) cell: Cell,
    /// Direction of the driven face; `None` for a passive module.
    pub(super) driven: Option<Cell>,
}

impl Placed {
    /// The cell in front of the driven face.
    pub(super) fn faced_cell(&self) -> Option<Cell> {
        self.driven.map(|direction| add(self.cell, direction))
    }

    pub(super) fn turned(self, about_x: usize, about_y: usize) -> Self {
        Self {
            cell: turn(self.cell, about_x, about_y),
            driven: self.driven.map(|d| turn(d, about_x, about_y)),
        }
    }
}

/// Right-handed quarter turns, first about x, then about y.
fn turn(cell: Cell, about_x: usize, about_y: usize) -> Cell {
    let cell = (0..about_x % 4).fold(cell, |[x, y, z], _| [x, -z, y]);
    (0..about_y % 4).fold(cell, |[x, y, z], _| [z, y, -x])
}

pub(super) fn add(a: Cell, b: Cell) -> Cell {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn direction(face: Face) -> Cell {
    let mut direction = [0; 3];
    direction[face.axis_index()] = match face {
        Face::PosX | Face::PosY | Face::PosZ => 1,
        Face::NegX | Face::NegY | Face::NegZ => -1,
    };
    direction
}

/// The face whose outward normal is a unit direction.
pub(super) fn face(towards: Cell) -> Option<Face> {
    Face::ALL
        .into_iter()
        .find(|&face| direction(face) == towards)
}

/// Index of the highest module of a column. `choose_x` selects the column's x, and `choose_y` its y among the columns at that x.
/// Every body has such a module, and the cell above it is always free.
pub(super) fn top_of_column(
    body: &[Placed],
    choose_x: impl Fn(usize) -> usize,
    choose_y: impl Fn(usize) -> usize,
) -> Option<usize> {
    let chosen = |mut values: Vec<i32>, choose: &dyn Fn(usize) -> usize| {
        values.sort_unstable();
        values.dedup();
        values.get(choose(values.len())).copied()
    };
    let x = chosen(body.iter().map(|p| p.cell[0]).collect(), &choose_x)?;
    let at_x = body.iter().filter(|p| p.cell[0] == x);
    let y = chosen(at_x.map(|p| p.cell[1]).collect(), &choose_y)?;
    let column = body
        .iter()
        .enumerate()
        .filter(|(_, p)| p.cell[..2] == [x, y]);
    column
        .max_by_key(|(_, p)| p.cell[2])
        .map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_right_handed_and_four_make_a_full_turn() {
        assert_eq!(turn([0, 1, 0], 1, 0), [0, 0, 1]);
        assert_eq!(turn([0, 0, 1], 0, 1), [1, 0, 0]);
        assert_eq!(turn([3, -2, 5], 4, 8), [3, -2, 5]);
        // First about x, then about y.
        assert_eq!(turn([0, 1, 0], 1, 1), [1, 0, 0]);
    }

    #[test]
    fn a_column_is_chosen_along_x_and_then_along_y() {
        let at = |cell| Placed { cell, driven: None };
        let body = [at([0, 0, 0]), at([0, 0, 1]), at([1, 0, 1]), at([1, 2, 0])];
        let top = |x: usize, y: usize| top_of_column(&body, |_| x, |_| y);
        assert_eq!(top(0, 0), Some(1));
        assert_eq!(top(1, 0), Some(2));
        assert_eq!(top(1, 1), Some(3));
    }
}
