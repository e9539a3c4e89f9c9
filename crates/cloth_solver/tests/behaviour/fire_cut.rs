//! Cloth that is cut and torn while it burns, or after.

use crate::common::damage::{blade, both};
use crate::common::*;
use cloth_solver::constraint::Wear;
use cloth_solver::damage::fire::Surroundings;
use cloth_solver::{Fabric, Fire, Flammable};
use glam::Vec3;

#[test]
fn what_heat_has_shrunk_stays_as_small_when_it_is_cut() {
    for mut cloth in both(8, 8) {
        let slots = cloth.topology.slots();
        cloth.constraints.wear(Some(Wear { stiffness: &vec![0.5; slots], rest: &vec![0.9; slots] }));
        for slot in 0..slots {
            let x = 0.9 * cloth.topology.rest[slot];
            cloth.particles.position.set(slot, x);
            cloth.particles.previous.set(slot, x);
        }
        for _ in 0..10 {
            cloth.step(TICK, Vec3::ZERO);
        }
        assert!(fastest(&cloth) < 0.01, "{} m/s before the cut", fastest(&cloth));
        cloth.cut(&blade([-0.3, 0.02], [0.3, 0.05])).expect("a slit");
        for _ in 0..10 {
            cloth.step(TICK, Vec3::ZERO);
            assert!(fastest(&cloth) < 0.01, "{} m/s after the cut", fastest(&cloth));
        }
    }
}

#[test]
fn a_particle_keeps_at_least_its_char_however_often_burning_cloth_is_cut() {
    for mut cloth in both(12, 12) {
        let fabric = Fabric::COTTON_POPLIN;
        let mut fire = Fire::new(&cloth.topology, &fabric, &Flammable::default()).unwrap();
        fire.ignite(&cloth.particles, Vec3::new(0.0, -0.4, 0.0), 0.2).unwrap();
        let mut lightest = f32::MAX;
        for tick in 0..480 {
            if tick % 30 == 0 {
                let (from, to) = ([-0.6, -0.55 + 0.002 * tick as f32], [0.6, -0.5 + 0.002 * tick as f32]);
                if let Some(cut) = cloth.cut(&blade(from, to)) {
                    fire.follow(&cloth.topology, &cut.change);
                }
            }
            cloth.burn(&mut fire, &Surroundings::default(), TICK.dt).unwrap();
            for slot in cloth.topology.particles().map(|slot| slot as usize) {
                lightest =
                    lightest.min(cloth.particles.mass[slot] / (cloth.topology.area[slot] * fabric.areal_density));
            }
        }
        // A twentieth is what fire leaves at least; of that a twentieth where a triangle burnt on one side only was cut.
        assert!(lightest < 0.5 && lightest > 0.05 * 0.05, "{lightest} of the mass of sound cloth");
    }
}
