//! Which colliders are near a cloth, and which of its particles, triangles and edges are near which collider.
//!
//! Both are kept from substep to substep (neighbour lists with a skin; Verlet 1967): they hold until cloth and collider together may
//! have moved as far as the skin. A cloth at rest searches nothing.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

use super::known_shape::KnownShape;
use super::nearest::{of_segments, on_triangle};
use super::{Shape, bounds};
use crate::lanes::{Frame, LANES, LEVEL, Vec3x8, load, splat};
use crate::{Particles, Pose, Soa3, Topology};

/// A triangle or edge, and the corners or edges of the collider that it may touch.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Item<const N: usize> {
    /// Numbers of its particles in [`Part::slots`].
    #[cfg_attr(feature = "save", serde(with = "crate::save::array"))]
    pub corners: [u32; N],
    /// First and last but one of its numbers in [`Part::features`].
    pub near: [u32; 2],
}

/// The part of a cloth that is near one collider.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// Slots of the particles: first those of the items, then the others.
    pub slots: Vec<u32>,
    /// How many of them belong to items.
    pub sharp: usize,
    /// Triangles near points of the collider.
    pub triangles: Vec<Item<3>>,
    /// Edges near segments of the collider.
    pub edges: Vec<Item<2>>,
    /// Numbers of points and segments of the collider.
    pub features: Vec<u32>,
    /// Points of the collider that triangles are tested against: corners, centre, ends.
    pub points: Vec<Vec3>,
    /// Segments of the collider that edges are tested against: edges, axis.
    pub segments: Vec<[Vec3; 2]>,
    /// Of a mesh its triangles near each particle, one after another.
    pub near: Vec<u32>,
    /// Where those of each particle begin.
    pub first_near: Vec<u32>,
    /// A particle with none is as far from a mesh, m, at least.
    pub bound: f32,
    /// Length of the longest edge of the cloth, m, at most; 0 where particles alone are met.
    pub longest: f32,
    /// Where the collider was when the lists were made; `None` if there are none.
    made: Option<Pose>,
    /// Whether there are triangles and edges in them.
    is_sharp: bool,
    /// How far the collider may move from there, m.
    room: f32,
    /// Its shape.
    shape: KnownShape,
    /// No point of the cloth was nearer than this, m, when the particles were at their anchors and the collider there.
    clear: Option<(Pose, f32)>,
}

/// The parts of a cloth that are near its colliders.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    /// Where the particles were when the lists were made, m.
    anchor: Soa3,
    /// How far they may move from there, m.
    room: f32,
    /// How far the farthest is from there in this substep, m; `None` if not known.
    strayed: Option<f32>,
    /// The farthest any moves in this substep, m; `None` if not known.
    moved: Option<f32>,
    /// 1 for slots that touched a collider in the last substep, 0 for the others.
    touched: Vec<f32>,
    /// Corners of the box that holds the particles before and after the substep, m.
    swept: [Vec3; 2],
    /// What tells one state of the topology from another: triangles, edges, slots in use.
    state: [usize; 3],
    /// In the order of the colliders.
    parts: Vec<Part>,
    /// Length of the longest edge when the lists were made, m; `None` if not known.
    longest: Option<f32>,
    /// Positions in the frame of the collider.
    local: Soa3,
    /// For each slot which points and which segments of the collider it is near, a bit each; those 64 apart share one.
    marks: [Vec<u64>; 2],
    /// Number in [`Part::slots`] of each slot.
    number: Vec<u32>,
}

/// How many substeps of the present speed the skin is made for.
const SUBSTEPS: f32 = 4.0;

/// The least thickness of the skin in mean edges.
const SKIN: f32 = 0.15;

/// What bears a load is drawn in by less than that many mean edges in a substep.
const DRAWN: f32 = 0.5;

/// A skin that many times as thick as it would be made now is made again.
const TOO_MUCH: f32 = 3.0;

/// How far below the edge of a solid a cloth edge may be and still find its way out, in mean edges.
const BELOW: f32 = 0.1;

/// How far any point of `shape` moves from one pose to another, m, at most.
pub(super) fn travel(shape: &Shape, from: Pose, to: Pose) -> f32 {
    let turn = if from.rotation == to.rotation { 0.0 } else { from.rotation.angle_between(to.rotation) };
    from.position.distance(to.position) + if turn > 0.0 { turn * shape.bounding_radius() } else { 0.0 }
}

