//! Free motion: falling, momentum, and that nothing depends on more than the input.

use crate::common::damage::blade;
use crate::common::*;
use cloth_solver::{Fabric, measure};
use glam::{DVec3, Quat, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn cloth_falls_by_half_g_t_squared_whatever_its_stiffness() {
    for fabric in [Fabric::COTTON_POPLIN, Fabric::COTTON_JERSEY, Fabric::PAPER] {
        let mut cloth = rectangle(1.0, 1.0, 20, 20, &fabric);
        run(&mut cloth, 1.0);
        for (p, rest) in cloth.topology.particles().zip(positions(&cloth)) {
            let fallen = cloth.topology.rest[p as usize].y - rest.y;
            assert!((fallen / (0.5 * 9.81) - 1.0).abs() < 0.005, "fell {fallen} m");
        }
    }
}

#[test]
fn free_cloth_keeps_its_momentum_and_gains_no_energy() {
    let mut cloth = rectangle(1.0, 1.0, 20, 20, &UNDAMPED);
    let spin = Vec3::new(0.4, 1.0, 2.0);
    for p in 0..cloth.topology.slots() {
        let r = cloth.topology.rest[p];
        cloth.particles.velocity.set(p, Vec3::new(0.5, 0.0, 0.2) + spin.cross(r));
    }
    let start = (
        measure::linear_momentum(&cloth.particles),
        measure::angular_momentum(&cloth.particles, DVec3::ZERO),
        measure::kinetic_energy(&cloth.particles),
    );
    for _ in 0..120 {
        cloth.step(TICK, Vec3::ZERO);
    }
    let linear = measure::linear_momentum(&cloth.particles);
    let angular = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
    assert!((linear - start.0).length() < 1e-5 * start.0.length(), "{linear} from {}", start.0);
    assert!((angular - start.1).length() < 1e-5 * start.1.length(), "{angular} from {}", start.1);
    assert!(measure::kinetic_energy(&cloth.particles) <= start.2 * 1.001);
}

#[test]
fn a_small_swing_keeps_its_height() {
    let mut cloth = rectangle(1.0, 1.0, 32, 32, &UNDAMPED);
    pin_top(&mut cloth, 0..=32);
    for p in 0..cloth.topology.slots() {
        let arm = cloth.topology.rest[p] - Vec3::Y * 0.5;
        cloth.particles.position.set(p, Quat::from_rotation_x(5_f32.to_radians()) * arm + Vec3::Y * 0.5);
    }
    let energy = |cloth: &cloth_solver::Cloth| {
        measure::kinetic_energy(&cloth.particles)
            + measure::gravitational_energy(&cloth.particles, GRAVITY)
            + measure::elastic_energy(&cloth.topology, &cloth.particles, &UNDAMPED)
    };
    let hung = 0.15 * 9.81 * 5e-5;
    let start = energy(&cloth);
    run(&mut cloth, 5.0);
    let left = (energy(&cloth) + hung) / (start + hung);
    assert!((0.94..=1.0).contains(&left), "{left} of its energy");
}

#[test]
fn internal_friction_stills_a_flapping_cloth_and_not_a_falling_one() {
    let flap = |damping| {
        let mut cloth = rectangle(1.0, 1.0, 10, 10, &Fabric { damping, ..Fabric::COTTON_POPLIN });
        for p in 0..cloth.topology.slots() {
            let r = cloth.topology.rest[p];
            cloth.particles.velocity.set(p, Vec3::new(0.0, 0.0, 3.0 * r.x * r.x));
        }
        run(&mut cloth, 1.0);
        let drift = measure::linear_momentum(&cloth.particles).as_vec3() / 0.15;
        let flapping = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).distance(drift));
        (drift, flapping.sum::<f32>())
    };
    let ((free_drift, free), (damped_drift, damped)) = (flap(0.0), flap(5.0));
    assert!(damped < 0.2 * free, "{damped} against {free}");
    assert!((damped_drift - free_drift).length() < 0.01 * free_drift.length());
}

#[test]
fn internal_friction_leaves_a_spinning_cloth_its_spin() {
    let mut cloth = rectangle(1.0, 1.0, 10, 10, &Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN });
    let spin = Vec3::new(0.4, 1.0, 2.0);
    for p in 0..cloth.topology.slots() {
        cloth.particles.velocity.set(p, spin.cross(cloth.topology.rest[p]));
    }
    let start = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
    for _ in 0..60 {
        cloth.step(TICK, Vec3::ZERO);
    }
    let left = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
    assert!((left - start).length() < 1e-4 * start.length(), "{left} of {start}");
}

#[test]
fn internal_friction_leaves_pieces_that_fly_apart_their_motion() {
    let mut cloth = rectangle(1.0, 1.0, 10, 10, &Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN });
    cloth.cut(&blade([0.03, 1.0], [0.03, -1.0])).expect("a cut through the middle");
    let pieces = cloth.topology.pieces();
    assert_eq!(pieces.triangles.len(), 2);
    for slot in cloth.topology.particles().map(|slot| slot as usize) {
        cloth.particles.velocity.set(slot, if pieces.of_slot[slot] == 0 { Vec3::Z } else { Vec3::NEG_Z });
    }
    for _ in 0..60 {
        cloth.step(TICK, Vec3::ZERO);
    }
    let speed = |slot: u32| cloth.particles.velocity.get(slot as usize).z.abs();
    let slowest = cloth.topology.particles().map(speed).fold(f32::INFINITY, f32::min);
    assert!(slowest > 0.999, "{slowest} m/s of 1");
}

