//! What hangs together.

use super::Topology;

/// The pieces that a cloth consists of, numbered by their first particles.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pieces {
    /// For each slot its piece; `u32::MAX` for padding.
    pub of_slot: Vec<u32>,
    /// For each piece how many triangles it has.
    pub triangles: Vec<u32>,
}

impl Topology {
    /// The pieces it consists of.
    pub fn pieces(&self) -> Pieces {
        let mut parent: Vec<u32> = (0..self.slots() as u32).collect();
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|slot| root(&mut parent, slot));
            let first = a.min(b).min(c);
            for slot in [a, b, c] {
                parent[slot as usize] = first;
            }
        }
        let mut pieces = Pieces { of_slot: vec![u32::MAX; self.slots()], triangles: Vec::new() };
        for slot in self.particles() {
            let first = root(&mut parent, slot);
            // The smallest slot of a piece is its root, and is met first.
            pieces.of_slot[slot as usize] = if first == slot {
                pieces.triangles.push(0);
                pieces.triangles.len() as u32 - 1
            } else {
                pieces.of_slot[first as usize]
            };
        }
        for corners in &self.triangles {
            pieces.triangles[pieces.of_slot[corners[0] as usize] as usize] += 1;
        }
        pieces
    }
}

fn root(parent: &mut [u32], mut slot: u32) -> u32 {
    while parent[slot as usize] != slot {
        parent[slot as usize] = parent[parent[slot as usize] as usize];
        slot = parent[slot as usize];
    }
    slot
}
