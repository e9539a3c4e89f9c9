//! Small-steps XPBD (Macklin et al. 2019): many substeps, one pass over the constraints in each, exact along lines.
//!
//! An exact line is stable only while T h²/(m l) stays below 1 (T tension, m particle mass, l edge length): its transverse
//! waves are explicit. Particles whose lines are tighter get as much inertia as the bound asks for, in that substep, and
//! no weight: what is at rest stays where it would be, and what swings near a taut corner swings a little slower.
//! (Selective mass scaling, as explicit finite elements use it; the load is known from the last substep's multipliers.)

use fearless_simd::{Simd, dispatch};

use crate::cloth::Substep;
use crate::constraint::Constraints;
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat};
use crate::Particles;
use fearless_simd::prelude::*;

/// Predicts positions from velocities and forces, and moves pinned particles along their frames.
pub fn integrate(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    constraints.scale_masses(particles, sub.h);
    dispatch!(*LEVEL, simd => predict(simd, particles, sub.h));
    constraints.apply_pins(particles, sub);
}

/// Solves all constraints once and takes velocities from the change of position.
pub fn solve(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    constraints.solve(particles, sub);
    dispatch!(*LEVEL, simd => take_velocities(simd, particles, sub.h));
    if sub.end == 1.0 {
        constraints.damp(particles, sub.h / (sub.end - sub.start));
    }
}

/// Symplectic Euler: `v += h a`, `x += h v` for all that is free.
#[inline(always)]
fn predict<S: Simd>(simd: S, particles: &mut Particles, h: f32) {
    let Particles { position, previous, velocity, mass, inverse_mass, acceleration, force } = particles;
    let step = splat(simd, h);
    let kick = Vec3x8::splat(simd, *acceleration * h);
    let zero = splat(simd, 0.0);
    for i in groups(inverse_mass) {
        let w = load(simd, inverse_mass, i);
        // Weight is mass times gravity, inertia may be more than mass: see `Constraints::scale_masses`.
        let mut v = Vec3x8::load(simd, velocity, i) + kick * (load(simd, mass, i) * w);
        if let Some(force) = force {
            v = v + Vec3x8::load(simd, force, i) * (w * step);
        }
        let free = w.simd_gt(zero);
        let v = Vec3x8 { x: free.select(v.x, zero), y: free.select(v.y, zero), z: free.select(v.z, zero) };
        let x = Vec3x8::load(simd, position, i);
        x.store(previous, i);
        (x + v * step).store(position, i);
        v.store(velocity, i);
    }
}

/// `v = (x − x_previous)/h`.
#[inline(always)]
fn take_velocities<S: Simd>(simd: S, particles: &mut Particles, h: f32) {
    let Particles { position, previous, velocity, inverse_mass, .. } = particles;
    let per_step = splat(simd, 1.0 / h);
    for i in groups(inverse_mass) {
        let moved = Vec3x8::load(simd, position, i) - Vec3x8::load(simd, previous, i);
        (moved * per_step).store(velocity, i);
    }
}

/// Starts of the groups of eight slots. Slots come in multiples of eight.
fn groups(slots: &[f32]) -> impl Iterator<Item = usize> + use<> {
    (0..slots.len() / LANES).map(|group| group * LANES)
}

