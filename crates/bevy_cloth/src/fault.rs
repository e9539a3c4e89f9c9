//! What happens to a cloth with a number that is not finite.

use std::sync::Arc;

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::SelfContacts;
use cloth_solver::{Cloth, Fabric, Particles, Topology};

use crate::cloth::{ClothHistory, ClothTopology};
use crate::events::ClothRecovered;
use crate::prepare::StepPlan;
use crate::report::report;
use crate::sleep::ClothAsleep;
use crate::step::{ClothTick, clear_forces};
use crate::weights::Loads;

/// Whether every number is finite that a tick goes on from. Inverse masses count: to the solver a NaN is a pin.
pub(crate) fn is_finite(particles: &Particles) -> bool {
    let (x, v) = (&particles.position, &particles.velocity);
    [&x.x, &x.y, &x.z, &v.x, &v.y, &v.z, &particles.inverse_mass].into_iter().all(|numbers| all_finite(numbers))
}

/// Infinity and NaN have the largest bits of all numbers but for the sign, and a maximum of integers becomes vector
/// code, which a sum of floats or a loop that ends early does not.
fn all_finite(numbers: &[f32]) -> bool {
    numbers.iter().fold(0, |largest, number| number.abs().to_bits().max(largest)) < f32::INFINITY.to_bits()
}

/// Puts a cloth back into its last finite shape, at rest. Masses and constraints are made anew, because whatever
/// spoilt the positions may have spoilt them too.
pub(crate) fn recover(
    topology: &Arc<Topology>,
    fabric: &Fabric,
    loads: &Loads,
    particles: &mut Particles,
    constraints: &mut Constraints,
    history: &ClothHistory,
) {
    let Ok(mut fresh) = Cloth::new(topology.clone(), fabric) else {
        // The fabric was accepted before and cannot be refused now: it is out of the simulation if it changed since.
        return;
    };
    if history.position.is_finite() {
        fresh.particles.position.copy_from(&history.position);
        fresh.particles.previous.copy_from(&history.position);
    }
    if let Err(error) = loads.hang(&mut fresh.particles) {
        error!("the weights of a recovered cloth were lost: {error}");
    }
    fresh.constraints.grabs = std::mem::take(&mut constraints.grabs);
    let pins = constraints.pins().clone();
    if let Err(error) = fresh.constraints.set_pins(&mut fresh.particles, pins) {
        error!("the pins of a recovered cloth were lost: {error}");
    }
    if let Err(error) = fresh.constraints.set_skin(&fresh.particles, constraints.skin().cloned()) {
        error!("the skin of a recovered cloth was lost: {error}");
    }
    (*particles, *constraints) = (fresh.particles, fresh.constraints);
}

/// Looks at every cloth that moved in this tick, and brings back those with a number that is not finite.
pub(crate) fn mend(
    mut cloths: Query<
        (
            Entity,
            &ClothTopology,
            Option<&Fabric>,
            &Loads,
            &mut Particles,
            &mut Constraints,
            &mut ClothHistory,
            Option<&mut SelfContacts>,
            &StepPlan,
        ),
        Without<ClothAsleep>,
    >,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for (entity, topology, fabric, loads, mut particles, mut constraints, mut history, own, plan) in &mut cloths {
        if plan.substeps == 0 {
            continue;
        }
        if !is_finite(&particles) {
            let fabric = fabric.copied().unwrap_or_default();
            recover(&topology.0, &fabric, loads, &mut particles, &mut constraints, &history);
            if let Some(mut own) = own {
                own.reset(&topology.0);
            }
            report(&mut commands, ClothRecovered { entity });
        }
        if tick.still {
            particles.velocity.fill(Vec3::ZERO);
            history.position.copy_from(&particles.position);
            constraints.pin_frames_mut().iter_mut().for_each(|motion| motion.from = motion.to);
        }
        clear_forces(&mut particles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bad_number_among_many_is_found_whatever_its_sign() {
        let mut numbers = [f32::MAX; 37];
        assert!(all_finite(&numbers));
        for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            numbers[20] = bad;
            assert!(!all_finite(&numbers), "{bad}");
        }
    }
}
