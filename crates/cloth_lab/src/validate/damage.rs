//! What tears at which load, and what tears and cuts keep.

use cloth_solver::damage::{Blade, Direction, Stroke, Tear, Tearing};
use cloth_solver::{Cloth, ClothError, Fabric, Method};
use glam::Vec3;

use super::finding::{Bench, Bound, budget};
use super::rig::{self, G, GRAVITY};

/// Width and height of the strip that is torn, m.
const WIDTH: f32 = 0.3;
const HEIGHT: f32 = 0.3;

/// Of poplin, stilled so that the load is the one it hangs under.
const FABRIC: Fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };

/// A strip held at its upper edge under a weight on its lower one that grows until it tears: at strength times width, and
/// earlier if it has a notch.
pub fn tearing(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "tearing";
    let cells: &[u32] = if bench.quick { &[16] } else { &[12, 16, 24] };
    for method in bench.with_default(&[]) {
        for (cells, as_mesh) in cells.iter().flat_map(|cells| [(*cells, false), (*cells, true)]) {
            let kind = if as_mesh { "mesh" } else { "rectangle" };
            for strength in [200.0_f32, 400.0] {
                let whole = torn_at(method, cells, as_mesh, strength, None)?;
                let what = format!("weight that tears a {kind} {cells} cells wide of {strength} N/m, N");
                bench.claim(CHECK, what, method, whole, f64::from(strength * WIDTH), Bound::Relative(0.02));
                if strength == 400.0 {
                    let notched = torn_at(method, cells, as_mesh, strength, Some(0.5))?;
                    let what =
                        "weight that tears it with a notch of half its width, N, against that over the half left";
                    bench.claim(CHECK, what, method, notched, 0.5 * whole, Bound::AtMost);
                }
            }
        }
    }
    Ok(())
}

/// The load under which a strip tears first, its own weight included, N; `notch` is the part of its width that is cut.
fn torn_at(method: Method, cells: u32, as_mesh: bool, strength: f32, notch: Option<f32>) -> Result<f64, ClothError> {
    // N/s: so slow that loads, smoothed over 0.05 s, lag by less than a hundredth.
    const RATE: f32 = 8.0;
    let mut cloth = strip(method, cells, as_mesh)?;
    if let Some(part) = notch {
        let off = 0.1 * HEIGHT / cells as f32;
        cloth.cut(&blade([-WIDTH, off], [(part - 0.5) * WIDTH, off]));
    }
    rig::hold(&mut cloth, |rest| rest.y > 0.499 * HEIGHT)?;
    let (tick, tearing) =
        (budget(method), Tearing { splits: 1, weakening: 1.0, reinforcement: 1.0, ..Tearing::at(strength) });
    let lower: Vec<u32> =
        cloth.topology.particles().filter(|slot| cloth.topology.rest[*slot as usize].y < -0.499 * HEIGHT).collect();
    let share = |slot: &u32| {
        let at_end = cloth.topology.rest[*slot as usize].x.abs() > 0.499 * WIDTH;
        if at_end { 0.5 / cells as f32 } else { 1.0 / cells as f32 }
    };
    let shares: Vec<(usize, f32)> = lower.iter().map(|slot| (*slot as usize, share(slot))).collect();
    let own = f64::from(FABRIC.areal_density * WIDTH * HEIGHT) * G;
    let mut tear = Tear::new(&cloth.topology, Vec::new());
    for ticks in 0.. {
        let weight = RATE * tick.dt * ticks as f32;
        if weight > 4.0 * strength * WIDTH {
            break;
        }
        for (slot, share) in &shares {
            cloth.particles.add_force(*slot, Vec3::NEG_Y * (weight * share));
        }
        cloth.step(tick, GRAVITY);
        cloth.particles.force.iter_mut().for_each(|force| force.fill(Vec3::ZERO));
        tear.watch(&cloth.topology, &cloth.particles, &mut cloth.constraints, tick.dt);
        if cloth.tear(&mut tear, &tearing).is_some() {
            return Ok(f64::from(weight) + own);
        }
    }
    Ok(f64::NAN)
}

fn strip(method: Method, cells: u32, as_mesh: bool) -> Result<Cloth, ClothError> {
    let strip = rig::rectangle([WIDTH, HEIGHT], [cells, cells], &FABRIC, method)?;
    if as_mesh { unwoven(&strip, method) } else { Ok(strip) }
}

/// The same sheet as a mesh that is no rectangle.
fn unwoven(sheet: &Cloth, method: Method) -> Result<Cloth, ClothError> {
    let topology = &sheet.topology;
    let positions: Vec<Vec3> = topology.vertex_particle.iter().map(|slot| topology.rest[*slot as usize]).collect();
    rig::mesh(&positions, &topology.triangle_vertices, &FABRIC, method)
}

