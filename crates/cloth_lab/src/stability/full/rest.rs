//! Cloth that has nothing to do but to rest, or to keep what it has.

use std::f32::consts::TAU;

use cloth_solver::forces::WindField;
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Tick, Topology, measure};
use glam::{DVec3, Quat, Vec3};

use super::sheet::{
    KINDS, TICK, corners, energy, farthest, fastest, hold, in_air, noise, positions, rms, run, sheet, strain, top,
};
use super::{Outcome, Part, Row, Trial};
use crate::stability::random::{self, Random, Sample};
use crate::validate::rig::{self, GRAVITY};

/// Below this rms speed a cloth is at rest, m/s.
const AT_REST: f32 = 0.03;
/// Random cloths.
const SAMPLES: u64 = 300;
/// Crumpled cloths.
const CRUMPLED: u64 = 40;
const POPLIN: Fabric = Fabric::COTTON_POPLIN;

/// Rows 18, 25, 26, 27, 29 and 36.
pub fn rows(part: Part, seed: u64) -> Vec<Row> {
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(
            18,
            "cloth of 1 mm, 1 m, 100 m, all lengths and forces in proportion",
            "the same shape within 1 % of the size",
            scales(),
        ),
        row(
            25,
            "random cloths of every preset, grids and meshes, held in five ways (as `--random`)",
            "rms below 0.03 m/s after 20 s in air",
            samples(part, seed),
        ),
        row(
            26,
            "a flag without wind and after one of 6 m/s; without air and damping",
            "rests; without air its energy never rises by 1 ‰",
            flags(part),
        ),
        row(
            27,
            "crumpled free cloth without air and gravity for 10 s",
            "linear and angular momentum kept to 1e-4 of their scale, energy never rises by 1 ‰",
            crumpled(part, seed),
        ),
        row(
            29,
            "starts on a line, in a point, strewn by a cell, twisted by 360°",
            "strain below 2 % within 3 s",
            starts(),
        ),
        row(36, "at rest without gravity: grids, meshes, tubes, caps, for 60 s", "moves less than 0.1 mm", still(part)),
    ]
}

fn scales() -> Vec<Trial> {
    // Everything in metres and newtons times the size, time times its root: the same motion.
    let hung = |scale: f32| {
        let of = |power: i32| scale.powi(power);
        let fabric = Fabric {
            stretch_warp: POPLIN.stretch_warp * scale,
            stretch_weft: POPLIN.stretch_weft * scale,
            shear: POPLIN.shear * scale,
            bend_warp: POPLIN.bend_warp * of(3),
            bend_weft: POPLIN.bend_weft * of(3),
            damping: 5.0 / scale.sqrt(),
            ..POPLIN
        };
        let mut cloth = sheet(0, [scale; 2], [16; 2], &fabric);
        hold(&mut cloth, corners([scale; 2]));
        rig::put(&mut cloth, |rest| rest + Vec3::Z * 0.03 * (5.0 * rest.x / scale).cos() * (0.5 * scale - rest.y));
        let tick = Tick::new(scale.sqrt() / 60.0);
        (0..600).for_each(|_| cloth.step(tick, GRAVITY));
        positions(&cloth).into_iter().map(|x| x / scale).collect::<Vec<Vec3>>()
    };
    let trial = |scale: f32| {
        Trial::new(format!("{scale} m"), move || {
            let far = farthest(&hung(1.0), &hung(scale));
            Outcome::new(far < 0.01, format!("{:.4} % of the size off", 100.0 * far))
        })
    };
    [1e-3, 0.03, 10.0, 100.0].into_iter().map(trial).collect()
}

fn samples(part: Part, seed: u64) -> Vec<Trial> {
    let trial = |number: u64| {
        let sample = Sample::new(seed.wrapping_add(number));
        Trial::new(format!("seed {}", sample.seed), move || match random::play(&sample) {
            Ok(seen) => {
                let kind = KINDS[usize::from(sample.mesh)];
                let told = format!(
                    "{}, {kind}, {}, {}: rms {:.4} m/s",
                    sample.preset,
                    sample.cells,
                    sample.held.name(),
                    seen.speed
                );
                Outcome::new(seen.rests(), told)
            }
            Err(error) => Outcome::new(false, error.to_string()),
        })
    };
    (0..part.of(SAMPLES, 2)).map(trial).collect()
}

