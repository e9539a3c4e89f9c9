use cloth_solver::Fabric;
use glam::{DVec2, DVec3};

use super::*;

fn wavy(sheet: &Sheet) -> Vec<DVec3> {
    let wave =
        |i: usize, p: &DVec3| *p * 1.01 + 0.02 * DVec3::new((3.0 * p.y).sin(), (5.0 * p.x).cos(), (i as f64).sin());
    sheet.flat.iter().enumerate().map(|(i, p)| wave(i, p)).collect()
}

fn sheet(cells: usize) -> Sheet {
    let fabric = Fabric { bend_warp: 1e-3, bend_weft: 2e-3, damping: 0.0, ..Fabric::DENIM_11_OZ };
    Sheet { gravity: DVec3::NEG_Y * 9.81, ..Sheet::new(DVec2::new(1.0, 0.8), [cells, cells - 1], &fabric) }
}

#[test]
fn forces_are_the_slope_of_the_energy() {
    let sheet = sheet(5);
    let x = wavy(&sheet);
    let mut force = vec![DVec3::ZERO; x.len()];
    sheet.forces(&x, &mut force);
    for i in [0, 3, 7, 14, 29] {
        for axis in 0..3 {
            let at = |way: f64| {
                let mut x = x.clone();
                x[i][axis] += way;
                sheet.potential_energy(&x)
            };
            let slope = -(at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((slope - force[i][axis]).abs() < 1e-5 * (1.0 + slope.abs()), "{slope} {}", force[i][axis]);
        }
    }
}

#[test]
fn stiffness_is_the_slope_of_the_forces() {
    let sheet = sheet(4);
    let x = wavy(&sheet);
    let n = x.len();
    let mut matrix = vec![glam::DMat3::ZERO; n * n];
    sheet.stiffness(&x, true, |i, j, block| matrix[i * n + j] += block);
    let (mut there, mut back) = (vec![DVec3::ZERO; n], vec![DVec3::ZERO; n]);
    for (j, axis) in [(0, 0), (6, 1), (7, 2), (13, 0)] {
        for (way, force) in [(1e-6, &mut there), (-1e-6, &mut back)] {
            let mut x = x.clone();
            x[j][axis] += way;
            sheet.forces(&x, force);
        }
        for i in 0..n {
            let slope = (back[i] - there[i]) / 2e-6;
            let column = matrix[i * n + j].col(axis);
            assert!((slope - column).length() < 1e-4 * (1.0 + column.length()), "{i} {j}: {slope} {column}");
        }
    }
}

#[test]
fn the_energies_are_those_the_solver_documents() {
    use cloth_solver::topology::Resolution;
    let fabric = Fabric { bend_warp: 1e-3, bend_weft: 2e-3, ..Fabric::DENIM_11_OZ };
    let size = glam::Vec2::new(1.0, 0.8);
    let topology = cloth_solver::Topology::rectangle(size, Resolution::Cells(glam::UVec2::new(5, 4))).unwrap();
    let mut particles = cloth_solver::Particles::new(&topology, fabric.areal_density);
    let sheet = sheet(5);
    let x = wavy(&sheet);
    for (slot, x) in topology.particles().zip(&x) {
        particles.position.set(slot as usize, x.as_vec3());
    }
    let of_solver = cloth_solver::measure::elastic_energy(&topology, &particles, &fabric);
    assert!((sheet.elastic_energy(&x) / of_solver - 1.0).abs() < 1e-4);
    let mass: f32 = particles.mass.iter().sum();
    assert!((sheet.mass.iter().sum::<f64>() - f64::from(mass)).abs() < 1e-6);
}

#[test]
fn a_hanging_strip_is_stretched_as_the_closed_form_says() {
    let fabric = Fabric { stretch_warp: 50.0, ..Fabric::COTTON_POPLIN };
    let mut sheet = Sheet::new(DVec2::new(0.1, 1.0), [2, 20], &fabric);
    sheet.gravity = DVec3::NEG_Y * 9.81;
    sheet.pinned[..3].fill(true);
    let rest = rest(&sheet, sheet.flat.clone());
    assert!(rest.residual < 1e-8, "{}", rest.residual);
    // Tip: σgL²/(2Y), exact at the nodes; the top edge bears all but half a spacing of the sheet.
    let tip = -0.5 - rest.x[61].y;
    let expected = 0.15 * 9.81 / (2.0 * 50.0);
    assert!((tip / expected - 1.0).abs() < 1e-5, "{tip} {expected}");
    let strain = sheet.largest_strain(&rest.x);
    assert!((strain / (0.15 * 9.81 * (1.0 - 0.025) / 50.0) - 1.0).abs() < 1e-5);
}

#[test]
fn an_undamped_swing_keeps_its_energy_and_friction_takes_some() {
    let mut swing = sheet(6);
    swing.pinned[..7].fill(true);
    swing.gravity = DVec3::new(0.0, -6.0, 6.0);
    let limit = 2.0 / highest_frequency(&swing, &swing.flat);
    let left = |sheet: &Sheet| {
        let mut motion = Motion::new(sheet, sheet.flat.clone(), vec![DVec3::ZERO; sheet.flat.len()]);
        let before = motion.energy();
        motion.advance(0.5, limit / 8.0);
        assert!(motion.kinetic_energy() > 0.05);
        (motion.energy() - before) / motion.kinetic_energy()
    };
    assert!(left(&swing).abs() < 1e-4, "{}", left(&swing));
    swing.damping = 2.0;
    assert!(left(&swing) < -0.01, "{}", left(&swing));
}

#[test]
fn above_its_limit_the_reference_explodes_and_below_it_does_not() {
    let mut sheet = sheet(6);
    sheet.pinned[..7].fill(true);
    let limit = 2.0 / highest_frequency(&sheet, &sheet.flat);
    let speed = |part: f64| {
        let mut motion = Motion::new(&sheet, sheet.flat.clone(), vec![DVec3::ZERO; sheet.flat.len()]);
        motion.advance(400.0 * limit, part * limit);
        motion.v.iter().map(|v| v.length_squared()).sum::<f64>().sqrt()
    };
    assert!(speed(0.95) < 10.0, "{}", speed(0.95));
    assert!(!speed(1.06).is_finite() || speed(1.06) > 100.0, "{}", speed(1.06));
}

#[test]
fn a_falling_sheet_reaches_the_terminal_speed_of_its_drag() {
    let stiff = Fabric { damping: 0.0, bend_warp: 0.1, bend_weft: 0.1, ..Fabric::COTTON_POPLIN };
    let mut falling = Sheet::new(DVec2::ONE, [4, 4], &stiff);
    falling.gravity = DVec3::NEG_Z * 9.81;
    falling.wind = Some(Wind { air: cloth_solver::forces::Air::default(), velocity: DVec3::ZERO });
    let mut motion = Motion::new(&falling, falling.flat.clone(), vec![DVec3::ZERO; 25]);
    motion.advance(1.5, 1e-4);
    let speed = -motion.v.iter().map(|v| v.z).sum::<f64>() / 25.0;
    assert!((speed / 1.433 - 1.0).abs() < 0.01, "{speed}");
}

#[test]
fn a_ball_keeps_cloth_out() {
    let mut sheet = Sheet::new(DVec2::ONE, [8, 8], &Fabric::COTTON_POPLIN);
    sheet.gravity = DVec3::NEG_Z * 9.81;
    sheet.balls = vec![Ball { centre: DVec3::NEG_Z * 0.31, reach: 0.3, friction: 0.3 }];
    let h = 0.25 / highest_frequency(&sheet, &sheet.flat);
    let mut motion = Motion::new(&sheet, sheet.flat.clone(), vec![DVec3::ZERO; 81]);
    motion.advance(0.3, h);
    let nearest = motion.x.iter().map(|x| x.distance(sheet.balls[0].centre)).fold(f64::INFINITY, f64::min);
    assert!((0.3 - 1e-9..0.301).contains(&nearest), "{nearest}");
    assert!(motion.x[0].z < -0.2);
}
