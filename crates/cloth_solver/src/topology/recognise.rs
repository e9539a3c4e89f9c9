//! Whether a mesh is a rectangle, and then its rows and columns.

use glam::{DMat2, DVec2, DVec3, UVec2, Vec2};

use super::grid::cell_triangles;
use super::{Grid, Topology};
use crate::lanes::LANES;

/// How far a particle may lie off its place, in spacings, and an axis off its direction, rad. Modelling tools and files write
/// coordinates to some six digits.
const OFF: f64 = 1e-3;

/// No vertex, no slot.
const NONE: u32 = u32::MAX;

impl Topology {
    /// A mesh that is a flat rectangle, evenly divided into rows along the weft and columns along the warp and each cell
    /// into two triangles, as a rectangle: with [`Topology::grid`], so that its threads are solved exactly. It stays where
    /// it lies, with the same render vertices; particles are numbered anew, row by row, and diagonals alternate, whichever
    /// way the mesh cut its cells. Any other mesh comes back as it is.
    ///
    /// Rest places may be off by 0.001 spacings. Row 0 is on the side that the warp points to.
    #[must_use]
    pub fn into_rectangle(self) -> Self {
        self.as_rectangle().unwrap_or(self)
    }

    fn as_rectangle(&self) -> Option<Self> {
        let count = self.particle_count();
        if self.grid.is_some() || self.hinge_rest.iter().any(|angle| f64::from(angle.abs()) > OFF) {
            return None;
        }
        let places = self.places()?;
        let columns = Even::new(places.iter().map(|place| place.x).collect())?;
        let rows = Even::new(places.iter().map(|place| -place.y).collect())?;
        if columns.count * rows.count != count as u32 {
            return None;
        }
        let grid = Grid {
            columns: columns.count,
            rows: rows.count,
            stride: columns.count.next_multiple_of(LANES as u32),
            spacing: Vec2::new(columns.spacing as f32, rows.spacing as f32),
        };
        // Which particle of the mesh stands where.
        let mut particle = vec![NONE; (grid.columns * grid.rows) as usize];
        let mut stand = vec![UVec2::ZERO; count];
        for (p, place) in places.iter().enumerate() {
            let at = UVec2::new(columns.index(place.x)?, rows.index(-place.y)?);
            let taken = &mut particle[(at.y * grid.columns + at.x) as usize];
            if *taken != NONE {
                return None;
            }
            (*taken, stand[p]) = (p as u32, at);
        }
        let corner_vertices = self.corner_vertices(&grid, &stand, &self.triangle_vertices)?;
        let slot = |p: u32| grid.slot(stand[p as usize].y, stand[p as usize].x);
        let mut made =
            Self::woven(grid, |row, column| self.rest[particle[(row * grid.columns + column) as usize] as usize]);
        let no_particle = made.padding();
        made.vertex_particle =
            (self.vertex_particle.iter()).map(|p| if (*p as usize) < count { slot(*p) } else { no_particle }).collect();
        let drawn = |corner_vertices: &[[u32; 4]]| {
            (grid.cells().zip(corner_vertices))
                .flat_map(|((row, column), vertices)| {
                    let corners = grid.cell(row, column);
                    let vertex = move |slot: u32| vertices[corners.iter().position(|c| *c == slot).unwrap_or_default()];
                    cell_triangles(&grid, row, column).map(|triangle| triangle.map(vertex))
                })
                .collect()
        };
        made.triangle_vertices = drawn(&corner_vertices);
        if !self.triangle_backs.is_empty() {
            made.triangle_backs = drawn(&self.corner_vertices(&grid, &stand, &self.triangle_backs)?);
        }
        made.mended = self.mended;
        Some(made)
    }

