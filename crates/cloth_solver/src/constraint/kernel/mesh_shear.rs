//! Shear of a mesh that is no grid, as a force, stable at any stiffness and any step: what [`crate::constraint::kernel::shear`] is to a grid.
//!
//! Each triangle has the stress λ of its shear `C = f_u · f_v` (see [`crate::constraint::kernel::triangles`]) and pulls with `−λ ∇C`. As plain forces,
//! λ = G A C, fine meshes would explode; swept as constraints they would hardly resist. So the stresses of all are found together,
//! `(1/(G A H²) + θ J W Jᵀ) λ = C`, by conjugate gradients, J all ∇C where the substep begins, H the longest substep: what
//! changes slowly from triangle to triangle keeps its stiffness, and no wave is faster than ω² H² = 1/θ. Whatever λ is, `−λ ∇C`
//! moves and turns no triangle as a whole.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::batch::{Batches, Packed, gather4, pack, scatter4};
use crate::constraint::kernel::shear::STIFFEST;
use crate::constraint::kernel::triangles::shear_gradient;
use crate::constraint::wear::Wear;
use crate::lanes::{LANES, Vec3x8, splat};
use crate::{Fabric, Particles, Substep, Topology};

/// ω² H² of the fastest wave of shear after filtering, H the longest substep.
const FASTEST: f32 = 2.0;

/// How much of the stress may be left to find, as root mean square.
const TOLERANCE: f32 = 0.0003;

/// A shear, rad, next to which what is less is rounding.
const FLAT: f32 = 1e-3;

/// Most iterations in a substep.
const ITERATIONS: usize = 60;

type Lanes = [f32; LANES];

/// What resists shear in a mesh.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct MeshShear {
    batches: Batches<3>,
    eights: Vec<Eight>,
    position: Vec<Packed>,
    /// ω² of the fastest wave where the substep at hand began, 1/s².
    fastest: f32,
    /// What is summed up at particles, with their inverse masses.
    sums: Vec<Packed>,
}

/// Eight triangles.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Eight {
    /// Inverse of the rest edges: see [`crate::constraint::kernel::triangles`].
    inverse_rest: [Lanes; 4],
    /// G A, J; 0 where no triangle is.
    stiffness: Lanes,
    worn: Lanes,
    /// ∇C by corner, each coordinate.
    gradient: [[Lanes; 3]; 3],
    lambda: Lanes,
    residual: Lanes,
    direction: Lanes,
    image: Lanes,
    /// 1/(the diagonal), and 1/(G A H²).
    scale: Lanes,
    compliance: Lanes,
}

