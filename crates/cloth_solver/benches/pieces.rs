//! What a torn-off scrap that lies still costs the rest of its cloth: `cargo bench -p cloth_solver --bench pieces`. A curtain of 64 × 64
//! particles of poplin swings in air; a part of it is cut off and lies on the ground.
//!
//! `whole` is a tick of the curtain before it is cut, `torn` one with the scrap on the ground, `frozen` the same where the scrap's
//! particles have no inverse mass, `left_out` the same where its triangles, and so its constraints, are taken out, and `alone` a cloth
//! that never had them. `leaving_out` is what it takes to take them out.

use std::hint::black_box;
use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::Blade;
use cloth_solver::forces::{Air, WindField};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, Topology};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::{Quat, UVec2, Vec2, Vec3};

const SIDE: u32 = 64;
const TICK: Tick = Tick::new(1.0 / 60.0);
const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A curtain a metre wide with so many rows of cells, whose upper edge is half a metre high.
fn curtain(rows: u32) -> Cloth {
    let height = rows as f32 / (SIDE - 1) as f32;
    let cells = Resolution::Cells(UVec2::new(SIDE - 1, rows));
    let topology = Arc::new(Topology::rectangle(Vec2::new(1.0, height), cells).expect("a rectangle"));
    let mut cloth = Cloth::new(topology, &Fabric::COTTON_POPLIN).expect("a preset");
    for slot in 0..cloth.topology.slots() {
        let place = cloth.topology.rest[slot] + Vec3::Y * (0.5 - 0.5 * height);
        cloth.particles.position.set(slot, place);
        cloth.particles.previous.set(slot, place);
    }
    let local = |particle: u32| cloth.particles.position.get(particle as usize);
    let pins = (0..SIDE).map(|particle| Pin { particle, frame: 0, local: local(particle) }).collect();
    let pins = Pins { frames: vec![Motion::default()], pins };
    cloth.constraints.set_pins(&mut cloth.particles, pins).expect("particles of the cloth");
    cloth.air = Some(Air::default());
    cloth.wind = WindField::uniform(Vec3::Z * 2.0);
    let motion = Motion::at_rest(Pose::new(Vec3::NEG_Y * 0.6, Quat::IDENTITY));
    cloth.contacts.set_colliders([Collider { shape: Shape::HalfSpace, motion, friction: 0.4 }]);
    cloth
}

fn run(cloth: &mut Cloth, ticks: u32) {
    (0..ticks).for_each(|_| cloth.step(TICK, GRAVITY));
}

/// Cuts off what is below the row, and lets that come to lie.
fn torn(row: u32) -> Cloth {
    let mut cloth = curtain(SIDE - 1);
    run(&mut cloth, 2);
    let y = 0.5 - (row as f32 + 0.01) / (SIDE - 1) as f32;
    let ray = |x: f32| [Vec3::new(x, y, 3.0), Vec3::new(x, y, -3.0)];
    cloth.cut(&Blade { from: ray(-1.0), to: ray(1.0) });
    run(&mut cloth, 300);
    cloth
}

/// The triangles of the pieces that nothing holds.
fn scrap(cloth: &Cloth) -> Vec<u32> {
    let pieces = cloth.topology.pieces();
    let held = pieces.of_slot[cloth.constraints.pins().pins[0].particle as usize];
    let is_loose = |corners: &[u32; 3]| pieces.of_slot[corners[0] as usize] != held;
    let triangles = cloth.topology.triangles.iter().enumerate();
    triangles.filter(|(_, corners)| is_loose(corners)).map(|(triangle, _)| triangle as u32).collect()
}

fn pieces(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pieces");
    let step = |cloth: &mut Cloth| cloth.step(black_box(TICK), GRAVITY);
    let mut whole = curtain(SIDE - 1);
    run(&mut whole, 300);
    group.bench_function("whole", |bencher| bencher.iter(|| step(&mut whole)));
    for (name, row) in [("half", 32), ("tenth", 57)] {
        let mut cloth = torn(row);
        let gone = scrap(&cloth);
        let left_out = |cloth: &mut Cloth| cloth.remove_triangles(&gone);
        let clone = || cloth.clone();
        group.bench_function(format!("{name}/leaving_out"), |bencher| {
            bencher.iter_batched_ref(clone, left_out, BatchSize::LargeInput);
        });
        let mut without = cloth.clone();
        left_out(&mut without);
        let mut frozen = cloth.clone();
        for slot in gone.iter().flat_map(|triangle| cloth.topology.triangles[*triangle as usize]) {
            frozen.particles.inverse_mass[slot as usize] = 0.0;
            frozen.particles.velocity.set(slot as usize, Vec3::ZERO);
        }
        let mut alone = curtain(row);
        run(&mut alone, 300);
        group.bench_function(format!("{name}/torn"), |bencher| bencher.iter(|| step(&mut cloth)));
        group.bench_function(format!("{name}/frozen"), |bencher| bencher.iter(|| step(&mut frozen)));
        group.bench_function(format!("{name}/left_out"), |bencher| bencher.iter(|| step(&mut without)));
        group.bench_function(format!("{name}/alone"), |bencher| bencher.iter(|| step(&mut alone)));
    }
}

criterion_group!(benches, pieces);
criterion_main!(benches);
