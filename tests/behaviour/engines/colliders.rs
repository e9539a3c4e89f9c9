//! The colliders of an engine are colliders for cloth.

use super::*;
use cloth_solver::Pose;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// All colliders at and below `entity`, and where they are in the world.
fn solids(app: &mut App, entity: Entity) -> Vec<(cloth_solver::contact::Shape, Pose)> {
    let mut found = Vec::new();
    let world = app.world_mut();
    let mut system = bevy::ecs::system::SystemState::<(
        Query<(Entity, &GlobalTransform), With<ClothCollider>>,
        ColliderShapes,
        Query<&ChildOf>,
    )>::new(world);
    let (all, shapes, parents) = system.get(world).unwrap();
    for (collider, place) in &all {
        if collider == entity || parents.get(collider).is_ok_and(|parent| parent.parent() == entity) {
            let (_, rotation, translation) = place.to_scale_rotation_translation();
            found.push((shapes.get(collider).unwrap().clone(), Pose::new(translation, rotation)));
        }
    }
    found
}

/// Signed distance of a point to the nearest of them, m.
fn distance(solids: &[(cloth_solver::contact::Shape, Pose)], point: Vec3) -> f32 {
    let of =
        |(shape, pose): &(cloth_solver::contact::Shape, Pose)| shape.distance_and_normal(pose.inverse_point(point)).0;
    solids.iter().map(of).fold(f32::INFINITY, f32::min)
}

/// Compares what `make` makes with what the engine says, at points around it. `wall` is half the thickness of a wall.
fn compare(app: &mut App, what: &str, wall: f32, entity: Entity, engine: impl Fn(&App, Vec3) -> f32) {
    run(app, 3);
    let solids = solids(app, entity);
    assert!(!solids.is_empty(), "{what} became nothing");
    let mut random = Xoshiro256PlusPlus::seed_from_u64(9);
    let at = place(app, entity);
    let mut outside = 0;
    for _ in 0..300 {
        let point = at + Vec3::from_array([(); 3].map(|()| random.random_range(-1.5..1.5)));
        let expected = engine(app, point) - wall;
        // Inside, what is nearest is told by other rules.
        if expected > 0.0 {
            let found = distance(&solids, point);
            // Of what is round the engine finds it by iteration, not to the last.
            let allowed = if what.starts_with("round") { 5e-3 } else { 1e-3 };
            assert!((found - expected).abs() < allowed, "{what} at {point}: {found} m, {expected} m expected");
            outside += 1;
        }
    }
    assert!(outside > 30, "{what}: only {outside} points");
}

fn tetrahedron() -> Vec<Vec3> {
    vec![Vec3::new(0.5, 0.0, 0.0), Vec3::new(-0.5, 0.1, 0.4), Vec3::new(-0.4, 0.0, -0.5), Vec3::new(0.0, 0.7, 0.1)]
}

fn roof() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = [[-0.5, 0.0, -0.5], [0.5, 0.0, -0.5], [0.0, 0.4, 0.0], [0.5, 0.0, 0.5], [-0.5, 0.1, 0.5]];
    (corners.map(Vec3::from_array).to_vec(), vec![[0, 2, 1], [1, 2, 3], [3, 2, 4], [4, 2, 0]])
}

