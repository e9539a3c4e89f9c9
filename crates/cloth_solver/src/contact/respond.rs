//! The answer of eight particles to one collider.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;

use super::{Collider, DEPENETRATION_SPEED, RESOLVED_SINK, Shape, Touch};
use crate::lanes::{Frame, LANES, Vec3x8, load, select, splat};
use crate::{Particles, Pose};

/// What one collider met in one substep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub touch: Touch,
    pub deepest: f32,
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
    let Particles { position, previous, velocity, mass, inverse_mass, .. } = particles;
    let (from, to) = (Frame::new(start), Frame::new(end));
    let reach = collider.shape.bounding_radius() + offset;
    let (reach_squared, margin, zero) = (splat(simd, reach * reach), splat(simd, offset), splat(simd, 0.0));
    let (step, per_step) = (splat(simd, h), splat(simd, 1.0 / h));
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let depenetration = splat(simd, DEPENETRATION_SPEED * h);
    let still = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut impulse, mut moment, mut speed) = (still, still, zero);
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
        let (distance, local_normal) = distance_and_normal(simd, &collider.shape, local, margin, near);
        let hit = near & distance.simd_lt(margin);
        if !hit.any_true() {
            continue;
        }
        let normal = to.direction(simd, local_normal);
        let depth = margin - distance;
        let before = from.inverse_point(simd, Vec3x8::load(simd, previous, i));
        let (distance_before, _) = distance_and_normal(simd, &collider.shape, before, margin, hit);
        let depth_before = (margin - distance_before).max(zero);

        // What the particle moved against the collider in this substep.
        let carried = x - from.direction(simd, local) - Vec3x8::splat(simd, from.origin);
        let v = Vec3x8::load(simd, velocity, i);
        let slip = v * step - carried;
        let along = slip.dot(normal);
        let approach = (-along).max(zero);
        let sliding = slip - normal * along;
        let stopped = (splat(simd, collider.friction) * approach / sliding.length().max(tiny)).min(splat(simd, 1.0));
        // What was outside when the substep began is put back at once. What was not, leaves slowly, and inside a solid
        // nothing slides or swings: what its way out stretches would else come back as speed.
        let buried = depth_before.simd_gt(splat(simd, RESOLVED_SINK * offset));
        let push = buried.select(depth.min(depenetration), depth);
        let placed = x + normal * push - sliding * stopped;
        let left = sliding * (splat(simd, 1.0) - stopped) + normal * along.max(zero);
        let left = select(buried, still, left) + carried;
        select(hit, placed, x).store(position, i);
        let left = left * per_step;
        select(hit, left, v).store(velocity, i);
        let given = select(hit, (v - left) * load(simd, mass, i), still);
        (impulse, moment) = (impulse + given, moment + centred.cross(given));
        speed = speed.max((hit & !buried).select(approach * per_step, zero));
        found.touch.touching += hit.to_bitmask().count_ones();
        found.deepest = found.deepest.max(hit.select(depth, zero).reduce_max());
    }
    (found.touch.impulse, found.touch.moment) = (sum(impulse), sum(moment));
    found.touch.speed = speed.reduce_max();
    found
}

/// The sum of eight vectors, in the same order on every instruction set.
#[inline(always)]
fn sum<S: Simd>(v: Vec3x8<S>) -> Vec3 {
    Vec3::from_array([v.x, v.y, v.z].map(|axis| <[f32; LANES]>::from(axis).iter().sum()))
}

/// Signed distance and outward normal in the shape's frame where `wanted` and the distance is less than `margin`; see
/// [`Shape::distance_and_normal`]. Elsewhere a distance that is no smaller than `margin`, or anything where not wanted.
#[inline(always)]
fn distance_and_normal<S: Simd>(
    simd: S,
    shape: &Shape,
    p: Vec3x8<S>,
    margin: f32x8<S>,
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
        Shape::Convex(hull) => {
            let (distance, normal) = nearest_plane(simd, &hull.planes, p);
            // A lower bound of the distance, and exact inside. Outside it is exact where the foot of the perpendicular
            // lies on the face; over an edge or a corner the shape knows better.
            let outside = wanted & distance.simd_gt(zero) & distance.simd_lt(margin);
            if !outside.any_true() {
                return (distance, normal);
            }
            let (beyond, _) = nearest_plane(simd, &hull.planes, p - normal * distance);
            let over_edge = outside & beyond.simd_gt(splat(simd, hull.radius * f32::EPSILON * 4.0));
            exact_where(simd, shape, p, over_edge, distance, normal)
        }
    }
}

/// The plane of a hull that `p` is farthest out of.
#[inline(always)]
fn nearest_plane<S: Simd>(simd: S, planes: &[(Vec3, f32)], p: Vec3x8<S>) -> (f32x8<S>, Vec3x8<S>) {
    let mut distance = splat(simd, f32::NEG_INFINITY);
    let mut normal = Vec3x8::splat(simd, Vec3::Y);
    for &(n, d) in planes {
        let n = Vec3x8::splat(simd, n);
        let out = p.dot(n) - splat(simd, d);
        let farther = out.simd_gt(distance);
        distance = farther.select(out, distance);
        normal = select(farther, n, normal);
    }
    (distance, normal)
}

/// Replaces distance and normal in some lanes by what the shape says.
#[inline(always)]
fn exact_where<S: Simd>(
    simd: S,
    shape: &Shape,
    p: Vec3x8<S>,
    lanes: mask32x8<S>,
    distance: f32x8<S>,
    normal: Vec3x8<S>,
) -> (f32x8<S>, Vec3x8<S>) {
    let (mut distance, mut n): ([f32; LANES], [[f32; LANES]; 3]) =
        (distance.into(), [normal.x.into(), normal.y.into(), normal.z.into()]);
    let mut left = lanes.to_bitmask();
    while left != 0 {
        let lane = left.trailing_zeros() as usize;
        left &= left - 1;
        let (d, normal) = shape.distance_and_normal(Vec3::new(p.x[lane], p.y[lane], p.z[lane]));
        distance[lane] = d;
        (n[0][lane], n[1][lane], n[2][lane]) = (normal.x, normal.y, normal.z);
    }
    let [x, y, z] = n.map(|n| f32x8::simd_from(simd, n));
    (f32x8::simd_from(simd, distance), Vec3x8 { x, y, z })
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
