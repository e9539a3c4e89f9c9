//! A strip clamped level at one end, under its own weight: the heavy elastica.

use cloth_solver::{Cloth, ClothError, Fabric, Method};
use glam::Vec3;

use super::closed;
use super::finding::{Bench, Bound, STATIC, budget};
use super::hang::level;
use super::rig::{self, G, GRAVITY};
use crate::plot::{Axis, Figure, Look, Panel, Series, Stroke};

/// Length of the strip with its clamp, m.
const LENGTH: f32 = 0.2;

/// Areal density, kg/m².
const DENSITY: f32 = 0.15;

/// How the strip is meshed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mesh {
    /// A rectangle of that many cells.
    Grid(u32),
    /// Triangles between lines at 45° to the strip, about as many.
    Turned(u32),
}

impl Mesh {
    fn name(self) -> String {
        match self {
            Self::Grid(cells) => format!("{cells} cells"),
            Self::Turned(cells) => format!("mesh turned by 45°, {cells} rows"),
        }
    }

    /// Where the clamp of two columns ends, in columns: where they end, but for the rows of a rectangle, which bend at their
    /// particles, half a column to either side.
    fn clamp(self) -> f32 {
        match self {
            Self::Grid(_) => 0.5,
            Self::Turned(_) => 1.0,
        }
    }

    /// Distance between two columns of particles, m.
    fn column(self) -> f32 {
        match self {
            Self::Grid(cells) | Self::Turned(cells) => LENGTH / cells as f32,
        }
    }
}

