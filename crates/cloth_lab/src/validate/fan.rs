//! What moves the air: the jet of a fan, and gusts.

use core::f64::consts::PI;

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::forces::{Fan, Gusts, GustyWind, WindField};
use cloth_solver::{ClothError, Fabric, Method, Motion, Pose};
use glam::{DVec3, Quat, Vec3};

use super::air::force_on;
use super::finding::{Bench, Bound};
use super::rig;

/// Blows along −z from the origin.
const FAN: Fan = Fan { on: true, diameter: 0.4, speed: 5.0, spread: 0.52, oscillation: None };

fn blown(colliders: &[Collider]) -> WindField {
    let mut field = WindField::default();
    field.set_fans([(FAN, Pose::IDENTITY)], colliders);
    field
}

/// Speed at a distance before the fan and from its axis, m/s.
fn speed(field: &WindField, along: f64, aside: f64) -> f64 {
    field.at(Vec3::new(aside as f32, 0.0, -along as f32)).as_dvec3().length()
}

/// The free round jet: along the axis, across, its momentum, and what is outside, behind and in the shadow.
pub fn jet(bench: &mut Bench) -> Result<(), ClothError> {
    let field = blown(&[]);
    let (outlet, diameter) = (f64::from(FAN.speed), f64::from(FAN.diameter));
    let mut add = |what: String, value, expected, bound| bench.known("fan", what, value, expected, bound);
    for diameters in [3.0_f64, 6.0, 12.0, 24.0, 48.0] {
        let expected = outlet * (6.0 / diameters).min(1.0);
        let found = speed(&field, diameters * diameter, 0.0);
        add(format!("speed on the axis {diameters} diameters away, m/s"), found, expected, Bound::Relative(0.02));
    }
    for diameters in [8.0, 32.0] {
        let along = diameters * diameter;
        let part = speed(&field, along, 0.095 * along) / speed(&field, along, 0.0);
        add(format!("part of it at 0.095 x aside, {diameters} diameters away"), part, 0.5, Bound::Relative(0.02));
    }
    let flux = |along: f64| {
        let step = (diameter + along) * 1e-4;
        let ring = |i: i32| (f64::from(i) + 0.5) * step;
        (0..10_000).map(ring).map(|r| speed(&field, along, r).powi(2) * 2.0 * PI * r * step).sum::<f64>()
    };
    let at_outlet = flux(0.01 * diameter);
    for diameters in [2.0, 6.0, 20.0] {
        let part = flux(diameters * diameter) / at_outlet;
        add(
            format!("momentum flux {diameters} diameters away over that at the outlet"),
            part,
            1.0,
            Bound::Relative(0.02),
        );
    }
    let (away, half) = (3.0, 0.5 * f64::from(FAN.spread));
    let rim = 0.5 * diameter + away * half.tan();
    add("speed outside of the spread angle, m/s".into(), speed(&field, away, 1.01 * rim), 0.0, Bound::AtMost);
    let drawn = field.at(Vec3::Z * 2.0).as_dvec3().dot(DVec3::NEG_Z) * 2.0 * PI * 4.0;
    let blown_out = outlet * PI * diameter * diameter / 4.0;
    add("air drawn in from behind over air blown out".into(), drawn / blown_out, 1.0, Bound::Relative(0.05));
    let ball = Collider {
        shape: Shape::sphere(0.2)?,
        motion: Motion::at_rest(Pose::new(Vec3::NEG_Z, Quat::IDENTITY)),
        friction: 0.0,
    };
    add("speed behind a ball in the jet, m/s".into(), speed(&blown(&[ball]), 2.0, 0.0), 0.0, Bound::AtMost);
    Ok(())
}

/// The force on a small panel falls with the square of the distance.
pub fn panel(bench: &mut Bench) -> Result<(), ClothError> {
    const SIDE: f32 = 0.04;
    let force = |away: f32| {
        let mut panel = rig::rectangle([SIDE, SIDE], [2, 2], &Fabric::COTTON_POPLIN, Method::default())?;
        rig::put(&mut panel, |rest| rest + Vec3::NEG_Z * away);
        Ok(-force_on(&mut panel, &blown(&[])).z)
    };
    for away in [4.0_f32, 8.0, 16.0] {
        let air = f64::from(6.0 * FAN.speed * FAN.diameter / away);
        let expected = 0.5 * 1.225 * 1.17 * f64::from(SIDE * SIDE) * air * air;
        let what = format!("force on a panel of 4 cm {away} m away, N");
        bench.known("fan", what, force(away)?, expected, Bound::Relative(0.02));
    }
    let ratio = force(4.0)? / force(8.0)?;
    bench.known("fan", "force at 4 m over that at 8 m", ratio, 4.0, Bound::Relative(0.02));
    Ok(())
}

/// Gusts are free of divergence, as strong as told along every axis, and carried by the wind.
pub fn gusts(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "gusts";
    const STEP: f32 = 0.01;
    let gusts = Gusts { intensity: 0.2, length: 2.0, seed: 1 };
    let after = |seconds: f32| {
        let (mut wind, mut field) = (GustyWind::default(), WindField::default());
        wind.advance(Vec3::X * 5.0, &gusts, seconds);
        field.set_wind(&wind, &Pose::IDENTITY);
        move |p: Vec3| (field.at(p) - Vec3::X * 5.0).as_dvec3()
    };
    let at = after(0.0);
    // Steps that are no fraction of each other or of a wavelength.
    let place = |i: i32| Vec3::new(0.7548, 0.5698, 0.4302) * 1.37 * (i as f32) % 97.0;
    let (mut square, mut divergence, mut steepness) = (DVec3::ZERO, 0.0_f64, 0.0_f64);
    let count = if bench.quick { 4_000 } else { 40_000 };
    for p in (0..count).map(place) {
        square += at(p) * at(p) / f64::from(count);
        let slope = |axis: Vec3| (at(p + axis * STEP) - at(p - axis * STEP)) / f64::from(2.0 * STEP);
        let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(slope);
        divergence += (x.x + y.y + z.z).powi(2);
        steepness += x.length_squared() + y.length_squared() + z.length_squared();
    }
    let part = (divergence / steepness).sqrt();
    bench.known(CHECK, "divergence over gradient, root mean squares", part, 0.01, Bound::AtMost);
    for (axis, mean) in ["along the wind", "up", "aside"].into_iter().zip(square.to_array()) {
        bench.known(CHECK, format!("root mean square {axis}, m/s"), mean.sqrt(), 1.0, Bound::Relative(0.05));
    }
    let (then, p) = (after(0.4), Vec3::new(0.3, 0.2, 0.1));
    let passed = then(p + Vec3::X * 2.0).distance(at(p));
    bench.known(CHECK, "change of the pattern as the wind carries it by 2 m, m/s", passed, 1e-3, Bound::AtMost);
    Ok(())
}
