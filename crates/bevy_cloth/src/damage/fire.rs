//! Fire on cloth that is [`Flammable`]: lit and put out by order, told, and taken over into mass, stiffness and triangles.

use bevy::prelude::*;
use cloth_solver::cloth::Constraints;
use cloth_solver::damage;
use cloth_solver::damage::fire::{Fire, Flammable, Surroundings};

use super::apply::Whole;
use crate::Fabric;
use crate::air::{self, Wind};
use crate::cloth::ClothRejection;
use crate::events::{ClothBurntOut, ClothBurntThrough, ClothExtinguished, ClothIgnited};
use crate::prepare::StepPlan;
use crate::report::report;
use crate::settings::Shared;
use crate::sleep::{ClothAsleep, WakeCause, wake_up};
use crate::step::ClothTick;

/// The fire of a running cloth that is [`Flammable`]. Read-only: temperature, fuel and char of each particle.
#[derive(Component, Clone, Debug, Deref)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct ClothFire {
    #[deref]
    fire: Fire,
    /// Number of slots it was made for or has followed.
    slots: usize,
    /// Whether the cloth is made of something else since the last tick.
    renewed: bool,
    /// Velocity of the hot gas, cloth frame, m/s.
    stream: Vec3,
    /// Whether it was burning a tick ago.
    burning: bool,
    /// Whether anything was ever scorched.
    pub(crate) scarred: bool,
}

impl ClothFire {
    fn new(fire: Fire) -> Self {
        let slots = fire.fuel().len();
        Self { fire, slots, renewed: false, stream: Vec3::ZERO, burning: false, scarred: false }
    }

    /// Velocity of the hot gas above the flames, in the cloth's frame, m/s: up, and with the wind.
    pub fn stream(&self) -> Vec3 {
        self.stream
    }

    /// Takes over what was torn or cut.
    pub(crate) fn follow(&mut self, now: &cloth_solver::Topology, change: &cloth_solver::topology::Change) {
        self.fire.follow(now, change);
        self.slots = change.slots;
    }

    /// Takes note that the cloth was given its full mass and stiffness again.
    pub(crate) fn renew(&mut self) {
        self.fire.forget_toll();
        self.renewed = true;
    }

    /// Lets mass and stiffness of the cloth be what the fire left of them.
    pub(crate) fn take_toll(
        &mut self,
        topology: &cloth_solver::Topology,
        particles: &mut cloth_solver::Particles,
        constraints: &mut Constraints,
    ) {
        if self.scarred {
            self.fire.take_toll(topology, particles, constraints);
        }
    }
}

/// Trigger this to hold a match to a cloth that is [`Flammable`]: what is dry within `radius` lights. Told by
/// [`ClothIgnited`]. Works while the clock is paused.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct IgniteCloth {
    /// The cloth.
    pub entity: Entity,
    /// Where, in the world, m.
    pub position: Vec3,
    /// How far the match reaches, m; 0 to 10,000. The nearest particle lights in any case.
    pub radius: f32,
}

/// Trigger this to pour water on a cloth that is [`Flammable`]: it goes out there, and does not light until it is dry.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct WetCloth {
    /// The cloth.
    pub entity: Entity,
    /// Where, in the world, m.
    pub position: Vec3,
    /// How far the water spreads, m; 0 to 10,000.
    pub radius: f32,
    /// Water, kg/m²; 0 to 100. Cotton soaks up about 0.3.
    pub water: f32,
}

/// Burns what is alight.
pub(crate) fn burn(
    mut cloths: Query<
        (Whole, Ref<Flammable>, Option<Ref<Fabric>>, Option<&Wind>, Option<&air::Surroundings>, &StepPlan),
        (Without<ClothRejection>, Without<ClothAsleep>),
    >,
    shared: Res<Shared<Wind>>,
    tick: Res<ClothTick>,
    mut commands: Commands,
) {
    for (mut cloth, flammable, fabric, own_wind, around, plan) in &mut cloths {
        if plan.substeps == 0 || tick.still {
            continue;
        }
        let slots = cloth.topology.slots();
        let is_changed = flammable.is_changed() || fabric.as_ref().is_some_and(|fabric| fabric.is_changed());
        let fabric = fabric.map_or_else(Fabric::default, |fabric| *fabric);
        let Some(fire) = cloth.fire.as_mut().filter(|fire| fire.slots == slots) else {
            // Both were checked, or the cloth would be rejected.
            if let Ok(fire) = Fire::new(&cloth.topology, &fabric, &flammable) {
                commands.entity(cloth.entity).try_insert(ClothFire::new(fire));
            }
            continue;
        };
        if is_changed && fire.fire.set(&cloth.topology, &fabric, &flammable).is_err() {
            continue;
        }
        let renewed = core::mem::take(&mut fire.renewed);
        if !fire.is_warm() {
            if renewed || is_changed {
                cloth.take_toll();
            }
            cloth.tell_flames(&mut commands);
            continue;
        }
        let gravity = cloth.particles.acceleration;
        let centre = cloth_solver::measure::centre_of_mass(&cloth.particles).as_vec3();
        let wind = match around {
            Some(around) => around.wind_at(centre),
            None => cloth.frame.pose.rotation.conjugate() * own_wind.unwrap_or(&shared).0,
        };
        let surroundings = Surroundings { wind, up: -gravity, ..default() };
        fire.stream = surroundings.stream();
        if let Err(error) = fire.fire.burn(&cloth.topology, &cloth.particles, &surroundings, tick.dt) {
            error!("the fire on cloth {} stands still: {error}", cloth.entity);
            continue;
        }
        fire.scarred = true;
        cloth.take_toll();
        cloth.burn_through(&mut commands);
        cloth.tell_flames(&mut commands);
    }
}

