//! Cloth that tears: at which load, how far, and what stays as it was.

use std::sync::Arc;

use crate::common::damage::*;
use crate::common::*;
use cloth_solver::constraint::Grab;
use cloth_solver::damage::{Direction, Tear, Tearing};
use cloth_solver::{Cloth, Fabric};
use glam::{Quat, Vec3};

/// A strip held at the top and pulled down by weights on its lower row, more and more, until it tears; the pull, N.
fn pull_apart(notched: bool, mesh: bool) -> Option<f32> {
    let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };
    let sheet = rectangle(0.3, 0.3, 15, 15, &fabric);
    let mut cloth = if mesh { as_mesh(&sheet, &fabric) } else { sheet };
    if notched {
        cloth.cut(&blade([-0.2, 0.01], [-0.05, 0.01])).unwrap();
    }
    let row = |y: f32| -> Vec<u32> {
        let rest = |slot: &u32| cloth.topology.rest[*slot as usize].y;
        cloth.topology.particles().filter(|slot| (rest(slot) - y).abs() < 1e-3).collect()
    };
    let (top, bottom) = (row(0.15), row(-0.15));
    pin_top(&mut cloth, top);
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    let tearing = Tearing::at(400.0);
    for tick in 0..400 {
        let pull = 0.5 * tick as f32;
        // Evenly over the width: the two at the ends of the row have but half of a column.
        let columns = |slot: &u32| if cloth.topology.rest[*slot as usize].x.abs() > 0.149 { 0.5 } else { 1.0 };
        for (slot, share) in bottom.iter().map(|slot| (*slot, columns(slot) / 15.0)).collect::<Vec<_>>() {
            cloth.particles.add_force(slot as usize, Vec3::NEG_Y * (pull * share));
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
        if cloth.tear(&mut tear, &tearing).is_some() {
            assert_sound(&cloth);
            return Some(pull);
        }
    }
    None
}

#[test]
fn a_notched_sheet_tears_at_a_lower_load_than_a_whole_one() {
    for mesh in [false, true].into_iter().take(cases(1, 2)) {
        let (whole, notched) = (pull_apart(false, mesh).unwrap(), pull_apart(true, mesh).unwrap());
        // A strip 0.3 m wide that takes 400 N/m.
        assert!((whole / 120.0 - 1.0).abs() < 0.03, "the whole one tears at {whole} N");
        assert!(notched < 0.8 * whole, "the notched one at {notched} N, the whole one at {whole} N");
    }
}

