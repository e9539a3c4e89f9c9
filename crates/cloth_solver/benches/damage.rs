//! What damage costs: `cargo bench -p cloth_solver --bench damage`. A square metre of cotton of 64 × 64 particles, hung by its
//! top row, 10 substeps.
//!
//! `quiet` is a tick of a whole cloth, `watched` the same with its loads watched for tearing, `torn` a tick in which a
//! particle parts, everything that follows from that included, `cut` a tick in which a slit of half its height is cut,
//! `after` a tick of the cloth with ten slits.

use std::hint::black_box;
use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::damage::{Blade, Direction, Tear, Tearing};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Tick, Topology};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::{UVec2, Vec2, Vec3};

const SIDE: u32 = 64;
const TICK: Tick = Tick::new(1.0 / 60.0);
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

fn hung() -> Cloth {
    let cells = Resolution::Cells(UVec2::splat(SIDE - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..SIDE).map(pin).collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    for _ in 0..30 {
        cloth.step(TICK, GRAVITY);
    }
    cloth
}

/// From the middle down to the lower edge.
fn slit(x: f32) -> Blade {
    let ray = |y: f32| [Vec3::new(x, y, 10.0), Vec3::new(x, y, -10.0)];
    Blade { from: ray(-1.0), to: ray(0.0) }
}

fn damage(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("damage");
    let mut cloth = hung();
    group.bench_function("quiet", |bencher| bencher.iter(|| cloth.step(black_box(TICK), GRAVITY)));
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    let tearing = Tearing::at(1e9);
    group.bench_function("watched", |bencher| {
        bencher.iter(|| {
            cloth.step(black_box(TICK), GRAVITY);
            tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, TICK.dt);
            cloth.tear(&mut tear, &tearing)
        });
    });
    let middle = cloth.topology.grid.map_or(0, |grid| grid.slot(SIDE / 2, SIDE / 2));
    let torn = |cloth: &mut Cloth| {
        cloth.tear_at(middle, Direction::Weft);
        cloth.step(TICK, GRAVITY);
    };
    group.bench_function("torn", |bencher| bencher.iter_batched_ref(|| cloth.clone(), torn, BatchSize::LargeInput));
    let cut = |cloth: &mut Cloth| {
        cloth.cut(&slit(0.1));
        cloth.step(TICK, GRAVITY);
    };
    group.bench_function("cut", |bencher| bencher.iter_batched_ref(|| cloth.clone(), cut, BatchSize::LargeInput));
    for i in 0..10 {
        cloth.cut(&slit(-0.46 + 0.1 * i as f32));
    }
    group.bench_function("after", |bencher| bencher.iter(|| cloth.step(black_box(TICK), GRAVITY)));
}

criterion_group!(benches, damage);
criterion_main!(benches);
