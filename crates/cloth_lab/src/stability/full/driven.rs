//! Cloth that is driven: wind, pins that jump and turn, odd ticks, odd forces, everything changed all the time.

use cloth_solver::contact::Shape;
use cloth_solver::forces::{Air, WindField};
use cloth_solver::{Cloth, Fabric, Method, Motion, Pose, Tick};
use glam::{Quat, Vec3};

use super::sheet::{
    KINDS, TICK, corners, farthest, fastest, hold, in_air, noise, positions, rms, run, sheet, solid, strain, top,
};
use super::{Outcome, Part, Row, Trial};
use crate::stability::random::Random;
use crate::validate::rig::{GRAVITY, put};

const POPLIN: Fabric = Fabric::COTTON_POPLIN;

/// Rows 14, 15, 16, 21, 22, 28 and 30.
pub fn rows(part: Part) -> Vec<Row> {
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(14, "wind of 10⁶ m/s for a second", "finite, strain within the fabric's limit 2 s after", gales()),
        row(
            15,
            "pins jump 1, 10, 1000 m, turn by 180° in one tick, dragged",
            "finite, strain within the fabric's limit 0.5 s after",
            jumps(part),
        ),
        row(
            16,
            "ticks of 10⁻⁶ s, of 1/30 and 1/144 s in turn, of any length from 1/240 to 1/20 s",
            "10⁻⁶ s change nothing, else the same rest within 1 % of the size",
            ticks(part),
        ),
        row(
            21,
            "collider, wind, pins, gravity and method changed in every tick for 10 s",
            "finite, mass kept",
            changes(part),
        ),
        row(22, "gravity of 100 g, drag × 10³, no gravity", "finite, below 400 m/s", extremes()),
        row(
            28,
            "a flag in 2…30 m/s for 8 s",
            "95 % of the ticks within 1.5 × the largest strain of 80 substeps",
            flags(part),
        ),
        row(
            30,
            "a worn cape: starts, accelerates to 100 m/s, turns, spins, bobs",
            "strain within 2 × the fabric's limit at all times",
            capes(part),
        ),
    ]
}

fn gales() -> Vec<Trial> {
    let trial = |kind: usize| {
        Trial::new(KINDS[kind], move || {
            let mut cloth = in_air(sheet(kind, [0.6; 2], [16; 2], &POPLIN));
            hold(&mut cloth, top(0.6));
            cloth.wind = WindField::uniform(Vec3::new(3e5, 1e5, 1e6));
            let mut fast = 0.0_f32;
            for _ in 0..60 {
                cloth.step(TICK, GRAVITY);
                fast = fast.max(fastest(&cloth));
            }
            cloth.wind = WindField::default();
            run(&mut cloth, 2.0);
            let held = cloth.particles.is_finite() && strain(&cloth) < POPLIN.stretch_limit;
            Outcome::new(held, format!("{fast:.0} m/s, strain {:.2} % 2 s after", 100.0 * strain(&cloth)))
        })
    };
    (0..2).map(trial).collect()
}

/// Moves all pins to `to` over one tick, and steps.
fn drive(cloth: &mut Cloth, to: Pose, tick: Tick) {
    let frames = cloth.constraints.pin_frames_mut();
    for frame in frames {
        *frame = Motion { from: frame.to, to };
    }
    cloth.step(tick, GRAVITY);
}

