//! Particles as structure of arrays.
//!
//! Every array has one entry per *slot*. A slot is a particle or padding. Padding has mass 0 and inverse mass 0,
//! stands where a neighbouring particle stands, and lets every kernel read and write eight slots at a time:
//!
//! ```text
//! grid of 5 columns, stride 8                     mesh of 11 particles
//! row 0   p0 p1 p2 p3 p4  -  -  -                 p0 p1 p2 p3 p4 p5 p6 p7
//! row 1   p8 p9 …                                 p8 p9 p10 -  -  -  -  -
//! tail    16 more                                 tail    16 more
//! ```

use glam::Vec3;

use crate::Topology;
use crate::forces::Airflow;
use crate::topology::Change;

/// Three coordinates, each in its own array.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soa3 {
    /// First coordinates.
    pub x: Vec<f32>,
    /// Second coordinates.
    pub y: Vec<f32>,
    /// Third coordinates.
    pub z: Vec<f32>,
}

impl Soa3 {
    /// `len` times zero.
    pub fn zeros(len: usize) -> Self {
        Self { x: vec![0.0; len], y: vec![0.0; len], z: vec![0.0; len] }
    }

    /// From a slice of vectors.
    pub fn from_slice(points: &[Vec3]) -> Self {
        Self {
            x: points.iter().map(|p| p.x).collect(),
            y: points.iter().map(|p| p.y).collect(),
            z: points.iter().map(|p| p.z).collect(),
        }
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Entry `i`.
    ///
    /// # Panics
    /// If `i` is not below [`Self::len`].
    #[inline]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Sets entry `i`.
    ///
    /// # Panics
    /// If `i` is not below [`Self::len`].
    #[inline]
    pub fn set(&mut self, i: usize, value: Vec3) {
        self.x[i] = value.x;
        self.y[i] = value.y;
        self.z[i] = value.z;
    }

    /// Copies all entries of `other`, which has the same length, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }

    /// Sets every entry to `value`.
    pub fn fill(&mut self, value: Vec3) {
        self.x.fill(value.x);
        self.y.fill(value.y);
        self.z.fill(value.z);
    }

    /// Takes over new entries, each between its parents.
    pub fn follow(&mut self, change: &Change) {
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(change.slots, 0.0);
            for born in &change.born {
                axis[born.slot as usize] = born.blend(|slot| axis[slot]);
            }
        }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        // A sum of x·0 is 0 for finite x and NaN otherwise, and vectorises, which a loop with an exit does not.
        [&self.x, &self.y, &self.z].iter().all(|v| v.iter().map(|x| x * 0.0).sum::<f32>() == 0.0)
    }
}

/// The mass that each touched particle has after `change`: what its corners of triangles had before. A triangle that was
/// divided shares its mass among its parts by their area.
fn shared_mass(mass: &[f32], before: &Topology, now: &Topology, change: &Change) -> Vec<f32> {
    let mut shared = vec![0.0_f64; change.slots];
    let mut origin: Vec<u32> = (0..change.slots as u32).collect();
    for born in change.born.iter().filter(|born| born.parents[0] == born.parents[1]) {
        origin[born.slot as usize] = origin[born.parents[0] as usize];
    }
    let density = |slot: u32| f64::from(mass[slot as usize]) / f64::from(before.area[slot as usize]);
    for (triangle, corners) in now.triangles.iter().enumerate() {
        if !corners.iter().any(|slot| change.touched[*slot as usize]) {
            continue;
        }
        let source = change.triangles[triangle];
        let (old, old_areas) = (before.triangles[source as usize], before.corner_areas(source).map(f64::from));
        let areas = now.corner_areas(triangle as u32).map(f64::from);
        let is_whole = corners.map(|slot| origin[slot as usize]) == old;
        let old_mass: f64 = old.iter().zip(old_areas).map(|(slot, area)| density(*slot) * area).sum();
        let mean = old_mass / old_areas.iter().sum::<f64>();
        for i in 0..3 {
            let part = if is_whole { density(old[i]) * old_areas[i] } else { mean * areas[i] };
            shared[corners[i] as usize] += part;
        }
    }
    shared.into_iter().map(|mass| mass as f32).collect()
}

