//! What a cloth draws: two faces of its present shape, in its own mesh, with its own bounds and colours.

use crate::common::*;
use bevy::camera::primitives::Aabb;
use bevy::mesh::VertexAttributeValues;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

/// An app with meshes and materials, and a cloth of 4 × 4 cells with `more` components.
fn drawn(more: impl Bundle) -> (App, Entity) {
    let mut app = with_meshes();
    app.init_asset::<StandardMaterial>();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(4, 4), Pins::top())).insert(more).id();
    run(&mut app, 2);
    (app, cloth)
}

fn colors(app: &App, cloth: Entity) -> Vec<[f32; 4]> {
    match mesh(app, cloth).attribute(Mesh::ATTRIBUTE_COLOR) {
        Some(VertexAttributeValues::Float32x4(values)) => values.clone(),
        other => panic!("colours are {other:?}"),
    }
}

/// How often the mesh asset of the cloth was written in the last frames.
fn writes(app: &mut App, cloth: Entity, frames: usize) -> usize {
    let id = get::<Mesh3d>(app, cloth).0.id();
    (0..frames)
        .map(|_| {
            app.update();
            let events = take_messages::<AssetEvent<Mesh>>(app);
            events.into_iter().filter(|event| *event == AssetEvent::Modified { id }).count()
        })
        .sum()
}

#[test]
fn front_and_back_are_separate_vertices_half_a_thickness_apart_and_face_away_from_each_other() {
    let fabric = Fabric { thickness: 0.004, ..Fabric::COTTON_POPLIN };
    let (app, cloth) = drawn((fabric, Gravity(Vec3::ZERO)));
    let (positions, normals) =
        (vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION), vectors(&app, cloth, Mesh::ATTRIBUTE_NORMAL));
    assert_eq!(positions.len(), 2 * 25);
    for vertex in 0..25 {
        assert_eq!((normals[vertex], normals[vertex + 25]), (Vec3::Z, Vec3::NEG_Z));
        assert!((positions[vertex] - positions[vertex + 25] - 0.004 * Vec3::Z).length() < 1e-6);
    }
    let indices: Vec<_> = mesh(&app, cloth).indices().expect("indices").iter().collect();
    for triangle in indices.chunks(3) {
        let [a, b, c] = [positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]];
        assert!((b - a).cross(c - a).dot(normals[triangle[0]]) > 0.0, "a face is seen from the wrong side");
    }
}

#[test]
fn texture_coordinates_run_from_the_top_left_and_tangents_along_u() {
    let (app, cloth) = drawn(());
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh(&app, cloth).attribute(Mesh::ATTRIBUTE_UV_0) else {
        panic!()
    };
    let positions = vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    let top_left = uvs.iter().position(|uv| *uv == [0.0, 0.0]).expect("a vertex at the top left");
    assert!((positions[top_left].xy() - Vec2::new(-0.5, 0.5)).length() < 1e-3);
    let Some(VertexAttributeValues::Float32x4(tangents)) = mesh(&app, cloth).attribute(Mesh::ATTRIBUTE_TANGENT) else {
        panic!()
    };
    let off = tangents.iter().map(|t| Vec3::from_slice(t).distance(Vec3::X)).fold(0.0, f32::max);
    assert!(off < 0.05, "a tangent is {off} off");
    assert!(tangents[..25].iter().all(|t| t[3] == 1.0) && tangents[25..].iter().all(|t| t[3] == -1.0));
}

#[test]
fn the_shape_drawn_lies_between_the_last_two_ticks() {
    let (mut app, cloth) = drawn(());
    app.world_mut().entity_mut(cloth).remove::<Pins>();
    run(&mut app, 16);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK / 4));
    let ticks = |app: &App| app.world().resource::<Time<ClothClock>>().elapsed();
    let lowest = |app: &App| vectors(app, cloth, Mesh::ATTRIBUTE_POSITION).iter().map(|p| p.y).fold(f32::MAX, f32::min);
    let (before, start) = (ticks(&app), lowest(&app));
    let mut drawn = vec![start];
    for _ in 0..3 {
        app.update();
        drawn.push(lowest(&app));
    }
    assert_eq!(ticks(&app), before, "a tick ran in between");
    let falls: Vec<f32> = drawn.windows(2).map(|pair| pair[0] - pair[1]).collect();
    assert!(falls.iter().all(|fall| *fall > 0.0), "it is drawn at {drawn:?}");
    assert!(falls.iter().all(|fall| (fall / falls[0] - 1.0).abs() < 0.01), "not evenly between: {drawn:?}");
    let last = world_positions(&app, cloth).iter().map(|p| p.y).fold(f32::MAX, f32::min);
    assert!(drawn[3] > last, "drawn at {drawn:?} beyond the last tick, {last}");
}

