//! Cloth that hangs: how far it stretches, and what its pins carry.

use crate::common::*;
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::{Fabric, Motion, Tick, measure};
use glam::Vec3;

/// Hangs a strip of 1 m by its whole top row and lets it rest.
fn hung_strip(stiffness: f32) -> cloth_solver::Cloth {
    let fabric = Fabric { stretch_warp: stiffness, stretch_weft: stiffness, ..Fabric::COTTON_POPLIN };
    let mut cloth = rectangle(0.5, 1.0, 20, 40, &fabric);
    pin_top(&mut cloth, 0..=20);
    run(&mut cloth, 20.0);
    cloth
}

#[test]
fn a_hanging_strip_stretches_by_its_weight_over_twice_its_stiffness() {
    for stiffness in [50.0, 500.0, 5000.0] {
        let cloth = hung_strip(stiffness);
        let grid = cloth.topology.grid.unwrap();
        let tip = grid.slot(grid.rows - 1, grid.columns / 2) as usize;
        let elongation = cloth.topology.rest[tip].y - cloth.particles.position.get(tip).y;
        let expected = 0.15 * 9.81 / (2.0 * stiffness);
        assert!((elongation / expected - 1.0).abs() < 0.01, "{elongation} m, not {expected} m, at {stiffness} N/m");
    }
}

#[test]
fn the_top_row_carries_the_weight() {
    let stiffness = 50.0;
    let cloth = hung_strip(stiffness);
    let grid = cloth.topology.grid.unwrap();
    let at = |row, column| cloth.particles.position.get(grid.slot(row, column) as usize);
    let force: f32 = (0..grid.columns)
        .map(|column| {
            let width = if column == 0 || column == grid.columns - 1 { 0.5 } else { 1.0 } * grid.spacing.x;
            let strain = at(0, column).distance(at(1, column)) / grid.spacing.y - 1.0;
            stiffness * width * strain
        })
        .sum();
    // The weight below the first row of links: all but half a row of cells.
    let weight = 0.15 * 0.5 * 9.81 * (1.0 - 0.5 / 40.0);
    assert!((force / weight - 1.0).abs() < 0.03, "{force} N, not {weight} N");
}

#[test]
fn cloth_hung_by_two_corners_holds_its_stretch_limit_at_the_default_budget() {
    for cells in [20, 40, 63].into_iter().take(cases(2, 3)) {
        let mut cloth = rectangle(1.0, 1.0, cells, cells, &Fabric::COTTON_POPLIN);
        pin_top(&mut cloth, [0, cells]);
        run(&mut cloth, 10.0);
        let strain = measure::largest_strain(&cloth.topology, &cloth.particles);
        assert!(strain < Fabric::COTTON_POPLIN.stretch_limit, "{strain} at {cells} cells");
    }
}

#[test]
fn cloth_hung_by_two_corners_hangs_alike_from_two_substeps_on() {
    let hang = |substeps| {
        let mut cloth = rectangle(1.0, 1.0, 32, 32, &Fabric::COTTON_POPLIN);
        pin_top(&mut cloth, [0, 32]);
        for _ in 0..600 {
            cloth.step(Tick { substeps, ..TICK }, GRAVITY);
        }
        let lowest = cloth.topology.grid.unwrap().slot(32, 16) as usize;
        (measure::largest_strain(&cloth.topology, &cloth.particles), cloth.particles.position.get(lowest).y)
    };
    let (strain, height) = hang(40);
    for substeps in [2, 3, 10].into_iter().step_by(cases(2, 1)) {
        let (found, at) = hang(substeps);
        assert!((found / strain - 1.0).abs() < 0.1, "{found}, not {strain}, with {substeps} substeps");
        assert!((at - height).abs() < 0.002, "{at} m, not {height} m, with {substeps} substeps");
    }
}

