//! From a flat start to rest: how long it takes, and how far from the reference's rest that is.

use std::time::Instant;

use cloth_scene::World;
use cloth_solver::{Method, measure};
use glam::DVec3;

use super::case::Case;
use super::run::{Setting, is_lost, place, positions};
use super::truth::Truth;

/// Root mean square speed below which a cloth is at rest, m/s.
const REST: f32 = 0.03;
/// How long it has to stay below, in ticks: half a second.
const LAST: usize = 30;
/// How long rest is waited for, s.
const SECONDS: f32 = 20.0;
/// How far out of its plane it starts, m: what is quite flat folds by rounding alone.
const BULGE: f64 = 1e-3;

/// The substeps in a tick that are tried.
pub const SUBSTEPS: [u32; 3] = [5, 10, 20];

/// How a method came to rest.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The case.
    pub case: &'static str,
    /// The method.
    pub method: Method,
    /// Substeps and iterations.
    pub setting: Setting,
    /// When it came to rest, s; `None` if it did not, or would have taken longer than a run may take.
    pub time: Option<f64>,
    /// Difference of its largest strain from the reference's at rest.
    pub strain_error: f64,
    /// Root mean square distance of the particles from the reference's rest, mm; folds may lie another way.
    pub shape_rms: f64,
}

/// Plays a case from flat until it has been at rest for half a second, 20 s at most and no longer than `limit` seconds of
/// computing.
pub fn settle(case: &Case, truth: &Truth, method: Method, substeps: u32, limit: f64) -> Option<Settled> {
    let setting = Setting { substeps, iterations: 1 };
    let scene = cloth_scene::Scene { method, substeps, iterations: 1, ..case.scene.clone() };
    let mut world = World::new(&scene).ok()?;
    let flat = positions(&world.cloths[0]);
    let bulge = |p: &DVec3| *p + DVec3::Z * (BULGE * (5.0 * p.x + 0.4).sin() * (4.0 * p.y + 0.3).cos());
    place(&mut world.cloths[0], &flat.iter().map(bulge).collect::<Vec<_>>());
    let (began, ticks) = (Instant::now(), (SECONDS * scene.rate) as usize);
    let mut quiet = 0;
    let mut time = None;
    for tick in 1..=ticks {
        world.tick();
        let cloth = &world.cloths[0];
        // A speed that is no number is not below either.
        quiet = if measure::rms_speed(&cloth.topology, &cloth.particles) < REST { quiet + 1 } else { 0 };
        if quiet == LAST {
            time = Some((tick - LAST) as f64 / f64::from(scene.rate));
            break;
        }
        if is_lost(cloth, f32::MAX.sqrt()) || began.elapsed().as_secs_f64() > limit {
            break;
        }
    }
    let cloth = &world.cloths[0];
    let strain = f64::from(measure::largest_strain(&cloth.topology, &cloth.particles));
    let there = positions(cloth);
    let squares = there.iter().zip(&truth.record.shape).map(|(a, b)| a.distance_squared(*b)).sum::<f64>();
    Some(Settled {
        case: case.name,
        method,
        setting,
        time,
        strain_error: (strain - truth.record.strain_of(case, truth.until)).abs(),
        shape_rms: 1e3 * (squares / there.len().max(1) as f64).sqrt(),
    })
}
