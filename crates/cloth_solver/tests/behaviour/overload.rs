//! Loads beyond what the most substeps resolve: a hand that pulls as hard as it can at a scrap of light fabric, a weight that would tear a
//! sheet.

use crate::common::*;
use cloth_solver::constraint::Grab;
use cloth_solver::{Cloth, Fabric, measure};
use glam::{Vec2, Vec3};

/// A scrap of `fabric` of 2 × 2.5 cm, as an irregular mesh, held by its upper corners.
fn scrap(fabric: &Fabric, cells: [u32; 2]) -> Cloth {
    let mut cloth = irregular_mesh(Vec2::new(0.02, 0.025), cells, fabric);
    hold(&mut cloth, |rest| rest.y > 0.0124 && rest.x.abs() > 0.0099);
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
            let mut most = 0.0_f32;
            for tick in 0..2_u32 {
                let at = |tick: u32| start + across.normalize() * (speed * TICK.dt * tick as f32);
                let weights = [1.0 / 3.0; 3];
                let (from, to) = (at(tick), at(tick + 1));
                cloth.constraints.grabs =
                    vec![Grab { particles, weights, from, to, stiffness: 200.0, max_force: 40.0 }];
                cloth.step(TICK, GRAVITY);
                most = most.max(fastest(&cloth));
            }
            let strain = measure::largest_strain(&cloth.topology, &cloth.particles);
            assert!(strain > 1.0, "the hand is to stretch it beyond what the substeps resolve, not by {strain}");
            assert!(most < 3.0 * speed, "{most} m/s with a hand of {speed} m/s");
        }
    }
}

#[test]
fn a_sheet_under_a_weight_that_would_tear_it_hangs_still() {
    let cells = 24;
    let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = rectangle(0.3, 0.3, cells, cells, &fabric);
    pin_top(&mut cloth, 0..=cells);
    let lower: Vec<u32> = cloth.topology.particles().filter(|p| cloth.topology.rest[*p as usize].y < -0.1499).collect();
    // N; 420 N/m in the end.
    let most = 126.0;
    for tick in 0..240 {
        let weight = most * (tick as f32 / 180.0).min(1.0);
        for slot in &lower {
            let is_end = cloth.topology.rest[*slot as usize].x.abs() > 0.1499;
            let share = if is_end { 0.5 } else { 1.0 } / cells as f32;
            cloth.particles.add_force(*slot as usize, Vec3::NEG_Y * (weight * share));
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force = None;
        assert!(fastest(&cloth) < 0.5, "{} m/s under {weight} N", fastest(&cloth));
    }
    // But for the last rows above the weight, where what is filtered ends.
    let grid = cloth.topology.grid.unwrap();
    let due = most / (0.3 * fabric.stretch_warp);
    for row in 0..20 {
        let [above, below] = [row, row + 1].map(|row| cloth.particles.position.get(grid.slot(row, 12) as usize));
        let strain = above.distance(below) / grid.spacing.y - 1.0;
        assert!((strain / due - 1.0).abs() < 0.01, "strain {strain} in row {row}, not {due}");
    }
}
