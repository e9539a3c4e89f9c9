//! Cloth that passes through itself where it begins: intersection contour minimisation (Volino, Magnenat-Thalmann 2006, *Resolving
//! surface collisions through intersection contour minimization*).
//!
//! Where an edge passes through a triangle neither has a side, so that near there nothing is kept apart; instead both are moved so that the
//! line along which the surfaces intersect becomes shorter, at a bounded speed that never becomes velocity.

use std::collections::{HashMap, HashSet};

use glam::Vec3A;

use super::hierarchy::Hierarchy;
use super::nearest::Kind;
use crate::measure::{Passage, passes};
use crate::{Particles, Topology};

/// How fast two surfaces are moved against each other, m/s.
const SPEED: f32 = 0.5;

/// Where the cloth passes through itself.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Tangle {
    pub passages: Vec<Passage>,
    /// For each of them the particles opposite to the edge; twice the same at the border.
    opposite: Vec<[u32; 2]>,
    /// The pairs of features that an edge and a triangle consist of that pass through each other.
    pairs: HashSet<[u32; 4]>,
}

impl Tangle {
    /// Finds where the cloth passes through itself with its particles at `positions`.
    pub fn find(&mut self, topology: &Topology, hierarchy: &mut Hierarchy, positions: &[Vec3A]) {
        self.passages = crate::measure::passages(topology, hierarchy, positions);
        self.pairs.clear();
        for passage in &self.passages {
            let ([a, b], [c, d, e]) = (passage.edge, topology.triangles[passage.triangle as usize]);
            let pairs = [(Kind::VertexTriangle, [a, c, d, e]), (Kind::VertexTriangle, [b, c, d, e])];
            let sides = [[c, d], [d, e], [e, c]].map(|[c, d]| (Kind::EdgeEdge, [a, b, c, d]));
            self.pairs.extend(pairs.into_iter().chain(sides).map(|(kind, ids)| key(kind, ids)));
        }
        let mut beside: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
        for corners in topology.triangles.iter().filter(|_| !self.passages.is_empty()) {
            for i in 0..3 {
                let (a, b, c) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
                beside.entry([a.min(b), a.max(b)]).or_insert([c, c])[1] = c;
            }
        }
        self.opposite.clear();
        self.opposite.extend(self.passages.iter().map(|passage| beside[&passage.edge]));
    }

    /// Whether the features of a pair belong to an edge and a triangle that pass through each other.
    pub fn involves(&self, kind: Kind, ids: [u32; 4]) -> bool {
        !self.pairs.is_empty() && self.pairs.contains(&key(kind, ids))
    }
}

/// The same for every order of the particles of a feature, and of two edges.
fn key(kind: Kind, ids: [u32; 4]) -> [u32; 4] {
    match kind {
        Kind::VertexTriangle => {
            let mut corners = [ids[1], ids[2], ids[3]];
            corners.sort_unstable();
            // Apart from edges, of which the first particle is the smallest.
            [ids[0] | 1 << 31, corners[0], corners[1], corners[2]]
        }
        Kind::EdgeEdge => {
            let [a, b, c, d] = ids;
            let mut edges = [[a.min(b), a.max(b)], [c.min(d), c.max(d)]];
            edges.sort_unstable();
            [edges[0][0], edges[0][1], edges[1][0], edges[1][1]]
        }
    }
}

/// Moves the surfaces so that the lines in which they intersect become shorter.
pub(super) fn untangle(tangle: &Tangle, topology: &Topology, particles: &mut Particles, h: f32) {
    for (passage, [first, second]) in tangle.passages.iter().zip(&tangle.opposite) {
        let corners = topology.triangles[passage.triangle as usize];
        let at = |slot: u32| Vec3A::from(particles.position.get(slot as usize));
        let ([from, to], triangle) = (passage.edge.map(at), corners.map(at));
        if !passes(from, to, triangle) {
            continue;
        }
        let [a, b, c] = triangle;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let along = (to - from).normalize_or_zero();
        let steep = along.dot(normal);
        if steep.abs() < 1e-3 {
            continue;
        }
        let s = normal.dot(a - from) / normal.dot(to - from);
        let point = from.lerp(to, s);
        // The line of intersection leaves the edge into each of its triangles.
        let mut gradient = Vec3A::ZERO;
        let opposite = [*first, *second];
        for opposite in &opposite[usize::from(first == second)..] {
            let into = at(*opposite) - from;
            let across = along.cross(into).normalize_or_zero().cross(normal).normalize_or_zero();
            let inward = into - along * along.dot(into);
            let line = if across.dot(inward) < 0.0 { -across } else { across };
            gradient += line - normal * (2.0 * along.dot(line) / steep);
        }
        let length = gradient.length();
        if length < 1e-6 {
            continue;
        }
        let move_by = gradient / length * (SPEED * h * (length / 0.5).min(1.0));
        let [u, v] = barycentric(triangle, point, normal);
        let ids = [passage.edge[0], passage.edge[1], corners[0], corners[1], corners[2]];
        let weights = [1.0 - s, s, u + v - 1.0, -u, -v];
        let inertia: f32 = (0..5).map(|i| particles.inverse_mass[ids[i] as usize] * weights[i] * weights[i]).sum();
        if inertia <= 0.0 {
            continue;
        }
        for i in 0..5 {
            let slot = ids[i] as usize;
            let shift = move_by * (particles.inverse_mass[slot] * weights[i] / inertia);
            let x = Vec3A::from(particles.position.get(slot)) + shift;
            particles.position.set(slot, x.into());
        }
    }
}

/// The weights of the second and the third corner at a point of the triangle.
fn barycentric([a, b, c]: [Vec3A; 3], point: Vec3A, normal: Vec3A) -> [f32; 2] {
    let whole = (b - a).cross(c - a).dot(normal);
    let part = |p: Vec3A, q: Vec3A| p.cross(q).dot(normal) / whole;
    [part(point - a, c - a), part(b - a, point - a)]
}