impl Near {
    /// Begins a substep.
    pub fn advance(&mut self, particles: &Particles, colliders: usize) {
        self.parts.resize_with(colliders, Part::default);
        // Not where the last substep would have ended: contact has moved what touched.
        let [before, now] =
            [&particles.previous, &particles.position].map(|x| dispatch!(*LEVEL, simd => bounds(simd, x)));
        self.swept = [before.0.min(now.0), before.1.max(now.1)];
        self.strayed = None;
        self.moved = None;
    }

    /// How far any particle is from its anchor, m; with new anchors if that is too far.
    fn strayed(&mut self, topology: &Topology, particles: &Particles, edge: f32) -> f32 {
        if let Some(strayed) = self.strayed {
            return strayed;
        }
        let state = [topology.triangles.len(), topology.edges.len(), topology.free as usize];
        let mut strayed = f32::INFINITY;
        if self.state == state && self.anchor.len() == particles.slots() {
            strayed = dispatch!(*LEVEL, simd => farthest(simd, &particles.previous, &self.anchor, None));
        }
        let moved = self.moved(particles, edge);
        let wanted = (SUBSTEPS * moved).max(SKIN * edge);
        if strayed + moved > self.room || strayed.is_nan() || self.room > TOO_MUCH * wanted {
            self.state = state;
            self.anchor.clone_from(&particles.previous);
            self.room = wanted.max(if strayed > self.room { strayed.min(edge) } else { 0.0 });
            self.longest = None;
            for part in &mut self.parts {
                (part.made, part.clear) = (None, None);
            }
            strayed = 0.0;
        }
        self.strayed = Some(strayed);
        strayed
    }

    /// The farthest any particle moves in this substep, m. Without those that touched in the last one: what bears a load is drawn
    /// into the collider by h² F/m, and is not under way; unless it is too far for that.
    fn moved(&mut self, particles: &Particles, edge: f32) -> f32 {
        let Particles { position, previous, .. } = particles;
        if let Some(moved) = self.moved {
            return moved;
        }
        let mut moved = dispatch!(*LEVEL, simd => farthest(simd, position, previous, None));
        if moved < DRAWN * edge && self.touched.len() == position.len() {
            moved = dispatch!(*LEVEL, simd => farthest(simd, position, previous, Some(&self.touched)));
        }
        self.moved = Some(moved);
        moved
    }

    /// Takes note of which slots touched a collider: 1 in `touched`, else 0. Leaves them all 0.
    pub fn take_touched(&mut self, touched: &mut Vec<f32>) {
        std::mem::swap(&mut self.touched, touched);
        touched.clear();
        touched.resize(self.touched.len(), 0.0);
    }

    /// How far any particle moves in this substep against a collider, m, at most.
    pub fn relative(&mut self, particles: &Particles, shape: &Shape, [from, to]: [Pose; 2], edge: f32) -> f32 {
        self.moved(particles, edge) + travel(shape, from, to)
    }

    /// Whether the boxes around cloth and collider, as they move in this substep, are farther than `margin` from each other.
    pub fn is_far(&self, shape: &Shape, poses: [Pose; 2], margin: f32) -> bool {
        let [low, high] = self.swept;
        if matches!(shape, Shape::HalfSpace) {
            // The corner of the box that is lowest above the plane.
            let up = poses[1].rotation * Vec3::Y;
            let lowest = Vec3::select(up.cmpge(Vec3::ZERO), low, high);
            return up.dot(lowest - poses[1].position) >= margin;
        }
        let [from, to] = poses.map(|pose| pose.position);
        let middle = 0.5 * (from + to);
        let away = middle - middle.clamp(low, high);
        away.length() > shape.bounding_radius() + margin + 0.5 * from.distance(to)
    }

    /// Whether the collider number `which` stays farther than `margin` away from the cloth, as far as is known from earlier
    /// substeps. `edge` is the mean edge length of the cloth, m.
    pub fn is_clear(
        &mut self,
        (topology, particles): (&Topology, &Particles),
        which: usize,
        shape: &Shape,
        poses: [Pose; 2],
        [margin, edge]: [f32; 2],
    ) -> bool {
        let part = &mut self.parts[which];
        if !part.shape.meet(shape) {
            (part.made, part.clear) = (None, None);
        }
        let Some((made, gap)) = part.clear else { return false };
        let moved = poses.map(|pose| travel(shape, made, pose));
        let left = gap - moved[0].max(moved[1]) - margin;
        left > 0.0 && {
            let strayed = self.strayed(topology, particles, edge);
            self.parts[which].clear.is_some() && left > strayed + self.moved(particles, edge)
        }
    }

