//! Fire: what lights, burns, chars and is gone.
//!
//! [`Fire`] is the state of one cloth's fire, at one of the two levels of [`Flammable`]. By itself it changes no cloth: whoever
//! owns the cloth reads what has become of each particle and triangle, and takes it over.

mod balance;
mod cells;
mod chance;
mod conduct;
mod contagion;
mod flame;
mod flammability;
mod heat;
mod rings;
mod state;
mod surroundings;
mod toll;

pub use flammability::{Contagion, Flammability, Flammable};
pub use surroundings::Surroundings;

use glam::Vec3;

use crate::topology::Change;
use crate::{ClothError, Fabric, Particles, Topology};
use contagion::Spread;
use heat::{Around, Heat};
use rings::Rings;
use state::State;

/// Temperature of a flame, K: nothing gets hotter.
pub const FLAME_TEMPERATURE: f32 = 1150.0;

/// Temperature of the air where nothing else is said, K.
pub const ROOM_TEMPERATURE: f32 = 293.15;

/// Fuel at which the flame goes out and what is left no longer holds together, a part of 1.
pub const BURNT: f32 = 0.05;

/// What is nearer than this to the temperature of the air has it, K.
const COLD: f32 = 0.5;

/// How far a particle has burnt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// As cold as the air.
    Virgin,
    /// Warmer than the air; or once burning, and out.
    Heating,
    /// In flames.
    Flaming,
    /// Burnt out, with cloth beside it that is not.
    Ember,
    /// Burnt out, and all cloth around it too.
    Gone,
}

/// The fire of one cloth.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub struct Fire {
    state: State,
    /// kg/m².
    areal_density: f32,
    rings: Rings,
    level: Level,
}

#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
enum Level {
    Heat(Box<Heat>),
    Contagion(Box<Spread>),
}

impl Fire {
    /// A cold cloth of `fabric` over `topology`.
    ///
    /// # Errors
    /// A number of `fabric` or `flammable` out of range.
    pub fn new(topology: &Topology, fabric: &Fabric, flammable: &Flammable) -> Result<Self, ClothError> {
        fabric.validate()?;
        flammable.validate()?;
        let rings = Rings::new(topology);
        Ok(Self {
            state: State::new(topology),
            areal_density: fabric.areal_density,
            level: match flammable {
                Flammable::Heat(rule) => Level::Heat(Box::new(Heat::new(topology, &rings, fabric, rule))),
                Flammable::Contagion(rule) => Level::Contagion(Box::new(Spread::new(topology, &rings, rule))),
            },
            rings,
        })
    }

    /// Changes the fabric and how it burns, also while it burns. Another level, or another seed, starts with a sound
    /// cloth.
    ///
    /// # Errors
    /// A number out of range; then nothing changes.
    pub fn set(&mut self, topology: &Topology, fabric: &Fabric, flammable: &Flammable) -> Result<(), ClothError> {
        fabric.validate()?;
        flammable.validate()?;
        self.areal_density = fabric.areal_density;
        match (&mut self.level, flammable) {
            (Level::Heat(heat), Flammable::Heat(rule)) => heat.set(fabric, rule),
            (Level::Contagion(spread), Flammable::Contagion(rule)) if spread.rule.seed == rule.seed => {
                spread.rule = *rule;
            }
            _ => {
                let taken = core::mem::take(&mut self.state.taken);
                *self = Self::new(topology, fabric, flammable)?;
                self.state.taken = taken;
            }
        }
        Ok(())
    }

    /// Sets alight what is dry and not burnt out within `radius` (m, 0..=1e4) of `centre` (cloth frame), as a match
    /// held there does; returns how many particles that are.
    ///
    /// # Errors
    /// A number that is not finite or out of range, or `particles` of another cloth; then nothing is lit.
    pub fn ignite(&mut self, particles: &Particles, centre: Vec3, radius: f32) -> Result<usize, ClothError> {
        self.check_region(particles, centre, radius)?;
        Ok(within(particles, centre, radius).filter(|slot| self.light(*slot)).count())
    }

