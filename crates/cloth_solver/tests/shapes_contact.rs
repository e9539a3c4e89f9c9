//! Cloth on colliders of every further form: it comes to rest there, and no triangle sinks in.

mod common;

use std::f32::consts::FRAC_PI_2;

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::{Cloth, Fabric, measure};
use common::*;
use glam::{Quat, Vec3};

const POPLIN: Fabric = Fabric::COTTON_POPLIN;

/// A sheet of 0.8 m that lies `above` the middle of a solid, which stands above ground at −0.3 m.
fn laid(shape: Shape, rotation: Quat, above: f32) -> Cloth {
    let mut cloth = rectangle(0.8, 0.8, 32, 32, &POPLIN);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.01, above, 0.02));
    let ground = collider(Shape::HalfSpace, Vec3::Y * -0.3, Quat::IDENTITY, POPLIN.friction);
    cloth.contacts.set_colliders([collider(shape, Vec3::ZERO, rotation, POPLIN.friction), ground]);
    cloth
}

/// How far the deepest point of a triangle, its corners included, is inside a collider, m.
fn deepest(cloth: &Cloth) -> f32 {
    let depth =
        |collider: &Collider, x: Vec3| -collider.shape.distance_and_normal(collider.motion.to.inverse_point(x)).0;
    let steps = 8;
    let shares = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| [i, j].map(|k| k as f32 / steps as f32)));
    let shares: Vec<[f32; 2]> = shares.collect();
    let mut deepest = f32::NEG_INFINITY;
    for triangle in &cloth.topology.triangles {
        let [a, b, c] = triangle.map(|slot| cloth.particles.position.get(slot as usize));
        for [u, v] in &shares {
            let x = a * (1.0 - u - v) + b * *u + c * *v;
            for collider in &cloth.contacts.colliders {
                deepest = deepest.max(depth(collider, x));
            }
        }
    }
    deepest
}

/// Lays a sheet over each and tells which of them it does not rest on, or sinks into by more than `most_depth`, m.
fn failures(cases: Vec<(&str, Shape, Quat, f32)>) -> Vec<String> {
    let mut failures = Vec::new();
    for (name, shape, rotation, most_depth) in cases {
        let mut cloth = laid(shape, rotation, 0.3);
        run(&mut cloth, 12.0);
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest(&cloth));
        let line = format!("{name}: {speed} m/s, {depth} m deep, {} contacts", cloth.contacts.touching);
        let is_at_rest = speed < 0.03 && depth < most_depth && cloth.contacts.touching > 50;
        failures.extend((!is_at_rest).then_some(line));
    }
    failures
}

#[test]
fn cloth_rests_on_curved_solids_and_no_triangle_sinks_in() {
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    let tilted = Quat::from_rotation_x(0.6) * Quat::from_rotation_z(0.5);
    // What triangles and edges meet lies inside: of a cylinder or a cone half a percent of the radius, of an ellipsoid 7 % of an axis.
    let shapes = failures(vec![
        ("a lying cylinder", Shape::cylinder(0.1, 0.5).unwrap(), lying, 1e-3),
        ("a thin bar", Shape::cylinder(0.01, 0.6).unwrap(), lying, 3e-4),
        ("the apex of a cone", Shape::cone(0.25, 0.4).unwrap(), Quat::IDENTITY, 1.5e-3),
        ("an egg", Shape::ellipsoid(Vec3::new(0.2, 0.12, 0.15)).unwrap(), tilted, 3e-3),
        ("a rounded box", Shape::rounded_cuboid(Vec3::splat(0.35), 0.03).unwrap(), Quat::IDENTITY, 3e-4),
        ("the corner of a rounded box", Shape::rounded_cuboid(Vec3::splat(0.35), 0.1).unwrap(), tilted, 3e-4),
    ]);
    assert!(shapes.is_empty(), "{shapes:#?}");
}