#[test]
fn a_tear_runs_on_until_the_sheet_is_in_two() {
    let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = rectangle(0.3, 0.3, 15, 15, &fabric);
    cloth.cut(&blade([-0.2, 0.01], [-0.05, 0.01])).unwrap();
    let (old_mass, old_area) = (mass(&cloth), area(&cloth.topology));
    pin_top(&mut cloth, 0..=15);
    let grid = cloth.topology.grid.unwrap();
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    let tearing = Tearing::at(400.0);
    for _ in 0..240 {
        for column in 0..=15 {
            cloth.particles.add_force(grid.slot(15, column) as usize, Vec3::NEG_Y * 5.0);
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
        cloth.tear(&mut tear, &tearing);
        assert!(cloth.particles.is_finite());
    }
    assert_sound(&cloth);
    assert!(cloth.topology.pieces().triangles.len() >= 2);
    assert!((mass(&cloth) / old_mass - 1.0).abs() < 1e-5 && (area(&cloth.topology) / old_area - 1.0).abs() < 1e-5);
    let below = cloth.particles.position.y[grid.slot(15, 7) as usize];
    assert!(below < -1.0, "the lower half falls: {below} m");
}

#[test]
fn what_a_crack_points_at_is_weak_and_what_it_has_passed_is_as_strong_as_it_was() {
    let mut cloth = rectangle(0.3, 0.3, 15, 15, &Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN });
    pin_top(&mut cloth, 0..=15);
    let grid = cloth.topology.grid.unwrap();
    let painted: Vec<f32> = (0..cloth.topology.slots()).map(|slot| if slot % 2 == 0 { 0.8 } else { 0.6 }).collect();
    let mut tear = Tear::new(&cloth.topology, painted.clone());
    let tearing = Tearing { splits: 1, reinforcement: 1.0, ..Tearing::at(400.0) };
    let mut splits = 0;
    for _ in 0..240 {
        // A hand's breadth of the lower edge is pulled.
        for column in 5..=10 {
            cloth.particles.add_force(grid.slot(15, column) as usize, Vec3::NEG_Y * 20.0);
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
        let Some(torn) = cloth.tear(&mut tear, &tearing) else { continue };
        let parted = torn.splits[0].particle;
        let copy = torn.change.born[0];
        for slot in [parted, copy.slot] {
            let ancestor = if slot == copy.slot { copy.parents[0] } else { slot };
            if let Some(painted) = painted.get(ancestor as usize) {
                assert_eq!(tear.strength(slot as usize), *painted, "the lip of a crack");
            }
        }
        let is_weak = |(slot, painted): &(usize, &f32)| tear.strength(*slot) == **painted * tearing.weakening;
        let weakened = painted.iter().enumerate().filter(is_weak);
        assert!(weakened.count() > 0, "the tips of a crack");
        splits += 1;
    }
    assert!(splits > 5, "{splits} particles parted");
}

/// Pulls for `seconds` at the triangle that lies at `at` at rest, with 20 N at most, until its target has moved by `drawn`, and
/// holds it for a second more. The rest positions of the particles that part, in order, and the triangle held at last.
fn pull(cloth: &mut Cloth, tearing: &Tearing, at: Vec3, drawn: Vec3, seconds: f32) -> (Vec<Vec3>, usize) {
    let middle = |cloth: &Cloth, triangle: usize, places: &dyn Fn(usize) -> Vec3| {
        cloth.topology.triangles[triangle].iter().map(|slot| places(*slot as usize)).sum::<Vec3>() / 3.0
    };
    let off = |triangle: &usize| middle(cloth, *triangle, &|slot| cloth.topology.rest[slot]).distance(at);
    let mut held = (0..cloth.topology.triangles.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    let mut from = middle(cloth, held, &|slot| cloth.particles.position.get(slot));
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    let mut torn_at = Vec::new();
    let moving = (seconds / TICK.dt) as u32;
    for tick in 0..moving + 60 {
        let to = if tick < moving { from + drawn / moving as f32 } else { from };
        let particles = cloth.topology.triangles[held];
        let grab = Grab { particles, weights: [1.0 / 3.0; 3], from, to, stiffness: 200.0, max_force: 20.0 };
        cloth.constraints.grabs = vec![grab];
        cloth.step(TICK, GRAVITY);
        from = to;
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
        if let Some(torn) = cloth.tear(&mut tear, tearing) {
            held = torn.change.triangles.iter().position(|source| *source == held as u32).unwrap();
            torn_at.extend(torn.splits.iter().map(|split| cloth.topology.rest[split.particle as usize]));
        }
    }
    (torn_at, held)
}

#[test]
fn a_hand_that_pulls_at_the_middle_of_a_curtain_rips_it_right_across() {
    let mut cloth = rectangle(1.0, 1.0, 32, 32, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=32);
    // Two hundredths of what poplin bears, as a game would have it.
    let (_, held) = pull(&mut cloth, &Tearing::at(240.0), Vec3::ZERO, Vec3::new(0.0, -1.8, 0.54), 1.5);
    let pieces = cloth.topology.pieces();
    let in_hand = pieces.of_slot[cloth.topology.triangles[held][0] as usize];
    let count = pieces.triangles[in_hand as usize];
    assert!(pieces.triangles.len() > 1 && count > 200, "a piece of {count} triangles is in the hand");
}

/// A velvet curtain on six hooks.
fn curtain() -> Cloth {
    let mut cloth = rectangle(2.0, 1.8, 80, 72, &Fabric::VELVET_CURTAIN);
    pin_top(&mut cloth, [0, 16, 32, 48, 64, 80]);
    settle(&mut cloth, 3.0);
    cloth
}

#[test]
fn a_curtain_is_dragged_aside_without_leaving_its_hooks_and_rips_at_the_hand() {
    let hung = curtain();
    let at = Vec3::new(0.1, -0.3, 0.0);
    let drawn =
        [([0.2, 0.1, 0.2], false), ([0.4, 0.0, 0.4], true), ([0.7, -0.35, 0.5], true), ([0.0, -0.5, 0.8], true)];
    for (drawn, rips) in drawn.into_iter().skip(cases(3, 0)) {
        let mut cloth = hung.clone();
        let (torn_at, _) = pull(&mut cloth, &Tearing::at(180.0), at, drawn.into(), 1.0);
        assert_eq!(!torn_at.is_empty(), rips, "drawn by {drawn:?}");
        if let Some(first) = torn_at.first() {
            assert!(first.distance(at) < 0.1, "drawn by {drawn:?} it first tears at {first}");
        }
        assert!(torn_at.iter().all(|place| place.y < 0.8), "drawn by {drawn:?} it tears along the hooks");
        assert!(cloth.particles.is_finite());
    }
}

#[test]
fn reinforcement_goes_with_the_pins_and_paint_stays() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &Fabric::COTTON_POPLIN);
    let painted: Vec<f32> = (0..cloth.topology.slots()).map(|slot| if slot % 2 == 0 { 0.8 } else { 1.0 }).collect();
    let mut tear = Tear::new(&cloth.topology, painted.clone());
    let expect = |cloth: &Cloth, tear: &Tear, corner: Option<Vec3>, factor: f32| {
        for slot in cloth.topology.particles().map(|slot| slot as usize) {
            let is_near = corner.is_some_and(|corner| cloth.topology.rest[slot].distance(corner) < 0.101);
            let wanted = painted[slot] * if is_near { factor } else { 1.0 };
            assert!((tear.strength(slot) / wanted - 1.0).abs() < 1e-5, "{slot}: {} for {wanted}", tear.strength(slot));
        }
    };
    let tearing = Tearing::at(1e6);
    pin_top(&mut cloth, [0]);
    cloth.tear(&mut tear, &tearing);
    expect(&cloth, &tear, Some(Vec3::new(-0.5, 0.5, 0.0)), 5.0);
    pin_top(&mut cloth, [20]);
    cloth.tear(&mut tear, &Tearing { reinforcement: 0.5, ..tearing });
    expect(&cloth, &tear, Some(Vec3::new(0.5, 0.5, 0.0)), 0.5);
    pin_top(&mut cloth, []);
    cloth.tear(&mut tear, &tearing);
    expect(&cloth, &tear, None, 1.0);
}

