//! The answer of eight particles to one collider.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::{Quat, Vec3};

use super::{Collider, DEPENETRATION_SPEED, Shape, Surface, Touch};
use crate::lanes::{Frame, LANES, Vec3x8, load, select, splat, store};
use crate::{Particles, Pose};

/// What one collider met in one substep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub touch: Touch,
    pub deepest: f32,
    /// How deep in the solid the deepest particle was when the substep began, m.
    pub buried: f32,
    /// How near the nearest particle is, m.
    pub nearest: f32,
}

/// How a contact answers, the same for all of one collider in one substep, or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    /// Distance kept from the surface, m.
    pub margin: f32,
    /// Coulomb friction coefficient.
    pub friction: f32,
    /// How far what began inside the solid may be moved out, m.
    pub way_out: f32,
    /// How far it may move in all, m: no link pulls it along faster while the cloth leaves a solid that it was put into.
    pub most_way: f32,
    /// How far the collider comes in the substep without giving speed to what it pushes, m.
    pub arrives: Vec3,
    /// Part of the substep that this is, 0..=1.
    pub part: f32,
}

impl Answer {
    /// Of `collider` in a whole substep of `h` s.
    pub fn new(collider: &Collider, margin: f32, arrives: Vec3, is_slow: bool, h: f32) -> Self {
        let way_out = DEPENETRATION_SPEED * h;
        let most_way = if is_slow { way_out } else { f32::INFINITY };
        Self { margin, friction: collider.friction, way_out, most_way, arrives, part: 1.0 }
    }

    /// Where a collider that was at `start` would have been, had it arrived by then: what it has moved from there is its speed.
    pub fn without_arrival(&self, start: Pose) -> Pose {
        Pose { position: start.position + self.arrives, ..start }
    }

    /// In a part of the substep.
    pub fn in_part(self, part: f32) -> Self {
        Self { way_out: self.way_out * part, most_way: self.most_way * part, part, ..self }
    }
}

/// What was no farther from the distance kept than this part of it touched from the start.
pub(super) const AT_ONCE: f32 = 0.01;

/// Eight particles against one collider, in its frame.
#[derive(Clone, Copy)]
pub(super) struct Eight<S: Simd> {
    /// Where they were when the substep, or this part of it, began, m.
    pub before: Vec3x8<S>,
    /// Where they are, m.
    pub now: Vec3x8<S>,
    /// What they move against the collider in a whole substep at their velocity, m.
    pub slip: Vec3x8<S>,
}

/// What came of [`meet`].
#[derive(Clone, Copy)]
pub(super) struct Met<S: Simd> {
    /// How far they are moved, m; 0 of those that do not touch.
    pub shift: Vec3x8<S>,
    /// What they move in a whole substep now, m.
    pub slip: Vec3x8<S>,
    /// Which of them touch.
    pub hit: mask32x8<S>,
    /// How far those were below the distance kept, m; 0 of the others.
    pub depth: f32x8<S>,
    /// How deep in the solid they were when the substep began, m; 0 if outside.
    pub buried: f32x8<S>,
    /// How far those that were outside would have moved into the surface in a whole substep, m; 0 of the others.
    pub approach: f32x8<S>,
}

