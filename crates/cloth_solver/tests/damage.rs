//! Cloth that is cut, torn and burnt through: what must hold of its triangles, mass and motion.

mod common;

use std::sync::Arc;

use cloth_solver::constraint::Grab;
use cloth_solver::damage::{Direction, Stroke, Tear, Tearing};
use cloth_solver::{Cloth, Fabric, Method, Tick, measure};
use common::damage::*;
use common::*;
use glam::{Quat, Vec3};
use proptest::prelude::*;

#[test]
fn a_full_straight_cut_leaves_exactly_two_pieces_and_keeps_area_and_mass() {
    // The last two go through particles exactly, the last one along a whole row.
    for (from, to) in [
        ([-0.6, 0.03], [0.6, -0.21]),
        ([0.013, 0.7], [-0.2, -0.7]),
        ([-0.7, -0.6], [0.7, 0.65]),
        ([-0.8, 0.14], [0.8, -0.14]),
        ([-0.6, 0.0], [0.6, 0.0]),
    ] {
        for mut cloth in both(12, 12) {
            let (old_area, old_mass) = (area(&cloth.topology), mass(&cloth));
            cloth.cut(&blade(from, to)).unwrap();
            assert_sound(&cloth);
            let pieces = cloth.topology.pieces();
            assert_eq!(pieces.triangles.len(), 2, "{from:?} to {to:?}");
            assert_eq!(euler(&cloth.topology), 2);
            assert!((area(&cloth.topology) / old_area - 1.0).abs() < 1e-6);
            assert!((mass(&cloth) / old_mass - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn a_cut_is_a_straight_line_and_no_staircase() {
    for mut cloth in both(16, 16) {
        let (from, to) = ([-0.7, -0.13], [0.7, 0.31]);
        cloth.cut(&blade(from, to)).unwrap();
        let pieces = cloth.topology.pieces();
        let spacing = 1.0 / 16.0;
        let along = (glam::Vec2::from(to) - glam::Vec2::from(from)).normalize();
        let off = |slot: u32| along.perp_dot(cloth.topology.rest[slot as usize].truncate() - glam::Vec2::from(from));
        for [a, b] in &cloth.topology.edges {
            let (first, second) = (off(*a), off(*b));
            // A line led through a particle bends by 0.15 of an edge at most.
            assert!(first * second >= 0.0 || first.abs().min(second.abs()) <= 0.16 * spacing * 1.5);
        }
        let (one, other): (Vec<u32>, Vec<u32>) =
            cloth.topology.particles().partition(|slot| pieces.of_slot[*slot as usize] == 0);
        let sign = |slots: &[u32]| slots.iter().map(|slot| off(*slot)).sum::<f32>().signum();
        assert_eq!(sign(&one) * sign(&other), -1.0);
    }
}

#[test]
fn a_cut_with_both_ends_inside_leaves_one_piece_with_a_hole() {
    for mut cloth in both(12, 12) {
        cloth.cut(&blade([-0.22, 0.03], [0.28, -0.11])).unwrap();
        assert_sound(&cloth);
        assert_eq!(cloth.topology.pieces().triangles.len(), 1);
        assert_eq!(euler(&cloth.topology), 0);
    }
}

#[test]
fn the_same_stroke_again_changes_nothing() {
    for mut cloth in both(12, 12) {
        let stroke = blade([-0.3, 0.03], [0.6, -0.21]);
        cloth.cut(&stroke).unwrap();
        let before = cloth.topology.clone();
        assert_eq!(cloth.cut(&stroke), None);
        assert!(Arc::ptr_eq(&before, &cloth.topology));
    }
}

#[test]
fn a_stroke_of_many_short_blades_cuts_as_one_long_blade_does() {
    for steps in [1, 2, 3, 5, 8, 13, 17, 24, 37, 60, 61, 122, 200, 500] {
        for mut cloth in both(12, 12) {
            let at = |i: u32| [-0.61 + 1.22 * i as f32 / steps as f32, 0.07 - 0.2 * i as f32 / steps as f32];
            let mut stroke = Stroke::new(ray(at(0)), &cloth.particles.position);
            for i in 0..steps {
                cloth.sweep(&mut stroke, ray(at(i + 1)));
            }
            assert_sound(&cloth);
            assert_eq!(cloth.topology.pieces().triangles.len(), 2, "{steps} blades");
        }
    }
}

#[test]
fn a_stroke_through_a_moving_curtain_is_one_slit_without_a_neck() {
    // Blown about and swinging, seen by rays from one eye; so that every blade begins where the cloth no longer is.
    for (events, dt) in [(20, 1.0 / 60.0), (45, 1.0 / 60.0), (30, 1.0 / 240.0)] {
        for mut cloth in both(16, 16) {
            let top: Vec<u32> =
                cloth.topology.particles().filter(|s| cloth.topology.rest[*s as usize].y > 0.499).collect();
            pin_top(&mut cloth, top);
            for slot in 0..cloth.topology.slots() {
                let Vec3 { x, y, .. } = cloth.topology.rest[slot];
                let down = 0.5 - y;
                cloth.particles.velocity.set(slot, down * Vec3::new(1.5, 0.5, 3.0 * (9.0 * x).sin() - 2.0));
            }
            let eye = Vec3::new(0.2, 0.1, 3.0);
            let ray = |i: u32| [eye, eye + 4.0 * (Vec3::new(-1.1 + 2.2 * i as f32 / events as f32, -0.1, 0.0) - eye)];
            let mut stroke = Stroke::new(ray(0), &cloth.particles.position);
            let mut cuts = 0;
            for i in 0..events {
                cloth.step(Tick { dt, ..TICK }, GRAVITY);
                cuts += u32::from(cloth.sweep(&mut stroke, ray(i + 1)).is_some());
            }
            assert_sound(&cloth);
            assert!(cuts > 4, "{cuts} of {events} blades cut");
            let mut pieces = cloth.topology.pieces().triangles;
            pieces.sort_unstable();
            assert!(pieces.len() >= 2, "{events} blades leave a neck");
            assert!(pieces[pieces.len() - 2] > 80, "only chips of {pieces:?} triangles were cut off");
        }
    }
}

#[test]
fn a_blade_that_has_not_moved_or_meets_nothing_cuts_nothing() {
    let mut cloth = rectangle(1.0, 1.0, 6, 6, &Fabric::COTTON_POPLIN);
    for nothing in [
        blade([0.1, 0.1], [0.1, 0.1]),
        blade([0.7, 0.1], [0.9, 0.1]),
        blade([f32::NAN, 0.1], [0.9, 0.1]),
        blade([0.11, 0.03], [0.112, 0.03]),
    ] {
        assert_eq!(cloth.cut(&nothing), None);
    }
    assert_eq!(euler(&cloth.topology), 1);
}

#[test]
fn no_part_gets_smaller_than_a_fiftieth_of_a_triangle_however_often_it_is_cut() {
    for mut cloth in both(6, 6) {
        let whole = 1.0 / 72.0;
        for i in 0..60 {
            let turn = i as f32 * 2.399;
            let (sin, cos) = turn.sin_cos();
            let off = 0.3 * (i as f32 * 0.7).sin();
            let from = [off * -sin - 0.8 * cos, off * cos - 0.8 * sin];
            let to = [off * -sin + 0.8 * cos, off * cos + 0.8 * sin];
            cloth.cut(&blade(from, to));
        }
        assert_sound(&cloth);
        let smallest = cloth.topology.triangle_rest.iter().map(|r| 0.5 * r.determinant()).fold(f32::INFINITY, f32::min);
        assert!(smallest >= 0.0199 * whole, "{}", smallest / whole);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_cuts_and_holes_leave_a_sound_cloth_of_the_same_mass(
        strokes in prop::collection::vec([-0.7_f32..0.7, -0.7..0.7, -0.7..0.7, -0.7..0.7], 1..40),
        holes in prop::collection::vec(0_u32..100, 0..6),
    ) {
        for mut cloth in both(10, 8) {
            let old = mass(&cloth);
            for [a, b, c, d] in &strokes {
                cloth.cut(&blade([*a, *b], [*c, *d]));
            }
            assert_sound(&cloth);
            prop_assert!((mass(&cloth) / old - 1.0).abs() < 1e-5, "{} of {old}", mass(&cloth));
            prop_assert!((area(&cloth.topology) - 1.0).abs() < 1e-5);
            let before = area(&cloth.topology);
            let gone: f64 = holes.iter().collect::<std::collections::BTreeSet<_>>().into_iter()
                .filter_map(|hole| cloth.topology.triangle_rest.get(*hole as usize))
                .map(|rest| 0.5 * f64::from(rest.determinant())).sum();
            cloth.remove_triangles(&holes);
            assert_sound(&cloth);
            prop_assert!((area(&cloth.topology) - before + gone).abs() < 1e-5);
        }
    }
}

#[test]
fn what_is_cut_off_falls_freely_and_the_rest_hangs_as_before_by_every_method() {
    // Soft enough for methods that step forces. Explicit Euler has no stability.
    let soft = Fabric { stretch_warp: 50.0, stretch_weft: 50.0, shear: 5.0, damping: 0.0, ..Fabric::COTTON_POPLIN };
    for method in Method::ALL.into_iter().filter(|method| *method != Method::ExplicitEuler) {
        for mut cloth in [rectangle(0.5, 0.5, 10, 10, &soft), as_mesh(&rectangle(0.5, 0.5, 10, 10, &soft), &soft)] {
            cloth.set_method(method);
            let top: Vec<u32> =
                cloth.topology.particles().filter(|s| cloth.topology.rest[*s as usize].y > 0.249).collect();
            pin_top(&mut cloth, top);
            cloth.cut(&blade([-0.4, 0.01], [0.4, 0.03])).unwrap();
            let pieces = cloth.topology.pieces();
            let lower =
                (0..cloth.topology.slots()).filter(|slot| pieces.of_slot[*slot] == pieces.of_slot[bottom(&cloth)]);
            let lower: Vec<usize> = lower.collect();
            let centre = |cloth: &Cloth| {
                let m: f32 = lower.iter().map(|s| cloth.particles.mass[*s]).sum();
                lower.iter().map(|s| cloth.particles.mass[*s] * cloth.particles.position.y[*s]).sum::<f32>() / m
            };
            let start = centre(&cloth);
            for _ in 0..30 {
                cloth.step(Tick { substeps: 40, ..TICK }, GRAVITY);
            }
            let fallen = start - centre(&cloth);
            assert!((fallen / (0.5 * 9.81 * 0.25) - 1.0).abs() < 0.015, "{fallen} m by {}", method.name());
            let upper = cloth.topology.particles().filter(|s| !lower.contains(&(*s as usize)));
            let lowest = upper.map(|s| cloth.particles.position.y[s as usize]).fold(f32::INFINITY, f32::min);
            assert!(lowest > -0.05, "the upper part hangs on: {lowest} m by {}", method.name());
        }
    }
}

fn bottom(cloth: &Cloth) -> usize {
    let y = |slot: &u32| cloth.topology.rest[*slot as usize].y;
    cloth.topology.particles().min_by(|a, b| y(a).total_cmp(&y(b))).unwrap() as usize
}

#[test]
fn a_strip_with_a_slit_carries_its_weight_around_it() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=20);
    cloth.cut(&blade([-0.13, 0.003], [0.13, 0.003])).unwrap();
    settle(&mut cloth, 5.0);
    let pairs: Vec<(u32, u32)> = (cloth.topology.particles())
        .flat_map(|a| cloth.topology.particles().map(move |b| (a, b)))
        .filter(|(a, b)| a < b && cloth.topology.rest[*a as usize] == cloth.topology.rest[*b as usize])
        .collect();
    assert!(!pairs.is_empty());
    let gape = |(a, b): &(u32, u32)| {
        cloth.particles.position.get(*a as usize).distance(cloth.particles.position.get(*b as usize))
    };
    let widest = pairs.iter().map(gape).fold(0.0, f32::max);
    assert!(widest > 1e-4 && widest < 0.05, "the slit gapes a little: {widest} m");
    assert!(measure::largest_strain(&cloth.topology, &cloth.particles) < 0.01);
    assert!(measure::kinetic_energy(&cloth.particles) < 1e-3);
}

#[test]
fn a_cut_cloth_keeps_its_momentum_and_gains_no_energy() {
    let mut cloth = rectangle(0.6, 0.6, 12, 12, &UNDAMPED);
    for slot in 0..cloth.topology.slots() {
        let x = cloth.topology.rest[slot];
        cloth.particles.velocity.set(slot, Vec3::new(0.3, -0.2, 0.1) + Vec3::new(0.0, 0.0, 2.0).cross(x));
    }
    cloth.cut(&blade([-0.5, -0.02], [0.5, 0.11])).unwrap();
    cloth.cut(&blade([-0.12, 0.4], [0.02, -0.4])).unwrap();
    assert_eq!(cloth.topology.pieces().triangles.len(), 4);
    let energy = |cloth: &Cloth| {
        measure::kinetic_energy(&cloth.particles)
            + measure::elastic_energy(&cloth.topology, &cloth.particles, &UNDAMPED)
    };
    let (momentum, before) = (measure::linear_momentum(&cloth.particles), energy(&cloth));
    let mut most = before;
    for _ in 0..120 {
        cloth.step(TICK, Vec3::ZERO);
        most = most.max(energy(&cloth));
    }
    let drift = (measure::linear_momentum(&cloth.particles) - momentum).length() / momentum.length();
    assert!(drift < 1e-4, "momentum drifts by {drift}");
    assert!(most < 1.01 * before, "energy rises from {before} to {most} J");
}

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
    let tearing = Tearing { strength: 400.0, splits: 4, weakening: 0.5 };
    for tick in 0..400 {
        let pull = 0.5 * tick as f32;
        let area = |slot: &u32| cloth.topology.area[*slot as usize];
        let total: f32 = bottom.iter().map(area).sum();
        for (slot, share) in bottom.iter().map(|slot| (*slot, area(slot) / total)).collect::<Vec<_>>() {
            cloth.particles.add_force(slot as usize, Vec3::NEG_Y * (pull * share));
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt / 10.0, TICK.dt);
        if cloth.tear(&mut tear, &tearing).is_some() {
            assert_sound(&cloth);
            return Some(pull);
        }
    }
    None
}

#[test]
fn a_notched_sheet_tears_at_a_lower_load_than_a_whole_one() {
    for mesh in [false, true] {
        let (whole, notched) = (pull_apart(false, mesh).unwrap(), pull_apart(true, mesh).unwrap());
        // A strip 0.3 m wide that takes 400 N/m.
        assert!((whole / 120.0 - 1.0).abs() < 0.15, "the whole one tears at {whole} N");
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
    let tearing = Tearing { strength: 400.0, splits: 4, weakening: 0.5 };
    for _ in 0..240 {
        for column in 0..=15 {
            cloth.particles.add_force(grid.slot(15, column) as usize, Vec3::NEG_Y * 5.0);
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt / 10.0, TICK.dt);
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
    let tearing = Tearing { strength: 400.0, splits: 1, weakening: 0.5 };
    let mut splits = 0;
    for _ in 0..240 {
        // A hand's breadth of the lower edge is pulled.
        for column in 5..=10 {
            cloth.particles.add_force(grid.slot(15, column) as usize, Vec3::NEG_Y * 20.0);
        }
        cloth.step(TICK, GRAVITY);
        cloth.particles.force.as_mut().unwrap().fill(Vec3::ZERO);
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt / 10.0, TICK.dt);
        let Some(torn) = cloth.tear(&mut tear, &tearing) else { continue };
        let parted = torn.splits[0].particle;
        let copy = torn.change.born[0];
        for slot in [parted, copy.slot] {
            let ancestor = if slot == copy.slot { copy.parents[0] } else { slot };
            if let Some(painted) = painted.get(ancestor as usize) {
                assert_eq!(tear.strength(slot as usize), *painted, "the lip of a crack");
            }
        }
        let weakened = (painted.iter().enumerate()).filter(|(slot, painted)| tear.strength(*slot) == **painted * 0.5);
        assert!(weakened.count() > 0, "the tips of a crack");
        splits += 1;
    }
    assert!(splits > 5, "{splits} particles parted");
}

#[test]
fn a_hand_that_pulls_at_the_middle_of_a_curtain_rips_it_right_across() {
    let mut cloth = rectangle(1.0, 1.0, 32, 32, &Fabric::COTTON_POPLIN);
    pin_top(&mut cloth, 0..=32);
    // Two hundredths of what poplin bears, as a game would have it.
    let tearing = Tearing { strength: 240.0, splits: 4, weakening: 0.5 };
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    let middle =
        |corners: &[u32; 3]| corners.iter().map(|slot| cloth.topology.rest[*slot as usize]).sum::<Vec3>() / 3.0;
    let off = |at: &usize| middle(&cloth.topology.triangles[*at]).length();
    let mut held = (0..cloth.topology.triangles.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
    let mut from = middle(&cloth.topology.triangles[held]);
    for _ in 0..90 {
        let to = from + Vec3::new(0.0, -1.2, 0.36) * TICK.dt;
        let particles = cloth.topology.triangles[held];
        let grab = Grab { particles, weights: [1.0 / 3.0; 3], from, to, stiffness: 200.0, max_force: 20.0 };
        cloth.constraints.grabs = vec![grab];
        cloth.step(TICK, GRAVITY);
        from = to;
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt / 10.0, TICK.dt);
        if let Some(torn) = cloth.tear(&mut tear, &tearing) {
            held = torn.change.triangles.iter().position(|source| *source == held as u32).unwrap();
        }
    }
    let pieces = cloth.topology.pieces();
    let in_hand = pieces.of_slot[cloth.topology.triangles[held][0] as usize];
    let count = pieces.triangles[in_hand as usize];
    assert!(pieces.triangles.len() > 1 && count > 200, "a piece of {count} triangles is in the hand");
}

#[test]
fn a_piece_that_falls_far_from_its_frame_tears_no_further() {
    for mesh in [false, true] {
        for fallen in [100.0, 3000.0, 1e5] {
            let sheet = rectangle(0.5, 0.5, 24, 24, &Fabric::COTTON_POPLIN);
            let mut cloth = if mesh { as_mesh(&sheet, &Fabric::COTTON_POPLIN) } else { sheet };
            place(&mut cloth, Quat::from_rotation_x(0.3), Vec3::new(0.4, -fallen, 0.2));
            cloth.particles.velocity.fill(Vec3::NEG_Y * (2.0 * 9.81 * fallen).sqrt());
            let mut tear = Tear::new(&cloth.topology, Vec::new());
            let tearing = Tearing { strength: 120.0, splits: 4, weakening: 0.5 };
            for tick in 0..90 {
                cloth.step(TICK, GRAVITY);
                tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt / 10.0, TICK.dt);
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
