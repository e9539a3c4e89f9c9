//! Falling asleep: which cloth has come to rest with nothing about that could move it.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::rest::{Rest, RestLimits, is_below, is_still};
use cloth_solver::{Particles, measure};

use super::{ClothAsleep, ClothSleep, Disturbances};
use crate::cloth::{ClothFrame, ClothHistory, ClothTopology};
use crate::damage::{ClothFire, ClothPieces, Tearable};
use crate::events::ClothFellAsleep;
use crate::prepare::{Anchors, Authored, StepPlan};
use crate::report::report;
use crate::settings::Shared;
use crate::step::ClothTick;

/// A cloth that is awake.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Awake {
    entity: Entity,
    rest: &'static mut Rest,
    topology: &'static ClothTopology,
    frame: &'static ClothFrame,
    anchors: &'static Anchors,
    particles: &'static mut Particles,
    constraints: Ref<'static, Constraints>,
    contacts: &'static Contacts,
    history: &'static mut ClothHistory,
    plan: &'static mut StepPlan,
    authored: &'static Authored,
    sleep: Option<&'static ClothSleep>,
    own: Option<&'static SelfContacts>,
    fire: Option<&'static ClothFire>,
    pieces: Option<&'static ClothPieces>,
    tearable: Option<&'static Tearable>,
}

/// Watches the cloths that moved in this tick, and lets those fall asleep that have come to rest.
pub(crate) fn fall_asleep(
    mut cloths: Query<Awake, Without<ClothAsleep>>,
    shared: Res<Shared<ClothSleep>>,
    disturbances: Res<Disturbances>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    if tick.still {
        return;
    }
    let mut restless: Vec<usize> = Vec::new();
    for mut cloth in &mut cloths {
        cloth.plan.at_rest = false;
        if cloth.plan.substeps == 0 {
            continue;
        }
        let settings = cloth.sleep.unwrap_or(&shared);
        let limits = RestLimits { speed: settings.speed, time: settings.time };
        if !settings.enabled
            || cloth.is_driven(settings.wind)
            || cloth.is_disturbed(limits.speed * tick.dt, &disturbances)
        {
            cloth.rest.disturb();
        } else {
            cloth.plan.at_rest = cloth.rest.watch(&cloth.particles, &cloth.history.position, &limits, tick.dt);
        }
        if !cloth.plan.at_rest {
            restless.extend(cloth.plan.group);
        }
    }
    // What steps together falls asleep together.
    for mut cloth in &mut cloths {
        if cloth.plan.at_rest && !cloth.plan.group.is_some_and(|group| restless.contains(&group)) {
            let (entity, asleep) = (cloth.entity, cloth.stand_still());
            commands.entity(entity).try_insert(asleep);
            report(&mut commands, ClothFellAsleep { entity });
        }
    }
}

impl AwakeItem<'_, '_> {
    /// Whether something moves it, or is about to: hands, forces, fire, what it hangs on, air faster than `wind` (m/s), a solid that it
    /// leaves, a tangle that
    /// is undone, a mesh that it waits for, or the end of debris.
    fn is_driven(&self, wind: f32) -> bool {
        let frame = &self.frame;
        !self.constraints.grabs.is_empty()
            || frame.lost
            || self.authored.stale
            || frame.pose != frame.before
            || frame.pose != frame.follow.target
            || self.constraints.pins().frames.iter().any(|motion| motion.from != motion.to)
            || self.particles.force.as_ref().is_some_and(|force| !is_below(force, f32::MIN_POSITIVE))
            || self.fire.is_some_and(|fire| fire.is_warm())
            || self.own.is_some_and(|own| own.tangled() > 0)
            || self.constraints.bodies().iter().any(|body| body.push.touched && body.is_movable())
            || self.contacts.is_leaving()
            || self.has_debris()
            || self.particles.airflow.as_ref().is_some_and(|air| !is_below(&air.velocity, wind))
    }

    /// Whether a piece of it is to be taken out in some time.
    fn has_debris(&self) -> bool {
        let (Some(pieces), Some(tearable)) = (self.pieces, self.tearable) else { return false };
        pieces.pieces.iter().any(|piece| !piece.pinned && piece.triangles < tearable.debris)
    }

    /// Whether a collider that moves may touch it. Of no interest for a cloth that moves by `far` (m) and more in a tick.
    fn is_disturbed(&self, far: f32, disturbances: &Disturbances) -> bool {
        if disturbances.is_empty() || !is_still(&self.particles.position, &self.history.position, far) {
            return false;
        }
        let bounds = measure::bounds(self.topology, &self.particles.position);
        disturbances.reach(&self.frame.pose, bounds, self.topology, &self.particles, self.contacts)
    }

    /// Takes all speed off it. Drawn between two ticks it stands still, too.
    fn stand_still(&mut self) -> ClothAsleep {
        let particles = &mut *self.particles;
        particles.velocity.fill(Vec3::ZERO);
        particles.previous.copy_from(&particles.position);
        self.history.position.copy_from(&particles.position);
        self.rest.disturb();
        self.plan.substeps = 0;
        ClothAsleep {
            bounds: measure::bounds(self.topology, &self.particles.position),
            has_anchors: self.anchors.follow_entities(),
            written: [self.particles.last_changed(), self.constraints.last_changed()],
        }
    }
}