#[test]
fn every_shape_of_avian_is_where_avian_says_also_scaled() {
    use avian3d::prelude::*;
    let (corners, triangles) = roof();
    let shapes: Vec<(&str, f32, Collider)> = vec![
        ("ball", 0.0, Collider::sphere(0.4)),
        ("cuboid", 0.0, Collider::cuboid(0.4, 0.8, 0.6)),
        ("round cuboid", 0.0, Collider::round_cuboid(0.4, 0.8, 0.6, 0.1)),
        ("capsule", 0.0, Collider::capsule(0.2, 0.8)),
        (
            "slanted capsule",
            0.0,
            Collider::capsule_endpoints(0.2, Vec3::new(0.1, -0.4, 0.2), Vec3::new(0.5, 0.3, -0.3)),
        ),
        ("cylinder", 0.0, Collider::cylinder(0.3, 0.7)),
        ("cone", 0.0, Collider::cone(0.4, 0.7)),
        ("hull", 0.0, Collider::convex_hull(tetrahedron()).unwrap()),
        ("half space", 0.0, Collider::half_space(Vec3::new(0.2, 1.0, -0.3).normalize())),
        ("triangle mesh", 0.005, Collider::trimesh(corners, triangles)),
        ("triangle", 0.005, Collider::triangle(Vec3::X * 0.6, Vec3::Y * 0.5, Vec3::Z * 0.7)),
        (
            "height field",
            0.005,
            Collider::heightfield(
                vec![vec![0.0, 0.2, 0.1], vec![0.3, 0.0, 0.2], vec![0.1, 0.4, 0.0]],
                Vec3::new(1.0, 1.0, 1.4),
            ),
        ),
        (
            "compound",
            0.0,
            Collider::compound(vec![
                (Vec3::new(0.4, 0.0, 0.0), Quat::from_rotation_z(0.5), Collider::cuboid(0.3, 0.6, 0.2)),
                (Vec3::new(-0.4, 0.2, 0.0), Quat::IDENTITY, Collider::sphere(0.25)),
            ]),
        ),
    ];
    for (what, wall, collider) in shapes {
        for scale in [1.0, 1.5] {
            let mut app = Avian::app();
            let at = Transform::from_xyz(0.3, 0.2, -0.1).with_rotation(Quat::from_rotation_x(0.7));
            let at = at.with_scale(Vec3::splat(scale));
            let entity = app.world_mut().spawn((RigidBody::Static, collider.clone(), at)).id();
            compare(&mut app, &format!("{what} by {scale}"), wall, entity, |app, point| {
                let place = get::<Transform>(app, entity);
                get::<Collider>(app, entity).distance_to_point(place.translation, place.rotation, point, true)
            });
        }
    }
}

#[test]
fn every_shape_of_rapier_is_where_rapier_says_also_scaled() {
    use bevy_rapier3d::prelude::*;
    let (corners, triangles) = roof();
    let shapes: Vec<(&str, f32, Collider)> = vec![
        ("ball", 0.0, Collider::ball(0.4)),
        ("cuboid", 0.0, Collider::cuboid(0.2, 0.4, 0.3)),
        ("round cuboid", 0.0, Collider::round_cuboid(0.2, 0.4, 0.3, 0.1)),
        ("capsule along x", 0.0, Collider::capsule_x(0.4, 0.2)),
        ("capsule along y", 0.0, Collider::capsule_y(0.4, 0.2)),
        ("slanted capsule", 0.0, Collider::capsule(Vec3::new(0.1, -0.4, 0.2), Vec3::new(0.5, 0.3, -0.3), 0.2)),
        ("cylinder", 0.0, Collider::cylinder(0.35, 0.3)),
        ("cone", 0.0, Collider::cone(0.35, 0.4)),
        ("hull", 0.0, Collider::convex_hull(&tetrahedron()).unwrap()),
        ("half space", 0.0, Collider::halfspace(Vec3::new(0.2, 1.0, -0.3).normalize()).unwrap()),
        ("triangle mesh", 0.005, Collider::trimesh(corners, triangles).unwrap()),
        ("triangle", 0.005, Collider::triangle(Vec3::X * 0.6, Vec3::Y * 0.5, Vec3::Z * 0.7)),
        (
            "height field",
            0.005,
            Collider::heightfield(vec![0.0, 0.2, 0.1, 0.3, 0.0, 0.2, 0.1, 0.4, 0.0], 3, 3, Vec3::new(1.0, 1.0, 1.4)),
        ),
        (
            "compound",
            0.0,
            Collider::compound(vec![
                (Vec3::new(0.4, 0.0, 0.0), Quat::from_rotation_z(0.5), Collider::cuboid(0.15, 0.3, 0.1)),
                (Vec3::new(-0.4, 0.2, 0.0), Quat::IDENTITY, Collider::ball(0.25)),
            ]),
        ),
    ];
    for (what, wall, collider) in shapes {
        for scale in [1.0, 1.5] {
            let mut app = Rapier::app();
            let at = Transform::from_xyz(0.3, 0.2, -0.1).with_rotation(Quat::from_rotation_x(0.7));
            let at = at.with_scale(Vec3::splat(scale));
            let entity = app.world_mut().spawn((RigidBody::Fixed, collider.clone(), at)).id();
            compare(&mut app, &format!("{what} by {scale}"), wall, entity, |app, point| {
                let place = get::<Transform>(app, entity);
                get::<Collider>(app, entity).distance_to_point(place.translation, place.rotation, point, true)
            });
        }
    }
}