impl super::apply::WholeItem<'_, '_> {
    /// Lets mass and stiffness be what the fire left of them.
    fn take_toll(&mut self) {
        if let Some(fire) = &mut self.fire {
            fire.take_toll(&self.topology, &mut self.particles, &mut self.constraints);
        }
    }

    /// Tells when the first flame breaks out and when the last goes out.
    fn tell_flames(&mut self, commands: &mut Commands) {
        let Some(fire) = &mut self.fire else { return };
        let burns = fire.is_burning();
        let (Some(particle), true) = (fire.flame(), burns != fire.burning) else { return };
        fire.burning = burns;
        let (entity, is_left) = (self.entity, fire.has_fuel());
        let position = self.place(particle);
        match (burns, is_left) {
            (true, _) => report(commands, ClothIgnited { entity, particle, position }),
            (false, true) => report(commands, ClothExtinguished { entity, particle, position }),
            (false, false) => report(commands, ClothBurntOut { entity, particle, position }),
        }
    }

    /// Takes out what is burnt through.
    fn burn_through(&mut self, commands: &mut Commands) {
        let Some(fire) = &self.fire else { return };
        let gone = fire.burnt_through().to_vec();
        let Some(first) = gone.first() else { return };
        let particle = self.topology.triangles[*first as usize][0];
        let position = self.place(particle);
        let mut now = self.topology.0.clone();
        let Some(change) = damage::remove(&mut now, &gone) else { return };
        self.become_(now, &change, commands);
        let triangles = gone.len() as u32;
        report(commands, ClothBurntThrough { entity: self.entity, particle, position, triangles });
    }
}

/// Answers [`IgniteCloth`].
pub(crate) fn on_ignite(
    asked: On<IgniteCloth>,
    mut cloths: Query<(Whole, &Flammable, Option<&Fabric>)>,
    mut commands: Commands,
) {
    let Ok((mut cloth, flammable, fabric)) = cloths.get_mut(asked.entity) else { return };
    wake_up(&mut commands, asked.entity, WakeCause::Particles);
    let local = cloth.frame.to_local(asked.position);
    let light = |fire: &mut ClothFire, particles: &cloth_solver::Particles, topology: &cloth_solver::Topology| {
        let lit = fire.fire.ignite(particles, local, asked.radius)?;
        let distance = |slot: &u32| particles.position.get(*slot as usize).distance_squared(local);
        match topology.particles().min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            Some(nearest) if lit == 0 => fire.fire.ignite_particle(nearest).map(|_| ()),
            _ => Ok(()),
        }
    };
    let result = match &mut cloth.fire {
        Some(fire) => light(fire, &cloth.particles, &cloth.topology),
        None => Fire::new(&cloth.topology, &fabric.copied().unwrap_or_default(), flammable).and_then(|fire| {
            let mut fire = ClothFire::new(fire);
            light(&mut fire, &cloth.particles, &cloth.topology)?;
            commands.entity(cloth.entity).try_insert(fire);
            Ok(())
        }),
    };
    if let Err(error) = result {
        warn!("cloth {} was not lit: {error}", asked.entity);
    }
}

/// Answers [`WetCloth`].
pub(crate) fn on_wet(
    asked: On<WetCloth>,
    mut cloths: Query<(Whole, &Flammable, Option<&Fabric>)>,
    mut commands: Commands,
) {
    let Ok((mut cloth, flammable, fabric)) = cloths.get_mut(asked.entity) else { return };
    wake_up(&mut commands, asked.entity, WakeCause::Particles);
    let local = cloth.frame.to_local(asked.position);
    let WetCloth { radius, water, .. } = *asked;
    let result = match &mut cloth.fire {
        Some(fire) => fire.fire.wet(&cloth.particles, local, radius, water),
        None => Fire::new(&cloth.topology, &fabric.copied().unwrap_or_default(), flammable).and_then(|mut fire| {
            fire.wet(&cloth.particles, local, radius, water)?;
            commands.entity(cloth.entity).try_insert(ClothFire::new(fire));
            Ok(())
        }),
    };
    if let Err(error) = result {
        warn!("cloth {} was not wetted: {error}", asked.entity);
    }
}

/// Puts out the fire of a cloth that is no longer flammable. What it did stays.
pub(crate) fn on_removed(removed: On<Remove, Flammable>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ClothFire>();
}
