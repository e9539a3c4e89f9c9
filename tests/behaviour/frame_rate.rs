//! The frame rate never changes the motion, and neither does anything else that is not part of the scene.

use std::time::Duration;

use crate::common::Bits;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::*;

/// A curtain dragged along by its moving rod into a moving ball, and a second cloth that falls on the ground.
fn scene(frame: Duration) -> (App, [Entity; 2]) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::default()));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    let world = app.world_mut();
    let curtain = world.spawn((Cloth::rectangle(1.0, 0.8).with_cells(20, 16), Pins::rods(4), Driven(0.5))).id();
    let sheet = Transform::from_xyz(3.0, 0.3, 0.0).with_rotation(Quat::from_rotation_x(-1.5));
    let sheet = world.spawn((Cloth::rectangle(0.5, 0.5).with_cells(10, 10), Fabric::SILK_CHARMEUSE, sheet)).id();
    world.spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(0.2, -0.3, 0.3), Driven(-1.0)));
    world.spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -0.2, 0.0)));
    app.add_systems(FixedUpdate, |time: Res<Time>, mut driven: Query<(&mut Transform, &Driven)>| {
        for (mut transform, Driven(speed)) in &mut driven {
            transform.translation.z += speed * time.delta_secs() * (3.0 * time.elapsed_secs()).sin();
            transform.rotate_y(0.2 * speed * time.delta_secs());
        }
    });
    (app, [curtain, sheet])
}

#[derive(Component)]
struct Driven(f32);

/// The bits of both clothes at each whole second.
fn history(frame: Duration, seconds: usize) -> Vec<[Bits; 2]> {
    let (mut app, cloths) = scene(frame);
    let mut history = Vec::new();
    // Ticks are counted by the clock itself: 144 frames of a hundred and forty-fourth of a second, rounded to
    // nanoseconds, are a few nanoseconds short of a second.
    app.add_systems(ClothSchedule, note.after(ClothSystems::Writeback));
    app.insert_resource(Notes { cloths, seconds: Vec::new() });
    // At most 144 frames a second, and one to start the clock.
    for _ in 0..=145 * seconds {
        if history.len() < seconds {
            app.update();
            history = app.world().resource::<Notes>().seconds.clone();
        }
    }
    assert_eq!(history.len(), seconds, "seconds passed");
    history
}

#[derive(Resource)]
struct Notes {
    cloths: [Entity; 2],
    seconds: Vec<[Bits; 2]>,
}

fn note(time: Res<Time<ClothClock>>, particles: Query<&Particles>, mut notes: ResMut<Notes>) {
    if time.elapsed().subsec_nanos() == 0 {
        let now = notes.cloths.map(|cloth| Bits::of(particles.get(cloth).expect("both clothes run")));
        notes.seconds.push(now);
    }
}

#[test]
fn frame_rates_of_24_60_and_144_hertz_give_the_same_bits_at_every_second() {
    let [slow, usual, fast] = [24.0, 60.0, 144.0].map(|hertz| history(Duration::from_secs_f64(1.0 / hertz), 3));
    assert_ne!(slow[0], slow[1], "nothing moves");
    assert_eq!(slow, usual);
    assert_eq!(usual, fast);
}

#[test]
fn two_runs_give_the_same_bits() {
    let frame = Duration::from_millis(17);
    assert_eq!(history(frame, 2), history(frame, 2));
}
