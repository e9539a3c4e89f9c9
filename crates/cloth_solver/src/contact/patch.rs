//! The part of a cloth that is near one collider, in that collider's frame, through one substep.
//!
//! Seen from there the collider stands still and the cloth moves past it. Where it moves farther than what the collider's inner
//! ball allows, the substep is taken in stages, the longer the farther the cloth is away (conservative advancement;
//! Mirtich 1996): so nothing passes, however fast, and every contact is met where it is shallow.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

use super::near::Part;
use super::respond::{Answer, Eight, Found, meet};
use super::{Shape, Surface, Touch, features, furrow};
use crate::batch::gather3;
use crate::lanes::{Frame, LANES, LEVEL, Vec3x8, load, splat, store};
use crate::{Particles, Pose, Soa3};

/// In a stage cloth moves against the collider that many of its inner radii at most.
const STAGE: f32 = 0.125;

/// The same of solids with corners and edges, near which the way out is short: at a quarter of the radius an apex passes.
const STAGE_OF_EDGES: f32 = 0.03;

/// The same of walls of triangles, through the middle of which particles, corners and folds are held back.
const STAGE_OF_WALLS: f32 = 0.5;

/// Stages of one substep at most: what moves past in larger steps yet is met where it ends.
const MOST_STAGES: f32 = 500.0;

/// Passes over particles, triangles and edges in each of several stages, at most; what moves so little that one stage does takes one.
const MOST_PASSES: u32 = 4;

/// Working memory: particles in the frame of a collider, in the order of [`Part::slots`], and padding.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Patch {
    /// Where each was when the stage began, m.
    pub before: Soa3,
    /// Where it is, m.
    pub now: Soa3,
    /// How far it moves in a whole substep, m.
    pub way: Soa3,
    /// The part of that which is its velocity, m.
    pub slip: Soa3,
    /// Normal of a plane through the nearest point of the collider that it is beyond as a whole.
    pub normal: Soa3,
    /// How far that plane is from the origin, m.
    pub height: Vec<f32>,
    /// Inverse mass, 1/kg.
    pub inverse_mass: Vec<f32>,
    /// Whether it touched.
    pub touched: Vec<bool>,
    /// How far contact put each from where it would have ended, m.
    pub shift: Soa3,
    /// Where it would have ended, if the substep is taken in stages, m.
    end: Soa3,
    /// How far the deepest was below the distance kept, m.
    pub deepest: f32,
    /// How deep in the solid the deepest particle was when a stage began, m.
    buried: f32,
    /// The largest push of the last pass, m.
    pub pushed: f32,
    /// How far the fastest that came from outside would have moved into the surface in a whole substep, m.
    pub approach: f32,
    /// How many triangles and edges were pushed.
    pub pushes: u32,
}

/// The farthest that cloth may move against a solid of `shape` in one stage, m.
pub(super) fn longest_stage(shape: &Shape) -> f32 {
    match shape.solid() {
        // What is rounded is as good to pass as a ball of that radius.
        Some((hull, rounding)) => (STAGE_OF_EDGES * hull.inner_radius).max(STAGE * rounding),
        None if shape.mesh().is_some() => STAGE_OF_WALLS * shape.inner_radius(),
        None => STAGE * shape.inner_radius(),
    }
}

impl Patch {
    /// Lets the triangles and edges of `part` meet a collider that its particles have met, and that moves little from the first
    /// of `poses` to the second.
    pub fn touch(
        &mut self,
        (particles, touched): (&mut Particles, &mut [f32]),
        part: &Part,
        shape: &Shape,
        poses: [Pose; 2],
        answer: &Answer,
        h: f32,
    ) -> Found {
        let (frames, slots) = (frames(poses, answer), &part.slots[..part.sharp]);
        dispatch!(*LEVEL, simd => {
            self.gather(simd, particles, slots, (shape, part), frames, h);
            self.find_planes(simd, (shape, part), answer.margin);
        });
        features::meet(self, part, shape, answer);
        features::hold_back(self, part, shape, answer.margin);
        let touch = dispatch!(*LEVEL, simd => self.scatter(simd, (particles, touched), slots, frames, h));
        Found { touch: Touch { touching: self.pushes, ..touch }, deepest: self.deepest, ..Found::default() }
    }

