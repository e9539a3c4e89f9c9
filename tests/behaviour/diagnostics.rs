//! Times and totals are there for those who add the plugin for them.

use crate::common::*;
use bevy::diagnostic::{DiagnosticPath, DiagnosticsStore};
use bevy::prelude::*;
use bevy_cloth::*;

type Watch = ClothDiagnosticsPlugin;

fn value(app: &App, path: &DiagnosticPath) -> f64 {
    let store = app.world().resource::<DiagnosticsStore>();
    let diagnostic = store.get(path).unwrap_or_else(|| panic!("{path} is not registered"));
    diagnostic.value().unwrap_or_else(|| panic!("{path} was not measured"))
}

/// A thousand particles over a ball, measured for half a second.
fn measured() -> App {
    let mut app = headless();
    app.add_plugins(ClothDiagnosticsPlugin);
    app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(24, 19), Pins::rods(3)));
    app.world_mut().spawn((Cloth::rectangle(1.0, 1.0).with_cells(24, 19), Pins::rods(3)));
    app.world_mut().spawn((ClothCollider::Sphere { radius: 0.2 }, Transform::from_xyz(0.0, -0.2, 0.1)));
    run(&mut app, 32);
    app
}

#[test]
fn totals_add_up_over_all_clothes() {
    let mut app = measured();
    assert_eq!(value(&app, &Watch::PARTICLES), 1000.0);
    assert!(value(&app, &Watch::CONSTRAINTS) > 5000.0);
    let mut touches = || {
        app.update();
        value(&app, &Watch::CONTACTS)
    };
    assert!((0..64).any(|_| touches() > 0.0), "in a second it never touches the ball");
    assert!((0.0..5.0).contains(&value(&app, &Watch::LARGEST_STRAIN)));
}

#[test]
fn every_phase_is_timed_and_the_substep_holds_its_parts() {
    let app = measured();
    let time = |path| value(&app, &path);
    for path in [Watch::PREPARE, Watch::FORCES, Watch::TEAR, Watch::BURN, Watch::WRITEBACK, Watch::DRAW] {
        assert!(time(path) >= 0.0);
    }
    let parts = time(Watch::INTEGRATE) + time(Watch::SOLVE) + time(Watch::COLLIDE);
    assert!(time(Watch::SOLVE) > 0.0 && time(Watch::COLLIDE) > 0.0);
    assert!(time(Watch::SUBSTEP) >= parts, "{} ms hold {parts} ms", time(Watch::SUBSTEP));
}

#[test]
fn a_frame_without_a_tick_adds_no_time() {
    let mut app = measured();
    let count = |app: &App| app.world().resource::<DiagnosticsStore>().get(&Watch::SOLVE).unwrap().history_len();
    app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    let before = count(&app);
    run(&mut app, 5);
    assert_eq!(count(&app), before);
}

#[test]
fn cloths_that_sleep_are_counted() {
    let mut app = headless();
    app.add_plugins(ClothDiagnosticsPlugin);
    let cloth = (Cloth::rectangle(0.3, 0.3).with_cells(4, 4), Gravity(Vec3::ZERO));
    app.world_mut().spawn(cloth.clone());
    app.world_mut().spawn((cloth.clone(), ClothSleep::NEVER));
    app.world_mut().spawn(cloth);
    run(&mut app, 10);
    assert_eq!(value(&app, &Watch::ASLEEP), 0.0);
    run(&mut app, 40);
    assert_eq!(value(&app, &Watch::ASLEEP), 2.0);
}
