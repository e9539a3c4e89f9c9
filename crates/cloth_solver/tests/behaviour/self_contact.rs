//! Cloth against itself: it never passes through, keeps its momentum, gains no energy, comes to rest in layers, and untangles.

use std::f32::consts::{FRAC_PI_2, PI};

use crate::common::*;
use cloth_solver::contact::{Contacts, SelfContact, SelfContacts, Shape, collide_self};
use cloth_solver::{Cloth, Fabric, Tick, measure};
use glam::{DVec3, EulerRot, Quat, Vec2, Vec3, Vec3Swizzles};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn set(cloth: &mut Cloth, slot: usize, x: Vec3) {
    cloth.particles.position.set(slot, x);
    cloth.particles.previous.set(slot, x);
}

fn keep_off_itself(cloth: &mut Cloth, fabric: &Fabric) {
    cloth.set_self_contact(fabric, &SelfContact::default()).unwrap();
}

fn lay_ground(cloth: &mut Cloth, friction: f32) {
    cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, friction)]);
}

fn crossings(cloth: &Cloth) -> usize {
    measure::crossings(&cloth.topology, &cloth.particles).len()
}

/// Bends flat cloth over a half circle of `radius` in x, from x = `at` on, and up.
fn fold(x: Vec3, at: f32, radius: f32) -> Vec3 {
    let (along, arc) = (x.x - at, PI * radius);
    if along <= 0.0 {
        x
    } else if along < arc {
        let (sin, cos) = (along / radius).sin_cos();
        Vec3::new(at + radius * sin, x.y + radius * (1.0 - cos), x.z)
    } else {
        Vec3::new(at + arc - along, 2.0 * radius + x.y, x.z)
    }
}

/// A sheet in `layers` that turn back over each other, 4 cm apart, a little above the ground.
fn folded(fabric: &Fabric, cells: u32, layers: u32) -> Cloth {
    let (length, radius) = (0.25, 0.02);
    let period = length + PI * radius;
    let width = period * layers as f32;
    let mut cloth = rectangle(width, 0.4, (width / 0.4 * cells as f32) as u32, cells, fabric);
    for slot in 0..cloth.topology.slots() {
        let rest = cloth.topology.rest[slot];
        let along = rest.x + 0.5 * width;
        let layer = ((along / period) as u32).min(layers - 1);
        let (rest_of_it, is_back) = (along - layer as f32 * period, layer % 2 == 1);
        let (sin, cos) = ((rest_of_it - length).max(0.0) / radius).sin_cos();
        let x = rest_of_it.min(length) + radius * sin;
        let y = (2 * layer) as f32 * radius + radius * (1.0 - cos) + 0.01;
        set(&mut cloth, slot, Vec3::new(if is_back { length - x } else { x }, y, rest.y));
    }
    lay_ground(&mut cloth, fabric.friction);
    keep_off_itself(&mut cloth, fabric);
    cloth
}

#[test]
fn layers_of_any_fabric_come_to_rest_without_a_crossing() {
    for (name, fabric) in Fabric::PRESETS.iter().step_by(cases(14, 1)) {
        let mut cloth = folded(fabric, 8, 4);
        for second in 0..6 {
            run(&mut cloth, 1.0);
            assert_eq!(crossings(&cloth), 0, "{name}, second {second}");
        }
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.03, "{speed} m/s of {name}");
    }
}

/// Throws a sheet that begins 1.2 m above the ground and is turned by Euler angles, rad. The first tick after which it passes through
/// itself.
fn throw(mut cloth: Cloth, fabric: &Fabric, [x, y, z]: [f32; 3], velocity: [f32; 3], ball: bool) -> Option<u32> {
    place(&mut cloth, Quat::from_euler(EulerRot::XYZ, x, y, z), Vec3::Y * 1.2);
    for slot in 0..cloth.topology.slots() {
        cloth.particles.velocity.set(slot, Vec3::from_array(velocity));
    }
    let ground = collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, 0.4);
    let ball = ball.then(|| collider(Shape::Sphere { radius: 0.2 }, Vec3::Y * 0.25, Quat::IDENTITY, 0.3));
    cloth.contacts.set_colliders([ground].into_iter().chain(ball));
    keep_off_itself(&mut cloth, fabric);
    (0..60).find(|_| {
        cloth.step(TICK, GRAVITY);
        crossings(&cloth) > 0
    })
}

