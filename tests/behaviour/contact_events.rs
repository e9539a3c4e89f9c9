//! Colliders that want to know are told which cloth touches them, and with what force.

use crate::common::sleep::*;
use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

const SIZE: f32 = 0.4;

/// A towel that lies flat at this place, above whatever is there.
fn flat(at: Vec3) -> impl Bundle {
    let flat = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let cloth = Cloth::rectangle(SIZE, SIZE).with_cells(8, 8);
    (cloth, Fabric::TERRY_TOWEL, Air::default(), Transform::from_translation(at).with_rotation(flat))
}

fn weight() -> f32 {
    9.81 * SIZE * SIZE * Fabric::TERRY_TOWEL.areal_density
}

/// A table whose top is at height 0 and whose middle is at the origin.
fn table() -> impl Bundle {
    (ClothCollider::Cuboid { size: Vec3::new(2.0, 0.2, 2.0) }, Transform::from_xyz(0.0, -0.1, 0.0))
}

fn noting() -> App {
    let mut app = headless();
    note_events::<ContactBegan>(&mut app);
    note_events::<ContactEnded>(&mut app);
    app
}

fn force(app: &App, collider: Entity) -> ClothForce {
    *get::<ClothForce>(app, collider)
}

#[test]
fn what_lies_on_a_table_weighs_on_it_awake_and_asleep() {
    let mut app = headless();
    let table = app.world_mut().spawn((table(), ClothForce::default())).id();
    let at = Vec3::new(0.5, 0.01, -0.3);
    let cloth = app.world_mut().spawn(flat(at)).id();
    assert_eq!(force(&app, table), ClothForce::default());
    run_to_sleep(&mut app, cloth);
    let asleep = force(&app, table);
    for force in [asleep.force, {
        app.world_mut().trigger(WakeCloth { entity: cloth });
        run(&mut app, 8);
        force(&app, table).force
    }] {
        let error = (force - Vec3::NEG_Y * weight()).length() / weight();
        assert!(error < 0.01, "{force} N for a weight of {} N", weight());
    }
    // The origin of the table is a tenth of a metre below its top.
    let arm = at.with_y(0.1);
    let torque = arm.cross(Vec3::NEG_Y * weight());
    let error = (asleep.torque - torque).length() / torque.length();
    assert!(error < 0.02, "{} N·m, {torque} N·m expected", asleep.torque);
    assert_eq!(asleep.touching, 81);
}

#[test]
fn the_force_goes_when_the_cloth_goes_or_is_taken_away() {
    let mut app = headless();
    let table = app.world_mut().spawn((table(), ClothForce::default())).id();
    let [first, second] = [-0.5, 0.5].map(|x| app.world_mut().spawn(flat(Vec3::new(x, 0.01, 0.0))).id());
    run_to_sleep(&mut app, first);
    run_to_sleep(&mut app, second);
    let share = |app: &App| -force(app, table).force.y / weight();
    assert!((share(&app) - 2.0).abs() < 0.02, "{} weights", share(&app));
    app.world_mut().despawn(first);
    run(&mut app, 2);
    assert!((share(&app) - 1.0).abs() < 0.01, "{} weights", share(&app));
    app.world_mut().get_mut::<Transform>(second).unwrap().translation.y += 3.0;
    run(&mut app, 2);
    assert_eq!(force(&app, table), ClothForce::default());
}

#[test]
fn on_a_slope_friction_and_pressure_together_are_the_weight_whichever_way_the_cloth_is_turned() {
    for turn in [0.0, 1.0, 2.5] {
        let mut app = headless();
        let slope = Transform::from_rotation(Quat::from_rotation_z(0.2));
        let ground = (ClothCollider::Ground, slope, ColliderFriction(1.0), ClothForce::default());
        let ground = app.world_mut().spawn(ground).id();
        let lies = slope.rotation * Quat::from_rotation_y(turn) * Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let cloth = app.world_mut().spawn(flat(Vec3::Y * 0.02)).id();
        app.world_mut().get_mut::<Transform>(cloth).unwrap().rotation = lies;
        run_to_sleep(&mut app, cloth);
        let force = force(&app, ground).force;
        let error = (force - Vec3::NEG_Y * weight()).length() / weight();
        assert!(error < 0.02, "{force} N for a weight of {} N", weight());
    }
}

#[test]
fn a_contact_begins_once_at_the_speed_of_the_fall_and_ends_once_when_they_are_apart() {
    let mut app = noting();
    let table = app.world_mut().spawn((table(), ContactEvents)).id();
    // Without air it falls flat, all at once.
    let cloth = app.world_mut().spawn(flat(Vec3::Y * 0.5)).remove::<Air>().id();
    run(&mut app, 64);
    let began = seen::<ContactBegan>(&app).to_vec();
    let [ContactBegan { entity, cloth: by, speed, impulse }] = began[..] else { panic!("{began:?}") };
    assert_eq!((entity, by), (table, cloth));
    let fall = (2.0 * 9.81 * 0.5_f32).sqrt();
    assert!((speed / fall - 1.0).abs() < 0.03, "{speed} m/s after a fall to {fall} m/s");
    let momentum = weight() / 9.81 * fall;
    assert!((impulse / momentum - 1.0).abs() < 0.1, "{impulse} N·s of {momentum} N·s");
    assert_eq!(seen::<ContactEnded>(&app), []);
    let touched = 64.0 * TICK.as_secs_f32() - fall / 9.81;
    app.world_mut().get_mut::<Transform>(table).unwrap().translation.y -= 5.0;
    let mut messages = Vec::new();
    for _ in 0..16 {
        app.update();
        messages.extend(take_messages::<ContactEnded>(&mut app));
    }
    let ended = seen::<ContactEnded>(&app).to_vec();
    assert_eq!(ended, messages);
    let [ContactEnded { entity, cloth: by, impulse: strongest, duration }] = ended[..] else { panic!("{ended:?}") };
    assert_eq!((entity, by), (table, cloth));
    assert!(strongest >= impulse);
    assert!((duration - touched).abs() < 0.05, "{duration} s, {touched} s expected");
    assert_eq!(seen::<ContactBegan>(&app).len(), 1);
}

