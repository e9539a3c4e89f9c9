//! Cloth in, on and between solids.

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::rest::{Rest, RestLimits};
use cloth_solver::{Cloth, Fabric, Motion, Pose};
use glam::{Quat, Vec2, Vec3};

use super::sheet::{
    KINDS, TICK, deepest, farthest, fastest, ground, hold, in_air, keep_off_itself, positions, rms, run, sheet, solid,
    strain, top,
};
use super::{Outcome, Part, Row, Trial};
use crate::validate::hang::level;
use crate::validate::rig::{self, GRAVITY};

/// The fastest that cloth may leave a solid, m/s: it is pushed out at 3.
const LEAVES_AT: f32 = 3.5;
/// Below this rms speed a cloth is at rest, m/s.
const AT_REST: f32 = 0.03;
const POPLIN: Fabric = Fabric::COTTON_POPLIN;

/// Rows 7, 8, 9, 19 and 31.
pub fn rows(part: Part) -> Vec<Row> {
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(
            7,
            "pinched between two balls, to a gap below twice the thickness and to a negative one",
            "finite, below 2 × the balls' speed, strain within the fabric's limit 0.5 s after",
            pinches(part),
        ),
        row(
            8,
            "spawned inside a ball, box, pyramid, 1 m below ground",
            "leaves at 3.5 m/s at most, is out after 3 s, takes less than 2 × the substeps of a free one",
            spawned(part),
        ),
        row(9, "on apex, edge, face, corner, bar for 30 s", "rms below 0.03 m/s, falls asleep", laid(part)),
        row(19, "all pinned, none pinned, pinned inside a ball", "finite, pins exact", pinned()),
        row(
            31,
            "a hung curtain reset 0.3, 0.6, 1 m into the floor",
            "no particle above 3.5 m/s, rms below 0.03 m/s after 5 s",
            floors(part),
        ),
    ]
}

fn pinches(part: Part) -> Vec<Trial> {
    let mut trials = Vec::new();
    for kind in 0..2 {
        for speed in part.sweep(&[0.5_f32, 2.0, 8.0]) {
            for gap in part.sweep(&[1.5, 0.0, -5.0, -40.0_f32]) {
                let at = format!("{}, {speed} m/s, gap of {gap} thicknesses", KINDS[kind]);
                trials.push(Trial::new(at, move || pinch(kind, speed, gap)));
            }
        }
    }
    trials
}

fn pinch(kind: usize, speed: f32, gap: f32) -> Outcome {
    let radius = 0.12;
    let mut cloth = in_air(sheet(kind, [0.5; 2], [24; 2], &POPLIN));
    hold(&mut cloth, top(0.5));
    run(&mut cloth, 0.5);
    let last = radius + 0.5 * gap * POPLIN.thickness;
    let (mut off, mut fast) = (radius + 0.05, 0.0_f32);
    let ball = |side: f32, from: f32, to: f32| {
        let pose = |off: f32| Pose::new(Vec3::new(0.01, -0.03, side * off), Quat::IDENTITY);
        Collider {
            motion: Motion { from: pose(from), to: pose(to) },
            ..solid(Shape::sphere(radius), Vec3::ZERO, Quat::IDENTITY)
        }
    };
    let mut move_to = |cloth: &mut Cloth, to: f32| {
        let from = std::mem::replace(&mut off, to);
        cloth.contacts.set_colliders([-1.0, 1.0].map(|side| ball(side, from, to)));
        cloth.step(TICK, GRAVITY);
        fast = fast.max(fastest(cloth));
    };
    let step = speed * TICK.dt;
    let steps = ((radius + 0.05 - last) / step).ceil() as u32;
    for number in 1..=steps {
        move_to(&mut cloth, (radius + 0.05 - step * number as f32).max(last));
    }
    for _ in 0..20 {
        move_to(&mut cloth, last);
    }
    for number in 1..=(0.1 / step).ceil() as u32 {
        move_to(&mut cloth, last + (step * number as f32).min(0.1));
    }
    cloth.contacts.set_colliders([]);
    run(&mut cloth, 0.5);
    let held = cloth.particles.is_finite() && fast < 2.0 * speed.max(1.0) && strain(&cloth) < POPLIN.stretch_limit;
    Outcome::new(held, format!("{fast:.2} m/s, strain {:.2} % 0.5 s after", 100.0 * strain(&cloth)))
}