#[test]
fn jersey_that_crashes_on_its_edge_does_not_pass_through_itself() {
    // So many pairs may meet that no more may be followed.
    let sheet = rectangle(0.491_064_54, 0.314_461_35, 19, 20, &Fabric::COTTON_JERSEY);
    let turn = [-0.073_619_13, 1.300_03, -0.237_098_34];
    assert_eq!(throw(sheet, &Fabric::COTTON_JERSEY, turn, [-1.043_395_4, -4.034_68, 2.874_266], false), None);
}

#[test]
fn a_towel_of_long_thin_cells_that_falls_on_a_ball_does_not_pass_through_itself() {
    // Its cells are sheared in their plane until they overlap.
    let towel = rectangle(0.514_190_9, 1.290_500_5, 39, 9, &Fabric::TERRY_TOWEL);
    let turn = [1.503_160_7, -2.328_412, 2.744_294];
    assert_eq!(throw(towel, &Fabric::TERRY_TOWEL, turn, [-0.948_977_35, -3.235_497_7, -1.852_395_4], true), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(4, 12), failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn a_sheet_dropped_on_its_edge_lies_in_a_heap_without_a_crossing(
        preset in 0..Fabric::PRESETS.len(), columns in 8_u32..16, rows in 8_u32..16, is_mesh in any::<bool>(),
        tilt in -0.3_f32..0.3, roll in -0.8_f32..0.8,
    ) {
        let fabric = Fabric::PRESETS[preset].1;
        let size = Vec2::new(0.8, 0.7);
        let mut cloth = if is_mesh { irregular_mesh(size, [columns, rows], &fabric) } else { rectangle(size.x, size.y, columns, rows, &fabric) };
        place(&mut cloth, Quat::from_rotation_x(tilt) * Quat::from_rotation_z(roll), Vec3::Y * 0.7);
        lay_ground(&mut cloth, fabric.friction);
        keep_off_itself(&mut cloth, &fabric);
        for tick in 0..420 {
            cloth.step(TICK, GRAVITY);
            if tick % 6 == 0 {
                prop_assert_eq!(crossings(&cloth), 0, "tick {}", tick);
            }
        }
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        prop_assert_eq!(crossings(&cloth), 0);
        prop_assert!(speed < 0.03, "{} m/s", speed);
    }

    #[test]
    fn a_sheet_thrown_in_any_way_does_not_pass_through_itself(
        preset in 0..Fabric::PRESETS.len(), size in [0.3_f32..1.3, 0.3_f32..1.3], cells in [8_u32..30, 8_u32..30], is_mesh in any::<bool>(),
        turn in [-3.0_f32..3.0, -3.0_f32..3.0, -3.0_f32..3.0], velocity in [-3.0_f32..3.0, -5.0_f32..1.0, -3.0_f32..3.0], ball in any::<bool>(),
    ) {
        let fabric = Fabric::PRESETS[preset].1;
        let sheet = if is_mesh { irregular_mesh(size.into(), cells, &fabric) } else { rectangle(size[0], size[1], cells[0], cells[1], &fabric) };
        prop_assert_eq!(throw(sheet, &fabric, turn, velocity, ball), None);
    }

    #[test]
    fn two_halves_thrown_onto_each_other_do_not_pass_and_keep_their_momentum(
        preset in 0..Fabric::PRESETS.len(), speed in 1.0_f32..20.0, cells in 6_u32..16, is_mesh in any::<bool>(), aside in -0.5_f32..0.5,
    ) {
        let fabric = Fabric { damping: 0.0, ..Fabric::PRESETS[preset].1 };
        let (size, cells) = (Vec2::new(0.6, 0.3), [2 * cells, cells]);
        let mut cloth = if is_mesh { irregular_mesh(size, cells, &fabric) } else { rectangle(size.x, size.y, cells[0], cells[1], &fabric) };
        for slot in 0..cloth.topology.slots() {
            let flat = cloth.topology.rest[slot];
            let x = fold(Vec3::new(flat.x, 0.0, flat.y), 0.01, 0.06);
            set(&mut cloth, slot, x);
            if cloth.particles.mass[slot] > 0.0 {
                let toward = if x.y > 0.06 { Vec3::new(0.0, -speed, 0.3 * aside * speed) } else { Vec3::Y * speed };
                cloth.particles.velocity.set(slot, toward);
            }
        }
        keep_off_itself(&mut cloth, &fabric);
        let mass: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
        let scale = mass * f64::from(speed);
        let linear = measure::linear_momentum(&cloth.particles);
        let mut angular = DVec3::ZERO;
        for tick in 0..40 {
            cloth.step(Tick::new(1.0 / 60.0), Vec3::ZERO);
            if tick == 0 {
                angular = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
            }
            prop_assert_eq!(crossings(&cloth), 0, "tick {}", tick);
        }
        prop_assert!(cloth.particles.is_finite());
        let drift = (measure::linear_momentum(&cloth.particles) - linear).length() / scale;
        let turn = (measure::angular_momentum(&cloth.particles, DVec3::ZERO) - angular).length() / (scale * 0.6);
        prop_assert!(drift < 1e-5, "linear {drift}");
        // Of the paths that are bent within a substep.
        prop_assert!(turn < 1e-4, "angular {turn}");
    }

    #[test]
    fn the_sides_of_cuts_and_tears_do_not_pass_through_each_other(
        preset in 0..Fabric::PRESETS.len(), cells in 8_u32..18, is_mesh in any::<bool>(), lies in any::<bool>(),
        blades in prop::collection::vec([-0.3_f32..0.3, -0.3_f32..0.3, -0.3_f32..0.3, -0.3_f32..0.3], 1..4),
        torn in prop::collection::vec((0_u32..400, -1.0_f32..1.0, -1.0_f32..1.0), 0..4),
    ) {
        let fabric = Fabric::PRESETS[preset].1;
        let size = Vec2::new(0.5, 0.5);
        let mut cloth = if is_mesh { irregular_mesh(size, [cells; 2], &fabric) } else { rectangle(size.x, size.y, cells, cells, &fabric) };
        // It lies, or falls onto its edge and crumples.
        let turn = if lies { Quat::from_rotation_x(0.2 - FRAC_PI_2) } else { Quat::from_rotation_x(0.15) * Quat::from_rotation_z(0.2) };
        place(&mut cloth, turn, Vec3::Y * if lies { 0.1 } else { 0.35 });
        lay_ground(&mut cloth, fabric.friction);
        keep_off_itself(&mut cloth, &fabric);
        run(&mut cloth, 0.2);
        let along = if lies { Vec3::Y } else { Vec3::Z };
        for [a, b, c, d] in blades {
            let ray = |x: f32, y: f32| if lies { Vec3::new(x, 0.0, y) } else { Vec3::new(x, 0.25 + 0.5 * y, 0.0) };
            let [from, to] = [ray(a, b), ray(c, d)].map(|x| [x + along, x - along]);
            cloth.cut(&cloth_solver::damage::Blade { from, to });
            run(&mut cloth, 0.05);
        }
        for (particle, x, y) in torn {
            let pull = if x > y { cloth_solver::damage::Direction::Weft } else { cloth_solver::damage::Direction::Warp };
            cloth.tear_at(particle % cloth.topology.slots() as u32, pull);
            run(&mut cloth, 0.05);
        }
        let mut most = 0;
        for _ in 0..180 {
            cloth.step(TICK, GRAVITY);
            most = most.max(crossings(&cloth));
        }
        prop_assert!(cloth.particles.is_finite());
        prop_assert_eq!(most, 0);
    }

    #[test]
    fn particles_that_nothing_holds_together_collide_without_gain_of_energy_and_keep_their_momentum(
        seed in any::<u32>(), speed in 0.1_f32..20.0, friction in 0.0_f32..1.0,
    ) {
        let fabric = Fabric::COTTON_POPLIN;
        let mut cloth = rectangle(0.3, 0.3, 8, 8, &fabric);
        let settings = SelfContact { friction: Some(friction), ..SelfContact::default() };
        let mut own = SelfContacts::new(&cloth.topology, &fabric, &settings).unwrap();
        let noise = |i: usize| {
            let hash = (i as u32 ^ seed.rotate_left(16)).wrapping_mul(0x9E37_79B9);
            ((hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8) as f32 / 8_388_608.0 - 1.0
        };
        let mass: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
        for slot in cloth.topology.particles().map(|slot| slot as usize).collect::<Vec<_>>() {
            let flat = cloth.topology.rest[slot];
            let x = fold(Vec3::new(flat.x, 0.0, flat.y), 0.0, 0.03);
            set(&mut cloth, slot, x);
            let random = Vec3::new(noise(3 * slot), noise(3 * slot + 1), noise(3 * slot + 2)) * 0.2;
            let toward = if x.y > 0.03 { Vec3::NEG_Y } else { Vec3::Y };
            cloth.particles.velocity.set(slot, (toward + random) * speed);
        }
        let scale = mass * f64::from(speed);
        let before = (measure::linear_momentum(&cloth.particles), measure::angular_momentum(&cloth.particles, DVec3::ZERO));
        let mut energy = measure::kinetic_energy(&cloth.particles);
        let tick = Tick::fixed(1.0 / 60.0, 10);
        for substep in 0..60 {
            let h = tick.dt / 10.0;
            let start = (substep % 10) as f32 / 10.0;
            let sub = cloth_solver::Substep { start, end: start + 0.1, ..tick.first() };
            for slot in 0..cloth.topology.slots() {
                let x = cloth.particles.position.get(slot);
                cloth.particles.previous.set(slot, x);
                cloth.particles.position.set(slot, x + cloth.particles.velocity.get(slot) * h);
            }
            collide_self(&cloth.topology, &mut cloth.particles, &Contacts::default(), &mut own, &sub);
            prop_assert_eq!(crossings(&cloth), 0, "substep {}", substep);
            let now = measure::kinetic_energy(&cloth.particles);
            prop_assert!(now <= energy * (1.0 + 2e-4), "{energy} J became {now} J in substep {substep}");
            energy = now;
        }
        let drift = (measure::linear_momentum(&cloth.particles) - before.0).length() / scale;
        let turn = (measure::angular_momentum(&cloth.particles, DVec3::ZERO) - before.1).length() / (scale * 0.3);
        prop_assert!(drift < 1e-5, "linear {drift}");
        // Of the paths that are bent within a substep.
        prop_assert!(turn < 5e-3, "angular {turn}");
    }
}

#[test]
fn a_corner_that_begins_through_the_sheet_comes_out_gently() {
    let fabric = Fabric::COTTON_POPLIN;
    let mut cloth = rectangle(0.5, 0.5, 20, 20, &fabric);
    for slot in 0..cloth.topology.slots() {
        let flat = Quat::from_rotation_x(-FRAC_PI_2) * cloth.topology.rest[slot];
        let mut x = fold(flat, 0.012, 0.03);
        if x.y >= 0.06 {
            // The upper half is bent down around the fold, the more the nearer to one corner, and pierces the lower.
            let hinge = Vec3::new(0.012, 0.06, x.z);
            x = hinge + Quat::from_rotation_z(0.9 * (-x.z / 0.25).max(0.0)) * (x - hinge);
        }
        set(&mut cloth, slot, x + Vec3::Y * 0.3);
    }
    let fastest = |cloth: &mut Cloth| {
        let mut fastest = 0.0_f32;
        for _ in 0..240 {
            cloth.step(TICK, Vec3::ZERO);
            let speeds = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).length());
            fastest = speeds.fold(fastest, f32::max);
        }
        fastest
    };
    // The start is strained, and that alone lets it spring open.
    let without = fastest(&mut cloth.clone());
    keep_off_itself(&mut cloth, &fabric);
    assert!(crossings(&cloth) > 5);
    let with = fastest(&mut cloth);
    let own = cloth.self_contacts.as_ref().unwrap();
    assert_eq!((crossings(&cloth), own.tangled()), (0, 0));
    assert!(with < 1.1 * without, "{with} m/s, {without} m/s without");
}

