//! Rollback: half a second is played again with other input, and once more with the same; then it is written and read.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_cloth::{Air, Cloth, ClothPlugin, Direction, Fabric, Particles, Pins, SavedCloths, Shared, TearCloth, Wind};

/// A tick of the app.
const TICK: Duration = Duration::from_micros(15_625);

/// So many ticks are played again.
const AGAIN: u32 = 32;

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, ClothPlugin::default()))
        .insert_resource(TimeUpdateStrategy::ManualDuration(TICK));
    let flag = (Cloth::rectangle(1.5, 1.0), Fabric::FLAG_POLYESTER, Pins::corners(), Air::default());
    let flag = app.world_mut().spawn(flag).id();
    (0..64).for_each(|_| app.update());
    // Tears are part of what is saved.
    app.world_mut().trigger(TearCloth { entity: flag, position: Vec3::ZERO, pull: Direction::Weft });

    let saved = SavedCloths::take(app.world());
    let mut play = |name: &str, saved: &SavedCloths, wind: Vec3| {
        // The wind is input: the game sets it for each tick, also for one that is played again.
        app.insert_resource(Shared(Wind(wind)));
        saved.restore(app.world_mut()).expect("it is the same flag");
        (0..AGAIN).for_each(|_| app.update());
        let particles = app.world().get::<Particles>(flag).expect("it runs");
        let middle =
            (0..particles.slots()).map(|slot| particles.position.get(slot) * particles.mass[slot]).sum::<Vec3>()
                / particles.mass.iter().sum::<f32>();
        println!("{name:>18}: its middle is at {middle}");
        middle
    };
    let calm = play("in calm air", &saved, Vec3::ZERO);
    let windy = play("in wind", &saved, Vec3::new(0.0, 0.0, 5.0));
    let again = play("in calm air again", &saved, Vec3::ZERO);
    assert!(again == calm && again != windy);

    // For a saved game. In another world the entities would have to be mapped, by `MapEntities`.
    let bytes = saved.to_bytes();
    let read = SavedCloths::from_bytes(&bytes).expect("the bytes are whole");
    println!("saved in {} kB", bytes.len() / 1000);
    assert_eq!(play("read from bytes", &read, Vec3::ZERO), calm);
}
