//! Triangles and edges of a cloth against what of a collider fits between particles: the centre of a ball, the axis of a capsule,
//! the corners and edges of a convex solid, the folds and borders of a triangle mesh.
//!
//! A contact acts at a point of the cloth with weights b of its corners (sum 1) along a normal n. What it lacks of the distance
//! kept, C, is made up for by `Δx_i = w_i b_i n λ`, `λ = C / Σ w_j b_j²` (Bridson, Fedkiw, Anderson 2002): the point itself moves by C,
//! and so the velocity of the point is taken into the surface, as that of a particle is.
//!
//! Where and along which normal is decided where the cloth came into contact, not where it would have gone to: a particle that bears a
//! load is drawn in by h² F/m in a substep, and looked at there an edge may seem to slip off sideways.

mod hull;

pub(super) use self::hull::is_pierced;

use glam::Vec3;

use self::hull::{
    edge_and_edges, edge_over_edges, is_cut, triangle_and_corners, triangle_around_corner, triangle_over_corners,
};
use super::near::Part;
use super::nearest::{of_segments, on_triangle};
use super::patch::Patch;
use super::respond::{AT_ONCE, Answer};
use super::{ConvexHull, Shape, TriangleMesh};

/// Rounds in which what would pass through a solid is held back, at most: each holds back what the last one let in.
const MOST_ZONES: u32 = 16;

/// The part of a round solid, about its centre or axis, that nothing may pass, in its radius.
const CORE: f32 = 0.5;

/// What a plane may lack of the distance kept, as a part of it, and be beyond: rounding.
const BEYOND: f32 = 0.9;

/// A point of the cloth and one of the collider that are nearest to each other.
#[derive(Clone, Copy, Debug)]
struct Pair<const N: usize> {
    /// Weights of the corners at the point of the cloth.
    weights: [f32; N],
    /// The point of the ball's centre, the axis, the corner or the edge.
    core: Vec3,
    /// From there to the cloth, of unit length.
    normal: Vec3,
    /// How far that is, m.
    distance: f32,
}

impl<const N: usize> Pair<N> {
    /// `None` where the points are one, or the cloth's is one of its particles, which are met elsewhere.
    fn new(weights: [f32; N], points: [Vec3; N], core: Vec3) -> Option<Self> {
        let way = blend(weights, points) - core;
        let distance = way.length();
        let is_particle = weights.iter().any(|weight| *weight >= 1.0);
        (distance > f32::MIN_POSITIVE && !is_particle).then(|| Self { weights, core, normal: way / distance, distance })
    }
}

/// One pass over the triangles and edges of `part`.
pub(super) fn meet(patch: &mut Patch, part: &Part, shape: &Shape, answer: &Answer) {
    let margin = answer.margin;
    let (keep, solid) = (shape.feature_radius() + margin, shape.solid());
    let among = |[first, end]: [u32; 2]| &part.features[first as usize..end as usize];
    for triangle in &part.triangles {
        let (corners, near) = (triangle.corners.map(|i| i as usize), among(triangle.near));
        if is_beyond(patch, corners, margin) {
            continue;
        }
        if let Some((hull, _)) = solid {
            let nearest = |near: &[u32], points, reach| triangle_and_corners(hull, near, points, reach);
            let inside = |points| {
                triangle_around_corner(hull, near, points, keep)
                    .or_else(|| triangle_over_corners(hull, near, points, keep))
            };
            touch_solid(patch, corners, near, keep, (nearest, inside), (shape, hull), answer);
        } else {
            for point in near.iter().map(|which| part.points[*which as usize]) {
                let nearest = |points, _| triangle_and_point(points, point);
                touch_round(patch, corners, keep, ([point; 2], nearest), shape, answer);
            }
        }
    }
    for edge in &part.edges {
        let (ends, near) = (edge.corners.map(|i| i as usize), among(edge.near));
        if is_beyond(patch, ends, margin) {
            continue;
        }
        if let Some((hull, _)) = solid {
            let nearest = |near: &[u32], points, reach| edge_and_edges(hull, near, points, reach);
            let inside = |points| edge_over_edges(hull, Some(near), points, keep);
            touch_solid(patch, ends, near, keep, (nearest, inside), (shape, hull), answer);
        } else {
            for axis in near.iter().map(|which| part.segments[*which as usize]) {
                let nearest = |points, _| edge_and_segment(points, axis);
                let ends_of_box = [axis[0].min(axis[1]), axis[0].max(axis[1])];
                touch_round(patch, ends, keep, (ends_of_box, nearest), shape, answer);
            }
        }
    }
}

