//! The curve over an edge and the patch over a triangle, from positions and normals. Values in, values out.

use bevy::prelude::*;

/// Where a curve leaves its chord at a larger angle than this, the cosine of 60°, it is no more an arc of a circle but less round.
const ROUNDEST: f32 = 0.5;

/// A cubic Bézier curve over an edge, as what it has beyond the straight edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Curve {
    /// How far the control point near each end is from the straight edge, m.
    offsets: [Vec3; 2],
    /// What the normal half-way loses against the mean of the ends, twice, to be at right angles to the edge.
    tilt: Vec3,
}

impl Curve {
    /// Over an edge with a triangle at either side: at its ends it is at right angles to the normals.
    pub fn inside([from, to]: [Vec3; 2], normals: [Vec3; 2]) -> Self {
        let edge = to - from;
        let [first, second] = [edge.dot(normals[0]), -edge.dot(normals[1])];
        let part = limits(first * second, [first * first, second * second]);
        let off = |along: Vec3, normal: Vec3, dip: f32| arc(along, along - normal * dip);
        let offsets = [off(edge, normals[0], first) * part[0], off(-edge, normals[1], second) * part[1]];
        Self { offsets, tilt: tilt(edge, normals) }
    }

    /// Over an edge of the boundary: at its ends it has the directions `tangents`. An end without one bends like the other.
    pub fn rim([from, to]: [Vec3; 2], normals: [Vec3; 2], tangents: [Option<Vec3>; 2]) -> Self {
        let edge = to - from;
        let first = tangents[0].map(|tangent| arc(edge, tangent * edge.dot(tangent)));
        let second = tangents[1].map(|tangent| arc(-edge, tangent * -edge.dot(tangent)));
        let offsets = match (first, second) {
            (Some(first), Some(second)) => {
                let bends = [first, second].map(|offset| aside(offset, edge));
                let part = limits(bends[0].dot(bends[1]), bends.map(|bend| bend.length_squared()));
                [first * part[0], second * part[1]]
            }
            (Some(first), None) => [first, mirrored(first, edge)],
            (None, Some(second)) => [mirrored(second, edge), second],
            (None, None) => [Vec3::ZERO; 2],
        };
        Self { offsets, tilt: tilt(edge, normals) }
    }

    /// Takes away what goes into the solids that the ends lie on. `supports` are their unit normals, or zero.
    pub fn rest_on(&mut self, supports: [Vec3; 2]) {
        if supports == [Vec3::ZERO; 2] {
            return;
        }
        for support in supports {
            for offset in &mut self.offsets {
                *offset -= support * offset.dot(support).min(0.0);
            }
        }
    }

    /// The curve from its first end to its last, or if `turned` the other way.
    pub fn seen(&self, turned: bool) -> Self {
        let [first, second] = self.offsets;
        if turned { Self { offsets: [second, first], tilt: self.tilt } } else { *self }
    }

    /// The point at `t` between the `ends`, 0 to 1.
    pub fn position(&self, [from, to]: [Vec3; 2], t: f32) -> Vec3 {
        let s = 1.0 - t;
        from * s + to * t + (self.offsets[0] * s + self.offsets[1] * t) * (3.0 * s * t)
    }

    /// The unit normal at `t` between the `ends`, 0 to 1.
    pub fn normal(&self, [from, to]: [Vec3; 2], t: f32) -> Vec3 {
        let s = 1.0 - t;
        (from * s + to * t - self.tilt * (s * t)).normalize_or(from)
    }
}

/// The point of the patch over a triangle with the barycentric coordinates `weights`. `curves` go from each corner to the next.
pub(super) fn patch_position(corners: [Vec3; 3], curves: &[Curve; 3], weights: Vec3) -> Vec3 {
    let weights = weights.to_array();
    let [u, v, w] = weights;
    let mut place = corners[0] * u + corners[1] * v + corners[2] * w;
    // The control point in the middle: half as far again from the corners' mean as the mean of the six on the edges.
    let middle = 1.5 * u * v * w;
    for (side, Curve { offsets: [near, far], .. }) in curves.iter().enumerate() {
        let (s, t) = (weights[side], weights[(side + 1) % 3]);
        place += *near * (3.0 * s * s * t + middle) + *far * (3.0 * s * t * t + middle);
    }
    place
}

/// The unit normal there.
pub(super) fn patch_normal(normals: [Vec3; 3], curves: &[Curve; 3], weights: Vec3) -> Vec3 {
    let Vec3 { x: u, y: v, z: w } = weights;
    let straight = normals[0] * u + normals[1] * v + normals[2] * w;
    let [first, second, third] = curves.each_ref().map(|curve| curve.tilt);
    (straight - first * (u * v) - second * (v * w) - third * (w * u)).normalize_or(normals[0])
}

/// The direction of a curve through three points in the one in the middle: that of the parabola in chord length.
pub(super) fn tangent([before, at, after]: [Vec3; 3]) -> Vec3 {
    let (first, second) = (at - before, after - at);
    let (near, far) = (first.length_squared(), second.length_squared());
    (first * far + second * near).normalize_or_zero()
}

/// How far the control point of an arc over `edge`, which begins in the direction `begin`, is from the first third of the edge.
/// `begin` is `edge` without what is at right angles to that direction.
fn arc(edge: Vec3, begin: Vec3) -> Vec3 {
    let whole = edge.length_squared();
    if whole <= 0.0 {
        return Vec3::ZERO;
    }
    let cosine = (begin.length_squared() / whole).sqrt().clamp(ROUNDEST, 1.0);
    (begin * (2.0 / (cosine * (1.0 + cosine))) - edge) / 3.0
}

/// Which part remains of the bends at both ends, so that neither is more than twice the other and both go to one side: then the
/// curve is convex. From the product of the bends, and the square of each.
fn limits(product: f32, squares: [f32; 2]) -> [f32; 2] {
    squares.map(|square| if 2.0 * product >= square { 1.0 } else { (2.0 * product / square).max(0.0) })
}

/// What `direction` at one end of an edge is at the other end, if both ends look the same.
pub(super) fn mirrored(direction: Vec3, edge: Vec3) -> Vec3 {
    2.0 * aside(direction, edge) - direction
}

/// The part of `offset` at right angles to `edge`.
fn aside(offset: Vec3, edge: Vec3) -> Vec3 {
    offset - edge * (offset.dot(edge) / edge.length_squared().max(f32::MIN_POSITIVE))
}

fn tilt(edge: Vec3, normals: [Vec3; 2]) -> Vec3 {
    edge * (2.0 * edge.dot(normals[0] + normals[1]) / edge.length_squared().max(f32::MIN_POSITIVE))
}
