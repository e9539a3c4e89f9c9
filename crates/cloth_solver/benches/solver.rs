//! What a constraint and a tick cost: `cargo bench -p cloth_solver`.
//!
//! `constraint` reports the time of a tick over the constraints it solves (elements are constraint solves: 1/throughput
//! is the time of one); `tick` the time of 1/60 s at the default budget. One core, cotton, 1 × 1 m, swinging from its top
//! edge, all constraints: stretch, shear, bending, twist.

use std::hint::black_box;
use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, Topology};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Quat, UVec2, Vec2, Vec3};

const TICK: Tick = Tick::new(1.0 / 60.0);
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A square metre of cotton with `side` particles to a side, hung by its top row, or by its top corners, and swinging.
fn hung(side: u32, corners: bool) -> Cloth {
    let cells = Resolution::Cells(UVec2::splat(side - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let held = |particle: &u32| !corners || *particle == 0 || *particle == side - 1;
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..side).filter(held).map(pin).collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    for slot in 0..cloth.topology.slots() {
        let x = cloth.topology.rest[slot];
        cloth.particles.velocity.set(slot, Vec3::Z * (0.5 - x.y));
    }
    for _ in 0..30 {
        cloth.step(TICK, GRAVITY);
    }
    cloth
}

fn constraint(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("constraint");
    for side in [32, 64, 128, 256] {
        for (name, corners) in [("top-hung", false), ("corner-hung", true)] {
            let mut cloth = hung(side, corners);
            group.throughput(Throughput::Elements(cloth.constraints.count() as u64 * u64::from(TICK.substeps)));
            group.bench_function(BenchmarkId::new(name, side), |bencher| {
                bencher.iter(|| cloth.step(black_box(TICK), GRAVITY));
            });
        }
    }
}

fn contact(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact");
    let shapes = [
        ("none", None),
        ("sphere", Shape::sphere(0.3).ok()),
        ("capsule", Shape::capsule(0.2, 0.4).ok()),
        ("pyramid", Shape::pyramid(Vec2::splat(0.6), 0.5).ok()),
    ];
    for (name, shape) in shapes {
        let mut cloth = hung(64, false);
        let at = Motion::at_rest(Pose::new(Vec3::new(0.0, 0.0, -0.2), Quat::IDENTITY));
        cloth.contacts.set_colliders(shape.map(|shape| Collider { shape, motion: at, friction: 0.3 }));
        for _ in 0..60 {
            cloth.step(TICK, GRAVITY);
        }
        group.bench_function(name, |bencher| bencher.iter(|| cloth.step(black_box(TICK), GRAVITY)));
    }
}

criterion_group!(benches, constraint, contact);
criterion_main!(benches);
