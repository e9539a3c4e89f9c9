//! When a cloth has come to rest, so that it need not be advanced any more.

use crate::{Particles, Soa3};

/// What counts as rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestLimits {
    /// Every particle moves slower than this from tick to tick, m/s.
    pub speed: f32,
    /// For so long, s.
    pub time: f32,
}

/// Watches whether a cloth comes to rest: whether for some time all its particles have been slow and it has lost kinetic energy.
///
/// What counts is how far particles get in a tick, not their velocities. What is pulled against a solid has one at the end of each substep
/// and gets nowhere: one contact takes it from a particle, and another, of an edge beside it, gives it back.
///
/// Slow alone is not enough: a sheet that begins to topple is slow as well, but gains energy, and one that drifts keeps it.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component))]
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rest {
    /// For how long all particles have been slow, s.
    slow: f32,
    /// Kinetic energy of what they moved in the tick when that began, J.
    energy: f64,
}

/// What is left of the energy, at most, of a cloth that comes to rest.
const FALLEN: f64 = 0.9;

/// Energy that belongs to speeds below this share of [`RestLimits::speed`] is noise: it need not fall, only not grow.
const NOISE: f64 = 1.0 / 30.0;

/// By how little sums of times may fall short, s.
const ROUNDING: f32 = 1e-4;

impl Rest {
    /// The cloth is moved by something: it is watched from the beginning again.
    pub fn disturb(&mut self) {
        *self = Self::default();
    }

    /// Takes note of the particles after a tick of `dt` s that nothing disturbed and that began where they were `before`. Whether they
    /// are at rest.
    pub fn watch(&mut self, particles: &Particles, before: &Soa3, limits: &RestLimits, dt: f32) -> bool {
        if !is_still(&particles.position, before, limits.speed * dt) {
            self.disturb();
            return false;
        }
        let energy = energy_of_way(particles, before) / f64::from(dt).powi(2);
        if self.slow == 0.0 {
            self.energy = energy;
        }
        self.slow += dt;
        if self.slow < limits.time - ROUNDING {
            return false;
        }
        let mass: f64 = particles.mass.iter().map(|mass| f64::from(*mass)).sum();
        let noise = 0.5 * mass * (NOISE * f64::from(limits.speed)).powi(2);
        let fell = energy <= if energy <= noise { self.energy } else { FALLEN * self.energy };
        if !fell {
            (self.slow, self.energy) = (dt, energy);
        }
        fell
    }
}

/// Whether no particle gets as far as `limit` (m) from where it was `before`. One whose place is no number does, and so does one more
/// or less.
pub fn is_still(now: &Soa3, before: &Soa3, limit: f32) -> bool {
    let axes = now.x.iter().zip(&before.x).zip(now.y.iter().zip(&before.y)).zip(now.z.iter().zip(&before.z));
    let squares = axes.map(|(((x, a), (y, b)), (z, c))| {
        let (x, y, z) = (x - a, y - b, z - c);
        (x * x + y * y + z * z).to_bits()
    });
    now.len() == before.len() && squares.fold(0, u32::max) < (limit * limit).to_bits()
}

/// Half of mass times square of the way, summed over all particles, kg·m².
fn energy_of_way(particles: &Particles, before: &Soa3) -> f64 {
    let now = &particles.position;
    let of = |slot: usize| f64::from(particles.mass[slot] * now.get(slot).distance_squared(before.get(slot)));
    0.5 * (0..particles.mass.len()).map(of).sum::<f64>()
}

/// Whether every vector is shorter than `limit`. One that is no number is not.
pub fn is_below(vectors: &Soa3, limit: f32) -> bool {
    let Soa3 { x, y, z } = vectors;
    // Of what is not negative the bits are in the order of the numbers, NaN last; and a maximum of integers becomes vector code.
    let squares = x.iter().zip(y).zip(z).map(|((x, y), z)| (x * x + y * y + z * z).to_bits());
    squares.fold(0, u32::max) < (limit * limit).to_bits()
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2, Vec3};

    use super::*;
    use crate::Topology;
    use crate::topology::Resolution;

    const LIMITS: RestLimits = RestLimits { speed: 0.03, time: 0.5 };
    const DT: f32 = 1.0 / 64.0;

    /// After how many ticks a sheet is at rest that moves at `speed(t)`.
    fn ticks_to_rest(speed: impl Fn(f32) -> f32) -> Option<u32> {
        let topology = Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(3))).unwrap();
        let mut particles = Particles::new(&topology, 0.1);
        let mut rest = Rest::default();
        (1..640).find(|tick| {
            let before = particles.position.clone();
            for slot in 0..before.len() {
                particles.position.set(slot, before.get(slot) + Vec3::Z * (speed(*tick as f32 * DT) * DT));
            }
            rest.watch(&particles, &before, &LIMITS, DT)
        })
    }

    #[test]
    fn what_stands_still_is_at_rest_after_the_time() {
        assert_eq!(ticks_to_rest(|_| 0.0), Some(32));
    }

    #[test]
    fn what_slows_down_is_at_rest_once_it_was_slow_for_the_time() {
        let ticks = ticks_to_rest(|t| 0.5 * (-2.0 * t).exp()).unwrap();
        let slow = (0.5_f32 / 0.03).ln() / 2.0 * 64.0;
        assert!((ticks as f32 - slow - 32.0).abs() < 2.0, "{ticks} ticks, {slow} of them fast");
    }

    #[test]
    fn what_gains_speed_is_not_at_rest_however_slow_it_is() {
        assert_eq!(ticks_to_rest(|t| 1e-9 * (1.5 * t).exp()), None);
    }

    #[test]
    fn what_drifts_is_not_at_rest() {
        assert_eq!(ticks_to_rest(|_| 0.02), None);
    }

    #[test]
    fn what_is_fast_or_no_number_is_not_at_rest() {
        assert_eq!(ticks_to_rest(|_| 0.031), None);
        assert_eq!(ticks_to_rest(|t| if t > 0.3 { f32::NAN } else { 0.0 }), None);
        assert_eq!(ticks_to_rest(|t| if t > 0.3 { f32::INFINITY } else { 0.0 }), None);
    }

    #[test]
    fn a_swing_that_is_fast_on_its_way_is_not_at_rest_where_it_turns() {
        assert_eq!(ticks_to_rest(|t| 0.1 * (3.0 * t).sin()), None);
    }
}
