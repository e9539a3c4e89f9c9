//! What is connected to what, at rest: particles, triangles, edges, hinges, and the way back to render vertices.

mod change;
pub(crate) mod curvature;
mod edge_loops;
mod grid;
mod hinge;
mod lines;
mod mend;
mod mesh;
mod orient;
mod pieces;
mod quads;
mod recognise;
mod renew;
mod strip;
mod surgery;
mod weave;
mod weld;

pub use change::{Born, BornVertex, Change};
pub(crate) use curvature::{Curvature, curvatures};
pub use grid::Resolution;
pub(crate) use hinge::hinge_angle;
pub(crate) use lines::{Along, Thread, regular_runs, threads};
pub use mend::Mended;
pub use mesh::MeshSource;
pub use pieces::Pieces;
pub use quads::Quads;
pub(crate) use quads::{FADING, QuadsRest, normal, star};
pub(crate) use strip::strips;
pub(crate) use surgery::{Crossing, Surgery};
pub(crate) use weave::Weave;

use std::sync::Arc;

use glam::{Mat2, Vec2, Vec3};

/// A rectangle of particles in rows (along the weft) and columns (along the warp).
///
/// ```text
///  slot = row * stride + column          top edge (row 0)
///   0 ── 1 ── 2 ── 3 ── 4   -  -  -      weft runs along a row (x), unit stride
///   │ \  │  / │ \  │  / │                warp runs down a column (−y), `stride` apart
///   8 ── 9 ──10 ──11 ──12   -  -  -      diagonals alternate, so that the mesh prefers no direction
/// ```
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Particles in a row, at least 2.
    pub columns: u32,
    /// Particles in a column, at least 2.
    pub rows: u32,
    /// Slots from one row to the next: `columns` rounded up to a multiple of 8.
    pub stride: u32,
    /// Rest distance between neighbours along the weft (x) and along the warp (y), m.
    pub spacing: Vec2,
}

impl Grid {
    /// The slot of the particle in `row` (0 at the top) and `column` (0 at the left).
    pub const fn slot(&self, row: u32, column: u32) -> u32 {
        row * self.stride + column
    }
}

/// Rest state and connectivity of one cloth. Clothes may share it; one that is taken apart gets its own.
///
/// All indices are particle slots (see [`crate::particles`]).
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Rest position of each slot, cloth frame, m. Padding repeats a neighbouring particle.
    pub rest: Vec<Vec3>,
    /// Area each particle stands for, m²; 0 for padding. A third of each of its triangles, in a rectangle a quarter of
    /// each of its cells.
    pub area: Vec<f32>,
    /// Triangles, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle its two edges `p1 − p0`, `p2 − p0` at rest as columns, in the triangle's plane with
    /// x along the weft and y along the warp, m.
    pub triangle_rest: Vec<Mat2>,
    /// Render vertices of each triangle, corner by corner.
    pub triangle_vertices: Vec<[u32; 3]>,
    /// Render vertices of the back of each triangle, corner by corner, where a mesh has another triangle there that is wound the
    /// other way; as in `triangle_vertices` where it has not. Empty if there is none.
    pub triangle_backs: Vec<[u32; 3]>,
    /// Every edge of the triangles once, `a < b`.
    pub edges: Vec<[u32; 2]>,
    /// Pairs of triangles over an inner edge: `[a, b, c, d]`, edge `a b`, `c` and `d` opposite to it. The triangle of
    /// `c` runs `a → b`, the one of `d` runs `b → a`, except across the seam of a one-sided surface, where both run
    /// `a → b`. Over an edge of three and more triangles those two bend that go on straightest, then the next two.
    pub hinges: Vec<[u32; 4]>,
    /// The triangles of each hinge: that of `c`, that of `d`.
    pub hinge_triangles: Vec<[u32; 2]>,
    /// Rest angle of each hinge, rad: 0 flat, positive where the front faces turn away from each other.
    pub hinge_rest: Vec<f32>,
    /// For each render vertex the particle it follows. Several vertices at one place (a UV seam) follow one particle. A vertex
    /// that no triangle uses has a slot here that is no particle.
    pub vertex_particle: Vec<u32>,
    /// Particles at which fans of triangles meet that share no edge there, in ascending order. They stay together until something is
    /// torn or cut at that very place.
    pub(crate) joints: Vec<u32>,
    /// What was wrong with the mesh it was made of, and was mended.
    pub mended: Mended,
    /// The rectangle's rows and columns, if it is one, or was before it was taken apart.
    pub grid: Option<Grid>,
    /// Its rows and columns of quads, if it is a mesh that has such; `None` again once it was taken apart.
    pub quads: Option<Quads>,
    /// Of a mesh with rows and columns, also after it was taken apart: the corner of each triangle that is not on the diagonal of its cell;
    /// [`NO_SQUARE`] for a part of one. Else empty.
    pub(crate) squares: Vec<u8>,
    /// Whether texture coordinates told where the warp runs.
    pub(crate) is_warp_told: bool,
    /// What is left of the rectangle, once it was taken apart.
    pub(crate) weave: Option<Box<Weave>>,
    /// How many triangles it had before it was taken apart.
    pub(crate) original_triangles: u32,
    /// Where new particles go: behind all there ever were, and the padding after them.
    pub(crate) free: u32,
}

