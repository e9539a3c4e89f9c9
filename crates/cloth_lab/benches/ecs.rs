//! What the ECS adds to the solver: `cargo bench -p cloth_lab --bench ecs`.
//!
//! One cloth of 1024 particles, 10 substeps, hung by its top edge. `solver` is [`Cloth::step`] alone; `ecs` the plugin's
//! whole schedule for one tick: changes noticed, frames, pins, forces, substeps, faults. `no plugin` is what Bevy takes
//! to run that schedule with nothing in it, and not the plugin's doing.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_cloth::{Cloth as ClothComponent, ClothPlugin, Pins as ClothPins};
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Tick, Topology};
use criterion::{Criterion, criterion_group, criterion_main};

const SIDE: u32 = 32;

fn solver(criterion: &mut Criterion) {
    let cells = Resolution::Cells(UVec2::splat(SIDE - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..SIDE).map(pin).collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    let tick = Tick { dt: Time::<Fixed>::default().timestep().as_secs_f32(), substeps: 10, iterations: 1 };
    criterion.bench_function("1024 particles/solver", |bencher| {
        bencher.iter(|| cloth.step(tick, Vec3::new(0.0, -9.81, 0.0)));
    });
}

fn ecs(criterion: &mut Criterion, name: &str, prepare: impl FnOnce(&mut App)) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin));
    prepare(&mut app);
    app.finish();
    app.cleanup();
    app.update();
    let timestep = app.world().resource::<Time<Fixed>>().timestep();
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            app.world_mut().resource_mut::<Time>().advance_by(timestep);
            app.world_mut().run_schedule(FixedPostUpdate);
        });
    });
}

fn one_cloth(criterion: &mut Criterion) {
    ecs(criterion, "1024 particles/ecs", |app| {
        app.add_plugins(ClothPlugin::default());
        app.world_mut().spawn((ClothComponent::rectangle(1.0, 1.0).with_cells(SIDE - 1, SIDE - 1), ClothPins::top()));
    });
}

fn no_cloth(criterion: &mut Criterion) {
    ecs(criterion, "no cloth/ecs", |app| {
        app.add_plugins(ClothPlugin::default());
    });
    ecs(criterion, "no plugin/ecs", |_| ());
}

criterion_group!(benches, solver, one_cloth, no_cloth);
criterion_main!(benches);
