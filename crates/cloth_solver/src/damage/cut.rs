//! Cutting: a blade is swept between two rays, and what it passes is divided along a straight line.
//!
//! Triangles are divided where the blade's plane crosses their edges, but for crossings so near to a particle that the line
//! is led through it. Then every particle on the line is parted into what lies on either side.

use glam::Vec3;

use crate::topology::{Change, Crossing, Surgery};
use crate::{Soa3, Topology};

/// A crossing nearer to the end of an edge than this part of it goes through the particle there.
const SNAP: f32 = 0.15;

/// No part of a triangle gets smaller than this part of the mean triangle of the whole cloth.
const SMALLEST: f32 = 0.02;

/// What a pointer's ray sweeps over on its way from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blade {
    /// Near and far end of the first ray, cloth frame, m.
    pub from: [Vec3; 2],
    /// Near and far end of the last ray, cloth frame, m.
    pub to: [Vec3; 2],
}

/// What a cut did.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// To particles and triangles.
    pub change: Change,
    /// The particles at which the line ends inside a triangle that the blade's last ray pierces: the next blade of the same
    /// stroke goes on from there.
    pub tips: Vec<u32>,
    /// How many edges long the line is.
    pub edges: usize,
    /// A particle in the middle of the line.
    pub at: u32,
}

impl Blade {
    /// Unit normal of its plane; `None` if it has not moved, or is not finite.
    fn normal(&self) -> Option<Vec3> {
        let ([near, far], [near_to, far_to]) = (self.from, self.to);
        // Half way, so that a twisted quad is cut as near to its middle as a plane can.
        (far - near).cross(0.5 * ((far_to - far) + (near_to - near))).try_normalize()
    }

    /// Whether a point of its plane lies between its rays, both included: what lies on the last ray of one blade and the
    /// first of the next must not be lost between them.
    fn contains(&self, point: Vec3, normal: Vec3) -> bool {
        const ROUNDING: f32 = 1e-5;
        let inside = |[near, far]: [Vec3; 2]| {
            let along = (far - near).normalize_or_zero();
            let depth = (point - near).dot(along);
            let rounding = ROUNDING * point.distance(near);
            (normal.cross(along).dot(point - near), rounding, (0.0..=far.distance(near)).contains(&depth))
        };
        let (after_from, rounding_from, deep_from) = inside(self.from);
        let (after_to, rounding_to, deep_to) = inside(self.to);
        let turned = normal.cross(self.from[1] - self.from[0]).dot(self.to[1] - self.from[0]).signum();
        after_from * turned >= -rounding_from && after_to * turned <= rounding_to && (deep_from || deep_to)
    }
}

/// Cuts `topology`, whose particles stand at `position`, with `blade`. `tips` are those of the stroke so far.
///
/// Nothing changes where nothing is crossed: the same blade again does nothing. `None` if it crossed nothing.
pub fn cut(topology: &mut Topology, position: &Soa3, blade: &Blade, tips: &[u32]) -> Option<Cut> {
    let normal = blade.normal()?;
    let mut line = Line::new(topology, position, blade, normal);
    line.hold(tips, blade.from);
    line.snap();
    let crossings = line.crossings();
    let Line { mut distance, mut on, .. } = line;
    let mut surgery = Surgery::new(topology);
    let born = surgery.divide(&crossings);
    let slots = surgery.topology().slots();
    distance.resize(slots, 0.0);
    on.resize(slots, false);
    for slot in &born {
        on[*slot as usize] = true;
    }
    let side: Vec<f32> = surgery.topology().triangles.iter().map(|corners| side(*corners, &distance, &on)).collect();
    let triangles = surgery.topology().triangles.clone();
    let between = |a: u32, b: u32| {
        let (first, second) = (triangles[a as usize], triangles[b as usize]);
        let shared = first.iter().filter(|slot| second.contains(slot) && on[**slot as usize]).count();
        shared == 2 && side[a as usize] * side[b as usize] < 0.0
    };
    let path: Vec<u32> = (0..slots as u32).filter(|slot| on[*slot as usize]).collect();
    surgery.part_all(path.clone(), between);
    let change = surgery.finish()?;
    let mut placed = position.clone();
    placed.follow(&change);
    let place = |slot: u32| placed.get(slot as usize);
    let is_on = |slot: u32| on.get(slot as usize).is_some_and(|on| *on);
    let ends: Vec<u32> = (topology.triangles.iter())
        .filter(|corners| corners.iter().any(|slot| is_on(*slot)))
        .filter(|corners| pierces(blade.to, corners.map(place)))
        .flat_map(|corners| corners.iter().copied().filter(|slot| is_on(*slot)))
        .collect();
    Some(Cut { change, tips: ends, edges: path.len().saturating_sub(1), at: path[path.len() / 2] })
}

/// On which side of the line a triangle lies, by the sign; it lies on one only, the line runs along edges. Where all its
/// corners are on the line, or as good as on it, where its middle is.
fn side(corners: [u32; 3], distance: &[f32], on: &[bool]) -> f32 {
    const AS_GOOD_AS: f32 = 1e-3;
    let of = |slot: u32| distance[slot as usize];
    let beside: f32 = corners.into_iter().filter(|slot| !on[*slot as usize]).map(of).sum();
    let farthest = corners.into_iter().map(|slot| of(slot).abs()).fold(0.0, f32::max);
    if beside.abs() > AS_GOOD_AS * farthest { beside } else { corners.into_iter().map(of).sum() }
}

