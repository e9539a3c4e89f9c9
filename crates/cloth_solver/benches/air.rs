//! What the air costs: `cargo bench -p cloth_solver --bench air`.
//!
//! One tick of 1/60 s in 10 substeps of 64 × 64 particles that swing from their top edge: in no air, in a uniform wind, in
//! gusts, in a zone, before a fan, and before a fan with a collider in its jet. The difference to `none` is the cost.

use std::hint::black_box;
use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::forces::{Air, Fan, Gusts, GustyWind, WindField, WindZone};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, Topology};
use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, UVec2, Vec2, Vec3};

const TICK: Tick = Tick::new(1.0 / 60.0);
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);
const SIDE: u32 = 64;
/// So slow that all of them swing alike.
const WIND: Vec3 = Vec3::new(0.1, 0.0, 0.3);

fn hung() -> Cloth {
    let cells = Resolution::Cells(UVec2::splat(SIDE - 1));
    let topology = Arc::new(Topology::rectangle(Vec2::ONE, cells).expect("a square metre"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    let pin = |particle: u32| Pin { particle, frame: 0, local: cloth.topology.rest[particle as usize] };
    let pins = Pins { frames: vec![Motion::default()], pins: (0..SIDE).map(pin).collect() };
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

/// A fan that the whole cloth is in the jet of.
fn fan() -> (Fan, Pose) {
    (Fan { speed: 0.5, diameter: 1.0, spread: 1.0, ..Fan::default() }, Pose::new(Vec3::Z * 2.0, Quat::IDENTITY))
}

fn air(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("air");
    let uniform = WindField::uniform(WIND);
    let mut wind = GustyWind::default();
    wind.advance(WIND, &Gusts { intensity: 0.2, ..Gusts::default() }, TICK.dt);
    let mut gusty = uniform.clone();
    gusty.set_wind(&wind, &Pose::IDENTITY);
    let mut zone = uniform.clone();
    zone.set_zones([(WindZone { velocity: WIND, ..WindZone::default() }, Pose::IDENTITY)]);
    let mut blown = uniform.clone();
    blown.set_fans([fan()], &[]);
    let ball = Collider {
        shape: Shape::sphere(0.2).expect("a size"),
        motion: Motion::at_rest(Pose::new(Vec3::Z, Quat::IDENTITY)),
        friction: 0.3,
    };
    let mut shadowed = uniform.clone();
    shadowed.set_fans([fan()], &[ball]);
    let mut all = shadowed.clone();
    all.set_wind(&wind, &Pose::IDENTITY);
    let winds = [
        ("none", None),
        ("uniform", Some(uniform)),
        ("gusts", Some(gusty)),
        ("zone", Some(zone)),
        ("fan", Some(blown)),
        ("fan and shadow", Some(shadowed)),
        ("gusts, fan and shadow", Some(all)),
    ];
    for (name, wind) in winds {
        let mut cloth = hung();
        cloth.air = wind.as_ref().map(|_| Air::default());
        cloth.wind = wind.unwrap_or_default();
        group.bench_function(name, |bencher| bencher.iter(|| cloth.step(black_box(TICK), GRAVITY)));
    }
}

criterion_group!(benches, air);
criterion_main!(benches);