/// See [`Topology::squares`].
pub(crate) const NO_SQUARE: u8 = 3;

impl Topology {
    /// The topology in `shared` to be changed: itself if nobody else has it, else a copy, with room for an eighth more than there
    /// is. A copy without room would be copied once more by the first of everything that is added.
    pub(crate) fn make_own(shared: &mut Arc<Self>) -> &mut Self {
        if Arc::get_mut(shared).is_none() {
            *shared = Arc::new(Self {
                rest: with_room(&shared.rest),
                area: with_room(&shared.area),
                triangles: with_room(&shared.triangles),
                triangle_rest: with_room(&shared.triangle_rest),
                triangle_vertices: with_room(&shared.triangle_vertices),
                triangle_backs: with_room(&shared.triangle_backs),
                edges: with_room(&shared.edges),
                hinges: with_room(&shared.hinges),
                hinge_triangles: with_room(&shared.hinge_triangles),
                hinge_rest: with_room(&shared.hinge_rest),
                vertex_particle: with_room(&shared.vertex_particle),
                joints: shared.joints.clone(),
                mended: shared.mended,
                grid: shared.grid,
                quads: shared.quads,
                squares: with_room(&shared.squares),
                is_warp_told: shared.is_warp_told,
                weave: shared.weave.clone(),
                original_triangles: shared.original_triangles,
                free: shared.free,
            });
        }
        Arc::make_mut(shared)
    }

    /// Number of slots, padding included.
    pub fn slots(&self) -> usize {
        self.rest.len()
    }

    /// A slot that is padding, and stays so.
    pub(crate) fn padding(&self) -> u32 {
        self.slots().saturating_sub(1) as u32
    }

    /// Number of particles, padding excluded.
    pub fn particle_count(&self) -> usize {
        self.particles().count()
    }

    /// The slots that are particles, in ascending order.
    pub fn particles(&self) -> impl Iterator<Item = u32> + '_ {
        self.area.iter().enumerate().filter(|(_, a)| **a > 0.0).map(|(i, _)| i as u32)
    }

    /// Whether `slot` is a particle.
    pub fn is_particle(&self, slot: u32) -> bool {
        self.area.get(slot as usize).is_some_and(|a| *a > 0.0)
    }
}

/// A copy with room for an eighth more.
fn with_room<T: Clone>(all: &[T]) -> Vec<T> {
    let mut copy = Vec::with_capacity(all.len() + all.len() / 8);
    copy.extend_from_slice(all);
    copy
}
