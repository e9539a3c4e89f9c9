//! Bending over the inner edges of a mesh that is no grid: the dihedral angle of each hinge.
//!
//! Energy `½ (D b/s) (θ − θ₀)²` with b the hinge's length and s = (A₁ + A₂)/b the spacing of the two triangles (Grinspun
//! et al. 2003); gradients after Bridson, Marino, Fedkiw 2003.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::batch::{Batches, gather, gather3, scatter3};
use crate::lanes::{LANES, Vec3x8, splat};
use crate::{Fabric, Particles, Substep, Topology};

/// The hinges of a mesh, eight at a time.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct Hinges {
    batches: Batches<4>,
    rest_angle: Vec<[f32; LANES]>,
    /// s/(D b), rad²/J.
    compliance: Vec<[f32; LANES]>,
}

/// Where no constraint is: so compliant that it never acts.
const IDLE_COMPLIANCE: f32 = 1e30;

impl Hinges {
    /// Of those hinges of `topology` that `which` names.
    pub fn new(topology: &Topology, which: &[u32], fabric: &Fabric) -> Self {
        let corners: Vec<[u32; 4]> = which.iter().map(|hinge| topology.hinges[*hinge as usize]).collect();
        let batches = Batches::new(&corners, topology.slots(), topology.padding());
        let stiffness = |i: usize| topology.stiffness_of(which[i] as usize, fabric);
        let compliance = batches.lanes(IDLE_COMPLIANCE, |i| 1.0 / stiffness(i).max(1.0 / IDLE_COMPLIANCE));
        let rest_angle = batches.lanes(0.0, |i| topology.hinge_rest[which[i] as usize]);
        Self { batches, rest_angle, compliance }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.batches.source.iter().flatten().flatten().count()
    }

    /// Solves every hinge once as a constraint, in a substep whose length times that of its kick is `square`.
    #[inline(always)]
    pub fn solve<S: Simd>(&self, simd: S, particles: &mut Particles, square: f32) {
        let per_step = splat(simd, 1.0 / square);
        for (g, group) in self.batches.groups.iter().enumerate() {
            let Eight { moves, x, w } = Eight::gather(simd, particles, group);
            // No `map` over arrays here: its closure would be compiled without the instruction set this is dispatched to.
            let x = [moves[0], x[1] + moves[1], x[2] + moves[2], x[3] + moves[3]];
            let (angle, gradient) = angle_and_gradient(simd, x);
            let turn = wrap(simd, angle - f32x8::simd_from(simd, self.rest_angle[g]));
            let compliance = f32x8::simd_from(simd, self.compliance[g]) * per_step;
            let lambda = -turn / (weight(&w, &gradient) + compliance);
            for i in 0..4 {
                scatter3(moves[i] + gradient[i] * (lambda * w[i]), &mut particles.moved, &group[i]);
            }
        }
    }

    /// Moves every particle by the moments of its hinges where the substep begins, no stiffer than the longest one resolves.
    #[inline(always)]
    pub fn push<S: Simd>(&self, simd: S, particles: &mut Particles, sub: &Substep) {
        let (per_step, share) = (splat(simd, 1.0 / (sub.longest * sub.longest)), splat(simd, sub.share()));
        for (g, group) in self.batches.groups.iter().enumerate() {
            let Eight { moves, x, w } = Eight::gather(simd, particles, group);
            let (angle, gradient) = angle_and_gradient(simd, x);
            let turn = wrap(simd, angle - f32x8::simd_from(simd, self.rest_angle[g]));
            let compliance = f32x8::simd_from(simd, self.compliance[g]) * per_step;
            let lambda = -turn * share / (weight(&w, &gradient) * splat(simd, RESOLVED) + compliance);
            for i in 0..4 {
                scatter3(moves[i] + gradient[i] * (lambda * w[i]), &mut particles.moved, &group[i]);
            }
        }
    }
}

/// How much of Σ w |∇C|² a moment alone may be stiff by, for those of all neighbours to stay stable together.
const RESOLVED: f32 = 6.0;

/// The particles of eight hinges: where they are from the first on, how they move, their inverse masses.
struct Eight<S: Simd> {
    moves: [Vec3x8<S>; 4],
    x: [Vec3x8<S>; 4],
    w: [f32x8<S>; 4],
}

