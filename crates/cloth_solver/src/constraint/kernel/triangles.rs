//! Stretch along warp and weft and shear of triangles that belong to no grid.
//!
//! The deformation gradient maps the triangle's plane at rest (weft, warp) to space: its columns `f_u`, `f_v` are what
//! unit steps along weft and warp have become. Constraints `|f_u| − 1`, `|f_v| − 1`, `f_u · f_v` (Baraff & Witkin 1998)
//! with compliances `1/(Y A)`, `1/(G A)`: the fabric's directions hold whatever way the mesh is cut.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::batch::{Batches, gather, gather3, scatter3};
use crate::constraint::kernel::lines::TURNED;
use crate::constraint::tension::Tensions;
use crate::constraint::wear::Wear;
use crate::lanes::{LANES, Vec3x8, select, splat};
use crate::topology::Along;
use crate::{Fabric, Particles, Topology};

/// Along which directions triangles are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    /// Where the substep ends.
    All,
    /// Where the substep begins, which turns nothing as a whole.
    AllFromStart,
}

/// The triangles of a mesh, eight at a time.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    batches: Batches<3>,
    /// Inverse of the rest edges, `[entry][lane]`: `f_u = e1·m0 + e2·m1`, `f_v = e1·m2 + e2·m3`.
    inverse_rest: Vec<[[f32; LANES]; 4]>,
    /// 1/area, 1/m².
    inverse_area: Vec<[f32; LANES]>,
    /// Factor on the compliance and on the rest length of each, as worn.
    worn: Option<[Vec<[f32; LANES]>; 2]>,
    /// Multipliers of weft and warp of the last solve, if anybody asked for them.
    lambda: Option<Vec<[[f32; LANES]; 2]>>,
    stretch_weft: f32,
    stretch_warp: f32,
    shear: f32,
}

impl Triangles {
    /// Of those triangles of `topology` that `which` names.
    pub fn new(topology: &Topology, which: &[u32], fabric: &Fabric) -> Self {
        let corners: Vec<[u32; 3]> = which.iter().map(|triangle| topology.triangles[*triangle as usize]).collect();
        let rest = |i: usize| topology.triangle_rest[which[i] as usize];
        let batches = Batches::new(&corners, topology.slots(), topology.padding());
        let entry = |pick: fn(glam::Mat2) -> f32| batches.lanes(0.0, |i| pick(rest(i).inverse()));
        let (m0, m1) = (entry(|m| m.x_axis.x), entry(|m| m.x_axis.y));
        let (m2, m3) = (entry(|m| m.y_axis.x), entry(|m| m.y_axis.y));
        let inverse_rest = (0..batches.groups.len()).map(|g| [m0[g], m1[g], m2[g], m3[g]]).collect();
        let inverse_area = batches.lanes(1.0, |i| 2.0 / rest(i).determinant());
        Self {
            batches,
            inverse_rest,
            inverse_area,
            worn: None,
            lambda: None,
            stretch_weft: fabric.stretch_weft,
            stretch_warp: fabric.stretch_warp,
            shear: fabric.shear,
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        let each = usize::from(self.shear > 0.0) + 2;
        self.batches.source.iter().flatten().flatten().count() * each
    }

    /// Takes over what became of the particles; `None` makes all as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        let Some(wear) = wear else {
            self.worn = None;
            return;
        };
        let (batches, one) = (&self.batches, vec![[1.0; LANES]; self.batches.groups.len()]);
        let [compliance, rest] = self.worn.get_or_insert_with(|| [one.clone(), one]);
        for (g, group) in batches.groups.iter().enumerate() {
            for lane in (0..LANES).filter(|lane| batches.source[g][*lane].is_some()) {
                let corners = [group[0][lane], group[1][lane], group[2][lane]];
                (compliance[g][lane], rest[g][lane]) = wear.of_triangle(corners);
            }
        }
    }

    /// Keeps the multipliers from now on.
    pub fn watch(&mut self) {
        self.lambda.get_or_insert_with(|| vec![[[0.0; LANES]; 2]; self.batches.groups.len()]);
    }

    /// Whether it keeps the multipliers.
    pub fn is_watched(&self) -> bool {
        self.lambda.is_some()
    }

    /// Adds the tensions in the last substep, of that [`crate::Substep::square`], weighed by area. From the second call on: the first
    /// lets the multipliers be kept.
    pub fn add_tensions(&mut self, square: f32, to: &mut Tensions) {
        self.watch();
        for (g, group) in self.batches.groups.iter().enumerate() {
            for lane in (0..LANES).filter(|lane| self.batches.source[g][*lane].is_some()) {
                let area = 1.0 / self.inverse_area[g][lane];
                for (along, lambda) in
                    self.lambda.iter().flat_map(|lambda| [Along::Weft, Along::Warp].into_iter().zip(lambda[g]))
                {
                    for corner in group {
                        // Tension times area is −λ/h²: the area cancels out.
                        to.add(along, corner[lane], -lambda[lane] / square, area);
                    }
                }
            }
        }
    }

    /// Solves every triangle once, in a substep of that [`crate::Substep::square`].
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, square: f32, of: Of) {
        let weft = splat(simd, 1.0 / (self.stretch_weft * square));
        let warp = splat(simd, 1.0 / (self.stretch_warp * square));
        let shear = splat(simd, 1.0 / (self.shear * square));
        for (g, group) in self.batches.groups.iter().enumerate() {
            // No `map` over arrays here: its closure would be compiled without the instruction set this is dispatched to.
            let [a, b, c] = group;
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let w = [gather(simd, inverse_mass, a), gather(simd, inverse_mass, b), gather(simd, inverse_mass, c)];
            // Relative to the first corner, so that nothing is lost in large coordinates.
            let origin = gather3(simd, position, a);
            let (to_b, to_c) = (gather3(simd, position, b) - origin, gather3(simd, position, c) - origin);
            let moves = [gather3(simd, moved, a), gather3(simd, moved, b), gather3(simd, moved, c)];
            let mut x = [moves[0], to_b + moves[1], to_c + moves[2]];
            let from_start = of == Of::AllFromStart;
            let start = [Vec3x8::splat(simd, glam::Vec3::ZERO), to_b, to_c];
            // Pushes are summed up apart: taken from the places, they would be rounded as these are, and momentum with them.
            let mut pushed = [Vec3x8::splat(simd, glam::Vec3::ZERO); 3];
            let [m0, m1, m2, m3] = self.inverse_rest[g];
            let m = [
                f32x8::simd_from(simd, m0),
                f32x8::simd_from(simd, m1),
                f32x8::simd_from(simd, m2),
                f32x8::simd_from(simd, m3),
            ];
            let mut inverse_area = f32x8::simd_from(simd, self.inverse_area[g]);
            let mut rest = splat(simd, 1.0);
            if let Some([compliance, rest_factor]) = &self.worn {
                inverse_area *= f32x8::simd_from(simd, compliance[g]);
                rest = f32x8::simd_from(simd, rest_factor[g]);
            }
            let begun = from_start.then_some(&start);
            let pull_weft = length(simd, &mut x, begun, &mut pushed, &w, [m[0], m[1]], weft * inverse_area, rest);
            let pull_warp = length(simd, &mut x, begun, &mut pushed, &w, [m[2], m[3]], warp * inverse_area, rest);
            if let Some(lambda) = &mut self.lambda {
                lambda[g] = [pull_weft.into(), pull_warp.into()];
            }
            if self.shear > 0.0 {
                let at = if from_start { &start } else { &x };
                angle(simd, &x, at, &mut pushed, &w, m, shear * inverse_area);
            }
            scatter3(moves[0] + pushed[0], moved, a);
            scatter3(moves[1] + pushed[1], moved, b);
            scatter3(moves[2] + pushed[2], moved, c);
        }
    }
}

