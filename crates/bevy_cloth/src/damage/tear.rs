//! Tearing: by load where a cloth is tearable, and by order.

use bevy::prelude::*;
use cloth_solver::ClothError;
use cloth_solver::damage::{Direction, Tear, Tearing, tear_at};

use super::apply::Whole;
use crate::cloth::ClothRejection;
use crate::events::ClothTorn;
use crate::prepare::{ClothSkin, StepPlan};
use crate::report::report;
use crate::sleep::ClothAsleep;
use crate::step::ClothTick;
use crate::{ClothTopology, Fabric};

/// Lets a cloth tear where its threads carry more than they can.
///
/// The limit is the fabric's [`strength`](Fabric::strength), times the painted strength of the mesh
/// ([`ATTRIBUTE_STRENGTH`](super::ATTRIBUTE_STRENGTH)), less what is charred, times [`Tearable::scale`]. Without this
/// component nothing is watched. A piece that has fallen some 8,000 edges from the cloth's frame tears no further.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Tearable {
    /// Factor on the fabric's strength, dimensionless; above 0, up to 1000. Default 0.02: a real fabric is 20 to 200 times
    /// too strong for a hand that drags a game's curtain.
    pub scale: f32,
    /// Most particles that part in a tick, 1 to 1000. Default 4.
    pub splits: u32,
    /// Factor on the strength of the particles that a crack points at, until it has passed, 0 to 1. Default 0.35: a tear
    /// runs on where it has begun, and a hand tears a flap rather than a scrap out of a curtain.
    pub weakening: f32,
    /// Factor on the strength of what lies within [`reach`](Self::reach) of a pin, as a heading tape or an eyelet strengthens
    /// it: else all that a hook holds would hang on the few threads that end at one particle; above 0, up to 1000. Default 5.
    pub reinforcement: f32,
    /// How far from a pin, at rest and over the cloth, it is reinforced, m; 0 to 1000. Default 0.1. At 0 the pinned particle
    /// itself is, and nothing else.
    pub reach: f32,
    /// A piece with fewer triangles, held by nothing, is debris. Default 8; 0 for none.
    pub debris: u32,
    /// For how long debris stays, s; 0 to 1,000,000. Default 5.
    pub debris_lifetime: f32,
}

impl Default for Tearable {
    fn default() -> Self {
        let Tearing { splits, weakening, reinforcement, reach, .. } = Tearing::at(1.0);
        Self { scale: 0.02, splits, weakening, reinforcement, reach, debris: 8, debris_lifetime: 5.0 }
    }
}

impl Tearable {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Tearable::scale", self.scale, f32::MIN_POSITIVE..=1e3, "above 0, up to 1000")?;
        ClothError::check("Tearable::splits", self.splits as f32, 1.0..=1000.0, "1..=1000")?;
        ClothError::check("Tearable::weakening", self.weakening, 0.0..=1.0, "0..=1")?;
        let field = "Tearable::reinforcement";
        ClothError::check(field, self.reinforcement, f32::MIN_POSITIVE..=1e3, "above 0, up to 1000")?;
        ClothError::check("Tearable::reach", self.reach, 0.0..=1e3, "0..=1000 m")?;
        ClothError::check("Tearable::debris_lifetime", self.debris_lifetime, 0.0..=1e6, "0..=1,000,000 s")
    }
}

impl Tearable {
    /// When cloth of `fabric` tears.
    pub(crate) fn of(&self, fabric: &Fabric) -> Tearing {
        let Self { scale, splits, weakening, reinforcement, reach, .. } = *self;
        Tearing { strength: fabric.strength * scale, splits, weakening, reinforcement, reach }
    }
}

/// What is known of the loads of a tearable cloth.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct TearState(pub Tear);

impl TearState {
    fn new(topology: &ClothTopology, skin: &ClothSkin) -> Self {
        let mut painted = Vec::new();
        if skin.0.strength.len() == topology.vertex_particle.len() {
            painted.resize(topology.slots(), 1.0);
            for (slot, strength) in topology.vertex_particle.iter().zip(&skin.0.strength) {
                painted[*slot as usize] = strength.clamp(0.0, 1.0);
            }
        }
        Self(Tear::new(topology, painted))
    }
}

/// Watches the loads of tearable cloths, and parts what is overloaded.
pub(crate) fn tear(
    mut cloths: Query<(Whole, &Tearable, Option<&Fabric>, &StepPlan), (Without<ClothRejection>, Without<ClothAsleep>)>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for (mut cloth, tearable, fabric, plan) in &mut cloths {
        if plan.substeps == 0 || tick.still {
            continue;
        }
        let slots = cloth.topology.slots();
        let Some(state) = cloth.tear.as_mut().filter(|state| state.0.slots() == slots) else {
            let state = TearState::new(&cloth.topology, &cloth.skin);
            commands.entity(cloth.entity).try_insert(state);
            continue;
        };
        state.0.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, tick.dt);
        let tearing = tearable.of(&fabric.copied().unwrap_or_default());
        let (mut now, pins) = (cloth.topology.0.clone(), &cloth.constraints.pins().pins);
        let charred = cloth.fire.as_ref().map_or(&[][..], |fire| fire.strength());
        let Some(torn) = state.0.tear(&mut now, pins, &tearing, charred) else { continue };
        let places: Vec<Vec3> = torn.splits.iter().map(|split| cloth.place(split.particle)).collect();
        cloth.become_(now, &torn.change, &mut commands);
        for (split, position) in torn.splits.iter().zip(places) {
            let overload = split.overload;
            report(&mut commands, ClothTorn { entity: cloth.entity, particle: split.particle, position, overload });
        }
    }
}

/// Trigger this to part a cloth at the particle nearest to a point, tearable or not: the crack is one or two edges long. Works
/// while the clock is paused. Where nothing can be parted, at the end of a thread, nothing happens.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct TearCloth {
    /// The cloth.
    pub entity: Entity,
    /// Near which point of the world, m.
    pub position: Vec3,
    /// Which way it is pulled: the crack runs across.
    pub pull: Direction,
}

/// Answers [`TearCloth`].
pub(crate) fn on_tear(asked: On<TearCloth>, mut cloths: Query<Whole>, mut commands: Commands) {
    let Ok(mut cloth) = cloths.get_mut(asked.entity) else { return };
    let local = cloth.frame.to_local(asked.position);
    let distance = |slot: &u32| cloth.particles.position.get(*slot as usize).distance_squared(local);
    let nearest = cloth.topology.particles().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let mut now = cloth.topology.0.clone();
    let torn = nearest.and_then(|particle| Some((particle, tear_at(&mut now, particle, asked.pull)?)));
    let Some((particle, change)) = torn else { return };
    let position = cloth.place(particle);
    cloth.become_(now, &change, &mut commands);
    report(&mut commands, ClothTorn { entity: cloth.entity, particle, position, overload: 0.0 });
}

/// Takes the memory of loads off a cloth that is no longer tearable.
pub(crate) fn on_removed(removed: On<Remove, Tearable>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<TearState>();
}