impl MeshShear {
    /// `None` if the fabric does not resist shear.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Option<Self> {
        if fabric.shear <= 0.0 {
            return None;
        }
        let batches = Batches::new(&topology.triangles, topology.slots(), topology.padding());
        let nothing = [0.0; LANES];
        let eights = batches.source.iter().map(|source| {
            let mut eight = Eight {
                inverse_rest: [nothing; 4],
                stiffness: nothing,
                worn: [1.0; LANES],
                gradient: [[nothing; 3]; 3],
                lambda: nothing,
                residual: nothing,
                direction: nothing,
                image: nothing,
                scale: nothing,
                compliance: nothing,
            };
            for (lane, triangle) in source.iter().enumerate() {
                let Some(triangle) = triangle else { continue };
                let rest = topology.triangle_rest[*triangle as usize];
                for (entry, value) in eight.inverse_rest.iter_mut().zip(rest.inverse().to_cols_array()) {
                    entry[lane] = value;
                }
                eight.stiffness[lane] = fabric.shear * 0.5 * rest.determinant();
            }
            eight
        });
        let eights = eights.collect();
        let packed = || vec![[0.0; 4]; topology.slots()];
        Some(Self { batches, eights, position: packed(), fastest: 0.0, sums: packed() })
    }

    /// Number of constraints: one to a triangle.
    pub fn count(&self) -> usize {
        self.batches.source.iter().flatten().flatten().count()
    }

    /// ω² H² of the fastest wave for the square H² of a substep, s², where the last one began.
    pub fn fastest(&self, square: f32) -> f32 {
        self.fastest * square
    }

    /// Takes over what became of the particles; `None` makes all as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        for ((eight, group), source) in self.eights.iter_mut().zip(&self.batches.groups).zip(&self.batches.source) {
            for lane in (0..LANES).filter(|lane| source[*lane].is_some()) {
                let corners = [group[0][lane], group[1][lane], group[2][lane]];
                eight.worn[lane] = 1.0 / wear.map_or(1.0, |wear| wear.of_triangle(corners).0);
            }
        }
    }

    /// Moves every particle by the forces of its triangles where the substep begins.
    #[inline(always)]
    pub fn push<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) {
        let square = sub.longest * sub.longest;
        pack(&particles.position, &particles.inverse_mass, &mut self.position);
        self.fastest = self.begin(simd, square, STIFFEST * square / (sub.shortest * sub.shortest)) / square;
        let filter = 1.0 / FASTEST - 1.0 / (self.fastest * square);
        if filter > 0.0 {
            self.iterate(simd, filter);
        } else {
            for eight in &mut self.eights {
                let lambda = f32x8::simd_from(simd, eight.residual) / f32x8::simd_from(simd, eight.compliance);
                eight.lambda = lambda.into();
            }
        }
        self.sum(simd, Of::Lambda);
        let share = sub.share();
        for (i, [x, y, z, w]) in self.sums.iter().enumerate() {
            let by = glam::Vec3::new(*x, *y, *z) * (w * share);
            particles.moved.set(i, particles.moved.get(i) - by);
        }
    }

    /// C and ∇C of every triangle where the particles are, none alone stiffer at rest than ω² H² = `stiffest`; that of the fastest wave is
    /// no more than what is returned.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, simd: S, square: f32, stiffest: f32) -> f32 {
        let tiny = splat(simd, f32::MIN_POSITIVE);
        let mut fastest = splat(simd, 0.0);
        for (eight, [a, b, c]) in self.eights.iter_mut().zip(&self.batches.groups) {
            let ((x_a, w_a), (x_b, w_b), (x_c, w_c)) =
                (gather4(simd, &self.position, a), gather4(simd, &self.position, b), gather4(simd, &self.position, c));
            let m = [
                f32x8::simd_from(simd, eight.inverse_rest[0]),
                f32x8::simd_from(simd, eight.inverse_rest[1]),
                f32x8::simd_from(simd, eight.inverse_rest[2]),
                f32x8::simd_from(simd, eight.inverse_rest[3]),
            ];
            let (value, gradient) = shear_gradient([x_a, x_b, x_c], m);
            let weight = w_a * gradient[0].dot(gradient[0])
                + w_b * gradient[1].dot(gradient[1])
                + w_c * gradient[2].dot(gradient[2]);
            let stiffness = f32x8::simd_from(simd, eight.stiffness) * f32x8::simd_from(simd, eight.worn);
            let at_rest = w_a * ((m[0] + m[1]) * (m[0] + m[1]) + (m[2] + m[3]) * (m[2] + m[3]))
                + w_b * (m[0] * m[0] + m[2] * m[2])
                + w_c * (m[1] * m[1] + m[3] * m[3]);
            let least = at_rest * splat(simd, 1.0 / stiffest);
            let compliance = (splat(simd, 1.0) / (stiffness * splat(simd, square)).max(tiny)).max(least);
            // Of a dozen triangles at a particle at most so many pull the same way.
            fastest = fastest.max(weight / compliance * splat(simd, MEET));
            for i in 0..3 {
                eight.gradient[i] = [gradient[i].x.into(), gradient[i].y.into(), gradient[i].z.into()];
            }
            eight.residual = value.into();
            eight.compliance = compliance.into();
            eight.scale = weight.into();
        }
        fastest.reduce_max()
    }

    /// Conjugate gradients, preconditioned by the diagonal, from the λ of the last substep on.
    #[inline(always)]
    fn iterate<S: Simd>(&mut self, simd: S, filter: f32) {
        let one = splat(simd, 1.0);
        for eight in &mut self.eights {
            let diagonal =
                f32x8::simd_from(simd, eight.compliance) + f32x8::simd_from(simd, eight.scale) * splat(simd, filter);
            eight.scale = (one / diagonal).into();
        }
        self.apply(simd, Of::Lambda, filter);
        let (mut sum, mut whole) = (0.0_f64, 0.0_f64);
        for eight in &mut self.eights {
            let right = f32x8::simd_from(simd, eight.residual);
            let scale = f32x8::simd_from(simd, eight.scale);
            let residual = right - f32x8::simd_from(simd, eight.image);
            let step = residual * scale;
            eight.residual = residual.into();
            eight.direction = step.into();
            sum += total(residual * step);
            whole += total((right * right + splat(simd, FLAT * FLAT)) * scale);
        }
        for _ in 0..ITERATIONS {
            if sum <= f64::from(TOLERANCE * TOLERANCE) * whole + f64::from(f32::MIN_POSITIVE) {
                break;
            }
            self.apply(simd, Of::Direction, filter);
            let mut curvature = 0.0;
            for eight in &self.eights {
                curvature += total(f32x8::simd_from(simd, eight.direction) * f32x8::simd_from(simd, eight.image));
            }
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let along = splat(simd, (sum / curvature) as f32);
            let mut next = 0.0;
            for eight in &mut self.eights {
                let lambda = f32x8::simd_from(simd, eight.lambda) + f32x8::simd_from(simd, eight.direction) * along;
                let residual = f32x8::simd_from(simd, eight.residual) - f32x8::simd_from(simd, eight.image) * along;
                eight.lambda = lambda.into();
                eight.residual = residual.into();
                next += total(residual * residual * f32x8::simd_from(simd, eight.scale));
            }
            let keep = splat(simd, (next / sum) as f32);
            for eight in &mut self.eights {
                let step = f32x8::simd_from(simd, eight.residual) * f32x8::simd_from(simd, eight.scale);
                eight.direction = (step + f32x8::simd_from(simd, eight.direction) * keep).into();
            }
            sum = next;
        }
    }

    /// `image = (1/(G A H²) + θ J W Jᵀ) of`.
    #[inline(always)]
    fn apply<S: Simd>(&mut self, simd: S, of: Of, filter: f32) {
        self.sum(simd, of);
        for (eight, group) in self.eights.iter_mut().zip(&self.batches.groups) {
            let mut image = splat(simd, 0.0);
            for i in 0..3 {
                let (sum, w) = gather4(simd, &self.sums, &group[i]);
                image += eight.gradient(simd, i).dot(sum) * w;
            }
            let own = f32x8::simd_from(simd, *eight.values(of)) * f32x8::simd_from(simd, eight.compliance);
            eight.image = (image * splat(simd, filter) + own).into();
        }
    }

    /// `sums = Jᵀ of`.
    #[inline(always)]
    fn sum<S: Simd>(&mut self, simd: S, of: Of) {
        for (sum, at) in self.sums.iter_mut().zip(&self.position) {
            *sum = [0.0, 0.0, 0.0, at[3]];
        }
        for (eight, group) in self.eights.iter().zip(&self.batches.groups) {
            let values = f32x8::simd_from(simd, *eight.values(of));
            for i in 0..3 {
                let (sum, w) = gather4(simd, &self.sums, &group[i]);
                scatter4(sum + eight.gradient(simd, i) * values, w, &mut self.sums, &group[i]);
            }
        }
    }
}

/// How many times the stiffness of a triangle that of all around it may be together.
const MEET: f32 = 4.0;

#[derive(Clone, Copy)]
enum Of {
    Lambda,
    Direction,
}

impl Eight {
    fn values(&self, of: Of) -> &Lanes {
        match of {
            Of::Lambda => &self.lambda,
            Of::Direction => &self.direction,
        }
    }

    #[inline(always)]
    fn gradient<S: Simd>(&self, simd: S, corner: usize) -> Vec3x8<S> {
        let [x, y, z] = &self.gradient[corner];
        Vec3x8 { x: f32x8::simd_from(simd, *x), y: f32x8::simd_from(simd, *y), z: f32x8::simd_from(simd, *z) }
    }
}

#[inline(always)]
fn total<S: Simd>(of: f32x8<S>) -> f64 {
    let lanes: Lanes = of.into();
    f64::from(lanes.iter().sum::<f32>())
}
