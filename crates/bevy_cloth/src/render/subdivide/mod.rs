//! Smooth subdivision: a surface finer than the simulated one, through the same particles.
//!
//! Each edge becomes a cubic curve and each triangle a cubic patch, from the positions and normals of its own particles
//! (curved PN triangles, Vlachos et al. 2001). Nothing else is looked at, so that any topology will do, and a tear parts
//! what is drawn like what is simulated. Three things differ from the paper:
//!
//! - A curve never bends more at one end than twice as much as at the other, and not at all where its ends bend to
//!   different sides. So it is convex, and what lies flat beside a fold stays flat instead of dipping below the ground.
//! - An edge of the boundary is a curve through the boundary's particles alone, without a bend at corners. So the two
//!   sides of a fresh cut remain one line.
//! - Normals on the boundary, where there are triangles on one side only, are such that the surface bends on as it does
//!   inside.

mod build;
mod curve;
#[cfg(test)]
mod tests;

use bevy::prelude::*;
use cloth_solver::Topology;

use super::surface;
use curve::Curve;

/// How much finer a cloth is drawn than it is simulated: a smooth surface through the particles.
///
/// Only the drawing changes, not the motion: a cloth of few particles looks smooth, at its silhouette and in its folds, for a small
/// part of what as many particles would cost. Hems, tears and creases stay, and what lies on a solid does not sink into it.
/// Picking hits the simulated triangles.
///
/// A component on a cloth overrides the resource [`Shared<ClothSubdivision>`](crate::Shared). May be changed at any time.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub enum ClothSubdivision {
    /// The simulated triangles. Costs nothing.
    #[default]
    None,
    /// Each edge in 2 parts: 4 times the triangles.
    X2,
    /// Each edge in 4 parts: 16 times the triangles. For cloth that is simulated coarsely or seen from near.
    X4,
}

impl ClothSubdivision {
    /// All of them, the coarsest first.
    pub const ALL: [Self; 3] = [Self::None, Self::X2, Self::X4];

    /// Into how many parts each edge is divided: 1, 2 or 4.
    pub const fn parts(self) -> u32 {
        match self {
            Self::None => 1,
            Self::X2 => 2,
            Self::X4 => 4,
        }
    }
}

/// An edge between two render vertices.
#[derive(Clone, Copy, Debug)]
struct Edge {
    vertices: [u32; 2],
    /// The particles of the vertices, in ascending order: at a UV seam both copies of an edge get the same bits.
    particles: [u32; 2],
    /// Of an edge of the boundary the rim at each end, an index into `rims` or [`CORNER`].
    rims: Option<[u32; 2]>,
}

/// In place of a rim: there the boundary has a corner, or several boundaries meet.
const CORNER: u32 = u32::MAX;

/// A triangle that gets vertices inside.
#[derive(Clone, Copy, Debug)]
struct Face {
    vertices: [u32; 3],
    particles: [u32; 3],
    /// The edges from each corner to the next.
    edges: [u32; 3],
}

