//! Cloth without window or renderer, as on a server: a flag falls from its pins to rest, in numbers.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::{Cloth, ClothClock, ClothPlugin, ClothStats, Fabric, Pins};

/// Simulated time, s.
const DURATION: f32 = 5.0;

fn main() -> AppExit {
    App::new()
        .add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()))
        // As fast as it can: each frame is worth one sixtieth of a second, however long it takes.
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 60.0)))
        .add_systems(Startup, setup)
        .add_systems(Update, report)
        .run()
}

fn setup(mut commands: Commands) {
    println!("   time   strain    speed   energy");
    commands.spawn((Cloth::rectangle(1.5, 1.0), Fabric::FLAG_POLYESTER, Pins::corners(), ClothStats::default()));
}

fn report(
    flag: Single<&ClothStats>,
    clock: Res<Time<ClothClock>>,
    mut next: Local<f32>,
    mut exit: MessageWriter<AppExit>,
) {
    let time = clock.elapsed_secs();
    if time >= *next {
        let ClothStats { largest_strain, rms_speed, kinetic_energy, .. } = **flag;
        println!("{time:5.2} s {:6.2} % {rms_speed:5.2} m/s {kinetic_energy:6.4} J", 100.0 * largest_strain);
        *next += 0.5;
    }
    if time >= DURATION {
        exit.write(AppExit::Success);
    }
}
