//! Nearest points of triangles and segments.

use glam::Vec3;

/// Weights of the corners of triangle `t` at its point nearest to `p`: the regions of Ericson, *Real-Time Collision Detection*
/// (2005), 5.1.5.
pub(super) fn on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> [f32; 3] {
    let (ab, ac) = (b - a, c - a);
    let from_a = p - a;
    let (d1, d2) = (ab.dot(from_a), ac.dot(from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let from_b = p - b;
    let (d3, d4) = (ab.dot(from_b), ac.dot(from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let from_c = p - c;
    let (d5, d6) = (ab.dot(from_c), ac.dot(from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let (v, w) = (vb / (va + vb + vc), vc / (va + vb + vc));
    [1.0 - v - w, v, w]
}

/// Where the segments `a` and `b` are nearest to each other, 0 at the first end of each and 1 at the second: Ericson, 5.1.9.
/// Neither may be a point; of parallel ones it is one of the nearest pairs.
pub(super) fn of_segments(a: [Vec3; 2], b: [Vec3; 2]) -> [f32; 2] {
    let (along_a, along_b, between) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (aa, bb, ab) = (along_a.length_squared(), along_b.length_squared(), along_a.dot(along_b));
    let (c, f) = (along_a.dot(between), along_b.dot(between));
    let denominator = aa * bb - ab * ab;
    let s = if denominator > 0.0 { ((ab * f - c * bb) / denominator).clamp(0.0, 1.0) } else { 0.0 };
    let t = (ab * s + f) / bb;
    if (0.0..=1.0).contains(&t) {
        return [s, t];
    }
    let t = t.clamp(0.0, 1.0);
    [((ab * t - c) / aa).clamp(0.0, 1.0), t]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn no_other_point_of_a_triangle_is_nearer(
            p in vector(), t in prop::array::uniform3(vector()), other in prop::array::uniform3(0.0_f32..1.0)
        ) {
            let at = |w: [f32; 3]| t[0] * w[0] + t[1] * w[1] + t[2] * w[2];
            let w = on_triangle(p, t);
            prop_assert!(w.iter().all(|w| (-1e-6..=1.0 + 1e-6).contains(w)) && (w.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            let sum = other.iter().sum::<f32>() + 1e-6;
            prop_assert!(at(w).distance(p) <= at(other.map(|w| w / sum)).distance(p) + 1e-4);
        }

        #[test]
        fn no_other_points_of_two_segments_are_nearer(
            a in prop::array::uniform2(vector()), b in prop::array::uniform2(vector()), other in prop::array::uniform2(0.0_f32..1.0)
        ) {
            let distance = |[s, t]: [f32; 2]| a[0].lerp(a[1], s).distance(b[0].lerp(b[1], t));
            let nearest = of_segments(a, b);
            prop_assert!(nearest.iter().all(|t| (0.0..=1.0).contains(t)));
            prop_assert!(distance(nearest) <= distance(other) + 1e-4);
        }
    }
}
