//! A curtain reset into the floor leaves it slowly.

use crate::common::*;
use cloth_solver::contact::Shape;
use cloth_solver::forces::Air;
use cloth_solver::{Fabric, measure};
use glam::{Quat, Vec3};

#[test]
fn a_curtain_reset_into_the_floor_leaves_it_slowly_and_rests() {
    for below in [0.3_f32, 0.6, 1.0].into_iter().skip(cases(2, 0)) {
        let mut cloth = rectangle(1.2, 1.5, 48, 60, &Fabric::COTTON_POPLIN);
        cloth.air = Some(Air::default());
        pin_top(&mut cloth, (0..=48).step_by(8));
        cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::Y * (below - 0.75), Quat::IDENTITY, 0.3)]);
        let mut fastest = 0.0_f32;
        for _ in 0..300 {
            let before = positions(&cloth);
            cloth.step(TICK, GRAVITY);
            let moved = positions(&cloth).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            fastest = fastest.max(moved / TICK.dt);
        }
        assert!(fastest < 3.5, "{fastest} m/s out of a floor {below} m above its hem");
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.03, "{speed} m/s 5 s later");
        assert!(!cloth.contacts.is_leaving(), "out of the floor since long, and still held back");
    }
}

#[test]
fn cloth_that_leaves_a_solid_is_free_at_once_where_that_is_taken_away() {
    let mut cloth = rectangle(0.5, 0.5, 12, 12, &Fabric::COTTON_POPLIN);
    let ball = collider(Shape::sphere(0.2).unwrap(), Vec3::ZERO, Quat::IDENTITY, 0.3);
    cloth.contacts.set_colliders([ball]);
    cloth.step(TICK, GRAVITY);
    assert!(cloth.contacts.is_leaving());
    cloth.contacts.set_colliders([]);
    cloth.step(TICK, GRAVITY);
    assert!(!cloth.contacts.is_leaving());
}
