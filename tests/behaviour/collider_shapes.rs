//! Colliders of every shape hold cloth, under a scale and as children too; a mesh may come later.

use std::f32::consts::FRAC_PI_2;

use crate::common::*;
use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_cloth::*;

/// A small cloth that lies flat at this height above the origin.
fn flat(height: f32) -> impl Bundle {
    let flat = Transform::from_xyz(0.0, height, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    (Cloth::rectangle(0.3, 0.3).with_cells(8, 8), Air::default(), flat)
}

/// How high the highest point of the cloth is, m.
fn top(app: &App, cloth: Entity) -> f32 {
    world_positions(app, cloth).iter().map(|x| x.y).fold(f32::NEG_INFINITY, f32::max)
}

/// A cloth lies on the collider, whose highest point is `height` above the origin, after two seconds.
fn holds(collider: impl Bundle, height: f32) {
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn(flat(height + 0.05)).id();
    app.world_mut().spawn(collider);
    run(&mut app, 128);
    let top = top(&app, cloth);
    assert!((height - 0.01..height + 0.02).contains(&top), "the cloth hangs at {top} m on what is {height} m high");
}

/// Two triangles in the plane of x and z.
fn sheet(half: f32) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, z)| [x * half, 0.0, z * half]);
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners.to_vec())
        .with_inserted_indices(Indices::U32(vec![0, 2, 1, 1, 2, 3]))
}

#[test]
fn cloth_lies_on_every_solid() {
    let octahedron = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [0.2 * axis, -0.2 * axis]).collect();
    holds(ClothCollider::Ellipsoid { radii: Vec3::new(0.3, 0.1, 0.2) }, 0.1);
    holds(ClothCollider::Cylinder { radius: 0.2, height: 0.3 }, 0.15);
    holds(ClothCollider::Cone { radius: 0.2, height: 0.2 }, 0.1);
    holds(ClothCollider::RoundedCuboid { size: Vec3::splat(0.4), radius: 0.05 }, 0.2);
    holds(ClothCollider::Hull { points: octahedron }, 0.2);
}

#[test]
fn cloth_lies_on_a_height_field() {
    let heights = (0..25).map(|i| if i == 12 { 0.1 } else { 0.0 }).collect();
    let (size, cells) = (Vec2::ONE, UVec2::splat(4));
    holds(ClothCollider::HeightField { size, cells, heights, thickness: 0.01 }, 0.105);
}

#[test]
fn a_sphere_under_a_scale_that_differs_between_its_axes_is_an_ellipsoid() {
    let scale = Transform::from_scale(Vec3::new(1.0, 0.5, 2.0));
    holds((ClothCollider::Sphere { radius: 0.2 }, scale), 0.1);
}

#[test]
fn solids_take_the_scale_of_their_transform() {
    holds(
        (ClothCollider::Cylinder { radius: 0.1, height: 0.1 }, Transform::from_scale(Vec3::new(2.0, 3.0, 2.0))),
        0.15,
    );
    let points = [Vec3::NEG_Y, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z].to_vec();
    holds((ClothCollider::Hull { points }, Transform::from_scale(Vec3::splat(0.2))), 0.2);
    // Upside down its pit is a hill.
    let heights = (0..9).map(|i| if i == 4 { -0.2 } else { 0.0 }).collect();
    let field = ClothCollider::HeightField { size: Vec2::ONE, cells: UVec2::splat(2), heights, thickness: 0.01 };
    holds((field, Transform::from_scale(Vec3::new(1.0, -0.5, 1.0))), 0.105);
}

#[test]
fn a_mesh_holds_cloth_from_when_it_is_loaded() {
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn(flat(0.5)).id();
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    note_events::<ColliderRejected>(&mut app);
    app.world_mut().spawn((ClothCollider::Mesh { thickness: 0.02 }, Mesh3d(handle.clone())));
    run(&mut app, 64);
    assert!(top(&app, cloth) < 0.0, "the cloth lies on a mesh that is not there");
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, sheet(1.0)).unwrap();
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 128);
    let lies = top(&app, cloth);
    assert!((0.005..0.02).contains(&lies), "the cloth lies at {lies} m");
    assert!(seen::<ColliderRejected>(&app).is_empty(), "waiting is nothing wrong");

    // It follows a change of the mesh.
    *app.world_mut().resource_mut::<Assets<Mesh>>().get_mut(&handle).unwrap() =
        sheet(0.01).translated_by(Vec3::X * 9.0);
    run(&mut app, 64);
    assert!(top(&app, cloth) < -0.5, "the cloth lies on the mesh as it was");
}

#[test]
fn a_mesh_without_triangles_is_refused() {
    let mut app = with_meshes();
    note_events::<ColliderRejected>(&mut app);
    let lines = Mesh::new(PrimitiveTopology::LineList, RenderAssetUsages::default());
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(lines);
    let collider = app.world_mut().spawn((ClothCollider::Mesh { thickness: 0.01 }, Mesh3d(handle))).id();
    run(&mut app, 3);
    let told = seen::<ColliderRejected>(&app);
    assert!(
        told.len() == 1 && told[0].entity == collider && told[0].error.to_string().contains("LineList"),
        "{told:?}"
    );
}

#[test]
fn a_solid_of_several_children_moves_with_its_parent() {
    let mut app = headless();
    let cloth = app.world_mut().spawn(flat(0.13)).id();
    let side = |x: f32| (ClothCollider::Cuboid { size: Vec3::new(0.2, 0.2, 0.4) }, Transform::from_xyz(x, 0.0, 0.0));
    let parent = app.world_mut().spawn((Transform::default(), children![side(-0.1), side(0.1)])).id();
    run(&mut app, 64);
    assert!((0.09..0.13).contains(&centre(&app, cloth).y), "the cloth lies on the children");
    // 0.3 m/s up and aside: friction takes the cloth along.
    for _ in 0..64 {
        let mut transform = app.world_mut().get_mut::<Transform>(parent).unwrap();
        transform.translation += Vec3::new(0.1, 0.3, 0.0) / 64.0;
        app.update();
    }
    run(&mut app, 8);
    let now = centre(&app, cloth);
    assert!((0.39..0.43).contains(&now.y) && now.x > 0.05, "the cloth stayed behind at {now}");
    app.world_mut().despawn(parent);
    run(&mut app, 64);
    assert!(centre(&app, cloth).y < 0.0, "the children are gone with their parent");
}
