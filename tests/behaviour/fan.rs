//! Fans and wind zones blow where they stand, as long as they are there, and only at cloth that has air.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

/// A free sheet facing a fan 1.5 m away that blows along −z, no gravity.
fn scene(fan: impl Bundle) -> (App, Entity, Entity) {
    let mut app = headless();
    app.insert_resource(Shared(Gravity(Vec3::ZERO)));
    let sheet = app.world_mut().spawn((Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Air::default())).id();
    let fan = app.world_mut().spawn((Transform::from_xyz(0.0, 0.0, 1.5), fan)).id();
    (app, sheet, fan)
}

#[test]
fn a_fan_blows_cloth_away() {
    let (mut app, sheet, _) = scene(Fan::default());
    run(&mut app, 64);
    let at = centre(&app, sheet);
    assert!(at.z < -1.0 && at.truncate().length() < 0.2, "at {at}");
}

#[test]
fn a_fan_that_is_off_moves_nothing_until_it_is_switched_on() {
    let (mut app, sheet, fan) = scene(Fan { on: false, ..default() });
    run(&mut app, 32);
    assert_eq!(centre(&app, sheet), Vec3::ZERO);
    app.world_mut().get_mut::<Fan>(fan).unwrap().on = true;
    run(&mut app, 32);
    assert!(centre(&app, sheet).z < -0.3, "at {}", centre(&app, sheet));
}

#[test]
fn a_fan_that_is_turned_round_draws_gently() {
    let (mut app, sheet, fan) = scene(Fan::default());
    app.world_mut().entity_mut(fan).insert(Transform::from_xyz(0.0, 0.0, 1.5).looking_to(Vec3::Z, Vec3::Y));
    run(&mut app, 64);
    let at = centre(&app, sheet);
    assert!(at.z > 1e-3 && at.z < 0.1, "at {at}");
}

#[test]
fn a_fan_that_is_removed_or_despawned_blows_no_more() {
    for despawn in [false, true] {
        let (mut app, sheet, fan) = scene(Fan::default());
        run(&mut app, 8);
        if despawn {
            app.world_mut().despawn(fan);
        } else {
            app.world_mut().entity_mut(fan).remove::<Fan>();
        }
        app.world_mut().trigger(ResetCloth { entity: sheet });
        run(&mut app, 32);
        assert_eq!(centre(&app, sheet), Vec3::ZERO, "despawned: {despawn}");
    }
}

#[test]
fn a_fan_without_a_transform_stands_at_the_origin_and_a_child_follows_its_parent() {
    let (mut app, sheet, fan) = scene(());
    app.world_mut().entity_mut(sheet).insert(Transform::from_xyz(0.0, 0.0, -1.0));
    app.world_mut().spawn(Fan::default());
    run(&mut app, 32);
    assert!(centre(&app, sheet).z < -1.2, "at {}", centre(&app, sheet));

    let (mut app, sheet, parent) = scene(());
    app.world_mut().entity_mut(parent).insert(Transform::from_xyz(2.0, 0.0, 0.0));
    app.world_mut().spawn((Fan::default(), ChildOf(parent), Transform::default().looking_to(Vec3::NEG_X, Vec3::Y)));
    run(&mut app, 32);
    assert!(centre(&app, sheet).x < -0.1, "at {}", centre(&app, sheet));
    let _ = fan;
}

#[test]
fn a_collider_between_fan_and_cloth_shadows_it() {
    let (mut app, sheet, _) = scene(Fan::default());
    let wall = Transform::from_xyz(0.0, 0.0, 0.8);
    let wall = app.world_mut().spawn((ClothCollider::Cuboid { size: Vec3::new(3.0, 3.0, 0.1) }, wall)).id();
    run(&mut app, 32);
    assert_eq!(centre(&app, sheet), Vec3::ZERO);
    app.world_mut().get_mut::<Transform>(wall).unwrap().translation.x = 3.0;
    run(&mut app, 32);
    assert!(centre(&app, sheet).z < -0.3, "at {}", centre(&app, sheet));
}

#[test]
fn an_oscillating_fan_swings_with_the_clock_of_the_cloth() {
    // At the end of its swing after 40 ticks; 0.6 rad turn a narrow cone away from the sheet.
    let oscillation = Some(Oscillation { angle: 0.6, rate: 24.0 });
    let (mut app, sheet, _) = scene(Fan { spread: 0.1, oscillation, ..default() });
    let speed = |app: &App| get::<Particles>(app, sheet).airflow.as_ref().map_or(0.0, |air| -air.velocity.z[0]);
    run(&mut app, 2);
    assert!(speed(&app) > 3.0, "{} m/s in the middle", speed(&app));
    run(&mut app, 38);
    assert_eq!(speed(&app), 0.0, "at the end of its swing");
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    run(&mut app, 40);
    app.world_mut().resource_mut::<Time<ClothClock>>().unpause();
    run(&mut app, 1);
    assert_eq!(speed(&app), 0.0, "it stands while the clock does");
}

