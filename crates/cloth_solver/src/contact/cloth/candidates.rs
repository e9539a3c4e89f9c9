//! Pairs of features that may come near each other.

use glam::Vec3A;

use super::features::{Features, Owned, side};
use super::four;
use super::hierarchy::{Bounds, Hierarchy};
use super::nearest::{Kind, nearest};
use super::surfaces::{Between, Surfaces};
use super::tangle::Tangle;
use crate::Topology;

/// The part of the distance that edges keep. Where layers lie flat their vertices keep the whole of it, and edges have no work.
const EDGES: f32 = 0.75;

/// The part of the distance kept that pairs always keep over a substep, and the part of their distance if they are nearer.
const LEAST: f32 = 0.1;
const LEAST_OF_NEARER: f32 = 0.9;

/// Features nearer to each other at rest than this part of the distance kept were one before a cut.
const SIDES: f32 = 1e-3;

/// A vertex and a triangle, or two edges.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub kind: Kind,
    pub ids: [u32; 4],
    /// Distance kept, m.
    pub keep: f32,
    /// How far both sides together may move, on paths less the drift, before they have to be looked at, m.
    pub limit: f32,
    /// How far each particle had gone since the search when `limit` was set, m.
    pub path: [f32; 4],
    /// Which corners and sides of the triangle it speaks for.
    owned: Owned,
}

impl Pair {
    /// Whether it speaks for its nearest points, and not another pair: an edge does not for its ends, and a corner or side of several
    /// triangles is spoken for by one.
    #[inline(always)]
    pub fn speaks(&self, weights: &[f32; 4]) -> bool {
        let [_, a, b, c] = weights.map(|weight| weight != 0.0);
        match self.kind {
            Kind::EdgeEdge => weights[0] != 0.0 && a && b && c,
            Kind::VertexTriangle => match [a, b, c] {
                [true, true, true] => true,
                [true, true, false] => self.owned.sides[0],
                [false, true, true] => self.owned.sides[1],
                [true, false, true] => self.owned.sides[2],
                [true, false, false] => self.owned.corners[0],
                [false, true, false] => self.owned.corners[1],
                _ => self.owned.corners[2],
            },
        }
    }

    /// The distance from which on the pair, now at `distance` m, has to be looked at, m. What another pair speaks for is only in
    /// danger where it may be passed.
    pub fn limit_at(&self, distance: f32, weights: &[f32; 4]) -> f32 {
        if self.speaks(weights) { self.keep } else { self.least(distance) }
    }

    /// The distance that is always kept over a substep by a pair that begins it at `distance` m, m.
    pub fn least(&self, distance: f32) -> f32 {
        (LEAST * self.keep).min(LEAST_OF_NEARER * distance)
    }
}

/// How a particle is expected to move until the next search, m.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Expected {
    /// In the substep at hand.
    pub now: Vec3A,
    /// Until the next search, that substep included.
    pub later: Vec3A,
    /// How far it may be off that.
    pub reach: f32,
}

impl Expected {
    /// By how much two particles may come nearer to each other.
    #[inline(always)]
    fn approach(&self, other: &Self) -> f32 {
        let [now, later] = [self.now - other.now, self.later - other.later].map(|way| way.length_squared());
        now.max(later).sqrt() + self.reach + other.reach
    }
}

/// All pairs found by the last search.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    pub all: Vec<Pair>,
    pub is_bounded: bool,
    expected: Vec<Expected>,
    features: Features,
}

impl Pairs {
    pub fn new(features: Features) -> Self {
        let expected = vec![Expected::default(); features.slots()];
        Self { all: Vec::new(), is_bounded: false, expected, features }
    }

    /// The features that are paired.
    pub fn features(&self) -> &Features {
        &self.features
    }

    pub fn len(&self) -> usize {
        self.all.len()
    }

    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Sets how particle `slot` is expected to move until the next search.
    pub fn expect(&mut self, slot: usize, expected: Expected) {
        self.expected[slot] = expected;
    }

