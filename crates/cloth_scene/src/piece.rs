//! The shape of a cloth at rest: a rectangle, a piece cut out of it, or one that goes around something.

use glam::{Vec2, Vec3};

use crate::SceneCloth;

/// A piece cut out of a rectangle, or one that goes around something.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScenePiece {
    /// Rest position of each vertex, m.
    pub positions: Vec<Vec3>,
    /// Texture coordinates: parts of width (from the left) and height (from the top).
    pub uvs: Vec<Vec2>,
    /// Triangles, counterclockwise as seen from +z.
    pub triangles: Vec<[u32; 3]>,
}

impl SceneCloth {
    /// Where a point lies at rest, m, in the cloth's own frame; `part` is its part of width (from the left) and height (from the top).
    pub fn point(&self, part: Vec2) -> Vec3 {
        match &self.wrap {
            Some(wrap) => wrap.point(part),
            None => ((part - 0.5) * self.size * Vec2::new(1.0, -1.0)).extend(0.0),
        }
    }

    /// Whether the cell of that column and row (from the top left) belongs to the piece.
    pub fn has_cell(&self, column: u32, row: u32) -> bool {
        let at = (Vec2::new(column as f32, row as f32) + 0.5) / self.cells.as_vec2();
        let corners = self.outline.len();
        // Within, if a ray to the right crosses the outline an odd number of times.
        let crosses = |corner: usize| {
            let (a, b) = (self.outline[corner], self.outline[(corner + 1) % corners]);
            (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        corners == 0 || (0..corners).filter(|corner| crosses(*corner)).count() % 2 == 1
    }

    /// Rest positions, texture coordinates and triangles of a piece that is cut out of the rectangle or goes around something; vertices
    /// row by row from the top left, those of no triangle left out. `None` of a whole, flat rectangle.
    pub fn piece(&self) -> Option<ScenePiece> {
        if self.outline.is_empty() && self.wrap.is_none() {
            return None;
        }
        let (columns, rows) = (self.cells.x, self.cells.y);
        let mut number = vec![u32::MAX; ((columns + 1) * (rows + 1)) as usize];
        let mut piece = ScenePiece::default();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            if !self.has_cell(column, row) {
                continue;
            }
            let [a, b, c, d] =
                [(row, column), (row, column + 1), (row + 1, column), (row + 1, column + 1)].map(|(row, column)| {
                    let slot = (row * (columns + 1) + column) as usize;
                    if number[slot] == u32::MAX {
                        number[slot] = piece.positions.len() as u32;
                        let part = Vec2::new(column as f32, row as f32) / self.cells.as_vec2();
                        piece.positions.push(self.point(part));
                        piece.uvs.push(part);
                    }
                    number[slot]
                });
            // Diagonals alternate, so that no direction is stiffer than its mirror image.
            let pair = if (row + column) % 2 == 0 { [[a, c, b], [b, c, d]] } else { [[a, c, d], [a, d, b]] };
            piece.triangles.extend(pair);
        }
        Some(piece)
    }
}
