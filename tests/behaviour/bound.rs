//! A fine mesh that is drawn on a coarse cloth.

use crate::common::*;
use bevy::camera::primitives::Aabb;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy_cloth::*;

/// Where the vertices of a bound mesh are drawn in the world, m.
fn drawn(app: &App, entity: Entity) -> Vec<Vec3> {
    let place = get::<Transform>(app, entity).compute_affine();
    vectors(app, entity, Mesh::ATTRIBUTE_POSITION).iter().map(|p| place.transform_point3(*p)).collect()
}

/// A plate 1 m wide and high with a thickness of 2 cm, so that it has vertices before the cloth and behind it.
fn plate(parts: u32) -> Mesh {
    let side = |z: f32| {
        let plane = Plane3d::new(Vec3::Z * z.signum(), Vec2::splat(0.5)).mesh().subdivisions(parts - 1).build();
        plane.translated_by(Vec3::Z * z)
    };
    let mut plate = side(0.01);
    plate.merge(&side(-0.01)).expect("both have the same attributes");
    plate
}

/// Where its vertices are as authored, m.
fn authored(parts: u32) -> Vec<Vec3> {
    let plate = plate(parts);
    let Some(VertexAttributeValues::Float32x3(values)) = plate.attribute(Mesh::ATTRIBUTE_POSITION) else { panic!() };
    values.iter().map(|v| Vec3::from_array(*v)).collect()
}

/// A cloth of `cells`, and a plate of `parts` that is bound to it, its entity placed by `place`.
fn scene(cells: u32, parts: u32, place: Transform, more: impl Bundle) -> (App, Entity, Entity) {
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(cells, cells), more)).id();
    let moved = plate(parts).transformed_by(Transform::from_matrix(place.to_matrix().inverse()));
    let fine = app.world_mut().resource_mut::<Assets<Mesh>>().add(moved);
    let fine = app.world_mut().spawn((BoundTo(cloth), Mesh3d(fine), place)).id();
    (app, cloth, fine)
}

fn everywhere() -> Pins {
    Pins::region(Vec3::splat(-9.0), Vec3::splat(9.0))
}

fn largest(errors: impl Iterator<Item = f32>) -> f32 {
    errors.fold(0.0, f32::max)
}

#[test]
fn at_rest_it_is_as_it_was_authored_wherever_its_entity_is() {
    for place in [
        Transform::IDENTITY,
        Transform::from_xyz(3.0, -2.0, 1.0).with_rotation(Quat::from_euler(EulerRot::XYZ, 0.3, 1.0, -0.7)),
        Transform::from_xyz(0.0, 1.0, 0.0).with_scale(Vec3::new(2.0, 0.5, 4.0)),
    ] {
        let (mut app, cloth, fine) = scene(5, 17, place, everywhere());
        let normals = vectors(&app, fine, Mesh::ATTRIBUTE_NORMAL);
        run(&mut app, 3);
        assert!(app.world().get::<Mesh3d>(cloth).is_none(), "the cloth draws no mesh of its own");
        let rest = authored(17);
        let error = largest(drawn(&app, fine).iter().zip(&rest).map(|(now, then)| now.distance(*then)));
        assert!(error < 2e-6, "{error} m away, placed by {place:?}");
        let turned = vectors(&app, fine, Mesh::ATTRIBUTE_NORMAL);
        let error = largest(turned.iter().zip(&normals).map(|(now, then)| now.distance(*then)));
        assert!(error < 1e-5, "normals differ by {error}, placed by {place:?}");
    }
}

#[test]
fn it_turns_with_the_cloth_as_a_rigid_body() {
    let (mut app, cloth, fine) = scene(4, 9, Transform::IDENTITY, everywhere());
    run(&mut app, 3);
    let to = Transform::from_xyz(0.2, 0.1, -0.1).with_rotation(Quat::from_rotation_y(1.2) * Quat::from_rotation_x(0.4));
    app.world_mut().entity_mut(cloth).insert((to, Teleport { policy: TeleportPolicy::CarryAlong, ..default() }));
    run(&mut app, 30);
    let rest = authored(9);
    let error = largest(drawn(&app, fine).iter().zip(&rest).map(|(now, then)| now.distance(to.transform_point(*then))));
    assert!(error < 1e-5, "{error} m away");
}

