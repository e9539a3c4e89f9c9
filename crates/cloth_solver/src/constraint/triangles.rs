//! Stretch along warp and weft and shear of triangles that belong to no grid.
//!
//! The deformation gradient maps the triangle's plane at rest (weft, warp) to space: its columns `f_u`, `f_v` are what
//! unit steps along weft and warp have become. Constraints `|f_u| − 1`, `|f_v| − 1`, `f_u · f_v` (Baraff & Witkin 1998)
//! with compliances `1/(Y A)`, `1/(G A)`: the fabric's directions hold whatever way the mesh is cut.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::batch::{Batches, gather, gather3, scatter3};
use crate::lanes::{LANES, Vec3x8, splat};
use crate::{Fabric, Particles, Topology};

/// The triangles of a mesh, eight at a time.
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    batches: Batches<3>,
    /// Inverse of the rest edges, `[entry][lane]`: `f_u = e1·m0 + e2·m1`, `f_v = e1·m2 + e2·m3`.
    inverse_rest: Vec<[[f32; LANES]; 4]>,
    /// 1/area, 1/m².
    inverse_area: Vec<[f32; LANES]>,
    stretch_weft: f32,
    stretch_warp: f32,
    shear: f32,
}

impl Triangles {
    pub fn new(topology: &Topology, fabric: &Fabric, padding: u32) -> Self {
        let batches = Batches::new(&topology.triangles, topology.slots(), padding);
        let entry = |pick: fn(glam::Mat2) -> f32| batches.lanes(0.0, |i| pick(topology.triangle_rest[i].inverse()));
        let (m0, m1) = (entry(|m| m.x_axis.x), entry(|m| m.x_axis.y));
        let (m2, m3) = (entry(|m| m.y_axis.x), entry(|m| m.y_axis.y));
        let inverse_rest = (0..batches.groups.len()).map(|g| [m0[g], m1[g], m2[g], m3[g]]).collect();
        let inverse_area = batches.lanes(1.0, |i| 2.0 / topology.triangle_rest[i].determinant());
        Self {
            batches,
            inverse_rest,
            inverse_area,
            stretch_weft: fabric.stretch_weft,
            stretch_warp: fabric.stretch_warp,
            shear: fabric.shear,
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.batches.source.iter().flatten().flatten().count() * if self.shear > 0.0 { 3 } else { 2 }
    }

    /// Solves every triangle once.
    #[inline(always)]
    pub fn solve<S: Simd>(&self, simd: S, particles: &mut Particles, h: f32) {
        let weft = splat(simd, 1.0 / (self.stretch_weft * h * h));
        let warp = splat(simd, 1.0 / (self.stretch_warp * h * h));
        let shear = splat(simd, 1.0 / (self.shear * h * h));
        for (g, group) in self.batches.groups.iter().enumerate() {
            // No `map` over arrays here: its closure would be compiled without the instruction set this is dispatched to.
            let [a, b, c] = group;
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let w = [gather(simd, inverse_mass, a), gather(simd, inverse_mass, b), gather(simd, inverse_mass, c)];
            // Relative to the first corner, so that nothing is lost in large coordinates.
            let origin = gather3(simd, position, a);
            let (to_b, to_c) = (gather3(simd, position, b) - origin, gather3(simd, position, c) - origin);
            let mut x = [gather3(simd, moved, a), to_b + gather3(simd, moved, b), to_c + gather3(simd, moved, c)];
            let [m0, m1, m2, m3] = self.inverse_rest[g];
            let m = [
                f32x8::simd_from(simd, m0),
                f32x8::simd_from(simd, m1),
                f32x8::simd_from(simd, m2),
                f32x8::simd_from(simd, m3),
            ];
            let inverse_area = f32x8::simd_from(simd, self.inverse_area[g]);
            length(simd, &mut x, &w, [m[0], m[1]], weft * inverse_area);
            length(simd, &mut x, &w, [m[2], m[3]], warp * inverse_area);
            if self.shear > 0.0 {
                angle(&mut x, &w, m, shear * inverse_area);
            }
            scatter3(x[0], moved, a);
            scatter3(x[1] - to_b, moved, b);
            scatter3(x[2] - to_c, moved, c);
        }
    }
}

/// `|e1·m0 + e2·m1| = 1`.
#[inline(always)]
fn length<S: Simd>(simd: S, x: &mut [Vec3x8<S>; 3], w: &[f32x8<S>; 3], m: [f32x8<S>; 2], compliance: f32x8<S>) {
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let f = (x[1] - x[0]) * m[0] + (x[2] - x[0]) * m[1];
    let size = f.length();
    let direction = f * (splat(simd, 1.0) / size.max(tiny));
    let m_0 = -(m[0] + m[1]);
    let weight = w[0] * m_0 * m_0 + w[1] * m[0] * m[0] + w[2] * m[1] * m[1] + compliance;
    let lambda = (splat(simd, 1.0) - size) / weight.max(tiny);
    let push = direction * lambda;
    x[0] = x[0] + push * (w[0] * m_0);
    x[1] = x[1] + push * (w[1] * m[0]);
    x[2] = x[2] + push * (w[2] * m[1]);
}

/// `(e1·m0 + e2·m1) · (e1·m2 + e2·m3) = 0`.
#[inline(always)]
fn angle<S: Simd>(x: &mut [Vec3x8<S>; 3], w: &[f32x8<S>; 3], m: [f32x8<S>; 4], compliance: f32x8<S>) {
    let (value, gradient) = shear_gradient(*x, m);
    let lambda = -value / (weight(w, &gradient) + compliance);
    for i in 0..3 {
        x[i] = x[i] + gradient[i] * (lambda * w[i]);
    }
}

/// `f_u · f_v` and its gradients.
#[inline(always)]
fn shear_gradient<S: Simd>(x: [Vec3x8<S>; 3], m: [f32x8<S>; 4]) -> (f32x8<S>, [Vec3x8<S>; 3]) {
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
