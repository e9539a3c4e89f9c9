//! Bending of a mesh that is no grid: quadratic in the positions, as [`crate::topology::curvatures`] measures it, and implicit.
//!
//! Energy `½ Σ A D |κ − κ₀|²` over triangles and the three components of curvature; with κ linear in the positions (isometric
//! bending, Bergou et al. 2006) that is `½ xᵀQx − tᵀx`, Q constant and without directions, t from the rest shape alone and 0
//! where that is flat. Its force is that where the substep begins; where it is too stiff for the longest substep H it is filtered,
//! `(M/H² + θ Q) d = t − Q x`, by conjugate gradients in the masses, a handful of iterations and as many as it takes for what is
//! stiff. From nothing on, every iterate is a symmetric matrix without directions times x: it moves and turns nothing as a whole.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x4};
use glam::{DVec3, Vec3};

use crate::batch::{Packed, pack};
use crate::topology::{Curvature, curvatures};
use crate::{Fabric, Particles, Soa3, Substep, Topology};

/// How much of the force that bending exerts may be left to find, as root mean square.
const TOLERANCE: f64 = 0.02;

/// Entries of a row that are added up side by side; no sum waits for the last one.
const ABREAST: usize = 4;

/// Most iterations in a substep.
const ITERATIONS: usize = 400;

/// What resists bending in a mesh.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct Bending {
    /// Row by row: the columns of Q off the diagonal and what stands there, filled up with zeros to a multiple of
    /// [`ABREAST`].
    rows: Vec<[u32; 2]>,
    columns: Vec<u32>,
    values: Vec<f32>,
    /// The diagonal of Q, N/m.
    diagonal: Vec<f32>,
    /// What is not flat at rest, with the stiffness of each component.
    curved: Vec<(Curvature, [f64; 3])>,
    rest: Vec<Vec3>,
    /// Number of triangles that resist.
    count: usize,
    /// Sum of the entries of each row of Q without their signs, N/m.
    largest: Vec<f32>,
    work: Work,
}

/// ω² H² of the fastest wave of bending after filtering, H the longest substep.
const FASTEST: f32 = 1.2;

/// Vectors of the conjugate gradients.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Work {
    residual: Vec<Packed>,
    direction: Vec<Packed>,
    image: Vec<Packed>,
    found: Vec<Packed>,
    /// M/H² of each slot; 0 for what does not move.
    inertia: Vec<f32>,
    /// Its inverse; 0 for what does not move.
    scale: Vec<f32>,
    /// θ.
    filter: f32,
}

impl Work {
    fn new(slots: usize) -> Self {
        let vector = || vec![[0.0; 4]; slots];
        let [inertia, scale] = [vec![0.0; slots], vec![0.0; slots]];
        Self { residual: vector(), direction: vector(), image: vector(), found: vector(), inertia, scale, filter: 0.0 }
    }
}

