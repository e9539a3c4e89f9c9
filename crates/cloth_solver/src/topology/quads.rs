//! The rows and columns of a mesh of quads that is no flat, even rectangle: a cape, a sleeve, a skirt, a sail.

use glam::{DVec2, DVec3};

use super::{Along, Grid, Topology};

/// Rows and columns along the edge loops of a mesh of quads.
///
/// ```text
///   open: a cape, a sail              closed: a sleeve, a skirt
///    o ── o ── o ── o                  ╭ o ── o ── o ── o ╮     the last column is
///    │    │    │    │                  │ │    │    │    │ │     the first one's neighbour
///   o ─── o ── o ─── o                 ╰ o ── o ── o ── o ╯
/// ```
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quads {
    /// How the particles lie in memory: row by row, from the top. Its spacing is the mean one.
    pub grid: Grid,
    /// Whether every row runs back into itself.
    pub closed: bool,
    /// Whether it is the rows that run along the warp, the columns along the weft.
    pub turned: bool,
}

impl Quads {
    /// Cells in a row.
    pub(crate) const fn across(&self) -> u32 {
        if self.closed { self.grid.columns } else { self.grid.columns - 1 }
    }

    /// The thread along which rows run.
    pub(crate) const fn along_rows(&self) -> Along {
        if self.turned { Along::Warp } else { Along::Weft }
    }

    /// The thread along which columns run.
    pub(crate) const fn along_columns(&self) -> Along {
        if self.turned { Along::Weft } else { Along::Warp }
    }

    /// The corners of a cell as [`Grid::cell`] has them.
    pub(crate) const fn cell(&self, row: u32, column: u32) -> [u32; 4] {
        let right = if column + 1 == self.grid.columns { 0 } else { column + 1 };
        [
            self.grid.slot(row, column),
            self.grid.slot(row, right),
            self.grid.slot(row + 1, column),
            self.grid.slot(row + 1, right),
        ]
    }

    /// The upper left corner of each cell as (row, column), row by row.
    pub(crate) fn cells(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.grid.rows - 1).flat_map(move |row| (0..self.across()).map(move |column| (row, column)))
    }
}

/// A cell of quads at rest.
///
/// ```text
///   p00 ── p10      e = p11 − p00, f = p10 − p01
///    │      │       u = (e + f)/2a, v = (e − f)/2b: its mean edges along the rows and down the columns, in rest lengths
///   p01 ── p11      shear C = u·v − c₀,  twist t = p00 + p11 − p10 − p01 − (γ·(e, f)) − τ n, n its normal
/// ```
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CellRest {
    /// m².
    pub area: f64,
    /// a and b, m.
    pub size: DVec2,
    /// c₀: 0 where rows and columns are at a right angle.
    pub shear: f64,
    /// γ: what of the twist is in the cell's plane, as where it is a trapezium.
    pub skew: DVec2,
    /// τ, m: of a saddle.
    pub twist: f64,
}

/// A bend of a line at one of its particles at rest.
///
/// c = t₂ − t₁ of the links there over their rest lengths, less `skew.x A + skew.y B` in the plane of the surface; A and B are what lies
/// between the neighbours in the row and in the column. At rest it is `curl` along the normal A × B.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BendRest {
    pub skew: DVec2,
    pub curl: f64,
    /// Width over length of fabric that it speaks for; 0 where there is none.
    pub shape: f64,
}

/// What [`Quads`] are like at rest.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct QuadsRest {
    /// By slot of their upper left corners.
    pub cells: Vec<CellRest>,
    /// Length and width of the links from each slot to the right, m, and down; 0 where none is.
    pub links: [Vec<DVec2>; 2],
    /// By slot, in the row and in the column.
    pub bends: [Vec<BendRest>; 2],
    /// |A × B| of each slot, m².
    pub stars: Vec<f64>,
}

/// The part of |A × B| at rest below which a normal, of length 1 at rest, fades: what is crumpled to a line has none.
pub(crate) const FADING: f64 = 0.2;

/// (A × B) N⁻¹, with `(1 + ε²) N² = |A × B|² + ε² |A × B|₀²`, ε [`FADING`]: a normal whose slope is bounded, and of length 1 at rest.
pub(crate) fn normal(across: DVec3, at_rest: f64) -> DVec3 {
    let fading = FADING * FADING;
    across * ((1.0 + fading) / (across.length_squared() + fading * at_rest * at_rest)).sqrt()
}

impl Quads {
    /// The neighbours of a particle: left, right, up, down.
    pub(crate) fn neighbours(&self, row: u32, column: u32) -> [Option<u32>; 4] {
        let Grid { columns, rows, .. } = self.grid;
        let wrap =
            |column: u32| if self.closed { Some(column % columns) } else { (column < columns).then_some(column) };
        let left = if column > 0 { Some(column - 1) } else { self.closed.then(|| columns - 1) };
        [
            left.map(|column| self.grid.slot(row, column)),
            wrap(column + 1).map(|column| self.grid.slot(row, column)),
            (row > 0).then(|| self.grid.slot(row.wrapping_sub(1), column)),
            (row + 1 < rows).then(|| self.grid.slot(row + 1, column)),
        ]
    }