#[test]
fn the_mesh_is_written_when_something_moved_and_only_then() {
    let (mut app, cloth) = drawn(());
    assert!(writes(&mut app, cloth, 4) >= 3, "it swings and is not drawn");
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    run(&mut app, 2);
    assert_eq!(writes(&mut app, cloth, 8), 0, "it stands and is drawn anew");
    app.world_mut().trigger(ResetCloth { entity: cloth });
    assert!(writes(&mut app, cloth, 4) > 0, "it was reset and is not drawn");
    app.world_mut().resource_mut::<Time<ClothClock>>().unpause();
    app.world_mut().entity_mut(cloth).insert(Pins::region(Vec3::splat(-1.0), Vec3::splat(1.0)));
    run(&mut app, 4);
    assert_eq!(writes(&mut app, cloth, 8), 0, "all of it is pinned and it is drawn anew");
}

#[test]
fn the_bounds_follow_the_cloth() {
    let (mut app, cloth) = drawn(());
    app.world_mut().entity_mut(cloth).remove::<Pins>();
    run(&mut app, 64);
    let bounds = get::<Aabb>(&app, cloth);
    let positions = vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    assert!(bounds.center.y < -3.0, "the bounds stay at {:?}", bounds.center);
    let off = positions.iter().map(|p| (p.abs_diff_eq(*p, 0.0), *p - Vec3::from(bounds.center)));
    let outside = off.map(|(_, p)| (p.abs() - Vec3::from(bounds.half_extents)).max_element()).fold(f32::MIN, f32::max);
    assert!(outside.abs() < 1e-5, "the farthest vertex is {outside} m outside");
}

#[test]
fn scale_and_place_of_the_entity_are_not_drawn_twice() {
    let at = Transform::from_xyz(5.0, 1.0, -2.0)
        .with_scale(Vec3::new(2.0, 3.0, 1.0))
        .with_rotation(Quat::from_rotation_y(1.0));
    let (app, cloth) = drawn((at, Gravity(Vec3::ZERO)));
    let positions = vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    let corner = positions[0];
    assert!(corner.xy().distance(Vec2::new(-0.5, 0.5)) < 1e-5, "in the entity's space the corner is at {corner}");
    let normals = vectors(&app, cloth, Mesh::ATTRIBUTE_NORMAL);
    assert!(normals[..25].iter().all(|normal| normal.distance(Vec3::Z) < 1e-5));
}

#[test]
fn an_entity_moved_between_ticks_leaves_the_cloth_where_it_hangs() {
    let (mut app, cloth) = drawn(Pins::top().to_world());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(std::time::Duration::ZERO));
    let in_world = |app: &App| {
        let place = get::<Transform>(app, cloth).compute_affine();
        vectors(app, cloth, Mesh::ATTRIBUTE_POSITION).into_iter().map(|p| place.transform_point3(p)).collect::<Vec<_>>()
    };
    app.update();
    let before = in_world(&app);
    let mut transform = app.world_mut().get_mut::<Transform>(cloth).unwrap();
    *transform = Transform::from_xyz(0.3, 0.2, 0.1).with_rotation(Quat::from_rotation_z(0.5));
    app.update();
    let moved = largest_move(&before, &in_world(&app));
    assert!(moved < 1e-5, "it jumped by {moved} m");
}

