//! The forms of colliders: how far they are, compared with brute force, and what is refused.

use cloth_solver::ClothError;
use cloth_solver::contact::Shape;
use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn vector(range: core::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(range).prop_map(Vec3::from)
}

/// Distance in a plane through the axis from a convex outline, whose corners go round it clockwise; the axis closes it.
fn from_outline(p: Vec3, outline: &[DVec2]) -> f32 {
    let p = p.as_dvec3();
    let p = DVec2::new(p.x.hypot(p.z), p.y);
    let away = outline.windows(2).map(|side| {
        let along = ((p - side[0]).dot(side[1] - side[0]) / side[0].distance_squared(side[1])).clamp(0.0, 1.0);
        p.distance(side[0].lerp(side[1], along))
    });
    let is_inside = outline.windows(2).all(|side| (side[1] - side[0]).perp_dot(p - side[0]) <= 0.0);
    let away = away.fold(f64::INFINITY, f64::min) as f32;
    if is_inside { -away } else { away }
}

/// The foot of `p` on the surface is where distance and normal say, and the surface there faces along the normal.
fn check(shape: &Shape, p: Vec3, expected: f32) -> Result<(), TestCaseError> {
    let (distance, normal) = shape.distance_and_normal(p);
    prop_assert!((distance - expected).abs() < 1e-5, "{distance} instead of {expected} at {p} from {shape:?}");
    prop_assert!((normal.length() - 1.0).abs() < 1e-5);
    for step in [0.0, 0.1] {
        let (height, _) = shape.distance_and_normal(p - normal * (distance - step));
        prop_assert!((height - step).abs() < 1e-4, "{height} m over the foot of {p} on {shape:?}, not {step}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn a_cylinder_is_as_far_as_its_outline(radius in 0.05_f32..1.0, height in 0.05_f32..2.0, p in vector(-2.0..2.0)) {
        let (r, h) = (f64::from(radius), f64::from(height) / 2.0);
        let outline = [DVec2::new(0.0, h), DVec2::new(r, h), DVec2::new(r, -h), DVec2::new(0.0, -h)];
        check(&Shape::cylinder(radius, height).unwrap(), p, from_outline(p, &outline))?;
    }

    #[test]
    fn a_cone_is_as_far_as_its_outline(radius in 0.05_f32..1.0, height in 0.05_f32..2.0, p in vector(-2.0..2.0)) {
        let (r, h) = (f64::from(radius), f64::from(height) / 2.0);
        let outline = [DVec2::new(0.0, h), DVec2::new(r, -h), DVec2::new(0.0, -h)];
        check(&Shape::cone(radius, height).unwrap(), p, from_outline(p, &outline))?;
    }

    #[test]
    fn a_rounded_box_is_as_far_as_its_core_less_its_radius(
        core in vector(0.05..1.0), radius in 0.01_f32..0.5, p in vector(-2.0..2.0)
    ) {
        let shape = Shape::rounded_cuboid(2.0 * (core + radius), radius).unwrap();
        let (outside, inside) = (p.distance(p.clamp(-core, core)), (p.abs() - core).max_element());
        check(&shape, p, if inside > 0.0 { outside } else { inside } - radius)?;
    }

    #[test]
    fn no_point_of_an_ellipsoid_is_nearer_than_its_distance(
        half in vector(0.05..1.0), p in vector(-2.0..2.0), others in prop::collection::vec(vector(-1.0..1.0), 50)
    ) {
        let shape = Shape::ellipsoid(half).unwrap();
        let (distance, normal) = shape.distance_and_normal(p);
        let foot = (p - normal * distance).as_dvec3();
        let level = |x: DVec3| (x / half.as_dvec3()).length();
        prop_assert!((level(foot) - 1.0).abs() < 1e-4, "the foot {foot} of {p} lies at {}", level(foot));
        prop_assert_eq!(distance > 0.0, level(p.as_dvec3()) > 1.0);
        let uphill = (foot / (half * half).as_dvec3()).normalize();
        prop_assert!(uphill.dot(normal.as_dvec3()) > 1.0 - 1e-6, "{normal} is not across the surface at {foot}");
        for other in others.iter().filter_map(|other| other.try_normalize()) {
            prop_assert!((other * half).distance(p) > distance.abs() - 1e-5);
        }
    }
}

fn curved() -> [Shape; 5] {
    [
        Shape::cylinder(0.5, 1.0).unwrap(),
        Shape::cone(0.5, 1.0).unwrap(),
        Shape::ellipsoid(Vec3::new(0.5, 0.2, 0.7)).unwrap(),
        Shape::ellipsoid(Vec3::new(1e4, 1e-4, 1.0)).unwrap(),
        Shape::rounded_cuboid(Vec3::new(1.0, 0.6, 0.8), 0.1).unwrap(),
    ]
}

#[test]
fn distance_and_normal_of_finite_points_are_never_nan() {
    for shape in curved() {
        for size in [0.0, f32::MIN_POSITIVE, 1e-30, 0.1, 0.5, 1.0, 1e20, f32::MAX] {
            for direction in [Vec3::X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::ONE, Vec3::new(-1.0, 1.0, 0.0)] {
                let (distance, normal) = shape.distance_and_normal(direction * size);
                assert!(!distance.is_nan(), "{shape:?} at {direction} * {size}");
                assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?} at {direction} * {size}: {normal}");
            }
        }
    }
}