#[test]
fn a_collider_that_does_not_ask_is_told_nothing() {
    let mut app = noting();
    let (dumb, forced) = (app.world_mut().spawn(table()).id(), app.world_mut().spawn(table()).id());
    app.world_mut().entity_mut(forced).insert(ClothForce::default());
    app.world_mut().spawn(flat(Vec3::Y * 0.01));
    run(&mut app, 32);
    assert_eq!(seen::<ContactBegan>(&app), []);
    assert!(app.world().get::<ClothForce>(dumb).is_none());
}

#[test]
fn a_contact_ends_when_one_of_the_two_is_gone_or_nobody_asks_any_more() {
    for way in 0..5 {
        let mut app = noting();
        let table = app.world_mut().spawn((table(), ContactEvents)).id();
        let cloth = app.world_mut().spawn(flat(Vec3::Y * 0.01)).id();
        run_to_sleep(&mut app, cloth);
        assert_eq!(seen::<ContactEnded>(&app), []);
        let world = app.world_mut();
        match way {
            0 => world.entity_mut(table).despawn(),
            1 => world.entity_mut(cloth).despawn(),
            2 => _ = world.entity_mut(cloth).remove::<Cloth>(),
            3 => _ = world.entity_mut(table).remove::<ClothCollider>(),
            _ => {
                world.entity_mut(table).remove::<ContactEvents>();
                world.trigger(WakeCloth { entity: cloth });
            }
        }
        run(&mut app, 16);
        let ended = seen::<ContactEnded>(&app);
        assert!(matches!(ended, [ContactEnded { entity, cloth: by, .. }] if (*entity, *by) == (table, cloth)), "{way}");
    }
}

#[test]
fn every_contact_that_begins_ends_once_before_it_begins_again_whatever_happens() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(11);
    let mut app = noting();
    for x in [-0.3, 0.3] {
        let cloth = Cloth::rectangle(0.5, 0.5).with_cells(6, 6);
        app.world_mut().spawn((cloth, Pins::rods(2), Air::default(), Transform::from_xyz(x, 0.0, 0.0)));
    }
    let mut balls = Vec::new();
    for _ in 0..2000 {
        let place = Vec3::from_array([(); 3].map(|()| random.random_range(-0.4..0.4)));
        let world = app.world_mut();
        let which = random.random_range(0..8);
        match (random.random_range(0..12), balls.get(which).copied()) {
            (0, None) => {
                let ball = (ClothCollider::Sphere { radius: 0.1 }, ContactEvents, Transform::from_translation(place));
                balls.push(world.spawn(ball).id());
            }
            (1, Some(ball)) => {
                world.despawn(ball);
                balls.swap_remove(which);
            }
            (2, Some(ball)) => _ = world.entity_mut(ball).remove::<ContactEvents>(),
            (3, Some(ball)) => _ = world.entity_mut(ball).insert((ContactEvents, ClothForce::default())),
            (4..8, Some(ball)) => world.get_mut::<Transform>(ball).unwrap().translation += 0.1 * place,
            (8, Some(ball)) => world.get_mut::<Transform>(ball).unwrap().translation = place,
            _ => {}
        }
        app.update();
    }
    let world = app.world_mut();
    let cloths: Vec<Entity> = world.query_filtered::<Entity, With<Cloth>>().iter(world).collect();
    cloths.into_iter().for_each(|cloth| _ = world.despawn(cloth));
    run(&mut app, 2);
    let pairs = |began: &ContactBegan| (began.entity, began.cloth);
    let mut began: Vec<_> = seen::<ContactBegan>(&app).iter().map(pairs).collect();
    let mut ended: Vec<_> = seen::<ContactEnded>(&app).iter().map(|ended| (ended.entity, ended.cloth)).collect();
    assert!(began.len() > 50, "only {} contacts", began.len());
    began.sort_unstable();
    ended.sort_unstable();
    assert_eq!(began, ended);
    assert!(seen::<ContactEnded>(&app).iter().all(|ended| ended.impulse >= 0.0 && ended.duration > 0.0));
}

#[test]
fn a_curtain_that_flutters_against_a_post_tells_so_ten_times_a_second_at_most() {
    let mut app = noting();
    app.world_mut().resource_mut::<Shared<Wind>>().0 = Wind(Vec3::new(6.0, 0.0, 2.0));
    app.world_mut().resource_mut::<Shared<Gusts>>().0 = Gusts { intensity: 0.4, ..default() };
    app.world_mut().spawn((Cloth::rectangle(0.6, 0.4).with_cells(12, 8), Pins::corners(), Air::default()));
    let post = (ClothCollider::Capsule { radius: 0.03, length: 1.0 }, Transform::from_xyz(0.1, 0.0, 0.05));
    app.world_mut().spawn((post, ContactEvents));
    run(&mut app, ticks(6.0));
    let count = seen::<ContactBegan>(&app).len();
    assert!((1..60).contains(&count), "it began {count} times");
}