/// The state of motion of one cloth, in the cloth's own frame.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// Where each particle is, m; within a substep where it was at its start.
    pub position: Soa3,
    /// How far each particle moves in the substep at hand, m: predicted by its first part, corrected by the second; the third
    /// adds it to [`Particles::position`] and takes the velocity from it. Kept apart, so that the
    /// velocity has the precision of a small number and not that of the difference of two large ones.
    pub moved: Soa3,
    /// Where each particle was at the start of the last finished substep, m.
    pub previous: Soa3,
    /// Velocity, m/s.
    pub velocity: Soa3,
    /// Mass, kg; 0 for padding.
    pub mass: Vec<f32>,
    /// 1/mass, 1/kg; 0 for padding and for pinned particles. What a hand holds has its inertia, too.
    pub inverse_mass: Vec<f32>,
    /// Acceleration all particles share in this tick (gravity), m/s².
    pub acceleration: Vec3,
    /// Further force on each particle in this tick, N. `None` costs nothing.
    pub force: Option<Soa3>,
    /// The air at each particle, and its force. `None` costs nothing.
    pub airflow: Option<Airflow>,
}

impl Particles {
    /// At rest, at the rest positions of `topology`, with the mass of `areal_density` (kg/m²).
    pub fn new(topology: &Topology, areal_density: f32) -> Self {
        let mass: Vec<f32> = topology.area.iter().map(|a| a * areal_density).collect();
        Self {
            position: Soa3::from_slice(&topology.rest),
            moved: Soa3::zeros(topology.rest.len()),
            previous: Soa3::from_slice(&topology.rest),
            velocity: Soa3::zeros(topology.rest.len()),
            inverse_mass: mass.iter().map(|m| if *m > 0.0 { 1.0 / m } else { 0.0 }).collect(),
            mass,
            acceleration: Vec3::ZERO,
            force: None,
            airflow: None,
        }
    }

    /// Number of slots, padding included.
    pub fn slots(&self) -> usize {
        self.mass.len()
    }

    /// Adds a force (N) on particle `slot` for this tick.
    ///
    /// # Panics
    /// If `slot` is not below [`Self::slots`].
    pub fn add_force(&mut self, slot: usize, force: Vec3) {
        let len = self.slots();
        let all = self.force.get_or_insert_with(|| Soa3::zeros(len));
        all.set(slot, all.get(slot) + force);
    }

    /// Hangs a further `mass` (kg, 0..=1e6) on particle `slot`.
    ///
    /// # Errors
    /// A slot that is no particle, or a mass out of range; then nothing changes.
    pub fn add_mass(&mut self, slot: usize, mass: f32) -> Result<(), crate::ClothError> {
        crate::ClothError::check("weight", mass, 0.0..=1e6, "0..=1,000,000 kg")?;
        if self.mass.get(slot).is_none_or(|m| *m <= 0.0) {
            let particles = self.mass.iter().filter(|m| **m > 0.0).count();
            return Err(crate::ClothError::NoSuchParticle { field: "weight", particle: slot as u32, particles });
        }
        self.mass[slot] += mass;
        if self.inverse_mass[slot] > 0.0 {
            self.inverse_mass[slot] = 1.0 / self.mass[slot];
        }
        Ok(())
    }

    /// Takes over what taking the cloth apart did: from `before` it became `now` by `change`. New particles stand and move
    /// between their parents; the mass of every triangle stays in it.
    pub fn follow(&mut self, before: &Topology, now: &Topology, change: &Change) {
        let mass = shared_mass(&self.mass, before, now, change);
        for all in [&mut self.position, &mut self.moved, &mut self.previous, &mut self.velocity] {
            all.follow(change);
        }
        if let Some(force) = &mut self.force {
            force.follow(change);
        }
        for numbers in [&mut self.inverse_mass, &mut self.mass] {
            numbers.resize(change.slots, 0.0);
        }
        for slot in (0..change.slots).filter(|slot| change.touched[*slot]) {
            let m = mass[slot];
            self.mass[slot] = m;
            self.inverse_mass[slot] = if m > 0.0 { 1.0 / m } else { 0.0 };
            if m <= 0.0 {
                self.velocity.set(slot, Vec3::ZERO);
            }
        }
    }

    /// Whether positions and velocities are all finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite()
    }
}
