//! Stiffness in the plane, by pulling at the border of a free square.
//!
//! The energies of a rectangle are, for small uniform strains, those of a membrane without Poisson effect: per area
//! `½ Y_u ε_u² + ½ Y_v ε_v² + ½ G γ²`. Turning the compliance (1/Y_u, 1/Y_v, 0, 1/G) by an angle gives what a pull T meets:
//! - along weft or warp: strain T/Y, nothing across;
//! - at 45°: strain `T (1/Y_u + 1/Y_v + 1/G)/4` along, `T (1/Y_u + 1/Y_v − 1/G)/4` across;
//! - a shear force T (a picture frame): γ = T/G.
//!
//! Such strains are uniform, so that every mesh holds them exactly.

use cloth_solver::{Cloth, ClothError, Fabric, Method};
use glam::{DVec2, Vec3};

use super::finding::{Bench, Bound, budget};
use super::rig;

/// Cells along each side.
const CELLS: u32 = 10;

/// Pull per width, N/m.
const PULL: f64 = 0.2;

/// Stress along weft, along warp and shear, N/m, put on the border of a square of 1 m until it rests; the same strains.
fn strained(method: Method, fabric: &Fabric, [weft, warp, shear]: [f64; 3]) -> Result<[f64; 3], ClothError> {
    let mut cloth = rig::rectangle([1.0, 1.0], [CELLS, CELLS], fabric, method)?;
    for slot in cloth.topology.particles().collect::<Vec<_>>() {
        let rest = cloth.topology.rest[slot as usize].as_dvec3();
        let on = |x: f64| if x.abs() > 0.499 { x.signum() } else { 0.0 };
        let (right, up) = (on(rest.x), on(rest.y));
        let share = |corner: f64| if corner == 0.0 { 1.0 } else { 0.5 } / f64::from(CELLS);
        let force = right * share(up) * DVec2::new(weft, shear) + up * share(right) * DVec2::new(shear, warp);
        cloth.particles.add_force(slot as usize, force.as_vec2().extend(0.0));
    }
    rig::run(&mut cloth, budget(method), Vec3::ZERO, 10.0);
    let edge = |from: [f32; 2], to: [f32; 2]| corner(&cloth, to) - corner(&cloth, from);
    let across = 0.5 * (edge([-0.5, -0.5], [0.5, -0.5]) + edge([-0.5, 0.5], [0.5, 0.5]));
    let up = 0.5 * (edge([-0.5, -0.5], [-0.5, 0.5]) + edge([0.5, -0.5], [0.5, 0.5]));
    Ok([across.length() - 1.0, up.length() - 1.0, across.dot(up)])
}

fn corner(cloth: &Cloth, place: [f32; 2]) -> glam::DVec3 {
    let near = |rest: Vec3| (rest.x - place[0]).abs() + (rest.y - place[1]).abs() < 1e-3;
    rig::mean(cloth, near).as_dvec3()
}

/// Pulls at 0°, 90° and 45° to the weft, and a picture frame.
pub fn pulls(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "stiffness in the plane";
    let fabric = Fabric {
        stretch_weft: 150.0,
        stretch_warp: 300.0,
        shear: 40.0,
        bend_warp: 0.0,
        bend_weft: 0.0,
        damping: 5.0,
        ..Fabric::COTTON_POPLIN
    };
    let (weft, warp, shear) = (150.0, 300.0, 40.0);
    for method in bench.with_default(&[Method::XpbdSweeps, Method::Pbd]) {
        let mut add = |what: &str, strain: f64, expected: f64| {
            let what = format!("stiffness {what}, N/m");
            bench.at_rest(CHECK, what, method, PULL / strain, PULL / expected, Bound::Relative(0.01));
        };
        add("along the weft", strained(method, &fabric, [PULL, 0.0, 0.0])?[0], PULL / weft);
        add("along the warp", strained(method, &fabric, [0.0, PULL, 0.0])?[1], PULL / warp);
        let [u, v, twist] = strained(method, &fabric, [0.5 * PULL; 3])?;
        let (sum, give) = (1.0 / weft + 1.0 / warp, 1.0 / shear);
        add("at 45°", 0.5 * (u + v + twist), PULL * (sum + give) / 4.0);
        add("across a pull at 45°", 0.5 * (u + v - twist), PULL * (sum - give) / 4.0);
        add("of a picture frame", strained(method, &fabric, [0.0, 0.0, PULL])?[2], PULL / shear);
    }
    Ok(())
}
