//! One method at one setting on one case: how long it takes, how far off it is.

use std::time::Instant;

use cloth_scene::World;
use cloth_solver::{Cloth, Method, measure};
use glam::DVec3;

use super::case::{Case, Judged};
use super::record::{Difference, Record};
use super::truth::Truth;

/// Ticks that are not timed at the start of a run.
const WARM_UP: usize = 3;
/// Speed above which a run has diverged, m/s.
const DIVERGED: f32 = 1e4;

/// Substeps in a tick and iterations in a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Substeps, at least 1.
    pub substeps: u32,
    /// Iterations, at least 1.
    pub iterations: u32,
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}×{}", self.substeps, self.iterations)
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// It ran to its end; how far off it was.
    Ok(Difference),
    /// It became faster than 10 km/s or was no longer finite.
    Diverged,
    /// It would have taken longer than a point may take.
    TooSlow,
    /// The method cannot do it.
    Unsupported,
}

impl Outcome {
    /// As a word.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ok(_) => "ok",
            Self::Diverged => "diverged",
            Self::TooSlow => "too slow",
            Self::Unsupported => "unsupported",
        }
    }

    /// The difference, if there is one.
    pub fn difference(&self) -> Option<&Difference> {
        if let Self::Ok(difference) = self { Some(difference) } else { None }
    }
}

/// One point of the chart.
#[derive(Clone, Debug)]
pub struct Point {
    /// The case.
    pub case: &'static str,
    /// The method.
    pub method: Method,
    /// Substeps and iterations.
    pub setting: Setting,
    /// CPU time of a simulated second on one core, s: median over the ticks.
    pub median: f64,
    /// The same of the fastest tick.
    pub minimum: f64,
    /// Number of ticks timed.
    pub timed: usize,
    /// Time of one solve of one constraint, ns.
    pub per_constraint: f64,
    /// How it ended.
    pub outcome: Outcome,
}

/// The settings a method is charted at.
pub fn settings(method: Method, quick: bool) -> Vec<Setting> {
    let of = |pairs: &[(u32, u32)]| {
        pairs.iter().map(|&(substeps, iterations)| Setting { substeps, iterations }).collect::<Vec<_>>()
    };
    let all = match method {
        Method::ExplicitEuler | Method::SymplecticEuler | Method::StormerVerlet | Method::RungeKutta4 => {
            of(&[(64, 1), (128, 1), (192, 1), (256, 1), (384, 1), (512, 1), (1024, 1), (2048, 1)])
        }
        Method::Pbd => of(&[(1, 1), (1, 5), (1, 20), (1, 80), (5, 1), (5, 4), (20, 1), (40, 1)]),
        Method::XpbdSweeps => of(&[(1, 1), (1, 20), (5, 1), (10, 1), (20, 1), (40, 1), (10, 4), (40, 4), (160, 1)]),
        Method::XpbdLines => of(&[(1, 1), (2, 1), (5, 1), (10, 1), (20, 1), (40, 1), (80, 1)]),
    };
    let all = if method.iterates() { all } else { all.into_iter().filter(|setting| setting.iterations == 1).collect() };
    if quick { all.into_iter().step_by(2).collect() } else { all }
}

/// The positions of a rectangle's particles, row by row, m.
pub fn positions(cloth: &Cloth) -> Vec<DVec3> {
    cloth.topology.particles().map(|slot| cloth.particles.position.get(slot as usize).as_dvec3()).collect()
}

/// Puts a rectangle's particles at `x` (m, row by row), at rest. Pinned ones stay.
pub fn place(cloth: &mut Cloth, x: &[DVec3]) {
    for (slot, x) in cloth.topology.particles().zip(x) {
        let slot = slot as usize;
        if cloth.particles.inverse_mass[slot] > 0.0 {
            cloth.particles.position.set(slot, x.as_vec3());
            cloth.particles.previous.set(slot, x.as_vec3());
        }
    }
}

/// Whether a cloth is no longer finite or faster than `speed`, m/s.
pub fn is_lost(cloth: &Cloth, speed: f32) -> bool {
    let v = &cloth.particles.velocity;
    !cloth.particles.is_finite() || (0..v.len()).any(|i| v.get(i).length_squared() > speed * speed)
}

/// Plays a case by `method` at `setting` and compares it with `truth`. A run that would take longer than `limit` seconds
/// is given up.
pub fn run(case: &Case, truth: &Truth, method: Method, setting: Setting, limit: f64) -> Point {
    let mut point = Point {
        case: case.name,
        method,
        setting,
        median: f64::NAN,
        minimum: f64::NAN,
        timed: 0,
        per_constraint: f64::NAN,
        outcome: Outcome::Unsupported,
    };
    let scene =
        cloth_scene::Scene { method, substeps: setting.substeps, iterations: setting.iterations, ..case.scene.clone() };
    let Ok(mut world) = World::new(&scene) else { return point };
    let Ok(fabric) = scene.cloths[0].fabric() else { return point };
    if let Some(start) = &truth.start {
        place(&mut world.cloths[0], start);
    }
    let gravity = world.frames[0].rotation.conjugate() * scene.gravity;
    let energy = |cloth: &Cloth| {
        measure::kinetic_energy(&cloth.particles)
            + measure::gravitational_energy(&cloth.particles, gravity)
            + measure::elastic_energy(&cloth.topology, &cloth.particles, &fabric)
    };
    let tip = world.cloths[0].topology.grid.map_or(0, |grid| grid.slot(grid.rows - 1, (grid.columns - 1) / 2)) as usize;
    let mut record = Record { energy: vec![energy(&world.cloths[0])], ..Record::default() };
    let (mut times, ticks, began) = (Vec::with_capacity(case.ticks()), case.ticks(), Instant::now());
    let mut outcome = None;
    for tick in 1..=ticks {
        let start = Instant::now();
        world.tick();
        times.push(start.elapsed().as_secs_f64());
        let cloth = &world.cloths[0];
        if is_lost(cloth, DIVERGED) {
            outcome = Some(Outcome::Diverged);
            break;
        }
        record.strain.push(f64::from(measure::largest_strain(&cloth.topology, &cloth.particles)));
        record.tip.push(f64::from(cloth.particles.position.get(tip).z));
        if case.judged != Judged::Rest {
            record.energy.push(energy(cloth));
        }
        if tick == truth.until {
            record.shape = positions(cloth);
        }
        if tick > WARM_UP && began.elapsed().as_secs_f64() / tick as f64 * ticks as f64 > limit {
            outcome = Some(Outcome::TooSlow);
            break;
        }
    }
    let warm = WARM_UP.min(times.len().saturating_sub(1));
    let timed = &mut times[warm..];
    timed.sort_by(f64::total_cmp);
    let rate = f64::from(scene.rate);
    let solves = world.cloths[0].constraints.count() as f64 * f64::from(setting.substeps * setting.iterations);
    point.timed = timed.len();
    point.minimum = timed[0] * rate;
    point.median = timed[timed.len() / 2] * rate;
    point.per_constraint = 1e9 * timed[timed.len() / 2] / solves;
    point.outcome =
        outcome.unwrap_or_else(|| Outcome::Ok(record.against(&truth.record, case, truth.until, truth.rest_energy)));
    point
}
