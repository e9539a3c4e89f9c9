//! Which triangles of a cloth may meet: patches of triangles that hang together, in a hierarchy of boxes.
//!
//! A patch that is nearly flat, and so with its neighbours, cannot meet itself: of a curtain at rest nothing is left to look at. Normals
//! do not say so (Volino, Magnenat-Thalmann 1994): long thin triangles that are sheared in their plane overlap though all face one way.
//! The deformation gradients do. Let `x` be where the point `X` of the flat rest shape is, and `F` the gradient of that. If for all
//! triangles `d·QF d ≥ m |d|²`, with one plane `Q` and `m > 0`, then along the straight way from `X` to `Y`
//! `|x − y| ≥ m |X − Y|`: no two points meet. Particles that move evenly change `F` evenly, so that it holds from one time to
//! another if it holds at both; and how far they may be off their paths bounds how far `F` may be off. Where a cut leaves two sides
//! at one place of the rest shape, or the way from point to point leaves the cloth, flatness says nothing.

use std::collections::HashMap;

use glam::{Mat2, Vec2, Vec3, Vec3A};

use crate::Topology;

/// Triangles in a patch at most.
const PATCH: usize = 16;

/// The least part of their distance at rest that the points of a flat patch keep.
const FLAT: f32 = 0.1;

/// The largest angle at the border, rad, that a patch may have: a straight border with room for rounding and for one that curves.
const REFLEX: f32 = 200.0 * std::f32::consts::PI / 180.0;

/// An axis-aligned box, m.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub min: Vec3A,
    pub max: Vec3A,
}

impl Bounds {
    pub const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    #[inline(always)]
    pub fn join(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline(always)]
    pub fn overlaps(&self, other: &Self) -> bool {
        (self.min.cmple(other.max) & other.min.cmple(self.max)).all()
    }

    #[inline(always)]
    fn size(&self) -> f32 {
        (self.max - self.min).element_sum()
    }
}

/// A node of the hierarchy.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Of a leaf its patch, else the second child; the first child comes next.
    next: u32,
    is_leaf: bool,
    /// Whether there is a marked patch in it.
    is_marked: bool,
}

/// Triangles near each other.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Patch {
    triangles: Vec<u32>,
    /// Their corners, each once.
    particles: Vec<u32>,
    /// Patches that share a particle with it, itself included, in ascending order.
    neighbors: Vec<u32>,
    /// Whether flatness says nothing of it: a particle of it stands where another one stands at rest, which it does not hang on, or a
    /// straight way in it may leave the cloth.
    is_slit: bool,
    /// The edges of each triangle at rest in its plane, inverted, 1/m.
    rests: Vec<Mat2>,
    /// The smallest height of a triangle at rest, m.
    height: f32,
    /// How far the planes of its triangles are from being one, dimensionless: of what is curved at rest.
    curl: f32,
    /// Their gradients now and later.
    gradients: [Gradients; 2],
    /// A particle of it has left its path.
    is_marked: bool,
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

impl Patch {
    fn gradients(&self, topology: &Topology, positions: &[Vec3A], reach: f32) -> Gradients {
        let mut all = [[Vec3A::ZERO; 2]; PATCH];
        let all = &mut all[..self.triangles.len()];
        let mut mean = [Vec3A::ZERO; 2];
        for ((gradient, triangle), rest) in all.iter_mut().zip(&self.triangles).zip(&self.rests) {
            let [a, b, c] = topology.triangles[*triangle as usize].map(|slot| positions[slot as usize]);
            let (first, second) = (b - a, c - a);
            *gradient =
                [first * rest.x_axis.x + second * rest.x_axis.y, first * rest.y_axis.x + second * rest.y_axis.y];
            (mean[0], mean[1]) = (mean[0] + gradient[0], mean[1] + gradient[1]);
        }
        let mean = mean.map(|sum| sum / all.len() as f32);
        let off = |of: &[Vec3A; 2]| of[0].distance_squared(mean[0]) + of[1].distance_squared(mean[1]);
        let spread = all.iter().map(off).fold(0.0, f32::max).sqrt();
        // Both ends of a height may be off.
        Gradients { mean, spread: spread + 2.0 * reach / self.height }
    }
}

