//! The state of one cloth: the components of its entity that a tick goes on from.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::ecs::world::EntityRef;
use bevy::prelude::*;
use cloth_solver::Particles;
use cloth_solver::cloth::Constraints;
use cloth_solver::contact::{Contacts, SelfContacts};
use cloth_solver::rest::Rest;

use super::RestoreError;
use crate::air::Surroundings;
use crate::cloth::{ClothFrame, ClothHistory, ClothRejection, ClothTopology};
use crate::contact::Touching;
use crate::damage::{ClothFire, ClothPieces, TearState, Tearable};
use crate::particle_pins::ParticlePins;
use crate::pins::Pins;
use crate::prepare::{Anchors, Armature, Authored, ClothSkin, Colliders, Skin, StepPlan};
use crate::self_contact::Tangled;
use crate::sleep::ClothAsleep;
use crate::weights::{Loads, Weights};
use crate::{Air, Fabric, Flammable, Freedom, SelfContact};

/// One cloth.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct SavedCloth {
    #[cfg_attr(feature = "serialize", serde(with = "crate::save::entity"))]
    pub entity: Entity,
    authored: SavedAuthored,
    #[cfg_attr(feature = "serialize", serde(with = "shared"))]
    topology: std::sync::Arc<cloth_solver::Topology>,
    #[cfg_attr(feature = "serialize", serde(with = "shared"))]
    skin: std::sync::Arc<Skin>,
    frame: ClothFrame,
    history: ClothHistory,
    particles: Particles,
    constraints: Constraints,
    contacts: Contacts,
    /// Whether it saw colliders, whose shapes are not written.
    has_colliders: bool,
    own: Option<SelfContacts>,
    anchors: Anchors,
    /// The places of its particles on the joints of an armature.
    places: Option<Vec<cloth_solver::constraint::SkinPoint>>,
    loads: Loads,
    plan: StepPlan,
    rest: Rest,
    air: Option<Surroundings>,
    particle_pins: Option<ParticlePins>,
    pieces: Option<ClothPieces>,
    tear: Option<TearState>,
    fire: Option<ClothFire>,
    touching: Option<Touching>,
    is_tangled: bool,
    is_asleep: bool,
}

/// What was authored, to tell whether it is the same.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct SavedAuthored {
    /// Fingerprint of the rest shape before anything was torn.
    origin: u64,
    fabric: Fabric,
    pins: Option<Pins>,
    weights: Option<Weights>,
    self_contact: Option<SelfContact>,
    freedom: Option<Freedom>,
}

impl SavedCloth {
    /// Of a running cloth.
    pub fn take(cloth: EntityRef) -> Option<Self> {
        let authored = cloth.get::<Authored>().filter(|authored| !authored.stale)?;
        Some(Self {
            entity: cloth.id(),
            authored: SavedAuthored {
                origin: authored.origin,
                fabric: cloth.get::<Fabric>().copied().unwrap_or_default(),
                pins: cloth.get::<Pins>().cloned(),
                weights: cloth.get::<Weights>().cloned(),
                self_contact: cloth.get::<SelfContact>().copied(),
                freedom: cloth.get::<Freedom>().copied(),
            },
            topology: cloth.get::<ClothTopology>()?.0.clone(),
            skin: cloth.get::<ClothSkin>()?.0.clone(),
            frame: *cloth.get()?,
            history: cloth.get::<ClothHistory>()?.clone(),
            particles: cloth.get::<Particles>()?.clone(),
            constraints: cloth.get::<Constraints>()?.clone(),
            contacts: cloth.get::<Contacts>()?.clone(),
            has_colliders: !cloth.get::<Contacts>()?.colliders.is_empty(),
            own: cloth.get().cloned(),
            anchors: cloth.get::<Anchors>()?.clone(),
            places: cloth.get::<Armature>().map(|armature| armature.points.clone()),
            loads: cloth.get::<Loads>()?.clone(),
            plan: cloth.get::<StepPlan>()?.clone(),
            rest: *cloth.get()?,
            air: cloth.get().cloned(),
            particle_pins: cloth.get().cloned(),
            pieces: cloth.get().cloned(),
            tear: cloth.get().cloned(),
            fire: cloth.get().cloned(),
            touching: cloth.get().cloned(),
            is_tangled: cloth.contains::<Tangled>(),
            is_asleep: cloth.contains::<ClothAsleep>(),
        })
    }