/// What is drawn of a cloth whose edges are divided in 2 or 4.
///
/// The first vertices are those of the topology; those on edges follow, then those inside of triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subdivision {
    /// Into how many parts each edge is divided.
    parts: u32,
    /// Number of vertices of the topology.
    coarse: usize,
    edges: Vec<Edge>,
    faces: Vec<Face>,
    /// Particles of the boundary, each with the one, or one of those, beside it whose normal tells its own.
    fringe: Vec<[u32; 2]>,
    /// Particles of a smooth boundary, each between its neighbours on the boundary.
    rims: Vec<[u32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// As many triangles of the back, where that has vertices of its own.
    backs: Vec<[u32; 3]>,
    /// Of each rim the direction of the boundary.
    tangents: Vec<Vec3>,
    /// Of each edge.
    curves: Vec<Curve>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

impl Subdivision {
    /// Of `topology`, each edge in `parts`, at least 2.
    pub fn new(topology: &Topology, parts: u32) -> Self {
        let mut new = Self { parts: parts.max(2), ..Self::default() };
        new.rebuild(topology);
        new
    }

    /// Into how many parts each edge is divided.
    pub const fn parts(&self) -> u32 {
        self.parts
    }

    /// Triangles of the vertices drawn, wound as those of the topology, in its order.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Those of the back, wound as those of the front, in the same order.
    pub fn backs(&self) -> &[[u32; 3]] {
        if self.backs.is_empty() { &self.triangles } else { &self.backs }
    }

    /// Number of vertices drawn.
    pub fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Position of each vertex drawn, m, as [`apply`](Self::apply) found it.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Unit normal of each vertex drawn, as [`apply`](Self::apply) found it.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Finds the surface of `topology`, for which this was built, through `positions`, one for each slot. `supports` has for
    /// each slot the unit normal of the solid it lies on, or zero; towards that solid nothing is rounded. It may be empty.
    /// Fills `normals`, one for each slot, with what it has taken for unit normals there. Allocates nothing.
    pub fn apply(&mut self, topology: &Topology, positions: &[Vec3], normals: &mut [Vec3], supports: &[Vec3]) {
        surface::normals(&topology.triangles, positions, normals);
        for same in self.fringe.chunk_by(|a, b| a[0] == b[0]) {
            let bent_on = |[at, inside]: &[u32; 2]| {
                let edge = positions[*at as usize] - positions[*inside as usize];
                curve::mirrored(normals[*inside as usize], edge)
            };
            let at = same[0][0] as usize;
            normals[at] = same.iter().map(bent_on).sum::<Vec3>().normalize_or(normals[at]);
        }
        for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
            self.positions[vertex] = positions[*slot as usize];
            self.normals[vertex] = normals[*slot as usize];
        }
        for (tangent, rim) in self.tangents.iter_mut().zip(&self.rims) {
            *tangent = curve::tangent(rim.map(|slot| positions[slot as usize]));
        }
        let parts = self.parts as f32;
        let per_edge = self.parts as usize - 1;
        for (index, edge) in self.edges.iter().enumerate() {
            let [from, to] = edge.particles.map(|slot| slot as usize);
            let (ends, at_ends) = ([positions[from], positions[to]], [normals[from], normals[to]]);
            let mut curve = match edge.rims {
                None => Curve::inside(ends, at_ends),
                Some(rims) => {
                    let tangent = |rim: u32| self.tangents.get(rim as usize).copied();
                    Curve::rim(ends, at_ends, rims.map(tangent))
                }
            };
            if let (Some(first), Some(second)) = (supports.get(from), supports.get(to)) {
                curve.rest_on([*first, *second]);
            }
            for part in 0..per_edge {
                let t = (part + 1) as f32 / parts;
                let vertex = self.coarse + index * per_edge + part;
                self.positions[vertex] = curve.position(ends, t);
                self.normals[vertex] = curve.normal(at_ends, t);
            }
            self.curves[index] = curve;
        }
        let mut vertex = self.coarse + self.edges.len() * per_edge;
        for face in &self.faces {
            let curves = std::array::from_fn(|side| {
                let [from, to] = [face.particles[side], face.particles[(side + 1) % 3]];
                self.curves[face.edges[side] as usize].seen(from > to)
            });
            let corners = face.particles.map(|slot| positions[slot as usize]);
            let at_corners = face.particles.map(|slot| normals[slot as usize]);
            for weights in build::inside(self.parts) {
                self.positions[vertex] = curve::patch_position(corners, &curves, weights);
                self.normals[vertex] = curve::patch_normal(at_corners, &curves, weights);
                vertex += 1;
            }
        }
    }

    /// Fills in what the vertices on edges and inside of triangles have of something that the first of `values`, one for
    /// each vertex of the topology, are: evenly between them. `values` has one entry for each vertex drawn.
    pub fn spread<const N: usize>(&self, values: &mut [[f32; N]]) {
        if values.len() < self.vertices() {
            return;
        }
        let (known, rest) = values.split_at_mut(self.coarse);
        let mix = |parts: &[([f32; N], f32)]| -> [f32; N] {
            std::array::from_fn(|i| parts.iter().map(|(value, part)| value[i] * part).sum())
        };
        let mut rest = rest.iter_mut();
        self.between(known, mix, |value| rest.next().into_iter().for_each(|to| *to = value));
    }

    /// Adds to `values`, one for each vertex of the topology, those of the vertices on edges and inside of triangles: `mix` makes
    /// them of two or three and their weights, which add up to 1.
    pub fn fill<T: Copy>(&self, values: &mut Vec<T>, mix: impl Fn(&[(T, f32)]) -> T) {
        let mut rest = Vec::with_capacity(self.vertices().saturating_sub(self.coarse));
        if let Some(known) = values.get(..self.coarse) {
            self.between(known, mix, |value| rest.push(value));
        }
        values.append(&mut rest);
    }

    /// Makes the values of the vertices on edges and then of those inside of triangles.
    fn between<T: Copy>(&self, known: &[T], mix: impl Fn(&[(T, f32)]) -> T, mut each: impl FnMut(T)) {
        let parts = self.parts as f32;
        for edge in &self.edges {
            let [from, to] = edge.vertices.map(|vertex| known[vertex as usize]);
            for part in 1..self.parts {
                let t = part as f32 / parts;
                each(mix(&[(from, 1.0 - t), (to, t)]));
            }
        }
        for face in &self.faces {
            let [a, b, c] = face.vertices.map(|vertex| known[vertex as usize]);
            for weights in build::inside(self.parts) {
                each(mix(&[(a, weights.x), (b, weights.y), (c, weights.z)]));
            }
        }
    }
}
