//! What cloth left to itself keeps, as a rectangle and as an irregular mesh: momentum, and energy, which may not grow.

use cloth_solver::{Cloth, ClothError, Fabric, Method, Tick, measure};
use glam::{Quat, Vec3};

use super::finding::{Bench, Bound, budget};
use super::rig::{self, G, GRAVITY};

/// What each check is done with, and whether it is the irregular mesh.
const KINDS: [(&str, bool); 2] = [("rectangle", false), ("irregular mesh", true)];

/// Substeps that energy is checked at.
const SUBSTEPS: [u32; 2] = [10, 20];

/// How long energy is watched, s.
const SECONDS: u32 = 8;

/// Part by which energy may rise within a second.
const RISE: f64 = 1e-3;

/// A sheet of `size` m and `cells`.
fn sheet(mesh: bool, size: [f32; 2], cells: [u32; 2], fabric: &Fabric, method: Method) -> Result<Cloth, ClothError> {
    if mesh {
        let (positions, triangles) = rig::irregular(size.into(), cells, 0);
        rig::mesh(&positions, &triangles, fabric, method)
    } else {
        rig::rectangle(size, cells, fabric, method)
    }
}

/// A free sheet that crumples, spins and flies for 10 s: its momenta, in parts of what its particles have without their
/// directions.
pub fn momentum(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "crumpled: momentum";
    let fabric = Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN };
    for method in bench.with_default(&[]) {
        for (name, mesh) in KINDS {
            let mut cloth = sheet(mesh, [1.0, 1.0], [16, 16], &fabric, method)?;
            for slot in 0..cloth.topology.slots() {
                let rest = cloth.topology.rest[slot];
                let waves = Vec3::Z * (1.5 * (9.0 * rest.x + 0.4).sin() * (7.0 * rest.y).cos());
                let spin = Vec3::new(0.4, 1.0, 2.0).cross(rest);
                cloth.particles.velocity.set(slot, Vec3::new(0.05, 0.0, 0.02) + spin - 2.0 * rest + waves);
            }
            let linear = |cloth: &Cloth| measure::linear_momentum(&cloth.particles);
            let angular = |cloth: &Cloth| {
                let middle = rig::midway(cloth);
                measure::angular_momentum(&middle, measure::centre_of_mass(&middle))
            };
            let before = [linear(&cloth), angular(&cloth)];
            let scale = scales(&cloth);
            let mut drift = [0.0_f64; 2];
            for _ in 0..600 {
                cloth.step(budget(method), Vec3::ZERO);
                let now = [linear(&cloth), angular(&cloth)];
                for i in 0..2 {
                    drift[i] = worse(drift[i], (now[i] - before[i]).length() / scale[i]);
                }
            }
            for (what, drift) in ["linear", "angular"].into_iter().zip(drift) {
                let what = format!("drift of {what} momentum in 10 s, {name}, parts");
                bench.claim(CHECK, what, method, drift, 1e-5, Bound::AtMost);
            }
        }
    }
    Ok(())
}

/// Sums of the amounts of the particles' momenta: linear, and angular about the centre of mass.
fn scales(cloth: &Cloth) -> [f64; 2] {
    let centre = measure::centre_of_mass(&cloth.particles);
    cloth.topology.particles().map(|slot| slot as usize).fold([0.0; 2], |[linear, angular], slot| {
        let momentum = f64::from(cloth.particles.mass[slot]) * cloth.particles.velocity.get(slot).as_dvec3();
        let arm = cloth.particles.position.get(slot).as_dvec3() - centre;
        [linear + momentum.length(), angular + arm.cross(momentum).length()]
    })
}