    /// Sets the particle `slot` alight; `false` if it is wet, burnt out, or burns already.
    ///
    /// # Errors
    /// A slot that is no particle of the cloth.
    pub fn ignite_particle(&mut self, slot: u32) -> Result<bool, ClothError> {
        if self.state.left.get(slot as usize).is_none_or(|left| *left == 0) {
            let particles = self.state.left.iter().filter(|left| **left > 0).count();
            return Err(ClothError::NoSuchParticle { field: "Fire::ignite_particle", particle: slot, particles });
        }
        Ok(self.light(slot as usize))
    }

    fn light(&mut self, slot: usize) -> bool {
        match &mut self.level {
            Level::Heat(heat) => heat.ignite(slot, &mut self.state),
            Level::Contagion(spread) => spread.ignite(slot, &mut self.state, &self.rings),
        }
    }

    /// Pours `water` (kg/m², 0..=100) on the cloth within `radius` (m, 0..=1e4) of `centre` (cloth frame). By heat,
    /// what burns there goes out if the water cools it below ignition, and what is left of the water has to boil away
    /// before anything there lights. By contagion, any water puts out, and stays.
    ///
    /// # Errors
    /// A number that is not finite or out of range, or `particles` of another cloth; then nothing changes.
    pub fn wet(&mut self, particles: &Particles, centre: Vec3, radius: f32, water: f32) -> Result<(), ClothError> {
        self.check_region(particles, centre, radius)?;
        ClothError::check("Fire::wet(water)", water, 0.0..=100.0, "0..=100 kg/m²")?;
        for slot in within(particles, centre, radius).filter(|_| water > 0.0) {
            match &mut self.level {
                Level::Heat(heat) => heat.wet(slot, water, &mut self.state, &self.rings),
                Level::Contagion(spread) => spread.wet(slot, water, &mut self.state, &self.rings),
            }
        }
        Ok(())
    }

    /// Advances by a tick of `dt` s; not at all if that is not positive. A cold cloth costs nearly nothing.
    ///
    /// # Errors
    /// Surroundings out of range, or `topology` or `particles` of another cloth; then nothing changes.
    pub fn burn(
        &mut self,
        topology: &Topology,
        particles: &Particles,
        surroundings: &Surroundings,
        dt: f32,
    ) -> Result<(), ClothError> {
        surroundings.validate()?;
        self.check_slots(topology.slots())?;
        self.check_slots(particles.slots())?;
        same("triangles of the cloth", topology.triangles.len(), self.state.through.len())?;
        same("edges of the cloth", topology.edges.len(), self.rings.edges())?;
        let state = &mut self.state;
        state.ignited.clear();
        state.burnt_through.clear();
        if dt > 0.0 {
            state.set_air(surroundings.air);
            (state.flaming, state.burning) = (0, false);
            match &mut self.level {
                Level::Heat(heat) => {
                    heat.burn(&Around { topology, particles, rings: &self.rings, surroundings }, state, dt);
                }
                Level::Contagion(spread) => spread.burn(topology, &self.rings, state, dt),
            }
        }
        Ok(())
    }

    /// Follows a `change` that made `topology` of the one before: what is born has the state of its parents.
    pub fn follow(&mut self, topology: &Topology, change: &Change) {
        self.state.follow(topology, change);
        let old = core::mem::replace(&mut self.rings, Rings::new(topology));
        match &mut self.level {
            Level::Heat(heat) => heat.follow(topology, &self.rings, change),
            Level::Contagion(spread) => spread.follow(topology, &old, &self.rings, change),
        }
    }

    fn check_slots(&self, slots: usize) -> Result<(), ClothError> {
        same("slots of the cloth", slots, self.state.fuel.len())
    }

    fn check_region(&self, particles: &Particles, centre: Vec3, radius: f32) -> Result<(), ClothError> {
        self.check_slots(particles.slots())?;
        ClothError::check("centre of Fire's region", centre.length(), 0.0..=1e6, "within 1e6 m of the cloth's origin")?;
        ClothError::check("radius of Fire's region", radius, 0.0..=1e4, "0..=1e4 m")
    }
}

