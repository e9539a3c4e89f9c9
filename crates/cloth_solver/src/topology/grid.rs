//! Rectangles.

use glam::{Mat2, UVec2, Vec2, Vec3};

use super::{Grid, Topology, hinge};
use crate::ClothError;
use crate::lanes::LANES;

/// Slots after the last row: kernels over pairs of neighbours read sixteen from any particle on.
pub(super) const TAIL: usize = 2 * LANES;

/// Most cells along one side of a rectangle.
const MAX_CELLS_A_SIDE: u32 = 4096;

/// Most cells of a rectangle.
const MAX_CELLS: u32 = 4_194_304;

/// How finely a rectangle is divided.
#[cfg_attr(feature = "ecs", derive(bevy_reflect::Reflect))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Distance between neighbouring particles, m, 1e-6..=1e4; rounded so that whole cells fill the rectangle.
    Spacing(f32),
    /// Number of cells across the width and down the height, 1..=4096 each and at most 4,194,304 in all.
    Cells(UVec2),
}

impl Resolution {
    /// Cells across the width and down the height of a rectangle of `size`, m.
    fn cells(self, size: Vec2) -> Result<UVec2, ClothError> {
        let (cells, spacing) = match self {
            Self::Cells(cells) => (cells, None),
            Self::Spacing(spacing) => {
                ClothError::check("Cloth::resolution.spacing", spacing, 1e-6..=1e4, "1e-6..=1e4 m")?;
                ((size / spacing).round().as_uvec2().max(UVec2::ONE), Some(spacing))
            }
        };
        let side = 1..=MAX_CELLS_A_SIDE;
        let too_many_in_all = u64::from(cells.x) * u64::from(cells.y) > u64::from(MAX_CELLS);
        let (field, value) = match spacing {
            Some(spacing) => ("Cloth::resolution.spacing", spacing),
            None if !side.contains(&cells.x) => ("Cloth::resolution.cells.x", cells.x as f32),
            None if !side.contains(&cells.y) => ("Cloth::resolution.cells.y", cells.y as f32),
            None => ("Cloth::resolution.cells.x * Cloth::resolution.cells.y", cells.x as f32 * cells.y as f32),
        };
        if side.contains(&cells.x) && side.contains(&cells.y) && !too_many_in_all {
            Ok(cells)
        } else {
            let allowed = "what gives 1..=4096 cells a side and at most 4194304 in all";
            Err(ClothError::OutOfRange { field, value, allowed })
        }
    }
}

impl Grid {
    /// The corners of the cell whose upper left particle stands in `row` and `column`: upper left, upper right, lower
    /// left, lower right.
    pub const fn cell(&self, row: u32, column: u32) -> [u32; 4] {
        let slot = self.slot(row, column);
        [slot, slot + 1, slot + self.stride, slot + self.stride + 1]
    }

    /// The upper left corner of each cell as (row, column), row by row.
    pub fn cells(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.rows - 1).flat_map(move |row| (0..self.columns - 1).map(move |column| (row, column)))
    }
}

impl Topology {
    /// A rectangle of `size` (width along x, height along y; m, each 1e-4..=1e4) in the xy plane, centred on the
    /// origin, facing +z. Row 0 is the top, column 0 the left side.
    ///
    /// Triangles come two to a cell, cell by cell along the rows. A particle stands for the quarters of the cells
    /// around it, which in a rectangle is more even than thirds of triangles.
    pub fn rectangle(size: Vec2, resolution: Resolution) -> Result<Self, ClothError> {
        ClothError::check("Cloth::size.x", size.x, 1e-4..=1e4, "1e-4..=1e4 m")?;
        ClothError::check("Cloth::size.y", size.y, 1e-4..=1e4, "1e-4..=1e4 m")?;
        let cells = resolution.cells(size)?;
        let grid = Grid {
            columns: cells.x + 1,
            rows: cells.y + 1,
            stride: (cells.x + 1).next_multiple_of(LANES as u32),
            spacing: size / cells.as_vec2(),
        };
        // From whole numbers, so that the rectangle is its own mirror image to the last bit.
        let part = |i: u32, count: u32| (2.0 * i as f32 - (count - 1) as f32) / (2 * (count - 1)) as f32;
        Ok(Self::woven(grid, |row, column| {
            Vec3::new(part(column, grid.columns) * size.x, -part(row, grid.rows) * size.y, 0.0)
        }))
    }

