//! A copy of a running cloth that steps itself, apart from the world.

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::damage::{Tear, Tearing};
use cloth_solver::{Cloth as SolverCloth, Particles, Tick};

use crate::air::Surroundings;
use crate::cloth::{ClothFrame, ClothRejection, ClothTopology};
use crate::damage::{TearState, Tearable};
use crate::prepare::StepPlan;
use crate::settings::{Gravity, Shared, Substeps};
use crate::{Air, Fabric};

/// A copy of a running cloth that steps itself, apart from the world: to try something on another thread.
///
/// It holds the cloth as it is now, with its pins, hands, solids and wind. They do not move on, and other cloths are not there. Fire is
/// left out. To go back to an earlier state, or for a saved game, take [`SavedCloths`](crate::SavedCloths).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::*;
/// # fn try_it(world: &World, cloth: Entity) {
/// let Some(mut copy) = ClothSnapshot::take(world, cloth) else { return };
/// (0..60).for_each(|_| copy.cloth.step(copy.tick, copy.gravity));
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct ClothSnapshot {
    /// The cloth.
    pub cloth: SolverCloth,
    /// What it is made of.
    pub fabric: Fabric,
    /// Gravity in its frame, m/s².
    pub gravity: Vec3,
    /// A tick, as the plugin would take it.
    pub tick: Tick,
    /// What is known of its loads, and when it tears; `None` if it does not tear.
    pub tearing: Option<(Tear, Tearing)>,
}

impl ClothSnapshot {
    /// Copies the cloth `entity`. `None` if it is no cloth, does not run yet or was refused.
    pub fn take(world: &World, entity: Entity) -> Option<Self> {
        let cloth = world.get_entity(entity).ok().filter(|cloth| !cloth.contains::<ClothRejection>())?;
        let fabric = cloth.get::<Fabric>().copied().unwrap_or_default();
        let around = cloth.get::<Surroundings>();
        let copy = SolverCloth {
            topology: cloth.get::<ClothTopology>()?.0.clone(),
            particles: cloth.get::<Particles>()?.clone(),
            constraints: cloth.get::<Constraints>()?.clone(),
            contacts: cloth.get::<Contacts>()?.clone(),
            self_contacts: cloth.get::<SelfContacts>().cloned(),
            air: around.and(cloth.get::<Air>()).copied(),
            wind: around.map(Surroundings::field).cloned().unwrap_or_default(),
            pace: cloth.get::<StepPlan>()?.pace(),
        };
        let frame = cloth.get::<ClothFrame>()?;
        let gravity = cloth.get::<Gravity>().or_else(|| Some(&world.get_resource::<Shared<Gravity>>()?.0))?.0;
        let budget = cloth.get::<Substeps>().or_else(|| Some(&world.get_resource::<Shared<Substeps>>()?.0))?;
        let dt = world.get_resource::<Time<Fixed>>().copied().unwrap_or_default().timestep().as_secs_f32();
        let (substeps, iterations) = (budget.count, budget.iterations);
        let tearing = cloth.get::<Tearable>().zip(cloth.get::<TearState>());
        Some(Self {
            gravity: frame.pose.rotation.conjugate() * gravity,
            tick: Tick { dt, substeps, most: budget.max.max(substeps), iterations },
            tearing: tearing.map(|(tearable, state)| (state.0.clone(), tearable.of(&fabric))),
            cloth: copy,
            fabric,
        })
    }
}