#[test]
fn two_runs_give_the_same_bits() {
    let run_once = || {
        let mut cloth = rectangle(1.0, 1.0, 30, 30, &Fabric::COTTON_POPLIN);
        place(&mut cloth, Quat::from_rotation_x(-1.2), Vec3::Y);
        pin_top(&mut cloth, [0, 30]);
        run(&mut cloth, 2.0);
        positions(&cloth)
    };
    assert_eq!(run_once(), run_once());
}

/// Hangs a sheet by its top row and moves the pins in a single tick, within the plane of the sheet.
fn jolted(cells: u32, way: Vec3) -> cloth_solver::Cloth {
    // Damped, or it would swing for long.
    let mut cloth = rectangle(1.0, 1.0, cells, cells, &Fabric { damping: 2.0, ..Fabric::COTTON_POPLIN });
    pin_top(&mut cloth, 0..=cells);
    let there = cloth_solver::Pose::new(way, Quat::IDENTITY);
    cloth.constraints.pin_frames_mut()[0].to = there;
    cloth.step(TICK, GRAVITY);
    cloth.constraints.pin_frames_mut()[0].from = there;
    cloth
}

/// Root mean square over all edges of the velocity of one end relative to the other, m/s.
fn rms_jitter(cloth: &cloth_solver::Cloth) -> f32 {
    let v = |p: u32| cloth.particles.velocity.get(p as usize);
    let edges = &cloth.topology.edges;
    (edges.iter().map(|[a, b]| v(*a).distance_squared(v(*b))).sum::<f32>() / edges.len() as f32).sqrt()
}

#[test]
fn cloth_crushed_within_its_own_plane_buckles_out_of_it_and_comes_to_rest() {
    let mut cloth = jolted(31, Vec3::NEG_Y * 0.5);
    run(&mut cloth, 1.0);
    let stored = measure::elastic_energy(&cloth.topology, &cloth.particles, &Fabric::COTTON_POPLIN);
    assert!(stored < 1.0, "{stored} J jammed in it");
    run(&mut cloth, 7.0);
    // It swings on its pins, as a whole: that is no motion within the fabric.
    let jitter = rms_jitter(&cloth);
    assert!(jitter < 0.02, "neighbours part at {jitter} m/s eight seconds after");
}

#[test]
fn cloth_pulled_along_within_its_own_plane_stays_in_it() {
    let mut cloth = jolted(10, Vec3::X * 0.02);
    run(&mut cloth, 2.0);
    assert!(positions(&cloth).iter().all(|x| x.z == 0.0));
}

#[test]
fn paper_thrown_on_the_ground_gains_no_energy() {
    // Its shear is stiffer than the most substeps of a tick resolve.
    for (size, cells, turn, velocity) in [
        ([1.028_387, 0.633_369], [23, 28], [-0.304_566, 0.490_572, -2.601_702], [-0.197_607, -3.458_348, 1.041_765]),
        ([0.729_332, 0.907_617], [28, 29], [0.789_726, -2.008_306, -1.981_879], [0.336_27, -4.467_01, -2.492_398]),
        ([0.680_201, 0.946_75], [31, 31], [-1.962_148, 1.746_445, -0.471_163], [0.674_602, -2.844_819, 1.612_654]),
    ] {
        let sheet = rectangle(size[0], size[1], cells[0], cells[1], &Fabric::PAPER);
        let gain = gain_of_thrown(sheet, turn, velocity);
        assert!(gain < 1e-3, "{cells:?} cells gain {gain} of their energy");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(6, 24), failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn a_sheet_of_any_fabric_thrown_on_the_ground_gains_no_energy(
        preset in 0..Fabric::PRESETS.len(), size in [0.3_f32..1.3, 0.3_f32..1.3], cells in [8_u32..40, 8_u32..40], is_mesh in any::<bool>(),
        turn in [-3.0_f32..3.0, -3.0_f32..3.0, -3.0_f32..3.0], velocity in [-3.0_f32..3.0, -5.0_f32..1.0, -3.0_f32..3.0],
    ) {
        let fabric = Fabric::PRESETS[preset].1;
        let sheet = if is_mesh { irregular_mesh(size.into(), cells, &fabric) } else { rectangle(size[0], size[1], cells[0], cells[1], &fabric) };
        let gain = gain_of_thrown(sheet, turn, velocity);
        prop_assert!(gain < 1e-3, "{} of its energy", gain);
    }
}

#[test]
fn a_scrap_of_paper_held_by_two_corners_rests_in_its_plane() {
    // Rows that swing against each other within the plane are nothing but shear.
    for (width, height, columns, rows) in
        [(0.108, 0.032, 2, 3), (0.108, 0.032, 2, 6), (0.108, 0.032, 7, 7), (0.2, 0.032, 4, 3)]
    {
        let mut cloth = rectangle(width, height, columns, rows, &Fabric { damping: 0.0, ..Fabric::PAPER });
        pin_top(&mut cloth, [0, columns]);
        run(&mut cloth, 20.0);
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.03, "{columns}×{rows} cells: {speed} m/s");
    }
}
