//! The line that a blade draws on a cloth: which edges it crosses, and which particles it is led through.
//!
//! Ray and particles move meanwhile. An edge is crossed where the ray meets it, at some time between first and last: seen along
//! the ray, a point meets a moving segment. So blades that follow each other leave no gap.

use glam::{Vec2, Vec3, Vec3Swizzles};

use crate::topology::Crossing;
use crate::{Soa3, Topology};

/// A crossing nearer to the end of an edge than this part of it goes through the particle there.
const SNAP: f32 = 0.15;

/// No part of a triangle gets smaller than this part of the mean triangle of the whole cloth.
const SMALLEST: f32 = 0.02;

/// What lies on the last ray of one blade and the first of the next must not be lost between them: the part of the distance
/// along the ray that two roundings may put it beyond.
const ROUNDING: f32 = 1e-5;

/// A ray, and what is beside it.
#[derive(Clone, Copy)]
struct View {
    near: Vec3,
    /// Unit vectors: the way that the ray goes relative to the cloth, across that, and along the ray.
    axes: [Vec3; 3],
}

impl View {
    /// Where `point` is seen: x how far the ray has yet to go, y how far aside, z how deep, m.
    fn seen(&self, point: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(point - self.near)))
    }
}

/// How each slot is seen along the first ray at first, and along the last ray at last.
pub(super) struct Seen {
    first: Vec<Vec3>,
    last: Vec<Vec3>,
}

impl Seen {
    fn of(&self, slot: u32) -> (Vec3, Vec3) {
        (self.first[slot as usize], self.last[slot as usize])
    }

    /// Which way the ray goes relative to some slots.
    pub fn way(&self, slots: impl Iterator<Item = u32>) -> Vec2 {
        let moves = slots.map(|slot| self.of(slot)).map(|(first, last)| (first - last).xy());
        moves.sum::<Vec2>().normalize_or_zero()
    }

    /// When the ray that goes `way` passes a slot: 0 at first, 1 at last.
    pub fn when(&self, slot: u32, way: Vec2) -> f32 {
        let (first, last) = self.of(slot);
        when(way.dot(first.xy()), way.dot(last.xy()))
    }

    /// Takes over what was `born` at crossings.
    pub fn follow(&mut self, slots: usize, crossings: &[Crossing], born: &[u32]) {
        for seen in [&mut self.first, &mut self.last] {
            seen.resize(slots, Vec3::ZERO);
            for (Crossing { edge: [a, b], t }, slot) in crossings.iter().zip(born) {
                seen[*slot as usize] = seen[*a as usize].lerp(seen[*b as usize], *t);
            }
        }
    }
}

/// The line that a blade draws on a cloth.
pub(super) struct Line<'a> {
    topology: &'a Topology,
    ray: [Vec3; 2],
    /// Where the particles stood at first, and now.
    position: [&'a Soa3; 2],
    pub seen: Seen,
    /// How deep the rays reach, m.
    reach: f32,
    /// For each slot whether the line goes through it.
    pub on: Vec<bool>,
    /// The edges and triangles that do not stay on one side of the ray: the few that it may meet.
    edges: Vec<[u32; 2]>,
    triangles: Vec<usize>,
}

