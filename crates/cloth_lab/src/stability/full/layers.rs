//! Cloth on itself: dropped, wrapped, tangled.

use std::f32::consts::TAU;

use cloth_solver::contact::Shape;
use cloth_solver::{Cloth, Fabric};
use glam::{Quat, Vec3};

use super::sheet::{
    KINDS, TICK, crossings, energy, ground, hold, in_air, keep_off_itself, noise, rms, run, sheet, solid,
};
use super::{Outcome, Part, Row, Trial};
use crate::stability::random::Random;
use crate::validate::rig::{self, GRAVITY};

/// Below this rms speed a cloth is at rest, m/s.
const AT_REST: f32 = 0.03;
/// Sheets that are dropped on their edge, and that start tangled.
const TRIALS: [u64; 2] = [60, 60];

/// Rows 10 and 11.
pub fn rows(part: Part) -> Vec<Row> {
    let seconds = if part.is_short() { 3 } else { 15 };
    let mut on_itself: Vec<Trial> = (0..part.of(TRIALS[0], 2)).map(dropped).collect();
    for (name, fabric) in part.sweep(&[
        ("poplin", Fabric::COTTON_POPLIN),
        ("silk", Fabric::SILK_CHARMEUSE),
        ("velvet", Fabric::VELVET_CURTAIN),
    ]) {
        on_itself.extend((0..2).map(|kind| wrapped(name, fabric, kind, seconds)));
    }
    let scene = "a sheet dropped on its edge onto the ground; a flag wrapped round its pole";
    let must = "no edge through a triangle at any time, rms below 0.03 m/s after 7 s (wrapped: 15 s)";
    let tangled_must = "finite, kinetic and elastic energy never above what there was to begin with";
    vec![
        Row { number: 10, scene, must, trials: on_itself },
        Row {
            number: 11,
            scene: "starts tangled, without gravity and air",
            must: tangled_must,
            trials: (0..part.of(TRIALS[1], 2)).map(tangled).collect(),
        },
    ]
}

fn dropped(seed: u64) -> Trial {
    Trial::new(format!("dropped, seed {seed}"), move || {
        let mut random = Random::new(seed);
        let (name, fabric) = Fabric::PRESETS[random.below(Fabric::PRESETS.len())];
        let cells = [(); 2].map(|()| 8 + random.below(12) as u32);
        let kind = random.below(2);
        let mut cloth = sheet(kind, [0.8, 0.7], cells, &fabric);
        let [tilt, roll] = [0.6, 1.6].map(|range| range * (random.part() as f32 - 0.5));
        let turn = Quat::from_rotation_x(tilt) * Quat::from_rotation_z(roll);
        rig::put(&mut cloth, |rest| Vec3::Y * 0.7 + turn * rest);
        cloth.contacts.set_colliders([ground(0.0)]);
        keep_off_itself(&mut cloth, &fabric);
        let mut most = 0;
        for tick in 0..420 {
            cloth.step(TICK, GRAVITY);
            if tick % 6 == 5 {
                most = most.max(crossings(&cloth));
            }
        }
        let held = cloth.particles.is_finite() && most == 0 && rms(&cloth) < AT_REST;
        Outcome::new(held, format!("{name}, {}: {most} crossings, rms {:.4} m/s", KINDS[kind], rms(&cloth)))
    })
}

fn wrapped(name: &'static str, fabric: Fabric, kind: usize, seconds: u32) -> Trial {
    Trial::new(format!("wrapped, {name}, {}", KINDS[kind]), move || {
        let (size, pole, pitch) = ([0.6, 0.3], 0.04, 0.006);
        let mut cloth = in_air(sheet(kind, size, [36, 18], &fabric));
        // A spiral whose arc is as long as the cloth.
        rig::put(&mut cloth, |rest| {
            let (along, mut angle) = (rest.x + 0.5 * size[0], 0.0_f32);
            for _ in 0..20 {
                angle = along / (pole + 0.002 + 0.5 * pitch * angle / TAU);
            }
            let radius = pole + 0.002 + pitch * angle / TAU;
            Vec3::new(radius * angle.cos(), rest.y, radius * angle.sin())
        });
        hold(&mut cloth, |rest| rest.x < -0.4999 * size[0]);
        cloth.contacts.set_colliders([solid(Shape::capsule(pole, 1.0), Vec3::ZERO, Quat::IDENTITY)]);
        keep_off_itself(&mut cloth, &fabric);
        let began = crossings(&cloth);
        let most = (0..seconds).map(|_| {
            run(&mut cloth, 1.0);
            crossings(&cloth)
        });
        let most = most.max().unwrap_or(0);
        let held = began == 0 && most == 0 && rms(&cloth) < AT_REST;
        Outcome::new(held, format!("{most} crossings, rms {:.4} m/s", rms(&cloth)))
    })
}

fn tangled(seed: u64) -> Trial {
    Trial::new(format!("seed {seed}"), move || {
        let mut random = Random::new(seed);
        let (name, preset) = Fabric::PRESETS[random.below(Fabric::PRESETS.len())];
        let fabric = Fabric { damping: 0.0, ..preset };
        let cells = [(); 2].map(|()| 6 + random.below(10) as u32);
        let kind = random.below(2);
        let mut cloth = sheet(kind, [0.5, 0.4], cells, &fabric);
        let strewn = 0.3 * random.part() as f32 * 0.5 / cells[0] as f32;
        fold_through_itself(&mut cloth, strewn, &mut random);
        keep_off_itself(&mut cloth, &fabric);
        let (tangled, first) = (crossings(&cloth), energy(&cloth, &fabric, Vec3::ZERO));
        let (mut most, mut free) = (0.0_f64, None);
        for tick in 0..300 {
            cloth.step(TICK, Vec3::ZERO);
            most = most.max(energy(&cloth, &fabric, Vec3::ZERO));
            if free.is_none() && tick % 6 == 0 && crossings(&cloth) == 0 {
                free = Some(tick as f32 * TICK.dt);
            }
        }
        let told = free.map_or_else(
            || format!("{} of {tangled} crossings left", crossings(&cloth)),
            |time| format!("{tangled} crossings, free after {time:.1} s"),
        );
        let held = cloth.particles.is_finite() && most <= first * 1.001 + 1e-9;
        Outcome::new(held, format!("{name}, {}: {told}, energy {:.3} of the first", KINDS[kind], most / first))
    })
}

/// Bends one half of the cloth back through the other at a small angle, every particle a little off.
fn fold_through_itself(cloth: &mut Cloth, strewn: f32, random: &mut Random) {
    let (radius, tilt) = (0.03, 0.3);
    let bent = |rest: Vec3| {
        let (along, arc) = (rest.x, std::f32::consts::PI * radius);
        if along <= 0.0 {
            Vec3::new(along, rest.y, 0.0)
        } else if along < arc {
            Vec3::new(radius * (along / radius).sin(), rest.y, radius * (1.0 - (along / radius).cos()))
        } else {
            // It comes down through the other half.
            Vec3::new(arc - along, rest.y, 2.0 * radius - tilt * 1.5 * (along - arc))
        }
    };
    for slot in 0..cloth.topology.slots() {
        let to = bent(cloth.topology.rest[slot]) + strewn * noise(random);
        cloth.particles.position.set(slot, to);
        cloth.particles.previous.set(slot, to);
    }
}
