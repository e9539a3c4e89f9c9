//! Pairs of features that may come near each other.

use std::ops::Range;

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
    /// How far its two patches have to have gone together before it needs to be looked at, m.
    pub due: f32,
    /// Whether it may come too near in the substep at hand.
    pub is_near: bool,
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
    /// Until its path ends, that substep included.
    pub later: Vec3A,
    /// Along its path, m/s.
    pub velocity: Vec3A,
    /// When that ends, s.
    pub until: f32,
    /// How far it may be off that.
    pub reach: f32,
}

impl Expected {
    /// By how much two particles may come nearer to each other.
    #[inline(always)]
    fn approach(&self, other: &Self) -> f32 {
        let (now, later) = (self.now - other.now, self.later - other.later);
        let mut farthest = now.length_squared().max(later.length_squared());
        if self.until != other.until {
            // Where the first of both paths ends.
            let (longer, left) = (self.until > other.until, self.until - other.until);
            let between = later - if longer { self.velocity } else { other.velocity } * left;
            farthest = farthest.max(between.length_squared());
        }
        farthest.sqrt() + self.reach + other.reach
    }
}

/// Pairs between the same two patches, which follow on one another.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub patches: [u32; 2],
    /// The indices of the first pair and of the one after the last.
    begin: u32,
    end: u32,
    /// The least [`Pair::due`] of those that are not near, and of those that are.
    pub others: f32,
    pub near: f32,
}

impl Run {
    /// The indices of its pairs.
    pub fn range(&self) -> Range<usize> {
        self.begin as usize..self.end as usize
    }
}

/// All pairs found so far that may still come near each other.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// With some that are forgotten between the runs.
    pub all: Vec<Pair>,
    pub runs: Vec<Run>,
    /// How many are not forgotten.
    count: usize,
    pub is_bounded: bool,
    expected: Vec<Expected>,
    features: Features,
}

impl Pairs {
    pub fn new(features: Features) -> Self {
        let expected = vec![Expected::default(); features.slots()];
        Self { all: Vec::new(), runs: Vec::new(), count: 0, is_bounded: false, expected, features }
    }

    /// The features that are paired.
    pub fn features(&self) -> &Features {
        &self.features
    }

    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub fn iter(&self) -> impl Iterator<Item = &Pair> {
        self.runs.iter().flat_map(|run| &self.all[run.range()])
    }

    /// Sets how particle `slot` is expected to move until the next search.
    pub fn expect(&mut self, slot: usize, expected: Expected) {
        self.expected[slot] = expected;
    }

    /// Forgets the pairs of marked patches, or all.
    fn forget(&mut self, hierarchy: &Hierarchy, of_marked: bool) {
        let Self { all, runs, count, .. } = self;
        runs.retain(|run| of_marked && !hierarchy.is_marked(run.patches));
        *count = runs.iter().map(|run| run.range().len()).sum();
        if *count <= all.len() / 2 {
            let mut kept = 0;
            for run in runs {
                let range = run.range();
                (run.begin, run.end) = (kept as u32, (kept + range.len()) as u32);
                all.copy_within(range, kept);
                kept = run.end as usize;
            }
            all.truncate(kept);
        }
    }

    /// Finds the pairs within `bounds`, or those of marked patches; `starts` is where particles are now.
    pub fn find(
        &mut self,
        topology: &Topology,
        surfaces: &Surfaces,
        hierarchy: &mut Hierarchy,
        bounds: &[Bounds],
        starts: &[Vec3A],
        tangle: &Tangle,
        of_marked: bool,
    ) {
        self.forget(hierarchy, of_marked);
        let (mut all, mut runs) = (std::mem::take(&mut self.all), std::mem::take(&mut self.runs));
        let (first_new, mut count) = (runs.len(), self.count);
        let around = |slots: &[u32]| slots.iter().fold(Bounds::EMPTY, |all, slot| all.join(bounds[*slot as usize]));
        hierarchy.for_each_pair(of_marked, |patches, a, others| {
            let begin = all.len() as u32;
            let mut add = |kind: Kind, ids: [u32; 4], owned: Owned| {
                if count < surfaces.most {
                    let pair = self.pair(topology, surfaces, starts, tangle, kind, ids, owned);
                    count += usize::from(pair.is_some());
                    all.extend(pair);
                }
            };
            let corners_a = topology.triangles[a as usize];
            let (box_a, owned_a) = (around(&corners_a), self.features.owned[a as usize]);
            let sides_a = [0, 1, 2].map(|i| side(corners_a, i));
            let side_boxes_a = sides_a.map(|side| around(&side));
            for &b in others {
                let corners_b = topology.triangles[b as usize];
                let owned_b = self.features.owned[b as usize];
                let boxes_b = corners_b.map(|slot| bounds[slot as usize]);
                let box_b = boxes_b[0].join(boxes_b[1]).join(boxes_b[2]);
                let two =
                    [(owned_a, corners_a, owned_b, corners_b, box_b), (owned_b, corners_b, owned_a, corners_a, box_a)];
                for (owned, from, to_owned, to, to_box) in two {
                    for i in (0..3).filter(|i| owned.corners[*i]) {
                        if !to.contains(&from[i]) && bounds[from[i] as usize].overlaps(&to_box) {
                            add(Kind::VertexTriangle, [from[i], to[0], to[1], to[2]], to_owned);
                        }
                    }
                }
                let side_boxes_b = [0, 1, 2].map(|j| boxes_b[j].join(boxes_b[(j + 1) % 3]));
                for i in (0..3).filter(|i| owned_a.sides[*i]) {
                    let first = sides_a[i];
                    for j in (0..3).filter(|j| owned_b.sides[*j]) {
                        let second = side(corners_b, j);
                        if !second.contains(&first[0])
                            && !second.contains(&first[1])
                            && side_boxes_a[i].overlaps(&side_boxes_b[j])
                        {
                            add(Kind::EdgeEdge, [first[0], first[1], second[0], second[1]], Owned::default());
                        }
                    }
                }
            }
            let end = all.len() as u32;
            match runs[first_new..].last_mut() {
                Some(run) if run.patches == patches => run.end = end,
                _ if end > begin => {
                    runs.push(Run { patches, begin, end, others: f32::NEG_INFINITY, near: f32::INFINITY });
                }
                _ => {}
            }
        });
        self.is_bounded = count >= surfaces.most;
        (self.all, self.runs, self.count) = (all, runs, count);
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
            due: f32::NEG_INFINITY,
            is_near: false,
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
