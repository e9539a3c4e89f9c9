//! Methods that step forces: explicit and symplectic Euler, Störmer–Verlet, Runge–Kutta of fourth order.
//!
//! They know no multipliers: stiff fabric takes steps shorter than the period of its fastest mode, `h < 2/ω` and
//! thereabouts. A hand is a plain spring here.

use glam::Vec3;

use super::Method;
use crate::constraint::Constraints;
use crate::tick::Substep;
use crate::{Particles, Soa3};

/// Working memory.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    acceleration: Soa3,
    stage: Soa3,
    stage_velocity: Soa3,
    sum: Soa3,
    sum_velocity: Soa3,
}

impl Scratch {
    fn fit(&mut self, slots: usize) {
        let Self { acceleration, stage, stage_velocity, sum, sum_velocity } = self;
        for array in [acceleration, stage, stage_velocity, sum, sum_velocity] {
            if array.len() != slots {
                *array = Soa3::zeros(slots);
            }
        }
    }
}

/// Takes hold of what is pinned or in a hand.
pub(super) fn begin(particles: &mut Particles, constraints: &Constraints, sub: &Substep) {
    for i in 0..particles.slots() {
        particles.inverse_mass[i] = if particles.mass[i] > 0.0 { 1.0 / particles.mass[i] } else { 0.0 };
    }
    particles.moved.fill(Vec3::ZERO);
    constraints.take_hold(particles);
    constraints.apply_pins(particles, sub);
}

/// One substep.
pub(super) fn step(particles: &mut Particles, constraints: &mut Constraints, sub: &Substep) {
    let mut work = std::mem::take(&mut constraints.explicit);
    work.fit(particles.slots());
    let h = sub.h;
    particles.previous.copy_from(&particles.position);
    // What is pinned moves evenly to where its frame takes it.
    for i in 0..particles.slots() {
        if particles.inverse_mass[i] <= 0.0 {
            particles.velocity.set(i, particles.moved.get(i) / h);
        }
    }
    let Scratch { acceleration, stage, stage_velocity, sum, sum_velocity } = &mut work;
    match constraints.method() {
        Method::ExplicitEuler => {
            accelerations(particles, constraints, &particles.position, sub.start, acceleration);
            add(&mut particles.position, &particles.velocity, h);
            add(&mut particles.velocity, acceleration, h);
        }
        Method::SymplecticEuler => {
            accelerations(particles, constraints, &particles.position, sub.start, acceleration);
            add(&mut particles.velocity, acceleration, h);
            add(&mut particles.position, &particles.velocity, h);
        }
        Method::StormerVerlet => {
            add(&mut particles.position, &particles.velocity, 0.5 * h);
            accelerations(particles, constraints, &particles.position, 0.5 * (sub.start + sub.end), acceleration);
            add(&mut particles.velocity, acceleration, h);
            add(&mut particles.position, &particles.velocity, 0.5 * h);
        }
        _ => {
            let middle = 0.5 * (sub.start + sub.end);
            sum.fill(Vec3::ZERO);
            sum_velocity.fill(Vec3::ZERO);
            acceleration.fill(Vec3::ZERO);
            stage_velocity.fill(Vec3::ZERO);
            for (back, time, weight) in
                [(0.0, sub.start, 1.0), (0.5, middle, 2.0), (0.5, middle, 2.0), (1.0, sub.end, 1.0)]
            {
                // x + back h v', v + back h a' of the stage before.
                stage.copy_from(&particles.position);
                add(stage, stage_velocity, back * h);
                stage_velocity.copy_from(&particles.velocity);
                add(stage_velocity, acceleration, back * h);
                accelerations(particles, constraints, stage, time, acceleration);
                add(sum, stage_velocity, weight / 6.0);
                add(sum_velocity, acceleration, weight / 6.0);
            }
            add(&mut particles.position, sum, h);
            add(&mut particles.velocity, sum_velocity, h);
        }
    }
    constraints.explicit = work;
}

/// `to += by * scale`.
fn add(to: &mut Soa3, by: &Soa3, scale: f32) {
    for (to, by) in [(&mut to.x, &by.x), (&mut to.y, &by.y), (&mut to.z, &by.z)] {
        for (to, by) in to.iter_mut().zip(by) {
            *to += by * scale;
        }
    }
}

/// Acceleration of each slot at `position`, m/s²; `t` is the part of the tick that has passed.
fn accelerations(particles: &Particles, constraints: &Constraints, position: &Soa3, t: f32, to: &mut Soa3) {
    match &particles.force {
        Some(force) => to.copy_from(force),
        None => to.fill(Vec3::ZERO),
    }
    if let Some(airflow) = &particles.airflow {
        add(to, &airflow.force, 1.0);
    }
    constraints.add_forces(position, to);
    for grab in &constraints.grabs {
        grab.add_force(position, to, t);
    }
    let Particles { mass, inverse_mass, acceleration, .. } = particles;
    for i in 0..particles.slots() {
        // Weight is mass times gravity; inertia is more while a hand holds.
        let w = inverse_mass[i];
        to.set(i, to.get(i) * w + *acceleration * (mass[i] * w));
    }
}