fn jumps(part: Part) -> Vec<Trial> {
    let places = [
        ("1 m", Pose::new(Vec3::X, Quat::IDENTITY)),
        ("10 m", Pose::new(Vec3::new(6.0, 8.0, 0.0), Quat::IDENTITY)),
        ("1000 m", Pose::new(Vec3::Z * 1000.0, Quat::IDENTITY)),
        ("180°", Pose::new(Vec3::ZERO, Quat::from_rotation_y(std::f32::consts::PI))),
    ];
    let trial = |(kind, (name, to)): (usize, (&'static str, Pose))| {
        Trial::new(format!("{name}, {}", KINDS[kind]), move || {
            let mut cloth = in_air(sheet(kind, [0.6; 2], [16; 2], &POPLIN));
            hold(&mut cloth, top(0.6));
            run(&mut cloth, 0.5);
            drive(&mut cloth, to, TICK);
            let most = strain(&cloth);
            (0..30).for_each(|_| drive(&mut cloth, to, TICK));
            let held = cloth.particles.is_finite() && strain(&cloth) < POPLIN.stretch_limit;
            Outcome::new(held, format!("strain {:.0} %, {:.2} % 0.5 s after", 100.0 * most, 100.0 * strain(&cloth)))
        })
    };
    let places = part.sweep(&places);
    (0..2).flat_map(|kind| places.iter().map(move |place| (kind, *place))).map(trial).collect()
}

fn ticks(part: Part) -> Vec<Trial> {
    let hung = |kind: usize| {
        let mut cloth = in_air(sheet(kind, [0.6; 2], [16; 2], &Fabric { damping: 5.0, ..POPLIN }));
        hold(&mut cloth, corners([0.6; 2]));
        // Flat, it would go to one side or the other.
        put(&mut cloth, |rest| rest + Vec3::Z * 0.02 * (5.0 * rest.x).cos() * (0.3 - rest.y));
        cloth
    };
    let seconds = if part.is_short() { 4.0 } else { 10.0 };
    let trial = move |(kind, name): (usize, &'static str)| {
        Trial::new(format!("{name}, {}", KINDS[kind]), move || {
            let mut usual = hung(kind);
            run(&mut usual, seconds);
            let mut cloth = hung(kind);
            let mut random = Random::new(3);
            if name == "10⁻⁶ s" {
                run(&mut cloth, seconds);
                (0..1000).for_each(|_| cloth.step(Tick::new(1e-6), GRAVITY));
            } else {
                let (mut time, mut number) = (0.0, 0_u32);
                while time < seconds {
                    let dt = match name {
                        "any" => random.between(1.0 / 240.0, 1.0 / 20.0) as f32,
                        _ if number.is_multiple_of(2) => 1.0 / 30.0,
                        _ => 1.0 / 144.0,
                    };
                    cloth.step(Tick::new(dt), GRAVITY);
                    (time, number) = (time + dt, number + 1);
                }
            }
            let far = farthest(&positions(&usual), &positions(&cloth)) / 0.6;
            Outcome::new(far < 0.01, format!("{:.3} % of the size off, rms {:.3} m/s", 100.0 * far, rms(&cloth)))
        })
    };
    let names = ["10⁻⁶ s", "in turn", "any"];
    (0..2).flat_map(|kind| names.into_iter().map(move |name| (kind, name))).map(trial).collect()
}

fn changes(part: Part) -> Vec<Trial> {
    let trial = |seed: u64| {
        Trial::new(format!("seed {seed}"), move || {
            let mut random = Random::new(seed);
            let mut cloth = in_air(sheet(seed as usize % 2, [0.6; 2], [14; 2], &POPLIN));
            let mass = |cloth: &Cloth| cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum::<f64>();
            let (first, mut fast) = (mass(&cloth), 0.0_f32);
            for tick in 0..600 {
                let height = 0.3 * noise(&mut random).y;
                hold(&mut cloth, |rest| rest.y > height.max(0.2));
                cloth.set_method([Method::XpbdLines, Method::XpbdSweeps][tick % 2]);
                cloth.wind = WindField::uniform(10.0 * noise(&mut random));
                let radius = 0.02 + 0.2 * random.part() as f32;
                cloth.contacts.set_colliders([solid(Shape::sphere(radius), 0.3 * noise(&mut random), Quat::IDENTITY)]);
                cloth.step(TICK, 20.0 * noise(&mut random));
                fast = fast.max(fastest(&cloth));
            }
            let held = cloth.particles.is_finite() && (mass(&cloth) / first - 1.0).abs() < 1e-6;
            Outcome::new(held, format!("{fast:.0} m/s at most"))
        })
    };
    (0..part.of(20, 2)).map(trial).collect()
}

fn extremes() -> Vec<Trial> {
    let trial = |(kind, name): (usize, &'static str)| {
        Trial::new(format!("{name}, {}", KINDS[kind]), move || {
            let mut cloth = in_air(sheet(kind, [0.6; 2], [16; 2], &POPLIN));
            hold(&mut cloth, corners([0.6; 2]));
            let gravity = match name {
                "100 g" => 100.0 * GRAVITY,
                "no gravity" => Vec3::ZERO,
                _ => GRAVITY,
            };
            if name == "drag × 10³" {
                cloth.air = Some(Air { density: 1225.0, ..Air::default() });
                cloth.wind = WindField::uniform(Vec3::Z * 5.0);
            }
            let mut fast = 0.0_f32;
            for _ in 0..300 {
                cloth.step(TICK, gravity);
                fast = fast.max(fastest(&cloth));
            }
            let held = cloth.particles.is_finite() && fast < 400.0;
            Outcome::new(held, format!("{fast:.1} m/s, strain {:.2} % at the end", 100.0 * strain(&cloth)))
        })
    };
    let names = ["100 g", "drag × 10³", "no gravity"];
    (0..2).flat_map(|kind| names.into_iter().map(move |name| (kind, name))).map(trial).collect()
}

fn flags(part: Part) -> Vec<Trial> {
    let seconds = if part.is_short() { 1.0 } else { 8.0 };
    let trial = move |(kind, wind): (usize, f32)| {
        Trial::new(format!("{wind} m/s, {}", KINDS[kind]), move || {
            let play = |tick: Tick| {
                let mut flag = in_air(sheet(kind, [0.45, 0.3], [24, 16], &POPLIN));
                hold(&mut flag, |rest| rest.x < -0.2249);
                flag.wind = WindField::uniform(Vec3::new(wind, 0.0, 0.1 * wind));
                let ticks = 0..(seconds * 60.0) as u32;
                let strains = ticks.map(|_| {
                    flag.step(tick, GRAVITY);
                    strain(&flag)
                });
                strains.collect::<Vec<f32>>()
            };
            let converged = play(Tick::fixed(1.0 / 60.0, 80)).into_iter().fold(0.0, f32::max);
            let strains = play(TICK);
            let within =
                strains.iter().filter(|strain| **strain <= 1.5 * converged).count() as f32 / strains.len() as f32;
            let most = strains.into_iter().fold(0.0, f32::max);
            let told = format!(
                "{:.1} % of the ticks; largest {:.2} %, converged {:.2} %",
                100.0 * within,
                100.0 * most,
                100.0 * converged
            );
            Outcome::new(within >= 0.95, told)
        })
    };
    let winds = part.sweep(&[2.0, 6.0, 10.0, 15.0, 20.0, 30.0]);
    (0..2).flat_map(|kind| winds.iter().map(move |wind| (kind, *wind))).map(trial).collect()
}

fn capes(part: Part) -> Vec<Trial> {
    let turn = |angle: f32| Pose::new(Vec3::ZERO, Quat::from_rotation_y(angle));
    let at = |place: Vec3| Pose::new(place, Quat::IDENTITY);
    let motions: [(&str, Box<dyn Fn(f32) -> Pose + Send + Sync>); 5] = [
        ("starts at 10 m/s", Box::new(move |t| at(Vec3::Z * 10.0 * t))),
        ("20 m/s² to 100 m/s", Box::new(move |t| at(Vec3::Z * 10.0 * t * t))),
        ("half round in 0.1 s", Box::new(move |t| turn(std::f32::consts::PI * (t / 0.1).min(1.0)))),
        ("spins at 10 rad/s", Box::new(move |t| turn(10.0 * t))),
        ("bobs 5 cm at 3 Hz", Box::new(move |t| at(Vec3::new(0.0, 0.05 * (18.85 * t).sin(), 4.0 * t)))),
    ];
    let seconds = if part.is_short() { 1.0 } else { 5.0 };
    let mut trials = Vec::new();
    for (name, motion) in motions {
        let motion = std::sync::Arc::new(motion);
        for kind in 0..2 {
            let motion = motion.clone();
            trials.push(Trial::new(format!("{name}, {}", KINDS[kind]), move || {
                let mut cape = in_air(sheet(kind, [0.6, 1.0], [12, 20], &POPLIN));
                hold(&mut cape, top(1.0));
                run(&mut cape, 0.5);
                let mut most = 0.0_f32;
                for tick in 1..=(seconds * 60.0) as u32 {
                    drive(&mut cape, motion(tick as f32 * TICK.dt), TICK);
                    most = most.max(strain(&cape));
                }
                let held = cape.particles.is_finite() && most < 2.0 * POPLIN.stretch_limit;
                Outcome::new(held, format!("strain {:.2} %, limit {:.0} %", 100.0 * most, 200.0 * POPLIN.stretch_limit))
            }));
        }
    }
    trials
}
