//! A cloth that has come to rest falls asleep: it stands still, at no cost, until something could move it.

mod common;

use bevy::prelude::*;
use bevy_cloth::*;
use common::*;

/// Longest time in which a cloth must have come to rest, s.
const LONG: f32 = 30.0;

fn ticks(seconds: f32) -> usize {
    (seconds / TICK.as_secs_f32()).round() as usize
}

fn is_asleep(app: &App, cloth: Entity) -> bool {
    app.world().entity(cloth).contains::<ClothAsleep>()
}

/// Runs until the cloth is asleep, and gives how long that took, s.
fn run_to_sleep(app: &mut App, cloth: Entity) -> f32 {
    for tick in 0..ticks(LONG) {
        if is_asleep(app, cloth) {
            return tick as f32 * TICK.as_secs_f32();
        }
        app.update();
    }
    let speed = get::<Particles>(app, cloth).velocity.clone();
    let fastest = (0..speed.len()).map(|slot| speed.get(slot).length()).fold(0.0, f32::max);
    panic!("awake after {LONG} s; its fastest particle goes at {fastest} m/s")
}

#[test]
fn explore() {
    for (name, fabric) in Fabric::PRESETS {
        for (what, pins) in [("top", Pins::top()), ("rods", Pins::rods(3)), ("corners", Pins::corners())] {
            let mut app = headless();
            let cloth = (Cloth::rectangle(0.6, 0.6).with_cells(12, 12), pins, *fabric, Air::default(), ClothStats::default());
            let cloth = app.world_mut().spawn(cloth).id();
            let mut t = 0;
            while !is_asleep(&app, cloth) && t < ticks(LONG) {
                app.update();
                t += 1;
            }
            println!("{name} {what}: {} s {}", t as f32 * TICK.as_secs_f32(), get::<ClothStats>(&app, cloth).rms_speed);
        }
    }
}
