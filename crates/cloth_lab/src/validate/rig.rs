//! Cloths to be measured, and how a swing is measured.

use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, ClothError, Fabric, Method, Motion, Particles, Tick, Topology, measure};
use glam::{UVec2, Vec2, Vec3};

/// Gravity of every check, m/s².
pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// Its amount, m/s².
pub const G: f64 = 9.81;

/// A rectangle of `size` m and `cells`, in the xy plane.
///
/// # Errors
/// A size, a number of cells or a fabric out of range.
pub fn rectangle(size: [f32; 2], cells: [u32; 2], fabric: &Fabric, method: Method) -> Result<Cloth, ClothError> {
    let topology = Topology::rectangle(Vec2::from(size), Resolution::Cells(UVec2::from(cells)))?;
    let mut cloth = Cloth::new(Arc::new(topology), fabric)?;
    cloth.set_method(method);
    Ok(cloth)
}

/// A mesh of `positions`, m, whose weft runs along x and whose warp along y at rest.
///
/// # Errors
/// What is wrong with the mesh or the fabric.
pub fn mesh(positions: &[Vec3], triangles: &[[u32; 3]], fabric: &Fabric, method: Method) -> Result<Cloth, ClothError> {
    let uvs: Vec<Vec2> = positions.iter().map(|p| p.truncate()).collect();
    let indices: Vec<u32> = triangles.iter().flatten().copied().collect();
    let topology = Topology::from_mesh(MeshSource { positions, uvs: &uvs, indices: &indices })?;
    let mut cloth = Cloth::new(Arc::new(topology), fabric)?;
    cloth.set_method(method);
    Ok(cloth)
}

/// A sheet in the xy plane about the origin of `columns` × `rows` quads whose corners lie up to a quarter of a cell off their
/// places, those of the border along it, each cut one way or the other: positions, m, and triangles.
pub fn irregular(size: Vec2, [columns, rows]: [u32; 2], seed: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let noise = |i: u32| {
        let mixed = (i ^ seed.wrapping_mul(0x85eb_ca6b)).wrapping_mul(2_654_435_761);
        f32::from((mixed >> 16) as u16) / 65_536.0 - 0.5
    };
    let at = |i: u32, j: u32| j * (columns + 1) + i;
    let cells = Vec2::new(columns as f32, rows as f32);
    let off = |inner: bool, i: u32| if inner { 0.5 * noise(i) } else { 0.0 };
    let place = |i: u32, j: u32| {
        let off =
            Vec2::new(off((1..columns).contains(&i), 2 * at(i, j)), off((1..rows).contains(&j), 2 * at(i, j) + 1));
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

/// Moves every particle from its rest position to where `place` says, at rest.
pub fn put(cloth: &mut Cloth, place: impl Fn(Vec3) -> Vec3) {
    for slot in 0..cloth.topology.slots() {
        let to = place(cloth.topology.rest[slot]);
        cloth.particles.position.set(slot, to);
        cloth.particles.previous.set(slot, to);
    }
}

/// The particles in the middle of the last substep, where their velocities are those of: to take positions at its end would
/// count what flows from one form of energy into another within half a substep as a gain.
pub fn midway(cloth: &Cloth) -> Particles {
    let mut middle = cloth.particles.clone();
    for slot in 0..middle.slots() {
        let [from, to] = [&cloth.particles.previous, &cloth.particles.position].map(|x| x.get(slot));
        middle.position.set(slot, from.midpoint(to));
    }
    middle
}

/// Pins the particles whose rest position is `held`, where they are.
///
/// # Errors
/// None on a cloth that [`rectangle`] or [`mesh`] made.
pub fn hold(cloth: &mut Cloth, held: impl Fn(Vec3) -> bool) -> Result<(), ClothError> {
    let pins = (cloth.topology.particles())
        .filter(|slot| held(cloth.topology.rest[*slot as usize]))
        .map(|particle| Pin { particle, frame: 0, local: cloth.particles.position.get(particle as usize) })
        .collect();
    cloth.constraints.set_pins(&mut cloth.particles, Pins { frames: vec![Motion::default()], pins })
}

/// Mean position of the particles whose rest position is `chosen`, m.
pub fn mean(cloth: &Cloth, chosen: impl Fn(Vec3) -> bool) -> Vec3 {
    let (sum, count) = (cloth.topology.particles().map(|slot| slot as usize))
        .filter(|slot| chosen(cloth.topology.rest[*slot]))
        .fold((Vec3::ZERO, 0.0), |(sum, count), slot| (sum + cloth.particles.position.get(slot), count + 1.0));
    sum / count
}

/// Advances by `seconds` under `gravity`.
pub fn run(cloth: &mut Cloth, tick: Tick, gravity: Vec3, seconds: f32) {
    for _ in 0..(seconds / tick.dt).round() as u32 {
        cloth.step(tick, gravity);
    }
}

/// Brings cloth to rest within `seconds`, also from a swing as a whole, which internal friction leaves alone: it is stopped
/// whenever its kinetic energy has passed a peak (kinetic damping, Cundall 1976).
pub fn settle(cloth: &mut Cloth, tick: Tick, gravity: Vec3, seconds: f32) {
    let mut last = 0.0;
    for _ in 0..(seconds / tick.dt).round() as u32 {
        cloth.step(tick, gravity);
        let energy = measure::kinetic_energy(&cloth.particles);
        if energy < last {
            cloth.particles.velocity.fill(Vec3::ZERO);
            last = 0.0;
        } else {
            last = energy;
        }
    }
}

/// A sinusoid that grows or fades.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// Hz.
    pub frequency: f64,
    /// Natural logarithm of the amplitude's growth per second, 1/s.
    pub growth: f64,
}

/// The sinusoid in `samples` taken every `dt` s, whose frequency is about `guess` Hz: the best `p`, `q` of
/// `x[n+k] = p x[n] + q x[n−k]`, with the lag k a quarter of a swing. It is exact for whatever a linear method makes of a
/// harmonic oscillator.
pub fn swing(samples: &[f64], dt: f64, guess: f64) -> Swing {
    let lag = ((0.25 / (guess * dt)).round() as usize).max(1);
    let (mut xx, mut xy, mut yy, mut xz, mut yz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for n in lag..samples.len().saturating_sub(lag) {
        let (x, y, z) = (samples[n], samples[n - lag], samples[n + lag]);
        (xx, xy, yy, xz, yz) = (xx + x * x, xy + x * y, yy + y * y, xz + x * z, yz + y * z);
    }
    let determinant = xx * yy - xy * xy;
    let (p, q) = ((xz * yy - yz * xy) / determinant, (yz * xx - xz * xy) / determinant);
    let amplitude = (-q).sqrt();
    let angle = (0.5 * p / amplitude).clamp(-1.0, 1.0).acos();
    let time = lag as f64 * dt;
    Swing { frequency: angle / (core::f64::consts::TAU * time), growth: amplitude.ln() / time }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fading_sinusoid_is_recognised() {
        let dt = 1.0 / 60.0;
        let samples: Vec<f64> =
            (0..300).map(|n| f64::from(n) * dt).map(|t| (-0.3 * t).exp() * (7.1 * t + 0.4).cos()).collect();
        let found = swing(&samples, dt, 1.0);
        assert!((found.frequency - 7.1 / core::f64::consts::TAU).abs() < 1e-9);
        assert!((found.growth + 0.3).abs() < 1e-9);
    }
}