#[test]
fn normals_tangents_and_bounds_are_those_of_the_shape_that_is_drawn() {
    // Seen from its entity the plate is skewed.
    let turn = Quat::from_euler(EulerRot::XYZ, 0.3, 1.0, -0.7);
    let place = Transform::from_xyz(3.0, -2.0, 1.0).with_rotation(turn).with_scale(Vec3::new(2.0, 0.5, 4.0));
    let affine = place.compute_affine();
    let (to_local, normal_to_local) = (affine.inverse(), affine.matrix3.transpose());
    let mut plate = plate(9).with_generated_tangents().expect("it has texture coordinates");
    let (mut normals, mut tangents) = (Vec::new(), Vec::new());
    for (attribute, values) in plate.attributes_mut() {
        match values {
            VertexAttributeValues::Float32x3(values) => values.iter_mut().for_each(|value| {
                let was = Vec3::from_array(*value);
                *value = if attribute.id == Mesh::ATTRIBUTE_NORMAL.id {
                    normals.push(was);
                    (normal_to_local * was).normalize().to_array()
                } else {
                    to_local.transform_point3(was).to_array()
                };
            }),
            VertexAttributeValues::Float32x4(values) => values.iter_mut().for_each(|[x, y, z, _]| {
                let was = Vec3::new(*x, *y, *z);
                tangents.push(was);
                [*x, *y, *z] = to_local.transform_vector3(was).normalize().to_array();
            }),
            _ => {}
        }
    }
    let mut app = with_meshes();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(4, 4), everywhere())).id();
    let fine = app.world_mut().resource_mut::<Assets<Mesh>>().add(plate);
    let fine = app.world_mut().spawn((BoundTo(cloth), Mesh3d(fine), place)).id();
    run(&mut app, 3);
    let to = Transform::from_xyz(0.2, 0.1, -0.1).with_rotation(Quat::from_rotation_y(1.2) * Quat::from_rotation_x(0.4));
    app.world_mut().entity_mut(cloth).insert((to, Teleport { policy: TeleportPolicy::CarryAlong, ..default() }));
    run(&mut app, 30);
    let now = vectors(&app, fine, Mesh::ATTRIBUTE_NORMAL);
    let to_world = normal_to_local.inverse();
    let error = largest(
        now.iter().zip(&normals).map(|(now, then)| (to_world * *now).normalize().distance(to.rotation * *then)),
    );
    assert!(now.len() == normals.len() && error < 1e-4, "normals differ by {error}");
    let Some(VertexAttributeValues::Float32x4(now)) = mesh(&app, fine).attribute(Mesh::ATTRIBUTE_TANGENT) else {
        panic!()
    };
    let world = |[x, y, z, _]: &[f32; 4]| affine.transform_vector3(Vec3::new(*x, *y, *z)).normalize();
    let error = largest(now.iter().zip(&tangents).map(|(now, then)| world(now).distance(to.rotation * *then)));
    assert!(now.len() == tangents.len() && error < 1e-4, "tangents differ by {error}");
    let bounds = get::<Aabb>(&app, fine);
    let points = vectors(&app, fine, Mesh::ATTRIBUTE_POSITION);
    let around = Aabb::enclosing(&points).expect("it has vertices");
    let error = bounds.min().distance(around.min()).max(bounds.max().distance(around.max()));
    assert!(error < 1e-5, "bounds differ by {error} m");
}

#[test]
fn it_follows_the_cloth_as_near_as_the_cloth_follows_itself() {
    // The same motion seen through the particles: on a plate whose vertices lie on particles each is at its particle, half of the plate's
    // thickness before or behind it.
    let (mut app, cloth, fine) = scene(8, 8, Transform::IDENTITY, (Pins::top(), Fabric::COTTON_POPLIN));
    app.world_mut().entity_mut(cloth).insert((Air::default(), Wind(Vec3::new(1.0, 0.0, 6.0))));
    for _ in 0..20 {
        run(&mut app, 10);
        let shown = get::<ShownShape>(&app, cloth).positions().to_vec();
        let topology = get::<ClothTopology>(&app, cloth);
        let rest = authored(8);
        for (now, then) in drawn(&app, fine).iter().zip(&rest) {
            let on = topology
                .particles()
                .find(|slot| topology.rest[*slot as usize].truncate().distance(then.truncate()) < 1e-4);
            let distance = now.distance(shown[on.expect("a particle is there") as usize]);
            assert!((distance - 0.01).abs() < 1e-5, "{distance} m from its particle");
        }
    }
}

