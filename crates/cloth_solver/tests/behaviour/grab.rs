//! Hands on the cloth: they drag it, feel its weight, and are no stronger than they are.

use crate::common::*;
use cloth_solver::constraint::Grab;
use cloth_solver::{Cloth, Fabric};
use glam::Vec3;

fn hand(cloth: &Cloth, max_force: f32, target: Vec3) -> Grab {
    let grid = cloth.topology.grid.unwrap();
    let middle = grid.slot(grid.rows / 2, grid.columns / 2);
    let triangle = cloth.topology.triangles.iter().find(|t| t.contains(&middle)).copied().unwrap();
    Grab { particles: triangle, weights: [1.0 / 3.0; 3], from: target, to: target, stiffness: 200.0, max_force }
}

fn held_point(cloth: &Cloth, grab: &Grab) -> Vec3 {
    grab.particles.iter().map(|p| cloth.particles.position.get(*p as usize) / 3.0).sum()
}

#[test]
fn a_hand_lifts_cloth_and_feels_its_weight() {
    let mut cloth = rectangle(1.0, 1.0, 40, 40, &Fabric::COTTON_POPLIN);
    let target = Vec3::new(0.0, 0.5, 0.0);
    let grab = hand(&cloth, 20.0, target);
    // In two seconds, as a hand does.
    let at = |tick: u32| Vec3::Y * (0.5 * tick as f32 / 120.0);
    for tick in 0..120 {
        cloth.constraints.grabs = vec![Grab { from: at(tick), to: at(tick + 1), ..grab }];
        cloth.step(TICK, GRAVITY);
    }
    cloth.constraints.grabs = vec![grab];
    settle(&mut cloth, 6.0);
    // The spring is drawn out by weight over stiffness: 1.47 N / 200 N/m.
    let sag = target.y - held_point(&cloth, &grab).y;
    assert!((sag / (0.15 * 9.81 / 200.0) - 1.0).abs() < 0.05, "{sag} m");
}

#[test]
fn a_hand_weaker_than_the_cloth_is_heavy_drops_it() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &Fabric::COTTON_POPLIN);
    cloth.constraints.grabs = vec![hand(&cloth, 0.5, Vec3::ZERO)];
    run(&mut cloth, 2.0);
    assert!(cloth_solver::measure::centre_of_mass(&cloth.particles).y < -5.0);
}

#[test]
fn pulling_at_pinned_cloth_with_all_strength_keeps_it_whole() {
    let mut cloth = rectangle(1.0, 1.0, 40, 40, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=40);
    let grab = hand(&cloth, 20.0, Vec3::new(0.0, -3.0, 1.0));
    cloth.constraints.grabs = vec![grab];
    run(&mut cloth, 5.0);
    let strain = cloth_solver::measure::largest_strain(&cloth.topology, &cloth.particles);
    // 20 N on one triangle of 2.5 cm: 800 N/m, a seventh of the stiffness, and more where the pull is not shared.
    assert!(strain < 0.6, "{strain}");
    cloth.constraints.grabs.clear();
    run(&mut cloth, 10.0);
    let speed = cloth_solver::measure::rms_speed(&cloth.topology, &cloth.particles);
    assert!(speed < 0.1, "{speed} m/s after letting go");
}
