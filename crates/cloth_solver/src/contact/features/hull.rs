//! Triangles and edges against the corners and edges of a convex solid.

use glam::Vec3;

use super::{Pair, blend, edge_and_segment, is_near, triangle_and_point};
use crate::contact::ConvexHull;
use crate::contact::nearest::on_triangle;

/// Sine of the angle below which a cloth edge and an edge of a solid are parallel and have no common normal; then particles and
/// corners meet before they do.
const PARALLEL: f32 = 1e-3;

/// How far a direction may be outside of the normals of an edge or a corner, sine of the angle: the rounding of places some
/// decimetres from the origin, over a distance kept of a tenth of a millimetre.
const CONE: f32 = 2e-3;

/// Cosine of the angle to a triangle's normal beyond which a way off a corner is along the triangle rather than away from it.
const OBLIQUE: f32 = 0.5;

/// The corners of a solid numbered `near`.
fn corners_of<'a>(hull: &'a ConvexHull, near: &'a [u32]) -> impl Iterator<Item = (usize, &'a Vec3)> {
    near.iter().map(|which| (*which as usize, &hull.corners[*which as usize]))
}

/// The edges of a solid numbered `near`, and the directions into their faces.
fn edges_of<'a>(hull: &'a ConvexHull, near: &'a [u32]) -> impl Iterator<Item = ([Vec3; 2], &'a [Vec3; 2])> {
    let corners = |edge: [u32; 2]| edge.map(|i| hull.corners[i as usize]);
    near.iter().map(move |which| (corners(hull.edges[*which as usize]), &hull.into_faces[*which as usize]))
}

