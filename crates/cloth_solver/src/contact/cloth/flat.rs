//! Which patches of triangles are so flat that they cannot meet themselves, nor one another.
//!
//! Normals do not say so (Volino, Magnenat-Thalmann 1994): long thin triangles that are sheared in their plane overlap though all face one way.
//! The deformation gradients do. Let `x` be where the point `X` of the flat rest shape is, and `F` the gradient of that. If for all
//! triangles `d·QF d ≥ m |d|²`, with one plane `Q` and `m > 0`, then along the straight way from `X` to `Y`
//! `|x − y| ≥ m |X − Y|`: no two points meet. Particles that move evenly change `F` evenly, so that it holds from one time to
//! another if it holds at both; and how far they may be off their paths bounds how far `F` may be off. Where a cut leaves two sides
//! at one place of the rest shape, or the way from point to point leaves the cloth, flatness says nothing.

use std::collections::HashMap;

use glam::{Mat2, Vec2, Vec3, Vec3A};

use super::hierarchy::PATCH;
use crate::Topology;

/// The least part of their distance at rest that the points of a flat patch keep.
const FLAT: f32 = 0.1;

/// The largest angle at the border, rad, that a patch may have: a straight border with room for rounding and for one that curves.
const REFLEX: f32 = 200.0 * std::f32::consts::PI / 180.0;

/// How flat a patch is.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Flatness {
    /// It is never flat: a particle of it stands where another one stands at rest, which it does not hang on, or a straight way in it may
    /// leave the cloth.
    is_slit: bool,
    /// The edges of each triangle at rest in its plane, inverted, 1/m.
    rests: Vec<Mat2>,
    /// The smallest height of a triangle at rest, m.
    height: f32,
    /// How far the planes of its triangles are from being one, dimensionless: of what is curved at rest.
    curl: f32,
    /// Its gradients now and later.
    gradients: [Gradients; 2],
}

/// The deformation gradients of the triangles of a patch.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
struct Gradients {
    /// The columns of their mean: along the weft and along the warp.
    mean: [Vec3A; 2],
    /// By how much any may be off it.
    spread: f32,
}

impl Gradients {
    /// Those of `triangles` with these inverted edges at rest; each may be off by `turn`.
    fn new(topology: &Topology, triangles: &[u32], rests: &[Mat2], positions: &[Vec3A], turn: f32) -> Self {
        let mut all = [[Vec3A::ZERO; 2]; PATCH];
        let all = &mut all[..triangles.len()];
        let mut mean = [Vec3A::ZERO; 2];
        for ((gradient, triangle), rest) in all.iter_mut().zip(triangles).zip(rests) {
            let [a, b, c] = topology.triangles[*triangle as usize].map(|slot| positions[slot as usize]);
            let (first, second) = (b - a, c - a);
            *gradient =
                [first * rest.x_axis.x + second * rest.x_axis.y, first * rest.y_axis.x + second * rest.y_axis.y];
            (mean[0], mean[1]) = (mean[0] + gradient[0], mean[1] + gradient[1]);
        }
        let mean = mean.map(|sum| sum / all.len() as f32);
        let off = |of: &[Vec3A; 2]| of[0].distance_squared(mean[0]) + of[1].distance_squared(mean[1]);
        Self { mean, spread: all.iter().map(off).fold(0.0, f32::max).sqrt() + turn }
    }

    /// The least part of their distance at rest that two points of it keep as seen along these two axes.
    fn least(&self, [first, second]: [Vec3A; 2]) -> f32 {
        let [x, y] = self.mean;
        let (a, d, both) = (first.dot(x), second.dot(y), 0.5 * (first.dot(y) + second.dot(x)));
        0.5 * (a + d) - (0.25 * (a - d) * (a - d) + both * both).sqrt() - self.spread
    }
}

/// The axes of the plane that a gradient turns the weft and the warp into, without the stretch and the shear.
fn plane([x, y]: [Vec3A; 2]) -> [Vec3A; 2] {
    // The polar decomposition of two columns: they times the inverse root of their products with each other.
    let (xx, xy, yy) = (x.dot(x), x.dot(y), y.dot(y));
    let root = (xx * yy - xy * xy).max(0.0).sqrt();
    let scale = 1.0 / (root * (xx + yy + 2.0 * root).sqrt());
    [(x * (yy + root) - y * xy) * scale, (y * (xx + root) - x * xy) * scale]
}

