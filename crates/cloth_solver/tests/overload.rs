//! Loads beyond what the most substeps resolve: a hand that pulls as hard as it can at a scrap of light fabric.

mod common;

use std::sync::Arc;

use cloth_solver::constraint::{Grab, Pin, Pins};
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Motion, Topology, measure};
use common::*;
use glam::{Vec2, Vec3};

/// A scrap of `fabric` of 2 × 2.5 cm, as an irregular mesh, held by its upper corners.
fn scrap(fabric: &Fabric, cells: [u32; 2]) -> Cloth {
    let size = Vec2::new(0.02, 0.025);
    let (positions, triangles) = irregular(size, cells);
    let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
    let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), fabric).unwrap();
    let corner = |x: Vec3| x.y > 0.0124 && x.x.abs() > 0.0099;
    let held = cloth.topology.particles().filter(|p| corner(cloth.topology.rest[*p as usize]));
    let pins = held.map(|particle| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] });
    let pins = Pins { frames: vec![Motion::default()], pins: pins.collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
    cloth
}

#[test]
fn a_scrap_of_mesh_pulled_with_all_strength_is_no_faster_than_the_hand_makes_it() {
    for fabric in [Fabric::VOILE, Fabric::SILK_CHARMEUSE] {
        for across in [Vec3::X, Vec3::Z, Vec3::new(8.4, 0.3, 1.2)] {
            let mut cloth = scrap(&fabric, [1, 2]);
            run(&mut cloth, 0.2);
            let lowest = |corners: &&[u32; 3]| {
                let heights = corners.map(|slot| cloth.topology.rest[slot as usize].y);
                (1e6 * (heights[0] + heights[1] + heights[2])) as i64
            };
            let particles = *cloth.topology.triangles.iter().min_by_key(lowest).unwrap();
            let start = particles.iter().map(|p| cloth.particles.position.get(*p as usize) / 3.0).sum::<Vec3>();
            let speed = 8.0;
            let mut fastest = 0.0_f32;
            for tick in 0..2_u32 {
                let at = |tick: u32| start + across.normalize() * (speed * TICK.dt * tick as f32);
                let weights = [1.0 / 3.0; 3];
                let (from, to) = (at(tick), at(tick + 1));
                cloth.constraints.grabs =
                    vec![Grab { particles, weights, from, to, stiffness: 200.0, max_force: 40.0 }];
                cloth.step(TICK, GRAVITY);
                let speeds = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).length());
                fastest = speeds.fold(fastest, f32::max);
            }
            let strain = measure::largest_strain(&cloth.topology, &cloth.particles);
            assert!(strain > 1.0, "the hand is to stretch it beyond what the substeps resolve, not by {strain}");
            assert!(fastest < 3.0 * speed, "{fastest} m/s with a hand of {speed} m/s");
        }
    }
}