/// The corner of a solid nearest to a triangle that it faces.
pub(super) fn triangle_and_corners(hull: &ConvexHull, near: &[u32], points: [Vec3; 3], reach: f32) -> Option<Pair<3>> {
    let corners = corners_of(hull, near).filter(|(_, corner)| is_near(points, reach, [**corner; 2]));
    let pairs = corners.filter_map(|(which, corner)| {
        let pair = triangle_and_point(points, *corner)?;
        let is_inner = pair.weights.iter().all(|weight| *weight > 0.0);
        (is_inner && faces(hull, which, pair.normal) == Some(1.0)).then_some(pair)
    });
    pairs.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// The edge of a solid nearest to one that it faces.
pub(super) fn edge_and_edges(hull: &ConvexHull, near: &[u32], ends: [Vec3; 2], reach: f32) -> Option<Pair<2>> {
    let mut nearest: Option<Pair<2>> = None;
    for (ridge @ [a, b], into_faces) in edges_of(hull, near) {
        if !is_near(ends, reach, [a.min(b), a.max(b)]) {
            continue;
        }
        let Some(pair) = edge_and_segment(ends, ridge) else { continue };
        let faces = into_faces.iter().all(|way| pair.normal.dot(*way) <= CONE);
        if faces && nearest.is_none_or(|nearest| pair.distance < nearest.distance) {
            nearest = Some(pair);
        }
    }
    nearest
}

/// 1 if `normal` is one of a corner, along which no edge of it rises, −1 if the opposite is.
fn faces(hull: &ConvexHull, corner: usize, normal: Vec3) -> Option<f32> {
    let place = hull.corners[corner];
    let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
    for [a, b] in hull.edges.iter().map(|edge| edge.map(|i| i as usize)).filter(|edge| edge.contains(&corner)) {
        let edge = hull.corners[if a == corner { b } else { a }] - place;
        let rise = normal.dot(edge) / edge.length();
        (least, most) = (least.min(rise), most.max(rise));
    }
    match (most <= CONE, least >= -CONE) {
        (true, _) => Some(1.0),
        (_, true) => Some(-1.0),
        _ => None,
    }
}

/// What a contact with a corner or an edge may be deep, m: less than the inner radius, or it is on the other side of the solid, and
/// than the way out through a face is long, where particles are met; of what has no particle inside and yet passes through the
/// solid, no particle is met.
fn most_depth<const N: usize>(hull: &ConvexHull, points: [Vec3; N], margin: f32) -> f32 {
    let is_inside = |p: &Vec3| hull.planes.iter().all(|(n, d)| n.dot(*p) < *d);
    if !points.iter().any(is_inside) && is_cut(hull, points) {
        return margin + hull.inner_radius;
    }
    let faces = hull.planes.iter().map(|(n, d)| d - points.map(|p| n.dot(p)).into_iter().fold(f32::INFINITY, f32::min));
    margin + faces.fold(hull.inner_radius, f32::min)
}

/// Whether an edge or a triangle passes through a solid.
pub(super) fn is_cut<const N: usize>(hull: &ConvexHull, points: [Vec3; N]) -> bool {
    let pairs = (0..N).flat_map(|i| (i + 1..N).map(move |j| [i, j]));
    let edges = hull.edges.iter().map(|edge| edge.map(|i| hull.corners[i as usize]));
    pairs.map(|pair| pair.map(|i| points[i])).any(|ends| is_segment_cut(hull, ends))
        || N == 3 && edges.into_iter().any(|edge| is_pierced([points[0], points[1], points[N - 1]], edge))
}

/// Whether a segment passes through a solid: it is clipped by the planes (Cyrus and Beck 1978).
fn is_segment_cut(hull: &ConvexHull, [a, b]: [Vec3; 2]) -> bool {
    let (mut enters, mut leaves) = (0.0_f32, 1.0_f32);
    for (n, d) in &hull.planes {
        let (from, to) = (n.dot(a) - d, n.dot(b) - d);
        if from >= 0.0 && to >= 0.0 {
            return false;
        }
        let time = from / (from - to);
        if from > 0.0 {
            enters = enters.max(time);
        } else if to > 0.0 {
            leaves = leaves.min(time);
        }
    }
    enters < leaves
}

/// Whether a segment passes through a triangle.
pub(in crate::contact) fn is_pierced([a, b, c]: [Vec3; 3], [from, to]: [Vec3; 2]) -> bool {
    let across = (b - a).cross(c - a);
    let [low, high] = [from, to].map(|end| across.dot(end - a));
    if (low < 0.0) == (high < 0.0) {
        return false;
    }
    let place = from.lerp(to, low / (low - high));
    [[a, b], [b, c], [c, a]].iter().all(|[u, v]| (*u - place).cross(*v - place).dot(across) > 0.0)
}

/// The way off the corner of a solid that sticks through a triangle, and how far it is, m.
pub(super) fn triangle_over_corners(
    hull: &ConvexHull,
    near: &[u32],
    points: [Vec3; 3],
    margin: f32,
) -> Option<(Pair<3>, f32)> {
    let edges = [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|i: usize| points[i]));
    // Where an edge of it crosses one of the solid less deep, that is the way out.
    let crossed = edges.into_iter().filter_map(|ends| edge_over_edges(hull, None, ends, margin));
    let most_depth = crossed.map(|(_, depth)| depth).fold(most_depth(hull, points, margin), f32::min);
    let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize_or_zero();
    let corners = corners_of(hull, near).filter(|(_, corner)| is_near(points, most_depth, [**corner; 2]));
    let ways = corners.filter_map(|(which, &core)| {
        let normal = normal * faces(hull, which, normal)?;
        let weights = on_triangle(core, points);
        let depth = margin - normal.dot(points[0] - core);
        let is_through = depth > 0.0 && depth < most_depth && weights.iter().all(|weight| *weight > 0.0);
        is_through.then_some((Pair { weights, core, normal, distance: margin - depth }, depth))
    });
    ways.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The other ends of the edges that meet in a corner.
fn edges_from(hull: &ConvexHull, corner: usize) -> impl Iterator<Item = Vec3> {
    let other = move |[a, b]: [usize; 2]| (a == corner).then_some(b).or((b == corner).then_some(a));
    hull.edges.iter().filter_map(move |edge| other(edge.map(|i| i as usize))).map(|i| hull.corners[i])
}

/// The way off the corner of a solid of which all edges pass through a triangle, and how far it is, m: from the middle of where they
/// do to the corner, if that is nearer than their other ends. Near a sharp corner the way out through a face may be shorter, and
/// leads nowhere: no particle is inside.
pub(super) fn triangle_around_corner(
    hull: &ConvexHull,
    near: &[u32],
    points: [Vec3; 3],
    margin: f32,
) -> Option<(Pair<3>, f32)> {
    let across = (points[1] - points[0]).cross(points[2] - points[0]);
    let area = across.length_squared();
    let ways = corners_of(hull, near).filter_map(|(which, &core)| {
        let mut sum = [0.0; 3];
        let mut around = true;
        let height = across.dot(core - points[0]);
        for end in edges_from(hull, which) {
            let time = height / (height - across.dot(end - points[0]));
            if !(0.0..0.5).contains(&time) {
                around = false;
                break;
            }
            let place = core.lerp(end, time);
            let weight = |i: usize| {
                let [u, v] = [1, 2].map(|step| points[(i + step) % 3] - place);
                u.cross(v).dot(across) / area
            };
            let weights: [f32; 3] = std::array::from_fn(weight);
            around &= weights.iter().all(|weight| *weight > 0.0);
            sum = std::array::from_fn(|i| sum[i] + weights[i]);
        }
        let count: f32 = sum.iter().sum();
        let weights = sum.map(|weight| weight / count);
        let way = core - blend(weights, points);
        let distance = way.length();
        if !around || distance <= f32::MIN_POSITIVE {
            return None;
        }
        // An edge that lies in the triangle passes through it anywhere: then the way is off the triangle's plane.
        let (off, out) = (across * (height.signum() / area.sqrt()), height.abs() / area.sqrt());
        let is_oblique = out < OBLIQUE * distance;
        let (normal, distance) = if is_oblique { (off, out) } else { (way / distance, distance) };
        Some((Pair { weights, core, normal, distance }, distance + margin))
    });
    ways.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The way off that edge of a solid, one of those `near` if given, which this one crosses least deep, and how far it is, m.
pub(super) fn edge_over_edges(
    hull: &ConvexHull,
    near: Option<&[u32]>,
    ends: [Vec3; 2],
    margin: f32,
) -> Option<(Pair<2>, f32)> {
    let along = ends[1] - ends[0];
    let mut most_depth = most_depth(hull, ends, margin);
    let mut least = None;
    let count = near.map_or(hull.edges.len(), <[u32]>::len);
    for which in (0..count).map(|i| near.map_or(i, |near| near[i] as usize)) {
        let ([a, b], into_faces) = (hull.edges[which].map(|i| hull.corners[i as usize]), hull.into_faces[which]);
        let (ridge, between) = (b - a, a - ends[0]);
        let across = along.cross(ridge);
        let square = across.length_squared();
        if square <= PARALLEL * PARALLEL * along.length_squared() * ridge.length_squared() {
            continue;
        }
        let (s, t) = (between.cross(ridge).dot(across) / square, between.cross(along).dot(across) / square);
        if s <= 0.0 || s >= 1.0 || !(0.0..=1.0).contains(&t) {
            continue;
        }
        let normal = across / square.sqrt();
        let rises = into_faces.map(|way| normal.dot(way));
        let normal = match (rises.iter().all(|rise| *rise <= CONE), rises.iter().all(|rise| *rise >= -CONE)) {
            (true, _) => normal,
            (_, true) => -normal,
            _ => continue,
        };
        let depth = margin + normal.dot(between);
        if depth > 0.0 && depth < most_depth {
            most_depth = depth;
            least =
                Some((Pair { weights: [1.0 - s, s], core: a + ridge * t, normal, distance: margin - depth }, depth));
        }
    }
    least
}
