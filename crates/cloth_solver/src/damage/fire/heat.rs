//! Fire by heat: who heats whom, and when.
//!
//! The balance of every particle is advanced in each tick. Who is within whose flame is looked up in turns, an eighth
//! of the flames in a tick, and at once for what has just burst into flame: flames are many, and fire is slow.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, dispatch};
use glam::{IVec3, Vec3};

use super::balance::{BOILING, Balance, Exposure, LATENT_HEAT};
use super::cells::Cells;
use super::conduct::Laplacian;
use super::flame::Flame;
use super::rings::{Rings, Spoke};
use super::state::{State, extend};
use super::{BURNT, Flammability, Surroundings};
use crate::lanes::{LANES, LEVEL, Vec3x8, load, splat};
use crate::topology::Change;
use crate::{Fabric, Particles, Soa3, Topology};

/// Ticks in which every flame is looked up once.
const TURNS: usize = 8;

/// Rounds for which a flame that heats nothing better than others do does not look round again.
const LOOKS_AWAY: u8 = 3;

/// What a tick needs to know of the cloth and of what is around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around<'a> {
    pub topology: &'a Topology,
    pub particles: &'a Particles,
    pub rings: &'a Rings,
    pub surroundings: &'a Surroundings,
}

/// What fire by heat keeps beside [`State`].
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct Heat {
    pub fabric: Flammability,
    /// kg/m².
    areal_density: f32,
    /// m.
    thickness: f32,
    exposure: Exposure,
    /// [`Exposure::reach`] as this round of turns finds it.
    reach: Vec<f32>,
    /// Width of the cloth that each particle stands for, m.
    width: Vec<f32>,
    laplacian: Laplacian,
    /// Positions when the cells were sorted, m.
    position: Soa3,
    cells: Cells,
    /// Whether the cells are those of this round.
    is_sorted: bool,
    /// Rounds for which each flame does not look round.
    looks_away: Vec<u8>,
    turn: usize,
    /// Whether anything is warm.
    pub warm: bool,
}

impl Heat {
    pub fn new(topology: &Topology, rings: &Rings, cloth: &Fabric, fabric: &Flammability) -> Self {
        let slots = topology.slots();
        Self {
            fabric: *fabric,
            areal_density: cloth.areal_density,
            thickness: cloth.thickness,
            exposure: Exposure::new(slots),
            reach: vec![0.0; slots],
            width: widths(topology),
            laplacian: Laplacian::new(topology, rings),
            position: Soa3::zeros(slots),
            cells: Cells::new(slots),
            is_sorted: false,
            looks_away: vec![0; slots],
            turn: 0,
            warm: false,
        }
    }

    pub fn set(&mut self, cloth: &Fabric, fabric: &Flammability) {
        (self.fabric, self.areal_density, self.thickness) = (*fabric, cloth.areal_density, cloth.thickness);
    }

    /// Heats `slot` to ignition; `false` if it cannot burn, or does.
    pub fn ignite(&mut self, slot: usize, state: &mut State) -> bool {
        let lights = self.catches(slot, state) && state.moisture[slot] <= 0.0;
        if lights {
            state.temperature[slot] = self.fabric.ignition;
            self.warm = true;
        }
        lights
    }

    /// Pours `water`, kg/m², on `slot`. What is hotter than boiling water boils some of it away at once.
    pub fn wet(&mut self, slot: usize, water: f32, state: &mut State, rings: &Rings) {
        let capacity = self.capacity(slot, state);
        let steam = ((state.temperature[slot] - BOILING).max(0.0) * capacity / LATENT_HEAT).min(water);
        state.temperature[slot] -= steam * LATENT_HEAT / capacity;
        state.moisture[slot] += water - steam;
        if state.temperature[slot] < self.fabric.ignition {
            self.exposure.flaming[slot] = 0.0;
        }
        // The fronts that set out from it are under its water, too.
        for end in rings.around(slot).iter().map(|spoke| spoke.end as usize) {
            self.exposure.front[end] = 0.0;
        }
    }

    /// Follows a change of topology.
    pub fn follow(&mut self, topology: &Topology, rings: &Rings, change: &Change) {
        let Exposure { reach, owed, front, crossed, flaming, late } = &mut self.exposure;
        let arrays = [reach, owed, front, crossed, flaming, late, &mut self.reach];
        arrays.into_iter().for_each(|array| extend(array, 0.0, change));
        self.looks_away.resize(change.slots, 0);
        self.width = widths(topology);
        self.laplacian = Laplacian::new(topology, rings);
        (self.position, self.cells) = (Soa3::zeros(change.slots), Cells::new(change.slots));
        self.is_sorted = false;
    }

