//! Steps, stiffness, masses, weights and lengths beyond what they should be.

use cloth_solver::{Fabric, Method, Tick};
use glam::{UVec2, Vec2};

use super::sheet::{KINDS, corners, fastest, hold, in_air, rms, sheet, strain};
use super::{Outcome, Part, Row, Trial};
use crate::stability::{self, Subject, Verdict};
use crate::validate::rig::GRAVITY;

/// Substeps of the default budget.
const SUBSTEPS: u32 = 10;
/// Ticks of a trial against the reference's rest.
const TICKS: u64 = 90;
/// Longest time to compute for one, s: never reached.
const WALL: f64 = 1e3;

/// Rows 1 to 5.
pub fn rows(part: Part) -> Vec<Row> {
    let row = |number, scene, must, trials| Row { number, scene, must, trials };
    vec![
        row(1, "methods that step forces, at 0.95 and 1.05 of their limit", "hold below, explode above", edges(part)),
        row(
            2,
            "stretch of 10²…10⁸ N/m in 30, 60, 144 Hz and 1, 5, 10 substeps",
            "finite, below 20 m/s after 2 s, stretch falls as stiffness grows",
            stiffness(part),
        ),
        row(
            3,
            "50 × 50 particles of 1 kg…0.1 g in all",
            "finite, slower in the third second than in the second",
            masses(part),
        ),
        row(
            4,
            "1…10⁴ particle masses on a free corner",
            "strain within 1 % of the reference's up to 10³, finite beyond",
            weights(part),
        ),
        row(5, "strips and sheets of 10, 100, 1000 links", "strain within 1 % of the reference's", links(part)),
    ]
}

fn edges(part: Part) -> Vec<Trial> {
    let methods = [Method::SymplecticEuler, Method::StormerVerlet, Method::RungeKutta4];
    let trial = |method: Method| {
        Trial::new(method.name(), move || {
            let checks = stability::checks(&[method]);
            let held = checks.iter().all(|check| check.verdicts == [Verdict::Survived, Verdict::Exploded]);
            let told: Vec<String> = checks
                .iter()
                .map(|check| format!("{}: {}", check.subject, check.verdicts.map(Verdict::name).join(", ")))
                .collect();
            Outcome::new(held && !checks.is_empty(), told.join("; "))
        })
    };
    part.sweep(&methods).into_iter().map(trial).collect()
}

fn stiffness(part: Part) -> Vec<Trial> {
    let rates = part.sweep(&[30.0_f32, 60.0, 144.0]);
    let counts = part.sweep(&[1_u32, 5, 10]);
    let pairs = rates.iter().flat_map(|rate| counts.iter().map(|count| (*rate, *count))).collect::<Vec<_>>();
    let trial = |(rate, substeps): (f32, u32)| {
        Trial::new(format!("{rate} Hz, {substeps} substeps"), move || {
            let (mut fast, mut strains) = (0.0_f32, Vec::new());
            for power in 2..=8 {
                let stretch = 10.0_f32.powi(power);
                let fabric = Fabric { stretch_warp: stretch, stretch_weft: stretch, ..Fabric::COTTON_POPLIN };
                let mut cloth = in_air(sheet(0, [1.0; 2], [16; 2], &fabric));
                hold(&mut cloth, corners([1.0; 2]));
                for tick in 0..(4.0 * rate) as u32 {
                    cloth.step(Tick::fixed(1.0 / rate, substeps), GRAVITY);
                    let now = fastest(&cloth);
                    if tick as f32 > 2.0 * rate && (now > fast || now.is_nan()) {
                        fast = now;
                    }
                }
                strains.push(strain(&cloth));
            }
            // Sheets that hardly stretch are not at rest to the last digit.
            let falls = strains.windows(2).all(|pair| pair[1] <= pair[0].max(0.02));
            let [soft, stiff] = [strains[0], strains[strains.len() - 1]];
            Outcome::new(
                fast < 20.0 && falls,
                format!("{fast:.2} m/s; strains {:.1} … {:.2} %", 100.0 * soft, 100.0 * stiff),
            )
        })
    };
    pairs.into_iter().map(trial).collect()
}

fn masses(part: Part) -> Vec<Trial> {
    let cells = if part.is_short() { 20 } else { 49 };
    let trial = move |(kind, mass): (usize, f32)| {
        Trial::new(format!("{}, {mass} kg", KINDS[kind]), move || {
            let fabric = Fabric { areal_density: mass, ..Fabric::COTTON_POPLIN };
            let mut cloth = in_air(sheet(kind, [1.0; 2], [cells; 2], &fabric));
            hold(&mut cloth, corners([1.0; 2]));
            let mut speeds = [0.0_f32; 3];
            for speed in &mut speeds {
                for _ in 0..60 {
                    cloth.step(Tick::new(1.0 / 60.0), GRAVITY);
                    *speed = speed.max(rms(&cloth));
                }
            }
            let held = cloth.particles.is_finite() && speeds[2] <= speeds[1].max(0.03);
            Outcome::new(held, format!("rms {:.3}, {:.3}, {:.3} m/s in each second", speeds[0], speeds[1], speeds[2]))
        })
    };
    let masses = part.sweep(&[1.0, 0.1, 1e-2, 1e-3, 1e-4]);
    (0..2).flat_map(|kind| masses.iter().map(move |mass| (kind, *mass))).map(trial).collect()
}

fn weights(part: Part) -> Vec<Trial> {
    let trial = |ratio: f32| {
        Trial::new(format!("{ratio} masses"), move || {
            let subject = Subject::weighted(12, ratio);
            let seen = stability::play(&subject.substeps(Method::default(), 1, SUBSTEPS, TICKS), WALL);
            let held = match seen.verdict() {
                Verdict::Survived => true,
                Verdict::Inaccurate => ratio > 1e3,
                Verdict::Exploded => false,
            };
            Outcome::new(held, format!("strain off by {:.2} %", 100.0 * seen.strain_error))
        })
    };
    part.sweep(&[1.0, 10.0, 1e2, 1e3, 1e4]).into_iter().map(trial).collect()
}

fn links(part: Part) -> Vec<Trial> {
    let stretch = Fabric::COTTON_POPLIN.stretch_warp;
    let trial = |(is_strip, count): (bool, u32)| {
        let name = if is_strip { "strip" } else { "sheet" };
        Trial::new(format!("{name}, {count} links"), move || {
            let subject = if is_strip {
                Subject::swing(Vec2::new(1.0 / count as f32, 1.0), UVec2::new(1, count), stretch)
            } else {
                Subject::swing(Vec2::ONE, UVec2::splat(count), stretch)
            };
            let seen = stability::play(&subject.substeps(Method::default(), 1, SUBSTEPS, TICKS), WALL);
            Outcome::new(
                seen.verdict() == Verdict::Survived,
                format!("strain off by {:.3} %", 100.0 * seen.strain_error),
            )
        })
    };
    let (strips, sheets) =
        (part.sweep(&[10, 100, 1000]), if part.is_short() { vec![10, 20] } else { vec![10, 32, 100] });
    strips
        .into_iter()
        .map(|count| (true, count))
        .chain(sheets.into_iter().map(|count| (false, count)))
        .map(trial)
        .collect()
}
