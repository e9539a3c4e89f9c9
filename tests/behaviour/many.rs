//! Many cloths at once move as each alone does, to the bit: on one thread or many, with or without systems between the substeps.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bevy::prelude::*;
use bevy_cloth::*;

use crate::common::*;

/// Numbers by chance, the same in every run (SplitMix64).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }

    fn whole(&mut self, low: u32, high: u32) -> u32 {
        (low + (self.next() * (high - low + 1) as f32) as u32).min(high)
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.whole(0, all.len() as u32 - 1) as usize]
    }
}

/// Spawns cloth number `index`, whose kind chance decides, and what it meets: 4 m from the next.
fn spawn(world: &mut World, index: usize) -> Entity {
    let mut chance = Chance(index as u64);
    let at = Vec3::new(4.0 * index as f32, 0.0, 0.0);
    let size = Vec2::new(chance.within(0.3, 1.5), chance.within(0.3, 1.5));
    let fabric = chance.one_of(&[
        Fabric::COTTON_POPLIN,
        Fabric::SILK_CHARMEUSE,
        Fabric::LEATHER_GARMENT,
        Fabric::FLAG_POLYESTER,
    ]);
    let pins = match chance.whole(0, 3) {
        0 => Pins::top(),
        1 => Pins::corners(),
        2 => Pins::rods(3),
        _ => Pins::region(Vec3::splat(-10.0), Vec3::new(0.01 - 0.5 * size.x, 10.0, 10.0)),
    };
    let cloth = Cloth::rectangle(size.x, size.y).with_cells(chance.whole(2, 24), chance.whole(2, 24));
    let cloth = world.spawn((cloth, fabric, pins, Transform::from_translation(at))).id();
    if chance.next() < 0.7 {
        world.entity_mut(cloth).insert((Air::default(), Wind(Vec3::new(chance.within(0.0, 12.0), 0.0, 2.0))));
    }
    if chance.next() < 0.5 {
        world.entity_mut(cloth).insert(SelfContact::default());
    }
    if chance.next() < 0.3 {
        world.entity_mut(cloth).insert(Tearable::default());
    }
    if chance.next() < 0.3 {
        world.entity_mut(cloth).insert(Substeps { count: chance.whole(1, 30), ..Substeps::default() });
    }
    if chance.next() < 0.5 {
        let ball = ClothCollider::Sphere { radius: 0.2 };
        world.spawn((ball, Transform::from_translation(at + Vec3::new(chance.within(-0.3, 0.3), -0.2, 0.1))));
    }
    cloth
}

/// Every bit of each of `cloths` after some ticks.
fn bits_after(app: &mut App, cloths: &[Entity]) -> Vec<Bits> {
    run(app, 40);
    cloths.iter().map(|cloth| Bits::of(get::<Particles>(app, *cloth))).collect()
}

const COUNT: usize = 60;

fn crowd(prepare: impl FnOnce(&mut App)) -> Vec<Bits> {
    let mut app = headless();
    prepare(&mut app);
    let cloths: Vec<Entity> = (0..COUNT).map(|index| spawn(app.world_mut(), index)).collect();
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