    /// Whether it can be put back.
    pub fn check(&self, world: &World) -> Result<(), RestoreError> {
        let entity = self.entity;
        let cloth = world.get_entity(entity).map_err(|_| RestoreError::NoCloth(entity))?;
        let runs = cloth.contains::<ClothTopology>() && !cloth.contains::<ClothRejection>();
        let now = cloth.get::<Authored>().filter(|authored| runs && !authored.stale);
        let now = now.ok_or(RestoreError::NoCloth(entity))?;
        let saved = &self.authored;
        if now.origin != saved.origin {
            return Err(RestoreError::OtherShape(entity));
        }
        let same = [
            ("Fabric", cloth.get::<Fabric>().copied().unwrap_or_default() == saved.fabric),
            ("Pins", cloth.get::<Pins>() == saved.pins.as_ref()),
            ("Weights", cloth.get::<Weights>() == saved.weights.as_ref()),
            ("SelfContact", cloth.get::<SelfContact>() == saved.self_contact.as_ref()),
            ("Freedom", cloth.get::<Freedom>() == saved.freedom.as_ref()),
        ];
        match same.into_iter().find(|(_, is_same)| !is_same) {
            Some((component, _)) => Err(RestoreError::OtherComponent { entity, component }),
            None => Ok(()),
        }
    }

    /// Puts it back. It was checked.
    pub fn restore(&self, world: &mut World) {
        self.restore_pins(world);
        let mut contacts = self.contacts.clone();
        if let Some(colliders) = world.get_resource::<Colliders>().filter(|_| self.has_colliders)
            && contacts.colliders.is_empty()
        {
            let touches = std::mem::take(&mut contacts.touches);
            contacts.set_colliders(colliders.seen_by(&self.frame, self.authored.fabric.friction));
            contacts.touches = touches;
        }
        let Ok(mut cloth) = world.get_entity_mut(self.entity) else { return };
        // Before the particles are written to, or it would wake.
        cloth.remove::<ClothAsleep>();
        if cloth.get::<ClothTopology>().is_none_or(|now| !std::sync::Arc::ptr_eq(&now.0, &self.topology)) {
            cloth.insert(ClothTopology(self.topology.clone()));
        }
        let mut skin = ClothSkin(self.skin.clone());
        if let Some(now) = cloth.get::<ClothSkin>() {
            skin.take_attributes(now);
        }
        if let (Some(mut armature), Some(places)) = (cloth.get_mut::<Armature>(), &self.places) {
            armature.points.clone_from(places);
        }
        #[cfg(feature = "render")]
        let skin = skin.with_hem(&self.topology);
        cloth.insert((
            (skin, self.frame, self.history.clone(), self.particles.clone(), self.constraints.clone(), contacts),
            (self.anchors.clone(), self.loads.clone(), self.plan.clone(), self.rest),
        ));
        put(&mut cloth, self.own.as_ref());
        put(&mut cloth, self.pieces.as_ref());
        // State of what it is no more would be taken up again once it is.
        let (tears, burns, blows) =
            (cloth.contains::<Tearable>(), cloth.contains::<Flammable>(), cloth.contains::<Air>());
        put(&mut cloth, self.tear.as_ref().filter(|_| tears));
        put(&mut cloth, self.fire.as_ref().filter(|_| burns));
        put(&mut cloth, self.air.as_ref().filter(|_| blows));
        put(&mut cloth, self.is_tangled.then_some(&Tangled));
        // Taking it off would tell that contacts have ended.
        match (cloth.get_mut::<Touching>(), &self.touching) {
            (Some(mut now), saved) => *now = saved.clone().unwrap_or_default(),
            (None, Some(saved)) => {
                cloth.insert(saved.clone());
            }
            (None, None) => {}
        }
        if self.is_asleep
            && let Some(asleep) = ClothAsleep::of(&cloth)
        {
            cloth.insert(asleep);
        }
    }

    /// Puts the pins on single particles back, which the plugin writes to as much as the user does.
    fn restore_pins(&self, world: &mut World) {
        let Ok(mut cloth) = world.get_entity_mut(self.entity) else { return };
        put(&mut cloth, self.particle_pins.as_ref());
        if let Some(mut authored) = cloth.get_mut::<Authored>() {
            authored.know_particle_pins(self.particle_pins.clone());
        }
        world.flush();
    }

    pub fn map_entities(&mut self, mapper: &mut impl EntityMapper) {
        self.entity = mapper.get_mapped(self.entity);
        self.anchors.map_entities(mapper);
        if let Some(pins) = &mut self.authored.pins {
            pins.map_entities(mapper);
        }
        if let Some(pins) = &mut self.particle_pins {
            pins.map_entities(mapper);
        }
        if let Some(touching) = &mut self.touching {
            touching.map_entities(mapper);
        }
    }
}

/// Puts a component on an entity, or takes it off.
fn put<T: Component + Clone>(cloth: &mut EntityWorldMut, component: Option<&T>) {
    match component {
        Some(component) => cloth.insert(component.clone()),
        None => cloth.remove::<T>(),
    };
}

/// What others share, written as if it were not.
#[cfg(feature = "serialize")]
mod shared {
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<T: Serialize, S: Serializer>(shared: &Arc<T>, serializer: S) -> Result<S::Ok, S::Error> {
        shared.as_ref().serialize(serializer)
    }

    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<T>, D::Error> {
        T::deserialize(deserializer).map(Arc::new)
    }
}
