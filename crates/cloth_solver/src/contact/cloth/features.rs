//! The features of cloth that meet: which triangle speaks for a corner or side that several have, and what hangs together.

use crate::Topology;

/// Of a triangle its corners and sides that are paired with others in its name: each belongs to one triangle.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Owned {
    pub corners: [bool; 3],
    pub sides: [bool; 3],
}

/// The features of one cloth, or of several.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Features {
    /// By triangle.
    pub owned: Vec<Owned>,
    /// Particles that each particle shares an edge with: `list[first[slot]..first[slot + 1]]`.
    first: Vec<u32>,
    list: Vec<u32>,
}

/// The side of a triangle from corner `i` on.
pub(super) fn side(corners: [u32; 3], i: usize) -> [u32; 2] {
    [corners[i], corners[(i + 1) % 3]]
}

impl Features {
    pub fn new(topology: &Topology) -> Self {
        let slots = topology.slots();
        let mut is_taken = vec![false; slots];
        let mut first = vec![0; slots + 1];
        for slot in topology.edges.iter().flatten() {
            first[*slot as usize + 1] += 1;
        }
        for slot in 0..slots {
            first[slot + 1] += first[slot];
        }
        let mut next = first.clone();
        let mut list = vec![0; first[slots] as usize];
        for &[a, b] in &topology.edges {
            for (from, to) in [(a, b), (b, a)] {
                let at = &mut next[from as usize];
                list[*at as usize] = to;
                *at += 1;
            }
        }
        let mut is_side_taken = vec![false; list.len()];
        let owned = topology.triangles.iter().map(|corners| Owned {
            corners: corners.map(|slot| !std::mem::replace(&mut is_taken[slot as usize], true)),
            sides: [0, 1, 2].map(|i| {
                let [a, b] = side(*corners, i);
                let (a, b) = (a.min(b), a.max(b));
                let range = first[a as usize] as usize..first[a as usize + 1] as usize;
                let at = range.clone().find(|at| list[*at] == b);
                at.is_some_and(|at| !std::mem::replace(&mut is_side_taken[at], true))
            }),
        });
        Self { owned: owned.collect(), first, list }
    }

    /// Those of several cloths, whose slots follow on one another.
    pub fn join<'a>(cloths: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut joint = Self { owned: Vec::new(), first: vec![0], list: Vec::new() };
        for cloth in cloths {
            let (slot, at) = (joint.slots() as u32, joint.list.len() as u32);
            joint.owned.extend(&cloth.owned);
            joint.first.extend(cloth.first[1..].iter().map(|first| at + first));
            joint.list.extend(cloth.list.iter().map(|other| slot + other));
        }
        joint
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.first.len() - 1
    }

    /// Whether two particles share an edge, or both one with a third.
    pub fn hang_together(&self, a: u32, b: u32) -> bool {
        let near = |slot: u32| &self.list[self.first[slot as usize] as usize..self.first[slot as usize + 1] as usize];
        near(a).contains(&b) || near(a).iter().any(|between| near(*between).contains(&b))
    }
}
