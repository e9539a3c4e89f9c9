//! Cloth on colliders: it stays outside, comes to rest, sticks and slides as friction says, and leaves gently.

use std::f32::consts::FRAC_PI_2;

use crate::common::*;
use cloth_solver::contact::{Collider, DEPENETRATION_SPEED, Shape};
use cloth_solver::{Cloth, Fabric, Motion, Pose, measure};
use glam::{Quat, Vec2, Vec3};

/// Lays a metre of cotton over a collider at (0, 0.2, 0) that stands on the ground at −0.3 m, for `seconds`.
fn drape(shape: Shape, rotation: Quat, aside: f32, cells: u32, seconds: f32) -> Cloth {
    let fabric = Fabric::COTTON_POPLIN;
    let mut cloth = rectangle(1.0, 1.0, cells, cells, &fabric);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(aside, 0.6, 0.03));
    let solid = collider(shape, Vec3::new(0.0, 0.2, 0.0), rotation, fabric.friction);
    let ground = collider(Shape::HalfSpace, Vec3::new(0.0, -0.3, 0.0), Quat::IDENTITY, fabric.friction);
    cloth.contacts.set_colliders([solid, ground]);
    run(&mut cloth, seconds);
    cloth
}

fn deepest(cloth: &Cloth) -> f32 {
    let depth = |collider: &Collider, x: Vec3| {
        let (distance, _) = collider.shape.distance_and_normal(collider.motion.to.inverse_point(x));
        cloth.contacts.offset - distance
    };
    let all = cloth.contacts.colliders.iter().flat_map(|c| positions(cloth).into_iter().map(move |x| depth(c, x)));
    all.fold(f32::NEG_INFINITY, f32::max)
}

/// Nothing deeper than a tenth of the distance kept, and hardly a motion, after ten seconds.
fn rests(cloth: &Cloth, what: &str) {
    let depth = deepest(cloth);
    assert!(depth < 0.1 * cloth.contacts.offset, "{depth} m into the {what}");
    let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
    assert!(speed < 0.03, "{speed} m/s on the {what}");
    assert!(cloth.contacts.touching > 50, "lies on the {what}");
}

fn pyramid() -> Shape {
    Shape::pyramid(Vec2::splat(0.6), 0.5).unwrap()
}

#[test]
fn cloth_rests_on_a_sphere() {
    rests(&drape(Shape::sphere(0.3).unwrap(), Quat::IDENTITY, 0.0, 40, 10.0), "sphere");
}

#[test]
fn cloth_rests_on_a_capsule() {
    let lying = Quat::from_rotation_z(FRAC_PI_2);
    rests(&drape(Shape::capsule(0.15, 0.5).unwrap(), lying, 0.0, 40, 10.0), "capsule");
}

#[test]
fn cloth_rests_on_the_apex_of_a_pyramid() {
    rests(&drape(pyramid(), Quat::IDENTITY, 0.0, 40, 10.0), "apex");
}

#[test]
fn cloth_rests_on_the_edge_of_a_pyramid() {
    let edge_up = Quat::from_rotation_x(1.2) * Quat::from_rotation_y(std::f32::consts::FRAC_PI_4);
    rests(&drape(pyramid(), edge_up, 0.0, 40, 10.0), "edge");
}

#[test]
fn cloth_rests_on_the_face_of_a_pyramid() {
    rests(&drape(pyramid(), Quat::from_rotation_x(-1.03), 0.2, 40, 10.0), "face");
}

#[test]
fn cloth_rests_on_the_corner_of_a_box() {
    let corner_up = Quat::from_rotation_x(0.6154) * Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
    rests(&drape(Shape::cuboid(Vec3::splat(0.5)).unwrap(), corner_up, 0.0, 40, 10.0), "corner");
}

#[test]
fn finely_divided_cloth_rests_on_a_pyramid_as_well() {
    rests(&drape(pyramid(), Quat::IDENTITY, 0.0, cases(48, 80), cases(6.0, 10.0)), "apex");
}