#[test]
fn a_tear_parts_it_and_a_reset_makes_it_whole() {
    let (mut app, cloth, fine) = scene(6, 23, Transform::IDENTITY, Pins::top());
    run(&mut app, 3);
    let (whole, vertices) = (triangles(&app, fine).len(), mesh(&app, fine).count_vertices());
    let uvs = mesh(&app, fine).attribute(Mesh::ATTRIBUTE_UV_0).expect("uvs").len();
    assert_eq!(uvs, vertices);
    // Across, from side to side, so that the lower half falls.
    app.world_mut().trigger(CutCloth {
        entity: cloth,
        from: Ray3d::new(Vec3::new(-1.0, 0.02, 1.0), Dir3::NEG_Z),
        to: Ray3d::new(Vec3::new(1.0, 0.03, 1.0), Dir3::NEG_Z),
        reach: 10.0,
    });
    run(&mut app, 60);
    assert!(get::<ClothPieces>(&app, cloth).pieces.len() > 1, "it is in pieces");
    assert_eq!(triangles(&app, fine).len(), whole, "no triangle is lost");
    let now = mesh(&app, fine).count_vertices();
    assert!(now > vertices, "vertices have copies");
    assert_eq!(mesh(&app, fine).attribute(Mesh::ATTRIBUTE_UV_0).expect("uvs").len(), now, "with all attributes");
    let at = drawn(&app, fine);
    let longest = largest(
        triangles(&app, fine)
            .iter()
            .map(|[a, b, c]| at[*a].distance(at[*b]).max(at[*b].distance(at[*c])).max(at[*c].distance(at[*a]))),
    );
    assert!(longest < 0.1, "a triangle hangs across the gap, {longest} m long");
    app.world_mut().trigger(ResetCloth { entity: cloth });
    run(&mut app, 2);
    assert_eq!((triangles(&app, fine).len(), mesh(&app, fine).count_vertices()), (whole, vertices));
}

#[test]
fn where_the_cloth_is_burnt_away_it_is_gone_too() {
    let (mut app, cloth, fine) = scene(6, 23, Transform::IDENTITY, (Pins::top(), Flammable::default()));
    run(&mut app, 3);
    let whole = triangles(&app, fine).len();
    app.world_mut().trigger(IgniteCloth { entity: cloth, position: Vec3::new(0.0, -0.5, 0.0), radius: 0.2 });
    let mut counts = Vec::new();
    for _ in 0..40 {
        run(&mut app, 20);
        counts.push(triangles(&app, fine).len());
    }
    assert!(counts.is_sorted_by(|a, b| a >= b), "nothing grows again: {counts:?}");
    assert!(*counts.last().expect("counted") < whole * 9 / 10, "{whole} triangles: {counts:?}");
}

#[test]
fn its_own_mesh_is_not_changed_and_comes_back() {
    for despawn in [false, true] {
        let (mut app, cloth, fine) = scene(4, 9, Transform::IDENTITY, Pins::top());
        let own = get::<Mesh3d>(&app, fine).clone();
        let before = vectors(&app, fine, Mesh::ATTRIBUTE_POSITION);
        run(&mut app, 30);
        assert_ne!(*get::<Mesh3d>(&app, fine), own, "a copy is drawn");
        if despawn {
            app.world_mut().entity_mut(cloth).despawn();
        } else {
            app.world_mut().entity_mut(fine).remove::<BoundTo>();
        }
        run(&mut app, 2);
        assert_eq!(*get::<Mesh3d>(&app, fine), own);
        assert_eq!(vectors(&app, fine, Mesh::ATTRIBUTE_POSITION), before);
        if !despawn {
            assert!(app.world().get::<Mesh3d>(cloth).is_some(), "the cloth is drawn again");
        }
    }
}

#[test]
fn a_mesh_that_cannot_be_bound_is_told_and_drawn_as_it_is() {
    let mut app = with_meshes();
    note_events::<BoundRejected>(&mut app);
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0), Pins::top())).id();
    let mut broken = plate(4);
    let Some(VertexAttributeValues::Float32x3(at)) = broken.attribute_mut(Mesh::ATTRIBUTE_POSITION) else { panic!() };
    at[7][1] = f32::NAN;
    let broken = app.world_mut().resource_mut::<Assets<Mesh>>().add(broken);
    let fine = app.world_mut().spawn((BoundTo(cloth), Mesh3d(broken.clone()))).id();
    run(&mut app, 5);
    let told = seen::<BoundRejected>(&app);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].error.to_string().contains("vertex 7 has a position that is not finite"), "{}", told[0].error);
    assert_eq!(get::<Mesh3d>(&app, fine).0, broken);
    // Mended, it is bound.
    *app.world_mut().resource_mut::<Assets<Mesh>>().get_mut(&broken).expect("it is there") = plate(4);
    run(&mut app, 30);
    assert_eq!(seen::<BoundRejected>(&app).len(), 1);
    assert!(drawn(&app, fine).iter().all(|at| at.is_finite()));
    assert_ne!(get::<Mesh3d>(&app, fine).0, broken);
}