impl Flatness {
    /// Of a patch of these triangles, [`PATCH`] at most, with these particles.
    pub fn new(topology: &Topology, triangles: &[u32], particles: &[u32], creases: &Creases) -> Self {
        let rests = || triangles.iter().map(|triangle| &topology.triangle_rest[*triangle as usize]);
        Self {
            is_slit: particles.iter().any(|slot| creases.is_slit[*slot as usize])
                || !hang_together(topology, triangles, particles),
            rests: rests().map(Mat2::inverse).collect(),
            height: rests().map(height).fold(f32::MAX, f32::min),
            curl: triangles.iter().map(|triangle| creases.curls[*triangle as usize]).fold(0.0, f32::max),
            gradients: Default::default(),
        }
    }

    /// Finds it for those triangles, with their particles at these places now and later or as many metres off as `reach`.
    pub fn find(&mut self, topology: &Topology, triangles: &[u32], positions: [&[Vec3A]; 2], reach: f32) {
        if !self.is_slit {
            // Both ends of a height may be off.
            let turn = 2.0 * reach / self.height;
            self.gradients =
                positions.map(|positions| Gradients::new(topology, triangles, &self.rests, positions, turn));
        }
    }

    /// Whether two patches that hang together, or one and itself, are flat as one.
    pub fn is_one_with(&self, other: &Self) -> bool {
        if self.is_slit || other.is_slit {
            return false;
        }
        let all = || self.gradients.iter().chain(&other.gradients);
        let axes = plane([0, 1].map(|axis| all().map(|gradients| gradients.mean[axis]).sum()));
        let curl = self.curl.max(other.curl);
        // What is not a number is not flat.
        all().all(|gradients| gradients.least(axes) >= FLAT + curl)
    }
}

/// What keeps patches of a topology from being flat.
pub(super) struct Creases {
    /// By slot: see [`Flatness::is_slit`].
    is_slit: Vec<bool>,
    /// By triangle: see [`Flatness::curl`].
    curls: Vec<f32>,
}

impl Creases {
    pub fn new(topology: &Topology) -> Self {
        let mut is_slit = doubled(topology);
        find_reflex(topology, &mut is_slit);
        Self { is_slit, curls: curls(topology) }
    }
}

/// Whether one comes from each triangle to every other over particles that they share.
fn hang_together(topology: &Topology, triangles: &[u32], particles: &[u32]) -> bool {
    let corners = |triangle: &u32| {
        let at = topology.triangles[*triangle as usize].map(|slot| particles.partition_point(|other| *other < slot));
        at.iter().fold(0_u64, |all, at| all | 1 << at)
    };
    let (mut reached, mut left): (u64, Vec<u64>) = (0, triangles.iter().map(corners).collect());
    while let Some(at) = left.iter().position(|corners| reached == 0 || reached & corners != 0) {
        reached |= left.swap_remove(at);
    }
    left.is_empty()
}

/// The smallest height of a triangle of which these are two edges, m.
fn height(edges: &Mat2) -> f32 {
    let [a, b] = [edges.x_axis, edges.y_axis];
    edges.determinant().abs() / a.length().max(b.length()).max(a.distance(b))
}

/// Adds the slots at which the border of the cloth turns inwards, or fans of triangles meet that share no edge there.
fn find_reflex(topology: &Topology, is_slit: &mut [bool]) {
    // At the border there are more edges than hinges.
    let mut edges = vec![0_i32; topology.slots()];
    topology.edges.iter().flatten().for_each(|slot| edges[*slot as usize] += 1);
    topology.hinges.iter().flat_map(|hinge| &hinge[..2]).for_each(|slot| edges[*slot as usize] -= 1);
    let mut angles = vec![0.0_f32; topology.slots()];
    for (corners, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
        let places = [Vec2::ZERO, rest.x_axis, rest.y_axis];
        for (i, slot) in corners.iter().enumerate() {
            let [a, b] = [1, 2].map(|next| places[(i + next) % 3] - places[i]);
            angles[*slot as usize] += a.angle_to(b).abs();
        }
    }
    for (slot, is_slit) in is_slit.iter_mut().enumerate() {
        *is_slit |= edges[slot] > 0 && angles[slot] > REFLEX;
    }
    topology.joints.iter().for_each(|slot| is_slit[*slot as usize] = true);
}