/// `|e1·m0 + e2·m1| = rest`; its multiplier.
#[inline(always)]
fn length<S: Simd>(
    simd: S,
    x: &mut [Vec3x8<S>; 3],
    start: Option<&[Vec3x8<S>; 3]>,
    pushed: &mut [Vec3x8<S>; 3],
    w: &[f32x8<S>; 3],
    m: [f32x8<S>; 2],
    compliance: f32x8<S>,
    rest: f32x8<S>,
) -> f32x8<S> {
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let f = (x[1] - x[0]) * m[0] + (x[2] - x[0]) * m[1];
    let size = f.length();
    let mut direction = f * (splat(simd, 1.0) / size.max(tiny));
    if let Some(start) = start {
        let f = (start[1] - start[0]) * m[0] + (start[2] - start[0]) * m[1];
        let size = f.length();
        let had = f * (splat(simd, 1.0) / size.max(tiny));
        let is_calm = size.simd_gt(splat(simd, 1e-6)) & had.dot(direction).simd_gt(splat(simd, TURNED));
        direction = select(is_calm, had, direction);
    }
    let m_0 = -(m[0] + m[1]);
    let weight = w[0] * m_0 * m_0 + w[1] * m[0] * m[0] + w[2] * m[1] * m[1] + compliance;
    let lambda = (rest - size) / weight.max(tiny);
    let push = direction * lambda;
    let weights = [w[0] * m_0, w[1] * m[0], w[2] * m[1]];
    for i in 0..3 {
        x[i] = x[i] + push * weights[i];
        pushed[i] = pushed[i] + push * weights[i];
    }
    lambda
}

/// `(e1·m0 + e2·m1) · (e1·m2 + e2·m3) = 0` for corners at `x`, along the gradient where they are `at`.
#[inline(always)]
fn angle<S: Simd>(
    simd: S,
    x: &[Vec3x8<S>; 3],
    at: &[Vec3x8<S>; 3],
    pushed: &mut [Vec3x8<S>; 3],
    w: &[f32x8<S>; 3],
    m: [f32x8<S>; 4],
    compliance: f32x8<S>,
) {
    let (value, _) = shear_gradient(*x, m);
    let (_, gradient) = shear_gradient(*at, m);
    // Without compliance a lane that is left over has no weight at all.
    let lambda = -value / (weight(w, &gradient) + compliance).max(splat(simd, f32::MIN_POSITIVE));
    for i in 0..3 {
        pushed[i] = pushed[i] + gradient[i] * (lambda * w[i]);
    }
}

/// `f_u · f_v` and its gradients.
#[inline(always)]
pub(in crate::constraint) fn shear_gradient<S: Simd>(
    x: [Vec3x8<S>; 3],
    m: [f32x8<S>; 4],
) -> (f32x8<S>, [Vec3x8<S>; 3]) {
    let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
    let (u, v) = (e1 * m[0] + e2 * m[1], e1 * m[2] + e2 * m[3]);
    let g1 = v * m[0] + u * m[2];
    let g2 = v * m[1] + u * m[3];
    let g0 = Vec3x8 { x: -(g1.x + g2.x), y: -(g1.y + g2.y), z: -(g1.z + g2.z) };
    (u.dot(v), [g0, g1, g2])
}

/// Σ w |∇C|².
#[inline(always)]
fn weight<S: Simd>(w: &[f32x8<S>; 3], gradient: &[Vec3x8<S>; 3]) -> f32x8<S> {
    w[0] * gradient[0].dot(gradient[0]) + w[1] * gradient[1].dot(gradient[1]) + w[2] * gradient[2].dot(gradient[2])
}
