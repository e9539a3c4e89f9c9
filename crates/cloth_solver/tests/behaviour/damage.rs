//! Cloth that is cut, and burnt through: what must hold of its triangles, mass and motion.

use std::sync::Arc;

use crate::common::damage::*;
use crate::common::*;
use cloth_solver::damage::Stroke;
use cloth_solver::{Cloth, Fabric, Method, Tick, measure};
use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

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
    #![proptest_config(ProptestConfig { cases: cases(4, 12), failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

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
