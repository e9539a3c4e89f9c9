//! What happens to a cloth with a number that is not finite.

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::{Fabric, Particles, Topology};

use crate::cloth::{ClothHistory, ClothTopology};
use crate::events::ClothRecovered;
use crate::prepare::StepPlan;
use crate::report::report;
use crate::step::{ClothTick, clear_forces};

/// Whether every number is finite that a tick goes on from. Inverse masses count: to the solver a NaN is a pin.
pub(crate) fn is_finite(particles: &Particles) -> bool {
    // A maximum of integers, which the compiler turns into vector code; infinity and NaN have the largest exponent.
    let largest = particles.inverse_mass.iter().fold(0, |largest, w| (w.to_bits() & !SIGN).max(largest));
    largest < f32::INFINITY.to_bits() && particles.is_finite()
}

/// The sign bit of an f32.
const SIGN: u32 = 1 << 31;

/// Puts a cloth back into its last finite shape, at rest. Masses and constraints are made anew, because whatever
/// spoilt the positions may have spoilt them too.
pub(crate) fn recover(
    topology: &Topology,
    fabric: &Fabric,
    particles: &mut Particles,
    constraints: &mut Constraints,
    history: &ClothHistory,
) {
    *particles = Particles::new(topology, fabric.areal_density);
    if history.position.is_finite() {
        particles.position.copy_from(&history.position);
        particles.previous.copy_from(&history.position);
    }
    // The fabric was accepted before, and so were the pins: should they be refused now, the old ones do as well.
    if let Ok(mut fresh) = Constraints::new(topology, fabric) {
        fresh.grabs = std::mem::take(&mut constraints.grabs);
        if let Err(error) = fresh.set_pins(particles, constraints.pins().clone()) {
            error!("the pins of a recovered cloth were lost: {error}");
        }
        *constraints = fresh;
    }
}

/// Looks at every cloth that moved in this tick, and brings back those with a number that is not finite.
pub(crate) fn mend(
    mut cloths: Query<(
        Entity,
        &ClothTopology,
        Option<&Fabric>,
        &mut Particles,
        &mut Constraints,
        &mut ClothHistory,
        &StepPlan,
    )>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for (entity, topology, fabric, mut particles, mut constraints, mut history, plan) in &mut cloths {
        if plan.substeps == 0 {
            continue;
        }
        if !is_finite(&particles) {
            let fabric = fabric.copied().unwrap_or_default();
            recover(topology, &fabric, &mut particles, &mut constraints, &history);
            report(&mut commands, ClothRecovered { entity });
        }
        if tick.still {
            particles.velocity.fill(Vec3::ZERO);
            history.position.copy_from(&particles.position);
        }
        clear_forces(&mut particles);
    }
}