/// Lets what passes through the solid, and did not when the stage began, go with the solid through this stage as one rigid body
/// (impact zones: Provot 1997; Bridson, Fedkiw, Anderson 2002): passes over contacts that pull at each other need not agree.
pub(super) fn hold_back(patch: &mut Patch, part: &Part, shape: &Shape, margin: f32) {
    let among = |[first, end]: [u32; 2]| &part.features[first as usize..end as usize];
    let core = CORE * shape.feature_radius();
    for _ in 0..MOST_ZONES {
        let mut holds = false;
        for triangle in &part.triangles {
            let points = || among(triangle.near).iter().map(|which| part.points[*which as usize]);
            let passes = |corners: [Vec3; 3]| match shape.solid() {
                Some((hull, _)) => is_cut(hull, corners),
                None => points().any(|p| blend(on_triangle(p, corners), corners).distance(p) < core),
            };
            holds |= hold_back_one(patch, triangle.corners.map(|i| i as usize), passes, margin);
        }
        for edge in &part.edges {
            let axes = || among(edge.near).iter().map(|which| part.segments[*which as usize]);
            let passes = |ends: [Vec3; 2]| match shape.solid() {
                Some((hull, _)) => is_cut(hull, ends),
                None => axes().any(|axis| {
                    let [s, t] = of_segments(ends, axis);
                    ends[0].lerp(ends[1], s).distance(axis[0].lerp(axis[1], t)) < core
                }),
            };
            holds |= hold_back_one(patch, edge.corners.map(|i| i as usize), passes, margin);
        }
        if !holds {
            break;
        }
    }
}

/// Puts back what particles went through the middle of a wall of triangles in this stage: in a narrow furrow pushes off one side go
/// through the other, and a wall has no inside to lead out of.
pub(super) fn hold_back_particles(patch: &mut Patch, part: &Part, mesh: &TriangleMesh) {
    for number in 0..part.slots.len() {
        let ends = [patch.before.get(number), patch.now.get(number)];
        let passes = |triangle: &u32| is_pierced(mesh.corners(*triangle), ends);
        if ends[0] != ends[1] && part.triangles_near(number).iter().any(passes) {
            put_back(patch, number);
        }
    }
}

/// Lets a particle go with the collider through this stage; `true` if it did not already.
fn put_back(patch: &mut Patch, number: usize) -> bool {
    let (before, now) = (patch.before.get(number), patch.now.get(number));
    let is_moved = patch.inverse_mass[number] > 0.0 && now != before;
    if is_moved {
        patch.now.set(number, before);
        patch.shift.set(number, patch.shift.get(number) + before - now);
        patch.way.set(number, patch.way.get(number) - patch.slip.get(number));
        patch.slip.set(number, Vec3::ZERO);
        patch.touched[number] = true;
    }
    is_moved
}

/// [`hold_back`] of one triangle or edge; `true` if it had to be.
fn hold_back_one<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    passes: impl Fn([Vec3; N]) -> bool,
    margin: f32,
) -> bool {
    let (before, now) = (corners.map(|i| patch.before.get(i)), corners.map(|i| patch.now.get(i)));
    if is_beyond(patch, corners, margin) || !passes(now) || passes(before) {
        return false;
    }
    corners.map(|corner| put_back(patch, corner)).contains(&true)
}

