//! Pins on single particles, made and released while a cloth runs.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::ecs::reflect::ReflectMapEntities;
use bevy::prelude::*;
use cloth_solver::{ClothError, Particles, Topology};

use crate::cloth::{ClothFrame, ClothTopology};
use crate::pins::PinTarget;
use crate::prepare::{Anchors, Placements};

/// Pins on single particles, beside those of [`Pins`](crate::Pins): each says exactly where its particle is held.
///
/// It may be inserted, changed and removed at any time, also while the clock is paused, and survives cuts, tears and a
/// change of `Pins` or fabric. Unlike `Pins` it does not survive a cloth that is rebuilt (another shape or scale) or reset
/// by [`ResetCloth`](crate::ResetCloth): then the plugin removes it. [`PinParticle`] and [`UnpinParticle`] edit it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::{ParticlePin, ParticlePins, PinTarget};
/// // Particle 40 is held at a point of the world; particle 0, which `Pins` would hold, is released.
/// let at = Vec3::new(0.2, 1.5, 0.3);
/// let pins = ParticlePins { held: vec![ParticlePin { particle: 40, to: PinTarget::World, at }], released: vec![0] };
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq, MapEntities)]
#[component(map_entities)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ParticlePins {
    /// The particles held. A particle that is held here is not held by [`Pins`](crate::Pins), and belongs to the first pin
    /// that names it. A particle that burns away is held no more.
    pub held: Vec<ParticlePin>,
    /// Particles that [`Pins`](crate::Pins) does not hold although it chooses them.
    pub released: Vec<u32>,
}

/// One particle and where it is held.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ParticlePin {
    /// The particle: an index into [`Particles`], as `ClothHit::particle` names it.
    pub particle: u32,
    /// What the pin follows.
    pub to: PinTarget,
    /// Where the particle is held, m: in the world for [`PinTarget::World`], else in the frame of the cloth or the entity
    /// (without its scale). Finite. Changing it moves the particle there at once.
    pub at: Vec3,
}

/// Trigger this to pin a particle where it is now. Works while the clock is paused.
///
/// A particle that is pinned already gets the new pin in place of the old one.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct PinParticle {
    /// The cloth. An entity that is no running cloth is left alone.
    pub entity: Entity,
    /// The particle. One that the cloth does not have is left alone.
    pub particle: u32,
    /// What the pin follows.
    pub to: PinTarget,
}

/// Trigger this to release a particle, whatever holds it: a [`ParticlePin`] is removed, and a particle held by
/// [`Pins`](crate::Pins) is added to [`ParticlePins::released`]. Works while the clock is paused.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct UnpinParticle {
    /// The cloth. An entity that is no running cloth is left alone.
    pub entity: Entity,
    /// The particle.
    pub particle: u32,
}

impl ParticlePins {
    /// Checks every pin against a cloth.
    pub(crate) fn validate(&self, topology: &Topology) -> Result<(), ClothError> {
        let particles = topology.slots();
        let known = |field, particle: u32| match (particle as usize) < particles {
            true => Ok(()),
            false => Err(ClothError::NoSuchParticle { field, particle, particles }),
        };
        for particle in &self.released {
            known("ParticlePins::released", *particle)?;
        }
        for pin in &self.held {
            known("ParticlePin::particle", pin.particle)?;
            for axis in pin.at.to_array() {
                ClothError::check("ParticlePin::at", axis, f32::MIN..=f32::MAX, "finite numbers of metres")?;
            }
        }
        Ok(())
    }
}

impl MapEntities for ParticlePins {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for pin in &mut self.held {
            if let PinTarget::Entity(entity) = &mut pin.to {
                *entity = mapper.get_mapped(*entity);
            }
        }
    }
}

/// Answers [`PinParticle`].
pub(crate) fn on_pin(
    asked: On<PinParticle>,
    cloths: Query<(&ClothFrame, &Particles), With<ClothTopology>>,
    placements: Placements,
    mut commands: Commands,
) {
    let PinParticle { entity, particle, to } = *asked;
    let Ok((frame, particles)) = cloths.get(entity) else { return };
    if particles.mass.get(particle as usize).is_none_or(|mass| *mass <= 0.0) {
        return;
    }
    let local = particles.position.get(particle as usize);
    let at = match to {
        PinTarget::Cloth => local,
        PinTarget::World => frame.to_world(local),
        PinTarget::Entity(target) => match placements.get(target) {
            Some(placement) => placement.pose.inverse_point(frame.to_world(local)),
            None => {
                warn!("particle {particle} of {entity} is not pinned: {target} has no `Transform`");
                return;
            }
        },
    };
    commands.entity(entity).entry::<ParticlePins>().or_default().and_modify(move |mut pins| {
        pins.held.retain(|pin| pin.particle != particle);
        pins.held.push(ParticlePin { particle, to, at });
    });
}

/// Answers [`UnpinParticle`].
pub(crate) fn on_unpin(asked: On<UnpinParticle>, cloths: Query<&Anchors>, mut commands: Commands) {
    let UnpinParticle { entity, particle } = *asked;
    let Ok(anchors) = cloths.get(entity) else { return };
    let is_authored = anchors.authored().iter().any(|pin| pin.particle == particle);
    commands.entity(entity).entry::<ParticlePins>().or_default().and_modify(move |mut pins| {
        pins.held.retain(|pin| pin.particle != particle);
        if is_authored && !pins.released.contains(&particle) {
            pins.released.push(particle);
        }
    });
}
