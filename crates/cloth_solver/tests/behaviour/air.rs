//! Drag and lift against known answers.

use std::sync::Arc;

use crate::common::*;
use cloth_solver::forces::{Air, WindField};
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Method, Tick, Topology, measure};
use glam::{Quat, Vec2, Vec3};
use proptest::prelude::*;

/// Keeps its form: the known answers are those of a flat sheet, and a limp one flutters.
const BOARD: Fabric = Fabric { bend_warp: 1.0, bend_weft: 1.0, damping: 5.0, ..Fabric::COTTON_POPLIN };

/// The triangles of a square metre of cloth, as a mesh.
fn as_mesh(cloth: &Cloth, fabric: &Fabric) -> Cloth {
    let rest = &cloth.topology.rest;
    let uvs: Vec<Vec2> = rest.iter().map(|p| Vec2::new(p.x, -p.y)).collect();
    let indices: Vec<u32> = cloth.topology.triangles.iter().flatten().copied().collect();
    // Only what a triangle names: padding belongs to none.
    let used: Vec<usize> = cloth.topology.particles().map(|slot| slot as usize).collect();
    let place = |slot: &u32| used.iter().position(|used| used == &(*slot as usize)).unwrap() as u32;
    let positions: Vec<Vec3> = used.iter().map(|slot| rest[*slot]).collect();
    let uvs: Vec<Vec2> = used.iter().map(|slot| uvs[*slot]).collect();
    let indices: Vec<u32> = indices.iter().map(place).collect();
    let source = MeshSource { positions: &positions, uvs: &uvs, indices: &indices };
    Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), fabric).unwrap()
}

/// The force of a wind on a cloth that moves at one velocity, N. Found for so short a time that nothing bounds it.
fn force(cloth: &mut Cloth, wind: Vec3, moving: Vec3) -> Vec3 {
    cloth.particles.velocity.fill(moving);
    WindField::uniform(wind).sample(&cloth.topology, &mut cloth.particles);
    Air::default().blow(&cloth.topology, &mut cloth.particles, &Tick { dt: 1e-6, ..TICK }.first());
    let force = &cloth.particles.airflow.as_ref().unwrap().force;
    (0..force.len()).map(|slot| force.get(slot)).sum()
}

/// Something that is neither flat nor even.
fn rumpled(columns: u32, rows: u32) -> Cloth {
    let mut cloth = rectangle(1.0, 1.0, columns, rows, &Fabric::COTTON_POPLIN);
    for slot in 0..cloth.topology.slots() {
        let p = cloth.topology.rest[slot];
        let bent = Vec3::new(p.x, p.y, 0.2 * (3.0 * p.x).sin() + 0.1 * p.x * p.y);
        cloth.particles.position.set(slot, bent);
    }
    cloth
}

fn speed_of_fall(mut cloth: Cloth, tick: Tick, seconds: f32) -> f32 {
    place(&mut cloth, Quat::from_rotation_x(-1.570_796_4), Vec3::ZERO);
    cloth.air = Some(Air::default());
    for _ in 0..(seconds / tick.dt).round() as u32 {
        cloth.step(tick, GRAVITY);
    }
    let count = cloth.topology.particle_count() as f32;
    -cloth.topology.particles().map(|slot| cloth.particles.velocity.y[slot as usize]).sum::<f32>() / count
}

#[test]
fn a_sheet_falls_broadside_as_the_hyperbolic_tangent_says_on_every_mesh_and_at_every_step() {
    for density in [0.05, 0.15, 0.30] {
        let fabric = Fabric { areal_density: density, ..BOARD };
        let sheet = |cells| rectangle(1.0, 1.0, cells, cells, &fabric);
        let terminal = (2.0 * density * 9.81 / (1.225 * 1.17_f32)).sqrt();
        for seconds in [0.2_f32, 1.0] {
            let expected = terminal * (9.81 * seconds / terminal).tanh();
            for (cloth, substeps) in [(sheet(4), 10), (sheet(9), 10), (as_mesh(&sheet(5), &fabric), 10), (sheet(5), 5)]
            {
                let found = speed_of_fall(cloth, Tick { substeps, ..TICK }, seconds);
                let what = format!("{density} kg/m² after {seconds} s in {substeps} substeps");
                assert!((found / expected - 1.0).abs() < 0.01, "{what}: {found} m/s, not {expected} m/s");
            }
        }
    }
}