#[test]
fn the_overloaded_end_of_a_thread_cannot_part_and_its_cloth_is_not_even_copied() {
    let mut cloth = rectangle(0.3, 0.3, 15, 15, &Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN });
    pin_top(&mut cloth, 0..=15);
    let grid = cloth.topology.grid.unwrap();
    let hem: Vec<u32> = (1..15).map(|column| grid.slot(15, column)).collect();
    let mut painted = vec![1.0; cloth.topology.slots()];
    // The hem takes 5 N/m, and 25 pull at it, down the warp.
    hem.iter().for_each(|slot| painted[*slot as usize] = 5e-6);
    let mut tear = Tear::new(&cloth.topology, painted);
    let before = cloth.topology.clone();
    for _ in 0..60 {
        hem.iter().for_each(|slot| cloth.particles.add_force(*slot as usize, Vec3::NEG_Y * 0.5));
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
        assert!(tear.tear(&mut cloth.topology, &[], &Tearing::at(1e6), &[]).is_none());
        assert!(Arc::ptr_eq(&before, &cloth.topology));
    }
    assert!(hem.iter().all(|slot| tear.load(*slot as usize) > 20.0));
}

#[test]
fn a_piece_that_falls_far_from_its_frame_tears_no_further() {
    for mesh in [false, true].into_iter().skip(cases(1, 0)) {
        for fallen in [100.0, 3000.0, 1e5].into_iter().skip(cases(2, 0)) {
            let sheet = rectangle(0.5, 0.5, 24, 24, &Fabric::COTTON_POPLIN);
            let mut cloth = if mesh { as_mesh(&sheet, &Fabric::COTTON_POPLIN) } else { sheet };
            place(&mut cloth, Quat::from_rotation_x(0.3), Vec3::new(0.4, -fallen, 0.2));
            cloth.particles.velocity.fill(Vec3::NEG_Y * (2.0 * 9.81 * fallen).sqrt());
            let mut tear = Tear::new(&cloth.topology, Vec::new());
            let tearing = Tearing::at(120.0);
            for tick in 0..cases(45, 90) {
                cloth.step(TICK, GRAVITY);
                tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
                let torn = cloth.tear(&mut tear, &tearing).is_some();
                assert!(!torn, "torn after {fallen} m, mesh: {mesh}, tick {tick}");
            }
        }
    }
}

#[test]
fn a_sheet_torn_to_single_cells_while_held_stays_finite_and_keeps_its_mass() {
    for mut cloth in both(6, 6) {
        let old = mass(&cloth);
        let triangle = cloth.topology.triangles[20];
        let at = Vec3::new(0.0, 0.3, 0.4);
        for round in 0..200_u32 {
            let particles: Vec<u32> = cloth.topology.particles().collect();
            let slot = particles[(round as usize * 7919) % particles.len()];
            let pull = if round % 2 == 0 { Direction::Weft } else { Direction::Warp };
            cloth.tear_at(slot, pull);
            cloth.constraints.grabs = vec![Grab {
                particles: triangle,
                weights: [1.0 / 3.0; 3],
                from: at,
                to: at,
                stiffness: 200.0,
                max_force: 20.0,
            }];
            cloth.step(TICK, GRAVITY);
            assert!(cloth.particles.is_finite(), "round {round}");
        }
        assert_sound(&cloth);
        assert!(cloth.topology.pieces().triangles.len() > 4);
        assert!((mass(&cloth) / old - 1.0).abs() < 1e-5);
    }
}