fn shapes() -> [(&'static str, Result<Shape, cloth_solver::ClothError>); 5] {
    [
        ("ball", Shape::sphere(0.2)),
        ("box", Shape::cuboid(Vec3::splat(0.35))),
        ("pyramid", Shape::pyramid(Vec2::splat(0.5), 0.4)),
        ("bar", Shape::capsule(0.02, 0.6)),
        ("ground", Ok(Shape::HalfSpace)),
    ]
}

fn spawned(part: Part) -> Vec<Trial> {
    let mut trials = Vec::new();
    for index in part.sweep(&[0, 1, 2, 4]) {
        for kind in 0..2 {
            let (name, _) = shapes()[index];
            trials.push(Trial::new(format!("{name}, {}", KINDS[kind]), move || {
                let (_, shape) = shapes()[index].clone();
                let mut cloth = in_air(sheet(kind, [0.5; 2], [20; 2], &POPLIN));
                rig::put(&mut cloth, |rest| level(rest) + Vec3::new(0.013, 0.02, 0.007));
                let mut free = cloth.clone();
                let mut taken = [0; 2];
                for _ in 0..30 {
                    free.step(TICK, GRAVITY);
                    taken[0] += free.pace.taken();
                }
                let height = if shape == Ok(Shape::HalfSpace) { 1.0 } else { 0.0 };
                cloth.contacts.set_colliders([solid(shape, Vec3::Y * height, Quat::IDENTITY)]);
                let mut fast = 0.0_f32;
                for tick in 0..180 {
                    let before = positions(&cloth);
                    cloth.step(TICK, GRAVITY);
                    let fallen = if height > 0.0 { 0.0 } else { 9.81 * TICK.dt * (tick + 1) as f32 };
                    fast = fast.max(farthest(&before, &positions(&cloth)) / TICK.dt - fallen);
                    if tick < 30 {
                        taken[1] += cloth.pace.taken();
                    }
                }
                let deep = deepest(&cloth);
                let ratio = taken[1] as f32 / taken[0] as f32;
                let held = fast <= LEAVES_AT && deep < 1e-3 && ratio < 2.0;
                let told = format!("{fast:.2} m/s, {:.1} mm deep after 3 s, {ratio:.1} × the substeps", 1e3 * deep);
                Outcome::new(held, told)
            }));
        }
    }
    trials
}

fn laid(part: Part) -> Vec<Trial> {
    let turn = |x: f32, y: f32, z: f32| Quat::from_rotation_x(x) * Quat::from_rotation_y(y) * Quat::from_rotation_z(z);
    let places = [
        ("apex", 2, turn(0.0, 0.0, 0.0)),
        ("edge", 2, turn(1.2, 0.785, 0.0)),
        ("face", 2, turn(-1.03, 0.0, 0.0)),
        ("corner", 1, turn(0.6154, 0.0, 0.785)),
        ("box", 1, turn(0.0, 0.0, 0.0)),
        ("bar", 3, turn(0.0, 0.0, 1.571)),
        ("ground", 4, turn(0.0, 0.0, 0.0)),
    ];
    let mut trials = Vec::new();
    for (name, index, rotation) in part.sweep(&places) {
        for kind in 0..2 {
            let seconds = if part.is_short() { 8.0 } else { 30.0 };
            trials.push(Trial::new(format!("{name}, {}", KINDS[kind]), move || {
                let (_, shape) = shapes()[index].clone();
                let mut cloth = in_air(sheet(kind, [0.5; 2], [20; 2], &POPLIN));
                rig::put(&mut cloth, |rest| level(rest) + Vec3::new(0.013, 0.5, 0.007));
                cloth.contacts.set_colliders([solid(shape, Vec3::ZERO, rotation), ground(-0.5)]);
                let (mut rest, mut asleep) = (Rest::default(), None);
                for tick in 0..(seconds / TICK.dt) as u32 {
                    let before = cloth.particles.position.clone();
                    cloth.step(TICK, GRAVITY);
                    let rests =
                        rest.watch(&cloth.particles, &before, &RestLimits { speed: AT_REST, time: 0.5 }, TICK.dt);
                    if rests && asleep.is_none() {
                        asleep = Some(tick as f32 * TICK.dt);
                    }
                }
                let told =
                    asleep.map_or_else(|| "does not fall asleep".into(), |time| format!("asleep after {time:.1} s"));
                Outcome::new(rms(&cloth) < AT_REST && asleep.is_some(), format!("rms {:.4} m/s, {told}", rms(&cloth)))
            }));
        }
    }
    trials
}

fn pinned() -> Vec<Trial> {
    let trial = |(kind, name): (usize, &'static str)| {
        Trial::new(format!("{name}, {}", KINDS[kind]), move || {
            let mut cloth = in_air(sheet(kind, [0.5; 2], [12; 2], &POPLIN));
            match name {
                "all pinned" => hold(&mut cloth, |_| true),
                "none pinned" => {}
                _ => {
                    hold(&mut cloth, |rest| rest.length() < 0.1);
                    cloth.contacts.set_colliders([solid(Shape::sphere(0.15), Vec3::ZERO, Quat::IDENTITY)]);
                }
            }
            run(&mut cloth, 2.0);
            let pins = cloth.constraints.pins();
            let off = |pin: &cloth_solver::constraint::Pin| {
                cloth.particles.position.get(pin.particle as usize).distance(pin.local)
            };
            let off = pins.pins.iter().map(off).fold(0.0, f32::max);
            let held = cloth.particles.is_finite() && off == 0.0;
            Outcome::new(held, format!("{} pins, off by {off} m, {:.2} m/s", pins.pins.len(), fastest(&cloth)))
        })
    };
    let names = ["all pinned", "none pinned", "pinned inside a ball"];
    names.into_iter().flat_map(|name| (0..2).map(move |kind| (kind, name))).map(trial).collect()
}

fn floors(part: Part) -> Vec<Trial> {
    let cells = if part.is_short() { [12, 15] } else { [24, 30] };
    let trial = |(kind, keeps_off, below): (usize, bool, f32)| {
        let name = if keeps_off { ", keeps off itself" } else { "" };
        Trial::new(format!("{}, {below} m{name}", KINDS[kind]), move || {
            let mut cloth = in_air(sheet(kind, [1.2, 1.5], cells, &POPLIN));
            hold(&mut cloth, top(1.5));
            if keeps_off {
                keep_off_itself(&mut cloth, &POPLIN);
            }
            cloth.contacts.set_colliders([ground(below - 0.75)]);
            let mut fast = 0.0_f32;
            for _ in 0..300 {
                let before = positions(&cloth);
                cloth.step(TICK, GRAVITY);
                fast = fast.max(farthest(&before, &positions(&cloth)) / TICK.dt);
            }
            let held = fast <= LEAVES_AT && rms(&cloth) < AT_REST;
            Outcome::new(held, format!("{fast:.2} m/s, rms {:.4} m/s after 5 s", rms(&cloth)))
        })
    };
    let below = part.sweep(&[0.3, 0.6, 1.0]);
    let kinds = [(0, false), (1, false), (0, true)];
    kinds.into_iter().flat_map(|(kind, own)| below.iter().map(move |below| (kind, own, *below))).map(trial).collect()
}