impl Bending {
    /// `None` if the fabric does not resist bending.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Option<Self> {
        if fabric.bend_warp <= 0.0 && fabric.bend_weft <= 0.0 {
            return None;
        }
        let all = curvatures(topology);
        let mut made = Self {
            rows: Vec::with_capacity(topology.slots()),
            columns: Vec::new(),
            values: Vec::new(),
            diagonal: vec![0.0; topology.slots()],
            count: all.iter().filter(|curvature| curvature.parts.len() > 3).count(),
            curved: Vec::new(),
            rest: Vec::new(),
            largest: Vec::new(),
            work: Work::new(topology.slots()),
        };
        let stiffness: Vec<[f64; 3]> = all.iter().map(|curvature| curvature.stiffness(fabric)).collect();
        let mut terms = vec![Vec::new(); topology.slots()];
        for (index, curvature) in all.iter().enumerate() {
            curvature.parts.iter().for_each(|(slot, weights)| terms[*slot as usize].push((index, weights)));
        }
        // A row at a time: the sum for each column, and which columns there are.
        let mut sums = vec![0.0; topology.slots()];
        let mut columns: Vec<u32> = Vec::new();
        for (slot, terms) in terms.iter().enumerate() {
            for (index, weights) in terms {
                let pull: [f64; 3] = core::array::from_fn(|a| stiffness[*index][a] * weights[a]);
                for (column, of) in &all[*index].parts {
                    let sum = &mut sums[*column as usize];
                    if *sum == 0.0 {
                        columns.push(*column);
                    }
                    *sum += pull[0] * of[0] + pull[1] * of[1] + pull[2] * of[2];
                }
            }
            columns.sort_unstable();
            let first = made.columns.len();
            for column in columns.drain(..) {
                let value = std::mem::take(&mut sums[column as usize]) as f32;
                if column as usize == slot {
                    made.diagonal[slot] += value;
                } else if value != 0.0 {
                    made.columns.push(column);
                    made.values.push(value);
                }
            }
            while !(made.columns.len() - first).is_multiple_of(ABREAST) {
                made.columns.push(slot as u32);
                made.values.push(0.0);
            }
            made.rows.push([first, made.columns.len()].map(|at| at as u32));
        }
        let entries = |[first, end]: [u32; 2]| &made.values[first as usize..end as usize];
        let sum = |(row, own): (&[u32; 2], &f32)| own + entries(*row).iter().map(|value| value.abs()).sum::<f32>();
        made.largest = made.rows.iter().zip(&made.diagonal).map(sum).collect();
        made.curved = (all.into_iter().filter(|curvature| !curvature.is_flat()))
            .map(|curvature| {
                let stiffness = curvature.stiffness(fabric);
                (curvature, stiffness)
            })
            .collect();
        if !made.curved.is_empty() {
            made.rest.clone_from(&topology.rest);
        }
        Some(made)
    }

    /// Number of constraints: one to a triangle.
    pub fn count(&self) -> usize {
        self.count
    }

    /// `Q x` of slot `i` at `x`, N: what bending pulls with, the other way round, were the cloth flat at rest.
    fn bent(&self, i: usize, x: impl Fn(usize) -> Vec3) -> Vec3 {
        let [first, end] = self.rows[i].map(|at| at as usize);
        let here = x(i);
        // Rows add up to 0: what counts is where the others are from here.
        (first..end).map(|at| (x(self.columns[at] as usize) - here) * self.values[at]).sum()
    }

    /// Adds t, times `scale`, of what is not flat at rest.
    fn add_targets(&self, x: impl Fn(u32) -> DVec3, mut add: impl FnMut(usize, Vec3)) {
        for (curvature, stiffness) in &self.curved {
            let targets = curvature.targets(curvature.at(&x), &x, |slot| self.rest[slot as usize].as_dvec3());
            for (slot, weights) in &curvature.parts {
                let pull: DVec3 = (0..3).map(|a| targets[a] * (stiffness[a] * weights[a])).sum();
                add(*slot as usize, pull.as_vec3());
            }
        }
    }

    /// Adds the forces at `position`, N.
    pub fn add_forces(&self, position: &Soa3, force: &mut Soa3) {
        for i in 0..self.rows.len() {
            force.set(i, force.get(i) - self.bent(i, |j| position.get(j)));
        }
        self.add_targets(|slot| position.get(slot as usize).as_dvec3(), |i, pull| force.set(i, force.get(i) + pull));
    }

    /// ω² H² of the fastest wave for the square H² of a substep, s²: at most the largest sum of a row (Gershgorin).
    pub fn fastest(&self, inverse_mass: &[f32], square: f32) -> f32 {
        inverse_mass.iter().zip(&self.largest).fold(0.0, |most, (w, row)| (w * row * square).max(most))
    }

    /// Moves every particle by what bends it where the substep begins.
    #[inline(always)]
    pub fn push<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) {
        let mut work = std::mem::take(&mut self.work);
        let Particles { position, moved, inverse_mass, mass, .. } = particles;
        let square = sub.longest * sub.longest;
        let fastest = self.fastest(inverse_mass, square);
        for (i, w) in inverse_mass.iter().enumerate() {
            work.inertia[i] = if *w > 0.0 { 1.0 / (w * square) } else { 0.0 };
            work.scale[i] = w * square;
        }
        work.filter = if fastest > FASTEST { 1.0 / FASTEST - 1.0 / fastest } else { 0.0 };
        pack(position, inverse_mass, &mut work.direction);
        for i in 0..self.rows.len() {
            (f32x4::splat(simd, 0.0) - self.times(simd, i, &work.direction)).store_slice(&mut work.residual[i]);
        }
        self.add_targets(
            |slot| position.get(slot as usize).as_dvec3(),
            |i, pull| work.residual[i] = (Vec3::from_slice(&work.residual[i]) + pull).extend(0.0).to_array(),
        );
        if work.filter > 0.0 {
            work.found.fill([0.0; 4]);
            self.iterate(simd, &mut work);
        } else {
            for i in 0..self.rows.len() {
                let push = f32x4::simd_from(simd, work.residual[i]) * f32x4::splat(simd, work.scale[i]);
                push.store_slice(&mut work.found[i]);
            }
        }
        // What rounding leaves must not push cloth that hangs on nothing.
        if mass.iter().zip(&work.inertia).all(|(mass, inertia)| *mass <= 0.0 || *inertia > 0.0) {
            let (mut push, mut all) = (DVec3::ZERO, 0.0);
            for (found, inertia) in work.found.iter().zip(&work.inertia) {
                push += Vec3::from_slice(found).as_dvec3() * f64::from(*inertia);
                all += f64::from(*inertia);
            }
            let push = (push / all.max(f64::MIN_POSITIVE)).as_vec3();
            for (found, _) in work.found.iter_mut().zip(&work.inertia).filter(|(_, inertia)| **inertia > 0.0) {
                *found = (Vec3::from_slice(found) - push).extend(0.0).to_array();
            }
        }
        let share = sub.share();
        for i in 0..self.rows.len() {
            moved.set(i, moved.get(i) + Vec3::from_slice(&work.found[i]) * share);
        }
        self.work = work;
    }

    /// Row `i` of Q times `vector`.
    #[inline(always)]
    fn times<S: Simd>(&self, simd: S, i: usize, vector: &[Packed]) -> f32x4<S> {
        let here = f32x4::simd_from(simd, vector[i]);
        let [first, end] = self.rows[i];
        let entries = first as usize..end as usize;
        let (columns, _) = self.columns[entries.clone()].as_chunks::<ABREAST>();
        let (values, _) = self.values[entries].as_chunks::<ABREAST>();
        let mut sums = [f32x4::splat(simd, 0.0); ABREAST];
        for (columns, values) in columns.iter().zip(values) {
            for k in 0..ABREAST {
                // Rows add up to 0: what counts is where the others are from here.
                let there = f32x4::simd_from(simd, vector[columns[k] as usize]);
                sums[k] += (there - here) * f32x4::splat(simd, values[k]);
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }

    /// Conjugate gradients, preconditioned by the masses, from `found` and `residual` on.
    #[inline(always)]
    fn iterate<S: Simd>(&self, simd: S, work: &mut Work) {
        let slots = self.rows.len();
        let filter = f32x4::splat(simd, work.filter);
        let mut sum = 0.0;
        for i in 0..slots {
            let residual = f32x4::simd_from(simd, work.residual[i]);
            let step = residual * f32x4::splat(simd, work.scale[i]);
            step.store_slice(&mut work.direction[i]);
            sum += dot(residual, step);
        }
        for _ in 0..ITERATIONS {
            if sum <= f64::from(f32::MIN_POSITIVE) {
                break;
            }
            let mut curvature = 0.0;
            for i in 0..slots {
                let here = f32x4::simd_from(simd, work.direction[i]);
                let image = self.times(simd, i, &work.direction) * filter + here * f32x4::splat(simd, work.inertia[i]);
                image.store_slice(&mut work.image[i]);
                curvature += dot(here, image);
            }
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let along = f32x4::splat(simd, (sum / curvature) as f32);
            let (mut next, mut left, mut force) = (0.0, 0.0, 0.0);
            for i in 0..slots {
                let direction = f32x4::simd_from(simd, work.direction[i]);
                let found = f32x4::simd_from(simd, work.found[i]) + direction * along;
                found.store_slice(&mut work.found[i]);
                let residual = f32x4::simd_from(simd, work.residual[i]) - f32x4::simd_from(simd, work.image[i]) * along;
                residual.store_slice(&mut work.residual[i]);
                next += dot(residual, residual * f32x4::splat(simd, work.scale[i]));
                let is_free = f32x4::splat(simd, if work.inertia[i] > 0.0 { 1.0 } else { 0.0 });
                left += dot(residual * is_free, residual);
                let pull = found * f32x4::splat(simd, work.inertia[i]);
                force += dot(pull, pull);
            }
            if left <= TOLERANCE * TOLERANCE * force {
                break;
            }
            let keep = f32x4::splat(simd, (next / sum) as f32);
            for i in 0..slots {
                let step = f32x4::simd_from(simd, work.residual[i]) * f32x4::splat(simd, work.scale[i]);
                (step + f32x4::simd_from(simd, work.direction[i]) * keep).store_slice(&mut work.direction[i]);
            }
            sum = next;
        }
    }
}

#[inline(always)]
fn dot<S: Simd>(a: f32x4<S>, b: f32x4<S>) -> f64 {
    let [x, y, z, _]: [f32; 4] = (a * b).into();
    f64::from(x + y + z)
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::lanes::LEVEL;
    use crate::measure::elastic_energy;
    use crate::topology::MeshSource;
    use crate::topology::curvature::tests::irregular;

    const FABRIC: Fabric = Fabric {
        stretch_warp: 1e-9,
        stretch_weft: 1e-9,
        shear: 0.0,
        bend_warp: 2e-3,
        bend_weft: 5e-4,
        ..Fabric::PAPER
    };

    /// A sheet, flat or with the curvature of a barrel at rest, pulled out of shape.
    fn bent(curved: bool) -> (Topology, Particles) {
        let mut topology = irregular(5);
        if curved {
            let barrel = |x: &Vec3| Vec3::new(x.x, 0.7 * x.y, 0.5 * x.x * (1.0 - x.x) + 0.3 * x.y * x.y);
            let used = topology.particle_count();
            let positions: Vec<Vec3> = topology.rest[..used].iter().map(barrel).collect();
            let source = MeshSource { positions: &positions, uvs: &[], indices: topology.triangles.as_flattened() };
            topology = Topology::from_mesh(source).expect("a barrel");
        }
        let mut particles = Particles::new(&topology, 0.1);
        for i in 0..particles.slots() {
            let x = particles.position.get(i);
            let off = Vec3::Z * (0.2 * x.x * x.x + 0.03 * (5.0 * x.y).sin());
            particles.position.set(i, x + off);
        }
        (topology, particles)
    }

    #[test]
    fn forces_are_what_the_energy_loses() {
        for curved in [false, true] {
            let (topology, mut particles) = bent(curved);
            let bending = Bending::new(&topology, &FABRIC).expect("a fabric that bends");
            let mut force = Soa3::zeros(particles.slots());
            bending.add_forces(&particles.position, &mut force);
            let step = 1e-3;
            let largest = (0..force.len()).map(|i| force.get(i).length()).fold(0.0, f32::max);
            assert!(largest > 5e-3, "{largest} N");
            for slot in [0, 7, 14, 20, 33] {
                let x = particles.position.get(slot);
                let mut energy = |by: Vec3| {
                    particles.position.set(slot, x + by);
                    elastic_energy(&topology, &particles, &FABRIC)
                };
                let lost = Vec3::AXES
                    .map(|axis| ((energy(-axis * step) - energy(axis * step)) / f64::from(2.0 * step)) as f32);
                let found = force.get(slot);
                // Targets that do not quite point as the curvature does have no energy for it.
                let tolerance = if curved { 0.05 } else { 1e-3 };
                let difference = found.distance(Vec3::from_array(lost));
                assert!(difference < tolerance * largest, "{found} N, not {lost:?} N at {slot}");
                particles.position.set(slot, x);
            }
        }
    }

    #[test]
    fn bending_takes_no_momentum_and_no_spin() {
        for curved in [false, true] {
            let (topology, mut particles) = bent(curved);
            let mut bending = Bending::new(&topology, &FABRIC).expect("a fabric that bends");
            let h = 1.0 / 600.0;
            let sub =
                Substep { h, kick: h, longest: h, shortest: h, start: 0.0, end: 1.0, implicit: false, iterations: 1 };
            for _ in 0..3 {
                dispatch!(*LEVEL, simd => bending.push(simd, &mut particles, &sub));
            }
            let (mut sum, mut spin, mut moved) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            for i in 0..particles.slots() {
                let pull = particles.moved.get(i).as_dvec3() * f64::from(particles.mass[i]);
                sum += pull;
                // A step is as implicit as it is long: torques balance where it ends.
                spin += (particles.position.get(i) + particles.moved.get(i)).as_dvec3().cross(pull);
                moved += pull.length();
            }
            assert!(moved > 0.0 && sum.length() < 1e-3 * moved, "{sum} of {moved}");
            assert!(spin.length() < 0.02 * moved, "{spin} of {moved}");
        }
    }
}