#[test]
fn any_tangle_stays_finite_and_slow() {
    for seed in 0..4_u32 {
        let fabric = Fabric::COTTON_JERSEY;
        let mut cloth = rectangle(0.4, 0.4, 14, 14, &fabric);
        for slot in 0..cloth.topology.slots() {
            let hash = |k: u32| {
                ((slot as u32 * 3 + k + 977 * seed).wrapping_mul(2_654_435_761) >> 16 & 0xffff) as f32 / 65_536.0 - 0.5
            };
            let wave = (cloth.topology.rest[slot] * 25.0).map(f32::sin) * 0.08;
            let noise = Vec3::new(hash(0), hash(1), hash(2)) * 0.03;
            let x = cloth.topology.rest[slot] * Vec3::new(0.6, 0.6, 1.0) + wave.zxy() + noise;
            set(&mut cloth, slot, x + Vec3::Y * 0.4);
        }
        lay_ground(&mut cloth, 0.4);
        keep_off_itself(&mut cloth, &fabric);
        let mut free = cloth.clone();
        free.self_contacts = None;
        let [mut with, mut without] = [0.0_f32; 2];
        let fastest = |cloth: &Cloth| {
            let speeds = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).length());
            speeds.fold(0.0, f32::max)
        };
        let began = crossings(&cloth);
        for _ in 0..300 {
            cloth.step(TICK, GRAVITY);
            free.step(TICK, GRAVITY);
            (with, without) = (with.max(fastest(&cloth)), without.max(fastest(&free)));
        }
        assert!(cloth.particles.is_finite());
        assert!(with < 1.2 * without + 1.0, "{with} m/s, {without} m/s without contact");
        let left = crossings(&cloth);
        assert!(began > 20 && left < began / 2, "{began} crossings became {left}");
    }
}

#[test]
fn the_same_heap_has_the_same_bits_twice() {
    let run = || {
        let mut cloth = rectangle(0.5, 0.5, 16, 16, &Fabric::COTTON_POPLIN);
        place(&mut cloth, Quat::from_rotation_x(0.1), Vec3::Y * 0.3);
        lay_ground(&mut cloth, 0.4);
        keep_off_itself(&mut cloth, &Fabric::COTTON_POPLIN);
        run(&mut cloth, 2.0);
        cloth.particles.position
    };
    assert_eq!(run(), run());
}

#[test]
fn hanging_cloth_has_no_candidates() {
    let mut cloth = rectangle(1.0, 1.0, 32, 32, &Fabric::VELVET_CURTAIN);
    pin_top(&mut cloth, 0..=32);
    keep_off_itself(&mut cloth, &Fabric::VELVET_CURTAIN);
    run(&mut cloth, 2.0);
    let own = cloth.self_contacts.as_ref().unwrap();
    assert_eq!((own.candidates(), own.touching()), (0, 0));
    assert!(own.searches() < 20, "{} searches", own.searches());
}
