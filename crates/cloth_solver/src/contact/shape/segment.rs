//! What stands between two points: eight segments against a shape at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;

use super::{ConvexHull, Form, Shape};
use crate::lanes::{LANES, Vec3x8, splat};

/// Whether the way from `from` to `to`, in the shape's own frame, enters the shape. One that starts inside does not enter. Of a
/// cylinder and a cone it is the polyhedron inside that is entered, of a rounded box the box around it, of a mesh a
/// triangle.
#[inline(always)]
pub(crate) fn enters<S: Simd>(simd: S, shape: &Shape, from: Vec3x8<S>, to: Vec3x8<S>) -> mask32x8<S> {
    let zero = splat(simd, 0.0);
    match shape {
        Shape::Sphere { radius } => enters_capsule(simd, 0.0, *radius, from, to - from),
        Shape::Capsule { radius, half_length } => enters_capsule(simd, *half_length, *radius, from, to - from),
        Shape::HalfSpace => from.y.simd_gt(zero) & to.y.simd_lt(zero),
        Shape::Convex(hull) => enters_hull(simd, hull, 0.0, from, to),
        Shape::Curved(curved) => match curved.form() {
            Form::Ellipsoid { half } => {
                // Seen shrunk along its axes it is a ball.
                let [from, to] = [from, to].map(|p| scaled(simd, p, half.recip()));
                enters_capsule(simd, 0.0, 1.0, from, to - from)
            }
            _ => enters_hull(simd, curved.hull(), curved.rounding(), from, to),
        },
        Shape::Mesh(mesh) => {
            let at = |p: Vec3x8<S>, lane: usize| Vec3::new(p.x[lane], p.y[lane], p.z[lane]);
            let hits = (0..LANES).map(|lane| f32::from(u8::from(mesh.is_between(at(from, lane), at(to, lane)))));
            let mut lanes = [0.0; LANES];
            lanes.iter_mut().zip(hits).for_each(|(lane, hit)| *lane = hit);
            f32x8::simd_from(simd, lanes).simd_gt(zero)
        }
    }
}

#[inline(always)]
fn scaled<S: Simd>(simd: S, p: Vec3x8<S>, by: Vec3) -> Vec3x8<S> {
    Vec3x8 { x: p.x * splat(simd, by.x), y: p.y * splat(simd, by.y), z: p.z * splat(simd, by.z) }
}

/// For a solid of which each plane is moved out by `more`.
#[inline(always)]
fn enters_hull<S: Simd>(simd: S, hull: &ConvexHull, more: f32, from: Vec3x8<S>, to: Vec3x8<S>) -> mask32x8<S> {
    // Between the last plane that the way goes in through and the first that it leaves by.
    let (way, zero) = (to - from, splat(simd, 0.0));
    let (mut enter, mut leave) = (zero, splat(simd, 1.0));
    for &(normal, offset) in &hull.planes {
        let normal = Vec3x8::splat(simd, normal);
        let speed = way.dot(normal);
        let height = splat(simd, offset + more) - from.dot(normal);
        let time = height / speed;
        enter = speed.simd_lt(zero).select(enter.max(time), enter);
        leave = speed.simd_gt(zero).select(leave.min(time), leave);
        let beside = speed.simd_eq(zero) & height.simd_lt(zero);
        leave = beside.select(zero, leave);
    }
    enter.simd_gt(zero) & enter.simd_lt(leave)
}

/// For the segment from −`half_length` to `half_length` on the y axis, blown up by `radius`. Nearest points of two
/// segments: Ericson, Real-Time Collision Detection (2005), 5.1.9.
#[inline(always)]
fn enters_capsule<S: Simd>(simd: S, half_length: f32, radius: f32, from: Vec3x8<S>, way: Vec3x8<S>) -> mask32x8<S> {
    let (zero, one, end) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, half_length));
    let tiny = splat(simd, f32::MIN_POSITIVE);
    // Nearest to the endless axis, then to the end of the segment that lies nearest to that.
    let across = way.x * way.x + way.z * way.z;
    let time = (-(from.x * way.x + from.z * way.z) / across.max(tiny)).max(zero).min(one);
    let on_axis = on_axis(from.y + way.y * time, end);
    let along = (on_axis - from.y) * way.y - from.x * way.x - from.z * way.z;
    let time = (along / way.dot(way).max(tiny)).max(zero).min(one);
    let reach = splat(simd, radius * radius);
    let nearest = from + way * time;
    from_axis(nearest, end).simd_lt(reach) & from_axis(from, end).simd_gt(reach)
}