    /// Remembers that no point of the cloth is nearer than `gap` (m) to the collider number `which`, which stands at `pose`.
    pub fn note(
        &mut self,
        (topology, particles): (&Topology, &Particles),
        which: usize,
        pose: Pose,
        [gap, edge]: [f32; 2],
    ) {
        let gap = gap - self.moved(particles, edge) - self.strayed(topology, particles, edge);
        self.parts[which].clear = Some((pose, gap));
    }

    /// Length of the longest edge of the cloth, m, at most.
    pub fn longest(&mut self, of: (&Topology, &Particles), edge: f32) -> f32 {
        self.longest_at_anchor(of, edge) + 2.0 * self.room
    }

    fn longest_at_anchor(&mut self, (topology, particles): (&Topology, &Particles), edge: f32) -> f32 {
        self.strayed(topology, particles, edge);
        let length = |edge: &[u32; 2]| self.anchor.get(edge[0] as usize).distance(self.anchor.get(edge[1] as usize));
        let find = || topology.edges.iter().map(length).fold(0.0, f32::max);
        *self.longest.get_or_insert_with(find)
    }

    /// Whether an edge was longer than `length`, m, when the lists were made.
    pub fn is_stretched(&mut self, of: (&Topology, &Particles), edge: f32, length: f32) -> bool {
        self.longest_at_anchor(of, edge) > length
    }

    /// The part near the collider number `which` of `shape`, which moves over the substep as `poses` say. Of a shape that
    /// `is_sharp` for the cloth with triangles and edges.
    pub fn part(
        &mut self,
        (topology, particles): (&Topology, &Particles),
        which: usize,
        shape: &Shape,
        poses: [Pose; 2],
        [margin, edge]: [f32; 2],
        is_sharp: bool,
    ) -> &Part {
        self.strayed(topology, particles, edge);
        let part = &self.parts[which];
        let wanted = SUBSTEPS * travel(shape, poses[0], poses[1]);
        let is_lean = part.room <= TOO_MUCH * wanted.max(SKIN * edge);
        let is_lean = is_lean && part.is_sharp == is_sharp;
        let is_good = |made: Pose| is_lean && poses.iter().all(|pose| travel(shape, made, *pose) <= part.room);
        if !part.made.is_some_and(is_good) {
            let longest = if is_sharp { self.longest((topology, particles), edge) } else { 0.0 };
            let Self { anchor, room, parts, local, marks, number, .. } = self;
            let part = &mut parts[which];
            part.room = wanted;
            part.is_sharp = is_sharp;
            part.made = Some(poses[1]);
            part.longest = longest;
            let reach = part.room + *room + margin;
            local.clone_from(anchor);
            let frame = Frame::new(poses[1]);
            dispatch!(*LEVEL, simd => for i in (0..local.len() / LANES).map(|group| group * LANES) {
                frame.inverse_point(simd, Vec3x8::load(simd, local, i)).store(local, i);
            });
            part.clear_lists();
            number.clear();
            number.resize(anchor.len(), u32::MAX);
            if let Some(mesh) = shape.mesh() {
                let far = reach + shape.feature_radius() + BELOW * edge.min(shape.inner_radius());
                let longest = is_sharp.then_some(longest);
                part.list_mesh(mesh, (topology, local), number, [reach, far], longest);
                return &self.parts[which];
            }
            if is_sharp {
                shape.features(&mut part.points, &mut part.segments);
                let far = reach + shape.feature_radius() + BELOW * edge.min(shape.inner_radius());
                mark(local, &part.points, &part.segments, far + longest, marks);
                part.list(topology, local, marks, number, far);
            }
            part.sharp = part.slots.len();
            let skin = Vec3::splat(reach);
            let [low, high] = shape.bounds();
            let [low, high] = [low - skin, high + skin];
            for slot in 0..local.len() {
                let x = local.get(slot);
                if number[slot] == u32::MAX && x.cmpge(low).all() && x.cmple(high).all() {
                    part.slots.push(slot as u32);
                }
            }
        }
        &self.parts[which]
    }
}

impl Part {
    fn clear_lists(&mut self) {
        self.slots.clear();
        self.triangles.clear();
        self.edges.clear();
        self.features.clear();
        self.points.clear();
        self.segments.clear();
        self.near.clear();
        self.first_near.clear();
    }