/// What has become of the cloth. Arrays have an entry per slot.
impl Fire {
    /// Temperature, K.
    pub fn temperature(&self) -> &[f32] {
        &self.state.temperature
    }

    /// What can still burn, 1 to 0; it never rises.
    pub fn fuel(&self) -> &[f32] {
        &self.state.fuel
    }

    /// Water in the cloth, kg/m².
    pub fn moisture(&self) -> &[f32] {
        &self.state.moisture
    }

    /// How far it is charred, 0..=1: what fuel has burnt.
    pub fn char(&self) -> &[f32] {
        &self.state.char
    }

    /// How near to decomposition the cloth has ever been, 0..=1: it browns.
    pub fn scorch(&self) -> &[f32] {
        &self.state.scorch
    }

    /// What is left of the strength, 0..=1: 1 − [`Fire::char`].
    pub fn strength(&self) -> &[f32] {
        &self.state.fuel
    }

    /// What is left of the stiffness, 0.01..=1: the square of the fuel, and of char a hundredth.
    pub fn stiffness(&self) -> &[f32] {
        &self.state.stiffness
    }

    /// Rest lengths in parts of the sound ones, 1 to 1 − [`Flammability::shrinkage`]: hot cloth shrinks, and curls
    /// where one side of a fold is hotter. It never rises.
    pub fn rest_scale(&self) -> &[f32] {
        &self.state.rest_scale
    }

    /// What is left of the mass of the dry cloth, 1 to that of its char, and 0.05 or more.
    pub fn mass_factor(&self) -> &[f32] {
        &self.state.mass_factor
    }

    /// How far the particle `slot` has burnt; [`Stage::Gone`] for a slot that is no particle.
    pub fn stage(&self, slot: u32) -> Stage {
        let slot = slot as usize;
        let state = &self.state;
        if state.left.get(slot).is_none_or(|left| *left == 0) {
            return Stage::Gone;
        }
        let ignition = match &self.level {
            Level::Heat(heat) => heat.fabric.ignition,
            Level::Contagion(_) => FLAME_TEMPERATURE,
        };
        match (state.fuel[slot] > BURNT, state.temperature[slot]) {
            (false, _) => Stage::Ember,
            (true, t) if t >= ignition => Stage::Flaming,
            (true, t) if t > state.air + COLD || state.scorch[slot] > 0.0 => Stage::Heating,
            _ => Stage::Virgin,
        }
    }

    /// Particles that burst into flame in the last tick, in no particular order.
    pub fn ignited(&self) -> &[u32] {
        &self.state.ignited
    }

    /// Triangles of the topology that the last tick took away, in ascending order. They are told once.
    pub fn burnt_through(&self) -> &[u32] {
        &self.state.burnt_through
    }

    /// Whether a tick has anything to do.
    pub fn is_warm(&self) -> bool {
        match &self.level {
            Level::Heat(heat) => heat.warm,
            Level::Contagion(spread) => spread.is_burning(),
        }
    }

    /// Number of particles in flames at the end of the last tick.
    pub fn flaming(&self) -> usize {
        self.state.flaming
    }

    /// Whether anything was in flames at the end of the last tick, or a front of fire on its way.
    pub fn is_burning(&self) -> bool {
        self.state.burning
    }

    /// A particle in flames at the end of the last tick; if there is none, one of the last that were.
    pub fn flame(&self) -> Option<u32> {
        self.state.flame
    }

    /// Whether any particle could still light.
    pub fn has_fuel(&self) -> bool {
        (0..self.state.fuel.len()).any(|slot| self.state.combustible(slot))
    }
}

/// Refuses a cloth that has another number of something than the fire was made for or has followed.
fn same(field: &'static str, found: usize, own: usize) -> Result<(), ClothError> {
    let allowed = "the number the fire was made for, or has followed";
    if found == own { Ok(()) } else { Err(ClothError::OutOfRange { field, value: found as f32, allowed }) }
}

/// The slots within `radius` of `centre`.
fn within(particles: &Particles, centre: Vec3, radius: f32) -> impl Iterator<Item = usize> + '_ {
    (0..particles.slots()).filter(move |slot| particles.position.get(*slot).distance(centre) <= radius)
}
