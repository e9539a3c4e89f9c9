//! Which particles, triangles and edges of a cloth are near which collider.
//!
//! Lists are kept from substep to substep (neighbour lists with a skin; Verlet 1967): a list holds all that is nearer to its collider
//! than the skin, and is as good until cloth and collider together may have moved as far. A cloth at rest looks for nothing.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

use super::Shape;
use crate::lanes::{LANES, LEVEL, Vec3x8, splat};
use crate::{Particles, Pose, Soa3, Topology};

/// The part of a cloth that is near one collider.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// Slots of the particles, in ascending order.
    pub slots: Vec<u32>,
    /// Triangles, as numbers in `slots`.
    pub triangles: Vec<[u32; 3]>,
    /// Edges, as numbers in `slots`.
    pub edges: Vec<[u32; 2]>,
    /// Length of the longest of those edges, m, at most.
    pub longest: f32,
    /// Where the collider was when the list was made; `None` if there is none.
    made: Option<Pose>,
    /// How far the collider may move from there, m.
    room: f32,
    /// The box around its shape.
    bounds: [Vec3; 2],
}

/// The parts of a cloth that are near its colliders.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    /// Where the particles were when the lists were made, m.
    anchor: Soa3,
    /// How far they may move from there, m.
    room: f32,
    /// What tells one state of the topology from another: triangles, edges, slots in use.
    state: [usize; 3],
    /// In the order of the colliders.
    pub parts: Vec<Part>,
    /// Which sides of a box a slot lies beyond, one bit each.
    beyond: Vec<u8>,
    /// Number in [`Part::slots`] of each slot.
    number: Vec<u32>,
}

/// How the particles of a cloth moved in a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Lowest corner of the box that holds them before and after, m.
    pub low: Vec3,
    /// Its highest corner, m.
    pub high: Vec3,
    /// The farthest any moved, m.
    moved: f32,
    /// The farthest any is from its anchor before or after, m.
    strayed: f32,
}

impl Extent {
    /// Whether a collider that moves from the first of `poses` to the second may come as near as `margin` to the cloth.
    pub fn reaches(&self, shape: &Shape, poses: [Pose; 2], margin: f32) -> bool {
        if matches!(shape, Shape::HalfSpace) {
            // The corner of the box that is lowest above the plane.
            let up = poses[1].rotation * Vec3::Y;
            let lowest = Vec3::select(up.cmpge(Vec3::ZERO), self.low, self.high);
            return up.dot(lowest - poses[1].position) < margin;
        }
        let [from, to] = poses.map(|pose| pose.position);
        let middle = 0.5 * (from + to);
        let away = middle - middle.clamp(self.low, self.high);
        away.length() <= shape.bounding_radius() + margin + 0.5 * from.distance(to)
    }
}

/// How many substeps of the present speed the skin is made for.
const SUBSTEPS: f32 = 4.0;

impl Near {
    /// Takes note of how the cloth moved in this substep; `edge` is its mean edge length, m.
    pub fn advance(&mut self, topology: &Topology, particles: &Particles, colliders: usize, edge: f32) -> Extent {
        let state = [topology.triangles.len(), topology.edges.len(), topology.free as usize];
        let is_same = self.state == state && self.anchor.len() == particles.slots();
        if !is_same {
            self.anchor = particles.position.clone();
            self.state = state;
        }
        let extent = dispatch!(*LEVEL, simd => extent(simd, particles, &self.anchor));
        if !is_same || extent.strayed > self.room || !extent.strayed.is_finite() {
            self.anchor.copy_from(&particles.position);
            self.room = (SUBSTEPS * extent.moved).max(0.25 * edge);
            self.parts.iter_mut().for_each(|part| part.made = None);
        }
        self.parts.resize_with(colliders, Part::default);
        extent
    }

