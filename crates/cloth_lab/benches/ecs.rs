//! What the ECS adds to the solver: `cargo bench -p cloth_lab --bench ecs`.
//!
//! One cloth of 1024 particles, 10 substeps, hung by its top edge. `solver` is [`Cloth::step`] alone. `by hand` is one turn
//! of Bevy's schedule without the plugin, then the same step: what anybody pays who has a cloth in a Bevy app. `plugin` is the
//! same turn with the plugin in it: changes noticed, frames, pins, forces, substeps, faults. The plugin's own cost is what
//! `plugin` takes beyond `by hand`; not beyond `solver`, because Bevy wakes sleeping threads in every schedule with several
//! threads, and they fall asleep while a cloth is stepped. `no cloth` and `no plugin` are the empty turns, threads awake.
//! `1000 asleep` is `no cloth` with 1000 cloths that sleep: what it takes beyond is what they cost.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth as ClothComponent, ClothAsleep, ClothCollider, ClothPlugin, Gravity, Pins as ClothPins};
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Tick, Topology};
use criterion::{Criterion, criterion_group, criterion_main};

const SIDE: u32 = 32;
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

fn hung() -> Cloth {
    let cells = Resolution::Cells(UVec2::splat(SIDE - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..SIDE).map(pin).collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    cloth
}

fn tick() -> Tick {
    Tick::new(Time::<Fixed>::default().timestep().as_secs_f32())
}

fn app(prepare: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    prepare(&mut app);
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn turn(app: &mut App) {
    let timestep = app.world().resource::<Time<Fixed>>().timestep();
    app.world_mut().resource_mut::<Time>().advance_by(timestep);
    app.world_mut().run_schedule(FixedPostUpdate);
}

fn with_cloth(criterion: &mut Criterion) {
    let mut cloth = hung();
    criterion.bench_function("1024 particles/solver", |bencher| bencher.iter(|| cloth.step(tick(), GRAVITY)));
    let (mut bare, mut cloth) = (app(|_| ()), hung());
    criterion.bench_function("1024 particles/by hand", |bencher| {
        bencher.iter(|| {
            turn(&mut bare);
            cloth.step(tick(), GRAVITY);
        });
    });
    let mut hung = app(|app| {
        app.add_plugins(ClothPlugin::default());
        app.world_mut().spawn((ClothComponent::rectangle(1.0, 1.0).with_cells(SIDE - 1, SIDE - 1), ClothPins::top()));
    });
    criterion.bench_function("1024 particles/plugin", |bencher| bencher.iter(|| turn(&mut hung)));
}

fn empty(criterion: &mut Criterion) {
    let mut idle = app(|app| {
        app.add_plugins(ClothPlugin::default());
    });
    criterion.bench_function("no cloth", |bencher| bencher.iter(|| turn(&mut idle)));
    let mut bare = app(|_| ());
    criterion.bench_function("no plugin", |bencher| bencher.iter(|| turn(&mut bare)));
}

/// Cloths that fall asleep at once, and then sleep.
fn asleep(criterion: &mut Criterion) {
    const COUNT: usize = 1000;
    let mut bed = app(|app| {
        app.add_plugins(ClothPlugin::default());
        for _ in 0..COUNT {
            let cloth = ClothComponent::rectangle(1.0, 1.0).with_cells(7, 7);
            app.world_mut().spawn((cloth, ClothPins::top(), Air::default(), Gravity(Vec3::ZERO)));
        }
        app.world_mut().spawn((ClothCollider::Ground, Transform::from_xyz(0.0, -5.0, 0.0)));
    });
    (0..64).for_each(|_| turn(&mut bed));
    let world = bed.world_mut();
    assert_eq!(world.query_filtered::<(), With<ClothAsleep>>().iter(world).count(), COUNT);
    criterion.bench_function("1000 asleep", |bencher| bencher.iter(|| turn(&mut bed)));
}

criterion_group!(benches, with_cloth, empty, asleep);
criterion_main!(benches);