impl<'a> Line<'a> {
    /// Of the first and last ray, and where the particles stood then; `None` if the ray has not moved relative to the cloth, or
    /// is not finite.
    pub fn new(topology: &'a Topology, position: [&'a Soa3; 2], rays: [[Vec3; 2]; 2]) -> Option<Self> {
        let along = rays.map(|[near, far]| (far - near).normalize_or_zero());
        let off = |k: usize, slot: usize| {
            let from_near = position[k].get(slot) - rays[k][0];
            from_near - along[k] * along[k].dot(from_near)
        };
        // What the blade is nearest to at first decides which way it goes.
        let slots = topology.particles().map(|slot| slot as usize);
        let nearest = slots.min_by(|a, b| off(0, *a).length_squared().total_cmp(&off(0, *b).length_squared()))?;
        let across = (along[0] + along[1]).cross(off(0, nearest) - off(1, nearest)).try_normalize()?;
        let view = |k: usize| {
            let aside = across.reject_from(along[k]).normalize();
            View { near: rays[k][0], axes: [aside.cross(along[k]), aside, along[k]] }
        };
        let seen = |k: usize| {
            let (view, position) = (view(k), position[k]);
            (0..topology.slots()).map(|slot| view.seen(position.get(slot))).collect()
        };
        let seen = Seen { first: seen(0), last: seen(1) };
        let reach = rays[0][0].distance(rays[0][1]).max(rays[1][0].distance(rays[1][1]));
        let on = vec![false; topology.slots()];
        let side = |slot: &u32| {
            let (first, last) = seen.of(*slot);
            i8::from(first.y > 0.0 && last.y > 0.0) - i8::from(first.y < 0.0 && last.y < 0.0)
        };
        let sides: Vec<i8> = (0..topology.slots() as u32).map(|slot| side(&slot)).collect();
        let may_meet = |slots: &[u32]| {
            let first = sides[slots[0] as usize];
            first == 0 || slots.iter().any(|slot| sides[*slot as usize] != first)
        };
        let edges = topology.edges.iter().copied().filter(|edge| may_meet(edge)).collect();
        let triangles = (0..topology.triangles.len()).filter(|at| may_meet(&topology.triangles[*at])).collect();
        Some(Self { topology, ray: rays[0], position, seen, reach, on, edges, triangles })
    }

    /// Whether a point seen there first and last is met at the time `t`: between both, 0..=1, and not beyond either end.
    fn is_within(&self, first: Vec3, last: Vec3, t: f32) -> bool {
        let rounding = ROUNDING * first.z.max(last.z);
        let beyond = (t.clamp(0.0, 1.0) - t).abs() * (first.x - last.x).abs();
        let is_deep = |depth: f32| (0.0..=self.reach).contains(&depth);
        beyond <= rounding && (is_deep(first.z) || is_deep(last.z))
    }

    /// Leads the line through those of `tips` that have a triangle which the first ray pierces.
    pub fn hold(&mut self, tips: &[u32]) {
        let at = |slot: u32| self.position[0].get(slot as usize);
        if tips.is_empty() {
            return;
        }
        for corners in &self.topology.triangles {
            let held = corners.iter().filter(|slot| tips.contains(slot));
            if held.clone().next().is_some() && pierces(self.ray, corners.map(at)) {
                held.for_each(|slot| self.on[*slot as usize] = true);
            }
        }
    }

    /// Where along an edge the line crosses it, if it does so between its ends.
    fn crossing(&self, [a, b]: [u32; 2]) -> Option<f32> {
        let (a, b) = (a as usize, b as usize);
        let Seen { first, last } = &self.seen;
        if self.on[a] || self.on[b] {
            return None;
        }
        meet([first[a].xy(), first[b].xy()], [last[a].xy(), last[b].xy()]).into_iter().flatten().find_map(|time| {
            let [from, to] = [a, b].map(|i| first[i].lerp(last[i], time));
            let (before, after) = (from.xy().length(), to.xy().length());
            let t = before / (before + after);
            // An end that is met is so within rounding, on this side or that.
            let is_between = from.xy().dot(to.xy()) <= 0.0 || before.min(after) <= ROUNDING * from.z;
            let met = self.is_within(first[a].lerp(first[b], t), last[a].lerp(last[b], t), time);
            (met && is_between).then_some(t)
        })
    }

    /// Leads the line through the particles it comes near.
    pub fn snap(&mut self) {
        for at in 0..self.edges.len() {
            let edge = self.edges[at];
            match self.crossing(edge) {
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
        for at in &self.triangles {
            let (corners, rest) = (self.topology.triangles[*at], self.topology.triangle_rest[*at]);
            let crossed: [Option<f32>; 3] =
                [0, 1, 2].map(|side| self.crossing([corners[side], corners[(side + 1) % 3]]));
            let area = 0.5 * rest.determinant();
            let least = match crossed {
                [Some(p), Some(q), None] => part(1.0 - p, q),
                [None, Some(p), Some(q)] => part(1.0 - p, q),
                [Some(q), None, Some(p)] => part(1.0 - p, q),
                [Some(t), None, None] | [None, Some(t), None] | [None, None, Some(t)] => t.min(1.0 - t),
                // In and out by the same edge, and another one: of a blade and a cloth that both move.
                [Some(_), Some(_), Some(_)] => 0.0,
                [None, None, None] => continue,
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

    /// Where the line crosses edges, sorted by edge.
    pub fn crossings(&self) -> Vec<Crossing> {
        let crossing = |edge: &[u32; 2]| self.crossing(*edge).map(|t| Crossing { edge: *edge, t });
        let mut crossings: Vec<Crossing> = self.edges.iter().filter_map(crossing).collect();
        crossings.sort_unstable_by_key(|crossing| crossing.edge);
        crossings
    }
}

/// The smallest part, as a part of the whole, of a triangle with two sides cut at `p` and `q` from their common corner: that
/// corner, or half of the rest, whichever of its diagonals divides it.
fn part(p: f32, q: f32) -> f32 {
    (p * q).min(1.0 - p).min(p * (1.0 - q)).min(1.0 - q).min(q * (1.0 - p))
}

/// When the ray passes what is `first` and `last` m ahead of it: 0 at first, 1 at last.
fn when(first: f32, last: f32) -> f32 {
    if first > last { first / (first - last) } else { 0.5 }
}

/// When the line through two points that move from `first` to `last` goes through the origin: the roots of
/// `a(t) × b(t) = 0`, which is quadratic.
fn meet(first: [Vec2; 2], last: [Vec2; 2]) -> [Option<f32>; 2] {
    let [a, b] = first.map(Vec2::as_dvec2);
    let [da, db] = [last[0].as_dvec2() - a, last[1].as_dvec2() - b];
    let (p, q, r) = (da.perp_dot(db), a.perp_dot(db) + da.perp_dot(b), a.perp_dot(b));
    let root = (q * q - 4.0 * p * r).sqrt();
    // Without a difference of numbers that are nearly alike.
    let sum = -0.5 * (q + root.copysign(q));
    [r / sum, sum / p].map(|t| t.is_finite().then_some(t as f32))
}

/// Whether the line from one point to another goes through a triangle.
pub(super) fn pierces([from, to]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let along = to - from;
    let volume = |p: Vec3, q: Vec3| along.dot((p - from).cross(q - from));
    let (u, v, w) = (volume(a, b), volume(b, c), volume(c, a));
    let same_sign = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    let normal = (b - a).cross(c - a);
    let (start, end) = (normal.dot(from - a), normal.dot(to - a));
    same_sign && start * end <= 0.0 && u + v + w != 0.0
}