fn flags(part: Part) -> Vec<Trial> {
    let seconds = if part.is_short() { 8.0 } else { 20.0 };
    let flag = |kind: usize, fabric: &Fabric| {
        let mut flag = sheet(kind, [0.45, 0.3], [18, 12], fabric);
        hold(&mut flag, |rest| rest.x < -0.2249);
        flag
    };
    let mut trials = Vec::new();
    for kind in 0..2 {
        for substeps in part.sweep(&[5, 10, 20]) {
            let tick = Tick::at_least(1.0 / 60.0, substeps);
            trials.push(Trial::new(format!("in air, {}, {substeps} substeps", KINDS[kind]), move || {
                let mut flag = in_air(flag(kind, &POPLIN));
                let mut speeds = Vec::new();
                for (wind, seconds) in [(0.0, seconds), (6.0, 2.0), (0.0, seconds)] {
                    flag.wind = WindField::uniform(Vec3::new(wind, 0.0, 0.1 * wind));
                    rig::run(&mut flag, tick, GRAVITY, seconds);
                    speeds.push(rms(&flag));
                }
                let held = speeds[0] < AT_REST && speeds[2] < AT_REST;
                Outcome::new(held, format!("rms {:.4} m/s, after the wind {:.4} m/s", speeds[0], speeds[2]))
            }));
            trials.push(Trial::new(format!("without air, {}, {substeps} substeps", KINDS[kind]), move || {
                let fabric = Fabric { damping: 0.0, ..POPLIN };
                let mut flag = flag(kind, &fabric);
                flag.step(tick, GRAVITY);
                let first = energy(&flag, &fabric, GRAVITY);
                // What there is to lose: a fall by half of its width.
                let scale = 0.5 * 0.45 * 9.81 * 0.45 * 0.3 * f64::from(POPLIN.areal_density);
                let mut most = first;
                for _ in 0..(seconds * 60.0) as u32 {
                    flag.step(tick, GRAVITY);
                    most = most.max(energy(&flag, &fabric, GRAVITY));
                }
                let rise = (most - first) / scale;
                Outcome::new(rise < 1e-3, format!("energy rises by {:.2} ‰ of that of its fall", 1e3 * rise))
            }));
        }
    }
    trials
}

fn crumpled(part: Part, seed: u64) -> Vec<Trial> {
    let seconds = if part.is_short() { 2.0 } else { 10.0 };
    let trial = move |number: u64| {
        let seed = seed.wrapping_add(number);
        Trial::new(format!("seed {seed}"), move || {
            let mut random = Random::new(seed);
            let (name, preset) = Fabric::PRESETS[random.below(Fabric::PRESETS.len())];
            let fabric = Fabric { damping: 0.0, ..preset };
            let cells = [(); 2].map(|()| 3 + random.below(12) as u32);
            let (kind, size) = (random.below(2), 0.4_f32);
            let mut cloth = sheet(kind, [size; 2], cells, &fabric);
            for slot in cloth.topology.particles().map(|slot| slot as usize).collect::<Vec<_>>() {
                let x = cloth.topology.rest[slot];
                let wave = 0.1 * size * (7.0 * x.x / size + 5.0 * x.y / size).sin();
                let place = Vec3::new(0.93 * x.x, x.y, wave) + 0.001 * noise(&mut random);
                cloth.particles.position.set(slot, place);
                cloth.particles.previous.set(slot, place);
                cloth.particles.velocity.set(slot, Vec3::new(0.3 + x.y, -x.x, 0.0) + 0.3 * noise(&mut random));
            }
            let mass: f64 = cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum();
            let linear = measure::linear_momentum(&cloth.particles);
            // From the first tick on: before it the velocities are those where the particles are.
            cloth.step(TICK, Vec3::ZERO);
            let angular = measure::angular_momentum(&cloth.particles, DVec3::ZERO);
            let first = energy(&cloth, &fabric, Vec3::ZERO);
            let (mut speed, mut most) = (f64::from(fastest(&cloth)), first);
            for _ in 0..(seconds * 60.0) as u32 {
                cloth.step(TICK, Vec3::ZERO);
                speed = speed.max(f64::from(fastest(&cloth)));
                most = most.max(energy(&cloth, &fabric, Vec3::ZERO));
            }
            let drift = (measure::linear_momentum(&cloth.particles) - linear).length() / (mass * speed);
            let turn = measure::angular_momentum(&cloth.particles, DVec3::ZERO) - angular;
            let turn = turn.length() / (mass * speed * f64::from(size));
            let rise = most / first - 1.0;
            let held = cloth.particles.is_finite() && drift < 1e-4 && turn < 1e-4 && rise < 1e-3;
            let told = format!(
                "{name}, {}, {} × {}: linear {drift:.1e}, angular {turn:.1e}, energy rises by {:.2} ‰",
                KINDS[kind],
                cells[0],
                cells[1],
                1e3 * rise
            );
            Outcome::new(held, told)
        })
    };
    (0..part.of(CRUMPLED, 2)).map(trial).collect()
}