#[test]
fn a_zone_blows_inside_of_itself_along_its_own_axes_and_adds_to_the_wind() {
    let mut app = headless();
    app.insert_resource(Shared(Gravity(Vec3::ZERO))).insert_resource(Shared(Wind(Vec3::Y * 2.0)));
    let sheet = || (Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Air::default());
    let inside = app.world_mut().spawn(sheet()).id();
    let outside = app.world_mut().spawn((sheet(), Transform::from_xyz(5.0, 0.0, 0.0))).id();
    let zone = WindZone { shape: ZoneShape::Cuboid { size: Vec3::splat(4.0) }, ..default() };
    let turned = Transform::default().looking_to(Vec3::X, Vec3::Y);
    let zone = app.world_mut().spawn((zone, turned)).id();
    run(&mut app, 32);
    let (inside_at, outside_at) = (centre(&app, inside), centre(&app, outside) - Vec3::X * 5.0);
    assert!(inside_at.x > 0.02 && inside_at.y > 0.002, "inside at {inside_at}");
    assert!(outside_at.x.abs() < 1e-5 && outside_at.y > 0.002, "outside at {outside_at}");
    app.world_mut().despawn(zone);
    for cloth in [inside, outside] {
        app.world_mut().trigger(ResetCloth { entity: cloth });
    }
    run(&mut app, 32);
    assert!(centre(&app, inside).x.abs() < 1e-5);
}

#[test]
fn without_air_neither_fan_nor_zone_changes_a_bit() {
    let hung = |blown: bool| {
        let mut app = headless();
        let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::corners())).id();
        if blown {
            app.world_mut().spawn((Fan { speed: 50.0, ..default() }, Transform::from_xyz(0.0, 0.0, 1.0)));
            app.world_mut().spawn(WindZone::default());
        }
        run(&mut app, 32);
        assert!(get::<Particles>(&app, cloth).airflow.is_none());
        bits(&app, cloth)
    };
    assert_eq!(hung(false), hung(true));
}

#[test]
fn the_frame_rate_does_not_change_what_fans_zones_and_gusts_do() {
    let after_a_second = |hertz: f64| {
        let mut app = headless();
        let frame = std::time::Duration::from_secs_f64(1.0 / hertz);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
        app.insert_resource(Shared(Wind(Vec3::X))).insert_resource(Shared(Gusts { intensity: 0.3, ..default() }));
        let place = Transform::from_xyz(0.1, 0.2, 0.3).with_rotation(Quat::from_rotation_y(0.4));
        let flag = app.world_mut().spawn((Cloth::rectangle(0.6, 0.4).with_cells(9, 6), place, Air::default())).id();
        app.world_mut().entity_mut(flag).insert(Pins::corners());
        let oscillation = Some(Oscillation { angle: 0.5, rate: 60.0 });
        app.world_mut().spawn((Fan { oscillation, ..default() }, Transform::from_xyz(0.0, 0.0, 1.5)));
        app.world_mut().spawn((WindZone::default(), Transform::from_xyz(0.5, 0.0, 0.0)));
        let moving = (ClothCollider::Sphere { radius: 0.1 }, Transform::from_xyz(-0.4, 0.0, 0.8));
        app.world_mut().spawn(moving);
        app.add_systems(FixedUpdate, |mut balls: Query<&mut Transform, With<ClothCollider>>| {
            balls.iter_mut().for_each(|mut ball| ball.translation.x += 0.01);
        });
        while app.world().resource::<Time<ClothClock>>().elapsed_secs_f64() < 1.0 {
            app.update();
        }
        let ticks = (app.world().resource::<Time<ClothClock>>().elapsed_secs_f64() * 64.0).round();
        assert_eq!(ticks, 64.0, "frames that end with the second");
        bits(&app, flag)
    };
    let [slow, usual] = [32.0, 64.0].map(after_a_second);
    assert_eq!(slow, usual);
    assert_eq!(usual, after_a_second(128.0));
}

/// What a fan or a zone with `bad` is told, and whether it blows once `mended`.
fn refused_until_mended(bad: impl Bundle, mended: impl Bundle, says: &str) {
    let (mut app, sheet, source) = scene(bad);
    note_events::<WindRejected>(&mut app);
    run(&mut app, 8);
    let told = seen::<WindRejected>(&app);
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert_eq!(told[0].entity, source);
    assert!(told[0].error.to_string().contains(says), "{} does not say {says}", told[0].error);
    assert_eq!(centre(&app, sheet), Vec3::ZERO);
    app.world_mut().entity_mut(source).insert(mended);
    run(&mut app, 32);
    assert!(centre(&app, sheet).z < -0.05, "at {}", centre(&app, sheet));
    assert_eq!(seen::<WindRejected>(&app).len(), 1);
}

#[test]
fn wrong_fans_and_zones_are_refused_by_name_and_blow_once_they_are_mended() {
    let near = || Transform::from_xyz(0.0, 0.0, 0.3);
    refused_until_mended(
        Fan { diameter: 0.0, ..default() },
        Fan::default(),
        "`Fan::diameter` is 0, allowed is 0.01..=100",
    );
    refused_until_mended(Fan { speed: f32::NAN, ..default() }, Fan::default(), "`Fan::speed` is NaN");
    let zone = WindZone { falloff: -1.0, ..default() };
    refused_until_mended(zone, (WindZone::default(), near()), "`WindZone::falloff` is -1");
}

#[test]
fn a_fan_whose_transform_is_lost_blows_from_where_it_was() {
    let (mut app, sheet, fan) = scene(Fan::default());
    note_events::<WindRejected>(&mut app);
    run(&mut app, 2);
    app.world_mut().get_mut::<Transform>(fan).unwrap().translation = Vec3::NAN;
    run(&mut app, 62);
    assert!(centre(&app, sheet).z < -1.0, "at {}", centre(&app, sheet));
    let told = seen::<WindRejected>(&app);
    assert!(told.len() == 1 && told[0].error.to_string().contains("`Transform` is NaN"), "{told:?}");
}