impl Gradients {
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

/// The triangles of a topology in patches, and these in a hierarchy of boxes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    bounds: Vec<Bounds>,
    /// By triangle.
    triangle_bounds: Vec<Bounds>,
    patches: Vec<Patch>,
    stack: Vec<[u32; 2]>,
}

impl Hierarchy {
    /// A hierarchy over the triangles of `topology`, by their place in the rest shape.
    pub fn new(topology: &Topology) -> Self {
        let centroids: Vec<Vec3> = (topology.triangles.iter())
            .map(|corners| corners.iter().map(|slot| topology.rest[*slot as usize]).sum::<Vec3>() / 3.0)
            .collect();
        let mut order: Vec<u32> = (0..topology.triangles.len() as u32).collect();
        let mut hierarchy = Self::default();
        if !order.is_empty() {
            hierarchy.split(topology, &centroids, &mut order);
        }
        hierarchy.bounds = vec![Bounds::EMPTY; hierarchy.nodes.len()];
        hierarchy.find_neighbors(topology);
        hierarchy
    }

    /// Adds the node over `run` and all below it: halves by the median along the widest axis.
    fn split(&mut self, topology: &Topology, centroids: &[Vec3], run: &mut [u32]) {
        let node = self.nodes.len();
        if run.len() <= PATCH {
            self.nodes.push(Node { next: self.patches.len() as u32, is_leaf: true, is_marked: false });
            let mut particles: Vec<u32> = run.iter().flat_map(|t| topology.triangles[*t as usize]).collect();
            particles.sort_unstable();
            particles.dedup();
            run.sort_unstable();
            self.patches.push(Patch { triangles: run.to_vec(), particles, ..Patch::default() });
            return;
        }
        self.nodes.push(Node { next: 0, is_leaf: false, is_marked: false });
        let all = run.iter().map(|triangle| centroids[*triangle as usize]);
        let size = all.clone().fold(Vec3::NEG_INFINITY, Vec3::max) - all.fold(Vec3::INFINITY, Vec3::min);
        let (axis, half) = (size.max_position(), run.len() / 2);
        let key = |triangle: &u32| centroids[*triangle as usize][axis];
        run.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (low, high) = run.split_at_mut(half);
        self.split(topology, centroids, low);
        self.nodes[node].next = self.nodes.len() as u32;
        self.split(topology, centroids, high);
    }

    fn find_neighbors(&mut self, topology: &Topology) {
        let mut patches_at: Vec<Vec<u32>> = vec![Vec::new(); topology.slots()];
        for (patch, Patch { particles, .. }) in self.patches.iter().enumerate() {
            particles.iter().for_each(|slot| patches_at[*slot as usize].push(patch as u32));
        }
        let mut is_slit = doubled(topology);
        find_reflex(topology, &mut is_slit);
        let curls = curls(topology);
        for patch in &mut self.patches {
            patch.neighbors =
                patch.particles.iter().flat_map(|slot| patches_at[*slot as usize].iter().copied()).collect();
            patch.neighbors.sort_unstable();
            patch.neighbors.dedup();
            patch.is_slit =
                patch.particles.iter().any(|slot| is_slit[*slot as usize]) || !patch.hangs_together(topology);
            let triangles = || patch.triangles.iter().map(|triangle| *triangle as usize);
            patch.rests = triangles().map(|triangle| topology.triangle_rest[triangle].inverse()).collect();
            patch.height =
                triangles().map(|triangle| height(&topology.triangle_rest[triangle])).fold(f32::MAX, f32::min);
            patch.curl = triangles().map(|triangle| curls[triangle]).fold(0.0, f32::max);
        }
    }

