//! What is left out of cloth that is far away or unseen.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

fn flag(more: impl Bundle) -> (App, Entity) {
    let mut app = headless();
    let wind = (Air::default(), Wind(Vec3::new(0.0, 0.0, 6.0)));
    let flag =
        app.world_mut().spawn((Cloth::rectangle(0.9, 0.6).with_cells(12, 8), Pins::top(), wind)).insert(more).id();
    (app, flag)
}

fn detail() -> ClothDetail {
    ClothDetail { reduced_from: 20.0, frozen_from: 50.0, ..default() }
}

/// A viewer so far from the origin.
fn viewer(app: &mut App, distance: f32) -> Entity {
    app.world_mut().spawn((ClothViewer, Transform::from_xyz(0.0, 0.0, distance))).id()
}

fn substeps(app: &App, cloth: Entity) -> u32 {
    get::<ClothStats>(app, cloth).substeps
}

/// How many substeps a tick has on average over so many ticks.
fn substeps_of(app: &mut App, cloth: Entity, ticks: usize) -> f32 {
    let count = |_| {
        run(app, 1);
        substeps(app, cloth)
    };
    (0..ticks).map(count).sum::<u32>() as f32 / ticks as f32
}

#[test]
fn near_and_without_a_viewer_all_is_computed_to_the_last_bit() {
    let motion = |more: fn(&mut App), with: bool| {
        let (mut app, flag) = flag(());
        if with {
            app.world_mut().entity_mut(flag).insert(detail());
        }
        more(&mut app);
        run(&mut app, 100);
        bits(&app, flag)
    };
    let plain = motion(|_| (), false);
    assert_eq!(motion(|_| (), true), plain, "without viewer or camera");
    assert_eq!(motion(|app| _ = viewer(app, 19.0), true), plain, "near a viewer");
    let two = |app: &mut App| [90.0, 19.0].iter().for_each(|distance| _ = viewer(app, *distance));
    assert_eq!(motion(two, true), plain, "near one of two viewers");
    let camera = |app: &mut App| {
        app.world_mut().spawn((Camera::default(), Transform::from_xyz(0.0, 0.0, 15.0)));
        app.world_mut().spawn((Camera { is_active: false, ..default() }, Transform::from_xyz(0.0, 0.0, 90.0)));
    };
    assert_eq!(motion(camera, true), plain, "near a camera");
}

#[test]
fn a_camera_that_is_not_active_does_not_see_it() {
    let (mut app, flag) = flag((detail(), ClothStats::default()));
    let cameras = [(true, 30.0), (false, 5.0)].map(|(is_active, distance)| {
        app.world_mut().spawn((Camera { is_active, ..default() }, Transform::from_xyz(0.0, 0.0, distance))).id()
    });
    run(&mut app, 120);
    let far = substeps_of(&mut app, flag, 120);
    app.world_mut().get_mut::<Camera>(cameras[1]).expect("it is there").is_active = true;
    run(&mut app, 120);
    let near = substeps_of(&mut app, flag, 120);
    assert!(far < 0.7 * near, "{far} substeps far off, {near} near");
}

#[test]
fn farther_off_it_takes_fewer_substeps_and_rests_as_it_rests_near() {
    let (mut app, flag) = flag((detail(), ClothStats::default()));
    let eye = viewer(&mut app, 5.0);
    run(&mut app, 120);
    let near = substeps_of(&mut app, flag, 120);
    app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = 30.0;
    run(&mut app, 120);
    let far = substeps_of(&mut app, flag, 120);
    assert!(far < 0.7 * near, "{far} substeps far off, {near} near");
    app.world_mut().entity_mut(flag).remove::<Wind>();
    run(&mut app, 900);
    let hangs = centre(&app, flag);
    app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = 5.0;
    run(&mut app, 300);
    let moved = centre(&app, flag).distance(hangs);
    assert!(moved < 1e-3, "it hangs {moved} m elsewhere");
}

#[test]
fn frozen_it_keeps_its_shape_goes_with_what_it_hangs_on_and_moves_on_from_there() {
    let (mut app, flag) = flag((detail(), ClothStats::default()));
    let eye = viewer(&mut app, 5.0);
    run(&mut app, 100);
    app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = 80.0;
    run(&mut app, 1);
    let shape = get::<Particles>(&app, flag).position.clone();
    // Its pole is moved and turned, each frame a little.
    for step in 1..=60 {
        let part = step as f32 / 60.0;
        app.world_mut()
            .entity_mut(flag)
            .insert(Transform::from_xyz(3.0 * part, part, 0.0).with_rotation(Quat::from_rotation_y(2.0 * part)));
        run(&mut app, 1);
    }
    assert_eq!(get::<Particles>(&app, flag).position, shape, "its shape, seen from its frame");
    let place = get::<Transform>(&app, flag).translation;
    assert!(get::<ClothFrame>(&app, flag).pose.position.distance(place) < 1e-6);
    assert_eq!(get::<Particles>(&app, flag).velocity.get(20), Vec3::ZERO);
    // It goes on without a jolt, though it is blown from another side now.
    app.world_mut().entity_mut(flag).insert(Wind(Vec3::ZERO));
    app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = 10.0;
    let mut before = world_positions(&app, flag);
    for tick in 0..120 {
        run(&mut app, 1);
        let now = world_positions(&app, flag);
        let moved = largest_move(&before, &now);
        assert!(moved < 5.0 * TICK.as_secs_f32(), "{moved} m in tick {tick}");
        before = now;
    }
    assert!(largest_move(&world_positions(&app, flag), &before) == 0.0);
    assert_ne!(get::<Particles>(&app, flag).position, shape, "it moves");
}

#[test]
fn it_does_not_go_to_and_fro_on_the_border() {
    let (mut app, flag) = flag((detail(), ClothStats::default()));
    let eye = viewer(&mut app, 51.0);
    run(&mut app, 2);
    let frozen = bits(&app, flag);
    for distance in [49.9, 47.0, 46.0, 50.1] {
        app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = distance;
        run(&mut app, 3);
        assert_eq!(bits(&app, flag), frozen, "at {distance} m");
    }
    app.world_mut().get_mut::<Transform>(eye).expect("it is there").translation.z = 44.9;
    run(&mut app, 3);
    assert_ne!(bits(&app, flag), frozen);
}

#[test]
fn unseen_it_is_frozen_if_that_is_wanted() {
    use bevy::camera::visibility::{SetViewVisibility, ViewVisibility};
    for (freeze_unseen, seen) in [(true, true), (true, false), (false, false)] {
        let (mut app, flag) = flag(ClothDetail { freeze_unseen, ..detail() });
        app.world_mut().entity_mut(flag).insert(ViewVisibility::default());
        if seen {
            app.world_mut().get_mut::<ViewVisibility>(flag).expect("it is there").set_visible();
        }
        run(&mut app, 2);
        let before = bits(&app, flag);
        run(&mut app, 10);
        assert_eq!(bits(&app, flag) == before, freeze_unseen && !seen, "freeze_unseen {freeze_unseen}, seen {seen}");
    }
}

#[test]
fn a_wrong_distance_is_told() {
    let (mut app, flag) = flag(());
    note_events::<ClothRejected>(&mut app);
    app.world_mut().entity_mut(flag).insert(ClothDetail { frozen_from: -1.0, ..default() });
    run(&mut app, 2);
    let told = seen::<ClothRejected>(&app);
    assert_eq!(told.len(), 1);
    assert_eq!(told[0].error.to_string(), "`ClothDetail::frozen_from` is -1, allowed is 0 m or more");
}
