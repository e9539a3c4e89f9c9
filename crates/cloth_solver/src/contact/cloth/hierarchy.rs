//! Which triangles of a cloth may meet: patches of triangles that hang together, in a hierarchy of boxes.
//!
//! A patch whose normals lie within a cone, and so with its neighbours, cannot meet itself (Volino, Magnenat-Thalmann 1994;
//! Provot 1997): of a curtain at rest nothing is left to look at. How wide the cone may be depends on how far particles may be off
//! their paths: that turns triangles. Where a cut leaves two sides at one place of the rest shape, flatness
//! says nothing: they may slide over each other.

use std::collections::HashMap;

use glam::{Vec3, Vec3A};

use crate::Topology;

/// Triangles in a patch at most.
const PATCH: usize = 16;

/// Cosine of the widest cone.
const CONE: f32 = 0.5;

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
    /// Whether a particle of it stands where another one stands at rest, which it does not hang on.
    is_slit: bool,
    /// Those of its normals now and later.
    cones: [Cone; 2],
}

/// A cone that holds normals.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
struct Cone {
    /// Unit mean of the normals; zero if they are not within a cone.
    axis: Vec3A,
    /// Cosine and sine of its half angle.
    cosine: f32,
    sine: f32,
    /// Sine of the angle by which its triangles may turn.
    turn: f32,
}

impl Cone {
    /// That of the normals of `triangles`, [`PATCH`] at most, whose particles may be `reach` m off.
    fn new(topology: &Topology, triangles: &[u32], positions: &[Vec3A], reach: f32) -> Self {
        let mut normals = [Vec3A::ZERO; PATCH];
        let normals = &mut normals[..triangles.len()];
        let mut sum = Vec3A::ZERO;
        // The square of the smallest height of a triangle.
        let mut height = f32::MAX;
        for (normal, triangle) in normals.iter_mut().zip(triangles) {
            let [a, b, c] = topology.triangles[*triangle as usize].map(|slot| positions[slot as usize]);
            let cross = (b - a).cross(c - a);
            let longest = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
            height = height.min(cross.length_squared() / longest.max(f32::MIN_POSITIVE));
            *normal = cross.normalize_or_zero();
            sum += *normal;
        }
        let axis = sum.normalize_or_zero();
        let cosine = normals.iter().map(|normal| axis.dot(*normal)).fold(1.0, f32::min);
        let axis = if cosine > CONE { axis } else { Vec3A::ZERO };
        let turn = 2.0 * reach / height.sqrt();
        Self { axis, cosine, sine: (1.0 - cosine * cosine).max(0.0).sqrt(), turn }
    }

    /// Whether a cone around the mean axis of both, of half the angle between them and the larger of their own, is still narrow, and less
    /// than a right angle wide to all sides once triangles have turned as far as they may.
    fn joins(&self, other: &Self) -> bool {
        if self.axis == Vec3A::ZERO || other.axis == Vec3A::ZERO {
            return false;
        }
        let between = self.axis.dot(other.axis).clamp(-1.0, 1.0);
        let [cosine, sine] = [0.5 * (1.0 + between), 0.5 * (1.0 - between)].map(f32::sqrt);
        let wider = if self.cosine < other.cosine { self } else { other };
        cosine * wider.cosine - sine * wider.sine > CONE.max(self.turn).max(other.turn)
    }
}

/// The triangles of a topology in patches, and these in a hierarchy of boxes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    nodes: Vec<Node>,
    bounds: Vec<Bounds>,
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
            self.nodes.push(Node { next: self.patches.len() as u32, is_leaf: true });
            let mut particles: Vec<u32> = run.iter().flat_map(|t| topology.triangles[*t as usize]).collect();
            particles.sort_unstable();
            particles.dedup();
            run.sort_unstable();
            self.patches.push(Patch { triangles: run.to_vec(), particles, ..Patch::default() });
            return;
        }
        self.nodes.push(Node { next: 0, is_leaf: false });
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
        let is_doubled = doubled(topology);
        for patch in &mut self.patches {
            patch.neighbors =
                patch.particles.iter().flat_map(|slot| patches_at[*slot as usize].iter().copied()).collect();
            patch.neighbors.sort_unstable();
            patch.neighbors.dedup();
            patch.is_slit = patch.particles.iter().any(|slot| is_doubled[*slot as usize]);
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
                joint.nodes.push(Node { next, is_leaf: false });
            }
            let (node, patch) = (joint.nodes.len() as u32, joint.patches.len() as u32);
            joint.nodes.extend(
                cloth
                    .nodes
                    .iter()
                    .map(|&Node { next, is_leaf }| Node { next: next + if is_leaf { patch } else { node }, is_leaf }),
            );
            let shifted = |all: &[u32], by: u32| all.iter().map(|index| index + by).collect();
            joint.patches.extend(cloth.patches.iter().map(|patch_of_it| Patch {
                triangles: shifted(&patch_of_it.triangles, triangles),
                particles: shifted(&patch_of_it.particles, slots),
                neighbors: shifted(&patch_of_it.neighbors, patch),
                ..*patch_of_it
            }));
            (slots, triangles) = (slots + more_slots, triangles + more_triangles);
        }
        joint.bounds = vec![Bounds::EMPTY; joint.nodes.len()];
        joint
    }

    /// Fits the boxes to those of the particles.
    pub fn refit(&mut self, particles: &[Bounds]) {
        for index in (0..self.nodes.len()).rev() {
            let Node { next, is_leaf } = self.nodes[index];
            self.bounds[index] = if is_leaf {
                let slots = self.patches[next as usize].particles.iter();
                slots.fold(Bounds::EMPTY, |all, slot| all.join(particles[*slot as usize]))
            } else {
                self.bounds[index + 1].join(self.bounds[next as usize])
            };
        }
    }

    /// Finds the cones of the normals of all patches with their particles at `now` and at `later`, or, each, as many metres off as
    /// `reach` says.
    pub fn find_cones(&mut self, topology: &Topology, now: &[Vec3A], later: &[Vec3A], reach: &[f32]) {
        for patch in self.patches.iter_mut().filter(|patch| !patch.is_slit) {
            let reach = patch.particles.iter().map(|slot| reach[*slot as usize]).fold(0.0, f32::max);
            patch.cones = [now, later].map(|positions| Cone::new(topology, &patch.triangles, positions, reach));
        }
    }

    /// Whether two patches hang together and are so flat, now and later, that they cannot meet.
    fn are_flat(&self, a: u32, b: u32) -> bool {
        let [first, second] = [a, b].map(|patch| &self.patches[patch as usize]);
        let mut cones = first.cones.iter().zip(&second.cones);
        cones.all(|(first, second)| first.joins(second)) && (a == b || first.neighbors.binary_search(&b).is_ok())
    }

    /// Calls `meet` with every two triangles whose patches have overlapping boxes and may meet, once, in a fixed order.
    pub fn for_each_pair(&mut self, mut meet: impl FnMut(&[u32], &[u32])) {
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        if !self.nodes.is_empty() {
            stack.push([0, 0]);
        }
        while let Some([a, b]) = stack.pop() {
            let [first, second] = [a, b].map(|node| self.nodes[node as usize]);
            if a == b {
                if first.is_leaf {
                    if !self.are_flat(first.next, first.next) {
                        let triangles = &self.patches[first.next as usize].triangles;
                        for (i, triangle) in triangles.iter().enumerate() {
                            meet(core::slice::from_ref(triangle), &triangles[i + 1..]);
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
                        let [first, second] = [first, second].map(|leaf| &self.patches[leaf.next as usize].triangles);
                        meet(first, second);
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
