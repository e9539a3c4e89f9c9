//! What takes long: torn to pieces, an hour of ticks, the monkey.

use cloth_solver::contact::Shape;
use cloth_solver::damage::Direction;
use cloth_solver::forces::WindField;
use cloth_solver::{Cloth, Fabric};
use glam::{Quat, Vec3};

use super::sheet::{
    KINDS, TICK, corners, crossings, farthest, ground, hash, hold, in_air, keep_off_itself, positions, run, sheet,
    solid, strain, top,
};
use super::{Outcome, Part, Row, Trial};
use crate::stability::monkey::{self, EPISODE, Episode, Plan, Tool};
use crate::stability::random::Random;
use crate::validate::hang::level;
use crate::validate::rig::{self, GRAVITY};

const POPLIN: Fabric = Fabric::COTTON_POPLIN;
/// Simulated time of the soak, s.
const HOUR: u64 = 3600;
/// Ticks of the monkey.
const MONKEY: u64 = 100_000;
/// After so long a cloth that hangs or lies has come to rest, s.
const SETTLED: f32 = 30.0;
/// How far it may drift from there, m.
const DRIFT: f32 = 1e-3;

/// Rows 20, 23 and 24.
pub fn rows(part: Part, seed: u64) -> Vec<Row> {
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(
            20,
            "torn particle by particle until nothing holds together",
            "finite, mass kept, below 30 m/s",
            torn(part),
        ),
        row(
            23,
            "an hour of ticks, awake; the first minute twice, on two threads",
            "finite, what is at rest drifts less than 1 mm, no strain above the fabric's limit, no crossing, bit-equal",
            soaks(part),
        ),
        row(
            24,
            "cut, torn, pulled, blown at, lit and hit by a seeded monkey for 10⁵ ticks",
            "finite, mass and pins kept, no particle above 3 × what drives it",
            monkeys(part, seed),
        ),
    ]
}

fn torn(part: Part) -> Vec<Trial> {
    let trial = |seed: u64| {
        Trial::new(format!("seed {seed}, {}", KINDS[seed as usize % 2]), move || {
            let mut random = Random::new(seed);
            let mut cloth = in_air(sheet(seed as usize % 2, [0.4; 2], [8; 2], &POPLIN));
            hold(&mut cloth, top(0.4));
            cloth.contacts.set_colliders([ground(-1.0)]);
            let mass = |cloth: &Cloth| cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum::<f64>();
            let (first, mut fast, mut tears) = (mass(&cloth), 0.0_f32, 0);
            for _ in 0..300 {
                for _ in 0..3 {
                    let particles: Vec<u32> = cloth.topology.particles().collect();
                    let particle = particles[random.below(particles.len())];
                    let pull = [Direction::Warp, Direction::Weft][random.below(2)];
                    tears += usize::from(cloth.tear_at(particle, pull).is_some());
                }
                cloth.step(TICK, GRAVITY);
                fast = fast.max(super::sheet::fastest(&cloth));
            }
            let pieces = cloth.topology.pieces().triangles.len();
            let held = cloth.particles.is_finite() && (mass(&cloth) / first - 1.0).abs() < 1e-5 && fast < 30.0;
            Outcome::new(held, format!("{tears} tears, {pieces} pieces, {fast:.1} m/s"))
        })
    };
    (0..part.of(10, 2)).map(trial).collect()
}

const SOAKS: [&str; 6] =
    ["hung grid", "hung mesh", "draped on a ball", "lies folded", "flag in 6 m/s", "by two corners"];

