//! What is moved once a frame moves over all ticks of the frame; what is moved before each tick is never late.

use std::time::Duration;

use crate::common::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::cloth_solver::cloth::Constraints;
use bevy_cloth::cloth_solver::contact::Contacts;
use bevy_cloth::*;

/// What was seen after each tick.
#[derive(Resource, Default)]
struct Seen(Vec<f32>);

/// Notes one number after each tick from now on.
fn note<M>(app: &mut App, look: impl IntoSystem<(), f32, M>) {
    let keep = |In(number): In<f32>, mut seen: ResMut<Seen>| seen.0.push(number);
    app.insert_resource(Seen::default());
    app.add_systems(ClothSchedule, look.pipe(keep).after(ClothSystems::Writeback));
}

/// Updates once, and gives what was noted in it.
fn noted(app: &mut App) -> Vec<f32> {
    app.world_mut().resource_mut::<Seen>().0.clear();
    app.update();
    app.world().resource::<Seen>().0.clone()
}

fn frames_of(app: &mut App, ticks: u32) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK * ticks));
}

/// Moves an entity between two frames, as a system in `Update` does.
fn put(app: &mut App, entity: Entity, x: f32) {
    app.world_mut().get_mut::<Transform>(entity).unwrap().translation.x = x;
}

fn assert_evenly(seen: &[f32], wanted: &[f32]) {
    let same = seen.len() == wanted.len() && seen.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(same, "{seen:?} instead of {wanted:?}");
}

const FIFTHS: [f32; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];

/// A curtain held by an entity. Notes where its corner is.
fn held_by_a_hand(plugin: ClothPlugin) -> (App, Entity, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, plugin));
    frames_of(&mut app, 1);
    app.update();
    let hand = app.world_mut().spawn(Transform::from_xyz(0.0, 0.2, 0.0)).id();
    let pins = Pins::top().to_entity(hand);
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.4, 0.4).with_cells(4, 4), pins)).id();
    note(&mut app, |cloths: Query<(&Particles, &ClothFrame)>| {
        cloths.single().map_or(f32::NAN, |(particles, frame)| frame.to_world(particles.position.get(0)).x + 0.2)
    });
    run(&mut app, 3);
    (app, cloth, hand)
}

#[test]
fn a_pin_moved_once_in_a_frame_of_five_ticks_moves_a_fifth_in_each() {
    for plugin in [ClothPlugin::default(), ClothPlugin::new(Update)] {
        let (mut app, _, hand) = held_by_a_hand(plugin);
        frames_of(&mut app, 5);
        put(&mut app, hand, 0.5);
        assert_evenly(&noted(&mut app), &FIFTHS);
        assert_evenly(&noted(&mut app), &[0.5; 5]);
    }
}

#[test]
fn a_pin_moved_once_in_a_frame_of_one_tick_is_there_in_that_tick() {
    let (mut app, _, hand) = held_by_a_hand(ClothPlugin::default());
    for x in [0.1, 0.3, 0.2] {
        put(&mut app, hand, x);
        assert_evenly(&noted(&mut app), &[x]);
    }
}

#[test]
fn a_slow_clock_spreads_the_move_over_the_ticks_it_has() {
    let (mut app, _, hand) = held_by_a_hand(ClothPlugin::default());
    app.world_mut().resource_mut::<Time<ClothClock>>().set_relative_speed(0.5);
    frames_of(&mut app, 10);
    put(&mut app, hand, 0.5);
    assert_evenly(&noted(&mut app), &FIFTHS);
}

#[test]
fn a_fast_clock_spreads_the_move_over_the_ticks_it_has() {
    let (mut app, _, hand) = held_by_a_hand(ClothPlugin::default());
    app.world_mut().resource_mut::<Time<ClothClock>>().set_relative_speed(5.0);
    put(&mut app, hand, 0.5);
    assert_evenly(&noted(&mut app), &FIFTHS);
}

#[test]
fn the_frame_of_a_cloth_moves_a_fifth_in_each_tick() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.4, 0.4).with_cells(4, 4), Pins::top())).id();
    note(&mut app, |frames: Query<&ClothFrame>| frames.single().map_or(f32::NAN, |frame| frame.pose.position.x));
    run(&mut app, 3);
    frames_of(&mut app, 5);
    put(&mut app, cloth, 0.5);
    assert_evenly(&noted(&mut app), &FIFTHS);
}