/// A small sheet on ground that slopes by `degrees`; how far it slid along the slope in `seconds`.
fn slide(degrees: f32, friction: f32, seconds: f32) -> f32 {
    let slope = Quat::from_rotation_z(-degrees.to_radians());
    let mut cloth = rectangle(0.3, 0.3, 12, 12, &UNDAMPED);
    let up = slope * Vec3::Y * cloth.contacts.offset;
    place(&mut cloth, slope * Quat::from_rotation_x(-FRAC_PI_2), up);
    cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::ZERO, slope, friction)]);
    run(&mut cloth, seconds);
    let centre = measure::centre_of_mass(&cloth.particles).as_vec3();
    (centre - up).dot(slope * Vec3::X)
}

#[test]
fn cloth_sticks_to_a_slope_that_is_less_steep_than_its_friction() {
    let moved = slide(20.0, 0.37, 5.0);
    assert!(moved.abs() < 1e-3, "crept {moved} m");
}

#[test]
fn cloth_slides_down_a_steeper_slope_at_coulombs_rate() {
    for (degrees, friction) in [(20.0_f32, 0.2_f32), (35.0, 0.5), (60.0, 0.1)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let expected = 0.5 * 9.81 * (sin - friction * cos);
        let moved = slide(degrees, friction, 1.0);
        assert!((moved / expected - 1.0).abs() < 0.03, "{moved} m, not {expected} m");
    }
}

/// The fastest any particle moves in a tick while the cloth leaves the collider it was put into, m/s.
fn escape_speed(cloth: &mut Cloth) -> f32 {
    let mut fastest = 0.0_f32;
    for _ in 0..120 {
        let before = positions(cloth);
        cloth.step(TICK, Vec3::ZERO);
        let moved = positions(cloth).iter().zip(&before).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        fastest = fastest.max(moved / TICK.dt);
    }
    fastest
}

#[test]
fn cloth_put_a_metre_under_the_ground_rises_at_the_depenetration_speed() {
    let mut cloth = rectangle(0.4, 0.4, 16, 16, &Fabric::COTTON_POPLIN);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), -Vec3::Y);
    cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, 0.3)]);
    let fastest = escape_speed(&mut cloth);
    assert!((fastest / DEPENETRATION_SPEED - 1.0).abs() < 0.01, "{fastest} m/s");
    assert!(deepest(&cloth) < 0.1 * cloth.contacts.offset, "is out");
    assert!(measure::rms_speed(&cloth.topology, &cloth.particles) < 1e-3, "and the push is no speed");
}

#[test]
fn cloth_put_half_into_a_solid_leaves_it_gently() {
    for shape in [Shape::sphere(0.4).unwrap(), Shape::cuboid(Vec3::splat(0.8)).unwrap()] {
        let mut cloth = rectangle(0.4, 0.4, 16, 16, &Fabric::COTTON_POPLIN);
        place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::Y * 0.33);
        cloth.contacts.set_colliders([collider(shape, Vec3::ZERO, Quat::IDENTITY, 0.3)]);
        let fastest = escape_speed(&mut cloth);
        assert!(fastest < 1.5 * DEPENETRATION_SPEED, "{fastest} m/s");
        assert!(deepest(&cloth) < 0.1 * cloth.contacts.offset, "is out");
    }
}

#[test]
fn a_moving_collider_carries_cloth_along() {
    let mut cloth = rectangle(0.5, 0.5, 20, 20, &Fabric::COTTON_POPLIN);
    let up = Vec3::Y * cloth.contacts.offset;
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), up);
    let mut x = 0.0;
    for _ in 0..60 {
        let next = x + 0.3 * TICK.dt;
        let pose = |x: f32| Pose::new(Vec3::X * x, Quat::IDENTITY);
        let motion = Motion { from: pose(x), to: pose(next) };
        cloth.contacts.set_colliders([Collider { shape: Shape::HalfSpace, motion, friction: 0.8 }]);
        cloth.step(TICK, GRAVITY);
        x = next;
    }
    let carried = measure::centre_of_mass(&cloth.particles).x;
    assert!((carried - 0.3).abs() < 0.01, "{carried} m");
}
