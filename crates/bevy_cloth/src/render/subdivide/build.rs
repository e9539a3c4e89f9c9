//! From a topology to the edges, boundaries and triangles of a finer one.

use bevy::prelude::*;
use cloth_solver::Topology;

use super::curve::Curve;
use super::{CORNER, Edge, Face, Subdivision};

/// Where the boundary at rest turns by more than this, the cosine of 45°, it has a corner.
const STRAIGHTEST_CORNER: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Edges inside from the boundary count if the sine of their angle to it is at least this part of that of the best one.
const NEARLY: f32 = 0.95;

/// No particle.
const NONE: u32 = u32::MAX;

/// A side of a triangle, ends in ascending order of their particles.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// The particle of the second end.
    high: u32,
    vertices: [u32; 2],
    /// Three times the triangle, and the corner it begins at.
    index: u32,
}

/// The barycentric coordinates of the vertices inside a triangle whose edges are divided in `parts`.
pub(super) fn inside(parts: u32) -> impl Iterator<Item = Vec3> {
    let of = move |i, j| Vec3::new((parts - i - j) as f32, i as f32, j as f32) / parts as f32;
    (1..parts).flat_map(move |j| (1..parts - j).map(move |i| of(i, j)))
}

impl Subdivision {
    /// Takes over another topology, keeping the allocations.
    pub fn rebuild(&mut self, topology: &Topology) {
        self.coarse = topology.vertex_particle.len();
        let own_backs = own_backs(topology);
        let drawn: Vec<([u32; 3], [u32; 3])> = (topology.triangles.iter().zip(&topology.triangle_vertices))
            .chain(own_backs.iter().map(|at| (&topology.triangles[*at], &topology.triangle_backs[*at])))
            .map(|(particles, vertices)| (*particles, *vertices))
            .collect();
        let (edge_of_side, boundary) = self.find_edges(topology, &drawn);
        self.find_rims(topology, &boundary);
        self.find_triangles(&drawn, &edge_of_side);
        self.divide_backs(topology.triangles.len(), &own_backs);
        let vertices =
            self.coarse + self.edges.len() * (self.parts as usize - 1) + self.faces.len() * inside(self.parts).count();
        self.tangents.resize(self.rims.len(), Vec3::ZERO);
        self.curves.resize(self.edges.len(), Curve::default());
        self.positions.resize(vertices, Vec3::ZERO);
        self.normals.resize(vertices, Vec3::Z);
    }

    /// Finds every edge. Tells the edge of each side of a triangle, and which edges are the boundary.
    fn find_edges(&mut self, topology: &Topology, drawn: &[([u32; 3], [u32; 3])]) -> (Vec<u32>, Vec<u32>) {
        let (sides, of_front) = (3 * drawn.len(), 3 * topology.triangles.len() as u32);
        // Sorted by the first particle by counting, then the few that begin there by the second.
        let mut ends = vec![0_u32; topology.slots() + 1];
        let pair = |triangle: &[u32; 3], corner: usize| [triangle[corner], triangle[(corner + 1) % 3]];
        for (triangle, _) in drawn {
            for corner in 0..3 {
                let [a, b] = pair(triangle, corner);
                ends[a.min(b) as usize + 1] += 1;
            }
        }
        for low in 1..ends.len() {
            ends[low] += ends[low - 1];
        }
        let mut sorted = vec![Side::default(); sides];
        for (triangle, (particles, vertices)) in drawn.iter().enumerate() {
            for corner in 0..3 {
                let [a, b] = pair(particles, corner);
                let [first, second] = pair(vertices, corner);
                let vertices = if a < b { [first, second] } else { [second, first] };
                let place = &mut ends[a.min(b) as usize];
                sorted[*place as usize] = Side { high: a.max(b), vertices, index: (3 * triangle + corner) as u32 };
                *place += 1;
            }
        }
        self.edges.clear();
        let (mut edge_of_side, mut boundary) = (vec![0; sides], Vec::new());
        let mut begin = 0;
        for (low, end) in ends.iter().take(topology.slots()).enumerate() {
            let here = &mut sorted[begin..*end as usize];
            begin = *end as usize;
            here.sort_unstable_by_key(|side| (side.high, side.vertices));
            for same in here.chunk_by(|a, b| a.high == b.high) {
                if same.iter().filter(|side| side.index < of_front).count() == 1 {
                    boundary.push(self.edges.len() as u32);
                }
                for copy in same.chunk_by(|a, b| a.vertices == b.vertices) {
                    for side in copy {
                        edge_of_side[side.index as usize] = self.edges.len() as u32;
                    }
                    let particles = [low as u32, copy[0].high];
                    self.edges.push(Edge { vertices: copy[0].vertices, particles, rims: None });
                }
            }
        }
        (edge_of_side, boundary)
    }

