//! What fire has done to each particle and triangle, whatever the level.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use crate::Topology;
use crate::lanes::{load, splat, store};
use crate::topology::Change;

use super::{BURNT, COLD, ROOM_TEMPERATURE};

/// Part of its stiffness that charred cloth keeps: threads of char still hang together.
const CHAR_STIFFNESS: f32 = 0.01;

/// Part of its mass that cloth has to the last: what leaves no char is not without any before it is gone.
const LEAST_MASS: f32 = BURNT;

/// Arrays per slot, and per triangle where said.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    /// K.
    pub temperature: Vec<f32>,
    /// What can still burn, 1 → 0.
    pub fuel: Vec<f32>,
    /// Water, kg/m².
    pub moisture: Vec<f32>,
    /// How near to decomposition it has ever been, 0..=1.
    pub scorch: Vec<f32>,
    /// 1 − fuel.
    pub char: Vec<f32>,
    pub stiffness: Vec<f32>,
    pub rest_scale: Vec<f32>,
    pub mass_factor: Vec<f32>,
    /// Part of its mass that each particle was already relieved of.
    pub taken: Vec<f32>,
    /// Triangles that are still there around each particle.
    pub left: Vec<u32>,
    /// Whether each triangle is gone.
    pub through: Vec<bool>,
    /// Particles that burst into flame in the last tick.
    pub ignited: Vec<u32>,
    /// Triangles that went in the last tick.
    pub burnt_through: Vec<u32>,
    /// Number of particles in flames after the last tick.
    pub flaming: usize,
    /// Whether anything is in flames, or a front of fire is on its way.
    pub burning: bool,
    /// One of the last particles that were seen in flames.
    pub flame: Option<u32>,
    /// Temperature of the air, K.
    pub air: f32,
}

impl State {
    pub fn new(topology: &Topology) -> Self {
        let slots = topology.slots();
        let mut state = Self {
            temperature: vec![ROOM_TEMPERATURE; slots],
            fuel: vec![1.0; slots],
            moisture: vec![0.0; slots],
            scorch: vec![0.0; slots],
            char: vec![0.0; slots],
            stiffness: vec![1.0; slots],
            rest_scale: vec![1.0; slots],
            mass_factor: vec![1.0; slots],
            taken: vec![0.0; slots],
            through: vec![false; topology.triangles.len()],
            ignited: Vec::with_capacity(slots),
            burnt_through: Vec::with_capacity(topology.triangles.len()),
            left: Vec::new(),
            flaming: 0,
            burning: false,
            flame: None,
            air: ROOM_TEMPERATURE,
        };
        state.count_left(topology);
        state
    }

    /// Tells what follows from the fuel and the scorch of the eight slots from `i` on, for a fabric that leaves `char`
    /// of its mass and shrinks by `shrinkage`.
    #[inline(always)]
    pub fn tell<S: Simd>(&mut self, simd: S, i: usize, char: f32, shrinkage: f32) {
        let (one, char) = (splat(simd, 1.0), splat(simd, char));
        let (fuel, scorch) = (load(simd, &self.fuel, i), load(simd, &self.scorch, i));
        store(one - fuel, &mut self.char, i);
        store((fuel * fuel).max(splat(simd, CHAR_STIFFNESS)), &mut self.stiffness, i);
        store(one - scorch * splat(simd, shrinkage), &mut self.rest_scale, i);
        store((char + (one - char) * fuel).max(splat(simd, LEAST_MASS)), &mut self.mass_factor, i);
    }

    /// Whether `slot` is a particle that can burn: it has fuel, and cloth around it.
    pub fn combustible(&self, slot: usize) -> bool {
        self.fuel[slot] > BURNT && self.left[slot] > 0
    }

    /// Marks `triangle` as gone; `false` if it was.
    pub fn burn_through(&mut self, topology: &Topology, triangle: usize) -> bool {
        if core::mem::replace(&mut self.through[triangle], true) {
            return false;
        }
        topology.triangles[triangle].iter().for_each(|corner| self.left[*corner as usize] -= 1);
        self.burnt_through.push(triangle as u32);
        true
    }

    /// Gives what is as cold as the air was the temperature it has now, K.
    pub fn set_air(&mut self, air: f32) {
        if self.air != air {
            let cold = |t: &&mut f32| (**t - self.air).abs() <= COLD;
            self.temperature.iter_mut().filter(cold).for_each(|t| *t = air);
            self.air = air;
        }
    }

    /// Follows a change of topology.
    pub fn follow(&mut self, topology: &Topology, change: &Change) {
        let Self { temperature, fuel, moisture, scorch, char, stiffness, rest_scale, mass_factor, taken, .. } = self;
        let arrays = [(temperature, self.air), (fuel, 1.0), (moisture, 0.0), (scorch, 0.0), (char, 0.0), (taken, 0.0)];
        for (array, new) in arrays.into_iter().chain([(stiffness, 1.0), (rest_scale, 1.0), (mass_factor, 1.0)]) {
            extend(array, new, change);
        }
        for slot in change.gone.iter().map(|slot| *slot as usize) {
            (self.temperature[slot], self.fuel[slot], self.char[slot]) = (self.air, 0.0, 1.0);
        }
        self.through = change.triangles.iter().map(|before| self.through[*before as usize]).collect();
        self.ignited = Vec::with_capacity(change.slots);
        self.burnt_through = Vec::with_capacity(topology.triangles.len());
        self.count_left(topology);
    }

    fn count_left(&mut self, topology: &Topology) {
        self.left.clear();
        self.left.resize(topology.slots(), 0);
        for (triangle, through) in topology.triangles.iter().zip(&self.through) {
            triangle.iter().for_each(|corner| self.left[*corner as usize] += u32::from(!through));
        }
    }
}

/// Gives `array` the slots of `change`: what is born lies between its parents, padding is `new`.
pub(super) fn extend(array: &mut Vec<f32>, new: f32, change: &Change) {
    array.resize(change.slots, new);
    for born in &change.born {
        array[born.slot as usize] = born.blend(|parent| array[parent]);
    }
}