    /// Lets `part` of the cloth meet a collider that moves from the first of `poses` to the second.
    pub fn collide(
        &mut self,
        (particles, touched): (&mut Particles, &mut [f32]),
        part: &Part,
        shape: &Shape,
        poses: [Pose; 2],
        answer: &Answer,
        h: f32,
    ) -> Found {
        let (frames, slots) = (frames(poses, answer), &part.slots[..]);
        let (farthest, nearest) =
            dispatch!(*LEVEL, simd => self.gather(simd, particles, slots, (shape, part), frames, h));
        // Nothing to do if no edge is as long as the nearest particle is away.
        if nearest - farthest > answer.margin + part.longest {
            return Found::default();
        }
        let step = longest_stage(shape).max(farthest / MOST_STAGES);
        if farthest <= step {
            self.meet(part, shape, answer, 1);
        } else {
            self.advance(part, shape, answer, farthest, step);
        }
        let touch = dispatch!(*LEVEL, simd => self.scatter(simd, (particles, touched), slots, frames, h));
        Found { touch, deepest: self.deepest, buried: self.buried, nearest: f32::NEG_INFINITY }
    }

    /// Takes the substep in stages.
    fn advance(&mut self, part: &Part, shape: &Shape, answer: &Answer, farthest: f32, step: f32) {
        self.end.copy_from(&self.now);
        self.now.copy_from(&self.before);
        let mut at = 0.0;
        while at < 1.0 {
            let least = dispatch!(*LEVEL, simd => self.distances(simd, shape));
            let clear = least - answer.margin - part.longest;
            let stage = (step.max(clear) / farthest).min(1.0 - at);
            self.before.copy_from(&self.now);
            add(&mut self.now, &self.way, stage);
            self.meet(part, shape, &answer.in_part(stage), MOST_PASSES);
            at += stage;
        }
        self.shift.copy_from(&self.now);
        add(&mut self.shift, &self.end, -1.0);
    }

    /// One stage: particles, then triangles, then edges.
    fn meet(&mut self, part: &Part, shape: &Shape, answer: &Answer, passes: u32) {
        for _ in 0..passes {
            dispatch!(*LEVEL, simd => self.meet_particles(simd, (shape, part), answer));
            self.pushed = 0.0;
            features::meet(self, part, shape, answer);
            if self.pushed <= answer.margin {
                break;
            }
        }
        if let Some(mesh) = shape.mesh() {
            furrow::settle(self, part, mesh, answer);
        }
        features::hold_back(self, part, shape, answer.margin);
        if let Some(mesh) = shape.mesh() {
            features::hold_back_particles(self, part, mesh);
        }
    }

