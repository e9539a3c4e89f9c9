//! Cloth that is suddenly deep inside a solid: spawned there, or the solid put over it.

use crate::common::*;
use cloth_solver::contact::Shape;
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, Fabric, measure};
use glam::{Quat, Vec2, Vec3};

/// 0..1 by hash.
fn random(case: u32, which: u32) -> f32 {
    let hash = (case * 31 + which + 1).wrapping_mul(0x9E37_79B9);
    ((hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8) as f32 / 16_777_216.0
}

fn solid(case: u32, size: f32) -> (Shape, Quat) {
    let turn = |which| random(case, which) * std::f32::consts::TAU;
    let shape = match case % 8 {
        0 => Shape::sphere(0.5 * size),
        1 => Shape::cuboid(Vec3::new(1.0, 0.7, 0.5) * size),
        2 => Shape::pyramid(Vec2::splat(size), size),
        3 => Shape::capsule(0.25 * size, size),
        4 => Shape::cylinder(0.4 * size, size),
        5 => Shape::cone(0.5 * size, size),
        6 => Shape::ellipsoid(Vec3::new(0.6, 0.4, 0.3) * size),
        _ => Shape::rounded_cuboid(Vec3::new(1.0, 0.7, 0.5) * size, 0.05 * size),
    };
    (shape.unwrap(), Quat::from_euler(glam::EulerRot::XYZ, turn(1), turn(2), turn(3)))
}

/// The deepest that the middle of any edge of the cloth is in a solid, m.
fn deepest_middle(cloth: &Cloth, shape: &Shape, (at, rotation): (Vec3, Quat)) -> f32 {
    let place = |slot: u32| cloth.particles.position.get(slot as usize);
    let depth = |&[a, b]: &[u32; 2]| {
        let middle = rotation.inverse() * (0.5 * (place(a) + place(b)) - at);
        -shape.distance_and_normal(middle).0
    };
    cloth.topology.edges.iter().map(depth).fold(0.0, f32::max)
}

#[test]
fn cloth_spawned_in_a_solid_leaves_it_whole_and_slowly_and_rests() {
    for case in 0..cases(3, 10) {
        let size = 0.2 + 0.2 * random(case, 0);
        let (shape, rotation) = solid(case, size);
        let at = Vec3::new(random(case, 4) - 0.5, random(case, 5) - 0.7, 0.2 * (random(case, 6) - 0.5)) * 0.5;
        let [columns, rows] = [7, 8].map(|which| 16 + (16.0 * random(case, which)) as u32);
        let mut cloth = if case % 3 == 0 {
            irregular_mesh(Vec2::new(0.8, 1.0), [columns, rows], &Fabric::COTTON_POPLIN)
        } else {
            rectangle(0.8, 1.0, columns, rows, &Fabric::COTTON_POPLIN)
        };
        cloth.air = Some(Air::default());
        let is_held = case % 5 != 0;
        if is_held {
            hold(&mut cloth, |rest| rest.y > 0.4999);
        }
        let floor = collider(Shape::HalfSpace, Vec3::NEG_Y * 1.2, Quat::IDENTITY, 0.3);
        cloth.contacts.set_colliders([collider(shape.clone(), at, rotation, 0.3), floor]);
        for _ in 0..60 {
            let (before, leaves) = (positions(&cloth), cloth.contacts.is_leaving());
            cloth.step(TICK, GRAVITY);
            let moved = positions(&cloth).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            // What has left may fall, faster.
            let is_slow = moved < 3.5 * TICK.dt || !leaves && !cloth.contacts.is_leaving() || !is_held;
            assert!(is_slow, "{} m/s out of solid {case}", moved / TICK.dt);
        }
        run(&mut cloth, 7.0);
        let depth = deepest_middle(&cloth, &shape, (at, rotation));
        assert!(depth < 0.05 * size, "an edge passes {depth} m deep through solid {case} of {size} m");
        let strain = measure::largest_strain(&cloth.topology, &cloth.particles);
        assert!(strain < 0.3, "a strain of {strain} on solid {case}");
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.03, "{speed} m/s on solid {case}");
        assert!(!cloth.contacts.is_leaving(), "out of solid {case} since long, and still held back");
    }
}
