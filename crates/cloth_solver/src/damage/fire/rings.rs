//! The edges around each particle.

use crate::Topology;

/// The edges around each slot, one after the other.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Rings {
    /// Where the edges of each slot start in `spokes`; one more at the end.
    start: Vec<u32>,
    spokes: Vec<Spoke>,
}

/// An edge as seen from one of its ends.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spoke {
    /// Its place in [`Topology::edges`].
    pub edge: u32,
    /// The particle at its other end.
    pub end: u32,
}

impl Rings {
    pub fn new(topology: &Topology) -> Self {
        let mut start = vec![0; topology.slots() + 1];
        for slot in topology.edges.iter().flatten() {
            start[*slot as usize + 1] += 1;
        }
        for slot in 0..topology.slots() {
            start[slot + 1] += start[slot];
        }
        let mut next = start.clone();
        let mut spokes = vec![Spoke::default(); 2 * topology.edges.len()];
        for (edge, &[a, b]) in topology.edges.iter().enumerate() {
            for (from, end) in [(a, b), (b, a)] {
                let place = &mut next[from as usize];
                spokes[*place as usize] = Spoke { edge: edge as u32, end };
                *place += 1;
            }
        }
        Self { start, spokes }
    }

    /// Number of edges.
    pub fn edges(&self) -> usize {
        self.spokes.len() / 2
    }

    /// The edges around `slot`; none if there is no such slot.
    pub fn around(&self, slot: usize) -> &[Spoke] {
        match self.start.get(slot..slot + 2) {
            Some(&[from, to]) => &self.spokes[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The edge between `a` and `b`.
    pub fn edge(&self, a: u32, b: u32) -> Option<usize> {
        self.around(a as usize).iter().find(|spoke| spoke.end == b).map(|spoke| spoke.edge as usize)
    }
}
