//! Colliders of a saved world, and what they are in the one that it is put back into.

use bevy::ecs::entity::{EntityHashMap, EntityMapper, MapEntities};
use bevy::prelude::*;
use cloth_solver::Pose;
use cloth_solver::contact::KnownShape;

use super::collider::Placed;
use super::{ColliderState, Colliders, Follow};

/// A collider as it stood in the last tick.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct SavedCollider {
    #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))]
    entity: Entity,
    shape: KnownShape,
    from: Pose,
    to: Pose,
    friction: Option<f32>,
    /// It was another one than in the tick before.
    changed: bool,
    follow: Option<Follow>,
    /// It was changed since.
    is_changed: bool,
}

impl MapEntities for SavedCollider {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.entity = mapper.get_mapped(self.entity);
    }
}

impl Colliders {
    /// All of them, to be put back later.
    pub fn save(&self, world: &World) -> Vec<SavedCollider> {
        let save = |placed: &Placed| {
            let state = world.get::<ColliderState>(placed.entity);
            SavedCollider {
                entity: placed.entity,
                shape: placed.shape.clone().into(),
                from: placed.from,
                to: placed.to,
                friction: placed.friction,
                changed: placed.changed,
                follow: state.and_then(|state| state.follow),
                is_changed: state.is_none_or(|state| state.changed),
            }
        };
        self.0.iter().map(save).collect()
    }

    /// Puts those back that are of the same shape still. All others are as if they had come in this tick.
    pub fn restore(world: &mut World, saved: &[SavedCollider]) {
        let saved: EntityHashMap<&SavedCollider> = saved.iter().map(|saved| (saved.entity, saved)).collect();
        let mut placed = Vec::with_capacity(saved.len());
        let mut colliders = world.query::<(Entity, &mut ColliderState)>();
        for (entity, mut state) in colliders.iter_mut(world) {
            let same = saved.get(&entity).copied().and_then(|saved| {
                let shape = state.shape().filter(|shape| saved.shape.clone().meet(shape))?;
                Some((saved, shape.clone()))
            });
            let Some((saved, shape)) = same else {
                (state.follow, state.changed) = (None, true);
                continue;
            };
            (state.follow, state.changed) = (saved.follow, saved.is_changed);
            let SavedCollider { from, to, friction, changed, .. } = *saved;
            placed.push(Placed { entity, shape, from, to, friction, changed });
        }
        placed.sort_unstable_by_key(|collider| collider.entity);
        world.insert_resource(Self(placed));
    }
}