    /// Loads the particles; tells how far any moves, and how far the nearest is away where it ends.
    #[inline(always)]
    fn gather<S: Simd>(
        &mut self,
        simd: S,
        particles: &Particles,
        slots: &[u32],
        (shape, part): (&Shape, &Part),
        [from, moving, to]: [Frame; 3],
        h: f32,
    ) -> (f32, f32) {
        self.fit(slots.len());
        let step = splat(simd, h);
        let (mut farthest, mut nearest) = (splat(simd, 0.0), splat(simd, f32::INFINITY));
        for (group, slots) in slots.chunks(LANES).enumerate() {
            // Padding repeats the last particle, and cannot move.
            let mut eight = [slots[slots.len() - 1]; LANES];
            eight[..slots.len()].copy_from_slice(slots);
            let x = gather3(simd, &particles.position, &eight);
            let now = to.inverse_point(simd, x);
            let before = from.inverse_point(simd, gather3(simd, &particles.previous, &eight));
            let way = now - before;
            let velocity = gather3(simd, &particles.velocity, &eight);
            let slip = from.inverse_direction(simd, velocity * step) + (now - moving.inverse_point(simd, x));
            let i = group * LANES;
            now.store(&mut self.now, i);
            before.store(&mut self.before, i);
            way.store(&mut self.way, i);
            slip.store(&mut self.slip, i);
            for lane in 0..LANES {
                let mass = if lane < slots.len() { particles.inverse_mass[eight[lane] as usize] } else { 0.0 };
                self.inverse_mass[i + lane] = mass;
            }
            farthest = farthest.max(way.dot(way));
            let zero = splat(simd, 0.0);
            let surface = Surface::near(shape, part, i);
            if !surface.is_convex() {
                // Only what is near is listed, and to look costs more than what may be left out.
                nearest = splat(simd, f32::NEG_INFINITY);
                continue;
            }
            nearest = nearest.min(surface.distance_and_normal(simd, now, zero, zero.simd_ge(zero)).0);
        }
        (farthest.reduce_max().sqrt(), nearest.reduce_min())
    }

    fn fit(&mut self, particles: usize) {
        let slots = particles.next_multiple_of(LANES);
        let Self { before, now, way, slip, normal, shift, end, .. } = self;
        for all in [before, now, way, slip, normal, shift, end] {
            for axis in [&mut all.x, &mut all.y, &mut all.z] {
                axis.resize(slots, 0.0);
            }
        }
        self.shift.fill(Vec3::ZERO);
        (self.deepest, self.buried, self.approach, self.pushes) = (0.0, 0.0, 0.0, 0);
        self.height.resize(slots, 0.0);
        self.inverse_mass.resize(slots, 0.0);
        self.touched.clear();
        self.touched.resize(slots, false);
    }

    /// The least distance of any particle from the collider, m; −∞ from a mesh, of which that is not known.
    #[inline(always)]
    fn distances<S: Simd>(&mut self, simd: S, shape: &Shape) -> f32 {
        let (surface, zero) = (Surface::of(shape), splat(simd, 0.0));
        if !surface.is_convex() {
            return f32::NEG_INFINITY;
        }
        let mut least = splat(simd, f32::INFINITY);
        for i in (0..self.height.len() / LANES).map(|group| group * LANES) {
            let now = Vec3x8::load(simd, &self.now, i);
            least = least.min(surface.distance_and_normal(simd, now, zero, zero.simd_ge(zero)).0);
        }
        least.reduce_min()
    }

    /// Finds the plane that each particle is beyond.
    #[inline(always)]
    fn find_planes<S: Simd>(&mut self, simd: S, (shape, part): (&Shape, &Part), margin: f32) {
        let (margin, zero) = (splat(simd, margin), splat(simd, 0.0));
        for i in (0..self.height.len() / LANES).map(|group| group * LANES) {
            let now = Vec3x8::load(simd, &self.now, i);
            let surface = Surface::near(shape, part, i);
            let (distance, normal) = surface.distance_and_normal(simd, now, margin, zero.simd_ge(zero));
            normal.store(&mut self.normal, i);
            // Nothing is beyond a plane if there is more of the surface behind.
            let height = if surface.is_convex() { now.dot(normal) - distance } else { splat(simd, f32::INFINITY) };
            store(height, &mut self.height, i);
        }
    }

