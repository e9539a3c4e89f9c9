//! Tethers (long range attachments, Kim, Chentanez, Müller 2012): no particle gets farther from its pin than the
//! fabric between them is long.
//!
//! They hide the stretch that a method leaves, at the price that the load they carry is missing inside the cloth.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::{Particles, Topology};

/// One particle tied to one pinned particle.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tether {
    particle: u32,
    anchor: u32,
    /// What the fabric between them allows at rest, m.
    length: f32,
    /// Length of the way between them along the edges at rest, m.
    way: f32,
}

/// How much longer the way along the edges of an even mesh may be than the straight one: across equilateral triangles 2/√3.
const ZIGZAG: f32 = 1.16;

/// The tethers of a cloth: each free particle to the pinned particle nearest along the cloth.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Tethers {
    tethers: Vec<Tether>,
    slack: f32,
}

impl Tethers {
    /// `slack` is the strain allowed before a tether acts, 0 or more.
    pub fn new(topology: &Topology, pinned: impl Iterator<Item = u32>, slack: f32) -> Self {
        let nearest = ways(topology, pinned);
        let is_flat = topology.hinge_rest.iter().all(|angle| angle.abs() < 1e-3);
        let tethers = nearest
            .iter()
            .enumerate()
            .filter(|(_, (distance, _))| distance.is_finite() && *distance > 0.0)
            .map(|(i, &(way, anchor))| {
                // The way along mesh edges zigzags. In flat fabric the straight one is what it stands for, unless it leads
                // round a corner or a hole; in a tube, which may be laid flat, it is too short.
                let straight = topology.rest[i].distance(topology.rest[anchor as usize]);
                let length = if is_flat && way <= ZIGZAG * straight { straight } else { way };
                Tether { particle: i as u32, anchor, length, way }
            })
            .collect();
        Self { tethers, slack }
    }

    /// Takes over that the cloth was taken apart: what holds over a crack, so that the way along the cloth has become longer
    /// or is no more, is gone.
    pub fn follow(&mut self, now: &Topology) {
        let mut anchors: Vec<u32> = self.tethers.iter().map(|tether| tether.anchor).collect();
        anchors.sort_unstable();
        anchors.dedup();
        let nearest = ways(now, anchors.into_iter());
        self.tethers.retain(|tether| nearest[tether.particle as usize].0 <= tether.way);
    }

    /// Number of tethers.
    pub fn count(&self) -> usize {
        self.tethers.len()
    }

    /// Pulls back every particle that is too far from its pin.
    pub fn solve(&self, particles: &mut Particles) {
        for tether in &self.tethers {
            let (i, anchor) = (tether.particle as usize, tether.anchor as usize);
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let away = (position.get(i) - position.get(anchor)) + (moved.get(i) - moved.get(anchor));
            let (distance, limit) = (away.length(), tether.length * (1.0 + self.slack));
            if distance > limit && inverse_mass[i] > 0.0 {
                moved.set(i, moved.get(i) - away * (1.0 - limit / distance));
            }
        }
    }
}

/// For each slot the length of the shortest way along the edges to one of the pinned particles, m, and that particle.
fn ways(topology: &Topology, pinned: impl Iterator<Item = u32>) -> Vec<(f32, u32)> {
    let mut neighbours: Vec<Vec<(u32, f32)>> = vec![Vec::new(); topology.slots()];
    for &[a, b] in &topology.edges {
        let length = topology.rest[a as usize].distance(topology.rest[b as usize]);
        neighbours[a as usize].push((b, length));
        neighbours[b as usize].push((a, length));
    }
    // Dijkstra from all pins at once; non-negative floats order like their bits.
    let mut nearest = vec![(f32::INFINITY, u32::MAX); topology.slots()];
    let mut queue = BinaryHeap::new();
    for anchor in pinned {
        nearest[anchor as usize] = (0.0, anchor);
        queue.push(Reverse((0_u32, anchor)));
    }
    while let Some(Reverse((bits, at))) = queue.pop() {
        let (distance, anchor) = nearest[at as usize];
        if distance.to_bits() != bits {
            continue;
        }
        for &(next, length) in &neighbours[at as usize] {
            if distance + length < nearest[next as usize].0 {
                nearest[next as usize] = (distance + length, anchor);
                queue.push(Reverse(((distance + length).to_bits(), next)));
            }
        }
    }
    nearest
}