    /// That of several cloths, whose slots and triangles follow on one another: of each its hierarchy and so many slots and triangles.
    pub fn join<'a>(cloths: impl IntoIterator<Item = (&'a Self, u32, u32)>) -> Self {
        let mut joint = Self::default();
        let (mut slots, mut triangles) = (0, 0);
        // Above the roots a node that has one of them as its first child, and what is left as its second.
        let mut cloths = cloths.into_iter().filter(|(cloth, ..)| !cloth.nodes.is_empty()).peekable();
        while let Some((cloth, more_slots, more_triangles)) = cloths.next() {
            if cloths.peek().is_some() {
                let next = (joint.nodes.len() + 1 + cloth.nodes.len()) as u32;
                joint.nodes.push(Node { next, is_leaf: false, is_marked: false });
            }
            let (node, patch) = (joint.nodes.len() as u32, joint.patches.len() as u32);
            joint.nodes.extend(
                cloth
                    .nodes
                    .iter()
                    .map(|of_it| Node { next: of_it.next + if of_it.is_leaf { patch } else { node }, ..*of_it }),
            );
            let shifted = |all: &[u32], by: u32| all.iter().map(|index| index + by).collect();
            joint.patches.extend(cloth.patches.iter().map(|patch_of_it| Patch {
                triangles: shifted(&patch_of_it.triangles, triangles),
                particles: shifted(&patch_of_it.particles, slots),
                neighbors: shifted(&patch_of_it.neighbors, patch),
                ..patch_of_it.clone()
            }));
            (slots, triangles) = (slots + more_slots, triangles + more_triangles);
        }
        joint.bounds = vec![Bounds::EMPTY; joint.nodes.len()];
        joint
    }

    /// Marks the patches of which a particle `has_left` its path. Returns how many.
    pub fn mark(&mut self, has_left: &[bool]) -> usize {
        for patch in &mut self.patches {
            patch.is_marked = patch.particles.iter().any(|slot| has_left[*slot as usize]);
        }
        for index in (0..self.nodes.len()).rev() {
            let Node { next, is_leaf, .. } = self.nodes[index];
            self.nodes[index].is_marked = match is_leaf {
                true => self.patches[next as usize].is_marked,
                false => self.nodes[index + 1].is_marked || self.nodes[next as usize].is_marked,
            };
        }
        self.patches.iter().filter(|patch| patch.is_marked).count()
    }

    /// Whether one of two patches is marked.
    pub fn is_marked(&self, patches: [u32; 2]) -> bool {
        patches.iter().any(|patch| self.patches[*patch as usize].is_marked)
    }

    /// Fits the boxes to those of the particles; `of_marked`: those of marked patches.
    pub fn refit(&mut self, topology: &Topology, particles: &[Bounds], of_marked: bool) {
        self.triangle_bounds.resize(topology.triangles.len(), Bounds::EMPTY);
        for index in (0..self.nodes.len()).rev() {
            let Node { next, is_leaf, is_marked } = self.nodes[index];
            if of_marked && !is_marked {
                continue;
            }
            self.bounds[index] = if is_leaf {
                let Self { patches, triangle_bounds, .. } = self;
                let triangles = patches[next as usize].triangles.iter().map(|triangle| *triangle as usize);
                triangles.fold(Bounds::EMPTY, |all, triangle| {
                    let [a, b, c] = topology.triangles[triangle].map(|slot| particles[slot as usize]);
                    triangle_bounds[triangle] = a.join(b).join(c);
                    all.join(triangle_bounds[triangle])
                })
            } else {
                self.bounds[index + 1].join(self.bounds[next as usize])
            };
        }
    }

    /// Finds the gradients of all patches with their particles at `now` and at `later`, or, each, as many metres off as `reach` says;
    /// `of_marked`: of the patches at which marked ones end, those included.
    pub fn find_flat(&mut self, topology: &Topology, now: &[Vec3A], later: &[Vec3A], reach: &[f32], of_marked: bool) {
        for index in 0..self.patches.len() {
            let patch = &self.patches[index];
            let is_marked = |patch: &u32| self.patches[*patch as usize].is_marked;
            if patch.is_slit || of_marked && !patch.neighbors.iter().any(is_marked) {
                continue;
            }
            let reach = patch.particles.iter().map(|slot| reach[*slot as usize]).fold(0.0, f32::max);
            let gradients = [now, later].map(|positions| patch.gradients(topology, positions, reach));
            self.patches[index].gradients = gradients;
        }
    }

    /// Whether two patches hang together and are so flat, now and later, that they cannot meet.
    fn are_flat(&self, a: u32, b: u32) -> bool {
        let [first, second] = [a, b].map(|patch| &self.patches[patch as usize]);
        if first.is_slit || second.is_slit || a != b && first.neighbors.binary_search(&b).is_err() {
            return false;
        }
        let all = || first.gradients.iter().chain(&second.gradients);
        let axes = plane([0, 1].map(|axis| all().map(|gradients| gradients.mean[axis]).sum()));
        let curl = first.curl.max(second.curl);
        // Negated, so that what is not a number is not flat.
        all().all(|gradients| gradients.least(axes) >= FLAT + curl)
    }

    /// The number of patches.
    pub fn patches(&self) -> usize {
        self.patches.len()
    }

    /// The particles of a patch.
    pub fn particles_of(&self, patch: usize) -> &[u32] {
        &self.patches[patch].particles
    }

    /// Calls `meet` with two patches, a triangle of the first and those of the second that have overlapping boxes and may meet it:
    /// every two triangles once, in a fixed order, all of two patches in turn. `of_marked`: only where one of the patches is marked.
    pub fn for_each_pair(&mut self, of_marked: bool, mut meet: impl FnMut([u32; 2], u32, &[u32])) {
        let of = |triangle: u32| &self.triangle_bounds[triangle as usize];
        let mut near = [0; PATCH];
        let mut meet_near = |patches: [u32; 2], triangle: u32, others: &[u32]| {
            let around = of(triangle);
            let mut count = 0;
            for &other in others {
                near[count] = other;
                count += usize::from(around.overlaps(of(other)));
            }
            if count > 0 {
                meet(patches, triangle, &near[..count]);
            }
        };
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push([0, 0]);
        }
        while let Some([a, b]) = stack.pop() {
            let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
            if of_marked && !first.is_marked && !second.is_marked {
                continue;
            }
            if a == b {
                if first.is_leaf {
                    if !self.are_flat(first.next, first.next) {
                        let triangles = &self.patches[first.next as usize].triangles;
                        for (i, triangle) in triangles.iter().enumerate() {
                            meet_near([first.next; 2], *triangle, &triangles[i + 1..]);
                        }
                    }
                } else {
                    stack.extend([[a + 1, first.next], [first.next, first.next], [a + 1, a + 1]]);
                }
                continue;
            }
            let [box_a, box_b] = [a, b].map(|node| self.bounds[node as usize]);
            if !box_a.overlaps(&box_b) {
                continue;
            }
            match (first.is_leaf, second.is_leaf) {
                (true, true) => {
                    if !self.are_flat(first.next, second.next) {
                        let patches = [first.next, second.next];
                        let [first, second] = patches.map(|patch| &self.patches[patch as usize].triangles);
                        for triangle in first.iter().filter(|triangle| of(**triangle).overlaps(&box_b)) {
                            meet_near(patches, *triangle, second);
                        }
                    }
                }
                (false, is_leaf) if is_leaf || box_a.size() >= box_b.size() => {
                    stack.extend([[first.next, b], [a + 1, b]]);
                }
                _ => stack.extend([[a, second.next], [a, b + 1]]),
            }
        }
        self.stack = stack;
    }
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

impl Patch {
    /// Whether one comes from each of its triangles to every other over particles that they share.
    fn hangs_together(&self, topology: &Topology) -> bool {
        let corners = |triangle: &u32| {
            let at = topology.triangles[*triangle as usize]
                .map(|slot| self.particles.partition_point(|other| *other < slot));
            at.iter().fold(0_u64, |all, at| all | 1 << at)
        };
        let (mut reached, mut left): (u64, Vec<u64>) = (0, self.triangles.iter().map(corners).collect());
        while let Some(at) = left.iter().position(|corners| reached == 0 || reached & corners != 0) {
            reached |= left.swap_remove(at);
        }
        left.is_empty()
    }
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

#[cfg(test)]
mod tests {
    use super::*;
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
        let neighbors =
            |patch: usize| hierarchy.patches[patch].neighbors.iter().map(move |other| (patch as u32, *other));
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
