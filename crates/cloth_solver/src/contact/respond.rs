//! The answer of eight particles to one collider.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::{Mat3, Vec3};

use super::{Collider, DEPENETRATION_SPEED, Shape};
use crate::lanes::{LANES, Vec3x8, load, splat};
use crate::{Particles, Pose};

/// What one collider met in one substep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub touching: u32,
    pub deepest: f32,
}

/// A pose with its rotation as a matrix.
#[derive(Clone, Copy)]
struct Frame {
    origin: Vec3,
    axes: Mat3,
}

impl Frame {
    fn new(pose: Pose) -> Self {
        Self { origin: pose.position, axes: Mat3::from_quat(pose.rotation) }
    }

    #[inline(always)]
    fn direction<S: Simd>(&self, simd: S, v: Vec3x8<S>) -> Vec3x8<S> {
        let m = &self.axes;
        Vec3x8::splat(simd, m.x_axis) * v.x + Vec3x8::splat(simd, m.y_axis) * v.y + Vec3x8::splat(simd, m.z_axis) * v.z
    }

    #[inline(always)]
    fn inverse_point<S: Simd>(&self, simd: S, p: Vec3x8<S>) -> Vec3x8<S> {
        let d = p - Vec3x8::splat(simd, self.origin);
        let m = &self.axes;
        Vec3x8 {
            x: d.dot(Vec3x8::splat(simd, m.x_axis)),
            y: d.dot(Vec3x8::splat(simd, m.y_axis)),
            z: d.dot(Vec3x8::splat(simd, m.z_axis)),
        }
    }
}

/// Puts every free particle within `offset` of the collider back and takes its velocity into the surface.
#[inline(always)]
pub(super) fn respond<S: Simd>(
    simd: S,
    particles: &mut Particles,
    collider: &Collider,
    start: Pose,
    end: Pose,
    offset: f32,
    h: f32,
) -> Found {
    let Particles { position, previous, velocity, inverse_mass, .. } = particles;
    let (from, to) = (Frame::new(start), Frame::new(end));
    let reach = collider.shape.bounding_radius() + offset;
    let (reach_squared, margin, zero) = (splat(simd, reach * reach), splat(simd, offset), splat(simd, 0.0));
    let (step, per_step) = (splat(simd, h), splat(simd, 1.0 / h));
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let depenetration = splat(simd, DEPENETRATION_SPEED * h);
    let mut found = Found::default();
    for i in (0..inverse_mass.len() / LANES).map(|group| group * LANES) {
        let x = Vec3x8::load(simd, position, i);
        let centred = x - Vec3x8::splat(simd, to.origin);
        let free = load(simd, inverse_mass, i).simd_gt(zero);
        let near = free & centred.dot(centred).simd_le(reach_squared);
        if !near.any_true() {
            continue;
        }
        let local = to.inverse_point(simd, x);
        let (distance, local_normal) = distance_and_normal(simd, &collider.shape, local, near);
        let hit = near & distance.simd_lt(margin);
        if !hit.any_true() {
            continue;
        }
        let normal = to.direction(simd, local_normal);
        let depth = margin - distance;
        let before = from.inverse_point(simd, Vec3x8::load(simd, previous, i));
        let (distance_before, _) = distance_and_normal(simd, &collider.shape, before, hit);
        let depth_before = (margin - distance_before).max(zero);

        // What the particle moved against the collider in this substep.
        let carried = x - from.direction(simd, local) - Vec3x8::splat(simd, from.origin);
        let slip = Vec3x8::load(simd, velocity, i) * step - carried;
        let along = slip.dot(normal);
        let approach = (-along).max(zero);
        let sliding = slip - normal * along;
        let stopped = (splat(simd, collider.friction) * approach / sliding.length().max(tiny)).min(splat(simd, 1.0));
        let push = depth.min((depth - depth_before).max(zero) + depth_before.min(depenetration));

        let placed = x + normal * push - sliding * stopped;
        let left = sliding * (splat(simd, 1.0) - stopped) + normal * along.max(zero) + carried;
        select(hit, placed, x).store(position, i);
        select(hit, left * per_step, Vec3x8::load(simd, velocity, i)).store(velocity, i);
        found.touching += hit.to_bitmask().count_ones();
        found.deepest = found.deepest.max(hit.select(depth, zero).reduce_max());
    }
    found
}

#[inline(always)]
fn select<S: Simd>(mask: mask32x8<S>, yes: Vec3x8<S>, no: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8 { x: mask.select(yes.x, no.x), y: mask.select(yes.y, no.y), z: mask.select(yes.z, no.z) }
}

/// Signed distance and outward normal in the shape's frame, where `wanted`; see [`Shape::distance_and_normal`].
#[inline(always)]
fn distance_and_normal<S: Simd>(
    simd: S,
    shape: &Shape,
    p: Vec3x8<S>,
    wanted: mask32x8<S>,
) -> (f32x8<S>, Vec3x8<S>) {
    let zero = splat(simd, 0.0);
    match shape {
        Shape::Sphere { radius } => ball(simd, p, *radius),
        Shape::Capsule { radius, half_length } => {
            let end = splat(simd, *half_length);
            let on_axis = p.y.max(-end).min(end);
            ball(simd, Vec3x8 { x: p.x, y: p.y - on_axis, z: p.z }, *radius)
        }
        Shape::HalfSpace => (p.y, Vec3x8 { x: zero, y: splat(simd, 1.0), z: zero }),
        Shape::Convex(_) => {
            let (mut distance, mut normal) = ([f32::INFINITY; LANES], [[0.0; LANES]; 3]);
            let mut lanes = wanted.to_bitmask();
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let (d, n) = shape.distance_and_normal(Vec3::new(p.x[lane], p.y[lane], p.z[lane]));
                distance[lane] = d;
                (normal[0][lane], normal[1][lane], normal[2][lane]) = (n.x, n.y, n.z);
            }
            let [x, y, z] = normal.map(|n| f32x8::simd_from(simd, n));
            (f32x8::simd_from(simd, distance), Vec3x8 { x, y, z })
        }
    }
}

/// A ball around the origin; at its very centre the normal is +y.
#[inline(always)]
fn ball<S: Simd>(simd: S, p: Vec3x8<S>, radius: f32) -> (f32x8<S>, Vec3x8<S>) {
    let length = p.length();
    let scale = splat(simd, 1.0) / length;
    let (zero, centre) = (splat(simd, 0.0), length.simd_le(splat(simd, f32::MIN_POSITIVE)));
    let up = Vec3x8 { x: zero, y: splat(simd, 1.0), z: zero };
    (length - splat(simd, radius), select(centre, up, p * scale))
}
