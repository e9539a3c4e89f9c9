//! A cloth made from a mesh waits for the mesh, and reads it anew when it changes.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// A sheet of `cells` × `cells` in the xy plane, 1 m × 1 m.
fn sheet(cells: u32) -> Mesh {
    Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(cells - 1).build()
}

fn particles(app: &App, cloth: Entity) -> Option<usize> {
    app.world().get::<ClothTopology>(cloth).map(|topology| topology.particle_count())
}

#[test]
fn a_cloth_waits_for_a_mesh_that_loads_later() {
    let mut app = with_meshes();
    note_events::<ClothRejected>(&mut app);
    let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(handle.clone()), Pins::top())).id();
    run(&mut app, 10);
    assert_eq!(particles(&app, cloth), None);
    assert_eq!(get::<Mesh3d>(&app, cloth).0, handle, "it drew something before there was anything to draw");
    app.world_mut().resource_mut::<Assets<Mesh>>().insert(&handle, sheet(8)).expect("the handle is reserved");
    run(&mut app, 10);
    assert_eq!(particles(&app, cloth), Some(81));
    assert!(centre(&app, cloth).y < 0.0, "it does not fall");
    assert_eq!(seen::<ClothRejected>(&app), [], "waiting is no fault");
}

#[test]
fn a_cloth_waits_for_a_mesh_component_that_comes_later() {
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn(Cloth::mesh()).id();
    run(&mut app, 4);
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet(4));
    app.world_mut().entity_mut(cloth).insert(Mesh3d(handle));
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), Some(25));
}

#[test]
fn a_cloth_without_mesh_assets_in_the_app_waits_without_a_fault() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d::default())).id();
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), None);
    assert_eq!(take_messages::<ClothRejected>(&mut app), []);
}

#[test]
fn another_mesh_on_the_entity_makes_another_cloth() {
    let mut app = with_meshes();
    let [small, large] = [4, 8].map(|cells| app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet(cells)));
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(small))).id();
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), Some(25));
    app.world_mut().entity_mut(cloth).insert(Mesh3d(large.clone()));
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), Some(81));
    assert_ne!(get::<Mesh3d>(&app, cloth).0, large, "it draws into the user's mesh");
}

#[test]
fn a_mesh_that_is_edited_makes_the_cloth_anew() {
    let mut app = with_meshes();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet(4));
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(handle.clone()))).id();
    run(&mut app, 4);
    *app.world_mut().resource_mut::<Assets<Mesh>>().get_mut(&handle).expect("it was added") = sheet(8);
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), Some(81));
}

#[test]
fn a_mesh_that_is_no_cloth_is_refused_and_a_good_one_taken() {
    let mut app = with_meshes();
    note_events::<ClothRejected>(&mut app);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let empty = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleList, default());
    let lines = Mesh::new(bevy::mesh::PrimitiveTopology::LineList, default());
    let mut wild = sheet(4);
    wild.insert_indices(bevy::mesh::Indices::U32(vec![0, 1, 99]));
    let [empty, lines, wild, good] = [empty, lines, wild, sheet(4)].map(|mesh| meshes.add(mesh));
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(empty))).id();
    run(&mut app, 4);
    for bad in [lines, wild] {
        app.world_mut().entity_mut(cloth).insert(Mesh3d(bad));
        run(&mut app, 4);
    }
    let told: Vec<_> = seen::<ClothRejected>(&app).iter().map(|told| told.error.to_string()).collect();
    assert_eq!(told.len(), 3, "{told:?}");
    assert!(told[0].contains("positions") && told[1].contains("LineList") && told[2].contains("99"), "{told:?}");
    app.world_mut().entity_mut(cloth).insert(Mesh3d(good));
    run(&mut app, 4);
    assert_eq!(particles(&app, cloth), Some(25));
    assert!(app.world().get::<ClothRejection>(cloth).is_none());
}
