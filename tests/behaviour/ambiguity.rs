//! No two systems of the plugin touch the same data in an order that is left open.

use crate::common::*;
use bevy::ecs::schedule::{InternedScheduleLabel, LogLevel, ScheduleBuildSettings, ScheduleLabel};
use bevy::prelude::*;
use bevy_cloth::*;

/// Turns ambiguity into an error in these schedules and runs a scene with everything in it. Bevy panics at the first.
fn run_strictly(app: &mut App, schedules: &[InternedScheduleLabel]) {
    for label in schedules {
        app.edit_schedule(*label, |schedule| {
            let strict = ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..default() };
            schedule.set_build_settings(strict);
        });
    }
    app.world_mut()
        .spawn((
            Cloth::rectangle(0.5, 0.5),
            Pins::rods(2),
            Grabs::default(),
            ClothStats::default(),
            SelfContact::default(),
        ))
        .insert((Weights::one(PinSelect::Corners, 0.1), Air::default(), Wind(Vec3::X)));
    app.world_mut().spawn(ClothCollider::Ground);
    app.world_mut().spawn((Fan::default(), WindZone::default()));
    run(app, 3);
}

fn own() -> [InternedScheduleLabel; 2] {
    [ClothSchedule.intern(), ClothSubstepSchedule.intern()]
}

#[test]
fn the_schedules_of_the_plugin_are_unambiguous() {
    let mut app = headless();
    app.add_plugins(ClothDiagnosticsPlugin);
    run_strictly(&mut app, &own());
}

#[test]
fn the_fixed_schedules_are_unambiguous_with_the_default_plugins() {
    let mut app = App::new();
    let plugins = DefaultPlugins.build().disable::<bevy::winit::WinitPlugin>().disable::<bevy::log::LogPlugin>();
    let plugins = plugins.set(bevy::render::RenderPlugin {
        render_creation: bevy::render::settings::WgpuSettings { backends: None, ..default() }.into(),
        ..default()
    });
    app.add_plugins((plugins, ClothPlugin::default(), ClothDiagnosticsPlugin));
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(TICK));
    let fixed = [FixedPreUpdate.intern(), FixedUpdate.intern(), FixedPostUpdate.intern()];
    app.finish();
    app.cleanup();
    run_strictly(&mut app, &[&own()[..], &fixed].concat());
}

#[test]
fn with_assets_and_picking_alone_every_schedule_of_a_frame_is_unambiguous() {
    let mut app = with_meshes();
    app.add_plugins((TransformPlugin, bevy::picking::PickingPlugin, bevy::picking::InteractionPlugin));
    run_strictly(
        &mut app,
        &[&own()[..], &[FixedPostUpdate.intern(), PreUpdate.intern(), PostUpdate.intern()]].concat(),
    );
}

#[test]
#[should_panic]
fn this_test_notices_an_ambiguity() {
    let mut app = headless();
    app.add_systems(ClothSchedule, |mut particles: Query<&mut Particles>| particles.iter_mut().for_each(|_| {}));
    run_strictly(&mut app, &own());
}