/// Whether all of these are beyond a plane that the whole collider is on the other side of.
#[inline(always)]
fn is_beyond<const N: usize>(patch: &Patch, corners: [usize; N], margin: f32) -> bool {
    for i in corners {
        let (normal, height) = (patch.normal.get(i), patch.height[i] + BEYOND * margin);
        let mut all = true;
        for j in corners {
            all &= normal.dot(patch.now.get(j)) >= height;
        }
        if all {
            return true;
        }
    }
    false
}

/// Meets a solid with corners and edges, of which `near` are met, at the distance `keep`. `inside` knows the way out for what was inside
/// from the start.
fn touch_solid<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    near: &[u32],
    keep: f32,
    (nearest, inside): (
        impl Fn(&[u32], [Vec3; N], f32) -> Option<Pair<N>>,
        impl Fn([Vec3; N]) -> Option<(Pair<N>, f32)>,
    ),
    (shape, hull): (&Shape, &ConvexHull),
    answer: &Answer,
) {
    let mut is_outside = false;
    for one in near.chunks(1) {
        is_outside |= touch(patch, corners, keep, |points, reach| nearest(one, points, reach), shape, answer);
    }
    // In a quiet substep nothing gets in: pushed out here, taut cloth over an edge would never rest.
    if answer.part >= 1.0 {
        return;
    }
    let now = corners.map(|i| patch.now.get(i));
    let way_out = if is_outside {
        if is_cut(hull, now) { inside(now) } else { None }
    } else {
        let outside = nearest(near, now, keep).map(|pair| (pair, keep - pair.distance));
        outside.or_else(|| inside(now))
    };
    if let Some((pair, depth)) = way_out.filter(|(_, depth)| *depth > 0.0) {
        push(patch, corners, &pair, depth, shape, answer);
    }
}

/// Meets the centre or the axis of a round solid, or a corner or a fold of a mesh, which `nearest` knows and a box holds.
fn touch_round<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    keep: f32,
    (around, nearest): ([Vec3; 2], impl Fn([Vec3; N], f32) -> Option<Pair<N>>),
    shape: &Shape,
    answer: &Answer,
) {
    let [before, now] = [&patch.before, &patch.now].map(|x| corners.map(|i| x.get(i)));
    let moved = (0..N).map(|i| before[i].distance_squared(now[i])).fold(0.0, f32::max).sqrt();
    if !is_near(before, keep + moved, around) {
        return;
    }
    if touch(patch, corners, keep, &nearest, shape, answer) || answer.part >= 1.0 {
        return;
    }
    let now = corners.map(|i| patch.now.get(i));
    let outside = nearest(now, keep).map(|pair| (pair, keep - pair.distance));
    if let Some((pair, depth)) = outside.filter(|(_, depth)| *depth > 0.0) {
        push(patch, corners, &pair, depth, shape, answer);
    }
}

/// Finds whether and where these come nearer than `keep` to what `nearest` finds next to them within a reach, and answers. `false`
/// if there was nothing where they began.
fn touch<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    keep: f32,
    nearest: impl Fn([Vec3; N], f32) -> Option<Pair<N>>,
    shape: &Shape,
    answer: &Answer,
) -> bool {
    let (before, now) = (corners.map(|i| patch.before.get(i)), corners.map(|i| patch.now.get(i)));
    let moved = (0..N).map(|i| before[i].distance_squared(now[i])).fold(0.0, f32::max).sqrt();
    let depth_at = |pair: &Pair<N>| keep - pair.normal.dot(blend(pair.weights, now) - pair.core);
    let Some(mut pair) = nearest(before, keep + moved) else { return false };
    // The plane between them, if they are still on their own sides of it.
    if now.iter().all(|p| pair.normal.dot(*p - pair.core) >= keep) {
        return true;
    }
    let (high, depth) = ((pair.distance - keep).max(0.0), depth_at(&pair));
    let time = if depth > 0.0 { high / (high + depth) } else { 1.0 };
    if high > AT_ONCE * answer.margin || depth <= 0.0 {
        let then: [Vec3; N] = std::array::from_fn(|i| before[i].lerp(now[i], time));
        pair = nearest(then, keep).unwrap_or(pair);
    }
    let depth = depth_at(&pair);
    if depth > 0.0 {
        push(patch, corners, &pair, depth, shape, answer);
    }
    true
}

