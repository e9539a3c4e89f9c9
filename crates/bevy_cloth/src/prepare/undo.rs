//! Takes the simulation off an entity that is no cloth, or no collider, any more.

use bevy::prelude::*;
use cloth_solver::Particles;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::rest::Rest;

use super::{Anchors, Armature, Authored, ClothSkin, ColliderState, DrawnMesh, StepPlan, TakenSkin};
use crate::air::Surroundings;
use crate::cloth::{Cloth, ClothFrame, ClothHistory, ClothMended, ClothRejection, ClothTopology};
use crate::collider::ClothCollider;
use crate::contact::Touching;
use crate::damage::{ClothFire, ClothPieces, TearState};
use crate::particle_pins::ParticlePins;
use crate::self_contact::Tangled;
use crate::settings::Grabs;
use crate::shown::ShownShape;
use crate::sleep::ClothAsleep;
use crate::weights::Loads;

/// Everything the plugin puts on a cloth's entity.
type Runtime = (
    (ClothTopology, ClothSkin, ClothFrame, ClothHistory, ClothRejection, DrawnMesh, ShownShape, Grabs, ParticlePins),
    (Particles, Constraints, Contacts, Anchors, Authored, StepPlan, Loads, Surroundings, Armature),
    (ClothPieces, TearState, ClothFire, Rest, ClothAsleep, Touching, SelfContacts, Tangled, ClothMended),
);

/// Leaves nothing behind when a [`Cloth`] is removed, and gives the entity back its mesh.
///
/// Queued, because an entity that is being despawned runs this too and is gone by then.
pub(crate) fn on_cloth_removed(removed: On<Remove, Cloth>, mut commands: Commands) {
    let entity = removed.entity;
    commands.queue(move |world: &mut World| {
        let Ok(mut entity) = world.get_entity_mut(entity) else { return };
        #[cfg(feature = "render")]
        crate::render::undraw(&mut entity);
        #[cfg(feature = "picking")]
        crate::picking::forget(&mut entity);
        TakenSkin::give_back(&mut entity);
        entity.remove::<Runtime>();
    });
}

/// Forgets where a collider was, so that one made later from the same entity starts at rest.
pub(crate) fn on_collider_removed(removed: On<Remove, ClothCollider>, mut commands: Commands) {
    let entity = removed.entity;
    commands.queue(move |world: &mut World| {
        if let Ok(mut entity) = world.get_entity_mut(entity) {
            entity.remove::<ColliderState>();
        }
    });
}