#[test]
fn an_ellipsoid_of_equal_axes_is_a_ball() {
    assert_eq!(Shape::ellipsoid(Vec3::splat(0.3)), Shape::sphere(0.3));
    let almost = Shape::ellipsoid(Vec3::new(0.3, 0.3, 0.300_001)).unwrap();
    let (distance, normal) = almost.distance_and_normal(Vec3::new(0.3, 0.0, 0.4));
    assert!((distance - 0.2).abs() < 1e-5 && normal.distance(Vec3::new(0.6, 0.0, 0.8)) < 1e-4);
}

#[test]
fn every_shape_fits_into_its_bounding_radius() {
    for shape in curved() {
        let radius = shape.bounding_radius();
        for direction in [Vec3::X, Vec3::NEG_Y, Vec3::ONE.normalize(), Vec3::new(0.6, -0.8, 0.0)] {
            let (distance, _) = shape.distance_and_normal(direction * (1.001 * radius));
            assert!(distance > 0.0, "{shape:?} reaches farther than {radius} m along {direction}");
        }
    }
}

fn refused<T: core::fmt::Debug>(result: Result<T, ClothError>) -> &'static str {
    match result {
        Err(ClothError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_wrong_size_is_refused_by_name() {
    assert_eq!(refused(Shape::cylinder(0.0, 1.0)), "ClothCollider::Cylinder.radius");
    assert_eq!(refused(Shape::cylinder(1.0, f32::NAN)), "ClothCollider::Cylinder.height");
    assert_eq!(refused(Shape::cone(2e4, 1.0)), "ClothCollider::Cone.radius");
    assert_eq!(refused(Shape::cone(1.0, -1.0)), "ClothCollider::Cone.height");
    assert_eq!(refused(Shape::ellipsoid(Vec3::new(1.0, 1.0, 0.0))), "ClothCollider::Ellipsoid.radii.z");
    assert_eq!(refused(Shape::rounded_cuboid(Vec3::new(1.0, 0.0, 1.0), 0.1)), "ClothCollider::RoundedCuboid.size.y");
    for radius in [0.0, 0.25, f32::NAN, f32::INFINITY] {
        let shape = Shape::rounded_cuboid(Vec3::new(1.0, 0.5, 1.0), radius);
        assert_eq!(refused(shape), "ClothCollider::RoundedCuboid.radius", "{radius}");
    }
}
