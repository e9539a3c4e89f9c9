//! Triangles and edges of a cloth against what of a collider fits between particles: the centre of a ball, the axis of a capsule,
//! the corners and edges of a convex solid.
//!
//! A contact acts at a point of the cloth with weights b of its corners (sum 1) along a normal n. What it lacks of the distance
//! kept, C, is made up for by `Δx_i = w_i b_i n λ`, `λ = C / Σ w_j b_j²` (Bridson, Fedkiw, Anderson 2002): the point itself moves by C,
//! and so the velocity of the point is taken into the surface, as that of a particle is.

use glam::Vec3;

use super::near::Part;
use super::nearest::{of_segments, on_triangle};
use super::patch::Patch;
use super::respond::Answer;
use super::{ConvexHull, Shape};

/// Sine of the angle below which a cloth edge and an edge of a solid are parallel and have no common normal; then particles and
/// corners meet before they do.
const PARALLEL: f32 = 1e-3;

/// How far a direction may be outside of the normals of an edge or a corner, sine of the angle: rounding.
const CONE: f32 = 1e-4;

/// What a plane may lack of the distance kept, as a part of it, and be beyond: rounding.
const BEYOND: f32 = 0.9;

/// One pass over the triangles and edges of `part`.
pub(super) fn meet(patch: &mut Patch, part: &Part, shape: &Shape, answer: &Answer) {
    match shape {
        Shape::HalfSpace => {}
        Shape::Sphere { radius } => {
            for triangle in part.triangles.iter().map(|triangle| triangle.map(|i| i as usize)) {
                if !is_beyond(patch, triangle, answer.margin) {
                    triangle_and_ball(patch, triangle, Vec3::ZERO, *radius, shape, answer);
                }
            }
        }
        Shape::Capsule { radius, half_length } => {
            let axis = [Vec3::Y * -half_length, Vec3::Y * *half_length];
            for triangle in part.triangles.iter().map(|triangle| triangle.map(|i| i as usize)) {
                if !is_beyond(patch, triangle, answer.margin) {
                    for end in axis {
                        triangle_and_ball(patch, triangle, end, *radius, shape, answer);
                    }
                }
            }
            for edge in part.edges.iter().map(|edge| edge.map(|i| i as usize)) {
                if !is_beyond(patch, edge, answer.margin) {
                    edge_and_axis(patch, edge, axis, *radius, shape, answer);
                }
            }
        }
        Shape::Convex(hull) => {
            for triangle in part.triangles.iter().map(|triangle| triangle.map(|i| i as usize)) {
                if !is_beyond(patch, triangle, answer.margin) {
                    triangle_and_corners(patch, triangle, hull, shape, answer);
                }
            }
            for edge in part.edges.iter().map(|edge| edge.map(|i| i as usize)) {
                if !is_beyond(patch, edge, answer.margin) {
                    edge_and_edges(patch, edge, hull, shape, answer);
                }
            }
        }
    }
}

/// Whether all of these are beyond a plane that the whole collider is on the other side of.
fn is_beyond<const N: usize>(patch: &Patch, corners: [usize; N], margin: f32) -> bool {
    let points = corners.map(|i| patch.now.get(i));
    corners.iter().any(|i| {
        let (normal, height) = (patch.normal.get(*i), patch.height[*i] + BEYOND * margin);
        points.iter().all(|p| normal.dot(*p) >= height)
    })
}

/// Against the ball of `radius` about `centre`.
fn triangle_and_ball(patch: &mut Patch, triangle: [usize; 3], centre: Vec3, radius: f32, shape: &Shape, answer: &Answer) {
    let points = triangle.map(|i| patch.now.get(i));
    let weights = on_triangle(centre, points);
    let way = points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2] - centre;
    let distance = way.length();
    if distance >= radius + answer.margin || distance <= f32::MIN_POSITIVE || weights.contains(&1.0) {
        return;
    }
    push(patch, triangle, weights, way / distance, radius + answer.margin - distance, shape, answer);
}

/// Against the segment `axis` blown up by `radius`.
fn edge_and_axis(patch: &mut Patch, edge: [usize; 2], axis: [Vec3; 2], radius: f32, shape: &Shape, answer: &Answer) {
    let ends = edge.map(|i| patch.now.get(i));
    let [s, t] = of_segments(ends, axis);
    let way = ends[0].lerp(ends[1], s) - axis[0].lerp(axis[1], t);
    let distance = way.length();
    if distance >= radius + answer.margin || distance <= f32::MIN_POSITIVE || s <= 0.0 || s >= 1.0 {
        return;
    }
    push(patch, edge, [1.0 - s, s], way / distance, radius + answer.margin - distance, shape, answer);
}

/// What a contact with a corner or an edge may be deep, m: less than the way out through a face is long, where the particles are
/// met, and than the inner radius, or it is on the other side of the solid.
fn most_depth<const N: usize>(hull: &ConvexHull, points: [Vec3; N], margin: f32) -> f32 {
    let faces = hull.planes.iter().map(|(n, d)| d - points.map(|p| n.dot(p)).into_iter().fold(f32::INFINITY, f32::min));
    margin + faces.fold(hull.inner_radius, f32::min)
}