    /// The place of each particle in the plane of weft (x) and warp (y), m; `None` if these have no one direction.
    fn places(&self) -> Option<Vec<DVec2>> {
        let corner = |triangle: &[u32; 3], i: usize| self.rest[triangle[i] as usize].as_dvec3();
        let axes = |triangle: usize| {
            let t = &self.triangles[triangle];
            let inverse: DMat2 = self.triangle_rest[triangle].as_dmat2().inverse();
            let (e1, e2) = (corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
            [inverse.x_axis, inverse.y_axis].map(|m| e1 * m.x + e2 * m.y)
        };
        let [weft, warp]: [DVec3; 2] = axes(0);
        let along = |[u, v]: [DVec3; 2]| u.distance(weft) < OFF && v.distance(warp) < OFF;
        let origin = corner(&self.triangles[0], 0);
        let place = |p: u32| {
            let offset = self.rest[p as usize].as_dvec3() - origin;
            DVec2::new(offset.dot(weft), offset.dot(warp))
        };
        (1..self.triangles.len()).all(|t| along(axes(t))).then(|| self.particles().map(place).collect())
    }

    /// Those of the render vertices `drawn` of each triangle at the corners of each cell, as [`Grid::cell`] has them; `None` if a triangle reaches over several
    /// cells, a cell is not covered by two of them, or a seam runs through it.
    fn corner_vertices(&self, grid: &Grid, stand: &[UVec2], drawn: &[[u32; 3]]) -> Option<Vec<[u32; 4]>> {
        let across = grid.columns - 1;
        let cells = (across * (grid.rows - 1)) as usize;
        let mut vertices = vec![[NONE; 4]; cells];
        let mut triangles = vec![0; cells];
        for (corners, drawn) in self.triangles.iter().zip(drawn) {
            let at = corners.map(|p| stand[p as usize]);
            let [low, high] = [at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2])];
            if high - low != UVec2::ONE {
                return None;
            }
            let cell = (low.y * across + low.x) as usize;
            triangles[cell] += 1;
            for (at, vertex) in at.into_iter().zip(drawn) {
                let known = &mut vertices[cell][((at.y - low.y) * 2 + at.x - low.x) as usize];
                if *known != NONE && known != vertex {
                    return None;
                }
                *known = *vertex;
            }
        }
        let covered = triangles.iter().all(|count| *count == 2) && vertices.iter().flatten().all(|v| *v != NONE);
        covered.then_some(vertices)
    }
}

/// Places at equal distances.
struct Even {
    first: f64,
    spacing: f64,
    count: u32,
}

impl Even {
    /// The places that `all` come back to, if those are equally far apart.
    fn new(mut all: Vec<f64>) -> Option<Self> {
        all.sort_by(f64::total_cmp);
        let (first, last) = (*all.first()?, *all.last()?);
        // There are at most as many places as particles.
        let least = (last - first) / all.len() as f64;
        let gaps = all.windows(2).filter(|pair| pair[1] - pair[0] > 0.5 * least).count();
        let even = Self { first, spacing: (last - first) / gaps as f64, count: gaps as u32 + 1 };
        (gaps > 0 && all.iter().all(|place| even.index(*place).is_some())).then_some(even)
    }

    /// Which of them `place` is.
    fn index(&self, place: f64) -> Option<u32> {
        let at = (place - self.first) / self.spacing;
        let near = at.round();
        ((at - near).abs() < OFF && (0.0..f64::from(self.count)).contains(&near)).then_some(near as u32)
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::FRAC_PI_4;

    use glam::{Mat2, Quat, Vec3};

    use super::*;
    use crate::topology::MeshSource;

    const CELLS: [u32; 2] = [5, 3];

    /// A sheet of 5 × 3 cells, 1 m × 0.9 m, as tools make it: all diagonals alike, row by row from below.
    fn sheet() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let [across, down] = CELLS;
        let positions =
            (0..=down).flat_map(|j| (0..=across).map(move |i| Vec3::new(0.2 * i as f32, 0.3 * j as f32, 0.0)));
        let corner = |i: u32, j: u32| j * (across + 1) + i;
        let triangles = (0..down).flat_map(|j| (0..across).map(move |i| (i, j))).flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        (positions.collect(), triangles.collect())
    }

    fn mesh(positions: &[Vec3], uvs: &[Vec2], triangles: &[[u32; 3]]) -> Topology {
        Topology::from_mesh(MeshSource { positions, uvs, indices: triangles.as_flattened() }).unwrap()
    }

