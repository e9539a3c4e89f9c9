//! How the motion of several things that a cloth hangs on is spread over the cloth between them.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use cloth_solver::Topology;
use cloth_solver::constraint::SkinPoint;
use cloth_solver::topology::Change;

use crate::prepare::Armature;

/// A particle that hangs on a frame of pins: particle and frame.
pub(crate) type Hung = (u32, u32);

/// Of how many frames of pins a particle takes a share at most.
const MOST: usize = 4;

/// What a particle that hangs on frames of pins takes of the motion of each: frame and weight. The weights sum to 1, or to 0
/// for one that hangs on nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Share {
    frames: [u32; MOST],
    weights: [f32; MOST],
}

impl Share {
    /// All of one frame.
    const fn whole(frame: u32) -> Self {
        Self { frames: [frame, 0, 0, 0], weights: [1.0, 0.0, 0.0, 0.0] }
    }

    /// Whether it hangs on nothing.
    pub fn is_none(self) -> bool {
        self.iter().next().is_none()
    }

    /// Frames and weights above 0.
    pub fn iter(self) -> impl Iterator<Item = (u32, f32)> {
        self.frames.into_iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }

    /// By inverse squares of the distances (Shepard 1968), those beyond the nearest few faded out (Franke and Little 1980), so
    /// that shares change evenly along the cloth.
    fn at(ways: &[(f32, u32)]) -> Self {
        let Some((nearest, frame)) = ways.first().copied() else { return Self::default() };
        if nearest == 0.0 {
            return Self::whole(frame);
        }
        let beyond = ways.get(MOST).map_or(0.0, |(way, _)| 1.0 / way);
        let mut share = Self::default();
        for (i, (way, frame)) in ways.iter().take(MOST).enumerate() {
            let closeness = nearest * (1.0 / way - beyond);
            (share.frames[i], share.weights[i]) = (*frame, closeness * closeness);
        }
        let total: f32 = share.weights.iter().sum();
        if total <= 0.0 {
            // All are equally far.
            share.weights = [1.0 / MOST as f32; MOST];
            return share;
        }
        share.weights = share.weights.map(|weight| weight / total);
        share
    }
}

/// The share of each particle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum Spread {
    /// Not found yet.
    #[default]
    Unknown,
    /// All of it hangs on one frame.
    All(u32),
    /// By slot.
    Each(Vec<Share>),
}

impl Spread {
    /// By the ways along the edges of the cloth, at rest, from the particles that hang on each frame. What an armature takes along,
    /// by the weights of its joints.
    pub fn find(topology: &Topology, hung: &[Hung], armature: Option<&Armature>) -> Self {
        let ways = nearest(topology, hung);
        if let Some(armature) = armature {
            let share = |(ways, point): (&Vec<_>, &SkinPoint)| match ways.is_empty() {
                true => Share::default(),
                false => Share { frames: point.frames, weights: point.weights },
            };
            return Self::Each(ways.iter().zip(&armature.points).map(share).collect());
        }
        let first = hung.first().map_or(0, |(_, frame)| *frame);
        let is_whole = |slot: u32| matches!(ways[slot as usize][..], [(_, frame)] if frame == first);
        if topology.particles().all(is_whole) {
            return Self::All(first);
        }
        Self::Each(ways.iter().map(|ways| Share::at(ways)).collect())
    }

    /// Takes over what was torn, cut or burnt, until it is found anew: what is born takes the share of a parent.
    pub fn follow(&mut self, change: &Change) {
        let Self::Each(shares) = self else { return };
        shares.resize(change.slots, Share::default());
        for born in &change.born {
            shares[born.slot as usize] = shares[born.parents[0] as usize];
        }
    }

    /// The share of the particle in `slot`.
    pub fn of(&self, slot: usize) -> Share {
        match self {
            Self::Unknown => Share::default(),
            Self::All(frame) => Share::whole(*frame),
            Self::Each(shares) => shares.get(slot).copied().unwrap_or_default(),
        }
    }
}

/// For each slot the nearest frames in ascending order of the way along the edges, m, one more than it takes shares of.
fn nearest(topology: &Topology, hung: &[Hung]) -> Vec<Vec<(f32, u32)>> {
    let mut neighbours: Vec<Vec<(u32, f32)>> = vec![Vec::new(); topology.slots()];
    for &[a, b] in &topology.edges {
        let length = topology.rest[a as usize].distance(topology.rest[b as usize]);
        neighbours[a as usize].push((b, length));
        neighbours[b as usize].push((a, length));
    }
    // Dijkstra from all pins at once, each particle reached once from each of the nearest frames. Non-negative floats order like
    // their bits. A particle pinned twice follows the last pin.
    let mut found: Vec<Vec<(f32, u32)>> = vec![Vec::new(); topology.slots()];
    let mut queue: BinaryHeap<_> = (hung.iter().rev().enumerate())
        .map(|(order, (particle, frame))| Reverse((0_u32, order as u32, *particle, *frame)))
        .collect();
    while let Some(Reverse((bits, order, at, frame))) = queue.pop() {
        let ways = &mut found[at as usize];
        let way = f32::from_bits(bits);
        let is_pinned = ways.first().is_some_and(|(nearest, _)| *nearest == 0.0);
        if ways.len() > MOST || (is_pinned && bits == 0) || ways.iter().any(|(_, known)| *known == frame) {
            continue;
        }
        ways.push((way, frame));
        for &(next, length) in &neighbours[at as usize] {
            queue.push(Reverse(((way + length).to_bits(), order, next, frame)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use bevy::math::{UVec2, Vec2};
    use cloth_solver::topology::Resolution;

    use super::*;

    fn strip(cells: u32) -> Topology {
        let resolution = Resolution::Cells(UVec2::new(cells, 1));
        Topology::rectangle(Vec2::new(1.0, 1.0 / cells as f32), resolution).expect("a strip")
    }

    #[test]
    fn a_cloth_on_one_frame_takes_all_of_its_motion() {
        let pins = [(0, 3), (5, 3)];
        assert_eq!(Spread::find(&strip(10), &pins, None), Spread::All(3));
    }

    #[test]
    fn shares_are_whole_at_the_pins_sum_to_one_and_change_evenly_between_them() {
        for hooks in [2, 3, 9] {
            let (cells, topology) = (72, strip(72));
            let pins: Vec<Hung> = (0..hooks).map(|hook| (hook * cells / (hooks - 1), hook)).collect();
            let spread = Spread::find(&topology, &pins, None);
            let share_of = |slot: u32, frame: u32| -> f32 {
                spread.of(slot as usize).iter().filter(|(of, _)| *of == frame).map(|(_, weight)| weight).sum()
            };
            for pin in &pins {
                assert_eq!(share_of(pin.0, pin.1), 1.0);
            }
            let step = 3.0 * (hooks - 1) as f32 / cells as f32;
            for slot in 0..=cells {
                let total: f32 = spread.of(slot as usize).iter().map(|(_, weight)| weight).sum();
                assert!((total - 1.0).abs() < 1e-5, "{hooks} hooks, {slot}: {total}");
                for frame in (0..hooks).filter(|_| slot > 0) {
                    let change = share_of(slot, frame) - share_of(slot - 1, frame);
                    assert!(change.abs() < step, "{hooks} hooks, {slot}, {frame}: {change}");
                }
            }
        }
    }
}
