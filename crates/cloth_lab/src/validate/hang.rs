//! What hangs at rest: a strip by its top row, and one by both ends.

use cloth_solver::{Cloth, ClothError, Fabric, Method, Tick, measure};
use glam::{Quat, Vec3};

use super::closed;
use super::finding::{Bench, Bound, STATIC, budget};
use super::rig::{self, G, GRAVITY};

/// A fabric of 0.15 kg/m² with `stretch` N/m that comes to rest soon.
fn fabric(stretch: f32) -> Fabric {
    Fabric {
        areal_density: 0.15,
        stretch_warp: stretch,
        stretch_weft: stretch,
        bend_warp: 0.0,
        bend_weft: 0.0,
        damping: 3.0,
        ..Fabric::COTTON_POPLIN
    }
}

/// How long cloth of [`fabric`] is given to come to rest, s.
fn settling(bench: &Bench) -> f32 {
    if bench.quick { 8.0 } else { 20.0 }
}

/// A strip of 1 m under its own weight: elongation of the tip σgL²/(2Y), force in the top row its weight.
pub fn strip(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "hanging strip";
    const ROWS: u32 = 20;
    for method in bench.with_default(STATIC) {
        for stiffness in [50.0_f32, 500.0, 5000.0] {
            let mut cloth = rig::rectangle([0.2, 1.0], [4, ROWS], &fabric(stiffness), method)?;
            rig::hold(&mut cloth, |rest| rest.y > 0.499)?;
            rig::run(&mut cloth, budget(method), GRAVITY, settling(bench));
            let elongation = -0.5 - f64::from(rig::mean(&cloth, |rest| rest.y < -0.499).y);
            let weight = 0.15 * G;
            let expected = weight / (2.0 * f64::from(stiffness));
            let what = format!("elongation at Y = {stiffness} N/m, m");
            bench.at_rest(CHECK, what, method, elongation, expected, Bound::Relative(0.01));
            let force = top_force(&cloth, f64::from(stiffness));
            let below = weight * 0.2 * (1.0 - 0.5 / f64::from(ROWS));
            let what = format!("force in the top row at Y = {stiffness} N/m, N");
            // f32 tells a length of 0.5 m to 6e-8 m; a link of 0.05 m stretched by 3e-4 to half a percent.
            bench.at_rest(CHECK, what, method, force, below, Bound::Relative(0.01));
        }
    }
    Ok(())
}

/// Force in the warp edges of the top row, N.
fn top_force(cloth: &Cloth, stiffness: f64) -> f64 {
    let Some(grid) = cloth.topology.grid else { return f64::NAN };
    let at = |row, column| cloth.particles.position.get(grid.slot(row, column) as usize).as_dvec3();
    (0..grid.columns)
        .map(|column| {
            let share = if column == 0 || column == grid.columns - 1 { 0.5 } else { 1.0 };
            let width = share * f64::from(grid.spacing.x);
            stiffness * width * (at(0, column).distance(at(1, column)) / f64::from(grid.spacing.y) - 1.0)
        })
        .sum()
}

/// A strip of 1 m held by both ends: sag and horizontal force of the catenary.
pub fn chain(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "catenary";
    // Stiff enough to stretch by 3e-4 at most, soft enough for f32 to tell its strain.
    const STIFFNESS: f32 = 3000.0;
    const WIDTH: f32 = 0.025;
    for method in bench.with_default(STATIC) {
        for span in [0.5_f32, 0.8, 0.9] {
            let mut cloth = rig::rectangle([1.0, WIDTH], [40, 1], &fabric(STIFFNESS), method)?;
            // Two straight halves, level across.
            let depth = (0.25 - 0.25 * span * span).sqrt();
            rig::put(&mut cloth, |rest| Vec3::new(span * rest.x, -depth * (1.0 - 2.0 * rest.x.abs()), -rest.y));
            rig::hold(&mut cloth, |rest| rest.x.abs() > 0.499)?;
            rig::run(&mut cloth, budget(method), GRAVITY, settling(bench));
            let (mut sag, mut pull) = (0.0, 0.0);
            const SAMPLES: u32 = 120;
            for _ in 0..SAMPLES {
                cloth.step(budget(method), GRAVITY);
                sag -= f64::from(rig::mean(&cloth, |rest| rest.x.abs() < 1e-3).y) / f64::from(SAMPLES);
                pull += horizontal(&cloth, f64::from(STIFFNESS)) / f64::from(SAMPLES);
            }
            let (depth, force) = closed::catenary(f64::from(span));
            let what = format!("sag over length at a span of {span}");
            bench.at_rest(CHECK, what, method, sag, depth, Bound::Relative(0.01));
            let what = format!("horizontal force over weight at a span of {span}");
            let weight = 0.15 * G * f64::from(WIDTH);
            bench.at_rest(CHECK, what, method, pull / weight, force, Bound::Relative(0.01));
        }
    }
    Ok(())
}