#[test]
fn stress_colours_tell_rest_from_load_and_go_when_they_are_no_longer_asked_for() {
    let (mut app, cloth) = drawn(ClothColoring::Stress);
    let blueness = |color: &[f32; 4]| color[2] - color[0];
    app.world_mut().entity_mut(cloth).insert(Gravity(Vec3::ZERO));
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 2);
    let at_rest = colors(&app, cloth);
    assert!(at_rest.iter().all(|color| blueness(color) > 0.3), "at rest it is {at_rest:?}");
    app.world_mut().entity_mut(cloth).insert((Gravity(Vec3::NEG_Y * 5000.0), Pins::rods(1)));
    run(&mut app, 32);
    let loaded = colors(&app, cloth);
    assert!(loaded.iter().any(|color| blueness(color) < -0.3), "under load nothing is red");
    assert_eq!(loaded[..25], loaded[25..], "both faces");
    app.world_mut().entity_mut(cloth).remove::<ClothColoring>();
    run(&mut app, 2);
    assert!(colors(&app, cloth).iter().all(|color| *color == [1.0; 4]), "colours are left");
    app.world_mut().resource_mut::<Shared<ClothColoring>>().0 = ClothColoring::Stress;
    run(&mut app, 2);
    assert!(colors(&app, cloth).iter().any(|color| *color != [1.0; 4]), "the shared value has no effect");
}

#[test]
fn vertex_colours_of_the_users_mesh_are_drawn_again_after_stress() {
    let mut app = with_meshes();
    let mut sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(3).build();
    sheet.insert_attribute(Mesh::ATTRIBUTE_COLOR, vec![[0.25, 0.5, 0.75, 1.0]; 25]);
    let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet))).id();
    run(&mut app, 2);
    assert_eq!(colors(&app, cloth), vec![[0.25, 0.5, 0.75, 1.0]; 50]);
    app.world_mut().entity_mut(cloth).insert(ClothColoring::Stress);
    run(&mut app, 2);
    assert_ne!(colors(&app, cloth), vec![[0.25, 0.5, 0.75, 1.0]; 50]);
    app.world_mut().entity_mut(cloth).insert(ClothColoring::Material);
    run(&mut app, 2);
    assert_eq!(colors(&app, cloth), vec![[0.25, 0.5, 0.75, 1.0]; 50]);
}

#[test]
fn a_cloth_without_a_material_is_given_one_and_its_own_is_put_aside_for_stress_only() {
    let (mut app, plain) = drawn(());
    assert!(app.world().get::<MeshMaterial3d<StandardMaterial>>(plain).is_some(), "it has no material");
    let red = StandardMaterial { base_color: Color::srgb(1.0, 0.0, 0.0), ..default() };
    let red = MeshMaterial3d(app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(red));
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0), red.clone())).id();
    run(&mut app, 2);
    let material = |app: &App| app.world().get::<MeshMaterial3d<StandardMaterial>>(cloth).cloned();
    assert_eq!(material(&app), Some(red.clone()));
    app.world_mut().entity_mut(cloth).insert(ClothColoring::Stress);
    run(&mut app, 2);
    assert_ne!(material(&app), Some(red.clone()));
    app.world_mut().entity_mut(cloth).remove::<ClothColoring>();
    run(&mut app, 2);
    assert_eq!(material(&app), Some(red));
}

#[test]
fn a_rectangle_that_is_no_cloth_any_more_draws_nothing() {
    let (mut app, cloth) = drawn(ClothColoring::Stress);
    app.world_mut().entity_mut(cloth).remove::<Cloth>();
    run(&mut app, 2);
    let entity = app.world().entity(cloth);
    assert!(!entity.contains::<Mesh3d>() && !entity.contains::<MeshMaterial3d<StandardMaterial>>());
    assert!(!entity.contains::<Aabb>());
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0);
}

#[test]
fn a_cloth_that_sleeps_is_drawn_where_it_is_and_its_mesh_is_not_written() {
    let (mut app, cloth) = drawn(Air::default());
    crate::common::sleep::run_to_sleep(&mut app, cloth);
    // Frames that end anywhere between two ticks.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK.mul_f32(0.37)));
    run(&mut app, 3);
    let drawn = vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION);
    let (front, back) = drawn.split_at(25);
    let middles = front.iter().zip(back).map(|(front, back)| 0.5 * (*front + *back)).collect::<Vec<_>>();
    let moved = largest_move(&world_positions(&app, cloth), &middles);
    assert!(moved < 1e-6, "drawn {moved} m from where it is");
    assert_eq!(writes(&mut app, cloth, 60), 0);
    app.world_mut().entity_mut(cloth).insert(Gravity(Vec3::X));
    assert!(writes(&mut app, cloth, 10) >= 9, "it is drawn again once it wakes");
}
