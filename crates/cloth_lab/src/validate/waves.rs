//! Frequencies: a taut membrane, and a sheet that hangs by its top.

use cloth_solver::{Cloth, ClothError, Fabric, Method};
use glam::Vec3;

use super::closed::{self, BESSEL_ZEROS};
use super::finding::{Bench, Bound, budget};
use super::rig::{self, G, GRAVITY};

/// Amplitude of what is set swinging, m.
const AMPLITUDE: f64 = 1e-3;

/// Methods that resolve a swing of a few Hz at their budget.
const METHODS: &[Method] = &[Method::XpbdSweeps];

/// Records `signal` for `seconds` and finds its frequency, about `guess` Hz.
fn frequency(
    cloth: &mut Cloth,
    method: Method,
    gravity: Vec3,
    seconds: f64,
    guess: f64,
    signal: impl Fn(&Cloth) -> f64,
) -> f64 {
    let tick = budget(method);
    let dt = f64::from(tick.dt);
    let mut samples = vec![signal(cloth)];
    for _ in 0..(seconds / dt).round() as u32 {
        cloth.step(tick, gravity);
        samples.push(signal(cloth));
    }
    rig::swing(&samples, dt, guess).frequency
}

/// A square membrane of 1 m under 10 N/m with 0.2 kg/m², set swinging in one mode after the other.
pub fn membrane(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "membrane";
    const CELLS: u32 = 20;
    const STRAIN: f32 = 0.01;
    // Per width of stretched cloth a strain ε pulls with Yε/(1 + ε).
    let stretch = 10.0 * (1.0 + STRAIN) / STRAIN;
    let fabric = Fabric {
        areal_density: 0.2 * (1.0 + STRAIN) * (1.0 + STRAIN),
        stretch_warp: stretch,
        stretch_weft: stretch,
        shear: 10.0,
        bend_warp: 0.0,
        bend_weft: 0.0,
        damping: 0.0,
        ..Fabric::COTTON_POPLIN
    };
    for method in bench.with_default(METHODS) {
        for mode in [[1, 1], [1, 2], [2, 2]] {
            let side = 1.0 / (1.0 + STRAIN);
            let mut cloth = rig::rectangle([side, side], [CELLS, CELLS], &fabric, method)?;
            let wave = |x: f32, half_waves: u32| {
                (core::f64::consts::PI * f64::from(half_waves) * (f64::from(x) * f64::from(1.0 + STRAIN) + 0.5)).sin()
            };
            let shape = |rest: Vec3| wave(rest.x, mode[0]) * wave(rest.y, mode[1]);
            rig::put(&mut cloth, |rest| {
                Vec3::new(rest.x * (1.0 + STRAIN), rest.y * (1.0 + STRAIN), (AMPLITUDE * shape(rest)) as f32)
            });
            rig::hold(&mut cloth, |rest| rest.x.abs().max(rest.y.abs()) > 0.499 * side)?;
            let expected = closed::membrane(1.0, 10.0, 0.2, mode, f64::from(CELLS));
            let found = frequency(&mut cloth, method, Vec3::ZERO, 1.0, expected, |cloth| projection(cloth, &shape));
            let what = format!("frequency of mode ({}, {}), {CELLS} cells a side, Hz", mode[0], mode[1]);
            bench.at_rest(CHECK, what, method, found, expected, Bound::Relative(0.01));
        }
    }
    Ok(())
}

/// How much of `shape` is in the displacement along z, weighted by mass.
fn projection(cloth: &Cloth, shape: &impl Fn(Vec3) -> f64) -> f64 {
    (cloth.topology.particles().map(|slot| slot as usize))
        .map(|slot| {
            let mass = f64::from(cloth.particles.mass[slot]);
            mass * shape(cloth.topology.rest[slot]) * f64::from(cloth.particles.position.z[slot])
        })
        .sum()
}

/// The three slowest small swings of a sheet of 1 m that hangs by its top edge, and what is left of a swing of 5° after
/// 5 s.
pub fn hung(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "swings of a hung sheet";
    let fabric = Fabric { bend_warp: 0.0, bend_weft: 0.0, damping: 0.0, ..Fabric::COTTON_POPLIN };
    for method in bench.with_default(METHODS) {
        for mode in 0..3 {
            let mut cloth = rig::rectangle([0.1, 1.0], [4, 40], &fabric, method)?;
            let shape = |rest: Vec3| {
                let above = (f64::from(rest.y) + 0.5).max(0.0);
                closed::bessel(BESSEL_ZEROS[mode] * above.sqrt())
            };
            stretched(&mut cloth, &fabric, |rest| (AMPLITUDE * shape(rest)) as f32);
            rig::hold(&mut cloth, |rest| rest.y > 0.499)?;
            let expected = closed::hanging(1.0, G, mode);
            let found = frequency(&mut cloth, method, GRAVITY, 8.0, expected, |cloth| projection(cloth, &shape));
            let what = format!("frequency of mode {}, Hz", mode + 1);
            bench.at_rest(CHECK, what, method, found, expected, Bound::Relative(0.01));
        }
    }
    Ok(())
}

/// Puts a sheet of 1 m that hangs along y where its own weight stretches it, moved along z.
fn stretched(cloth: &mut Cloth, fabric: &Fabric, along_z: impl Fn(Vec3) -> f32) {
    let give = fabric.areal_density * G as f32 / fabric.stretch_warp;
    rig::put(cloth, |rest| {
        let below_top = 0.5 - rest.y;
        let sunk = give * (below_top - 0.5 * below_top * below_top);
        Vec3::new(rest.x, rest.y - sunk, along_z(rest))
    });
}