    #[inline(always)]
    fn meet_particles<S: Simd>(&mut self, simd: S, (shape, part): (&Shape, &Part), answer: &Answer) {
        let (margin, zero) = (splat(simd, answer.margin), splat(simd, 0.0));
        let (mut deepest, mut buried, mut approach) = (zero, zero, zero);
        for i in (0..self.height.len() / LANES).map(|group| group * LANES) {
            let now = Vec3x8::load(simd, &self.now, i);
            let free = load(simd, &self.inverse_mass, i).simd_gt(zero);
            let surface = Surface::near(shape, part, i);
            let (distance, normal) = surface.distance_and_normal(simd, now, margin, zero.simd_ge(zero));
            normal.store(&mut self.normal, i);
            // Nothing is beyond a plane if there is more of the surface behind.
            let height = if surface.is_convex() { now.dot(normal) - distance } else { splat(simd, f32::INFINITY) };
            store(height, &mut self.height, i);
            let wanted = free & distance.simd_lt(margin);
            if !wanted.any_true() {
                continue;
            }
            let (before, slip) = (Vec3x8::load(simd, &self.before, i), Vec3x8::load(simd, &self.slip, i));
            let met = meet(simd, surface, Eight { before, now, slip }, (distance, normal), wanted, answer);
            (now + met.shift).store(&mut self.now, i);
            (Vec3x8::load(simd, &self.shift, i) + met.shift).store(&mut self.shift, i);
            (Vec3x8::load(simd, &self.way, i) + met.slip - slip).store(&mut self.way, i);
            met.slip.store(&mut self.slip, i);
            deepest = deepest.max(met.depth);
            buried = buried.max(met.buried);
            approach = approach.max(met.approach);
            let mut hit = met.hit.to_bitmask();
            while hit != 0 {
                self.touched[i + hit.trailing_zeros() as usize] = true;
                hit &= hit - 1;
            }
        }
        self.deepest = self.deepest.max(deepest.reduce_max());
        self.buried = self.buried.max(buried.reduce_max());
        self.approach = self.approach.max(approach.reduce_max());
    }

    /// Puts back what touched. Tells what that gives to the collider.
    #[inline(always)]
    fn scatter<S: Simd>(
        &self,
        simd: S,
        (particles, touched): (&mut Particles, &mut [f32]),
        slots: &[u32],
        [from, moving, to]: [Frame; 3],
        h: f32,
    ) -> Touch {
        let mut touch = Touch { speed: self.approach / h, ..Touch::default() };
        let per_step = splat(simd, 1.0 / h);
        for (group, slots) in slots.chunks(LANES).enumerate() {
            let i = group * LANES;
            if !self.touched[i..i + slots.len()].contains(&true) {
                continue;
            }
            let now = Vec3x8::load(simd, &self.now, i);
            let slip = Vec3x8::load(simd, &self.slip, i);
            let velocity = (from.direction(simd, slip) + (to.point(simd, now) - moving.point(simd, now))) * per_step;
            let shift = to.direction(simd, Vec3x8::load(simd, &self.shift, i));
            let [shift, velocity] =
                [shift, velocity].map(|v| -> [[f32; LANES]; 3] { [v.x.into(), v.y.into(), v.z.into()] });
            for (lane, slot) in slots.iter().enumerate().filter(|(lane, _)| self.touched[i + lane]) {
                let at = |v: [[f32; LANES]; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
                let slot = *slot as usize;
                let place = particles.position.get(slot);
                let given = (particles.velocity.get(slot) - at(velocity)) * particles.mass[slot];
                touch.touching += 1;
                touch.impulse += given;
                touch.moment += (place - to.origin).cross(given);
                particles.position.set(slot, place + at(shift));
                particles.velocity.set(slot, at(velocity));
                touched[slot] = 1.0;
            }
        }
        touch
    }
}

/// The collider's frame at the start, the same as it would be if it had arrived by then, and its frame at the end.
fn frames([start, end]: [Pose; 2], answer: &Answer) -> [Frame; 3] {
    [start, answer.without_arrival(start), end].map(Frame::new)
}

/// `to += by * scale`.
fn add(to: &mut Soa3, by: &Soa3, scale: f32) {
    for (to, by) in [(&mut to.x, &by.x), (&mut to.y, &by.y), (&mut to.z, &by.z)] {
        for (to, by) in to.iter_mut().zip(by) {
            *to += by * scale;
        }
    }
}