/// The line that a blade draws on a cloth.
struct Line<'a> {
    topology: &'a Topology,
    position: &'a Soa3,
    blade: &'a Blade,
    normal: Vec3,
    /// Of each slot from the blade's plane, m.
    distance: Vec<f32>,
    /// For each slot whether the line goes through it.
    on: Vec<bool>,
}

impl<'a> Line<'a> {
    fn new(topology: &'a Topology, position: &'a Soa3, blade: &'a Blade, normal: Vec3) -> Self {
        let mut distance = vec![0.0; topology.slots()];
        let mut on = vec![false; topology.slots()];
        for slot in topology.particles().map(|slot| slot as usize) {
            let point = position.get(slot);
            distance[slot] = (point - blade.from[0]).dot(normal);
            on[slot] = distance[slot] == 0.0 && blade.contains(point, normal);
        }
        Self { topology, position, blade, normal, distance, on }
    }

    /// Leads the line through those of `tips` that have a triangle which `ray` pierces.
    fn hold(&mut self, tips: &[u32], ray: [Vec3; 2]) {
        let at = |slot: u32| self.position.get(slot as usize);
        for corners in &self.topology.triangles {
            let held = corners.iter().filter(|slot| tips.contains(slot));
            if held.clone().next().is_some() && pierces(ray, corners.map(at)) {
                held.for_each(|slot| self.on[*slot as usize] = true);
            }
        }
    }

    /// Where along an edge the line crosses it, if it does so between its ends.
    fn crossing(&self, [a, b]: [u32; 2]) -> Option<f32> {
        let (da, db) = (self.distance[a as usize], self.distance[b as usize]);
        if self.on[a as usize] || self.on[b as usize] || da * db >= 0.0 {
            return None;
        }
        let t = da / (da - db);
        let point = self.position.get(a as usize).lerp(self.position.get(b as usize), t);
        self.blade.contains(point, self.normal).then_some(t)
    }

    /// Leads the line through the particles it comes near.
    fn snap(&mut self) {
        for edge in &self.topology.edges {
            match self.crossing(*edge) {
                Some(t) if t < SNAP => self.on[edge[0] as usize] = true,
                Some(t) if t > 1.0 - SNAP => self.on[edge[1] as usize] = true,
                _ => {}
            }
        }
        let rest = &self.topology.triangle_rest;
        let total: f32 = rest.iter().map(|rest| 0.5 * rest.determinant()).sum();
        let originals = self.topology.original_triangles.max(1) as f32;
        let smallest = SMALLEST * total / originals;
        // Each round leads the line through at least one more particle.
        while self.snap_slivers(smallest) {}
    }

    /// Leads the line through the nearest particle of every triangle that it would cut a part from that is too small.
    fn snap_slivers(&mut self, smallest: f32) -> bool {
        let mut snapped = false;
        for (corners, rest) in self.topology.triangles.iter().zip(&self.topology.triangle_rest) {
            let crossed: [Option<f32>; 3] =
                [0, 1, 2].map(|side| self.crossing([corners[side], corners[(side + 1) % 3]]));
            let area = 0.5 * rest.determinant();
            let least = match crossed {
                [Some(p), Some(q), None] => part(1.0 - p, q),
                [None, Some(p), Some(q)] => part(1.0 - p, q),
                [Some(q), None, Some(p)] => part(1.0 - p, q),
                [Some(t), None, None] | [None, Some(t), None] | [None, None, Some(t)] => t.min(1.0 - t),
                _ => continue,
            };
            if least * area >= smallest {
                continue;
            }
            let nearest = (0..3)
                .filter_map(|side| crossed[side].map(|t| (side, t)))
                .map(|(side, t)| (if t < 0.5 { corners[side] } else { corners[(side + 1) % 3] }, t.min(1.0 - t)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((slot, _)) = nearest {
                self.on[slot as usize] = true;
                snapped = true;
            }
        }
        snapped
    }

    fn crossings(&self) -> Vec<Crossing> {
        let edges = self.topology.edges.iter();
        edges.filter_map(|edge| self.crossing(*edge).map(|t| Crossing { edge: *edge, t })).collect()
    }
}

/// The smallest part, as a part of the whole, of a triangle with two sides cut at `p` and `q` from their common corner: that
/// corner, or half of the rest, whichever of its diagonals divides it.
fn part(p: f32, q: f32) -> f32 {
    (p * q).min(1.0 - p).min(p * (1.0 - q)).min(1.0 - q).min(q * (1.0 - p))
}

/// Whether the line from one point to another goes through a triangle.
fn pierces([from, to]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let along = to - from;
    let volume = |p: Vec3, q: Vec3| along.dot((p - from).cross(q - from));
    let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
    let same_sign = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let normal = (b - a).cross(c - a);
    let (start, end) = (normal.dot(from - a), normal.dot(to - a));
    same_sign && start * end <= 0.0 && u + v + w != 0.0
}
