//! What is left of a rectangle's cells once it was taken apart.
//!
//! A cell is whole while both its triangles are, and share its diagonal; its corners may be copies. All else is loose:
//! parts of triangles that were cut, and halves of cells whose other half is gone.

use super::grid::is_even;
use super::{Grid, NO_SQUARE, Topology};

/// Not a half of a cell, or no corner.
pub(crate) const NONE: u32 = u32::MAX;

/// Which triangles are halves of which cells, and which cells are whole.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Weave {
    /// For each triangle twice the number of its cell, and one more for the second half; [`NONE`] for a part of one.
    pub halves: Vec<u32>,
    /// For each cell, row by row, its corners as [`Grid::cell`] has them; [`NONE`] in the first where it is not whole.
    pub cells: Vec<[u32; 4]>,
    /// The triangles that belong to no whole cell, in ascending order.
    pub loose: Vec<u32>,
}

impl Weave {
    /// Of a rectangle whose triangles are the given halves of cells.
    pub fn new(grid: &Grid, triangles: &[[u32; 3]], halves: Vec<u32>) -> Self {
        let across = (grid.columns - 1) as usize;
        let count = across * (grid.rows - 1) as usize;
        let mut triangle_of = vec![NONE; 2 * count];
        for (triangle, half) in halves.iter().enumerate().filter(|(_, half)| **half != NONE) {
            triangle_of[*half as usize] = triangle as u32;
        }
        let mut cells = vec![[NONE; 4]; count];
        let mut whole = vec![false; triangles.len()];
        for (cell, corners) in cells.iter_mut().enumerate() {
            let [first, second] = [triangle_of[2 * cell], triangle_of[2 * cell + 1]];
            if first == NONE || second == NONE {
                continue;
            }
            let (t, s) = (triangles[first as usize], triangles[second as usize]);
            let joined = if is_even(cell as u32, grid) {
                (t[0] == s[0] && t[2] == s[1]).then_some([t[0], s[2], t[1], t[2]])
            } else {
                (t[2] == s[0] && t[1] == s[1]).then_some([t[0], t[2], t[1], s[2]])
            };
            if let Some(joined) = joined {
                *corners = joined;
                (whole[first as usize], whole[second as usize]) = (true, true);
            }
        }
        let loose = (0..triangles.len() as u32).filter(|triangle| !whole[*triangle as usize]).collect();
        Self { halves, cells, loose }
    }
}

impl Topology {
    /// The corners of the cell of a rectangle whose upper left particle stood in `row` and `column`, as [`Grid::cell`] has
    /// them, if it is whole.
    pub(crate) fn cell(&self, grid: &Grid, row: u32, column: u32) -> Option<[u32; 4]> {
        match &self.weave {
            None => Some(grid.cell(row, column)),
            Some(weave) => {
                let corners = weave.cells[(row * (grid.columns - 1) + column) as usize];
                (corners[0] != NONE).then_some(corners)
            }
        }
    }

    /// The triangles that belong to no whole cell of a rectangle: of one that was never taken apart none, of any other mesh
    /// all.
    pub(crate) fn loose(&self) -> impl Iterator<Item = u32> + '_ {
        let (listed, all) = match (&self.weave, &self.grid) {
            (Some(weave), _) => (weave.loose.as_slice(), 0),
            (None, Some(_)) => (&[][..], 0),
            (None, None) => (&[][..], self.triangles.len() as u32),
        };
        listed.iter().copied().chain(0..all)
    }

    /// The area that each corner of `triangle` stands for, m²: a quarter of its cell for a corner of a half, where the
    /// corners on the diagonal have another half; a third of the triangle elsewhere.
    pub(crate) fn corner_areas(&self, triangle: u32) -> [f32; 3] {
        let area = 0.5 * self.triangle_rest[triangle as usize].determinant();
        if let Some(square) = self.squares.get(triangle as usize) {
            return match *square {
                NO_SQUARE => [area / 3.0; 3],
                square => quarters(area, usize::from(square)),
            };
        }
        let half = match (&self.weave, &self.grid) {
            (Some(weave), _) => weave.halves[triangle as usize],
            (None, Some(_)) => triangle,
            (None, None) => NONE,
        };
        let Some(grid) = self.grid.filter(|_| half != NONE) else { return [area / 3.0; 3] };
        let square = match (is_even(half / 2, &grid), half % 2) {
            (true, 0) => 1,
            (true, _) | (false, 1) => 2,
            (false, _) => 0,
        };
        quarters(area, square)
    }
}

/// Half of a triangle for its corner `square`, which has no part in the other half of its cell.
fn quarters(area: f32, square: usize) -> [f32; 3] {
    let mut areas = [0.25 * area; 3];
    areas[square] = 0.5 * area;
    areas
}
