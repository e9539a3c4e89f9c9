//! Two clothes may share one mesh asset: each simulates and draws a copy of its own, and the asset stays as it is.

use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_cloth::*;

fn positions(app: &App, handle: &Handle<Mesh>) -> Vec<[f32; 3]> {
    let mesh = app.world().resource::<Assets<Mesh>>().get(handle).expect("the mesh exists");
    match mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(positions)) => positions.clone(),
        other => panic!("positions are {other:?}"),
    }
}

/// Two clothes from one mesh, the second hung up by other pins, run for half a second.
fn pair() -> (App, Handle<Mesh>, Vec<[f32; 3]>, [Entity; 2]) {
    let mut app = with_meshes();
    let sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(7).build();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let before = positions(&app, &handle);
    let pins = [Pins::corners(), Pins::rods(1)];
    let cloths = pins.map(|pins| app.world_mut().spawn((Cloth::mesh(), Mesh3d(handle.clone()), pins)).id());
    run(&mut app, 32);
    (app, handle, before, cloths)
}

#[test]
fn the_shared_asset_is_never_written() {
    let (app, handle, before, _) = pair();
    assert_eq!(positions(&app, &handle), before);
}

#[test]
fn each_cloth_draws_its_own_shape() {
    let (app, shared, before, cloths) = pair();
    let [first, second] = cloths.map(|cloth| get::<Mesh3d>(&app, cloth).0.clone());
    assert!(first != shared && second != shared && first != second);
    let [first, second] = [first, second].map(|handle| positions(&app, &handle));
    assert_eq!(first.len(), 2 * before.len(), "front and back");
    assert_ne!(first, second);
}

#[test]
fn a_cloth_that_is_no_more_gives_its_entity_the_shared_mesh_back() {
    let (mut app, shared, _, [first, second]) = pair();
    let meshes = app.world().resource::<Assets<Mesh>>().len();
    app.world_mut().entity_mut(first).remove::<Cloth>();
    run(&mut app, 4);
    assert_eq!(get::<Mesh3d>(&app, first).0, shared);
    assert_ne!(get::<Mesh3d>(&app, second).0, shared);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), meshes - 1, "its own mesh is still there");
}
