//! Cloths of the trials, and what is measured of them.

use cloth_solver::contact::{Collider, SelfContact, Shape};
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, Fabric, Method, Motion, Pose, Tick, measure};
use glam::{Quat, Vec2, Vec3};

use crate::stability::random::Random;
use crate::validate::rig;

/// The default tick.
pub const TICK: Tick = Tick::new(1.0 / 60.0);

/// What kinds of cloth are tried.
pub const KINDS: [&str; 2] = ["grid", "mesh"];

/// A sheet in the xy plane about the origin; of kind 1 an irregular mesh.
///
/// # Panics
/// On a size or fabric out of range: a trial asks for none.
pub fn sheet(kind: usize, size: [f32; 2], cells: [u32; 2], fabric: &Fabric) -> Cloth {
    let cloth = if kind == 1 {
        let (positions, triangles) = rig::irregular(Vec2::from(size), cells, 7);
        rig::mesh(&positions, &triangles, fabric, Method::default())
    } else {
        rig::rectangle(size, cells, fabric, Method::default())
    };
    cloth.unwrap_or_else(|error| panic!("{error}"))
}

/// The same in still air.
pub fn in_air(mut cloth: Cloth) -> Cloth {
    cloth.air = Some(Air::default());
    cloth
}

/// Pins the particles whose rest position is `held`.
pub fn hold(cloth: &mut Cloth, held: impl Fn(Vec3) -> bool) {
    rig::hold(cloth, held).unwrap_or_else(|error| panic!("{error}"));
}

/// The upper edge of a sheet of that height.
pub fn top(height: f32) -> impl Fn(Vec3) -> bool {
    move |rest| rest.y > 0.4999 * height
}

/// The upper corners of a sheet of that size.
pub fn corners([width, height]: [f32; 2]) -> impl Fn(Vec3) -> bool {
    move |rest| rest.y > 0.4999 * height && rest.x.abs() > 0.4999 * width
}

/// Keeps the cloth off itself.
pub fn keep_off_itself(cloth: &mut Cloth, fabric: &Fabric) {
    cloth.set_self_contact(fabric, &SelfContact::default()).unwrap_or_else(|error| panic!("{error}"));
}

/// A solid at rest.
pub fn solid(shape: Result<Shape, cloth_solver::ClothError>, at: Vec3, rotation: Quat) -> Collider {
    let shape = shape.unwrap_or_else(|error| panic!("{error}"));
    Collider { shape, motion: Motion::at_rest(Pose::new(at, rotation)), friction: 0.4 }
}

/// Solid ground at that height.
pub fn ground(height: f32) -> Collider {
    solid(Ok(Shape::HalfSpace), Vec3::Y * height, Quat::IDENTITY)
}

/// Advances by `seconds`.
pub fn run(cloth: &mut Cloth, seconds: f32) {
    rig::run(cloth, TICK, rig::GRAVITY, seconds);
}

/// Root mean square speed, m/s.
pub fn rms(cloth: &Cloth) -> f32 {
    measure::rms_speed(&cloth.topology, &cloth.particles)
}

/// The largest strain.
pub fn strain(cloth: &Cloth) -> f32 {
    measure::largest_strain(&cloth.topology, &cloth.particles)
}

/// The largest speed, m/s; not a number if any is.
pub fn fastest(cloth: &Cloth) -> f32 {
    let speeds = cloth.topology.particles().map(|slot| cloth.particles.velocity.get(slot as usize).length());
    speeds.fold(0.0, |most, speed| if speed > most || speed.is_nan() { speed } else { most })
}

/// All positions.
pub fn positions(cloth: &Cloth) -> Vec<Vec3> {
    cloth.topology.particles().map(|slot| cloth.particles.position.get(slot as usize)).collect()
}

/// How far any particle is from where it was, m.
pub fn farthest(before: &[Vec3], now: &[Vec3]) -> f32 {
    before.iter().zip(now).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// How deep any particle is inside of the cloth's solids, m; 0 outside.
pub fn deepest(cloth: &Cloth) -> f32 {
    let depth = |solid: &Collider| {
        let to = solid.motion.to;
        let inside = positions(cloth).into_iter().map(|x| -solid.shape.distance_and_normal(to.inverse_point(x)).0);
        inside.fold(0.0, f32::max)
    };
    cloth.contacts.colliders.iter().map(depth).fold(0.0, f32::max)
}

/// Edges that pass through a triangle.
pub fn crossings(cloth: &Cloth) -> usize {
    measure::crossings(&cloth.topology, &cloth.particles).len()
}

/// Kinetic, elastic and gravitational energy, J.
pub fn energy(cloth: &Cloth, fabric: &Fabric, gravity: Vec3) -> f64 {
    measure::total_energy(&cloth.topology, &cloth.particles, fabric, gravity)
}

/// A vector of −1..1.
pub fn noise(random: &mut Random) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| 2.0 * random.part() as f32 - 1.0))
}

/// A direction, none likelier than another.
pub fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = noise(random);
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// All bits of the state, mixed.
pub fn hash(cloth: &Cloth) -> u64 {
    let numbers = [&cloth.particles.position, &cloth.particles.velocity];
    let numbers = numbers.into_iter().flat_map(|all| all.x.iter().chain(&all.y).chain(&all.z));
    numbers.fold(0, |mixed: u64, number| {
        (mixed.rotate_left(5) ^ u64::from(number.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}
