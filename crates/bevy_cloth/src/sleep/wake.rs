//! Waking: the look at what could move a cloth that is asleep.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::Particles;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::Contacts;

use super::{ClothAsleep, ClothSleep, Disturbances, WakeCause};
use crate::air::{SharedWind, Surroundings, Wind};
use crate::cloth::{ClothFrame, ClothHistory, ClothTopology};
use crate::damage::{Flammable, Tearable};
use crate::events::{ClothWoke, WakeCloth};
use crate::freedom::Freedom;
use crate::particle_pins::ParticlePins;
use crate::pins::Pins;
use crate::prepare::{Anchors, Colliders, Placement, Placements, StepPlan, WindSources, differs_in_scale};
use crate::report::report_now;
use crate::settings::{Grabs, Gravity, Shared, Substeps};
use crate::step::ClothTick;
use crate::teleport::Teleport;
use crate::weights::Weights;
use crate::{Air, Fabric, Gusts, Method, SelfContact};

/// A cloth that is asleep.
#[derive(QueryData)]
pub(crate) struct Asleep {
    entity: Entity,
    asleep: &'static ClothAsleep,
    frame: &'static ClothFrame,
    anchors: &'static Anchors,
    particles: Ref<'static, Particles>,
    constraints: Ref<'static, Constraints>,
    transform: Option<&'static Transform>,
    is_child: Has<ChildOf>,
}

/// Wakes the cloths that something could move in this tick.
pub(crate) fn wake(
    asleep: Query<Asleep>,
    bodies: Query<(&ClothTopology, &Contacts)>,
    mut airy: Query<(&mut Surroundings, Option<&ClothSleep>), (With<Air>, With<ClothAsleep>)>,
    placements: Placements,
    disturbances: Res<Disturbances>,
    (colliders, winds): (Res<Colliders>, Res<WindSources>),
    (wind, settings): (Res<SharedWind>, Res<Shared<ClothSleep>>),
    mut commands: Commands,
) {
    // A collider that moves may let out a wind that it kept off.
    let winds_changed = winds.changed || (!winds.fans.is_empty() && !disturbances.is_empty());
    for cloth in &asleep {
        let entity = cloth.entity;
        let is_near = || {
            let Ok((topology, contacts)) = bodies.get(entity) else { return false };
            disturbances.reach(&cloth.frame.pose, cloth.asleep.bounds, topology, &cloth.particles, contacts)
        };
        let mut is_blown = || {
            let Ok((mut around, own)) = airy.get_mut(entity) else { return false };
            let limit = own.unwrap_or(&settings).wind;
            !around.is_below(limit, &cloth.particles.position, &wind, &winds, &colliders, cloth.frame)
        };
        let cause = if cloth.has_moved(&placements) {
            WakeCause::Frame
        } else if cloth.is_written() {
            WakeCause::Particles
        } else if !disturbances.is_empty() && is_near() {
            WakeCause::Collider
        } else if winds_changed && is_blown() {
            WakeCause::Wind
        } else {
            continue;
        };
        wake_up(&mut commands, entity, cause);
    }
}

impl AsleepItem<'_, '_> {
    /// Whether its entity or one that its pins hang on is elsewhere.
    fn has_moved(&self, placements: &Placements) -> bool {
        let now = match self.transform {
            Some(transform) if !self.is_child => Some(Placement::of(transform)),
            Some(_) => placements.get(self.entity),
            None => None,
        };
        now.is_some_and(|now| now.pose != self.frame.pose || differs_in_scale(now.scale, self.frame.scale))
            || (self.asleep.has_anchors && self.anchors.have_moved(placements))
    }

    /// Whether someone wrote to its state.
    fn is_written(&self) -> bool {
        [self.particles.last_changed(), self.constraints.last_changed()] != self.asleep.written
    }
}

/// Wakes the cloths that a system pushed between [`ClothSystems::Prepare`](crate::ClothSystems::Prepare) and the first substep.
pub(crate) fn wake_pushed(
    mut asleep: Query<(Asleep, &mut StepPlan, &mut Contacts, Option<&Substeps>, Option<&Fabric>)>,
    shared: Res<Shared<Substeps>>,
    colliders: Res<Colliders>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    if tick.still {
        return;
    }
    for (cloth, mut plan, mut contacts, substeps, fabric) in &mut asleep {
        if cloth.is_written() {
            let friction = fabric.copied().unwrap_or_default().friction;
            contacts.set_colliders(colliders.seen_by(cloth.frame, friction));
            plan.plan_substeps(substeps.unwrap_or(&shared));
            wake_up(&mut commands, cloth.entity, WakeCause::Particles);
        }
    }
}

/// Wakes a cloth if it is asleep once the present system is done.
pub(crate) fn wake_up(commands: &mut Commands, entity: Entity, cause: WakeCause) {
    commands.queue(move |world: &mut World| {
        let Ok(mut cloth) = world.get_entity_mut(entity) else { return };
        if cloth.take::<ClothAsleep>().is_some() {
            report_now(world, ClothWoke { entity, cause });
        }
    });
}

/// Answers [`WakeCloth`].
pub(crate) fn on_asked(asked: On<WakeCloth>, mut commands: Commands) {
    wake_up(&mut commands, asked.entity, WakeCause::Request);
}

/// What a sleeping cloth wakes without. Changes are noticed where they are taken over.
type Removed = (
    (Fabric, Pins, ParticlePins, Weights, Gravity, Substeps, Method, Teleport, ClothSleep, Grabs),
    (Tearable, Flammable, Air, Wind, Gusts, SelfContact, Freedom),
    (Particles, Constraints, Contacts, ClothTopology, ClothFrame, ClothHistory),
);

/// Wakes a cloth that lost a component.
pub(crate) fn on_removed(removed: On<Remove, Removed>, asleep: Query<(), With<ClothAsleep>>, mut commands: Commands) {
    if asleep.contains(removed.entity) {
        wake_up(&mut commands, removed.entity, WakeCause::Change);
    }
}
