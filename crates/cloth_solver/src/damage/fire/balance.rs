//! The heat balance of each particle over a tick, eight at a time.
//!
//! `σ c dT/dt = q − h (T − T_air) − 2 ε σ_SB (T⁴ − T_air⁴) − L dw/dt`, per area of cloth. What a flame touches takes
//! its net flux q and loses nothing to the air; beyond ignition q falls with the distance to the flame's temperature,
//! so that nothing gets hotter than the flame. Losses are implicit. Both together are stable at any tick.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};

use super::state::State;
use super::{BURNT, COLD, FLAME_TEMPERATURE, Flammability};
use crate::lanes::{LANES, load, splat, store};

/// Boiling point of water, K.
pub(super) const BOILING: f32 = 373.15;

/// Latent heat of evaporation, J/kg.
pub(super) const LATENT_HEAT: f32 = 2.26e6;

/// Free convection from both faces to the air, W/(m²·K).
const CONVECTION: f32 = 20.0;

/// 2 ε σ_SB, W/(m²·K⁴), of two faces of emissivity 0.9.
const RADIATION: f32 = 2.0 * 0.9 * 5.670_374e-8;

/// What reaches the particles from flames, one entry per slot.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Exposure {
    /// Part of the cell that flames reach, 0..=1.
    pub reach: Vec<f32>,
    /// Time for which the full flux is owed since before this tick, s.
    pub owed: Vec<f32>,
    /// Part of the full flux that drives the front of the fire through the cell, 0..=1; 0 where no front is. It goes on
    /// though the flame behind it has burnt out: in truth the flame is in the cell.
    pub front: Vec<f32>,
    /// How much of the cell the front has crossed, 0..=1.
    pub crossed: Vec<f32>,
    /// 1 where it was in flames at the last tick.
    pub flaming: Vec<f32>,
    /// How long ago what has just burst into flame did so, s.
    pub late: Vec<f32>,
}

impl Exposure {
    pub fn new(slots: usize) -> Self {
        let zeros = || vec![0.0; slots];
        Self { reach: zeros(), owed: zeros(), front: zeros(), crossed: zeros(), flaming: zeros(), late: zeros() }
    }
}

/// What the tick did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    /// Whether anything is warmer than the air or will be.
    pub warm: bool,
    /// Whether any particle has burnt out.
    pub burnt_out: bool,
    /// Number of particles in flames, and one of them.
    pub flaming: usize,
    pub flame: Option<u32>,
    /// Whether any is in flames, or a front is on its way.
    pub burning: bool,
}

/// The fabric and the tick, as the balance needs them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance {
    /// Heat capacity σ c, J/(m²·K).
    pub capacity: f32,
    pub fabric: Flammability,
    /// Fuel that a burning particle loses in the tick, and one whose char glows.
    pub burns: f32,
    pub glows: f32,
    /// Temperature of the air, K.
    pub air: f32,
    pub dt: f32,
}

impl Balance {
    pub fn new(fabric: &Flammability, areal_density: f32, air: f32, dt: f32) -> Self {
        Self {
            capacity: areal_density * fabric.specific_heat,
            burns: dt * fabric.mass_loss_rate / (areal_density * (1.0 - fabric.char)),
            glows: if fabric.afterglow > 0.0 { dt * BURNT / fabric.afterglow } else { BURNT },
            fabric: *fabric,
            air,
            dt,
        }
    }

    /// Advances every particle by the tick; what bursts into flame is added to [`State::ignited`].
    #[inline(always)]
    pub fn advance<S: Simd>(&self, simd: S, state: &mut State, exposure: &mut Exposure) -> Outcome {
        let zero = splat(simd, 0.0);
        let mut outcome = Outcome::default();
        for i in (0..state.temperature.len() / LANES * LANES).step_by(LANES) {
            let t = load(simd, &state.temperature, i);
            let touched = load(simd, &exposure.reach, i).max(load(simd, &exposure.front, i));
            let warm = (t - splat(simd, self.air)).abs().simd_gt(splat(simd, COLD)) | touched.simd_gt(zero);
            if !warm.any_true() {
                continue;
            }
            outcome.warm = true;
            let fuel = load(simd, &state.fuel, i);
            let (heated, lit) = self.heat(simd, state, exposure, i);
            store(heated, &mut state.temperature, i);
            let left = self.consume(simd, state, i, heated, load(simd, &exposure.crossed, i));
            let limit = splat(simd, BURNT);
            let flaming = load(simd, &exposure.flaming, i).simd_gt(zero).to_bitmask();
            if flaming != 0 {
                outcome.flaming += flaming.count_ones() as usize;
                outcome.flame = Some(i as u32 + flaming.trailing_zeros());
            }
            outcome.burning |= flaming != 0 || load(simd, &exposure.front, i).simd_gt(zero).any_true();
            outcome.burnt_out |= (fuel.simd_gt(limit) & left.simd_le(limit)).any_true();
            if lit.simd_gt(zero).any_true() {
                let slots = (i..i + LANES).filter(|slot| lit[slot - i] > 0.0);
                state.ignited.extend(slots.map(|slot| slot as u32));
            }
        }
        outcome
    }