#[test]
fn methods_that_step_forces_feel_the_air_too() {
    let soft = Fabric { stretch_warp: 50.0, stretch_weft: 50.0, shear: 5.0, bend_warp: 0.0, bend_weft: 0.0, ..BOARD };
    for method in [Method::SymplecticEuler, Method::StormerVerlet, Method::RungeKutta4] {
        let mut cloth = rectangle(1.0, 1.0, 3, 3, &soft);
        cloth.set_method(method);
        let found = speed_of_fall(cloth, Tick { substeps: 20, ..TICK }, 1.0);
        let expected = (2.0 * 0.15 * 9.81 / (1.225 * 1.17_f32)).sqrt();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} m/s by {}", method.name());
    }
}

#[test]
fn broadside_the_force_is_the_dynamic_pressure_times_the_drag_of_a_plate() {
    let mut sheet = rectangle(2.0, 0.5, 7, 9, &Fabric::COTTON_POPLIN);
    let found = force(&mut sheet, Vec3::Z * 3.0, Vec3::ZERO);
    let expected = 0.5 * 1.225 * 1.17 * 9.0;
    assert!((found - Vec3::Z * expected).length() < 1e-4 * expected, "{found}");
    let along = force(&mut sheet, Vec3::X * 3.0, Vec3::ZERO);
    assert!((along - Vec3::X * (expected * 0.03 / 1.17)).length() < 1e-4 * expected, "{along}");
}

#[test]
fn a_stretched_sheet_catches_no_more_wind() {
    let mut sheet = rectangle(1.0, 1.0, 5, 5, &Fabric::COTTON_POPLIN);
    let before = force(&mut sheet, Vec3::Z, Vec3::ZERO);
    for slot in 0..sheet.topology.slots() {
        sheet.particles.position.set(slot, sheet.topology.rest[slot] * 3.0);
    }
    assert!((force(&mut sheet, Vec3::Z, Vec3::ZERO) - before).length() < 1e-5 * before.length());
}

#[test]
fn air_faster_than_sound_pulls_no_harder() {
    let mut sheet = rumpled(5, 5);
    let mut at = |speed: f32| force(&mut sheet, Vec3::new(0.6, 0.0, 0.8) * speed, Vec3::ZERO);
    let limit = at(340.0);
    assert!((at(1e6) - limit).length() < 1e-4 * limit.length());
    assert!(at(330.0).length() < 0.95 * limit.length());
}