impl<S: Simd> Eight<S> {
    #[inline(always)]
    fn gather(simd: S, particles: &Particles, [a, b, c, d]: &[[u32; LANES]; 4]) -> Self {
        let Particles { position, moved, inverse_mass, .. } = particles;
        let origin = gather3(simd, position, a);
        Self {
            moves: [gather3(simd, moved, a), gather3(simd, moved, b), gather3(simd, moved, c), gather3(simd, moved, d)],
            x: [
                Vec3x8::splat(simd, glam::Vec3::ZERO),
                gather3(simd, position, b) - origin,
                gather3(simd, position, c) - origin,
                gather3(simd, position, d) - origin,
            ],
            w: [
                gather(simd, inverse_mass, a),
                gather(simd, inverse_mass, b),
                gather(simd, inverse_mass, c),
                gather(simd, inverse_mass, d),
            ],
        }
    }
}

/// Σ w |∇C|².
#[inline(always)]
fn weight<S: Simd>(w: &[f32x8<S>; 4], gradient: &[Vec3x8<S>; 4]) -> f32x8<S> {
    let [a, b, c, d] = *gradient;
    w[0] * a.dot(a) + w[1] * b.dot(b) + w[2] * c.dot(c) + w[3] * d.dot(d)
}

/// The dihedral angle, positive where the front faces turn away from each other, and its gradients. A hinge with a
/// triangle of no area has none there.
#[inline(always)]
fn angle_and_gradient<S: Simd>(simd: S, [a, b, c, d]: [Vec3x8<S>; 4]) -> (f32x8<S>, [Vec3x8<S>; 4]) {
    let (one, tiny) = (splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
    let edge = b - a;
    let length = edge.length();
    let (n1, n2) = (edge.cross(c - a), (d - a).cross(edge));
    let (q1, q2) = (n1 * (one / n1.dot(n1).max(tiny)), n2 * (one / n2.dot(n2).max(tiny)));
    let along = one / length.max(tiny);
    // sin θ and cos θ, both times |n1| |n2|.
    let angle = atan2(simd, n1.cross(n2).dot(edge) * along, n1.dot(n2));
    let gradient = [
        q1 * ((b - c).dot(edge) * along) + q2 * ((b - d).dot(edge) * along),
        q1 * ((c - a).dot(edge) * along) + q2 * ((d - a).dot(edge) * along),
        q1 * -length,
        q2 * -length,
    ];
    (angle, gradient)
}

/// An angle difference brought back to −π..π: the short way round.
#[inline(always)]
fn wrap<S: Simd>(simd: S, angle: f32x8<S>) -> f32x8<S> {
    let turn = splat(simd, core::f32::consts::TAU);
    angle - turn * (angle * splat(simd, 1.0 / core::f32::consts::TAU)).round_ties_even()
}

/// `atan2(y, x)` in every lane, 0 at the origin, absolute error below 2e-6 rad. A polynomial rather than the platform's
/// `atan2f`, so that every machine computes the same bits.
#[inline(always)]
fn atan2<S: Simd>(simd: S, y: f32x8<S>, x: f32x8<S>) -> f32x8<S> {
    let (ax, ay) = (x.abs(), y.abs());
    let t = ax.min(ay) / ax.max(ay).max(splat(simd, f32::MIN_POSITIVE));
    let s = t * t;
    // Minimax fit of atan(t)/t on 0..1, odd terms up to t¹⁵ (Abramowitz & Stegun 4.4.49).
    let mut p = splat(simd, 0.002_866_225_7);
    for c in [-0.016_165_737, 0.042_909_614, -0.075_289_64, 0.106_562_64, -0.142_089, 0.199_935_51, -0.333_331_45] {
        p = p * s + splat(simd, c);
    }
    let angle = t + t * s * p;
    let angle = ay.simd_gt(ax).select(splat(simd, core::f32::consts::FRAC_PI_2) - angle, angle);
    let angle = x.simd_lt(splat(simd, 0.0)).select(splat(simd, core::f32::consts::PI) - angle, angle);
    y.simd_lt(splat(simd, 0.0)).select(-angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::dispatch;

    #[test]
    fn the_polynomial_agrees_with_atan2_all_round() {
        for i in 0..3600 {
            let angle = (f32::from(i as i16) / 10.0 - 180.0).to_radians();
            let (y, x) = (angle.sin() * 3.0, angle.cos() * 3.0);
            let found = dispatch!(*crate::lanes::LEVEL, simd => atan2(simd, splat(simd, y), splat(simd, x))[0]);
            assert!((found - y.atan2(x)).abs() < 2e-6, "{found} for {angle}");
        }
    }
}
