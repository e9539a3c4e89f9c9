//! Cloth on colliders of every further form: it comes to rest there, and no triangle sinks in.

use std::f32::consts::FRAC_PI_2;

use crate::common::*;
use cloth_solver::contact::Shape;
use cloth_solver::measure;
use glam::{Quat, Vec3};

/// Lays a sheet over each and tells which of them it does not rest on, or sinks into by more than `most_depth`, m.
fn failures(solids: Vec<(&str, Shape, Quat, f32)>) -> Vec<String> {
    let mut failures = Vec::new();
    for (name, shape, rotation, most_depth) in solids.into_iter().step_by(cases(3, 1)) {
        let mut cloth = laid(shape, rotation, 0.3);
        run(&mut cloth, cases(9.0, 12.0));
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest_triangle(&cloth));
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