    #[test]
    fn a_flat_even_sheet_has_rows_and_columns_wherever_it_lies() {
        let (flat, triangles) = sheet();
        let turn = Quat::from_rotation_y(1.0) * Quat::from_rotation_x(0.5);
        let positions: Vec<Vec3> = flat.iter().map(|p| turn * *p + Vec3::new(3.0, -2.0, 7.0)).collect();
        let uvs: Vec<Vec2> = flat.iter().map(|p| Vec2::new(p.x, 1.0 - p.y)).collect();
        let made = mesh(&positions, &uvs, &triangles).into_rectangle();
        let grid = made.grid.expect("a rectangle");
        assert_eq!([grid.columns - 1, grid.rows - 1], CELLS);
        assert!(grid.spacing.distance(Vec2::new(0.2, 0.3)) < 1e-6);
        for (vertex, position) in positions.iter().enumerate() {
            assert_eq!(made.rest[made.vertex_particle[vertex] as usize], *position);
        }
        let top = made.vertex_particle[(CELLS[0] + 1) as usize * CELLS[1] as usize];
        assert_eq!(top, grid.slot(0, 0), "the warp points against v, and the weft to the right of it");
        for ((triangle, drawn), rest) in made.triangles.iter().zip(&made.triangle_vertices).zip(&made.triangle_rest) {
            assert_eq!(drawn.map(|vertex| made.vertex_particle[vertex as usize]), *triangle);
            let [a, b, c] = triangle.map(|slot| made.rest[slot as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(turn * Vec3::Z) > 0.0 && (normal.length() - rest.determinant()).abs() < 1e-6);
        }
        assert!((made.area.iter().sum::<f32>() - 0.9).abs() < 1e-5);
    }

    #[test]
    fn a_turned_texture_turns_rows_into_columns() {
        let (positions, triangles) = sheet();
        let uvs: Vec<Vec2> = positions.iter().map(|p| Vec2::new(p.y, p.x)).collect();
        let grid = mesh(&positions, &uvs, &triangles).into_rectangle().grid.expect("a rectangle");
        assert_eq!([grid.rows - 1, grid.columns - 1], CELLS);
        assert!(grid.spacing.distance(Vec2::new(0.3, 0.2)) < 1e-6);
    }

    #[test]
    fn a_seam_between_cells_keeps_its_vertices_and_one_through_a_cell_keeps_the_mesh() {
        let (mut positions, mut triangles) = sheet();
        let double = |vertex: u32, in_triangles: &[usize], positions: &mut Vec<Vec3>, triangles: &mut [[u32; 3]]| {
            positions.push(positions[vertex as usize]);
            for triangle in in_triangles {
                triangles[*triangle].iter_mut().filter(|v| **v == vertex).for_each(|v| *v = positions.len() as u32 - 1);
            }
        };
        double(1, &[2, 3], &mut positions, &mut triangles);
        let made = mesh(&positions, &[], &triangles).into_rectangle();
        assert!(made.grid.is_some());
        let used = |vertex: u32| made.triangle_vertices.iter().filter(|t| t.contains(&vertex)).count();
        assert!(used(1) > 0 && used(24) > 0);
        double(8, &[2], &mut positions, &mut triangles);
        assert_eq!(mesh(&positions, &[], &triangles).into_rectangle().grid, None);
    }

    #[test]
    fn what_is_no_even_rectangle_stays_a_mesh() {
        let (positions, triangles) = sheet();
        let kept = |positions: &[Vec3], uvs: &[Vec2], triangles: &[[u32; 3]]| {
            let made = mesh(positions, uvs, triangles);
            assert_eq!(made.clone().into_rectangle(), made);
        };
        // A triangle is missing, a row lies elsewhere, the sheet is folded, the threads run askew.
        kept(&positions, &[], &triangles[1..]);
        let moved = |what: fn(Vec3) -> Vec3| positions.iter().map(|p| what(*p)).collect::<Vec<_>>();
        kept(&moved(|p| if p.y > 0.2 && p.y < 0.4 { p - Vec3::Y * 0.1 } else { p }), &[], &triangles);
        kept(&moved(|p| if p.y > 0.5 { p + Vec3::Z * 0.1 } else { p }), &[], &triangles);
        let askew: Vec<Vec2> = positions.iter().map(|p| Mat2::from_angle(FRAC_PI_4) * p.truncate()).collect();
        kept(&positions, &askew, &triangles);
    }
}