#[test]
fn what_the_fabric_lets_through_does_not_push() {
    let mut sheet = rectangle(1.0, 1.0, 5, 5, &Fabric::COTTON_POPLIN);
    let full = force(&mut sheet, Vec3::Z, Vec3::ZERO);
    let mut through = |porosity| {
        Air { porosity, ..Air::default() }.blow(&sheet.topology, &mut sheet.particles, &TICK.first());
        let force = &sheet.particles.airflow.as_ref().unwrap().force;
        (0..force.len()).map(|slot| force.get(slot)).sum::<Vec3>()
    };
    assert!((through(0.75) - full * 0.25).length() < 1e-3 * full.length());
    assert_eq!(through(1.0), Vec3::ZERO);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_force_follows_the_square_of_the_wind_its_mirror_image_and_nothing_but_the_difference(
        wind in prop::array::uniform3(-8.0_f32..8.0), moving in prop::array::uniform3(-8.0_f32..8.0), times in 0.1_f32..9.0
    ) {
        let (wind, moving) = (Vec3::from(wind), Vec3::from(moving));
        let mut cloth = rumpled(6, 5);
        let one = force(&mut cloth, wind, Vec3::ZERO);
        let near = |a: Vec3, b: Vec3| (a - b).length() <= 1e-4 * (a.length() + b.length()) + 1e-6;
        prop_assert!(near(force(&mut cloth, wind * times, Vec3::ZERO), one * (times * times)));
        prop_assert!(near(force(&mut cloth, -wind, Vec3::ZERO), -one));
        prop_assert!(near(force(&mut cloth, wind + moving, moving), one));
        prop_assert!(force(&mut cloth, moving, moving).length() < 1e-9);
    }

    #[test]
    fn the_force_does_not_depend_on_how_the_sheet_is_cut(wind in prop::array::uniform3(-8.0_f32..8.0)) {
        let wind = Vec3::from(wind);
        let mut coarse = rumpled(16, 12);
        let expected = force(&mut coarse, wind, Vec3::ZERO);
        let mut mesh = as_mesh(&coarse, &Fabric::COTTON_POPLIN);
        for slot in 0..mesh.topology.slots() {
            let p = mesh.topology.rest[slot];
            let bent = Vec3::new(p.x, p.y, 0.2 * (3.0 * p.x).sin() + 0.1 * p.x * p.y);
            mesh.particles.position.set(slot, bent);
        }
        for found in [force(&mut rumpled(41, 37), wind, Vec3::ZERO), force(&mut mesh, wind, Vec3::ZERO)] {
            prop_assert!((found - expected).length() < 0.01 * expected.length(), "{found} and {expected}");
        }
    }
}

#[test]
fn a_gale_takes_a_sheet_along_no_faster_than_it_blows() {
    for wind in [1e2, 1e4, 1e6] {
        let mut cloth = rectangle(1.0, 1.0, 6, 6, &BOARD);
        cloth.air = Some(Air::default());
        cloth.wind = WindField::uniform(Vec3::new(0.2, 0.0, 1.0) * wind);
        for _ in 0..30 {
            cloth.step(TICK, Vec3::ZERO);
            let fastest = cloth.topology.particles().map(|slot| cloth.particles.velocity.get(slot as usize).length());
            let fastest = fastest.fold(0.0, f32::max);
            assert!(fastest < 1.05 * wind, "{fastest} m/s in a wind of {wind} m/s");
        }
    }
}

#[test]
fn a_flag_in_a_gale_of_a_million_metres_a_second_stays_finite_and_comes_back() {
    let mut flag = rectangle(1.0, 0.6, 20, 12, &Fabric::FLAG_POLYESTER);
    pin_top(&mut flag, 0..=20);
    flag.air = Some(Air::default());
    flag.wind = WindField::uniform(Vec3::new(1e6, 0.0, 1e5));
    for _ in 0..30 {
        flag.step(TICK, GRAVITY);
        assert!(flag.particles.is_finite());
    }
    flag.wind = WindField::default();
    run(&mut flag, 1.0);
    let stretched = measure::largest_strain(&flag.topology, &flag.particles);
    assert!(stretched < Fabric::FLAG_POLYESTER.stretch_limit, "still stretched by {stretched}");
}

#[test]
fn without_air_a_wind_changes_not_a_bit_and_takes_no_memory() {
    let fall = |wind| {
        let mut cloth = rectangle(1.0, 1.0, 6, 6, &BOARD);
        cloth.wind = WindField::uniform(wind);
        (0..30).for_each(|_| cloth.step(TICK, GRAVITY));
        assert!(cloth.particles.airflow.is_none());
        positions(&cloth)
    };
    assert_eq!(fall(Vec3::ZERO), fall(Vec3::ONE * 30.0));
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    let refused = |air: Air| air.validate().unwrap_err().to_string();
    assert!(refused(Air { density: -1.0, ..Air::default() }).contains("`Air::density` is -1, allowed is 0..=2000"));
    assert!(refused(Air { normal: 11.0, ..Air::default() }).contains("`Air::normal` is 11"));
    assert!(refused(Air { tangent: f32::NAN, ..Air::default() }).contains("`Air::tangent` is NaN"));
    assert!(refused(Air { porosity: 1.5, ..Air::default() }).contains("`Air::porosity` is 1.5, allowed is 0..=1"));
}
