//! Small-steps XPBD (Macklin et al. 2019): many substeps, a few passes over the constraints in each, exact along lines.
//!
//! A pass leaves an error of the order of h² F/m wherever two families of constraints share a load F: that is why plain XPBD
//! stretches a curtain at its hooks. Further passes go on from its multipliers, until nothing is left to do, and there are as
//! many substeps as load and motion ask for: see [`crate::tick`].
//!
//! Every force within the cloth has no moment about where the substep begins, and positions and velocities leap over each other
//! (leapfrog; Hairer, Lubich, Wanner 2003): so the whole keeps its momentum to rounding, and its energy as well as the
//! substeps resolve its motion.

use fearless_simd::{Simd, dispatch};

use crate::Particles;
use crate::constraint::Constraints;
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat};
use crate::tick::Substep;
use fearless_simd::prelude::*;

/// Predicts how the particles move from velocities and forces, and moves pinned ones along their frames.
pub fn integrate(particles: &mut Particles, constraints: &Constraints, sub: &Substep) {
    constraints.take_hold(particles);
    dispatch!(*LEVEL, simd => predict(simd, particles, sub));
    constraints.apply_pins(particles, sub);
}

/// Takes positions and velocities from how the particles moved.
pub fn accept(particles: &mut Particles, sub: &Substep) {
    dispatch!(*LEVEL, simd => take_velocities(simd, particles, sub.h));
}

/// Leapfrog: `Δx = h (v + kick a)` for all that is free.
#[inline(always)]
fn predict<S: Simd>(simd: S, particles: &mut Particles, sub: &Substep) {
    let Particles { moved, velocity, mass, inverse_mass, acceleration, force, airflow, .. } = particles;
    let (step, kick) = (splat(simd, sub.h), splat(simd, sub.kick));
    let weight = Vec3x8::splat(simd, *acceleration * sub.kick);
    let zero = splat(simd, 0.0);
    for i in groups(inverse_mass) {
        let w = load(simd, inverse_mass, i);
        // Weight is mass times gravity, inertia may be more than mass: that of a hand.
        let mut v = Vec3x8::load(simd, velocity, i) + weight * (load(simd, mass, i) * w);
        if let Some(force) = force {
            v = v + Vec3x8::load(simd, force, i) * (w * kick);
        }
        if let Some(airflow) = airflow {
            v = v + Vec3x8::load(simd, &airflow.force, i) * (w * kick);
        }
        let free = w.simd_gt(zero);
        let v = Vec3x8 { x: free.select(v.x, zero), y: free.select(v.y, zero), z: free.select(v.z, zero) };
        (v * step).store(moved, i);
    }
}

/// Moves nearer to 0 than this, m, are 0: a hundredth of the size of an atom's nucleus. A swing never quite ends, and a pull at
/// one place fades without end over the others; where what is left are no normal numbers any more, a tick takes twice as long.
const NOTHING: f32 = 1e-17;

/// `x += Δx`, `v = Δx/h`.
#[inline(always)]
fn take_velocities<S: Simd>(simd: S, particles: &mut Particles, h: f32) {
    let Particles { position, moved, previous, velocity, inverse_mass, .. } = particles;
    let step = splat(simd, h);
    for i in groups(inverse_mass) {
        let (x, moved) = (Vec3x8::load(simd, position, i), without_next_to_nothing(simd, Vec3x8::load(simd, moved, i)));
        x.store(previous, i);
        (x + moved).store(position, i);
        // Divided, not multiplied by 1/h, whose rounding would add to the speed of everything in every substep.
        Vec3x8 { x: moved.x / step, y: moved.y / step, z: moved.z / step }.store(velocity, i);
    }
}

#[inline(always)]
fn without_next_to_nothing<S: Simd>(simd: S, v: Vec3x8<S>) -> Vec3x8<S> {
    let (zero, nothing) = (splat(simd, 0.0), splat(simd, NOTHING));
    Vec3x8 {
        x: v.x.abs().simd_lt(nothing).select(zero, v.x),
        y: v.y.abs().simd_lt(nothing).select(zero, v.y),
        z: v.z.abs().simd_lt(nothing).select(zero, v.z),
    }
}

/// Starts of the groups of eight slots. Slots come in multiples of eight.
fn groups(slots: &[f32]) -> impl Iterator<Item = usize> + use<> {
    (0..slots.len() / LANES).map(|group| group * LANES)
}
