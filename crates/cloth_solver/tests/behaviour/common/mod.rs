//! What the tests of the solver share.

pub mod damage;
pub mod fire;

use std::sync::Arc;

pub use cloth_cases::cases;
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, Fabric, Motion, Pose, Tick, Topology, measure};
use glam::{EulerRot, Quat, UVec2, Vec2, Vec3};

pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// The tick of the default budget.
pub const TICK: Tick = Tick::new(1.0 / 60.0);

/// Cotton without internal friction.
pub const UNDAMPED: Fabric = Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN };

pub fn rectangle(width: f32, height: f32, columns: u32, rows: u32, fabric: &Fabric) -> Cloth {
    let cells = Resolution::Cells(UVec2::new(columns, rows));
    let topology = Topology::rectangle(Vec2::new(width, height), cells).unwrap();
    Cloth::new(Arc::new(topology), fabric).unwrap()
}

/// A sheet in the xy plane about the origin of `columns` × `rows` quads whose inner corners lie up to a quarter of a cell off
/// their places, each cut one way or the other: positions and triangles.
pub fn irregular(size: Vec2, [columns, rows]: [u32; 2]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let noise = |i: u32| f32::from((i.wrapping_mul(2_654_435_761) >> 16) as u16) / 65_536.0 - 0.5;
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let cells = Vec2::new(columns as f32, rows as f32);
    let place = |i: u32, j: u32| {
        let inner = (1..columns).contains(&i) && (1..rows).contains(&j);
        let off = if inner { 0.5 * Vec2::new(noise(2 * at(i, j)), noise(2 * at(i, j) + 1)) } else { Vec2::ZERO };
        (((Vec2::new(i as f32, j as f32) + off) / cells - 0.5) * size).extend(0.0)
    };
    let positions = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
    let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if noise(7 * a + 3) > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    });
    (positions, triangles.collect())
}

/// A sheet of `fabric` over [`irregular`].
pub fn irregular_mesh(size: Vec2, cells: [u32; 2], fabric: &Fabric) -> Cloth {
    let (positions, triangles) = irregular(size, cells);
    let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
    Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), fabric).unwrap()
}

/// Pins the particles whose rest position is `held` to where that is.
pub fn hold(cloth: &mut Cloth, held: impl Fn(Vec3) -> bool) {
    let rest = |p: u32| cloth.topology.rest[p as usize];
    let pins = cloth.topology.particles().filter(|p| held(rest(*p)));
    let pins = pins.map(|particle| Pin { particle, frame: 0, local: rest(particle) }).collect();
    let pins = Pins { frames: vec![Motion::default()], pins };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
}

/// The speed of the fastest particle, m/s; not a number if any is.
pub fn fastest(cloth: &Cloth) -> f32 {
    let speeds = cloth.topology.particles().map(|p| cloth.particles.velocity.get(p as usize).length());
    speeds.fold(0.0, |most, speed| if speed > most || speed.is_nan() { speed } else { most })
}

