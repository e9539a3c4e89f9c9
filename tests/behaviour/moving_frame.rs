//! A cloth's frame moves with its entity; what is not pinned keeps its place in the world.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

fn falling(at: Transform) -> (App, Entity) {
    let mut app = headless();
    // Whatever happens to its transform is motion.
    let teleport = Teleport { policy: TeleportPolicy::Simulate, ..default() };
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(6, 6), at, teleport)).id();
    run(&mut app, 8);
    (app, cloth)
}

#[test]
fn a_cloth_without_pins_falls_on_whatever_happens_to_its_transform() {
    let (mut still, reference) = falling(Transform::IDENTITY);
    let (mut app, cloth) = falling(Transform::IDENTITY);
    for round in 0..32 {
        let mut transform = app.world_mut().get_mut::<Transform>(cloth).unwrap();
        transform.translation = Vec3::new((round as f32 * 0.7).sin(), 0.3, -0.2 * round as f32);
        transform.rotate(Quat::from_euler(EulerRot::XYZ, 0.3, -0.2, 0.1));
        app.update();
        still.update();
        let apart = largest_move(&world_positions(&still, reference), &world_positions(&app, cloth));
        assert!(apart < 1e-3, "after {round} rounds {apart} m from where it would have fallen");
    }
}

#[test]
fn a_parent_that_moves_moves_the_frame_as_well() {
    let mut app = headless();
    let parent = app.world_mut().spawn(Transform::from_xyz(0.0, 1.0, 0.0)).id();
    let child =
        (Cloth::rectangle(1.0, 1.0).with_cells(8, 8), Pins::top(), Transform::from_xyz(0.0, 1.0, 0.0), ChildOf(parent));
    let cloth = app.world_mut().spawn(child).id();
    run(&mut app, 2);
    let turn = Quat::from_rotation_y(0.3);
    app.world_mut().get_mut::<Transform>(parent).unwrap().rotation = turn;
    run(&mut app, 2);
    let corner = get::<ClothFrame>(&app, cloth).to_world(get::<Particles>(&app, cloth).position.get(0));
    assert!(corner.distance(turn * Vec3::new(-0.5, 2.5, 0.0)) < 1e-5, "the corner is at {corner}");
}

#[test]
fn a_turning_parent_does_not_build_the_cloth_anew() {
    let mut app = headless();
    let parent = app.world_mut().spawn(Transform::from_scale(Vec3::splat(1.7))).id();
    let cloth = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(6, 6), ChildOf(parent))).id();
    run(&mut app, 64);
    for _ in 0..64 {
        app.world_mut().get_mut::<Transform>(parent).unwrap().rotate_y(0.1);
        app.update();
    }
    assert!(centre(&app, cloth).y < -10.0, "it began anew and fell only to {}", centre(&app, cloth));
}

#[test]
fn gravity_points_down_in_a_turned_frame() {
    let (mut app, cloth) = falling(Transform::from_rotation(Quat::from_rotation_z(1.0)));
    run(&mut app, 32);
    let fallen = centre(&app, cloth);
    assert!(fallen.x.abs() < 1e-3 && fallen.y < -1.0, "it fell to {fallen}");
}

#[test]
fn ten_kilometres_from_the_origin_a_cloth_hangs_as_it_does_there() {
    let shape = |x: f32| {
        let mut app = headless();
        let cloth = (Cloth::rectangle(0.5, 0.5).with_cells(10, 10), Pins::rods(2), Transform::from_xyz(x, 0.0, 0.0));
        let cloth = app.world_mut().spawn(cloth).id();
        let ball = Transform::from_xyz(x, -0.1, 0.125);
        app.world_mut().spawn((ClothCollider::Sphere { radius: 0.25 }, ball));
        run(&mut app, 128);
        bits(&app, cloth)
    };
    // 8192 m is a power of two, at which the ball's place is exact.
    assert_eq!(shape(0.0), shape(8192.0));
}

#[test]
fn a_moving_collider_carries_cloth_along() {
    let mut app = headless();
    let flat = Transform::from_xyz(0.0, 0.27, 0.0).with_rotation(Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2));
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.3, 0.3).with_cells(6, 6), flat)).id();
    let tray = ClothCollider::Cuboid { size: Vec3::new(1.0, 0.5, 1.0) };
    let tray = app.world_mut().spawn((tray, ColliderFriction(1.0))).id();
    run(&mut app, 32);
    for _ in 0..64 {
        app.world_mut().get_mut::<Transform>(tray).unwrap().translation.x += 0.5 / 64.0;
        app.update();
    }
    let carried = centre(&app, cloth).x;
    assert!((carried - 0.5).abs() < 0.05, "carried {carried} m of 0.5 m");
}

#[test]
fn a_rod_that_jumps_takes_its_curtain_along_and_leaves_it_whole() {
    use TeleportPolicy::*;
    for (distance, policy) in [(1.0, Simulate), (10.0, Simulate), (1.0, CarryAlong), (1000.0, CarryAlong)] {
        let mut app = headless();
        let cloth = (Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::rods(3), ClothStats::default());
        let cloth = app.world_mut().spawn((cloth, Teleport { policy, ..default() })).id();
        run(&mut app, 32);
        let mut transform = app.world_mut().get_mut::<Transform>(cloth).unwrap();
        *transform = Transform::from_xyz(distance, 0.0, 0.0).with_rotation(Quat::from_rotation_y(std::f32::consts::PI));
        // A jump of 10 m within a tick is a blow of 100 kJ, which without air only the fabric's own friction takes.
        for tick in 0..256 {
            app.update();
            assert!(
                get::<Particles>(&app, cloth).is_finite(),
                "{policy:?} {distance} m: not finite after {tick} ticks"
            );
        }
        assert_eq!(take_messages::<ClothRecovered>(&mut app), [], "{policy:?} {distance} m");
        let stats = get::<ClothStats>(&app, cloth);
        assert!(stats.largest_strain < Fabric::COTTON_POPLIN.stretch_limit, "{policy:?} {distance} m: {stats:?}");
        let away = centre(&app, cloth).distance(Vec3::X * distance);
        assert!(away < 0.5, "{policy:?} {distance} m: the cloth is still {away} m away after four seconds");
    }
}
