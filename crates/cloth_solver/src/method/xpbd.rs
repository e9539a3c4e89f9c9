//! Small-steps XPBD (Macklin et al. 2019): many substeps, one pass over the constraints in each, exact along lines.
//!
//! One pass leaves an error of the order of h² F/m wherever two families of constraints, or constraints and contact,
//! share a load F: that is why plain XPBD stretches a curtain at its hooks. Two measures keep it small and the step
//! stable at any load and any number of substeps; both leave what is at rest where it belongs:
//!
//! - the waves across taut lines are implicit (`lines::soften`);
//! - a particle under a lasting load that the substep cannot resolve gets the inertia, not the weight, that resolves it
//!   (selective mass scaling, as explicit finite elements use it), at the same kinetic energy.

use fearless_simd::{Simd, dispatch};

use crate::Particles;
use crate::cloth::Substep;
use crate::constraint::Constraints;
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat, store};
use fearless_simd::prelude::*;

/// Predicts positions from velocities and forces, and moves pinned particles along their frames.
pub fn integrate(particles: &mut Particles, constraints: &Constraints, sub: &Substep) {
    dispatch!(*LEVEL, simd => scale_masses(simd, particles));
    constraints.take_hold(particles);
    dispatch!(*LEVEL, simd => predict(simd, particles, sub.h));
    constraints.apply_pins(particles, sub);
}

/// Solves all constraints once and takes velocities from the change of position.
pub fn solve(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    constraints.solve(particles, sub);
    dispatch!(*LEVEL, simd => take_velocities(simd, particles, sub.h));
}

/// Most by which a particle's inertia grows from one substep to the next.
const INERTIA_GROWTH: f32 = 4.0;

/// Least of its inertia that a particle keeps from one substep to the next. Without, the inertia of cloth held at a point
/// comes and goes with every bounce of the load; with 0.8, cloth that leaves a solid it was put into is thrown.
const INERTIA_FADE: f32 = 0.6;

/// Gives particles under a load that the substep cannot resolve the inertia it asks for, and takes back what is no
/// longer needed. Their weight stays: what is at rest stays at rest.
#[inline(always)]
fn scale_masses<S: Simd>(simd: S, particles: &mut Particles) {
    let Particles { mass, inverse_mass, load: wanted, inertia, velocity, .. } = particles;
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let (growth, fade) = (splat(simd, INERTIA_GROWTH), splat(simd, INERTIA_FADE));
    for i in groups(mass) {
        let mass = load(simd, mass, i);
        let had = load(simd, inertia, i);
        let m = mass.max(load(simd, wanted, i)).min(had * growth).max(had * fade);
        store(m, inertia, i);
        // Neither adds nor takes energy, whether inertia comes or goes: at the old velocity it would pump.
        let share = mass.simd_gt(zero).select((had / m).sqrt(), zero);
        (Vec3x8::load(simd, velocity, i) * share).store(velocity, i);
        let w = one / m;
        store(mass.simd_gt(zero).select(w, zero), inverse_mass, i);
    }
}

/// Symplectic Euler: `v += h a`, `Δx = h v` for all that is free.
#[inline(always)]
fn predict<S: Simd>(simd: S, particles: &mut Particles, h: f32) {
    let Particles { moved, velocity, mass, inverse_mass, acceleration, force, airflow, .. } = particles;
    let step = splat(simd, h);
    let kick = Vec3x8::splat(simd, *acceleration * h);
    let zero = splat(simd, 0.0);
    for i in groups(inverse_mass) {
        let w = load(simd, inverse_mass, i);
        // Weight is mass times gravity, inertia may be more than mass: see `scale_masses`.
        let mut v = Vec3x8::load(simd, velocity, i) + kick * (load(simd, mass, i) * w);
        if let Some(force) = force {
            v = v + Vec3x8::load(simd, force, i) * (w * step);
        }
        if let Some(airflow) = airflow {
            v = v + Vec3x8::load(simd, &airflow.force, i) * (w * step);
        }
        let free = w.simd_gt(zero);
        let v = Vec3x8 { x: free.select(v.x, zero), y: free.select(v.y, zero), z: free.select(v.z, zero) };
        (v * step).store(moved, i);
        v.store(velocity, i);
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