    /// Advances by a tick of `dt` s.
    pub fn burn(&mut self, around: &Around<'_>, state: &mut State, dt: f32) {
        if !self.warm {
            return;
        }
        let flame = Flame::new(&self.fabric, around.surroundings);
        if self.turn == 0 {
            // What the last round has not found again is no longer in any flame.
            core::mem::swap(&mut self.reach, &mut self.exposure.reach);
            self.reach.fill(0.0);
        }
        if self.turn == 0 || !self.is_sorted {
            self.sort(&flame, around.particles, state);
        }
        dispatch!(*LEVEL, simd => self.look_round(simd, &flame, around.rings, state));
        let balance = Balance::new(&self.fabric, self.areal_density, state.air, dt);
        let exposure = &mut self.exposure;
        let outcome = dispatch!(*LEVEL, simd => balance.advance(simd, state, exposure));
        (state.flaming, state.burning) = (outcome.flaming, outcome.burning);
        state.flame = outcome.flame.or(state.flame);
        dispatch!(*LEVEL, simd => self.spread(simd, &flame, around.rings, state));
        self.conduct(around.topology, state, dt);
        if outcome.burnt_out {
            burn_through(around.topology, state);
        }
        self.turn = (self.turn + 1) % TURNS;
        if !outcome.warm {
            self.rest();
        }
    }

    /// Sorts what flames may heat into cells of space.
    fn sort(&mut self, flame: &Flame, particles: &Particles, state: &State) {
        self.position.copy_from(&particles.position);
        let mut cells = core::mem::take(&mut self.cells);
        let slots = (0..state.fuel.len()).filter(|slot| self.catches(*slot, state));
        cells.build(flame.longest, slots, &self.position, &self.width);
        (self.cells, self.is_sorted) = (cells, true);
    }

    /// Looks up whom an eighth of the flames heat.
    #[inline(always)]
    fn look_round<S: Simd>(&mut self, simd: S, flame: &Flame, rings: &Rings, state: &State) {
        let slots = state.fuel.len();
        for slot in slots * self.turn / TURNS..slots * (self.turn + 1) / TURNS {
            if self.looks_away[slot] > 0 {
                self.looks_away[slot] -= 1;
            } else if self.exposure.flaming[slot] > 0.0 && !self.heat_around(simd, slot, None, flame, rings, state) {
                self.looks_away[slot] = LOOKS_AWAY;
            }
        }
    }

    /// Heats what is within the flames that have burst out in this tick.
    #[inline(always)]
    fn spread<S: Simd>(&mut self, simd: S, flame: &Flame, rings: &Rings, state: &State) {
        for slot in state.ignited.iter().map(|slot| *slot as usize) {
            self.heat_around(simd, slot, Some(self.exposure.late[slot]), flame, rings, state);
            self.looks_away[slot] = 0;
        }
    }

    /// Heats what is within the flame on `slot`; `false` if others do so better. `late` is how long ago the flame burst
    /// out, s, if it has in this tick.
    #[inline(always)]
    fn heat_around<S: Simd>(
        &mut self,
        simd: S,
        slot: usize,
        late: Option<f32>,
        flame: &Flame,
        rings: &Rings,
        state: &State,
    ) -> bool {
        let at = self.position.get(slot);
        let ring = rings.around(slot);
        let mut any = false;
        for end in ring.iter().map(|spoke| spoke.end as usize) {
            if self.catches(end, state) {
                any = true;
                let part = flame.on_neighbour(self.position.get(end) - at);
                if state.moisture[end] > 0.0 {
                    expose(&mut self.exposure, &mut self.reach, end, part, late);
                } else if late.is_some() || self.exposure.front[end] == 0.0 {
                    self.send_front(end, part, late, state);
                }
            }
        }
        self.heat_cells(simd, at, late, flame, ring) || any
    }

    /// Sends a front, driven by a part of the flux, into the cell of `slot`, which it would cross as a whole. One that
    /// is on its way is overtaken only if it would arrive later: fronts do not add up.
    fn send_front(&mut self, slot: usize, part: f32, late: Option<f32>, state: &State) {
        let heat = self.capacity(slot, state) * (self.fabric.ignition - state.air);
        let Exposure { front, crossed, .. } = &mut self.exposure;
        let left = part * (1.0 - crossed[slot]);
        if left > front[slot] {
            crossed[slot] += (left - front[slot]) * late.unwrap_or(0.0) * self.fabric.heat_flux / heat;
            front[slot] = left;
        }
    }