    /// The rectangle `grid`, whose particle in (row, column) rests at `place`, with one render vertex a particle.
    pub(super) fn woven(grid: Grid, place: impl Fn(u32, u32) -> Vec3) -> Self {
        let triangles: Vec<[u32; 3]> =
            grid.cells().flat_map(|(row, column)| cell_triangles(&grid, row, column)).collect();
        let flat = |slot: u32| Vec2::new((slot % grid.stride) as f32, -((slot / grid.stride) as f32)) * grid.spacing;
        let triangle_rest = (triangles.iter())
            .map(|t| {
                let [p0, p1, p2] = t.map(flat);
                Mat2::from_cols(p1 - p0, p2 - p0)
            })
            .collect();
        let (rest, area) = particles(&grid, place);
        let sides = hinge::sides(&triangles);
        let (hinges, hinge_triangles): (Vec<_>, Vec<_>) = hinge::hinges(&triangles, &rest, &sides).unzip();
        let vertex = |slot: u32| slot / grid.stride * grid.columns + slot % grid.stride;
        Self {
            triangle_vertices: triangles.iter().map(|triangle| triangle.map(vertex)).collect(),
            hinge_triangles,
            triangle_rest,
            edges: hinge::by_edge(&sides).map(|shared| shared[0].edge).collect(),
            hinge_rest: vec![0.0; hinges.len()],
            hinges,
            vertex_particle: (0..grid.rows)
                .flat_map(|row| (0..grid.columns).map(move |column| grid.slot(row, column)))
                .collect(),
            triangle_backs: Vec::new(),
            joints: Vec::new(),
            mended: Default::default(),
            grid: Some(grid),
            quads: None,
            squares: Vec::new(),
            is_warp_told: false,
            weave: None,
            original_triangles: triangles.len() as u32,
            free: rest.len() as u32,
            rest,
            area,
            triangles,
        }
    }
}

/// The two triangles of a cell, counter-clockwise, with the diagonal from the upper left where `row + column` is even.
pub(super) fn cell_triangles(grid: &Grid, row: u32, column: u32) -> [[u32; 3]; 2] {
    let [upper_left, upper_right, lower_left, lower_right] = grid.cell(row, column);
    if (row + column).is_multiple_of(2) {
        [[upper_left, lower_left, lower_right], [upper_left, lower_right, upper_right]]
    } else {
        [[upper_left, lower_left, upper_right], [upper_right, lower_left, lower_right]]
    }
}

/// Whether the diagonal of a cell, counted row by row, runs from its upper left corner.
pub(super) fn is_even(cell: u32, grid: &Grid) -> bool {
    let across = grid.columns - 1;
    (cell / across + cell % across).is_multiple_of(2)
}

