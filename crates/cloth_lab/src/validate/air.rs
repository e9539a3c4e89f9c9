//! The air: falling broadside, and the force on a sheet in the wind.

use cloth_solver::forces::{Air, WindField};
use cloth_solver::{Cloth, ClothError, Fabric, Method, Tick};
use glam::{DVec3, Vec3};

use super::finding::{Bench, Bound, budget};
use super::hang::level;
use super::rig::{self, G, GRAVITY};

/// A level sheet of 1 m and `cells`, of `density` kg/m².
fn sheet(method: Method, cells: u32, density: f32) -> Result<Cloth, ClothError> {
    // As stiff as a board: the known answer is that of a flat sheet, and a limp one flutters.
    let fabric =
        Fabric { areal_density: density, bend_warp: 1.0, bend_weft: 1.0, damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = rig::rectangle([1.0, 1.0], [cells, cells], &fabric, method)?;
    rig::put(&mut cloth, level);
    Ok(cloth)
}

/// How fast a sheet falls broadside after `seconds`, m/s.
fn fallen(method: Method, cells: u32, density: f32, rate: f32, seconds: f32) -> Result<f64, ClothError> {
    let mut cloth = sheet(method, cells, density)?;
    let tick = Tick { dt: 1.0 / rate, ..budget(method) };
    cloth.air = Some(Air::default());
    for _ in 0..(seconds * rate).round() as u32 {
        cloth.step(tick, GRAVITY);
    }
    let count = cloth.topology.particle_count() as f64;
    Ok(-cloth.topology.particles().map(|slot| f64::from(cloth.particles.velocity.y[slot as usize])).sum::<f64>()
        / count)
}

/// Falling broadside: v = v_t tanh(gt/v_t) with v_t = √(2σg/(ρC)), on any mesh and at any step.
pub fn fall(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "air";
    let air = Air::default();
    for method in bench.with_default(&[]) {
        for density in [0.05_f32, 0.15, 0.30] {
            let terminal = (2.0 * f64::from(density) * G / f64::from(air.density * air.normal)).sqrt();
            for seconds in [0.2_f32, 3.0] {
                let expected = terminal * (G * f64::from(seconds) / terminal).tanh();
                let what = format!("speed of fall broadside of {density} kg/m² after {seconds} s, m/s");
                let found = fallen(method, 10, density, 240.0, seconds)?;
                bench.claim(CHECK, what, method, found, expected, Bound::Relative(0.01));
            }
        }
        let settings = [(5, 60.0), (10, 60.0), (20, 60.0), (10, 240.0)];
        let speeds = settings.map(|(cells, rate)| fallen(method, cells, 0.15, rate, 3.0));
        let speeds = speeds.into_iter().collect::<Result<Vec<_>, _>>()?;
        let (low, high) = speeds.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(*v), h.max(*v)));
        let what = "spread of terminal speed over 5, 10, 20 cells and 60, 240 Hz, parts";
        bench.claim(CHECK, what, method, high / low - 1.0, 0.01, Bound::AtMost);
    }
    Ok(())
}

/// The force of a wind on a sheet that moves at one velocity, N.
fn force(cells: u32, wind: Vec3, moving: Vec3) -> Result<DVec3, ClothError> {
    let mut cloth = sheet(Method::default(), cells, 0.15)?;
    cloth.particles.velocity.fill(moving);
    Ok(force_on(&mut cloth, &WindField::uniform(wind)))
}

/// The force of an air on a cloth as it is, N.
pub fn force_on(cloth: &mut Cloth, wind: &WindField) -> DVec3 {
    wind.sample(&cloth.topology, &mut cloth.particles);
    // For so short a time that what a particle may get does not bound it.
    let short = Tick::fixed(1e-6, 1);
    Air::default().blow(&cloth.topology, &mut cloth.particles, &short.first());
    let force = cloth.particles.airflow.as_ref().map(|airflow| &airflow.force);
    force.map_or(DVec3::ZERO, |all| (0..all.len()).map(|slot| all.get(slot).as_dvec3()).sum())
}

/// The force on a sheet at rest: ½ρCAv², its square law, its mirror image, its independence of the mesh.
pub fn wind(bench: &mut Bench) -> Result<(), ClothError> {
    let mut add = |quantity: &str, value, expected, bound| bench.known("air", quantity, value, expected, bound);
    let slant = Vec3::new(1.0, 2.0, -0.5);
    let one = force(10, slant, Vec3::ZERO)?;
    let broadside = force(10, Vec3::Y * 2.0, Vec3::ZERO)?.y;
    add("force of 2 m/s broadside on 1 m², N", broadside, 0.5 * 1.225 * 1.17 * 4.0, Bound::Relative(1e-3));
    let ratio = force(10, 3.0 * slant, Vec3::ZERO)?.length() / one.length();
    add("force at three times the wind over that at one", ratio, 9.0, Bound::Relative(1e-4));
    let still = force(10, slant, slant)?.length();
    add("force when moving with the air, N", still, 1e-6, Bound::AtMost);
    let mirrored = (force(10, -slant, Vec3::ZERO)? + one).length() / one.length();
    add("force of the wind turned round plus that of the wind, parts", mirrored, 1e-5, Bound::AtMost);
    let finer = (force(37, slant, Vec3::ZERO)? - one).length() / one.length();
    add("force on 37 cells a side less that on 10, parts", finer, 1e-4, Bound::AtMost);
    Ok(())
}
