//! Nearest points of a vertex and a triangle, and of two edges (Ericson 2004, *Real-Time Collision Detection*, 5.1).

use glam::Vec3A;

/// Which features of cloth meet in a pair, and the order of its four particles.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The vertex, then the three corners of the triangle.
    VertexTriangle,
    /// The ends of one edge, then those of the other.
    EdgeEdge,
}

impl Kind {
    /// How many of the four particles belong to the first feature.
    pub fn split(self) -> usize {
        match self {
            Self::VertexTriangle => 1,
            Self::EdgeEdge => 2,
        }
    }
}

/// The nearest points of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// The weights of the four particles: those of the first feature sum to 1, those of the second to −1.
    pub weights: [f32; 4],
    /// From the point of the second feature to that of the first, m.
    pub between: Vec3A,
}

/// The nearest points of a pair whose particles are at `points`.
#[inline(always)]
pub(super) fn nearest(kind: Kind, points: &[Vec3A; 4]) -> Nearest {
    match kind {
        Kind::VertexTriangle => vertex_triangle(points),
        Kind::EdgeEdge => edge_edge(points),
    }
}

#[inline(always)]
fn vertex_triangle([p, a, b, c]: &[Vec3A; 4]) -> Nearest {
    let (ab, ac, ap) = (*b - *a, *c - *a, *p - *a);
    let found = |u: f32, v: f32| Nearest { weights: [1.0, u + v - 1.0, -u, -v], between: ap - ab * u - ac * v };
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return found(0.0, 0.0);
    }
    let bp = *p - *b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return found(1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return found(ratio(d1, d1 - d3), 0.0);
    }
    let cp = *p - *c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return found(0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return found(0.0, ratio(d2, d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return found(1.0 - w, w);
    }
    let whole = va + vb + vc;
    found(ratio(vb, whole), ratio(vc, whole))
}

/// `part / whole` of what has no extent is 0.
#[inline(always)]
fn ratio(part: f32, whole: f32) -> f32 {
    if whole.abs() > f32::MIN_POSITIVE { part / whole } else { 0.0 }
}

#[inline(always)]
fn edge_edge([a, b, c, d]: &[Vec3A; 4]) -> Nearest {
    let (first, second, apart) = (*b - *a, *d - *c, *a - *c);
    let (aa, ee, f) = (first.length_squared(), second.length_squared(), second.dot(apart));
    let (cross, along) = (first.dot(second), first.dot(apart));
    let parallel = aa * ee - cross * cross;
    let clamp = |x: f32| x.clamp(0.0, 1.0);
    // Nearly parallel edges are equally near along their common part: any of its points will do.
    let mut s = if parallel > 1e-7 * aa * ee { clamp((cross * f - along * ee) / parallel) } else { 0.5 };
    let mut t = ratio(cross * s + f, ee);
    if !(0.0..=1.0).contains(&t) {
        t = clamp(t);
        s = clamp(ratio(cross * t - along, aa));
    } else if parallel <= 1e-7 * aa * ee {
        s = clamp(ratio(cross * t - along, aa));
    }
    Nearest { weights: [1.0 - s, s, t - 1.0, -t], between: apart + first * s - second * t }
}

/// How far the two features stay apart along `normal`, m: the lowest point of the first above the highest of the second;
/// negative where a plane across `normal` does not part them.
#[inline(always)]
pub(super) fn gap_along(kind: Kind, points: &[Vec3A; 4], normal: Vec3A) -> f32 {
    // Relative to one of the points, as these may be far from the origin.
    let at = |i: usize| normal.dot(points[i] - points[3]);
    match kind {
        Kind::VertexTriangle => at(0) - at(1).max(at(2)).max(0.0),
        Kind::EdgeEdge => at(0).min(at(1)) - at(2).max(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn point() -> impl Strategy<Value = Vec3A> {
        [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0].prop_map(Vec3A::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn no_two_points_of_a_pair_are_nearer_than_those_found(points in [point(), point(), point(), point()]) {
            for kind in [Kind::VertexTriangle, Kind::EdgeEdge] {
                let found = nearest(kind, &points);
                let sum: Vec3A = points.iter().zip(found.weights).map(|(p, w)| *p * w).sum();
                prop_assert!(sum.distance(found.between) < 1e-5);
                let steps = || (0..=20).map(|i| i as f32 / 20.0);
                let nearest_of_many = steps().flat_map(|s| steps().map(move |t| (s, t))).filter_map(|(s, t)| match kind {
                    Kind::VertexTriangle if s + t > 1.0 => None,
                    Kind::VertexTriangle => {
                        let [p, a, b, c] = points;
                        Some(p.distance(a + (b - a) * s + (c - a) * t))
                    }
                    Kind::EdgeEdge => {
                        let [a, b, c, d] = points;
                        Some(a.lerp(b, s).distance(c.lerp(d, t)))
                    }
                });
                let sampled = nearest_of_many.fold(f32::INFINITY, f32::min);
                prop_assert!(found.between.length() < sampled + 1e-5, "{kind:?}");
            }
        }
    }
}