/// Puts particles that are nearer than the distance kept back to the surface where they came through it, and takes their velocity
/// into the surface. `wanted` are those that may move and whose `distance` is less than the margin.
///
/// What was inside the solid when the substep began has no way in: it leaves along the plane of least depth, slowly, and
/// nothing slides or swings there: what its way out stretches would else come back as speed.
#[inline(always)]
pub(super) fn meet<S: Simd>(
    simd: S,
    surface: Surface,
    of: Eight<S>,
    (distance, normal): (f32x8<S>, Vec3x8<S>),
    wanted: mask32x8<S>,
    answer: &Answer,
) -> Met<S> {
    let Eight { before, now, slip } = of;
    let (margin, zero, one) = (splat(simd, answer.margin), splat(simd, 0.0), splat(simd, 1.0));
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let (distance_before, normal_before) = surface.distance_and_normal(simd, before, margin, wanted);
    let buried = distance_before.simd_lt(zero);
    let high = (distance_before - margin).max(zero);
    let (mut entry, mut entry_distance, mut entry_normal) = (before, distance_before, normal_before);
    if (wanted & high.simd_gt(margin * splat(simd, AT_ONCE))).any_true() {
        // Along the way the distance to a convex solid is a convex function: the chord through its ends meets the distance kept no
        // earlier than the way does.
        let time = (high / (high + margin - distance).max(tiny)).max(zero).min(one);
        entry = before + (now - before) * time;
        (entry_distance, entry_normal) = surface.distance_and_normal(simd, entry, margin, wanted);
    }
    let entry_depth = margin - entry_distance + (entry - now).dot(entry_normal);
    let normal = select(buried, normal, entry_normal);
    let depth = buried.select(margin - distance, entry_depth).max(zero);
    let hit = wanted & depth.simd_gt(zero);

    let along = slip.dot(normal);
    let approach = (-along).max(zero);
    let sliding = slip - normal * along;
    let stopped = (splat(simd, answer.friction) * approach / sliding.length().max(tiny)).min(one);
    let left_inside = (margin - distance_before - splat(simd, answer.way_out)).max(zero);
    let push = buried.select((depth - left_inside).max(zero), depth);
    let dragged = sliding * (stopped * splat(simd, answer.part));
    let left = sliding * (one - stopped) + normal * along.max(zero);
    let still = Vec3x8 { x: zero, y: zero, z: zero };
    let mut moved_out = normal * push;
    if answer.most_way.is_finite() {
        let way = now + moved_out - before;
        let part = (splat(simd, answer.most_way) / way.length().max(tiny)).min(one);
        moved_out = before + way * part - now;
    }
    Met {
        shift: select(hit, select(buried, moved_out, normal * push - dragged), still),
        slip: select(hit, select(buried, still, left), slip),
        hit,
        depth: hit.select(depth, zero),
        buried: hit.select((-distance_before).max(zero), zero),
        approach: (hit & !buried).select(approach, zero),
    }
}

/// Every free particle against a collider, in one stage.
#[inline(always)]
pub(super) fn respond<S: Simd>(
    simd: S,
    particles: &mut Particles,
    touched: &mut [f32],
    shape: &Shape,
    mut poses: [Pose; 2],
    answer: &Answer,
    h: f32,
) -> Found {
    if matches!(shape, Shape::Sphere { .. }) && poses[0].rotation == poses[1].rotation {
        // A ball that does not spin looks the same from all sides.
        poses = poses.map(|pose| Pose::new(pose.position, Quat::IDENTITY));
    }
    let is_still = poses[0] == poses[1];
    match (is_still, poses.iter().all(|pose| pose.rotation == Quat::IDENTITY)) {
        (true, true) => respond_in::<S, true, true>(simd, particles, touched, shape, poses, answer, h),
        (true, false) => respond_in::<S, true, false>(simd, particles, touched, shape, poses, answer, h),
        (false, true) => respond_in::<S, false, true>(simd, particles, touched, shape, poses, answer, h),
        (false, false) => respond_in::<S, false, false>(simd, particles, touched, shape, poses, answer, h),
    }
}