fn blend<const N: usize>(weights: [f32; N], points: [Vec3; N]) -> Vec3 {
    (0..N).map(|i| points[i] * weights[i]).sum()
}

fn triangle_and_point(points: [Vec3; 3], core: Vec3) -> Option<Pair<3>> {
    Pair::new(on_triangle(core, points), points, core)
}

fn edge_and_segment(ends: [Vec3; 2], axis: [Vec3; 2]) -> Option<Pair<2>> {
    let [s, t] = of_segments(ends, axis);
    Pair::new([1.0 - s, s], ends, axis[0].lerp(axis[1], t))
}

/// Whether what is no farther than `reach` from the box around `points` may be this segment or corner.
fn is_near<const N: usize>(points: [Vec3; N], reach: f32, [low, high]: [Vec3; 2]) -> bool {
    let reach = Vec3::splat(reach);
    let (least, most) = points.iter().fold((Vec3::MAX, Vec3::MIN), |(least, most), p| (least.min(*p), most.max(*p)));
    !(high.cmplt(least - reach).any() || low.cmpgt(most + reach).any())
}

/// Answers one contact that is `depth` below the distance kept, as [`super::respond::meet`] answers that of a particle.
fn push<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    pair: &Pair<N>,
    depth: f32,
    shape: &Shape,
    answer: &Answer,
) {
    let Pair { weights, normal, .. } = *pair;
    // What is held counts as being as light as the others: a push close beside it would else throw these far off.
    let lightest = corners.map(|corner| patch.inverse_mass[corner]).into_iter().fold(0.0, f32::max);
    let light = |corner: usize| if patch.inverse_mass[corner] > 0.0 { patch.inverse_mass[corner] } else { lightest };
    let inertia: f32 = (0..N).map(|i| light(corners[i]) * weights[i] * weights[i]).sum();
    if lightest <= 0.0 {
        return;
    }
    let mean = |of: &crate::Soa3| (0..N).map(|i| of.get(corners[i]) * weights[i]).sum::<Vec3>();
    let distance_before = shape.depth(mean(&patch.before));
    let slip = mean(&patch.slip);
    let along = slip.dot(normal);
    let approach = (-along).max(0.0);
    let sliding = slip - normal * along;
    let (shift, change) = if distance_before < 0.0 {
        let left_inside = (answer.margin - distance_before - answer.way_out).max(0.0);
        (normal * (depth - left_inside).max(0.0), -slip)
    } else {
        let stopped = (answer.friction * approach / sliding.length().max(f32::MIN_POSITIVE)).min(1.0);
        (normal * depth - sliding * (stopped * answer.part), normal * approach - sliding * stopped)
    };
    for i in 0..N {
        let (corner, share) = (corners[i], patch.inverse_mass[corners[i]] * weights[i] / inertia);
        if share > 0.0 {
            for (of, by) in [
                (&mut patch.now, shift),
                (&mut patch.shift, shift),
                (&mut patch.way, change),
                (&mut patch.slip, change),
            ] {
                of.set(corner, of.get(corner) + by * share);
            }
            patch.touched[corner] = true;
        }
    }
    if distance_before >= 0.0 {
        patch.approach = patch.approach.max(approach);
    }
    patch.pushes += 1;
    patch.deepest = patch.deepest.max(depth);
    patch.pushed = patch.pushed.max(depth);
}