    /// The temperatures after the tick, and 1 where flames have burst out.
    #[inline(always)]
    fn heat<S: Simd>(&self, simd: S, state: &mut State, exposure: &mut Exposure, i: usize) -> (f32x8<S>, f32x8<S>) {
        let (zero, one, dt) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, self.dt));
        let (ignition, air) = (splat(simd, self.fabric.ignition), splat(simd, self.air));
        let (t, fuel) = (load(simd, &state.temperature, i), load(simd, &state.fuel, i));
        let wet = load(simd, &state.moisture, i);
        let burnt = splat(simd, BURNT);
        let combustible = fuel.simd_gt(burnt);
        let was_flaming = combustible & t.simd_ge(ignition);
        let touched = was_flaming.select(one, load(simd, &exposure.reach, i));
        let mass = load(simd, &state.mass_factor, i);
        let capacity = mass * splat(simd, self.capacity);
        let flux = splat(simd, self.fabric.heat_flux) / capacity;

        let rise = flux * (touched * dt + load(simd, &exposure.owed, i));
        let latent = splat(simd, LATENT_HEAT);
        let boils = (t + rise - splat(simd, BOILING)).max(zero) * capacity / latent;
        let steam = boils.min(wet);
        store(wet - steam, &mut state.moisture, i);
        let dry = t + rise - steam * latent / capacity;

        let start = t.max(ignition);
        let tiny = splat(simd, f32::MIN_POSITIVE);
        let range = splat(simd, FLAME_TEMPERATURE - self.fabric.ignition);
        let beyond = (dry - start) / range;
        let limited = start + (splat(simd, FLAME_TEMPERATURE) - start) * beyond / (one + beyond);
        let heated = dry.simd_gt(start).select(limited, dry);

        let glows = fuel.simd_gt(zero) & fuel.simd_le(burnt) & t.simd_ge(splat(simd, self.fabric.decomposition));
        let radiated = splat(simd, RADIATION) * (t * t + air * air) * (t + air);
        let lost = (radiated + splat(simd, CONVECTION)) * dt / capacity;
        let loses = (touched.simd_gt(zero) | glows).select(zero, lost);
        let after = air + (heated - air) / (one + loses);

        // A front crosses what is dry and does not burn yet.
        let open = combustible & t.simd_lt(ignition) & wet.simd_le(zero);
        let front = open.select(load(simd, &exposure.front, i), zero);
        let (arrived, ago) = self.cross(simd, exposure, i, front, flux);
        let since = arrived.select(ago, (dry - start).max(zero) / (flux * touched).max(tiny));
        let after = arrived.select(after.max(ignition), after);
        let flaming = (combustible & after.simd_ge(ignition)).select(one, zero);
        let lit = (flaming - load(simd, &exposure.flaming, i)).max(zero);
        store(flaming, &mut exposure.flaming, i);
        store(zero, &mut exposure.owed, i);
        store(since, &mut exposure.late, i);
        (after, lit)
    }

    /// Moves the fronts on that a part `front` of the `flux` (K/s) drives: which of them have crossed their cells, and
    /// how long ago, s.
    #[inline(always)]
    fn cross<S: Simd>(
        &self,
        simd: S,
        exposure: &mut Exposure,
        i: usize,
        front: f32x8<S>,
        flux: f32x8<S>,
    ) -> (mask32x8<S>, f32x8<S>) {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let speed = flux * front / splat(simd, self.fabric.ignition - self.air);
        let there = front.simd_gt(zero);
        let crossed = load(simd, &exposure.crossed, i) + speed * splat(simd, self.dt);
        store(front, &mut exposure.front, i);
        store(there.select(crossed, zero), &mut exposure.crossed, i);
        (there & crossed.simd_ge(one), (crossed - one) / speed.max(splat(simd, f32::MIN_POSITIVE)))
    }

    /// Burns what is hot enough, scorches it, also by a front that has `crossed` a part of the cell, tells what
    /// follows, and returns the fuel that is left.
    #[inline(always)]
    fn consume<S: Simd>(&self, simd: S, state: &mut State, i: usize, t: f32x8<S>, crossed: f32x8<S>) -> f32x8<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let fuel = load(simd, &state.fuel, i);
        let rate = fuel.simd_gt(splat(simd, BURNT)).select(splat(simd, self.burns), splat(simd, self.glows));
        let hot = t.simd_ge(splat(simd, self.fabric.decomposition));
        let left = hot.select((fuel - rate).max(zero), fuel);
        let near = (t - splat(simd, BOILING)) / splat(simd, self.fabric.decomposition - BOILING);
        let scorch = load(simd, &state.scorch, i).max(near.max(crossed).min(one));
        store(left, &mut state.fuel, i);
        store(scorch, &mut state.scorch, i);
        state.tell(simd, i, self.fabric.char, self.fabric.shrinkage);
        left
    }
}