#[test]
fn cloth_held_by_one_side_sags_as_its_shear_stiffness_says() {
    for cells in [16, 32] {
        let fabric = Fabric { damping: 20.0, ..Fabric::COTTON_POPLIN };
        let mut cloth = rectangle(0.5, 1.0, cells, 2 * cells, &fabric);
        let grid = cloth.topology.grid.unwrap();
        let held = (0..grid.rows).map(|row| grid.slot(row, 0)).map(|particle| Pin {
            particle,
            frame: 0,
            local: cloth.topology.rest[particle as usize],
        });
        let pins = Pins { frames: vec![Motion::default()], pins: held.collect() };
        cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
        run(&mut cloth, 4.0);
        let end = grid.slot(grid.rows / 2, grid.columns - 1) as usize;
        let sag = cloth.topology.rest[end].y - cloth.particles.position.get(end).y;
        // A beam far higher than its shear lets it bend: σ g W²/2G, and next to nothing from stretch. Its free edges, where
        // shear vanishes, add some: small steps of Verlet's method find 5 % more at 16 cells, too.
        let expected = 0.15 * 9.81 * 0.25 / (2.0 * Fabric::COTTON_POPLIN.shear);
        assert!((sag / expected - 1.0).abs() < 0.07, "{sag} m, not {expected} m, with {cells} cells");
    }
}

#[test]
fn no_number_of_substeps_makes_corner_hung_cloth_explode() {
    let cells = cases(32, 63);
    for substeps in [1, 2, 3, 5, 10, 20].into_iter().step_by(cases(2, 1)) {
        let mut cloth = rectangle(1.0, 1.0, cells, cells, &Fabric::COTTON_POPLIN);
        for p in 0..cloth.topology.slots() {
            // Not perfectly flat, or it could not buckle.
            cloth.particles.position.z[p] += 1e-3 * (p as f32 * 12.9898).sin();
        }
        pin_top(&mut cloth, [0, cells]);
        for _ in 0..300 {
            cloth.step(Tick { substeps, ..TICK }, GRAVITY);
        }
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 2.0, "{speed} m/s with {substeps} substeps");
        assert!(positions(&cloth).iter().all(|x| x.length() < 2.5), "with {substeps} substeps");
    }
}

#[test]
fn pins_follow_their_frame_exactly_and_let_go() {
    let mut cloth = rectangle(1.0, 1.0, 10, 10, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, [0, 10]);
    let there = cloth_solver::Pose::new(Vec3::new(0.003, 0.001, 0.002), glam::Quat::from_rotation_y(0.01));
    cloth.constraints.pin_frames_mut()[0].to = there;
    cloth.step(TICK, GRAVITY);
    for pin in &cloth.constraints.pins().pins {
        assert_eq!(cloth.particles.position.get(pin.particle as usize), there.point(pin.local));
    }
    cloth.constraints.set_pins(&mut cloth.particles, Default::default()).unwrap();
    let before = cloth.particles.position.get(0);
    run(&mut cloth, 0.5);
    assert!(cloth.particles.position.get(0).y < before.y - 0.5, "a released corner falls");
}

#[test]
fn tethers_hold_the_stretch_that_a_coarse_step_leaves() {
    let strain = |slack| {
        let mut cloth = rectangle(1.0, 1.0, 40, 40, &Fabric::COTTON_JERSEY);
        pin_top(&mut cloth, 0..=40);
        cloth.constraints.set_tethers(&cloth.topology, slack);
        run(&mut cloth, 5.0);
        let grid = cloth.topology.grid.unwrap();
        let tip = grid.slot(grid.rows - 1, 20) as usize;
        cloth.topology.rest[tip].y - cloth.particles.position.get(tip).y
    };
    assert!(strain(None) > 0.02, "jersey stretches by centimetres");
    assert!(strain(Some(0.005)) < 0.006, "and does not with tethers");
}

#[test]
fn the_residual_vanishes_at_rest_and_not_in_a_coarse_step() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=20);
    run(&mut cloth, 10.0);
    let at_rest = cloth.constraints.residual(&cloth.particles).unwrap();
    assert!(at_rest < 1e-5, "{at_rest}");
    for p in 0..cloth.topology.slots() {
        cloth.particles.velocity.set(p, Vec3::new(3.0, 0.0, 2.0) * cloth.topology.rest[p].x);
    }
    cloth.step(Tick { substeps: 1, ..TICK }, GRAVITY);
    let coarse = cloth.constraints.residual(&cloth.particles).unwrap();
    assert!(coarse > 10.0 * at_rest, "{coarse} against {at_rest}");
}
