//! Which triangles of a cloth may meet: patches of triangles that hang together, in a hierarchy of boxes.
//!
//! A patch that is flat, and so with its neighbours, cannot meet itself (see `flat`): of a curtain at rest nothing is left to look at.

use glam::{Vec3, Vec3A};

use super::flat::{Creases, Flatness};
use crate::Topology;

/// Triangles in a patch at most.
pub(super) const PATCH: usize = 16;

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
    flat: Flatness,
    /// A particle of it has left its path.
    is_marked: bool,
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
        let creases = Creases::new(topology);
        for patch in &mut self.patches {
            patch.neighbors =
                patch.particles.iter().flat_map(|slot| patches_at[*slot as usize].iter().copied()).collect();
            patch.neighbors.sort_unstable();
            patch.neighbors.dedup();
            patch.flat = Flatness::new(topology, &patch.triangles, &patch.particles, &creases);
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

    /// Finds how flat patches are with their particles at `now` and at `later`, or, each, as many metres off as `reach` says;
    /// `of_marked`: those at which marked ones end, those included.
    pub fn find_flat(&mut self, topology: &Topology, now: &[Vec3A], later: &[Vec3A], reach: &[f32], of_marked: bool) {
        for index in 0..self.patches.len() {
            let is_marked = |patch: &u32| self.patches[*patch as usize].is_marked;
            if of_marked && !self.patches[index].neighbors.iter().any(is_marked) {
                continue;
            }
            let Patch { triangles, particles, flat, .. } = &mut self.patches[index];
            let reach = particles.iter().map(|slot| reach[*slot as usize]).fold(0.0, f32::max);
            flat.find(topology, triangles, [now, later], reach);
        }
    }

    /// Whether two patches hang together and are so flat, now and later, that they cannot meet.
    pub(super) fn are_flat(&self, a: u32, b: u32) -> bool {
        let [first, second] = [a, b].map(|patch| &self.patches[patch as usize]);
        (a == b || first.neighbors.binary_search(&b).is_ok()) && first.flat.is_one_with(&second.flat)
    }

    /// The patches that share a particle with one, itself included.
    #[cfg(test)]
    pub(super) fn neighbors_of(&self, patch: usize) -> &[u32] {
        &self.patches[patch].neighbors
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