/// A strip clamped at x = −L/2, free from the end of the clamp on; Γ is that of its free length.
fn clamped(mesh: Mesh, gamma: f64, method: Method) -> Result<Cloth, ClothError> {
    let column = mesh.column();
    let bend = (f64::from(DENSITY) * G * f64::from(LENGTH - mesh.clamp() * column).powi(3) / gamma) as f32;
    let fabric =
        Fabric { areal_density: DENSITY, bend_warp: bend, bend_weft: bend, damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = match mesh {
        Mesh::Grid(cells) => rig::rectangle([LENGTH, 4.0 * column], [cells, 4], &fabric, method)?,
        Mesh::Turned(cells) => {
            let (positions, triangles) = turned(cells, 8);
            rig::mesh(&positions, &triangles, &fabric, method)?
        }
    };
    // Let go from the known answer: where it is not the method's own, it leaves.
    let held = |rest: Vec3| rest.x < -0.5 * LENGTH + 1.5 * column;
    let (clamp, free) = (-0.5 * LENGTH + mesh.clamp() * column, LENGTH - mesh.clamp() * column);
    let curve = closed::elastica_curve(gamma);
    rig::put(&mut cloth, |rest| {
        if held(rest) {
            return level(rest);
        }
        let part = f64::from((rest.x - clamp) / free) * (curve.len() - 1) as f64;
        let [drop, reach] = curve[(part.round() as usize).min(curve.len() - 1)];
        Vec3::new(clamp + free * reach as f32, -free * drop as f32, level(rest).z)
    });
    rig::hold(&mut cloth, held)?;
    Ok(cloth)
}

/// A strip in the xy plane over the points (i, j) of a square lattice with i + j even: diamonds, each cut in two, and
/// halves of diamonds at the border.
fn turned(columns: u32, rows: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let step = LENGTH / columns as f32;
    let mut index = vec![u32::MAX; ((columns + 1) * (rows + 1)) as usize];
    let mut positions = Vec::new();
    let place = |i: i64, j: i64| (j * i64::from(columns + 1) + i) as usize;
    for j in 0..=i64::from(rows) {
        for i in (0..=i64::from(columns)).filter(|i| (i + j) % 2 == 0) {
            index[place(i, j)] = positions.len() as u32;
            positions.push(Vec3::new(i as f32 * step - 0.5 * LENGTH, (j as f32 - 0.5 * rows as f32) * step, 0.0));
        }
    }
    let at = |i: i64, j: i64| {
        let inside = (0..=i64::from(columns)).contains(&i) && (0..=i64::from(rows)).contains(&j);
        inside.then(|| index[place(i, j)])
    };
    let mut triangles = Vec::new();
    for j in 0..=i64::from(rows) {
        for i in (0..=i64::from(columns)).filter(|i| (i + j) % 2 == 1) {
            match [at(i - 1, j), at(i, j - 1), at(i + 1, j), at(i, j + 1)] {
                // Cut across and along in turn, so that no direction is preferred.
                [Some(left), Some(below), Some(right), Some(above)] if (i - j).rem_euclid(4) == 1 => {
                    triangles.extend([[left, below, right], [left, right, above]]);
                }
                [Some(left), Some(below), Some(right), Some(above)] => {
                    triangles.extend([[left, below, above], [below, right, above]]);
                }
                corners => {
                    let corners: Vec<u32> = corners.into_iter().flatten().collect();
                    triangles.extend(<[u32; 3]>::try_from(corners));
                }
            }
        }
    }
    (positions, triangles)
}

/// Drop over reach of the tip, of its mean place over the last half of a run of `seconds`.
fn droop(mesh: Mesh, gamma: f64, method: Method, seconds: f32) -> Result<f64, ClothError> {
    let mut cloth = clamped(mesh, gamma, method)?;
    rig::run(&mut cloth, budget(method), GRAVITY, 0.5 * seconds);
    let mut tip = Vec3::ZERO;
    let samples = (0.5 * seconds / budget(method).dt).round() as u32;
    for _ in 0..samples {
        cloth.step(budget(method), GRAVITY);
        tip += rig::mean(&cloth, |rest| rest.x > 0.499 * LENGTH) / samples as f32;
    }
    let clamp = -0.5 * LENGTH + mesh.clamp() * mesh.column();
    Ok(f64::from(-tip.y) / f64::from(tip.x - clamp))
}

/// Droop over Γ on two grids and on one turned by 45°, and the angle of the chord at the bar of ASTM D1388.
pub fn elastica(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "cantilever";
    let (gammas, seconds): (&[f64], f32) =
        if bench.quick { (&[1.0, 8.0, 100.0], 10.0) } else { (&[0.5, 1.0, 3.0, 5.0, 8.0, 10.0, 30.0, 100.0], 20.0) };
    let mut series = Vec::new();
    for method in bench.with_default(STATIC) {
        let meshes: &[Mesh] = if method == Method::default() {
            &[Mesh::Grid(20), Mesh::Grid(40), Mesh::Turned(20), Mesh::Turned(40)]
        } else {
            &[Mesh::Grid(20)]
        };
        for mesh in meshes {
            let mut points = Vec::new();
            for gamma in gammas {
                let found = droop(*mesh, *gamma, method, seconds)?;
                let (drop, reach) = closed::elastica(*gamma);
                let what = format!("H/W at Γ = {gamma}, {}", mesh.name());
                bench.at_rest(CHECK, what, method, found, drop / reach, Bound::Relative(0.05));
                if *gamma == 8.0 {
                    let what = format!("angle of the chord at Γ = 8 (ASTM D1388), {}, °", mesh.name());
                    bench.at_rest(CHECK, what, method, found.atan().to_degrees(), 41.5, Bound::Absolute(1.5));
                }
                points.push((*gamma, found));
            }
            let (label, look) = match mesh {
                Mesh::Grid(20) => (method.name().to_owned(), Look::of(method)),
                Mesh::Grid(_) => (mesh.name(), Look(2)),
                Mesh::Turned(20) => ("turned by 45°".to_owned(), Look(1)),
                Mesh::Turned(_) => ("turned, finer".to_owned(), Look(9)),
            };
            series.push(Series { label, look, stroke: Stroke::Points, points });
        }
    }
    let curve = (0..=60).map(|i| 10_f64.powf(-0.5 + 2.6 * f64::from(i) / 60.0));
    let points = curve.map(|gamma| (gamma, closed::elastica(gamma))).map(|(gamma, (h, w))| (gamma, h / w)).collect();
    series.push(Series { label: "heavy elastica".into(), look: Look(0), stroke: Stroke::Line, points });
    let panel = Panel {
        title: "A strip clamped level under its own weight".into(),
        x: Axis::log("Γ = σgL³/D"),
        y: Axis::log("drop over reach of the tip, H/W").within(3e-3, 30.0),
        series,
        ..Panel::default()
    };
    bench.figures.push(("validate-cantilever", Figure::single(panel)));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_turned_mesh_covers_the_strip_and_no_more() {
        let (positions, triangles) = turned(20, 4);
        let area: f32 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| positions[i as usize]);
                0.5 * (b - a).cross(c - a).z
            })
            .inspect(|area| assert!(*area > 0.0))
            .sum();
        assert!((area / (LENGTH * LENGTH / 5.0) - 1.0).abs() < 1e-5, "{area}");
    }
}
