//! Pins hold by rods, vertices, region or colour, and follow the cloth, the world or another entity.

use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_cloth::*;

/// The particles with inverse mass 0, by rest position, in order of x.
fn held(app: &App, cloth: Entity) -> Vec<Vec3> {
    let (particles, topology) = (get::<Particles>(app, cloth), get::<ClothTopology>(app, cloth));
    let held = topology.particles().filter(|slot| particles.inverse_mass[*slot as usize] == 0.0);
    let mut held: Vec<_> = held.map(|slot| topology.rest[slot as usize]).collect();
    held.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    held
}

fn held_by(pins: Pins) -> Vec<Vec3> {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(2.0, 1.0).with_cells(8, 4), pins)).id();
    run(&mut app, 2);
    held(&app, cloth)
}

fn xs(points: Vec<Vec3>) -> Vec<f32> {
    points.into_iter().map(|point| point.x).collect()
}

#[test]
fn rods_lie_evenly_along_the_top_whatever_the_width() {
    assert_eq!(xs(held_by(Pins::rods(5))), [-1.0, -0.5, 0.0, 0.5, 1.0]);
    assert_eq!(xs(held_by(Pins::rods(3))), [-1.0, 0.0, 1.0]);
    assert_eq!(xs(held_by(Pins::rods(1))), [0.0]);
    assert!(held_by(Pins::rods(0)).is_empty());
    assert!(held_by(Pins::rods(5)).iter().all(|point| point.y == 0.5));
}

#[test]
fn the_top_its_corners_vertices_and_regions_hold_what_they_name() {
    assert_eq!(held_by(Pins::top()).len(), 9);
    assert_eq!(xs(held_by(Pins::corners())), [-1.0, 1.0]);
    // Row by row from the top left: the last of the first row, the first of the second.
    let vertices = held_by(Pins::vertices([8, 9]));
    assert_eq!(vertices, [Vec3::new(-1.0, 0.25, 0.0), Vec3::new(1.0, 0.5, 0.0)]);
    let region = held_by(Pins::region(Vec3::new(-1.0, -0.5, -0.1), Vec3::new(-0.75, -0.25, 0.1)));
    assert_eq!(region.len(), 4);
}

#[test]
fn groups_add_up_and_the_first_to_choose_a_particle_holds_it() {
    let mut app = headless();
    let hand = app.world_mut().spawn(Transform::IDENTITY).id();
    let pins = Pins::corners().and(Pins::top().to_entity(hand));
    let cloth = app.world_mut().spawn((Cloth::rectangle(2.0, 1.0).with_cells(8, 4), pins)).id();
    run(&mut app, 2);
    assert_eq!(held(&app, cloth).len(), 9);
    app.world_mut().get_mut::<Transform>(hand).unwrap().translation.z = 0.1;
    run(&mut app, 2);
    let position = &get::<Particles>(&app, cloth).position;
    assert_eq!(position.get(0).z, 0.0, "the corner belongs to the cloth");
    assert!((position.get(1).z - 0.1).abs() < 1e-6, "the rest of the top edge to the hand");
}

#[test]
fn red_vertices_of_a_mesh_hold_and_a_seam_does_not_matter() {
    let mut app = with_meshes();
    let mut sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(3).build();
    let Some(VertexAttributeValues::Float32x3(positions)) = sheet.attribute(Mesh::ATTRIBUTE_POSITION) else { panic!() };
    let colors: Vec<_> = positions.iter().map(|p| [if p[1] > 0.4 { 0.8 } else { 0.1 }, 1.0, 1.0, 1.0]).collect();
    sheet.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet), Pins::vertex_color(0.5))).id();
    run(&mut app, 2);
    let held = held(&app, cloth);
    assert!(held.len() == 5 && held.iter().all(|point| point.y > 0.4), "{held:?}");
}

#[test]
fn rods_and_top_work_on_a_mesh() {
    let mut app = with_meshes();
    let sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(3).build();
    let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet), Pins::rods(3))).id();
    run(&mut app, 2);
    let held = xs(held(&app, cloth));
    assert!(held.len() == 3 && held.iter().zip([-0.5, 0.0, 0.5]).all(|(x, rod)| (x - rod).abs() < 1e-6), "{held:?}");
}

#[test]
fn a_plane_hangs_by_its_highest_side_whichever_way_its_texture_lies_and_stretches_no_more_than_a_rectangle() {
    for turn in [0.0, 0.5, 1.0, 1.5].map(|half_turns| Quat::from_rotation_z(half_turns * std::f32::consts::PI)) {
        let mut app = with_meshes();
        let sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(30).build().rotated_by(turn);
        let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
        let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet), Pins::corners(), ClothStats::default())).id();
        run(&mut app, 128);
        let held = held(&app, cloth);
        assert!(held.len() == 2 && held.iter().all(|point| point.y > 0.499), "{held:?}");
        let strain = get::<ClothStats>(&app, cloth).largest_strain;
        assert!(strain < 0.03, "{strain}");
    }
}

