//! What the ECS adds to the solver: `cargo bench -p cloth_lab --bench ecs`.
//!
//! One cloth of 1024 particles, 10 substeps, hung by its top edge. `solver` is [`Cloth::step`] alone. `by hand` is one turn
//! of Bevy's schedule without the plugin, then the same step: what anybody pays who has a cloth in a Bevy app. `plugin` is the
//! same turn with the plugin in it: changes noticed, frames, pins, forces, substeps, faults. The plugin's own cost is what
//! `plugin` takes beyond `by hand`; not beyond `solver`, because Bevy wakes sleeping threads in every schedule with several
//! threads, and they fall asleep while a cloth is stepped. `no cloth` and `no plugin` are the empty turns, threads awake.
//! `1000 asleep` is `no cloth` with 1000 cloths that sleep: what it takes beyond is what they cost.
//!
//! `1000 flags` (12 × 8 cells) and `100 capes` (400 particles) blow in a wind: `solver` steps one after the other, `on all threads` shares
//! them out evenly among as many threads as there are cores, `plugin` is a turn of an app with them. What the plugin takes on one
//! core is told by a run on one: `taskset -c 0 cargo bench ...`.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_cloth::{
    Air, Cloth as ClothComponent, ClothAsleep, ClothCollider, ClothPlugin, ClothSleep, Gravity, Pins as ClothPins,
    Shared, Wind,
};
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::forces::WindField;
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
        app.insert_resource(Shared(ClothSleep { enabled: false, ..ClothSleep::default() }));
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

/// A flag or a cape.
#[derive(Clone, Copy)]
struct Piece {
    size: Vec2,
    cells: UVec2,
    /// Held by its left side; if not, by its top.
    by_side: bool,
}

const WIND: Vec3 = Vec3::new(5.0, 0.0, 1.5);

impl Piece {
    const FLAG: Self = Self { size: Vec2::new(0.9, 0.6), cells: UVec2::new(12, 8), by_side: true };
    const CAPE: Self = Self { size: Vec2::ONE, cells: UVec2::splat(19), by_side: false };

    fn bare(self, topology: &Arc<Topology>) -> Cloth {
        let mut cloth = Cloth::new(topology.clone(), &Fabric::COTTON_POPLIN).expect("a preset");
        let corner = cloth.topology.rest[0];
        let is_held = |at: Vec3| if self.by_side { at.x == corner.x } else { at.y == corner.y };
        let place = |particle: u32| cloth.topology.rest[particle as usize];
        let held = cloth.topology.particles().filter(|particle| is_held(place(*particle)));
        let pins = held.map(|particle| Pin { particle, frame: 0, local: place(particle) }).collect();
        let pins = Pins { frames: vec![Motion::default()], pins };
        cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
        cloth.air = Some(Air::default());
        cloth.wind = WindField::uniform(WIND);
        cloth
    }

    fn all_bare(self, count: usize) -> Vec<Cloth> {
        let topology = Topology::rectangle(self.size, Resolution::Cells(self.cells)).expect("a rectangle");
        let topology = Arc::new(topology);
        let mut cloths: Vec<Cloth> = (0..count).map(|_| self.bare(&topology)).collect();
        (0..WARM).for_each(|_| cloths.iter_mut().for_each(|cloth| cloth.step(tick(), GRAVITY)));
        cloths
    }

    fn all_in_an_app(self, count: usize) -> App {
        let (low, high) = (Vec3::splat(-10.0), Vec3::new(0.01 - 0.5 * self.size.x, 10.0, 10.0));
        let mut app = app(|app| {
            app.add_plugins(ClothPlugin::default()).insert_resource(Shared(Wind(WIND)));
            for _ in 0..count {
                let cloth = ClothComponent::rectangle(self.size.x, self.size.y).with_cells(self.cells.x, self.cells.y);
                let pins = if self.by_side { ClothPins::region(low, high) } else { ClothPins::top() };
                app.world_mut().spawn((cloth, pins, Air::default()));
            }
        });
        (0..WARM).for_each(|_| turn(&mut app));
        app
    }
}

/// Turns in which the cloths begin to blow about.
const WARM: usize = 128;

fn many(criterion: &mut Criterion) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    for (name, count, piece) in [("1000 flags", 1000, Piece::FLAG), ("100 capes", 100, Piece::CAPE)] {
        let mut group = criterion.benchmark_group(name);
        group.sample_size(20);
        let mut cloths = piece.all_bare(count);
        group.bench_function("solver", |bencher| {
            bencher.iter(|| cloths.iter_mut().for_each(|cloth| cloth.step(tick(), GRAVITY)));
        });
        let mut cloths = piece.all_bare(count);
        group.bench_function("on all threads", |bencher| {
            bencher.iter(|| {
                std::thread::scope(|scope| {
                    for cloths in cloths.chunks_mut(count.div_ceil(threads)) {
                        scope.spawn(|| cloths.iter_mut().for_each(|cloth| cloth.step(tick(), GRAVITY)));
                    }
                });
            });
        });
        let mut app = piece.all_in_an_app(count);
        group.bench_function("plugin", |bencher| bencher.iter(|| turn(&mut app)));
        group.finish();
    }
}

criterion_group!(benches, with_cloth, empty, asleep, many);
criterion_main!(benches);
