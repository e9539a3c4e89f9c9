//! A cloth drawn finer than it is simulated.

use crate::common::*;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_cloth::*;

fn hung(more: impl Bundle) -> (App, Entity) {
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(4, 4), Pins::top())).insert(more).id();
    run(&mut app, 2);
    (app, cloth)
}

#[test]
fn a_cloth_is_drawn_with_4_or_16_times_the_triangles_by_component_or_by_resource() {
    let (mut app, cloth) = hung(());
    let coarse = triangles(&app, cloth).len();
    let mut times = |set: &dyn Fn(&mut World)| {
        set(app.world_mut());
        run(&mut app, 2);
        triangles(&app, cloth).len() / coarse
    };
    let own = |subdivision: ClothSubdivision| {
        move |world: &mut World| {
            world.entity_mut(cloth).insert(subdivision);
        }
    };
    assert_eq!(times(&own(ClothSubdivision::X2)), 4);
    assert_eq!(times(&own(ClothSubdivision::X4)), 16);
    assert_eq!(times(&own(ClothSubdivision::None)), 1);
    assert_eq!(times(&|world| world.resource_mut::<Shared<ClothSubdivision>>().0 = ClothSubdivision::X2), 1);
    assert_eq!(
        times(&|world| {
            world.entity_mut(cloth).remove::<ClothSubdivision>();
        }),
        4
    );
}

#[test]
fn the_motion_is_the_same_to_the_last_bit() {
    let [coarse, fine] = [ClothSubdivision::None, ClothSubdivision::X4].map(|subdivision| {
        let (mut app, cloth) = hung(subdivision);
        run(&mut app, 30);
        bits(&app, cloth)
    });
    assert_eq!(coarse, fine);
}

#[test]
fn a_towel_over_a_ball_sinks_in_no_deeper_than_before() {
    const RADIUS: f32 = 0.25;
    let mut app = with_meshes();
    let lying = Transform::from_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let towel = (Cloth::rectangle(0.9, 0.9).with_cells(12, 12), Fabric::TERRY_TOWEL, lying);
    let cloth = app.world_mut().spawn(towel).id();
    let under = Transform::from_xyz(0.0, -RADIUS - 0.01, 0.0);
    app.world_mut().spawn((ClothCollider::Sphere { radius: RADIUS }, under));
    run(&mut app, 90);
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let mut look = |subdivision: ClothSubdivision| {
        app.world_mut().entity_mut(cloth).insert(subdivision);
        run(&mut app, 2);
        let place = get::<Transform>(&app, cloth).compute_affine();
        let positions = vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION).into_iter().map(|p| place.transform_point3(p));
        let positions: Vec<Vec3> = positions.collect();
        let height = |p: Vec3| p.distance(under.translation) - RADIUS;
        let front = triangles(&app, cloth).into_iter().map(|corners| corners.map(|i| positions[i]));
        let middles = front.map(|corners| corners.iter().sum::<Vec3>() / 3.0);
        middles.map(height).fold(f32::MAX, f32::min)
    };
    let [lowest, half, quarter] = ClothSubdivision::ALL.map(&mut look);
    assert!(half >= lowest - 1e-5 && quarter >= lowest - 1e-5, "{half} m and {quarter} m, was {lowest} m");
}

#[test]
fn a_cut_parts_what_is_drawn() {
    let (mut app, cloth) = hung((ClothSubdivision::X4, Gravity(Vec3::ZERO)));
    let ray = |y: f32| Ray3d { origin: Vec3::new(0.02, y, 1.0), direction: Dir3::NEG_Z };
    app.world_mut().trigger(CutCloth { entity: cloth, from: ray(1.0), to: ray(-1.0), reach: 10.0 });
    run(&mut app, 2);
    let topology = get::<ClothTopology>(&app, cloth);
    assert_eq!(get::<ClothPieces>(&app, cloth).pieces.len(), 2);
    let all = triangles(&app, cloth);
    assert_eq!(all.len(), 2 * 16 * topology.triangles.len());
    // Vertices that a triangle connects hang together: two pieces, front and back of each.
    let mut leader: Vec<usize> = (0..vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION).len()).collect();
    fn find(leader: &mut [usize], mut vertex: usize) -> usize {
        while leader[vertex] != vertex {
            leader[vertex] = leader[leader[vertex]];
            vertex = leader[vertex];
        }
        vertex
    }
    for [a, b, c] in &all {
        for other in [b, c] {
            let (a, other) = (find(&mut leader, *a), find(&mut leader, *other));
            leader[a] = other;
        }
    }
    let leaders: std::collections::HashSet<usize> =
        all.iter().flatten().map(|vertex| find(&mut leader.clone(), *vertex)).collect();
    assert_eq!(leaders.len(), 4);
}

#[test]
fn texture_coordinates_tangents_and_colours_are_between_those_of_the_particles() {
    let (app, cloth) = hung((ClothSubdivision::X4, ClothColoring::Stress, Gravity(Vec3::ZERO)));
    let (positions, mesh) = (vectors(&app, cloth, Mesh::ATTRIBUTE_POSITION), mesh(&app, cloth));
    let back = positions.len() / 2;
    assert_eq!(back, 17 * 17);
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else { panic!("no uvs") };
    for (uv, position) in uvs.iter().zip(&positions) {
        let expected = Vec2::new(position.x + 0.5, 0.5 - position.y);
        assert!(Vec2::from_array(*uv).distance(expected) < 1e-4, "{uv:?} at {position}");
    }
    let Some(VertexAttributeValues::Float32x4(tangents)) = mesh.attribute(Mesh::ATTRIBUTE_TANGENT) else { panic!() };
    for (vertex, tangent) in tangents.iter().enumerate() {
        let sign = if vertex < back { 1.0 } else { -1.0 };
        assert!(Vec4::from_array(*tangent).distance(Vec3::X.extend(sign)) < 1e-4, "{tangent:?}");
    }
    let Some(VertexAttributeValues::Float32x4(colors)) = mesh.attribute(Mesh::ATTRIBUTE_COLOR) else { panic!() };
    let [low, high] = [0, 2].map(|channel| colors.iter().map(move |color| color[channel]));
    assert!(low.zip(high).all(|(red, blue)| blue > red + 0.3), "at rest all is blue: {colors:?}");
}