/// A blade that sweeps along z over a sheet, from above one place of it to above another, m.
fn blade(from: [f32; 2], to: [f32; 2]) -> Blade {
    Blade { from: ray(from), to: ray(to) }
}

fn ray([x, y]: [f32; 2]) -> [Vec3; 2] {
    [Vec3::new(x, y, 1.0), Vec3::new(x, y, -1.0)]
}

/// Cuts by what they leave: pieces, the Euler characteristic, area and mass.
pub fn cutting(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "cutting";
    for as_mesh in [false, true] {
        let kind = if as_mesh { "mesh" } else { "rectangle" };
        let sheet = || strip(Method::default(), 20, as_mesh);
        let (across, inside) = (([-0.2, 0.02], [0.2, -0.05]), ([-0.07, 0.02], [0.09, -0.03]));
        for (place, (from, to), count, left) in
            [("from edge to edge", across, 2.0, 2.0), ("with both ends inside", inside, 1.0, 0.0)]
        {
            let mut cut = sheet()?;
            cut.cut(&blade(from, to));
            let what = format!("pieces of a {kind} cut {place}");
            bench.known(CHECK, what, pieces(&cut), count, Bound::Absolute(0.0));
            bench.known(CHECK, "its Euler characteristic, whole 1", euler(&cut), left, Bound::Absolute(0.0));
        }
        let mut one = sheet()?;
        one.cut(&blade(across.0, across.1));
        for blades in [10, 100] {
            let mut many = sheet()?;
            let mut stroke = Stroke::new(ray(across.0), &many.particles.position);
            for i in 1..=blades {
                let part = i as f32 / blades as f32;
                many.sweep(&mut stroke, ray([-0.2 + 0.4 * part, 0.02 - 0.07 * part]));
            }
            let what = format!("pieces of a {kind} cut across by {blades} blades");
            bench.known(CHECK, what, pieces(&many), 2.0, Bound::Absolute(0.0));
            let what = "area of the upper one over that by one blade";
            bench.known(CHECK, what, first_area(&many) / first_area(&one), 1.0, Bound::Relative(1e-3));
        }
        let mut ruined = sheet()?;
        let done = ruin(&mut ruined, if bench.quick { 100 } else { 1000 });
        for (of, now, before) in [("area", area(&ruined), area(&sheet()?)), ("mass", mass(&ruined), mass(&sheet()?))] {
            let what = format!("{of} of a {kind} after {done} tears and cuts at random, relative");
            bench.known(CHECK, what, now / before, 1.0, Bound::Absolute(1e-5));
        }
    }
    Ok(())
}

/// Tears and cuts a sheet `count` times, all over and in all directions; how often something gave.
fn ruin(sheet: &mut Cloth, count: u32) -> u32 {
    // Multiples of irrational numbers: no place and no direction twice.
    let part = |i: u32, of: f64| (f64::from(i) * of).fract() as f32;
    let mut done = 0;
    for i in 1..=count {
        let gave = if i % 3 == 0 {
            let end = |x: f64, y: f64| [(part(i, x) - 0.5) * 1.2 * WIDTH, (part(i, y) - 0.5) * 1.2 * HEIGHT];
            sheet.cut(&blade(end(0.618_034, 0.324_718), end(0.754_878, 0.569_840))).is_some()
        } else {
            let particles: Vec<u32> = sheet.topology.particles().collect();
            let particle = particles[(part(i, 0.618_034) * particles.len() as f32) as usize % particles.len()];
            let pull = if part(i, 0.324_718) < 0.5 { Direction::Weft } else { Direction::Warp };
            sheet.tear_at(particle, pull).is_some()
        };
        done += u32::from(gave);
    }
    done
}

/// Particles less edges plus triangles.
fn euler(cloth: &Cloth) -> f64 {
    let topology = &cloth.topology;
    topology.particle_count() as f64 - topology.edges.len() as f64 + topology.triangles.len() as f64
}

fn pieces(cloth: &Cloth) -> f64 {
    cloth.topology.pieces().triangles.len() as f64
}

fn area(cloth: &Cloth) -> f64 {
    cloth.topology.triangle_rest.iter().map(|rest| 0.5 * f64::from(rest.determinant())).sum()
}

fn mass(cloth: &Cloth) -> f64 {
    cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum()
}

/// Area of the piece that the first particle, at the upper left corner, is of, m².
fn first_area(cloth: &Cloth) -> f64 {
    let (topology, pieces) = (&cloth.topology, cloth.topology.pieces());
    let of_first = |slot: u32| pieces.of_slot[slot as usize] == 0;
    let triangles = topology.triangles.iter().zip(&topology.triangle_rest);
    triangles.filter(|(corners, _)| of_first(corners[0])).map(|(_, rest)| 0.5 * f64::from(rest.determinant())).sum()
}