/// Rest position and area of each slot, the padding of the rows and of the tail included.
fn particles(grid: &Grid, place: impl Fn(u32, u32) -> Vec3) -> (Vec<Vec3>, Vec<f32>) {
    let slots = (grid.rows * grid.stride) as usize + TAIL;
    let (mut rest, mut area) = (Vec::with_capacity(slots), Vec::with_capacity(slots));
    let share = |i: u32, count: u32| if i == 0 || i == count - 1 { 0.5 } else { 1.0 };
    for row in 0..grid.rows {
        for slot in 0..grid.stride {
            let column = slot.min(grid.columns - 1);
            rest.push(place(row, column));
            let is_particle = slot < grid.columns;
            let cells = if is_particle { share(row, grid.rows) * share(column, grid.columns) } else { 0.0 };
            area.push(cells * grid.spacing.x * grid.spacing.y);
        }
    }
    let last = place(grid.rows - 1, grid.columns - 1);
    rest.resize(slots, last);
    area.resize(slots, 0.0);
    (rest, area)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(columns: u32, rows: u32) -> Topology {
        Topology::rectangle(Vec2::new(2.0, 1.5), Resolution::Cells(UVec2::new(columns, rows))).unwrap()
    }

    #[test]
    fn rows_are_padded_to_eight_slots_and_a_tail_of_sixteen_follows() {
        for (cells, stride) in [(1, 8), (4, 8), (7, 8), (8, 16), (15, 16)] {
            let topology = rectangle(cells, 3);
            let grid = topology.grid.unwrap();
            assert_eq!(grid.stride, stride);
            assert_eq!(topology.slots() as u32, 4 * stride + 16);
            assert_eq!(topology.area.len(), topology.slots());
            assert_eq!(topology.particle_count() as u32, 4 * (cells + 1));
            for slot in 0..topology.slots() as u32 {
                let inside = slot < 4 * stride && slot % stride < grid.columns;
                assert_eq!(topology.is_particle(slot), inside);
                let row = (slot / stride).min(3);
                let twin =
                    if slot < 4 * stride { grid.slot(row, (slot % stride).min(cells)) } else { grid.slot(3, cells) };
                assert_eq!(topology.rest[slot as usize], topology.rest[twin as usize]);
            }
        }
    }

    #[test]
    fn the_first_row_is_the_top_and_the_first_column_the_left() {
        let topology = rectangle(4, 3);
        let grid = topology.grid.unwrap();
        let at = |row, column| topology.rest[grid.slot(row, column) as usize];
        assert_eq!(at(0, 0), Vec3::new(-1.0, 0.75, 0.0));
        assert_eq!(at(3, 4), Vec3::new(1.0, -0.75, 0.0));
        assert_eq!(at(0, 2), Vec3::new(0.0, 0.75, 0.0));
        assert_eq!(grid.spacing, Vec2::new(0.5, 0.5));
        assert_eq!(topology.vertex_particle[5], grid.slot(1, 0));
    }

    #[test]
    fn a_corner_stands_for_a_quarter_cell_an_edge_for_half_and_the_inside_for_one() {
        let topology = rectangle(4, 3);
        let grid = topology.grid.unwrap();
        let cells = |row, column| topology.area[grid.slot(row, column) as usize] / 0.25;
        assert_eq!([cells(0, 0), cells(0, 1), cells(1, 0), cells(2, 2), cells(3, 4)], [0.25, 0.5, 0.5, 1.0, 0.25]);
        assert!((topology.area.iter().sum::<f32>() - 3.0).abs() < 1e-5);
    }

    #[test]
    fn every_triangle_faces_forward_and_neighbouring_diagonals_alternate() {
        let topology = rectangle(3, 2);
        let diagonals: Vec<bool> = topology.triangles.chunks(2).map(|pair| pair[0][2] > pair[0][1]).collect();
        assert_eq!(diagonals, [true, false, true, false, true, false]);
        for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
            let [a, b, c] = triangle.map(|p| topology.rest[p as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.z > 0.0);
            assert!((rest.determinant() - normal.z).abs() < 1e-6);
        }
    }

    #[test]
    fn a_rectangle_has_as_many_edges_and_hinges_as_eulers_formula_says() {
        let topology = rectangle(9, 5);
        let border = 2 * (9 + 5);
        assert_eq!(topology.particle_count() + topology.triangles.len(), topology.edges.len() + 1);
        assert_eq!(topology.hinges.len(), topology.edges.len() - border);
        assert_eq!(topology.hinge_rest.len(), topology.hinges.len());
        assert!(topology.edges.is_sorted() && topology.edges.iter().all(|[a, b]| a < b));
    }

    #[test]
    fn a_spacing_is_rounded_to_whole_cells_and_never_to_none() {
        let of =
            |spacing| Topology::rectangle(Vec2::new(1.0, 0.5), Resolution::Spacing(spacing)).unwrap().grid.unwrap();
        assert_eq!([of(0.1).columns, of(0.1).rows], [11, 6]);
        assert_eq!([of(0.3).columns, of(0.3).rows], [4, 3]);
        assert_eq!([of(50.0).columns, of(50.0).rows], [2, 2]);
    }

    #[test]
    fn a_wrong_size_or_resolution_is_refused_by_name() {
        let fails = |size: [f32; 2], resolution| match Topology::rectangle(size.into(), resolution) {
            Err(ClothError::OutOfRange { field, .. }) => field,
            other => panic!("{other:?}"),
        };
        let fine = Resolution::Cells(UVec2::ONE);
        let cells = |x, y| Resolution::Cells(UVec2::new(x, y));
        assert_eq!(fails([f32::NAN, 1.0], fine), "Cloth::size.x");
        assert_eq!(fails([1.0, -1.0], fine), "Cloth::size.y");
        assert_eq!(fails([1.0, 1e30], fine), "Cloth::size.y");
        assert_eq!(fails([1.0, 1.0], cells(0, 5)), "Cloth::resolution.cells.x");
        assert_eq!(fails([1.0, 1.0], cells(5, u32::MAX)), "Cloth::resolution.cells.y");
        assert!(fails([1.0, 1.0], cells(4096, 4096)).contains('*'));
        for spacing in [0.0, -1.0, f32::NAN, f32::INFINITY, 2e-4] {
            assert_eq!(fails([1.0, 1.0], Resolution::Spacing(spacing)), "Cloth::resolution.spacing");
        }
    }
}
