//! Clothes, colliders and what pins hang on may vanish at any time, and nothing is left behind.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

#[test]
fn clothes_and_colliders_vanish_in_mid_run() {
    let mut app = with_meshes();
    let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2));
    let [first, second] = [0.0, 2.0].map(|x| {
        let cloth = (cloth.clone(), Transform::from_xyz(x, 0.0, 0.0));
        app.world_mut().spawn(cloth).id()
    });
    let ball = app.world_mut().spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(2.0, 0.0, 0.1))).id();
    run(&mut app, 10);
    app.world_mut().despawn(first);
    run(&mut app, 10);
    app.world_mut().despawn(ball);
    run(&mut app, 10);
    assert!(get::<Particles>(&app, second).is_finite());
    app.world_mut().despawn(second);
    run(&mut app, 10);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0, "the meshes they drew are still there");
}

#[test]
fn a_cloth_may_vanish_in_the_middle_of_a_tick() {
    let mut app = headless();
    app.world_mut().spawn((Cloth::rectangle(0.5, 0.5), Pins::rods(2)));
    let vanish = |cloths: Query<Entity, With<Particles>>, mut commands: Commands| {
        for cloth in &cloths {
            commands.entity(cloth).despawn();
        }
    };
    app.add_systems(ClothSubstepSchedule, vanish.after(ClothSystems::Integrate).before(ClothSystems::Solve));
    run(&mut app, 10);
    let mut cloths = app.world_mut().query::<&Cloth>();
    assert_eq!(cloths.iter(app.world()).count(), 0);
}

#[test]
fn pins_stay_where_the_entity_was_that_held_them() {
    let mut app = headless();
    let hand = app.world_mut().spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top().to_entity(hand))).id();
    run(&mut app, 4);
    app.world_mut().get_mut::<Transform>(hand).unwrap().translation.x = 0.25;
    run(&mut app, 2);
    app.world_mut().despawn(hand);
    run(&mut app, 64);
    let corner = get::<Particles>(&app, cloth).position.get(0);
    assert!(corner.distance(Vec3::new(-0.25, 0.5, 0.0)) < 1e-5, "the corner is at {corner}");
}

#[test]
fn a_thousand_clothes_come_and_go_and_nothing_is_left() {
    let mut app = with_meshes();
    run(&mut app, 2);
    let entities = app.world().entities().count_spawned();
    for round in 0..20 {
        let cloth = (Cloth::rectangle(0.1, 0.1).with_cells(2 + round % 3, 2), Pins::corners());
        let cloths: Vec<_> = (0..50).map(|_| app.world_mut().spawn(cloth.clone()).id()).collect();
        run(&mut app, 2);
        for cloth in cloths {
            app.world_mut().despawn(cloth);
        }
    }
    run(&mut app, 2);
    assert_eq!(app.world().entities().count_spawned(), entities);
    assert_eq!(app.world().resource::<Assets<Mesh>>().len(), 0);
}
