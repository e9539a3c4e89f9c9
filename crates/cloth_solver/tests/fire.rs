//! Fire.

use cloth_solver::damage::fire::*;
use cloth_solver::topology::Resolution;
use cloth_solver::*;
use glam::*;

const DT: f32 = 1.0 / 60.0;

fn speeds(size: Vec2, cells: UVec2, along: Vec3, tilt: Quat, dt: f32, wind: Vec3, s: f32) -> f32 {
    let t = Topology::rectangle(size, Resolution::Cells(cells)).unwrap();
    let fabric = Fabric { areal_density: s, ..Fabric::COTTON_POPLIN };
    let mut p = Particles::new(&t, s);
    for i in 0..t.slots() {
        p.position.set(i, tilt * t.rest[i]);
    }
    let mut f = Fire::new(&t, &fabric, &Flammable::default()).unwrap();
    let x = |i: u32| t.rest[i as usize].dot(along);
    let min = t.particles().map(x).fold(f32::MAX, f32::min);
    let max = -min;
    for i in t.particles() {
        if x(i) < min + 1e-5 {
            assert!(f.ignite_particle(i).unwrap());
        }
    }
    let mut at = vec![f32::NAN; t.slots()];
    let mut n = 0;
    while n < 60000 {
        n += 1;
        f.burn(&t, &p, &Surroundings { wind, ..Default::default() }, dt).unwrap();
        for i in f.ignited() {
            at[*i as usize] = n as f32 * dt;
        }
        if t.particles().all(|i| x(i) < max - 0.001 || at[i as usize].is_finite()) {
            break;
        }
        if !f.is_warm() {
            println!("died at {}", n as f32 * dt);
            break;
        }
    }
    let (mut sx, mut sy, mut sxx, mut sxy, mut k) = (0.0f64, 0.0f64, 0.0f64, 0.0f64, 0.0f64);
    for i in t.particles() {
        let (a, b) = (x(i) as f64, at[i as usize] as f64);
        if a > (min + 0.25 * (max - min)) as f64 && b.is_finite() {
            sx += a;
            sy += b;
            sxx += a * a;
            sxy += a * b;
            k += 1.0;
        }
    }
    1000.0 / ((k * sxy - sx * sy) / (k * sxx - sx * sx)) as f32
}

#[test]
fn explore() {
    for l in [0.005, 0.01, 0.016, 0.025, 0.05] {
        let c = |w: f32, h: f32| UVec2::new((w / l) as u32, (h / l) as u32);
        let t0 = std::time::Instant::now();
        let still = Vec3::ZERO;
        let up = speeds(Vec2::new(0.1, 1.2), c(0.1, 1.2), Vec3::Y, Quat::IDENTITY, DT, still, 0.15);
        let side = speeds(Vec2::new(0.3, 0.1), c(0.3, 0.1), Vec3::X, Quat::IDENTITY, DT, still, 0.15);
        let down = speeds(Vec2::new(0.1, 0.15), c(0.1, 0.15), Vec3::NEG_Y, Quat::IDENTITY, DT, still, 0.15);
        let slope = speeds(Vec2::new(0.1, 0.3), c(0.1, 0.3), Vec3::Y, Quat::from_rotation_x(0.785398), DT, still, 0.15);
        let coarse = speeds(Vec2::new(0.1, 1.2), c(0.1, 1.2), Vec3::Y, Quat::IDENTITY, 0.1, still, 0.15);
        let coarse_side = speeds(Vec2::new(0.3, 0.1), c(0.3, 0.1), Vec3::X, Quat::IDENTITY, 0.1, still, 0.15);
        let heavy = speeds(Vec2::new(0.1, 1.2), c(0.1, 1.2), Vec3::Y, Quat::IDENTITY, DT, still, 0.30);
        println!(
            "{l}: up {up} side {side} down {down} 45 {slope} | dt .1 up {coarse} side {coarse_side} | heavy {heavy}  {:?}",
            t0.elapsed()
        );
    }
}