fn starts() -> Vec<Trial> {
    let half = 0.24;
    let trial = |(kind, name): (usize, &'static str)| {
        Trial::new(format!("{name}, {}", KINDS[kind]), move || {
            let mut cloth = in_air(sheet(kind, [2.0 * half; 2], [12; 2], &POPLIN));
            let mut random = Random::new(5);
            for slot in 0..cloth.topology.slots() {
                let (rest, noise) = (cloth.topology.rest[slot], noise(&mut random));
                let to = match name {
                    "line" => Vec3::new(rest.x, half, 0.0),
                    "point" => Vec3::Y * half + 1e-6 * noise,
                    "strewn" => rest + 0.04 * noise,
                    _ => Quat::from_rotation_y((half - rest.y) / (2.0 * half) * TAU) * rest,
                };
                cloth.particles.position.set(slot, to);
                cloth.particles.previous.set(slot, to);
            }
            let held = top(2.0 * half);
            let pins = cloth.topology.particles().filter(|slot| held(cloth.topology.rest[*slot as usize]));
            let pin = |particle: u32| cloth_solver::constraint::Pin {
                particle,
                frame: 0,
                local: cloth.topology.rest[particle as usize],
            };
            let pins =
                cloth_solver::constraint::Pins { frames: vec![Default::default()], pins: pins.map(pin).collect() };
            if let Err(error) = cloth.constraints.set_pins(&mut cloth.particles, pins) {
                return Outcome::new(false, error.to_string());
            }
            run(&mut cloth, 3.0);
            let held = cloth.particles.is_finite() && strain(&cloth) < 0.02;
            Outcome::new(held, format!("strain {:.2} %, rms {:.3} m/s", 100.0 * strain(&cloth), rms(&cloth)))
        })
    };
    let names = ["line", "point", "strewn", "twisted"];
    (0..2).flat_map(|kind| names.into_iter().map(move |name| (kind, name))).map(trial).collect()
}

/// A curved surface over `columns` × `rows` quads.
fn curved(columns: u32, rows: u32, place: impl Fn(f32, f32) -> Vec3) -> Cloth {
    let at = |i: u32, j: u32| place(i as f32 / columns as f32, j as f32 / rows as f32);
    let positions: Vec<Vec3> =
        (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j))).map(|(i, j)| at(i, j)).collect();
    let corner = |i: u32, j: u32| j * (columns + 1) + i;
    let quads = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let indices: Vec<u32> = quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [a, b, c, a, c, d]
        })
        .collect();
    let source = MeshSource { positions: &positions, uvs: &[], indices: &indices };
    let made = Topology::from_mesh(source).and_then(|topology| Cloth::new(topology.into(), &POPLIN));
    made.unwrap_or_else(|error| panic!("{error}"))
}

fn still(part: Part) -> Vec<Trial> {
    let seconds = if part.is_short() { 5.0 } else { 60.0 };
    let made: [(&'static str, fn() -> Cloth); 6] = [
        ("grid 7 × 5, paper", || sheet(0, [0.4, 0.3], [7, 5], &Fabric::PAPER)),
        ("grid 20 × 20", || sheet(0, [0.4; 2], [20; 2], &POPLIN)),
        ("grid 1 × 30", || sheet(0, [0.05, 0.9], [1, 30], &POPLIN)),
        ("mesh 12 × 9", || sheet(1, [0.4, 0.3], [12, 9], &POPLIN)),
        ("tube", || curved(20, 12, |u, v| Vec3::new(0.1 * (TAU * u).cos(), 0.4 * v, 0.1 * (TAU * u).sin()))),
        ("cap", || {
            curved(12, 12, |u, v| {
                let (x, y) = (0.3 * (u - 0.5), 0.3 * (v - 0.5));
                Vec3::new(x, y, (0.09 - x * x - y * y).sqrt())
            })
        }),
    ];
    let trial = move |(name, make): (&'static str, fn() -> Cloth)| {
        Trial::new(name, move || {
            let mut cloth = make();
            let before = positions(&cloth);
            (0..(seconds * 60.0) as u32).for_each(|_| cloth.step(TICK, Vec3::ZERO));
            let far = farthest(&before, &positions(&cloth));
            Outcome::new(far < 1e-4, format!("{:.4} mm", 1e3 * far))
        })
    };
    made.into_iter().map(trial).collect()
}