    /// Lists what is no farther than `far` from a point or a segment of the collider.
    fn list(&mut self, topology: &Topology, local: &Soa3, marks: &[Vec<u64>; 2], number: &mut [u32], far: f32) {
        let Self { slots, triangles, edges, features, points, segments, .. } = self;
        let at = |slot: u32| local.get(slot as usize);
        let mut add = |slot: u32| {
            let number = &mut number[slot as usize];
            if *number == u32::MAX {
                *number = slots.len() as u32;
                slots.push(slot);
            }
            *number
        };
        let bit = |number: usize| 1_u64 << (number % 64);
        let common = |marks: &[u64], corners: &[u32]| corners.iter().fold(u64::MAX, |all, i| all & marks[*i as usize]);
        for triangle in &topology.triangles {
            let marked = common(&marks[0], triangle);
            if marked == 0 {
                continue;
            }
            let (first, corners) = (features.len() as u32, triangle.map(at));
            for (which, point) in points.iter().enumerate().filter(|(which, _)| marked & bit(*which) != 0) {
                let weights = on_triangle(*point, corners);
                let nearest: Vec3 = (0..3).map(|i| corners[i] * weights[i]).sum();
                if nearest.distance(*point) <= far {
                    features.push(which as u32);
                }
            }
            let near = [first, features.len() as u32];
            if near[1] > first {
                triangles.push(Item { corners: triangle.map(&mut add), near });
            }
        }
        for edge in &topology.edges {
            let marked = common(&marks[1], edge);
            if marked == 0 {
                continue;
            }
            let (first, ends) = (features.len() as u32, edge.map(at));
            for (which, segment) in segments.iter().enumerate().filter(|(which, _)| marked & bit(*which) != 0) {
                let [s, t] = of_segments(ends, *segment);
                if ends[0].lerp(ends[1], s).distance(segment[0].lerp(segment[1], t)) <= far {
                    features.push(which as u32);
                }
            }
            let near = [first, features.len() as u32];
            if near[1] > first {
                edges.push(Item { corners: edge.map(&mut add), near });
            }
        }
    }
}

/// Marks the slots that are nearer than `far` to a point or a segment.
fn mark(local: &Soa3, points: &[Vec3], segments: &[[Vec3; 2]], far: f32, marks: &mut [Vec<u64>; 2]) {
    for marks in &mut *marks {
        marks.clear();
        marks.resize(local.len(), 0);
    }
    dispatch!(*LEVEL, simd => {
        for (which, point) in points.iter().enumerate() {
            mark_one(simd, local, [*point; 2], far, which, &mut marks[0]);
        }
        for (which, segment) in segments.iter().enumerate() {
            mark_one(simd, local, *segment, far, which, &mut marks[1]);
        }
    });
}

#[inline(always)]
fn mark_one<S: Simd>(simd: S, local: &Soa3, [a, b]: [Vec3; 2], far: f32, which: usize, marks: &mut [u64]) {
    let along = b - a;
    let per_square = splat(simd, if a == b { 0.0 } else { 1.0 / along.length_squared() });
    let [start, along] = [a, along].map(|v| Vec3x8::splat(simd, v));
    let (far, zero, one) = (splat(simd, far * far), splat(simd, 0.0), splat(simd, 1.0));
    for i in (0..local.len() / LANES).map(|group| group * LANES) {
        let off = Vec3x8::load(simd, local, i) - start;
        let away = off - along * (off.dot(along) * per_square).max(zero).min(one);
        let mut near = away.dot(away).simd_le(far).to_bitmask();
        while near != 0 {
            marks[i + near.trailing_zeros() as usize] |= 1 << (which % 64);
            near &= near - 1;
        }
    }
}

/// The largest distance between entries of `a` and `b` that are not `left_out` (1, else 0), m.
#[inline(always)]
fn farthest<S: Simd>(simd: S, a: &Soa3, b: &Soa3, left_out: Option<&[f32]>) -> f32 {
    let (mut most, one) = (splat(simd, 0.0), splat(simd, 1.0));
    for i in (0..a.len() / LANES).map(|group| group * LANES) {
        let way = Vec3x8::load(simd, a, i) - Vec3x8::load(simd, b, i);
        let square = way.dot(way);
        let part = match left_out {
            Some(left_out) => one - load(simd, left_out, i),
            None => one,
        };
        most = most.max(square * part);
    }
    most.reduce_max().sqrt()
}