    /// The part near the collider number `which` of `shape`, which moves over the substep as `poses` say.
    pub fn part(&mut self, topology: &Topology, which: usize, shape: &Shape, poses: [Pose; 2], margin: f32) -> &Part {
        let Self { anchor, room, parts, beyond, number, .. } = self;
        let part = &mut parts[which];
        let arm = shape.bounding_radius() + *room;
        let moves =
            |from: Pose, to: Pose| from.position.distance(to.position) + arm * from.rotation.angle_between(to.rotation);
        let bounds = shape.bounds();
        let is_good = |made: Pose| part.bounds == bounds && poses.iter().all(|pose| moves(made, *pose) <= part.room);
        if !part.made.is_some_and(is_good) {
            part.room = (SUBSTEPS * moves(poses[0], poses[1])).max(*room);
            part.made = Some(poses[1]);
            part.bounds = bounds;
            let skin = Vec3::splat(part.room + *room + margin);
            let [low, high] = [bounds[0] - skin, bounds[1] + skin];
            beyond.resize(anchor.len(), 0);
            for slot in 0..anchor.len() {
                let x = poses[1].inverse_point(anchor.get(slot));
                let (under, over) = (x.cmplt(low).bitmask(), x.cmpgt(high).bitmask());
                beyond[slot] = (under | over << 3) as u8;
            }
            part.list(topology, beyond, number, anchor);
            part.longest += 2.0 * *room;
        }
        part
    }
}

impl Part {
    /// Lists what is not beyond one side of the box with all its corners.
    fn list(&mut self, topology: &Topology, beyond: &[u8], number: &mut Vec<u32>, at: &Soa3) {
        let is_near = |corners: &[u32]| corners.iter().fold(u8::MAX, |all, slot| all & beyond[*slot as usize]) == 0;
        self.triangles.clear();
        self.triangles.extend(topology.triangles.iter().filter(|triangle| is_near(*triangle)));
        self.edges.clear();
        self.edges.extend(topology.edges.iter().filter(|edge| is_near(*edge)));
        number.clear();
        number.resize(beyond.len(), u32::MAX);
        for slot in self.triangles.as_flattened().iter().chain(self.edges.as_flattened()) {
            number[*slot as usize] = 0;
        }
        self.slots.clear();
        for slot in 0..beyond.len() {
            if number[slot] == 0 {
                number[slot] = self.slots.len() as u32;
                self.slots.push(slot as u32);
            }
        }
        let length = |edge: &[u32; 2]| at.get(edge[0] as usize).distance(at.get(edge[1] as usize));
        self.longest = self.edges.iter().map(length).fold(0.0, f32::max);
        let triangles = self.triangles.as_flattened_mut().iter_mut();
        for corner in triangles.chain(self.edges.as_flattened_mut()) {
            *corner = number[*corner as usize];
        }
    }
}

#[inline(always)]
fn extent<S: Simd>(simd: S, particles: &Particles, anchor: &Soa3) -> Extent {
    let infinity = splat(simd, f32::INFINITY);
    let mut low = Vec3x8 { x: infinity, y: infinity, z: infinity };
    let mut high = Vec3x8 { x: -infinity, y: -infinity, z: -infinity };
    let (mut moved, mut strayed) = (splat(simd, 0.0), splat(simd, 0.0));
    for i in (0..anchor.len() / LANES).map(|group| group * LANES) {
        let (x, before) = (Vec3x8::load(simd, &particles.position, i), Vec3x8::load(simd, &particles.previous, i));
        let anchor = Vec3x8::load(simd, anchor, i);
        for p in [x, before] {
            low = Vec3x8 { x: low.x.min(p.x), y: low.y.min(p.y), z: low.z.min(p.z) };
            high = Vec3x8 { x: high.x.max(p.x), y: high.y.max(p.y), z: high.z.max(p.z) };
            let off = p - anchor;
            strayed = strayed.max(off.dot(off));
        }
        let way = x - before;
        moved = moved.max(way.dot(way));
    }
    Extent {
        low: Vec3::new(low.x.reduce_min(), low.y.reduce_min(), low.z.reduce_min()),
        high: Vec3::new(high.x.reduce_max(), high.y.reduce_max(), high.z.reduce_max()),
        moved: moved.reduce_max().sqrt(),
        strayed: strayed.reduce_max().sqrt(),
    }
}
