//! What changes at run time, and what it costs: a grab, contacts, cuts.

use std::time::Instant;

use cloth_scene::World;
use cloth_solver::constraint::Grab;
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::damage::Blade;
use cloth_solver::{Cloth, Method, Motion, Pose};
use glam::{Quat, Vec3};

use super::case::Case;
use super::run::{Setting, place};
use super::truth::Truth;

/// Ticks before anything is timed, and ticks timed.
const TICKS: usize = 30;
/// Edge of the box behind the sheet, m: it touches 500 of 64 × 64 particles.
const BOX: f32 = 0.352;
/// Gravity towards that box, m/s².
const PRESS: f32 = 5.0;
/// Stiffness, N/m, and greatest force, N, of the hand.
const HAND: (f32, f32) = (500.0, 20.0);

/// The cost of a change to a cloth that hangs quietly.
#[derive(Clone, Debug)]
pub struct Cost {
    /// The method.
    pub method: Method,
    /// Substeps and iterations.
    pub setting: Setting,
    /// What is changed.
    pub change: &'static str,
    /// Median time of a quiet tick, s.
    pub quiet: f64,
    /// Median time of the first tick with the change, s; `None` where the method has exploded.
    pub first: Option<f64>,
    /// Median time of the ticks after it, s.
    pub later: Option<f64>,
    /// Contacts in the last of those.
    pub contacts: u32,
}

/// Rows that a slit goes through: it crosses a weft and a diagonal edge in each.
const SLIT: u32 = 50;

/// How often the first tick with a change is timed.
const TRIALS: usize = 9;

/// What is timed.
pub const CHANGES: [&str; 4] = ["one grab", "500 contacts", "a slit through 100 edges", "two slits at once"];

/// The setting at which a method is timed.
pub fn setting(method: Method) -> Setting {
    let (substeps, iterations) = match method {
        Method::ExplicitEuler | Method::SymplecticEuler | Method::StormerVerlet | Method::RungeKutta4 => (512, 1),
        _ => (10, 1),
    };
    Setting { substeps, iterations }
}

/// Times every change on the hanging sheet of `case`.
pub fn costs(case: &Case, truth: &Truth, method: Method) -> Vec<Cost> {
    CHANGES.iter().map(|change| cost(case, truth, method, change)).collect()
}

fn cost(case: &Case, truth: &Truth, method: Method, change: &'static str) -> Cost {
    let setting = setting(method);
    let mut cost = Cost { method, setting, change, quiet: f64::NAN, first: None, later: None, contacts: 0 };
    let scene =
        cloth_scene::Scene { method, substeps: setting.substeps, iterations: setting.iterations, ..case.scene.clone() };
    let Ok(mut world) = World::new(&scene) else { return cost };
    if let Some(start) = &truth.start {
        place(&mut world.cloths[0], start);
    }
    (0..TICKS).for_each(|_| world.tick());
    if !world.cloths[0].particles.is_finite() {
        return cost;
    }
    cost.quiet = median(&mut world);
    if change == CHANGES[1] {
        world.scene.gravity.z -= PRESS;
    }
    let quiet = world.clone();
    let mut first = Vec::new();
    for _ in 0..TRIALS {
        world = quiet.clone();
        let start = Instant::now();
        if apply(&mut world.cloths[0], change).is_none() {
            return cost;
        }
        world.tick();
        first.push(start.elapsed().as_secs_f64());
    }
    cost.first = Some(middle(first));
    cost.later = Some(median(&mut world));
    cost.contacts = world.cloths[0].contacts.touching;
    cost
}

/// Changes the cloth; `None` where there is nothing to change.
fn apply(cloth: &mut Cloth, change: &str) -> Option<()> {
    let middle = cloth.topology.triangles.len() / 2 + cloth.topology.grid?.columns as usize;
    let particles = *cloth.topology.triangles.get(middle)?;
    match change {
        "one grab" => {
            let held = particles.map(|slot| cloth.particles.position.get(slot as usize));
            let at = held.iter().sum::<Vec3>() / 3.0 + 0.02 * Vec3::Z;
            let (stiffness, max_force) = HAND;
            let weights = [1.0 / 3.0; 3];
            cloth.constraints.grabs.push(Grab { particles, weights, from: at, to: at, stiffness, max_force });
        }
        "500 contacts" => {
            let pose = Pose::new(Vec3::NEG_Z * (BOX / 2.0 + 0.5 * cloth.contacts.offset), Quat::IDENTITY);
            let shape = Shape::cuboid(Vec3::splat(BOX)).ok()?;
            cloth.contacts.colliders.push(Collider { shape, motion: Motion::at_rest(pose), friction: 0.3 });
        }
        // From the lower edge up.
        _ => {
            let grid = cloth.topology.grid?;
            let topology = cloth.topology.clone();
            let at = |column: u32, row: u32| topology.rest[grid.slot(row, column) as usize];
            let slits = if change == CHANGES[3] { 2 } else { 1 };
            for column in [grid.columns / 2, grid.columns / 4].into_iter().take(slits) {
                let x = 0.5 * (at(column, 0).x + at(column + 1, 0).x);
                // In a sheet of fewer rows through all but the first.
                let end = (grid.rows - 1).saturating_sub(SLIT).max(1);
                let (low, high) = (at(0, grid.rows - 1).y - 1.0, at(0, end).y);
                let ray = |y: f32| [Vec3::new(x, y, 10.0), Vec3::new(x, y, -10.0)];
                cloth.cut(&Blade { from: ray(low), to: ray(high) })?;
            }
        }
    }
    Some(())
}

fn timed(world: &mut World) -> f64 {
    let start = Instant::now();
    world.tick();
    start.elapsed().as_secs_f64()
}

fn median(world: &mut World) -> f64 {
    middle((0..TICKS).map(|_| timed(world)).collect())
}

fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
