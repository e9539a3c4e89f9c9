//! What is around all cloths: the clock, the wind, fans, colliders, and which cloths step together.

use core::time::Duration;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

use crate::ClothClock;
use crate::air::SharedWind;
use crate::groups::Groups;
use crate::prepare::{Colliders, SavedCollider, WindSources};

/// What is around all cloths.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Around {
    elapsed: Duration,
    delta: Duration,
    /// What the clock has taken in and made no tick of yet.
    accumulated: Duration,
    wind: SharedWind,
    sources: WindSources,
    colliders: Vec<SavedCollider>,
    groups: Groups,
}

impl Around {
    pub fn take(world: &World) -> Self {
        let clock = world.get_resource::<Time<ClothClock>>().copied().unwrap_or_default();
        Self {
            elapsed: clock.elapsed(),
            delta: clock.delta(),
            accumulated: clock.context().accumulated(),
            wind: world.get_resource::<SharedWind>().cloned().unwrap_or_default(),
            sources: world.get_resource::<WindSources>().cloned().unwrap_or_default(),
            colliders: world.get_resource::<Colliders>().map_or_else(Vec::new, |colliders| colliders.save(world)),
            groups: world.get_resource::<Groups>().cloned().unwrap_or_default(),
        }
    }

    /// Puts all of it back but the groups.
    pub fn restore(&self, world: &mut World) {
        if let Some(mut clock) = world.get_resource_mut::<Time<ClothClock>>() {
            let mut context = *clock.context();
            context.set_accumulated(self.accumulated);
            let mut now = Time::new_with(context);
            now.advance_by(self.elapsed.saturating_sub(self.delta));
            now.advance_by(self.delta);
            *clock = now;
        }
        world.insert_resource(self.wind.clone());
        world.insert_resource(self.sources.clone());
        Colliders::restore(world, &self.colliders);
    }

    /// Puts back which cloths step together. These are there already.
    pub fn restore_groups(&self, world: &mut World) {
        let groups = self.groups.clone().linked(world);
        world.insert_resource(groups);
    }

    pub fn map_entities(&mut self, mapper: &mut impl EntityMapper) {
        self.sources.map_entities(mapper);
        self.colliders.iter_mut().for_each(|collider| collider.map_entities(mapper));
        self.groups.map_entities(mapper);
    }
}
