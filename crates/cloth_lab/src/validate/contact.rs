//! Contact: friction on an incline, and how deep cloth at rest lies in solids.

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::{Cloth, ClothError, Fabric, Method, Motion, Pose};
use glam::{Quat, Vec2, Vec3};

use super::finding::{Bench, Bound, budget};
use super::hang::level;
use super::rig::{self, G, GRAVITY};

/// Methods whose constraints meet contact in their own way.
const METHODS: &[Method] = &[Method::XpbdLines];

/// A sheet of 0.2 m on a plane that slopes down along +x by `slope` rad.
fn on_incline(method: Method, slope: f32, friction: f32) -> Result<Cloth, ClothError> {
    let fabric = Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = rig::rectangle([0.2, 0.2], [8, 8], &fabric, method)?;
    let turn = Quat::from_rotation_z(-slope);
    let above = cloth.contacts.offset;
    rig::put(&mut cloth, |rest| turn * (level(rest) + Vec3::Y * above));
    let motion = Motion::at_rest(Pose::new(Vec3::ZERO, turn));
    cloth.contacts.colliders.push(Collider { shape: Shape::HalfSpace, motion, friction });
    Ok(cloth)
}

/// How far down the slope the middle of the sheet is, m.
fn slid(cloth: &Cloth, slope: f32) -> f64 {
    let down = Quat::from_rotation_z(-slope) * Vec3::X;
    f64::from(rig::mean(cloth, |_| true).dot(down))
}

/// Coulomb friction: sticks if and only if μ ≥ tan θ; slides with g (sin θ − μ cos θ).
pub fn friction(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "friction";
    for method in bench.with_default(METHODS) {
        for degrees in [20.0_f32, 35.0] {
            let slope = degrees.to_radians();
            for (part, sticks) in [(1.05, true), (0.95, false)] {
                let mut cloth = on_incline(method, slope, part * slope.tan())?;
                rig::run(&mut cloth, budget(method), GRAVITY, 5.0);
                let bound = if sticks { Bound::AtMost } else { Bound::AtLeast };
                let what = format!("way in 5 s on {degrees}° at μ = {part} tan θ, m");
                bench.claim(CHECK, what, method, slid(&cloth, slope).abs(), 1e-3, bound);
            }
            let friction = 0.5 * slope.tan();
            let mut cloth = on_incline(method, slope, friction)?;
            rig::run(&mut cloth, budget(method), GRAVITY, 1.0);
            let found = 2.0 * slid(&cloth, slope);
            let expected = G * (f64::from(slope.sin()) - f64::from(friction) * f64::from(slope.cos()));
            let what = format!("acceleration on {degrees}° at μ = 0.5 tan θ, m/s²");
            bench.claim(CHECK, what, method, found, expected, Bound::Relative(0.03));
        }
    }
    Ok(())
}

/// A sheet draped on a sphere, a capsule, a box and a pyramid: how far its particles are closer than they should be.
pub fn depth(bench: &mut Bench) -> Result<(), ClothError> {
    const CHECK: &str = "contact depth";
    let seconds = if bench.quick { 4.0 } else { 10.0 };
    let shapes = [
        ("a sphere", Shape::sphere(0.2)?, Quat::IDENTITY),
        ("a capsule", Shape::capsule(0.15, 0.3)?, Quat::from_rotation_z(core::f32::consts::FRAC_PI_2)),
        ("a box", Shape::cuboid(Vec3::new(0.3, 0.2, 0.3))?, Quat::IDENTITY),
        ("a pyramid", Shape::pyramid(Vec2::splat(0.5), 0.4)?, Quat::IDENTITY),
    ];
    for method in bench.with_default(METHODS) {
        for (name, shape, turn) in &shapes {
            let fabric = Fabric { damping: 3.0, ..Fabric::COTTON_POPLIN };
            let mut cloth = rig::rectangle([0.8, 0.8], [32, 32], &fabric, method)?;
            rig::put(&mut cloth, |rest| level(rest) + Vec3::Y * 0.25);
            let pose = Pose::new(Vec3::ZERO, *turn);
            cloth.contacts.colliders.push(Collider {
                shape: shape.clone(),
                motion: Motion::at_rest(pose),
                friction: fabric.friction,
            });
            rig::run(&mut cloth, budget(method), GRAVITY, seconds);
            let offset = cloth.contacts.offset;
            let deepest = (cloth.topology.particles())
                .map(|slot| cloth.particles.position.get(slot as usize))
                .map(|p| offset - shape.distance_and_normal(pose.inverse_point(p)).0)
                .fold(f32::NEG_INFINITY, |deep, here| if here > deep || here.is_nan() { here } else { deep });
            let what = format!("depth at rest on {name}, of the distance kept");
            bench.claim(CHECK, what, method, f64::from((deepest / offset).max(0.0)), 0.1, Bound::AtMost);
        }
    }
    Ok(())
}
