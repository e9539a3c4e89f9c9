//! The distance from an ellipsoid.

use glam::{DVec3, Vec3};

/// Steps of Newton's method at most; each leaves the distance to the root no larger, and a pole a third behind.
const MOST_STEPS: u32 = 100;

/// A coordinate of a point is taken for at least that part of the semi-axis: on a plane of symmetry the equation has no pole to start
/// from. Far below what an f32 resolves.
const OFF_SYMMETRY: f64 = 1e-12;

/// Signed distance from an ellipsoid with semi-axes `half` to `p` and the outward normal at the nearest point of the surface, inside as
/// well as outside.
///
/// The nearest point is `x_i = e_i² p_i / (t + e_i²)` with the largest root t of `Σ (e_i p_i / (t + e_i²))² = 1` (D. Eberly, *Distance
/// from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*, 2013). To the right of its last pole the left side falls and is
/// convex, so that Newton's method comes to the root from the left and never passes it.
pub(super) fn distance_and_normal(half: Vec3, p: Vec3) -> (f32, Vec3) {
    let e = half.as_dvec3();
    let y = p.as_dvec3().abs().max(e * OFF_SYMMETRY);
    let (squares, products) = (e * e, e * y);
    // Where one of the terms is 1 the sum is no less.
    let mut t = (products - squares).max_element();
    for _ in 0..MOST_STEPS {
        let terms = products / (DVec3::splat(t) + squares);
        let excess = terms.dot(terms) - 1.0;
        let slope = 2.0 * (terms * terms / (DVec3::splat(t) + squares)).element_sum();
        let next = t + excess / slope;
        // Where rounding is all that is left it stands still or turns back.
        if next <= t || next.is_nan() {
            break;
        }
        t = next;
    }
    let nearest = squares * y / (DVec3::splat(t) + squares);
    let normal = (nearest / squares).normalize_or(DVec3::Y);
    let distance = (y - nearest).length() * 1.0_f64.copysign(t);
    (distance as f32, normal.as_vec3() * Vec3::ONE.copysign(p))
}