/// For each triangle how far its plane, spread out with that of a neighbour, is turned against it: times the triangles across a patch.
fn curls(topology: &Topology) -> Vec<f32> {
    let mut curls = vec![0.0_f32; topology.triangles.len()];
    for ([a, b, ..], triangles) in topology.hinges.iter().zip(&topology.hinge_triangles) {
        let edges = triangles.map(|triangle| {
            let rest = topology.triangle_rest[triangle as usize];
            let corners = topology.triangles[triangle as usize];
            let places = [Vec2::ZERO, rest.x_axis, rest.y_axis];
            let place = |slot: u32| corners.iter().position(|corner| *corner == slot).map_or(Vec2::NAN, |i| places[i]);
            place(*b) - place(*a)
        });
        let curl = (PATCH as f32).sqrt() * edges[0].distance(edges[1]) / edges[0].length();
        for triangle in triangles {
            let of = &mut curls[*triangle as usize];
            // What is not a number stays one.
            *of = if *of >= curl { *of } else { curl };
        }
    }
    curls
}

/// For each slot whether another particle stands nearer to it at rest than a tenth of the mean edge.
fn doubled(topology: &Topology) -> Vec<bool> {
    let lengths = topology.edges.iter().map(|&[a, b]| topology.rest[a as usize].distance(topology.rest[b as usize]));
    let edge = lengths.sum::<f32>() / topology.edges.len().max(1) as f32;
    let (near, edge) = (0.1 * edge, edge.max(f32::MIN_POSITIVE));
    // Off the places where the rows and columns of a rectangle are: there few particles are near the next cell.
    let cell = |x: Vec3| (x / edge + 0.37).floor().as_ivec3();
    let mut last_in: HashMap<glam::IVec3, u32> = HashMap::with_capacity(topology.slots());
    let mut before = vec![u32::MAX; topology.slots()];
    for slot in topology.particles() {
        let last = last_in.insert(cell(topology.rest[slot as usize]), slot);
        before[slot as usize] = last.unwrap_or(u32::MAX);
    }
    let mut is_doubled = vec![false; topology.slots()];
    for slot in topology.particles() {
        let x = topology.rest[slot as usize];
        let (low, high) = (cell(x - near), cell(x + near));
        for i in low.x..=high.x {
            for j in low.y..=high.y {
                for k in low.z..=high.z {
                    let mut other = last_in.get(&glam::IVec3::new(i, j, k)).copied().unwrap_or(u32::MAX);
                    while let Some(rest) = topology.rest.get(other as usize) {
                        is_doubled[slot as usize] |= other != slot && rest.distance(x) < near;
                        other = before[other as usize];
                    }
                }
            }
        }
    }
    is_doubled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Bounds, Hierarchy};
    use crate::measure::passages;
    use crate::topology::{MeshSource, Resolution};
    use glam::UVec2;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn rectangle(cells: UVec2, cell: Vec2) -> Topology {
        Topology::rectangle(cell * cells.as_vec2(), Resolution::Cells(cells)).unwrap()
    }

    /// Fitted to particles that go from `now` to `later`, as many metres off as `reach`.
    fn fitted(topology: &Topology, now: &[Vec3A], later: &[Vec3A], reach: f32) -> Hierarchy {
        let mut hierarchy = Hierarchy::new(topology);
        let around = Vec3A::splat(reach);
        let bounds: Vec<Bounds> =
            (now.iter().zip(later)).map(|(a, b)| Bounds { min: a.min(*b) - around, max: a.max(*b) + around }).collect();
        hierarchy.refit(topology, &bounds, false);
        hierarchy.find_flat(topology, now, later, &vec![reach; topology.slots()], false);
        hierarchy
    }

    /// Whether it leaves out all pairs within patches and between neighbours.
    fn is_flat(hierarchy: &Hierarchy) -> bool {
        let neighbors = |patch: usize| hierarchy.neighbors_of(patch).iter().map(move |other| (patch as u32, *other));
        (0..hierarchy.patches()).flat_map(neighbors).all(|(a, b)| hierarchy.are_flat(a, b))
    }

    #[test]
    fn what_is_bent_sheared_and_stretched_a_little_is_flat() {
        let topology = rectangle(UVec2::new(24, 18), Vec2::new(0.02, 0.03));
        let bent = |x: &Vec3| Vec3A::new(1.1 * x.x + 0.2 * x.y, x.y, 0.1 * (3.0 * x.x).sin());
        let now: Vec<Vec3A> = topology.rest.iter().map(bent).collect();
        let turned: Vec<Vec3A> = now.iter().map(|x| Vec3A::new(x.z, x.x, x.y)).collect();
        assert!(is_flat(&fitted(&topology, &now, &now, 0.003)));
        assert!(is_flat(&fitted(&topology, &turned, &turned, 0.003)));
        let flipped: Vec<Vec3A> = now.iter().map(|x| Vec3A::new(-x.x, x.y, -x.z)).collect();
        assert!(!is_flat(&fitted(&topology, &now, &flipped, 0.003)), "half way it lies in a line");
    }

    #[test]
    fn a_notch_is_not_flat_although_all_lies_in_one_plane() {
        // The two sides of it may slide over each other, and nothing turns.
        let mut topology = rectangle(UVec2::new(5, 2), Vec2::splat(0.02));
        let whole = fitted(&topology, &places(&topology), &places(&topology), 0.0);
        assert!((0..whole.patches() as u32).any(|patch| whole.are_flat(patch, patch)));
        let middle = |corners: &[u32; 3]| corners.iter().map(|slot| topology.rest[*slot as usize]).sum::<Vec3>() / 3.0;
        let cut: Vec<[u32; 3]> = topology
            .triangles
            .iter()
            .copied()
            .filter(|corners| middle(corners).x.abs() > 0.01 || middle(corners).y < 0.0)
            .collect();
        let vertices: Vec<Vec3> = topology.rest.clone();
        let indices: Vec<u32> = cut.into_flattened();
        topology = Topology::from_mesh(MeshSource { positions: &vertices, indices: &indices, uvs: &[] }).unwrap();
        let notched = fitted(&topology, &places(&topology), &places(&topology), 0.0);
        assert!((0..notched.patches() as u32).all(|patch| !notched.are_flat(patch, patch)));
    }

    fn places(topology: &Topology) -> Vec<Vec3A> {
        topology.rest.iter().map(|x| Vec3A::from(*x)).collect()
    }

    fn vector() -> impl Strategy<Value = Vec3> {
        [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(Vec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn flatness_hides_no_crossing(
            columns in 2_u32..9, rows in 2_u32..9, shape in 0.08_f32..1.0,
            bend in vector(), shear in vector(), amount in 0.0_f32..2.0, off in prop::collection::vec((vector(), vector()), 81),
        ) {
            let cell = Vec2::new(0.02 * shape, 0.02);
            let topology = rectangle(UVec2::new(columns, rows), cell);
            let place = |off: &dyn Fn(usize) -> Vec3, bend: f32| -> Vec<Vec3A> {
                let moved = (0..topology.slots()).map(|slot| {
                    let x = topology.rest[slot];
                    let bent = Vec3::Z * (bend * (x.x * x.x + x.x * x.y) / cell.y);
                    // Along the longer side of a cell, as what is sheared.
                    let noise = off(slot % 81) * Vec3::new(cell.x, cell.y, cell.x);
                    Vec3A::from(x + shear * x.y + bent + noise * amount)
                });
                moved.collect()
            };
            let now = place(&|slot| off[slot].0, bend.x);
            let later = place(&|slot| off[slot].1, bend.y);
            let mut hierarchy = fitted(&topology, &now, &later, 0.0);
            for t in [0.0, 0.3, 0.7, 1.0] {
                let at: Vec<Vec3A> = now.iter().zip(&later).map(|(a, b)| a.lerp(*b, t)).collect();
                let mut all = Hierarchy::new(&topology);
                all.refit(&topology, &at.iter().map(|x| Bounds { min: *x, max: *x }).collect::<Vec<_>>(), false);
                prop_assert_eq!(passages(&topology, &mut hierarchy, &at), passages(&topology, &mut all, &at));
            }
        }
    }
}
