//! What a cloth is doing, in numbers, for those that ask.

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::{Particles, measure};

use crate::cloth::ClothTopology;
use crate::prepare::StepPlan;
use crate::sleep::ClothAsleep;

/// What a cloth is doing, in numbers. Spawn it beside [`Cloth`](crate::Cloth) to have it measured after every tick;
/// without it nothing is measured. Writing to it has no effect.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ClothStats {
    /// Number of particles.
    pub particles: u32,
    /// Number of triangles.
    pub triangles: u32,
    /// Constraints solved in each substep.
    pub constraints: u32,
    /// Particles that touched a collider in the last substep.
    pub contacts: u32,
    /// Places at which it pressed on itself in the last substep; 0 without [`SelfContact`](crate::SelfContact), as are the next two.
    pub self_contacts: u32,
    /// Edges that pass through a triangle of it, see [`ClothTangled`](crate::ClothTangled).
    pub tangled: u32,
    /// Whether it is so crumpled that [`SelfContact::budget`](crate::SelfContact::budget) was too small: it may pass through itself.
    pub self_contact_bounded: bool,
    /// Substeps of the last tick.
    pub substeps: u32,
    /// Largest strain of the weave, dimensionless.
    pub largest_strain: f32,
    /// Root mean square of the strains of all threads, stretched and compressed, dimensionless.
    pub rms_strain: f32,
    /// Root mean square of the particles' speeds, weighed by mass, m/s.
    pub rms_speed: f32,
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
    /// Whether it is asleep, see [`ClothSleep`](crate::ClothSleep). It then takes no substeps.
    pub asleep: bool,
}

/// Measures the clothes that ask for it; those that are asleep once.
pub(crate) fn measure(
    mut cloths: Query<
        (
            &mut ClothStats,
            &ClothTopology,
            &Particles,
            &Constraints,
            &Contacts,
            Option<&SelfContacts>,
            &StepPlan,
            Has<ClothAsleep>,
        ),
        Or<(Without<ClothAsleep>, Added<ClothAsleep>, Added<ClothStats>)>,
    >,
) {
    for (mut stats, topology, particles, constraints, contacts, own, plan, asleep) in &mut cloths {
        *stats = ClothStats {
            particles: topology.particle_count() as u32,
            triangles: topology.triangles.len() as u32,
            constraints: constraints.count() as u32,
            contacts: contacts.touching,
            self_contacts: own.map_or(0, SelfContacts::touching),
            tangled: own.map_or(0, SelfContacts::tangled) as u32,
            self_contact_bounded: own.is_some_and(SelfContacts::is_bounded),
            substeps: plan.substeps,
            largest_strain: measure::largest_strain(topology, particles),
            rms_strain: rms_strain(topology, particles),
            rms_speed: measure::rms_speed(topology, particles),
            kinetic_energy: measure::kinetic_energy(particles),
            asleep,
        };
    }
}

/// Root mean square of the strains of all threads, stretched and compressed.
fn rms_strain(topology: &ClothTopology, particles: &Particles) -> f32 {
    let (count, squares) = measure::edge_strains(topology, particles)
        .map(|(_, strain)| f64::from(strain).powi(2))
        .fold((0_usize, 0.0), |(count, squares), square| (count + 1, squares + square));
    (squares / count.max(1) as f64).sqrt() as f32
}
