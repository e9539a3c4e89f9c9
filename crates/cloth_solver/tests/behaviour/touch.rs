//! What a cloth gives to colliders is what they give to it.

use std::sync::Arc;

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, Topology, measure};
use glam::{Quat, UVec2, Vec2, Vec3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
const DT: f32 = 1.0 / 64.0;

#[test]
fn the_momentum_that_a_falling_sheet_loses_is_what_its_colliders_get() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    let shapes = [
        Shape::sphere(0.15).unwrap(),
        Shape::capsule(0.1, 0.3).unwrap(),
        Shape::cuboid(Vec3::splat(0.25)).unwrap(),
        Shape::pyramid(Vec2::splat(0.4), 0.3).unwrap(),
    ];
    let mut on_ground = 0;
    for trial in 0..12 {
        let (_, fabric) = Fabric::PRESETS[random.random_range(0..Fabric::PRESETS.len())];
        let cells = Resolution::Cells(UVec2::new(random.random_range(4..12), random.random_range(4..12)));
        let topology = Arc::new(Topology::rectangle(Vec2::splat(0.5), cells).unwrap());
        let mut cloth = Cloth::new(topology, &fabric).unwrap();
        let turn = Quat::from_euler(glam::EulerRot::YXZ, random.random_range(0.0..6.0), 1.5, 0.2);
        for slot in 0..cloth.particles.slots() {
            let place = turn * cloth.particles.position.get(slot) + Vec3::Y * 0.3;
            cloth.particles.position.set(slot, place);
            cloth.particles.previous.set(slot, place);
        }
        let place = Pose::new(Vec3::new(random.random_range(-0.1..0.1), 0.0, 0.0), Quat::from_rotation_y(trial as f32));
        let solid = |shape, pose| Collider { shape, motion: Motion::at_rest(pose), friction: 0.4 };
        let ground = Pose::new(Vec3::NEG_Y * 0.2, Quat::IDENTITY);
        cloth.contacts.set_colliders([solid(shapes[trial % 4].clone(), place), solid(Shape::HalfSpace, ground)]);
        let mass: f32 = cloth.particles.mass.iter().sum();
        let (mut largest, mut touched) = (0.0_f32, [false; 2]);
        for tick in 0..96 {
            let before = measure::linear_momentum(&cloth.particles).as_vec3();
            cloth.step(Tick::fixed(DT, 20), GRAVITY);
            let gained = measure::linear_momentum(&cloth.particles).as_vec3() - before;
            let given: Vec3 = cloth.contacts.touches.iter().map(|touch| touch.impulse).sum();
            touched = [0, 1].map(|i| touched[i] || cloth.contacts.touches[i].touching > 0);
            // The first half of the first substep has no kick.
            if tick > 0 {
                largest = largest.max((GRAVITY * mass * DT - given - gained).length());
            }
        }
        // Of the momentum after a metre of fall.
        let error = largest / (mass * 4.4);
        assert!(error < 1e-5, "trial {trial}: {error}");
        assert!(touched[0], "trial {trial} met nothing");
        on_ground += usize::from(touched[1]);
    }
    assert!(on_ground > 0, "none reached the ground");
}
