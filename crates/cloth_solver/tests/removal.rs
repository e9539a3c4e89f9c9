//! Links that are removed while the cloth moves.

mod common;

use cloth_solver::{Fabric, Method, Tick, measure};
use common::*;

/// Soft enough for methods that step forces.
const SOFT: Fabric =
    Fabric { stretch_warp: 50.0, stretch_weft: 50.0, shear: 5.0, damping: 0.0, ..Fabric::COTTON_POPLIN };

#[test]
fn what_is_cut_off_from_its_pins_falls_by_every_method() {
    // Explicit Euler has no stability.
    for method in Method::ALL.into_iter().filter(|method| *method != Method::ExplicitEuler) {
        let mut cloth = rectangle(0.5, 0.5, 10, 10, &SOFT);
        cloth.set_method(method);
        pin_top(&mut cloth, 0..=10);
        let grid = cloth.topology.grid.unwrap();
        for column in 0..=10 {
            assert!(cloth.constraints.remove_link(grid.slot(4, column), grid.slot(5, column)));
        }
        let tip = grid.slot(10, 5) as usize;
        let start = cloth.particles.position.get(tip).y;
        let (substeps, ticks) = (40, 30);
        for _ in 0..ticks {
            cloth.step(Tick { substeps, ..TICK }, GRAVITY);
        }
        let fallen = start - cloth.particles.position.get(tip).y;
        assert!((fallen / (0.5 * 9.81 * 0.25) - 1.0).abs() < 0.01, "{fallen} m by {}", method.name());
        let above = cloth.particles.position.get(grid.slot(4, 5) as usize).y;
        assert!((above - 0.05).abs() < 0.01, "the upper part hangs on: {above} m by {}", method.name());
    }
}

#[test]
fn a_strip_with_a_slit_carries_its_weight_around_it() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=20);
    let grid = cloth.topology.grid.unwrap();
    for column in 8..=12 {
        assert!(cloth.constraints.remove_link(grid.slot(9, column), grid.slot(10, column)));
    }
    settle(&mut cloth, 5.0);
    let y = |row, column| cloth.particles.position.get(grid.slot(row, column) as usize).y;
    let gape = y(9, 10) - y(10, 10) - 0.05;
    assert!(gape > 1e-4 && gape < 0.05, "the slit gapes a little: {gape} m");
    let beside = y(9, 4) - y(10, 4) - 0.05;
    assert!(beside.abs() < 1e-3, "beside it nothing gives: {beside} m");
    assert!(measure::kinetic_energy(&cloth.particles) < 1e-3);
}

#[test]
fn a_removed_link_and_its_bends_no_longer_count_and_cannot_be_removed_again() {
    let mut cloth = rectangle(0.5, 0.5, 10, 10, &Fabric::COTTON_POPLIN);
    let grid = cloth.topology.grid.unwrap();
    let mut remove = |a: (u32, u32), b: (u32, u32)| {
        let before = cloth.constraints.count();
        let removed = cloth.constraints.remove_link(grid.slot(a.0, a.1), grid.slot(b.0, b.1));
        (removed, before - cloth.constraints.count())
    };
    assert_eq!(remove((5, 5), (5, 6)), (true, 3), "a link and a bend at each end");
    assert_eq!(remove((5, 6), (5, 5)), (false, 0), "it is gone");
    assert_eq!(remove((5, 6), (5, 7)), (true, 2), "the bend between them went with the first");
    assert_eq!(remove((0, 0), (1, 0)), (true, 2), "a run's first particle has no bend");
    assert_eq!(remove((10, 9), (10, 10)), (true, 2), "nor has its last");
    assert_eq!(remove((2, 2), (3, 3)), (false, 0), "no link runs across a cell");
    assert_eq!(remove((2, 2), (2, 4)), (false, 0), "nor over a particle");
    assert_eq!(remove((0, 10), (1, 0)), (false, 0), "nor from one row's end to the next row");
}
