//! Cloth that starts in a solid leaves it, cloth on anything sharp comes to rest without sinking in, and a strip over a bar
//! holds what friction says.

use std::f32::consts::{E, FRAC_PI_2, FRAC_PI_4, PI};

use crate::common::*;
use cloth_solver::contact::Shape;
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, Fabric, Soa3, measure};
use glam::{Quat, Vec2, Vec3};

const POPLIN: Fabric = Fabric::COTTON_POPLIN;

/// What a triangle at rest may be deep in a solid, m.
const MOST_DEPTH: f32 = 0.1 * POPLIN.thickness + 2e-4;

fn pyramid() -> Shape {
    Shape::pyramid(Vec2::splat(0.5), 0.4).unwrap()
}

#[test]
fn cloth_spawned_in_a_solid_leaves_it_and_rests() {
    let shapes = [
        ("a sphere", Shape::sphere(0.25).unwrap()),
        ("a box", Shape::cuboid(Vec3::splat(0.4)).unwrap()),
        ("a pyramid", pyramid()),
    ];
    for (name, shape) in shapes.into_iter().skip(cases(2, 0)) {
        let mut cloth = laid(shape, Quat::IDENTITY, 0.01);
        run(&mut cloth, 10.0);
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest_triangle(&cloth));
        assert!(speed < 0.03, "{speed} m/s on {name} 10 s later");
        assert!(depth < MOST_DEPTH, "{depth} m in {name} 10 s later");
    }
}

#[test]
fn cloth_rests_on_what_is_sharp_and_no_triangle_sinks_in() {
    let edge_up = Quat::from_rotation_x(1.2) * Quat::from_rotation_y(FRAC_PI_4);
    let corner_up = Quat::from_rotation_x(0.6154) * Quat::from_rotation_z(FRAC_PI_4);
    let solids = [
        ("an apex", pyramid(), Quat::IDENTITY),
        ("an edge", pyramid(), edge_up),
        ("a face", pyramid(), Quat::from_rotation_x(-1.03)),
        ("a corner", Shape::cuboid(Vec3::splat(0.35)).unwrap(), corner_up),
        ("a box", Shape::cuboid(Vec3::splat(0.35)).unwrap(), Quat::IDENTITY),
        ("a ball", Shape::sphere(0.2).unwrap(), Quat::IDENTITY),
        ("a bar", Shape::capsule(0.02, 0.6).unwrap(), Quat::from_rotation_z(FRAC_PI_2)),
    ];
    for (name, shape, rotation) in solids.into_iter().step_by(cases(3, 1)) {
        let mut cloth = laid(shape, rotation, 0.3);
        run(&mut cloth, 12.0);
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest_triangle(&cloth));
        assert!(speed < 0.03, "{speed} m/s on {name}");
        assert!(depth < MOST_DEPTH, "{depth} m into {name}");
    }
}

/// How far a strip slides in so many ticks over a bar that it goes half round, pulled at one end `ratio` times as hard as at the other,
/// m.
fn slides(ratio: f32, friction: f32, ticks: u32) -> f32 {
    let (radius, hanging, width) = (0.05, 0.15, 0.05);
    let length = PI * radius + 2.0 * hanging;
    let mut cloth = rectangle(width, length, 8, 76, &POPLIN);
    let around = radius + cloth.contacts.offset;
    for slot in 0..cloth.topology.slots() {
        let rest = cloth.topology.rest[slot];
        let arc = rest.y.clamp(-FRAC_PI_2 * around, FRAC_PI_2 * around);
        let (sin, cos) = (arc / around).sin_cos();
        let x = Vec3::new(rest.x, around * cos - (rest.y - arc).abs(), around * sin);
        cloth.particles.position.set(slot, x);
        cloth.particles.previous.set(slot, x);
    }
    let bar = Shape::capsule(radius, 0.4).unwrap();
    cloth.contacts.set_colliders([collider(bar, Vec3::ZERO, Quat::from_rotation_z(FRAC_PI_2), friction)]);
    let ends = [-1.0_f32, 1.0].map(|side| -> Vec<usize> {
        let is_end = |slot: &usize| side * cloth.topology.rest[*slot].y > 0.499 * length;
        cloth.topology.particles().map(|p| p as usize).filter(is_end).collect()
    });
    let drop = |cloth: &Cloth, slots: &[usize]| -> f32 {
        slots.iter().map(|slot| cloth.particles.position.y[*slot]).sum::<f32>() / slots.len() as f32
    };
    let mut start = [0.0; 2];
    for tick in 0..60 + ticks {
        // Slowly to the full pull, as much at both ends, in the first second.
        let pull = 0.2 * (tick as f32 / 60.0).min(1.0);
        let ratio = if tick < 60 { 1.0 } else { ratio };
        let mut force = Soa3::zeros(cloth.topology.slots());
        for (slots, pull) in ends.iter().zip([pull, ratio * pull]) {
            for slot in slots {
                force.set(*slot, Vec3::NEG_Y * (pull / slots.len() as f32));
            }
        }
        cloth.particles.force = Some(force);
        cloth.step(TICK, Vec3::ZERO);
        if tick < 60 {
            start = [drop(&cloth, &ends[0]), drop(&cloth, &ends[1])];
        }
    }
    0.5 * ((drop(&cloth, &ends[0]) - start[0]) - (drop(&cloth, &ends[1]) - start[1]))
}

#[test]
fn a_strip_over_a_bar_holds_up_to_the_load_of_friction_around_it() {
    for friction in [0.2, 0.4] {
        let limit = E.powf(friction * PI);
        let (holds, slips) = (slides(0.95 * limit, friction, 180), slides(1.05 * limit, friction, 12));
        assert!(holds.abs() < 1e-3, "slides {holds} m under 0.95 of what friction {friction} holds");
        assert!(slips > 0.01, "slides {slips} m under 1.05 of what friction {friction} holds");
    }
}

#[test]
fn a_ball_that_touches_cloth_beside_a_pin_throws_nothing() {
    for (columns, gap) in [(5, 0.0), (5, -0.002), (12, 0.0), (24, -0.001)] {
        let mut cloth = rectangle(0.4, 0.43, columns, 3, &POPLIN);
        cloth.air = Some(Air::default());
        hold(&mut cloth, |rest| rest.y > 0.2149);
        let at = cloth.topology.rest[2] + Vec3::new(1e-6, -2e-4, 0.1 + gap);
        let ball = collider(Shape::sphere(0.1).unwrap(), at, Quat::IDENTITY, POPLIN.friction);
        let mut most = 0.0_f32;
        for _ in 0..240 {
            cloth.contacts.set_colliders([ball.clone()]);
            cloth.step(TICK, GRAVITY);
            most = most.max(fastest(&cloth));
        }
        assert!(most < 0.5, "{most} m/s beside a ball of gap {gap} m, {columns} columns");
    }
}