#[test]
fn a_mesh_that_is_no_rectangle_stretches_about_as_far_as_its_fabric_may() {
    let mut app = with_meshes();
    let mut sheet = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(cases(16, 30)).build();
    let Some(VertexAttributeValues::Float32x2(uvs)) = sheet.attribute_mut(Mesh::ATTRIBUTE_UV_0) else { panic!() };
    // Warp and weft run along the diagonals.
    uvs.iter_mut().for_each(|uv| *uv = [uv[0] + uv[1], uv[0] - uv[1]]);
    let sheet = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    let cloth = app.world_mut().spawn((Cloth::mesh(), Mesh3d(sheet), Pins::corners(), ClothStats::default())).id();
    run(&mut app, 192);
    assert_eq!(get::<ClothTopology>(&app, cloth).grid, None);
    let strain = get::<ClothStats>(&app, cloth).largest_strain;
    assert!(strain < 3.0 * Fabric::default().stretch_limit, "{strain}");
}

/// A cloth whose top edge is held by `pins`, for a second of ticks in which the cloth's transform, or the entity
/// `hand`, moves 0.5 m along x, and then at rest for 2 s. Gives the corner's place in the world, and the centre's.
fn after_moving(pins: impl Fn(Entity) -> Pins, move_hand: bool) -> (Vec3, Vec3) {
    let mut app = headless();
    let hand = app.world_mut().spawn(Transform::from_xyz(3.0, 2.0, 1.0)).id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(10, 10), pins(hand))).id();
    run(&mut app, 8);
    for _ in 0..64 {
        let moved = if move_hand { hand } else { cloth };
        app.world_mut().get_mut::<Transform>(moved).unwrap().translation.x += 0.5 / 64.0;
        app.update();
    }
    run(&mut app, 128);
    let frame = get::<ClothFrame>(&app, cloth);
    (frame.to_world(get::<Particles>(&app, cloth).position.get(0)), centre(&app, cloth))
}

#[test]
fn pins_on_the_cloth_drag_it_along_with_its_transform() {
    let (corner, centre) = after_moving(|_| Pins::top(), false);
    assert!(corner.distance(Vec3::new(0.0, 0.5, 0.0)) < 1e-5, "the corner is at {corner}");
    assert!((centre.x - 0.5).abs() < 0.1, "the centre is at {centre}");
}

#[test]
fn pins_on_the_world_stay_when_the_transform_moves() {
    let (corner, centre) = after_moving(|_| Pins::top().to_world(), false);
    assert!(corner.distance(Vec3::new(-0.5, 0.5, 0.0)) < 1e-5, "the corner is at {corner}");
    assert!(centre.x.abs() < 0.01, "the centre is at {centre}");
}

#[test]
fn pins_on_an_entity_follow_it_and_not_the_transform() {
    let (corner, centre) = after_moving(|hand| Pins::top().to_entity(hand), true);
    assert!(corner.distance(Vec3::new(0.0, 0.5, 0.0)) < 1e-5, "the corner is at {corner}");
    assert!((centre.x - 0.5).abs() < 0.1, "the centre is at {centre}");
    let (corner, _) = after_moving(|hand| Pins::top().to_entity(hand), false);
    assert!(corner.distance(Vec3::new(-0.5, 0.5, 0.0)) < 1e-5, "the corner is at {corner}");
}

#[test]
fn an_entity_that_turns_takes_its_pins_round() {
    let mut app = headless();
    let hand = app.world_mut().spawn(Transform::from_xyz(0.0, 0.5, 0.0)).id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top().to_entity(hand))).id();
    run(&mut app, 2);
    for _ in 0..64 {
        let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 / 64.0);
        app.world_mut().get_mut::<Transform>(hand).unwrap().rotate(turn);
        app.update();
    }
    let corner = get::<Particles>(&app, cloth).position.get(0);
    assert!(corner.distance(Vec3::new(0.0, 0.5, 0.5)) < 1e-4, "the corner is at {corner}");
}

#[test]
fn a_pin_follows_a_child_of_what_moves() {
    let mut app = headless();
    let arm = app.world_mut().spawn(Transform::IDENTITY).id();
    let hand = app.world_mut().spawn((Transform::from_xyz(0.0, 0.5, 0.0), ChildOf(arm))).id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top().to_entity(hand))).id();
    run(&mut app, 2);
    app.world_mut().get_mut::<Transform>(arm).unwrap().translation.z = 0.125;
    run(&mut app, 1);
    let corner = get::<Particles>(&app, cloth).position.get(0);
    assert!(corner.distance(Vec3::new(-0.5, 0.5, 0.125)) < 1e-6, "the corner is at {corner}");
}
