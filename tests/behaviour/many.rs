//! Many cloths at once move as each alone does, to the bit: on one thread or many, with or without systems between the substeps.

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bevy::prelude::*;
use bevy_cloth::*;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

use crate::common::*;

/// Spawns cloth number `index`, whose kind chance decides, and what it meets: 4 m from the next.
fn spawn(world: &mut World, index: usize) -> Entity {
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(index as u64);
    let at = Vec3::new(4.0 * index as f32, 0.0, 0.0);
    let size = Vec2::new(chance.random_range(0.3..1.5), chance.random_range(0.3..1.5));
    let fabrics = [Fabric::COTTON_POPLIN, Fabric::SILK_CHARMEUSE, Fabric::LEATHER_GARMENT, Fabric::FLAG_POLYESTER];
    let fabric = fabrics[chance.random_range(0..fabrics.len())];
    let pins = match chance.random_range(0..4) {
        0 => Pins::top(),
        1 => Pins::corners(),
        2 => Pins::rods(3),
        _ => Pins::region(Vec3::splat(-10.0), Vec3::new(0.01 - 0.5 * size.x, 10.0, 10.0)),
    };
    let cloth = Cloth::rectangle(size.x, size.y).with_cells(chance.random_range(2..=24), chance.random_range(2..=24));
    let cloth = world.spawn((cloth, fabric, pins, Transform::from_translation(at))).id();
    if chance.random_bool(0.7) {
        world.entity_mut(cloth).insert((Air::default(), Wind(Vec3::new(chance.random_range(0.0..12.0), 0.0, 2.0))));
    }
    if chance.random_bool(0.5) {
        world.entity_mut(cloth).insert(SelfContact::default());
    }
    if chance.random_bool(0.3) {
        world.entity_mut(cloth).insert(Tearable::default());
    }
    if chance.random_bool(0.3) {
        world.entity_mut(cloth).insert(Substeps { count: chance.random_range(1..=30), ..Substeps::default() });
    }
    if chance.random_bool(0.5) {
        let ball = ClothCollider::Sphere { radius: 0.2 };
        world.spawn((ball, Transform::from_translation(at + Vec3::new(chance.random_range(-0.3..0.3), -0.2, 0.1))));
    }
    cloth
}

/// Every bit of each of `cloths` after some ticks.
fn bits_after(app: &mut App, cloths: &[Entity]) -> Vec<Bits> {
    run(app, 40);
    cloths.iter().map(|cloth| Bits::of(get::<Particles>(app, *cloth))).collect()
}

fn crowd(prepare: impl FnOnce(&mut App)) -> Vec<Bits> {
    let mut app = headless();
    prepare(&mut app);
    let cloths: Vec<Entity> = (0..cases(20, 60)).map(|index| spawn(app.world_mut(), index)).collect();
    bits_after(&mut app, &cloths)
}

#[test]
fn a_crowd_moves_to_the_bit_as_each_of_it_alone() {
    let crowd = crowd(|_| ());
    for (index, in_crowd) in crowd.iter().enumerate().step_by(3) {
        let mut app = headless();
        let alone = spawn(app.world_mut(), index);
        assert_eq!(&bits_after(&mut app, &[alone])[0], in_crowd, "cloth {index}");
    }
}

#[test]
fn a_crowd_moves_to_the_bit_the_same_when_a_system_looks_on_between_the_substeps() {
    let seen = Arc::new(AtomicUsize::new(0));
    let count = seen.clone();
    let watched = crowd(|app| {
        let look = move || {
            count.fetch_add(1, Ordering::Relaxed);
        };
        app.add_systems(ClothSubstepSchedule, look.after(ClothSystems::Integrate).before(ClothSystems::Solve));
    });
    assert!(seen.load(Ordering::Relaxed) >= 10 * 40, "a system between the substeps of every cloth");
    assert!(watched == crowd(|_| ()), "the same bits");
}

#[test]
fn a_condition_on_a_set_of_the_substeps_is_asked_in_each_of_them() {
    let asked = Arc::new(AtomicUsize::new(0));
    let count = asked.clone();
    let mut app = headless();
    app.configure_sets(
        ClothSubstepSchedule,
        ClothSystems::Solve.run_if(move || {
            count.fetch_add(1, Ordering::Relaxed);
            true
        }),
    );
    app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top()));
    run(&mut app, 3);
    assert!(asked.load(Ordering::Relaxed) >= 20, "asked {} times", asked.load(Ordering::Relaxed));
}

/// Two towels, one just above the other: they step together, by the schedule of substeps.
fn let_two_towels_touch(app: &mut App) {
    let towel = |height: f32| {
        let flat = Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
        (Cloth::rectangle(0.3, 0.3).with_cells(8, 8), SelfContact::default(), flat)
    };
    let towels = [0.0, 0.002].map(|height| app.world_mut().spawn(towel(height)).id());
    run(app, 2);
    towels.into_iter().for_each(|towel| assert!(app.world_mut().despawn(towel)));
}

#[test]
fn what_is_put_between_the_substeps_while_the_app_runs_sees_each_of_them() {
    for is_condition in [false, true] {
        let seen = Arc::new(AtomicUsize::new(0));
        let count = seen.clone();
        let mut app = headless();
        let_two_towels_touch(&mut app);
        app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top()));
        run(&mut app, 2);
        if is_condition {
            let condition = move || count.fetch_add(1, Ordering::Relaxed) < usize::MAX;
            app.configure_sets(ClothSubstepSchedule, ClothSystems::Solve.run_if(condition));
        } else {
            let look = move || {
                count.fetch_add(1, Ordering::Relaxed);
            };
            app.add_systems(ClothSubstepSchedule, look.after(ClothSystems::Solve).before(ClothSystems::Collide));
        }
        run(&mut app, 3);
        let seen = seen.load(Ordering::Relaxed);
        assert!(seen >= 30, "{seen} substeps seen, is a condition: {is_condition}");
    }
}