/// Against the corners of a solid that it covers.
fn triangle_and_corners(patch: &mut Patch, triangle: [usize; 3], hull: &ConvexHull, shape: &Shape, answer: &Answer) {
    let points = triangle.map(|i| patch.now.get(i));
    let most_depth = most_depth(hull, points, answer.margin);
    let reach = Vec3::splat(hull.inner_radius + answer.margin);
    let low = points[0].min(points[1]).min(points[2]) - reach;
    let high = points[0].max(points[1]).max(points[2]) + reach;
    let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
    for (which, &corner) in hull.corners.iter().enumerate() {
        if corner.cmplt(low).any() || corner.cmpgt(high).any() {
            continue;
        }
        // The normals of a corner are those that no edge of it rises along.
        let edges = hull.edges.iter().filter_map(|[a, b]| match which {
            _ if *a as usize == which => Some(hull.corners[*b as usize] - corner),
            _ if *b as usize == which => Some(hull.corners[*a as usize] - corner),
            _ => None,
        });
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for edge in edges {
            let rise = normal.dot(edge) / edge.length();
            (least, most) = (least.min(rise), most.max(rise));
        }
        let outward = if most <= CONE {
            normal
        } else if least >= -CONE {
            -normal
        } else {
            continue;
        };
        let depth = answer.margin - outward.dot(points[0] - corner);
        let weights = on_triangle(corner, points);
        if depth > 0.0 && depth < most_depth && weights.iter().all(|weight| *weight > 0.0) {
            push(patch, triangle, weights, outward, depth, shape, answer);
        }
    }
}

/// Against that edge of a solid that it crosses least deep.
fn edge_and_edges(patch: &mut Patch, edge: [usize; 2], hull: &ConvexHull, shape: &Shape, answer: &Answer) {
    let ends = edge.map(|i| patch.now.get(i));
    let along = ends[1] - ends[0];
    let reach = Vec3::splat(hull.inner_radius + answer.margin);
    let (low, high) = (ends[0].min(ends[1]) - reach, ends[0].max(ends[1]) + reach);
    let most_depth = most_depth(hull, ends, answer.margin);
    let mut least: Option<(f32, f32, Vec3)> = None;
    for (corners, into_faces) in hull.edges.iter().zip(&hull.into_faces) {
        let [a, b] = corners.map(|i| hull.corners[i as usize]);
        if a.max(b).cmplt(low).any() || a.min(b).cmpgt(high).any() {
            continue;
        }
        let ridge = b - a;
        let normal = along.cross(ridge);
        let square = normal.length_squared();
        if square <= PARALLEL * PARALLEL * along.length_squared() * ridge.length_squared() {
            continue;
        }
        let normal = normal / square.sqrt();
        let rises = into_faces.map(|way| normal.dot(way));
        let outward = if rises.iter().all(|rise| *rise <= CONE) {
            normal
        } else if rises.iter().all(|rise| *rise >= -CONE) {
            -normal
        } else {
            continue;
        };
        let depth = answer.margin - outward.dot(ends[0] - a);
        let between = a - ends[0];
        let cross = along.cross(ridge);
        let s = between.cross(ridge).dot(cross) / square;
        let t = between.cross(along).dot(cross) / square;
        let crosses = s > 0.0 && s < 1.0 && (0.0..=1.0).contains(&t);
        if crosses && depth < least.map_or(most_depth, |least| least.0) {
            least = Some((depth, s, outward));
        }
    }
    if let Some((depth, s, normal)) = least.filter(|least| least.0 > 0.0) {
        push(patch, edge, [1.0 - s, s], normal, depth, shape, answer);
    }
}

/// Answers one contact that is `depth` below the distance kept, as [`super::respond::meet`] answers that of a particle.
fn push<const N: usize>(
    patch: &mut Patch,
    corners: [usize; N],
    weights: [f32; N],
    normal: Vec3,
    depth: f32,
    shape: &Shape,
    answer: &Answer,
) {
    let inertia: f32 = (0..N).map(|i| patch.inverse_mass[corners[i]] * weights[i] * weights[i]).sum();
    if inertia <= 0.0 {
        return;
    }
    let mean = |of: &crate::Soa3| (0..N).map(|i| of.get(corners[i]) * weights[i]).sum::<Vec3>();
    let (distance_before, _) = shape.distance_and_normal(mean(&patch.before));
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
            for (of, by) in [(&mut patch.now, shift), (&mut patch.shift, shift), (&mut patch.way, change), (&mut patch.slip, change)] {
                of.set(corner, of.get(corner) + by * share);
            }
            patch.touched[corner] = true;
        }
    }
    patch.deepest = patch.deepest.max(depth);
    patch.pushed = patch.pushed.max(depth);
}
