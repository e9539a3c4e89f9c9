//! The clock pauses, slows and steps, and never changes the motion it shows.

use crate::common::*;
use bevy::prelude::*;
use bevy_cloth::*;

fn hanging() -> (App, Entity) {
    let mut app = headless();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2))).id();
    (app, cloth)
}

fn clock(app: &mut App) -> Mut<'_, Time<ClothClock>> {
    app.world_mut().resource_mut()
}

fn ticks(app: &App) -> u32 {
    let clock = app.world().resource::<Time<ClothClock>>();
    (clock.elapsed().as_nanos() / clock.timestep().as_nanos()) as u32
}

/// The bits of an undisturbed run after each tick.
fn reference(ticks: usize) -> Vec<Bits> {
    let (mut app, cloth) = hanging();
    let mut tick = || {
        app.update();
        bits(&app, cloth)
    };
    (0..ticks).map(|_| tick()).collect()
}

#[test]
fn a_paused_clock_stands_and_goes_on_as_if_nothing_had_been() {
    let reference = reference(20);
    let (mut app, cloth) = hanging();
    run(&mut app, 10);
    clock(&mut app).pause();
    run(&mut app, 50);
    assert_eq!(bits(&app, cloth), reference[9]);
    assert_eq!(ticks(&app), 10);
    clock(&mut app).unpause();
    run(&mut app, 10);
    assert_eq!(bits(&app, cloth), reference[19]);
}

#[test]
fn single_steps_run_one_tick_each_while_paused() {
    let reference = reference(4);
    let (mut app, cloth) = hanging();
    clock(&mut app).pause();
    for tick in &reference {
        clock(&mut app).step_once();
        run(&mut app, 5);
        assert_eq!(bits(&app, cloth), *tick);
    }
    assert_eq!(ticks(&app), 4);
}

#[test]
fn slow_motion_shows_the_same_motion_over_more_frames() {
    let reference = reference(16);
    let (mut app, cloth) = hanging();
    clock(&mut app).set_relative_speed(0.25);
    run(&mut app, 4 * 16);
    assert_eq!(ticks(&app), 16);
    assert_eq!(bits(&app, cloth), reference[15]);
}

#[test]
fn fast_motion_shows_the_same_motion_over_fewer_frames() {
    let reference = reference(16);
    let (mut app, cloth) = hanging();
    clock(&mut app).set_relative_speed(4.0);
    run(&mut app, 4);
    assert_eq!(bits(&app, cloth), reference[15]);
}

#[test]
fn a_hitch_runs_a_bounded_number_of_ticks() {
    let (mut app, cloth) = hanging();
    run(&mut app, 2);
    let hitch = std::time::Duration::from_secs(100);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(hitch));
    app.update();
    // Bevy lets a frame be no longer than a quarter of a second.
    assert_eq!(ticks(&app), 2 + 16);
    assert!(get::<Particles>(&app, cloth).is_finite());
}

#[test]
fn no_time_is_no_motion() {
    let (mut app, cloth) = hanging();
    run(&mut app, 8);
    let before = bits(&app, cloth);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(std::time::Duration::ZERO));
    run(&mut app, 8);
    assert_eq!(bits(&app, cloth), before);
}

#[test]
fn in_another_schedule_the_ticks_are_as_long_and_the_motion_the_same() {
    let reference = reference(16);
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ClothPlugin::new(Update)));
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK * 4));
    app.update();
    let cloth = app.world_mut().spawn((Cloth::rectangle(0.5, 0.5).with_cells(8, 8), Pins::rods(2))).id();
    run(&mut app, 4);
    assert_eq!(bits(&app, cloth), reference[15]);
}

#[test]
fn within_a_tick_time_is_the_cloth_clock_and_outside_it_is_not() {
    #[derive(Resource, Default)]
    struct Inside(Vec<(f32, f32)>);
    let (mut app, _) = hanging();
    app.init_resource::<Inside>().add_systems(
        ClothSchedule,
        (|time: Res<Time>, mut inside: ResMut<Inside>| inside.0.push((time.delta_secs(), time.elapsed_secs())))
            .in_set(ClothSystems::Forces),
    );
    clock(&mut app).set_relative_speed(0.5);
    run(&mut app, 4);
    let tick = TICK.as_secs_f32();
    assert_eq!(app.world().resource::<Inside>().0, [(tick, tick), (tick, 2.0 * tick)]);
    assert_eq!(app.world().resource::<Time>().elapsed(), TICK * 4);
}