#[inline(always)]
fn on_axis<S: Simd>(y: f32x8<S>, end: f32x8<S>) -> f32x8<S> {
    y.max(-end).min(end)
}

/// Square of the distance from the segment of ± `end` on the y axis.
#[inline(always)]
fn from_axis<S: Simd>(p: Vec3x8<S>, end: f32x8<S>) -> f32x8<S> {
    let y = p.y - on_axis(p.y, end);
    p.x * p.x + y * y + p.z * p.z
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;
    use glam::{Vec2, Vec3};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;
    use crate::lanes::LEVEL;

    fn is_between(shape: &Shape, from: Vec3, to: Vec3) -> bool {
        let mask = dispatch!(*LEVEL, simd => {
            enters(simd, shape, Vec3x8::splat(simd, from), Vec3x8::splat(simd, to)).to_bitmask()
        });
        assert!(mask == 0 || mask == 0xff, "lanes disagree");
        mask != 0
    }

    fn shapes() -> [Shape; 8] {
        [
            Shape::sphere(0.5).unwrap(),
            Shape::capsule(0.3, 1.0).unwrap(),
            Shape::cuboid(Vec3::new(0.4, 1.0, 0.7)).unwrap(),
            Shape::pyramid(Vec2::new(0.8, 1.0), 0.9).unwrap(),
            Shape::cylinder(0.4, 0.8).unwrap(),
            Shape::cone(0.5, 0.9).unwrap(),
            Shape::ellipsoid(Vec3::new(0.3, 0.6, 0.4)).unwrap(),
            Shape::HalfSpace,
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn a_way_enters_where_a_walk_along_it_gets_inside(
            from in prop::array::uniform3(-2.0_f32..2.0), to in prop::array::uniform3(-2.0_f32..2.0)
        ) {
            let (from, to) = (Vec3::from(from), Vec3::from(to));
            for shape in &shapes() {
                let depth = |i: u32| shape.distance_and_normal(from.lerp(to, i as f32 / 400.0)).0;
                let least = (0..=400).map(depth).fold(f32::INFINITY, f32::min);
                // What grazes the surface within a step of the walk is anybody's guess.
                if depth(0).abs() > 1e-3 && least.abs() > 5e-3 {
                    prop_assert_eq!(is_between(shape, from, to), depth(0) > 0.0 && least < 0.0, "{:?}", shape);
                }
            }
        }
    }

    #[test]
    fn a_way_that_starts_inside_or_ends_before_does_not_enter() {
        for shape in &shapes() {
            let (inside, outside) = (Vec3::Y * -0.05, Vec3::new(0.01, 3.0, 0.02));
            assert!(is_between(shape, outside, -outside), "{shape:?}");
            assert!(is_between(shape, outside, inside), "{shape:?}");
            assert!(!is_between(shape, inside, outside), "{shape:?}");
            assert!(!is_between(shape, inside, -outside), "{shape:?}");
            assert!(!is_between(shape, outside, outside * 0.7), "{shape:?}");
            assert!(!is_between(shape, outside, outside), "{shape:?}");
        }
    }

    #[test]
    fn a_way_along_the_axis_of_a_capsule_enters_at_its_end() {
        let capsule = Shape::capsule(0.3, 1.0).unwrap();
        assert!(is_between(&capsule, Vec3::Y * 2.0, Vec3::Y * 0.7));
        assert!(!is_between(&capsule, Vec3::Y * 2.0, Vec3::Y * 0.9));
        assert!(!is_between(&capsule, Vec3::new(0.4, 2.0, 0.0), Vec3::new(0.4, -2.0, 0.0)));
    }
}