/// Pins the particles of the top row in the given columns where they are.
pub fn pin_top(cloth: &mut Cloth, columns: impl IntoIterator<Item = u32>) {
    let pins = columns.into_iter().map(|particle| Pin {
        particle,
        frame: 0,
        local: cloth.particles.position.get(particle as usize),
    });
    let pins = Pins { frames: vec![Motion::default()], pins: pins.collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
}

/// Moves and turns the whole cloth, at rest.
pub fn place(cloth: &mut Cloth, rotation: Quat, position: Vec3) {
    for slot in 0..cloth.topology.slots() {
        let x = position + rotation * cloth.topology.rest[slot];
        cloth.particles.position.set(slot, x);
        cloth.particles.previous.set(slot, x);
    }
}

pub fn run(cloth: &mut Cloth, seconds: f32) {
    for _ in 0..(seconds / TICK.dt).round() as u32 {
        cloth.step(TICK, GRAVITY);
    }
}

/// Brings cloth to the rest it would swing about for long: stops it whenever its kinetic energy has passed a peak
/// (kinetic damping, Cundall 1976).
pub fn settle(cloth: &mut Cloth, seconds: f32) {
    let mut last = 0.0;
    for _ in 0..(seconds / TICK.dt).round() as u32 {
        cloth.step(TICK, GRAVITY);
        let energy = cloth_solver::measure::kinetic_energy(&cloth.particles);
        if energy < last {
            cloth.particles.velocity.fill(Vec3::ZERO);
            last = 0.0;
        } else {
            last = energy;
        }
    }
}

pub fn collider(shape: Shape, position: Vec3, rotation: Quat, friction: f32) -> Collider {
    Collider { shape, motion: Motion::at_rest(Pose::new(position, rotation)), friction }
}

pub fn positions(cloth: &Cloth) -> Vec<Vec3> {
    cloth.topology.particles().map(|p| cloth.particles.position.get(p as usize)).collect()
}

/// A sheet of 0.8 m that lies `above` the middle of a solid, which stands above ground at −0.3 m.
pub fn laid(shape: Shape, rotation: Quat, above: f32) -> Cloth {
    let mut cloth = rectangle(0.8, 0.8, cases(24, 32), cases(24, 32), &Fabric::COTTON_POPLIN);
    place(&mut cloth, Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2), Vec3::new(0.01, above, 0.02));
    let ground = collider(Shape::HalfSpace, Vec3::Y * -0.3, Quat::IDENTITY, Fabric::COTTON_POPLIN.friction);
    cloth.contacts.set_colliders([collider(shape, Vec3::ZERO, rotation, Fabric::COTTON_POPLIN.friction), ground]);
    cloth
}

/// How far the deepest point of a triangle, its corners included, is inside a collider, m.
pub fn deepest_triangle(cloth: &Cloth) -> f32 {
    let depth =
        |collider: &Collider, x: Vec3| -collider.shape.distance_and_normal(collider.motion.to.inverse_point(x)).0;
    let steps = 8;
    let shares = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| [i, j].map(|k| k as f32 / steps as f32)));
    let shares: Vec<[f32; 2]> = shares.collect();
    let mut deepest = f32::NEG_INFINITY;
    for triangle in &cloth.topology.triangles {
        let [a, b, c] = triangle.map(|slot| cloth.particles.position.get(slot as usize));
        for [u, v] in &shares {
            let x = a * (1.0 - u - v) + b * *u + c * *v;
            for collider in &cloth.contacts.colliders {
                deepest = deepest.max(depth(collider, x));
            }
        }
    }
    deepest
}

/// Throws a sheet that begins 1.2 m above the ground and is turned by Euler angles, rad. By how much its kinetic energy and its height
/// together ever exceed what they began with, as a share of that.
pub fn gain_of_thrown(mut cloth: Cloth, [x, y, z]: [f32; 3], velocity: [f32; 3]) -> f64 {
    place(&mut cloth, Quat::from_euler(EulerRot::XYZ, x, y, z), Vec3::Y * 1.2);
    for slot in 0..cloth.topology.slots() {
        cloth.particles.velocity.set(slot, Vec3::from_array(velocity));
    }
    cloth.contacts.set_colliders([collider(Shape::HalfSpace, Vec3::ZERO, Quat::IDENTITY, 0.4)]);
    let energy = |cloth: &Cloth| {
        let height =
            |(slot, mass): (usize, &f32)| f64::from(*mass) * 9.81 * f64::from(cloth.particles.position.get(slot).y);
        measure::kinetic_energy(&cloth.particles) + cloth.particles.mass.iter().enumerate().map(height).sum::<f64>()
    };
    let began = energy(&cloth);
    (0..60).fold(f64::MIN, |most, _| {
        cloth.step(TICK, GRAVITY);
        most.max(energy(&cloth) / began - 1.0)
    })
}