/// [`respond`] to a collider that is `STILL` in this substep or not, and whose frame is `PARALLEL` to that of the cloth or not.
#[inline(always)]
fn respond_in<S: Simd, const STILL: bool, const PARALLEL: bool>(
    simd: S,
    particles: &mut Particles,
    touched: &mut [f32],
    shape: &Shape,
    [start, end]: [Pose; 2],
    answer: &Answer,
    h: f32,
) -> Found {
    let Particles { position, previous, velocity, mass, inverse_mass, .. } = particles;
    let (from, to) = (Frame::new(start), Frame::new(end));
    let moving = Frame::new(answer.without_arrival(start));
    let (margin, zero) = (splat(simd, answer.margin), splat(simd, 0.0));
    let (step, per_step) = (splat(simd, h), splat(simd, 1.0 / h));
    let still = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut impulse, mut moment, mut speed) = (still, still, zero);
    let mut found = Found::default();
    let (mut nearest, mut deepest, mut buried) = (splat(simd, f32::INFINITY), zero, zero);
    for i in (0..inverse_mass.len() / LANES).map(|group| group * LANES) {
        let x = Vec3x8::load(simd, position, i);
        let free = load(simd, inverse_mass, i).simd_gt(zero);
        let centred = x - Vec3x8::splat(simd, to.origin);
        let now = turned_back::<S, PARALLEL>(simd, &to, centred);
        let (distance, normal) = distance_and_normal(simd, shape, now, margin, free);
        nearest = nearest.min(distance);
        let wanted = free & distance.simd_lt(margin);
        if !wanted.any_true() {
            continue;
        }
        let x_before = Vec3x8::load(simd, previous, i);
        let before = turned_back::<S, PARALLEL>(simd, &from, x_before - Vec3x8::splat(simd, from.origin));
        let v = Vec3x8::load(simd, velocity, i);
        let mut slip = turned_back::<S, PARALLEL>(simd, &from, v * step);
        if !STILL {
            slip = slip + (now - moving.inverse_point(simd, x));
        }
        let met = meet(simd, Surface::of(shape), Eight { before, now, slip }, (distance, normal), wanted, answer);
        (x + turned::<S, PARALLEL>(simd, &to, met.shift)).store(position, i);
        let mut left = turned::<S, PARALLEL>(simd, &from, met.slip);
        if !STILL {
            let at = now + met.shift;
            left = left + (to.point(simd, at) - moving.point(simd, at));
        }
        let left = left * per_step;
        select(met.hit, left, v).store(velocity, i);
        let given = select(met.hit, (v - left) * load(simd, mass, i), still);
        (impulse, moment) = (impulse + given, moment + centred.cross(given));
        speed = speed.max(met.approach);
        store(met.hit.select(splat(simd, 1.0), load(simd, touched, i)), touched, i);
        found.touch.touching += met.hit.to_bitmask().count_ones();
        deepest = deepest.max(met.depth);
        buried = buried.max(met.buried);
    }
    found.nearest = nearest.reduce_min();
    found.deepest = deepest.reduce_max();
    found.buried = buried.reduce_max();
    (found.touch.impulse, found.touch.moment) = (sum(impulse), sum(moment));
    found.touch.speed = speed.reduce_max() / h;
    found
}

/// Takes a direction out of a frame, which may be `PARALLEL` to the space around it.
#[inline(always)]
fn turned<S: Simd, const PARALLEL: bool>(simd: S, frame: &Frame, v: Vec3x8<S>) -> Vec3x8<S> {
    if PARALLEL { v } else { frame.direction(simd, v) }
}

/// Takes a direction into a frame, which may be `PARALLEL` to the space around it.
#[inline(always)]
fn turned_back<S: Simd, const PARALLEL: bool>(simd: S, frame: &Frame, v: Vec3x8<S>) -> Vec3x8<S> {
    if PARALLEL { v } else { frame.inverse_direction(simd, v) }
}

/// The sum of eight vectors, in the same order on every instruction set.
#[inline(always)]
fn sum<S: Simd>(v: Vec3x8<S>) -> Vec3 {
    Vec3::from_array([v.x, v.y, v.z].map(|axis| <[f32; LANES]>::from(axis).iter().sum()))
}

/// Signed distance and outward normal in the shape's frame where `wanted` and the distance is less than `margin`; see
/// [`Shape::distance_and_normal`]. Elsewhere a distance that is no smaller than `margin`, or anything where not wanted.
#[inline(always)]
pub(super) fn distance_and_normal<S: Simd>(
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
        Shape::Mesh(_) => exact_where(simd, shape, p, wanted, splat(simd, f32::MAX), p),
        Shape::Curved(curved) => {
            let (distance, normal, is_bound) = curved.bound(simd, p);
            let near = is_bound & wanted & distance.simd_lt(margin);
            if near.any_true() { exact_where(simd, shape, p, near, distance, normal) } else { (distance, normal) }
        }
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