/// A sheet hung by its top edge swings from 30°: how much its energy rises within a second.
pub fn swing(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "swing: energy";
    let fabric = Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN };
    for method in bench.with_default(&[]) {
        for (name, mesh) in KINDS {
            for substeps in SUBSTEPS {
                let mut cloth = sheet(mesh, [1.0, 1.0], [16, 16], &fabric, method)?;
                let turn = Quat::from_rotation_x(core::f32::consts::FRAC_PI_6);
                rig::put(&mut cloth, |rest| turn * (rest - 0.5 * Vec3::Y));
                rig::hold(&mut cloth, |rest| rest.y > 0.499)?;
                let energies = watch(&mut cloth, Tick { substeps, ..budget(method) }, &fabric);
                let weight = f64::from(fabric.areal_density) * G;
                let of_swing = weight * 0.5 * (1.0 - core::f64::consts::FRAC_PI_6.cos());
                let rise = rise_in_a_second(&energies) / of_swing;
                let what = format!("rise of energy within 1 s, {name}, {substeps} substeps, parts of the swing's");
                bench.claim(CHECK, what, method, rise, RISE, Bound::AtMost);
            }
        }
    }
    Ok(())
}

/// A flag held by its side falls: how much its energy rises within a second.
pub fn flag(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "falling flag: energy";
    let fabric = Fabric { damping: 0.0, ..Fabric::FLAG_POLYESTER };
    for method in bench.with_default(&[]) {
        for (name, mesh) in KINDS {
            for substeps in SUBSTEPS {
                let mut cloth = sheet(mesh, [1.5, 1.0], [24, 16], &fabric, method)?;
                // A little out of its plane: so it folds.
                rig::put(&mut cloth, |rest| {
                    rest + Vec3::Z * (1e-3 * (7.0 * rest.x).sin() * (5.0 * rest.y + 0.3).cos())
                });
                rig::hold(&mut cloth, |rest| rest.x < -0.749)?;
                let energies = watch(&mut cloth, Tick { substeps, ..budget(method) }, &fabric);
                let first = energies[0].height;
                let falls = energies.windows(2).take_while(|pair| pair[1].height < pair[0].height).count();
                let rise = rise_in_a_second(&energies) / (first - energies[falls].height);
                let what = format!("rise of energy within 1 s, {name}, {substeps} substeps, parts of its first fall's");
                bench.claim(CHECK, what, method, rise, RISE, Bound::AtMost);
            }
        }
    }
    Ok(())
}

/// Energies after a tick, J.
#[derive(Clone, Copy)]
struct Told {
    /// All of it.
    total: f64,
    /// That of its height.
    height: f64,
}

/// Energies before the first tick and after each.
fn watch(cloth: &mut Cloth, tick: Tick, fabric: &Fabric) -> Vec<Told> {
    let told = |cloth: &Cloth| {
        let middle = rig::midway(cloth);
        let height = measure::gravitational_energy(&middle, GRAVITY);
        let elastic = measure::elastic_energy(&cloth.topology, &middle, fabric);
        Told { total: measure::kinetic_energy(&middle) + elastic + height, height }
    };
    let mut energies = vec![told(cloth)];
    for _ in 0..SECONDS * (1.0 / tick.dt).round() as u32 {
        cloth.step(tick, GRAVITY);
        energies.push(told(cloth));
    }
    energies
}

/// The largest rise of energy from any tick to one within a second after it, J.
fn rise_in_a_second(energies: &[Told]) -> f64 {
    let rises = energies.windows(61).flat_map(|second| second[1..].iter().map(|later| later.total - second[0].total));
    rises.fold(0.0, worse)
}

/// The larger one; what is no number stays.
fn worse(worst: f64, now: f64) -> f64 {
    if now > worst || now.is_nan() { now } else { worst }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_counts_within_a_second_and_not_beyond() {
        let told = |total: f64| Told { total, height: 0.0 };
        let slow: Vec<Told> = (0..601).map(|tick| told(f64::from(tick) / 60.0)).collect();
        assert!((rise_in_a_second(&slow) - 1.0).abs() < 1e-9);
        let mut bump = vec![told(2.0); 200];
        (bump[80], bump[81]) = (told(1.0), told(1.5));
        assert_eq!(rise_in_a_second(&bump), 1.0);
        bump[100] = told(f64::NAN);
        assert!(rise_in_a_second(&bump).is_nan());
    }
}