fn children(app: &App, entity: Entity) -> usize {
    app.world().get::<Children>(entity).map_or(0, |children| children.len())
}

#[test]
fn what_is_made_follows_the_collider_and_goes_with_it() {
    use avian3d::prelude::*;
    let mut app = Avian::app();
    let entity = app.world_mut().spawn((RigidBody::Static, Collider::sphere(0.4), Transform::IDENTITY)).id();
    run(&mut app, 2);
    assert_eq!(get::<ClothCollider>(&app, entity), &ClothCollider::Sphere { radius: 0.4 });
    app.world_mut().entity_mut(entity).insert(Collider::cuboid(1.0, 2.0, 3.0));
    run(&mut app, 2);
    assert_eq!(get::<ClothCollider>(&app, entity), &ClothCollider::Cuboid { size: Vec3::new(1.0, 2.0, 3.0) });
    let parts =
        vec![(Vec3::X, Quat::IDENTITY, Collider::sphere(0.2)), (Vec3::NEG_X, Quat::IDENTITY, Collider::sphere(0.2))];
    app.world_mut().entity_mut(entity).insert(Collider::compound(parts));
    run(&mut app, 2);
    assert!(app.world().get::<ClothCollider>(entity).is_none());
    assert_eq!(children(&app, entity), 2);
    app.world_mut().entity_mut(entity).insert(NoCloth);
    run(&mut app, 2);
    assert_eq!(children(&app, entity), 0);
    app.world_mut().entity_mut(entity).remove::<NoCloth>();
    run(&mut app, 2);
    assert_eq!(children(&app, entity), 2);
    app.world_mut().entity_mut(entity).insert(Sensor);
    run(&mut app, 2);
    assert_eq!(children(&app, entity), 0);
    app.world_mut().entity_mut(entity).remove::<Sensor>().insert(Collider::sphere(0.3));
    run(&mut app, 2);
    assert!(app.world().get::<ClothCollider>(entity).is_some());
    app.world_mut().entity_mut(entity).remove::<Collider>();
    run(&mut app, 2);
    assert!(app.world().get::<ClothCollider>(entity).is_none());
}

#[test]
fn a_collider_of_the_user_stays_and_what_has_no_counterpart_is_passed() {
    use bevy_rapier3d::prelude::*;
    let mut app = Rapier::app();
    let own = ClothCollider::Sphere { radius: 1.0 };
    let user = app.world_mut().spawn((Collider::ball(0.4), own.clone(), Transform::IDENTITY)).id();
    let line = Collider::polyline(vec![Vec3::ZERO, Vec3::X, Vec3::Y], None);
    let line = app.world_mut().spawn((line, Transform::IDENTITY)).id();
    run(&mut app, 3);
    app.world_mut().entity_mut(user).insert(Collider::ball(0.5));
    run(&mut app, 3);
    assert_eq!(get::<ClothCollider>(&app, user), &own);
    assert!(app.world().get::<ClothCollider>(line).is_none());
    assert_eq!(children(&app, line), 0);
}
