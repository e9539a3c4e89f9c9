//! Wrong data of a collider is told with entity, field, value and what is allowed; cloth falls past it until it is
//! mended.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// Spawns a collider with `bad` under a falling cloth. Checks that it is refused once, with all of `says` in what is
/// told, and that the cloth falls past it and rests on it once it is `mended`.
fn refused_until_mended(bad: impl Bundle, mended: impl Bundle, says: &[&str]) {
    let mut app = headless();
    note_events::<ColliderRejected>(&mut app);
    let flat = Transform::from_xyz(0.0, 0.05, 0.0).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.3, 0.3).with_cells(6, 6), flat)).id();
    let collider = app.world_mut().spawn(bad).id();
    run(&mut app, 64);
    let told = seen::<ColliderRejected>(&app);
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert_eq!(told[0].entity, collider);
    let message = told[0].error.to_string();
    assert!(says.iter().all(|part| message.contains(part)), "`{message}` does not say all of {says:?}");
    assert!(centre(&app, cloth).y < -3.0, "the cloth lies on a collider that was refused");

    app.world_mut().entity_mut(collider).insert(mended);
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 64);
    assert!(centre(&app, cloth).y > -1.0, "the cloth falls past the mended collider");
    assert_eq!(seen::<ColliderRejected>(&app).len(), 1);
}

#[test]
fn a_ball_of_no_size() {
    let good = ClothCollider::Sphere { radius: 0.5 };
    refused_until_mended(ClothCollider::Sphere { radius: 0.0 }, (good, below(0.5)), &["radius", "0", "allowed"]);
}

#[test]
fn a_capsule_whose_length_is_no_number() {
    let bad = ClothCollider::Capsule { radius: 0.5, length: f32::NAN };
    let good = ClothCollider::Capsule { radius: 0.5, length: 0.5 };
    refused_until_mended(bad, (good, below(0.75)), &["length", "NaN", "allowed"]);
}

#[test]
fn a_box_of_negative_height() {
    let good = ClothCollider::Cuboid { size: Vec3::ONE };
    refused_until_mended(
        ClothCollider::Cuboid { size: Vec3::new(1.0, -1.0, 1.0) },
        (good, below(0.5)),
        &["size", "-1"],
    );
}

#[test]
fn a_pyramid_of_no_height() {
    let good = ClothCollider::Pyramid { base: Vec2::splat(4.0), height: 0.5 };
    refused_until_mended(
        ClothCollider::Pyramid { base: Vec2::splat(4.0), height: 0.0 },
        (good, below(0.25)),
        &["height", "0", "allowed"],
    );
}

#[test]
fn a_convex_solid_that_has_no_end() {
    let bad = ClothCollider::Convex { planes: vec![Vec4::new(0.0, 1.0, 0.0, 0.0)] };
    let planes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|n| [n.extend(0.5), (-n).extend(0.5)]).collect();
    refused_until_mended(bad, (ClothCollider::Convex { planes }, below(0.5)), &["planes", "allowed"]);
}

#[test]
fn a_convex_solid_with_a_normal_of_no_length() {
    let bad = ClothCollider::Convex { planes: vec![Vec4::W] };
    refused_until_mended(bad, (ClothCollider::Cuboid { size: Vec3::ONE }, below(0.5)), &["planes", "0", "allowed"]);
}

#[test]
fn a_capsule_scaled_differently_along_its_axes() {
    let capsule = ClothCollider::Capsule { radius: 0.2, length: 0.1 };
    let bad = below(0.5).with_scale(Vec3::new(2.0, 1.0, 2.0));
    let good = below(0.5).with_scale(Vec3::splat(2.0));
    refused_until_mended((capsule, bad), good, &["Transform::scale", "1", "same on all axes"]);
}

#[test]
fn a_cylinder_scaled_differently_across_its_axis() {
    let cylinder = ClothCollider::Cylinder { radius: 0.25, height: 0.5 };
    let bad = below(0.5).with_scale(Vec3::new(2.0, 2.0, 1.0));
    let good = below(0.5).with_scale(Vec3::new(2.0, 2.0, 2.0));
    refused_until_mended((cylinder, bad), good, &["Transform::scale", "1", "same along x and z"]);
}

#[test]
fn a_hull_of_points_in_one_plane() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::X + Vec3::Z];
    let points = square.into_iter().flat_map(|p| [p - 0.5, p - 0.5 + Vec3::Y]).collect();
    let good = ClothCollider::Hull { points };
    let bad = ClothCollider::Hull { points: square.to_vec() };
    refused_until_mended(bad, (good, below(0.5)), &["depth of ClothCollider::Hull.points", "0", "allowed"]);
}

#[test]
fn a_height_field_with_a_height_too_few() {
    let field = |count| {
        let (size, cells) = (Vec2::ONE, UVec2::new(2, 3));
        ClothCollider::HeightField { size, cells, heights: vec![0.0; count], thickness: 0.1 }
    };
    refused_until_mended(field(11), (field(12), below(0.1)), &["heights.len()", "11", "(cells.x + 1) * (cells.y + 1)"]);
}

#[test]
fn a_ground_that_is_nowhere_from_the_start() {
    let bad = (ClothCollider::Ground, Transform::from_xyz(0.0, f32::NAN, 0.0));
    refused_until_mended(bad, below(0.0), &["Transform", "NaN", "finite"]);
}

#[test]
fn friction_below_zero() {
    let bad = (ClothCollider::Ground, ColliderFriction(-0.1));
    refused_until_mended(bad, ColliderFriction(0.5), &["ColliderFriction", "-0.1", "0..=10"]);
}

fn below(depth: f32) -> Transform {
    Transform::from_xyz(0.0, -depth, 0.0)
}
