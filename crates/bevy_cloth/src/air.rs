//! The wind, and what the air does to cloth.

use bevy::prelude::*;
use cloth_solver::forces::Air;
use cloth_solver::{ClothError, Particles};

use crate::cloth::{ClothFrame, ClothTopology};
use crate::prepare::StepPlan;
use crate::settings::Shared;
use crate::step::ClothTick;

/// Velocity of the air, the same everywhere, in world axes, m/s; each axis −1,000,000 to 1,000,000. Default 0: calm.
///
/// A component on a cloth overrides the resource [`Shared<Wind>`]. Only a cloth with the component [`Air`] feels it, and
/// it feels calm air, too.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Wind(pub Vec3);

impl Wind {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let mut axes = self.0.to_array().into_iter();
        axes.try_for_each(|axis| ClothError::check("Wind", axis, -1e6..=1e6, "-1,000,000..=1,000,000 m/s on each axis"))
    }
}

/// Lets the air act on every cloth that has [`Air`].
pub(crate) fn blow(
    mut cloths: Query<(&mut Particles, &ClothTopology, &ClothFrame, &Air, Option<&Wind>, &StepPlan)>,
    shared: Res<Shared<Wind>>,
    tick: Res<ClothTick>,
) {
    for (mut particles, topology, frame, air, wind, plan) in &mut cloths {
        if plan.substeps > 0 && !tick.still {
            // Velocities are those in the world, along the axes of the cloth's frame: how that moves does not matter.
            let wind = frame.pose.rotation.conjugate() * wind.unwrap_or(&shared).0;
            air.blow(&topology.0, &mut particles, tick.dt, |_| wind);
        }
    }
}

/// Takes the memory of the air's forces off a cloth that has no [`Air`] any more.
pub(crate) fn on_air_removed(removed: On<Remove, Air>, mut cloths: Query<&mut Particles>) {
    if let Ok(mut particles) = cloths.get_mut(removed.entity) {
        particles.force = None;
    }
}
