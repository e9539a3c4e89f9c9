//! What the threads carry.

use crate::topology::Along;

/// Tension along one direction at each slot: the sum over the links there, and the sum of their weights; the mean is in N/m.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Sum of the tensions.
    pub tension: Vec<f32>,
    /// Sum of the weights.
    pub weight: Vec<f32>,
}

/// Tension along weft and warp at each slot.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Tensions {
    weft: Sums,
    warp: Sums,
}

impl Tensions {
    /// Along weft and along warp.
    pub fn along(&self) -> [&Sums; 2] {
        [&self.weft, &self.warp]
    }

    pub(super) fn clear(&mut self, slots: usize) {
        for numbers in [&mut self.weft, &mut self.warp].into_iter().flat_map(|of| [&mut of.tension, &mut of.weight]) {
            numbers.clear();
            numbers.resize(slots, 0.0);
        }
    }

    /// Adds `tension` with `weight` to a slot.
    pub(super) fn add(&mut self, along: Along, slot: u32, tension: f32, weight: f32) {
        let of = self.of(along);
        of.tension[slot as usize] += tension;
        of.weight[slot as usize] += weight;
    }

    pub(super) fn of(&mut self, along: Along) -> &mut Sums {
        match along {
            Along::Weft => &mut self.weft,
            Along::Warp => &mut self.warp,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::constraint::{Pin, Pins};
    use crate::topology::curvature::tests::irregular;
    use crate::{Cloth, Fabric, Motion, Tick};

    #[test]
    fn the_mean_tension_of_an_irregular_mesh_is_what_it_is_pulled_with() {
        let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };
        let mut cloth = Cloth::new(irregular(12).into(), &fabric).expect("a cloth");
        let topology = cloth.topology.clone();
        let rest = |slot: u32| topology.rest[slot as usize];
        let row = |y: f32| topology.particles().filter(move |slot| (rest(*slot).y - y).abs() < 1e-4);
        let pin = |particle: u32| Pin { particle, frame: 0, local: rest(particle) };
        let pins = Pins { frames: vec![Motion::default()], pins: row(1.0).map(pin).collect() };
        cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles");
        let tick = Tick::new(1.0 / 60.0);
        for _ in 0..240 {
            cloth.particles.force = None;
            for slot in row(0.0) {
                let width = if (0.01..0.99).contains(&rest(slot).x) { 1.0 } else { 0.5 } / 12.0;
                cloth.particles.add_force(slot as usize, Vec3::NEG_Y * (200.0 * width));
            }
            cloth.step(tick, Vec3::ZERO);
        }
        let mut found = Tensions::default();
        cloth.constraints.tensions(&topology, &cloth.particles, &mut found);
        let warp = found.along()[1];
        let inner = topology.particles().filter(|slot| rest(*slot).cmpgt(Vec3::splat(0.2)).bitmask() & 3 == 3);
        let inner: Vec<u32> = inner.filter(|slot| rest(*slot).truncate().max_element() < 0.8).collect();
        let mean = inner.iter().map(|slot| warp.tension[*slot as usize] / warp.weight[*slot as usize]).sum::<f32>()
            / inner.len() as f32;
        assert!((mean / 200.0 - 1.0).abs() < 0.03, "{mean} N/m");
    }
}