fn soaked(name: &str) -> Cloth {
    let mut cloth = match name {
        "hung grid" | "by two corners" => in_air(sheet(0, [0.5; 2], [12; 2], &POPLIN)),
        "hung mesh" => in_air(sheet(1, [0.5; 2], [10; 2], &POPLIN)),
        "flag in 6 m/s" => in_air(sheet(0, [0.45, 0.3], [15, 10], &POPLIN)),
        _ => in_air(sheet(0, [0.5; 2], [12; 2], &Fabric::TERRY_TOWEL)),
    };
    match name {
        "hung grid" | "hung mesh" => hold(&mut cloth, top(0.5)),
        "by two corners" => hold(&mut cloth, corners([0.5; 2])),
        "flag in 6 m/s" => {
            hold(&mut cloth, |rest| rest.x < -0.2249);
            cloth.wind = WindField::uniform(Vec3::new(6.0, 0.0, 0.6));
        }
        "draped on a ball" => {
            rig::put(&mut cloth, |rest| level(rest) + Vec3::new(0.01, 0.3, 0.01));
            cloth.contacts.set_colliders([solid(Shape::sphere(0.25), Vec3::ZERO, Quat::IDENTITY), ground(-0.25)]);
        }
        _ => {
            rig::put(&mut cloth, |rest| Quat::from_rotation_x(0.2) * rest + Vec3::Y * 0.4);
            cloth.contacts.set_colliders([ground(0.0)]);
            keep_off_itself(&mut cloth, &Fabric::TERRY_TOWEL);
        }
    }
    cloth
}

fn soaks(part: Part) -> Vec<Trial> {
    let seconds = part.of_time(HOUR, 60) as f32;
    let trial = move |name: &'static str| {
        Trial::new(format!("{name}, {seconds} s"), move || {
            let minute = || {
                let mut cloth = soaked(name);
                run(&mut cloth, SETTLED);
                let settled = positions(&cloth);
                run(&mut cloth, 60.0 - SETTLED);
                (cloth, settled)
            };
            let second = std::thread::spawn(move || hash(&minute().0));
            let (mut cloth, settled) = minute();
            let equal = second.join().is_ok_and(|second| second == hash(&cloth));
            let (mut worst, mut most) = (0, strain(&cloth));
            for _ in 1..(seconds / 60.0) as u32 {
                run(&mut cloth, 60.0);
                (worst, most) = (worst.max(crossings(&cloth)), most.max(strain(&cloth)));
            }
            // In wind, and without self-contact, neither says anything.
            let worst = if cloth.self_contacts.is_some() { worst } else { 0 };
            let drift = if name.starts_with("flag") { 0.0 } else { farthest(&settled, &positions(&cloth)) };
            let limit = POPLIN.stretch_limit;
            let held = cloth.particles.is_finite() && equal && drift < DRIFT && most < limit && worst == 0;
            let twice = if equal { "bit-equal" } else { "not bit-equal" };
            Outcome::new(held, format!("drift {:.3} mm, strain {:.2} %, {twice}", 1e3 * drift, 100.0 * most))
        })
    };
    SOAKS.into_iter().map(trial).collect()
}

fn monkeys(part: Part, seed: u64) -> Vec<Trial> {
    let ticks = part.of_time(MONKEY, 2 * u64::from(EPISODE));
    let trial = |number: u64| {
        let seed = seed.wrapping_add(number);
        let ticks = (ticks - number * u64::from(EPISODE)).min(u64::from(EPISODE)) as u32;
        Trial::new(format!("seed {seed}, {ticks} ticks"), move || {
            let plan = Plan::new(seed, ticks, &Tool::ALL);
            let seen = monkey::play(&plan);
            let told = match seen.fault {
                None => format!("{:.1} m/s, {:.2} × its drive", seen.speed, seen.ratio),
                Some((fault, tick)) => format!(
                    "{fault:?} after tick {tick}, {:.1} m/s, {:.2} × its drive; `--monkey {ticks} --seed {seed}`",
                    seen.speed, seen.ratio
                ),
            };
            let held = seen.fault.is_none();
            Outcome { episode: Some(Box::new(Episode { seed, plan, seen })), ..Outcome::new(held, told) }
        })
    };
    (0..ticks.div_ceil(u64::from(EPISODE))).map(trial).collect()
}