    /// Finds the pairs within `bounds`; `starts` is where particles are now.
    pub fn find(
        &mut self,
        topology: &Topology,
        surfaces: &Surfaces,
        hierarchy: &mut Hierarchy,
        bounds: &[Bounds],
        starts: &[Vec3A],
        tangle: &Tangle,
    ) {
        let mut all = std::mem::take(&mut self.all);
        all.clear();
        let around = |slots: &[u32]| slots.iter().fold(Bounds::EMPTY, |all, slot| all.join(bounds[*slot as usize]));
        let mut add = |kind: Kind, ids: [u32; 4], owned: Owned| {
            if all.len() < surfaces.most {
                all.extend(self.pair(topology, surfaces, starts, tangle, kind, ids, owned));
            }
        };
        hierarchy.for_each_pair(|first, second| {
            for &a in first {
                let corners_a = topology.triangles[a as usize];
                let (box_a, owned_a) = (around(&corners_a), self.features.owned[a as usize]);
                for &b in second {
                    let corners_b = topology.triangles[b as usize];
                    let box_b = around(&corners_b);
                    if !box_a.overlaps(&box_b) {
                        continue;
                    }
                    let owned_b = self.features.owned[b as usize];
                    let two = [
                        (owned_a, corners_a, owned_b, corners_b, box_b),
                        (owned_b, corners_b, owned_a, corners_a, box_a),
                    ];
                    for (owned, from, to_owned, to, to_box) in two {
                        for i in (0..3).filter(|i| owned.corners[*i]) {
                            if !to.contains(&from[i]) && bounds[from[i] as usize].overlaps(&to_box) {
                                add(Kind::VertexTriangle, [from[i], to[0], to[1], to[2]], to_owned);
                            }
                        }
                    }
                    for i in (0..3).filter(|i| owned_a.sides[*i]) {
                        let first = side(corners_a, i);
                        let first_box = around(&first);
                        for j in (0..3).filter(|j| owned_b.sides[*j]) {
                            let second = side(corners_b, j);
                            if !second.contains(&first[0])
                                && !second.contains(&first[1])
                                && first_box.overlaps(&around(&second))
                            {
                                add(Kind::EdgeEdge, [first[0], first[1], second[0], second[1]], Owned::default());
                            }
                        }
                    }
                }
            }
        });
        self.is_bounded = all.len() >= surfaces.most;
        self.all = all;
    }

    /// The pair of these particles, if they can come near each other and have a side.
    fn pair(
        &self,
        topology: &Topology,
        surfaces: &Surfaces,
        starts: &[Vec3A],
        tangle: &Tangle,
        kind: Kind,
        ids: [u32; 4],
        owned: Owned,
    ) -> Option<Pair> {
        let (first, second) = ids.split_at(kind.split());
        let found = nearest(kind, &four(starts, &ids));
        let distance = found.between.length();
        let expected = |slot: &u32| self.expected[*slot as usize];
        let approach =
            first.iter().map(expected).flat_map(|a| second.iter().map(expected).map(move |b| a.approach(&b)));
        let approach = approach.fold(0.0, f32::max);
        let between = surfaces.between(ids[0], ids[3]);
        if distance > between.distance + approach || tangle.involves(kind, ids) {
            return None;
        }
        let mut pair = Pair {
            kind,
            ids,
            keep: self.distance_kept(topology, &between, kind, ids),
            limit: 0.0,
            path: [0.0; 4],
            owned,
        };
        pair.limit = distance - pair.limit_at(distance, &found.weights);
        (pair.limit <= approach).then_some(pair)
    }

    /// What lies nearer in the weave than the distance kept may stay as near as nine tenths of that. The two sides of a cut do not belong
    /// to each other.
    fn distance_kept(&self, topology: &Topology, between: &Between, kind: Kind, ids: [u32; 4]) -> f32 {
        let distance = match kind {
            Kind::VertexTriangle => between.distance,
            Kind::EdgeEdge => EDGES * between.distance,
        };
        if !between.is_own {
            return distance;
        }
        let rest = nearest(kind, &ids.map(|slot| Vec3A::from(topology.rest[slot as usize]))).between.length();
        // What stands at one place at rest are the two sides of a cut, also next to its end, where they hang together.
        if 0.9 * rest >= distance || rest < SIDES * distance {
            return distance;
        }
        let (first, second) = ids.split_at(kind.split());
        let hang_together = first.iter().any(|a| second.iter().any(|b| self.features.hang_together(*a, *b)));
        if hang_together { 0.9 * rest } else { distance }
    }
}