    /// Heats the cloth within the flame at `at`, of its `ring` what it covers.
    #[inline(always)]
    fn heat_cells<S: Simd>(&mut self, simd: S, at: Vec3, late: Option<f32>, flame: &Flame, ring: &[Spoke]) -> bool {
        let mut any = false;
        if self.cells.is_empty() {
            return any;
        }
        let low = self.cells.cell(at + flame.low - self.cells.widest);
        let high = self.cells.cell(at + flame.high + self.cells.widest);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let points = self.cells.points(IVec3::new(x, y, z));
                    any |= self.heat_points(simd, points, at, late, flame, ring);
                }
            }
        }
        any
    }

    /// Heats those of the sorted `points` that are within the flame at `at`.
    #[inline(always)]
    fn heat_points<S: Simd>(
        &mut self,
        simd: S,
        points: core::ops::Range<usize>,
        at: Vec3,
        late: Option<f32>,
        flame: &Flame,
        ring: &[Spoke],
    ) -> bool {
        let Self { cells, exposure, reach, .. } = self;
        let mut any = false;
        for i in points.clone().step_by(LANES) {
            let offset = Vec3x8::load(simd, &cells.at, i) - Vec3x8::splat(simd, at);
            let [parts, ways] = flame.on_cells(simd, offset, load(simd, &cells.cloth, i));
            if !parts.simd_gt(splat(simd, 0.0)).any_true() {
                continue;
            }
            for k in i..points.end.min(i + LANES) {
                let (part, slot) = (parts[k - i], cells.slot[k]);
                // A cell of the ring that the flame does not cover is crossed by a front.
                let beats = part > reach[slot as usize];
                if beats && (ways[k - i] < 1.0 || ring.iter().all(|spoke| spoke.end != slot)) {
                    expose(exposure, reach, slot as usize, part, late);
                    any = true;
                }
            }
        }
        any
    }

    /// Lets heat flow along an eighth of the edges, for eight ticks.
    fn conduct(&self, topology: &Topology, state: &mut State, dt: f32) {
        let edges = topology.edges.len();
        let range = edges * self.turn / TURNS..edges * (self.turn + 1) / TURNS;
        let (temperature, mass) = (&mut state.temperature, &state.mass_factor);
        let areal = self.areal_density * self.fabric.specific_heat;
        let capacity = |slot: usize| areal * mass[slot] * topology.area[slot];
        let conductance = self.fabric.conductivity * self.thickness;
        self.laplacian.flow(&topology.edges, range, conductance * dt * TURNS as f32, capacity, temperature);
    }

    /// Everything is cold again.
    fn rest(&mut self) {
        let Exposure { reach, owed, front, crossed, flaming, .. } = &mut self.exposure;
        for array in [reach, owed, front, crossed, flaming, &mut self.reach] {
            array.fill(0.0);
        }
        self.looks_away.fill(0);
        (self.turn, self.warm) = (0, false);
    }

    /// Whether a flame beside `slot` heats it until it lights.
    fn catches(&self, slot: usize, state: &State) -> bool {
        state.combustible(slot) && state.temperature[slot] < self.fabric.ignition
    }

    /// Heat capacity of the cloth at `slot`, J/(m²·K).
    fn capacity(&self, slot: usize, state: &State) -> f32 {
        self.areal_density * self.fabric.specific_heat * state.mass_factor[slot]
    }
}

/// Width of the cloth that each particle stands for, m.
fn widths(topology: &Topology) -> Vec<f32> {
    topology.area.iter().map(|area| area.sqrt()).collect()
}

/// Gives `slot` a part of the flux of a flame, in this round (`reach`) and from now on; since `late` s, if it is new.
fn expose(exposure: &mut Exposure, reach: &mut [f32], slot: usize, part: f32, late: Option<f32>) {
    exposure.owed[slot] += (part - exposure.reach[slot]).max(0.0) * late.unwrap_or(0.0);
    exposure.reach[slot] = exposure.reach[slot].max(part);
    reach[slot] = reach[slot].max(part);
}

/// Takes away the triangles whose corners have all burnt out.
fn burn_through(topology: &Topology, state: &mut State) {
    for (triangle, corners) in topology.triangles.iter().enumerate() {
        if corners.iter().all(|corner| state.fuel[*corner as usize] <= BURNT) {
            state.burn_through(topology, triangle);
        }
    }
}