    /// Finds where the boundary goes on smoothly from one edge to the next.
    fn find_rims(&mut self, topology: &Topology, boundary: &[u32]) {
        self.rims.clear();
        let mut links = vec![[NONE; 2]; topology.slots()];
        let mut rim_of = vec![CORNER; topology.slots()];
        let mut on_boundary = vec![false; topology.slots()];
        let mut meets_several = Vec::new();
        for edge in boundary {
            let [a, b] = self.edges[*edge as usize].particles;
            for [at, other] in [[a, b], [b, a]] {
                on_boundary[at as usize] = true;
                match &mut links[at as usize] {
                    [first, _] if *first == NONE => *first = other,
                    [_, second] if *second == NONE => *second = other,
                    _ => meets_several.push(at),
                }
            }
        }
        for at in meets_several {
            links[at as usize] = [NONE; 2];
        }
        for edge in boundary {
            for at in self.edges[*edge as usize].particles {
                let [before, after] = links[at as usize];
                if rim_of[at as usize] != CORNER || before == NONE || after == NONE {
                    continue;
                }
                let [p, q, r] = [before, at, after].map(|slot| topology.rest[slot as usize]);
                if (q - p).normalize_or_zero().dot((r - q).normalize_or_zero()) >= STRAIGHTEST_CORNER {
                    rim_of[at as usize] = self.rims.len() as u32;
                    self.rims.push([before, at, after]);
                }
            }
        }
        for edge in boundary {
            let edge = &mut self.edges[*edge as usize];
            edge.rims = Some(edge.particles.map(|slot| rim_of[slot as usize]));
        }
        self.find_fringe(topology, &links, &rim_of, &on_boundary);
    }

    /// Finds which edge goes straight inside from each particle of the boundary, or which two or more do nearly. From a corner between
    /// smooth boundaries those are followed, after all else.
    fn find_fringe(&mut self, topology: &Topology, links: &[[u32; 2]], rim_of: &[u32], on_boundary: &[bool]) {
        let rest = |slot: u32| topology.rest[slot as usize];
        let is_corner = |at: u32| {
            let is_smooth = |link: u32| link != NONE && rim_of[link as usize] != CORNER;
            rim_of[at as usize] == CORNER && links[at as usize].into_iter().all(is_smooth)
        };
        let mut found = Vec::new();
        for Edge { particles: [a, b], .. } in &self.edges {
            let (at, inside) = match [a, b].map(|at| on_boundary[*at as usize]) {
                [true, false] => (*a, *b),
                [false, true] => (*b, *a),
                _ => continue,
            };
            if is_corner(at) {
                continue;
            }
            let [before, after] = links[at as usize];
            let straight = if before == NONE || after == NONE {
                1.0
            } else {
                let boundary = (rest(after) - rest(before)).normalize_or_zero();
                (rest(inside) - rest(at)).normalize_or_zero().cross(boundary).length()
            };
            found.push((at, inside, straight));
        }
        found.sort_unstable_by_key(|(at, inside, _)| [*at, *inside]);
        found.dedup();
        self.fringe.clear();
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let best = same.iter().map(|(.., straight)| *straight).fold(0.0, f32::max);
            let straightest = same.iter().filter(|(.., straight)| *straight >= NEARLY * best);
            self.fringe.extend(straightest.map(|(at, inside, _)| [*at, *inside]));
        }
        let corners = (0..).zip(on_boundary).filter(|(at, on_boundary)| **on_boundary && is_corner(*at));
        self.fringe.extend(corners.flat_map(|(at, _)| links[at as usize].map(|link| [at, link])));
    }

    /// Lists the triangles drawn.
    fn find_triangles(&mut self, drawn: &[([u32; 3], [u32; 3])], edge_of_side: &[u32]) {
        self.triangles.clear();
        self.faces.clear();
        let parts = self.parts as usize;
        let inside_each = inside(self.parts).count();
        let first_inside = self.coarse + self.edges.len() * (parts - 1);
        let (sides, _) = edge_of_side.as_chunks::<3>();
        for (triangle, ((particles, vertices), edges)) in drawn.iter().zip(sides).enumerate() {
            let on_edge = |side: usize, part: usize| {
                let [from, to] = [particles[side], particles[(side + 1) % 3]];
                let part = if from < to { part } else { parts - part };
                (self.coarse + edges[side] as usize * (parts - 1) + part - 1) as u32
            };
            // The vertex `i` parts from the first corner towards the second and `j` towards the third.
            let vertex = |i: usize, j: usize| match (i, j) {
                (0, 0) => vertices[0],
                (i, 0) if i == parts => vertices[1],
                (0, j) if j == parts => vertices[2],
                (i, 0) => on_edge(0, i),
                (0, j) => on_edge(2, parts - j),
                (i, j) if i + j == parts => on_edge(1, j),
                (i, j) => {
                    let rows_before: usize = (1..j).map(|row| parts - 1 - row).sum();
                    (first_inside + triangle * inside_each + rows_before + i - 1) as u32
                }
            };
            for j in 0..parts {
                for i in 0..parts - j {
                    self.triangles.push([vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)]);
                    if i + j + 1 < parts {
                        self.triangles.push([vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                    }
                }
            }
            if inside_each > 0 {
                self.faces.push(Face { vertices: *vertices, particles: *particles, edges: *edges });
            }
        }
    }

    /// Parts the triangles of the back from those of the front, behind which they were listed.
    fn divide_backs(&mut self, triangles: usize, own_backs: &[usize]) {
        self.backs.clear();
        if own_backs.is_empty() {
            return;
        }
        let each = (self.parts * self.parts) as usize;
        let own = self.triangles.split_off(each * triangles);
        self.backs.clone_from(&self.triangles);
        for (at, own) in own_backs.iter().zip(own.chunks_exact(each)) {
            self.backs[each * at..each * (at + 1)].copy_from_slice(own);
        }
    }
}

/// The triangles whose back has other vertices than the front.
fn own_backs(topology: &Topology) -> Vec<usize> {
    let pairs = topology.triangle_vertices.iter().zip(&topology.triangle_backs).enumerate();
    pairs.filter(|(_, (front, back))| front != back).map(|(triangle, _)| triangle).collect()
}
