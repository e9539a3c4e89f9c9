//! What fire costs in a tick of 1/60 s: `cargo bench -p cloth_solver --bench fire`.
//!
//! A square metre of hanging cotton of 64 × 64 particles. `cold`: nothing burns; `alight`: everything does; `climbing`:
//! the fire has climbed half of the sheet from its lower edge; `folded`: the same in a sheet folded to four layers 2 cm
//! apart. `quiet step` is the tick of the cloth itself at the default budget, to compare with.

use std::hint::black_box;
use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::damage::fire::{Contagion, Flammability, Surroundings};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Fire, Flammable, Motion, Tick, Topology};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::{UVec2, Vec2, Vec3};

const SIDE: u32 = 64;
const TICK: Tick = Tick::new(1.0 / 60.0);

fn hung() -> Cloth {
    let cells = Resolution::Cells(UVec2::splat(SIDE - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..SIDE).map(pin).collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    cloth
}

/// Folds the sheet along two columns' lines into layers 2 cm apart.
fn fold(cloth: &mut Cloth) {
    for slot in 0..cloth.topology.slots() {
        let x = cloth.topology.rest[slot];
        let layer = ((x.x + 0.5) * 4.0).floor().min(3.0);
        cloth.particles.position.set(slot, Vec3::new((x.x + 0.5) % 0.25, x.y, 0.02 * layer));
    }
}

fn tick(fire: &mut Fire, cloth: &Cloth) {
    let surroundings = black_box(Surroundings::default());
    fire.burn(&cloth.topology, &cloth.particles, &surroundings, TICK.dt).expect("the cloth's own fire");
}

/// The fire of `cloth`, lit where `lit` says, after `seconds`.
fn burning(cloth: &Cloth, flammable: Flammable, lit: impl Fn(Vec3) -> bool, seconds: f32) -> Fire {
    let mut fire = Fire::new(&cloth.topology, &Fabric::COTTON_POPLIN, &flammable).expect("a preset");
    for slot in cloth.topology.particles().filter(|slot| lit(cloth.topology.rest[*slot as usize])) {
        fire.ignite_particle(slot).expect("a particle of the cloth");
    }
    for _ in 0..(seconds / TICK.dt) as u32 {
        tick(&mut fire, cloth);
    }
    fire
}

/// Times a tick as the mean over one round of turns, at the start of which `fire` is each time.
fn round(criterion: &mut Criterion, name: &str, cloth: &Cloth, fire: &Fire) {
    let mut group = criterion.benchmark_group("fire");
    group.throughput(criterion::Throughput::Elements(8));
    group.bench_function(name, |bencher| {
        bencher.iter_batched_ref(|| fire.clone(), |fire| (0..8).for_each(|_| tick(fire, cloth)), BatchSize::SmallInput);
    });
}

fn fire(criterion: &mut Criterion) {
    let mut cloth = hung();
    criterion.bench_function("quiet step", |bencher| {
        bencher.iter(|| cloth.step(black_box(TICK), Vec3::NEG_Y * 9.81));
    });
    let mut folded = hung();
    fold(&mut folded);
    let cloth = hung();
    let cotton = Flammable::default();
    // Burns as long as the benchmark lasts.
    let slow = Flammable::Heat(Flammability { mass_loss_rate: 1e-4, ..Flammability::COTTON });
    let lower_edge = |x: Vec3| x.y < -0.499;
    round(criterion, "heat, cold", &cloth, &burning(&cloth, cotton, |_| false, 0.0));
    round(criterion, "heat, alight", &cloth, &burning(&cloth, slow, |_| true, 1.0));
    round(criterion, "heat, climbing", &cloth, &burning(&cloth, cotton, lower_edge, 5.2));
    round(criterion, "heat, climbing, folded", &folded, &burning(&folded, cotton, lower_edge, 5.2));
    let chance = Flammable::Contagion(Contagion { rate: 0.001, ..Contagion::default() });
    round(criterion, "contagion, cold", &cloth, &burning(&cloth, chance, |_| false, 0.0));
    round(criterion, "contagion, alight", &cloth, &burning(&cloth, chance, |_| true, 1.0));
}

criterion_group!(benches, fire);
criterion_main!(benches);