/// Mean over the columns of the horizontal part of the force in the weft edges, N.
fn horizontal(cloth: &Cloth, stiffness: f64) -> f64 {
    let Some(grid) = cloth.topology.grid else { return f64::NAN };
    let width = 0.5 * f64::from(grid.spacing.y);
    let along = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|slot| cloth.particles.position.get(slot as usize).as_dvec3());
        (b.x - a.x).abs() / a.distance(b)
    };
    let weft = |[a, b]: &[u32; 2]| a.abs_diff(*b) == 1;
    let total: f64 = measure::edge_strains(&cloth.topology, &cloth.particles)
        .filter(|(edge, _)| weft(edge))
        .map(|(edge, strain)| stiffness * width * f64::from(strain) * along(edge))
        .sum();
    total / f64::from(grid.columns - 1)
}

/// Mesh and step independence: where the middle of the lower edge of a sheet comes to rest that hangs by two corners
/// brought nearer to each other.
pub fn refined(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "mesh and step independence";
    let seconds = if bench.quick { 6.0 } else { 12.0 };
    for method in bench.with_default(&[Method::XpbdSweeps, Method::Pbd]) {
        let tip = |cells: u32, substeps: u32| -> Result<f64, ClothError> {
            let fabric = Fabric { damping: 3.0, ..Fabric::COTTON_POPLIN };
            let mut cloth = rig::rectangle([1.0, 1.0], [cells, cells], &fabric, method)?;
            let bulge = |x: f32| 0.25 * (core::f32::consts::PI * x).cos();
            rig::put(&mut cloth, |rest| Vec3::new(0.8 * rest.x, rest.y, bulge(rest.x)));
            rig::hold(&mut cloth, |rest| rest.y > 0.499 && rest.x.abs() > 0.499)?;
            let tick = Tick { substeps, ..budget(method) };
            rig::settle(&mut cloth, tick, GRAVITY, seconds);
            Ok(f64::from(rig::mean(&cloth, |rest| rest.y < -0.499 && rest.x.abs() < 1e-3).y))
        };
        let spread = |places: &[f64]| {
            let (low, high) =
                places.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
            if places.iter().all(|p| p.is_finite()) { high - low } else { f64::INFINITY }
        };
        let cells: &[u32] = if bench.quick { &[10, 20] } else { &[10, 20, 40] };
        let meshes = cells.iter().map(|cells| tip(*cells, budget(method).substeps)).collect::<Result<Vec<_>, _>>()?;
        let steps = [5, 10, 20, 40].map(|substeps| tip(20, substeps)).into_iter().collect::<Result<Vec<_>, _>>()?;
        let what = format!("spread of the lower edge's place over {cells:?} cells a side, m");
        bench.at_rest(CHECK, what, method, spread(&meshes), 0.02, Bound::AtMost);
        let what = "spread of the lower edge's place over 5, 10, 20, 40 substeps, m";
        bench.at_rest(CHECK, what, method, spread(&steps), 0.02, Bound::AtMost);
    }
    Ok(())
}

/// Turns a cloth that stands upright to lie level, its face up.
pub fn level(rest: Vec3) -> Vec3 {
    Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2) * rest
}