#[test]
fn a_hand_moves_a_fifth_in_each_tick() {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.4, 0.4).with_cells(4, 4), Pins::top())).id();
    note(&mut app, |clothes: Query<&Constraints>| {
        clothes.single().ok().and_then(|cloth| cloth.grabs.first()).map_or(f32::NAN, |grab| grab.to.x)
    });
    app.world_mut().entity_mut(cloth).insert(Grabs(vec![Grab::default()]));
    run(&mut app, 3);
    frames_of(&mut app, 5);
    app.world_mut().get_mut::<Grabs>(cloth).unwrap().0[0].target.x = 0.5;
    assert_evenly(&noted(&mut app), &FIFTHS);
}

#[test]
fn a_collider_moved_before_each_tick_is_never_late() {
    let mut app = headless();
    app.world_mut().spawn((Cloth::rectangle(0.4, 0.4).with_cells(4, 4), Pins::top()));
    let ball = app.world_mut().spawn(ClothCollider::Sphere { radius: 0.1 }).id();
    app.add_systems(FixedUpdate, |mut balls: Query<&mut Transform, With<ClothCollider>>| {
        balls.iter_mut().for_each(|mut transform| transform.translation.x += 0.01);
    });
    // By how much it is behind.
    note(&mut app, move |contacts: Query<&Contacts>, transforms: Query<&Transform>| {
        let seen = contacts.single().expect("one cloth").colliders[0].motion.to.position.x;
        transforms.get(ball).expect("it is there").translation.x - seen
    });
    // Few ticks in a frame, then many, as with a game that begins to stutter.
    for ticks in [1, 1, 3, 1, 5, 2] {
        frames_of(&mut app, ticks);
        assert_eq!(noted(&mut app), vec![0.0; ticks as usize]);
    }
}

/// A ball that comes to a curtain and stays in it, moved once a frame. The largest strain on its way, and where the curtain
/// is two seconds later, in its middle.
fn pushed_at(frames_a_second: f64) -> (f32, Vec3) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::default()));
    app.world_mut().resource_mut::<Time<Virtual>>().set_max_delta(Duration::from_secs(1));
    let frame = Duration::from_secs_f64(1.0 / frames_a_second);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    let stats = (ClothStats::default(), Tearable::default());
    let curtain = app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(12, 12), Pins::top(), stats)).id();
    app.world_mut().spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(0.0, -0.1, 0.6)));
    note(&mut app, |stats: Query<&ClothStats>| stats.single().map_or(f32::NAN, |stats| stats.largest_strain));
    note_events::<ClothTorn>(&mut app);
    app.add_systems(Update, |mut balls: Query<&mut Transform, With<ClothCollider>>, time: Res<Time>| {
        balls.iter_mut().for_each(|mut transform| transform.translation.z = (0.6 - time.elapsed_secs()).max(0.0));
    });
    for _ in 0..(3.0 * frames_a_second) as usize {
        app.update();
    }
    assert_eq!(crate::common::seen::<ClothTorn>(&app).len(), 0, "it tore");
    let strains = &app.world().resource::<Seen>().0;
    assert!(strains.len() > 150);
    let grid = get::<ClothTopology>(&app, curtain).grid.expect("a rectangle has a grid");
    let middle = get::<Particles>(&app, curtain).position.get(grid.slot(6, 7) as usize);
    (strains.iter().fold(0.0, |largest, strain| strain.max(largest)), middle)
}

#[test]
fn a_ball_moved_once_a_frame_pushes_as_far_and_strains_no_more_at_3_and_at_30_frames_a_second() {
    let (usual_strain, usual) = pushed_at(60.0);
    for frames_a_second in [30.0, 3.0] {
        let (strain, middle) = pushed_at(frames_a_second);
        assert!(strain < usual_strain + 0.01, "{frames_a_second} Hz: strain {strain}, at 60 Hz {usual_strain}");
        assert!(middle.distance(usual) < 0.02, "{frames_a_second} Hz: pushed to {middle}, at 60 Hz to {usual}");
    }
}