    /// What is where at rest.
    pub(crate) fn at_rest(&self, rest: impl Fn(u32) -> DVec3) -> QuadsRest {
        let slots = (self.grid.rows * self.grid.stride) as usize;
        let mut made = QuadsRest {
            cells: vec![CellRest::default(); slots],
            links: [vec![DVec2::ZERO; slots], vec![DVec2::ZERO; slots]],
            bends: [vec![BendRest::default(); slots], vec![BendRest::default(); slots]],
            stars: vec![0.0; slots],
        };
        for (row, column) in self.cells() {
            let corners = self.cell(row, column);
            let cell = CellRest::new(corners.map(&rest));
            made.cells[corners[0] as usize] = cell;
            let [p00, p10, p01, _] = corners.map(|slot| slot as usize);
            // Half of the cell's width to the links on either side of it.
            for (along, slots, width) in
                [(0, [p00, p01], 0.5 * cell.area / cell.size.x), (1, [p00, p10], 0.5 * cell.area / cell.size.y)]
            {
                slots.into_iter().for_each(|slot| made.links[along][slot].y += width);
            }
        }
        for row in 0..self.grid.rows {
            for column in 0..self.grid.columns {
                let slot = self.grid.slot(row, column);
                let around = self.neighbours(row, column);
                for (along, next) in [around[1], around[3]].into_iter().enumerate() {
                    if let Some(next) = next {
                        made.links[along][slot as usize].x = rest(slot).distance(rest(next));
                    }
                }
            }
        }
        for row in 0..self.grid.rows {
            for column in 0..self.grid.columns {
                let slot = self.grid.slot(row, column);
                let around = self.neighbours(row, column);
                let [a, b] = star(rest(slot), around.map(|slot| slot.map(&rest)));
                made.stars[slot as usize] = a.cross(b).length();
                for along in 0..2 {
                    let bend = made.bend(slot, around, along, &rest);
                    made.bends[along][slot as usize] = bend;
                }
            }
        }
        made
    }
}

impl CellRest {
    fn new([p00, p10, p01, p11]: [DVec3; 4]) -> Self {
        let (e, f) = (p11 - p00, p10 - p01);
        let (across, down) = (0.5 * (e + f), 0.5 * (e - f));
        let normal = e.cross(f);
        let area = 0.5 * normal.length();
        let twist = p00 + p11 - p10 - p01;
        let up = normal.normalize_or_zero();
        Self {
            area,
            size: DVec2::new(across.length(), down.length()),
            shear: across.normalize_or_zero().dot(down.normalize_or_zero()),
            skew: in_plane(twist, e, f),
            twist: twist.dot(up),
        }
    }
}

/// The part of `v` in the plane of `a` and `b`, by these.
fn in_plane(v: DVec3, a: DVec3, b: DVec3) -> DVec2 {
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let (va, vb) = (v.dot(a), v.dot(b));
    DVec2::new(va * bb - vb * ab, vb * aa - va * ab) / (aa * bb - ab * ab)
}

/// What lies between the neighbours in the row, and in the column.
pub(crate) fn star(here: DVec3, around: [Option<DVec3>; 4]) -> [DVec3; 2] {
    let [left, right, up, down] = around.map(|place| place.unwrap_or(here));
    [right - left, down - up]
}

impl QuadsRest {
    fn bend(&self, slot: u32, around: [Option<u32>; 4], along: usize, rest: impl Fn(u32) -> DVec3) -> BendRest {
        let [before, _, above, _] = around;
        let (Some(before), Some(after)) = (if along == 0 { before } else { above }, around[2 * along + 1]) else {
            return BendRest::default();
        };
        let links = [before, slot].map(|slot| self.links[along][slot as usize]);
        let here = rest(slot);
        let curl = (rest(after) - here) / links[1].x - (here - rest(before)) / links[0].x;
        let [a, b] = star(here, around.map(|slot| slot.map(&rest)));
        BendRest {
            skew: in_plane(curl, a, b),
            curl: curl.dot(a.cross(b).normalize_or_zero()),
            shape: (links[0].y + links[1].y) / (links[0].x + links[1].x),
        }
    }
}

impl Topology {
    /// The rest of its [`Topology::quads`], if it has any.
    pub(crate) fn quads_at_rest(&self) -> Option<(Quads, QuadsRest)> {
        self.quads.map(|quads| (quads, quads.at_rest(|slot| self.rest[slot as usize].as_dvec3())))
    }
}
