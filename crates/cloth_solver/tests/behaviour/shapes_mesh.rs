//! Hulls of points, triangle meshes and height fields as colliders: how far they are, what is refused, and cloth on them.

use std::f32::consts::{FRAC_PI_2, TAU};

use crate::common::*;
use cloth_solver::contact::Shape;
use cloth_solver::{Cloth, ClothError, Fabric, measure};
use glam::{DVec3, Quat, UVec2, Vec2, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const POPLIN: Fabric = Fabric::COTTON_POPLIN;

fn vector(range: core::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(range).prop_map(Vec3::from)
}

fn distance_to_triangle(p: Vec3, triangle: [Vec3; 3]) -> f64 {
    let (p, [a, b, c]) = (p.as_dvec3(), triangle.map(Vec3::as_dvec3));
    let normal = (b - a).cross(c - a);
    let foot = p - normal * (p - a).dot(normal) / normal.length_squared();
    let sides = [[a, b], [b, c], [c, a]];
    if sides.iter().all(|[u, v]| (v - u).cross(foot - u).dot(normal) >= 0.0) {
        return foot.distance(p);
    }
    let on_side = |[u, v]: [DVec3; 2]| u.lerp(v, ((p - u).dot(v - u) / u.distance_squared(v)).clamp(0.0, 1.0));
    sides.into_iter().map(|side| on_side(side).distance(p)).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn a_mesh_is_as_far_as_the_nearest_of_its_triangles_less_half_its_thickness(
        vertices in prop::collection::vec(vector(-1.0..1.0), 30), p in vector(-2.0..2.0), thickness in 0.01_f32..0.2
    ) {
        let indices: Vec<u32> = (0..30).collect();
        let shape = Shape::triangle_mesh(&vertices, &indices, thickness).unwrap();
        let (triangles, _) = vertices.as_chunks::<3>();
        let nearest = triangles.iter().map(|t| distance_to_triangle(p, *t)).fold(f64::INFINITY, f64::min) as f32;
        let (distance, normal) = shape.distance_and_normal(p);
        prop_assert!((distance - (nearest - thickness / 2.0)).abs() < 1e-5, "{distance}, not {nearest} less half of {thickness}");
        prop_assert!((normal.length() - 1.0).abs() < 1e-5);
        let foot = p - normal * nearest;
        let off = triangles.iter().map(|t| distance_to_triangle(foot, *t)).fold(f64::INFINITY, f64::min);
        prop_assert!(off < 1e-4, "the foot of {p} is {off} m off the triangles");
    }

    #[test]
    fn the_hull_of_points_holds_them_all_and_has_its_corners_among_them(
        points in prop::collection::vec(vector(-1.0..1.0), 4..60), others in prop::collection::vec(vector(-2.0..2.0), 10)
    ) {
        let shape = Shape::hull(&points);
        // Four points may lie nearly in one plane.
        prop_assume!(shape.is_ok());
        let Ok(Shape::Convex(hull)) = shape else { unreachable!() };
        prop_assert_eq!(hull.corners.len() + hull.planes.len(), hull.edges.len() + 2, "Euler's formula");
        for corner in &hull.corners {
            prop_assert!(points.contains(corner));
        }
        for p in &points {
            prop_assert!(hull.distance_and_normal(*p).0 < 1e-5);
        }
        // Where two edges are equally near to the rounding of a square, the normal is known to the root of that.
        for p in others {
            let (distance, normal) = hull.distance_and_normal(p);
            let gap = hull.corners.iter().map(|c| normal.dot(p - *c)).fold(f32::INFINITY, f32::min);
            prop_assert!((gap - distance).abs() < 1e-3 || distance < 0.0, "{gap} m off all corners along the normal, not {distance}");
        }
    }

    /// Points on a lattice: many in one plane, on one line, and twice at one place.
    #[test]
    fn the_hull_of_points_on_a_lattice_holds_them_all(
        points in prop::collection::vec(prop::array::uniform3(-2_i8..3), 4..80), scale in prop::array::uniform3(0.01_f32..100.0)
    ) {
        let points: Vec<Vec3> = points.into_iter().map(|p| Vec3::from(p.map(f32::from)) * Vec3::from(scale)).collect();
        if let Ok(Shape::Convex(hull)) = Shape::hull(&points) {
            let reach = hull.radius;
            prop_assert!(points.iter().all(|p| hull.distance_and_normal(*p).0 <= 1e-5 * reach));
            prop_assert_eq!(hull.corners.len() + hull.planes.len(), hull.edges.len() + 2, "Euler's formula");
        }
    }
}

#[test]
fn the_hull_of_the_corners_of_a_box_and_points_within_is_that_box() {
    let corner = |i: u32| Vec3::from_array([0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 0.5 } else { -0.5 }));
    let inner = (0..100).map(|i| corner(i % 8) * 0.01 * i as f32);
    let points: Vec<Vec3> = (0..8).map(corner).chain(inner).collect();
    let Shape::Convex(hull) = Shape::hull(&points).unwrap() else { panic!("a hull") };
    assert_eq!((hull.planes.len(), hull.corners.len(), hull.edges.len()), (6, 8, 12));
    let cuboid = Shape::cuboid(Vec3::ONE).unwrap();
    for p in [Vec3::ONE, Vec3::new(0.3, 0.1, -2.0), Vec3::new(0.1, 0.2, 0.4)] {
        let (found, expected) = (hull.distance_and_normal(p), cuboid.distance_and_normal(p));
        assert!((found.0 - expected.0).abs() < 1e-6 && found.1.distance(expected.1) < 1e-6);
    }
}

fn field<T: core::fmt::Debug>(result: Result<T, ClothError>) -> &'static str {
    match result {
        Err(ClothError::OutOfRange { field, .. } | ClothError::NoTriangles { field }) => field,
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_is_no_hull_is_refused() {
    let square = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
    assert_eq!(field(Shape::hull(&square[..3])), "ClothCollider::Hull.points.len()");
    let flat = Shape::hull(&square);
    assert!(matches!(flat, Err(ClothError::OutOfRange { value: 0.0, .. })), "{flat:?}");
    assert_eq!(field(flat), "depth of ClothCollider::Hull.points");
    assert_eq!(field(Shape::hull(&[Vec3::ONE; 8])), "depth of ClothCollider::Hull.points");
    let line = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| Vec3::ONE * x);
    assert_eq!(field(Shape::hull(&line)), "depth of ClothCollider::Hull.points");
    assert_eq!(field(Shape::hull(&[2e4 * Vec3::X, Vec3::X, Vec3::Y, Vec3::Z])), "reach of ClothCollider::Hull.points");
    let nan = Shape::hull(&[Vec3::NAN, Vec3::X, Vec3::Y, Vec3::Z]);
    assert!(matches!(nan, Err(ClothError::VertexNotFinite { vertex: 0, .. })));
    let ball: Vec<Vec3> = (0..2000)
        .map(|i| Quat::from_rotation_y(0.7 * i as f32) * Quat::from_rotation_x(0.3 * i as f32) * Vec3::Z)
        .collect();
    assert_eq!(field(Shape::hull(&ball)), "number of faces of ClothCollider::Hull");
}

#[test]
fn what_is_no_mesh_or_height_field_is_refused() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    assert_eq!(field(Shape::triangle_mesh(&corners, &[0, 1, 2], 0.0)), "ClothCollider::Mesh.thickness");
    assert_eq!(field(Shape::triangle_mesh(&corners, &[], 0.01)), "ClothCollider::Mesh");
    assert_eq!(field(Shape::triangle_mesh(&corners, &[0, 1, 1], 0.01)), "ClothCollider::Mesh");
    assert!(matches!(Shape::triangle_mesh(&corners, &[0, 1], 0.01), Err(ClothError::NotTriangleList { .. })));
    let far = Shape::triangle_mesh(&corners, &[0, 1, 3], 0.01);
    assert!(matches!(far, Err(ClothError::IndexOutOfRange { triangle: 0, index: 3, vertices: 3 })));
    let field_of =
        |size, cells, heights: &[f32], thickness| field(Shape::height_field(size, cells, heights, thickness));
    assert_eq!(field_of(Vec2::new(0.0, 1.0), UVec2::ONE, &[0.0; 4], 0.01), "ClothCollider::HeightField.size.x");
    assert_eq!(field_of(Vec2::ONE, UVec2::new(1, 0), &[0.0; 4], 0.01), "ClothCollider::HeightField.cells.y");
    assert_eq!(field_of(Vec2::ONE, UVec2::ONE, &[0.0; 3], 0.01), "ClothCollider::HeightField.heights.len()");
    assert_eq!(field_of(Vec2::ONE, UVec2::ONE, &[2e4; 4], 0.01), "ClothCollider::HeightField.heights");
    assert_eq!(field_of(Vec2::ONE, UVec2::ONE, &[0.0; 4], f32::NAN), "ClothCollider::HeightField.thickness");
}

/// A ball of triangles: vertices and indices.
fn ball(radius: f32, rings: u32) -> (Vec<Vec3>, Vec<u32>) {
    let around = 2 * rings;
    let mut vertices = Vec::new();
    for (i, j) in (0..=rings).flat_map(|i| (0..=around).map(move |j| (i, j))) {
        let (up, turn) = (0.5 * TAU * i as f32 / rings as f32, TAU * j as f32 / around as f32);
        vertices.push(radius * Vec3::new(up.sin() * turn.cos(), up.cos(), up.sin() * turn.sin()));
    }
    let at = |i: u32, j: u32| i * (around + 1) + j;
    let quads = (0..rings).flat_map(|i| (0..around).map(move |j| (i, j)));
    let indices =
        quads.flat_map(|(i, j)| [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]);
    (vertices, indices.collect())
}

/// Ridges and furrows along z, half a metre apart and 0.3 m high, of `cells` along a side of `size` m.
fn ridges(size: f32, cells: u32, thickness: f32) -> Shape {
    let height = |i: u32| {
        let x = (i % (cells + 1)) as f32 / cells as f32 * size - size / 2.0;
        0.3 * (1.0 - 4.0 * ((x / 0.5).rem_euclid(1.0) - 0.5).abs()).abs() - 0.3
    };
    let heights: Vec<f32> = (0..(cells + 1).pow(2)).map(height).collect();
    Shape::height_field(Vec2::splat(size), UVec2::splat(cells), &heights, thickness).unwrap()
}

fn laid(shape: &Shape, rotation: Quat, above: f32) -> Cloth {
    let mut cloth = rectangle(0.8, 0.8, cases(24, 32), cases(24, 32), &POPLIN);
    place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.01, above, 0.02));
    let ground = collider(Shape::HalfSpace, Vec3::Y * -0.6, Quat::IDENTITY, POPLIN.friction);
    cloth.contacts.set_colliders([collider(shape.clone(), Vec3::ZERO, rotation, POPLIN.friction), ground]);
    cloth
}

/// How far the deepest point of a triangle is inside of `shape`, m.
fn deepest(cloth: &Cloth, shape: &Shape, rotation: Quat) -> f32 {
    let steps = 6;
    let shares = (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| [i, j].map(|k| k as f32 / steps as f32)));
    let shares: Vec<[f32; 2]> = shares.collect();
    let points = cloth.topology.triangles.iter().flat_map(|triangle| {
        let [a, b, c] = triangle.map(|slot| cloth.particles.position.get(slot as usize));
        shares.iter().map(move |[u, v]| a * (1.0 - u - v) + b * *u + c * *v)
    });
    points.map(|x| -shape.distance_and_normal(rotation.inverse() * x).0).fold(f32::NEG_INFINITY, f32::max)
}

#[test]
fn cloth_rests_on_hulls_meshes_and_height_fields() {
    let tilted = Quat::from_rotation_x(0.6) * Quat::from_rotation_z(0.5);
    let (round, triangles) = ball(0.2, 12);
    let rock: Vec<Vec3> = ball(0.2, 5).0.into_iter().map(|p| p * Vec3::new(1.0, 0.6, 1.2)).collect();
    let tent = [(-0.3, -0.2), (0.0, 0.1), (0.3, -0.2)].map(|(x, y)| [-0.3, 0.3].map(|z| Vec3::new(x, y, z))).concat();
    let panels = [0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5];
    let sheet =
        [Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, 0.0, -0.2), Vec3::new(-0.2, 0.0, 0.2), Vec3::new(0.2, 0.0, 0.2)];
    let solids = [
        ("the hull of a rock", Shape::hull(&rock).unwrap(), tilted),
        ("a ball of triangles", Shape::triangle_mesh(&round, &triangles, 0.01).unwrap(), Quat::IDENTITY),
        ("the ridge of a tent", Shape::triangle_mesh(&tent, &panels, 0.01).unwrap(), Quat::IDENTITY),
        (
            "the edge of a sheet",
            Shape::triangle_mesh(&sheet, &[0, 1, 2, 2, 1, 3], 0.01).unwrap(),
            Quat::from_rotation_x(FRAC_PI_2),
        ),
        ("a sheet", Shape::triangle_mesh(&sheet, &[0, 1, 2, 2, 1, 3], 0.02).unwrap(), Quat::IDENTITY),
        ("ridges", ridges(2.0, 16, 0.02), Quat::IDENTITY),
        ("fine ridges", ridges(2.0, 128, 0.02), Quat::IDENTITY),
    ];
    let mut failures = Vec::new();
    for (name, shape, rotation) in solids.into_iter().step_by(cases(3, 1)) {
        let mut cloth = laid(&shape, rotation, 0.3);
        run(&mut cloth, cases(7.0, 12.0));
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest(&cloth, &shape, rotation));
        let line = format!("{name}: {speed} m/s, {depth} m deep, {} contacts", cloth.contacts.touching);
        let is_at_rest = speed < 0.03 && depth < 1e-4 && cloth.contacts.touching > 20;
        failures.extend((!is_at_rest).then_some(line));
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(2, 8), failure_persistence: None, rng_seed: RngSeed::Fixed(18), ..ProptestConfig::default() })]

    /// In a furrow or a hollow what is pushed off one side goes into the others.
    #[test]
    fn cloth_in_furrows_and_hollows_is_on_all_their_sides_at_once(
        (half, waves) in (1_u32..5, 2_u32..5), steep in 0.7_f32..1.5, is_hollow: bool,
        cells in 16_u32..32, preset in 0..Fabric::PRESETS.len(), at in vector(0.0..0.1)
    ) {
        let (_, fabric) = Fabric::PRESETS[preset];
        // Waves of straight slopes, so many fields long each.
        let fields = 2 * half * waves;
        let (field, size) = (1.2 / fields as f32, Vec2::splat(1.2));
        let wave = |i: u32| steep * field * (i % (2 * half)).abs_diff(half) as f32;
        let height = |i: u32| {
            let [x, z] = [i % (fields + 1), i / (fields + 1)].map(wave);
            if is_hollow { 0.5 * (x + z) } else { x }
        };
        let heights: Vec<f32> = (0..(fields + 1).pow(2)).map(height).collect();
        let shape = Shape::height_field(size, UVec2::splat(fields), &heights, 0.02).unwrap();
        let mut cloth = rectangle(0.8, 0.8, cells, cells, &fabric);
        let highest = steep * field * half as f32;
        place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), at + Vec3::Y * (highest + 0.05));
        let ground = collider(Shape::HalfSpace, Vec3::Y * -0.6, Quat::IDENTITY, fabric.friction);
        cloth.contacts.set_colliders([collider(shape.clone(), Vec3::ZERO, Quat::IDENTITY, fabric.friction), ground]);
        run(&mut cloth, 5.0);
        let (speed, depth) = (measure::rms_speed(&cloth.topology, &cloth.particles), deepest(&cloth, &shape, Quat::IDENTITY));
        prop_assert!(speed < 0.05 && depth < 1e-5, "{speed} m/s, {depth} m deep");
    }
}

#[test]
fn cloth_thrown_at_a_wall_of_triangles_stays_on_its_side() {
    let (round, triangles) = ball(0.3, 10);
    let shapes = [
        Shape::triangle_mesh(&round, &triangles, 0.005).unwrap(),
        ridges(2.0, 16, 0.005),
        Shape::triangle_mesh(&[Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::Z], &[0, 1, 2], 0.002)
            .unwrap(),
    ];
    for (which, shape) in shapes.iter().enumerate() {
        for speed in [1.0, 5.0, 20.0, 50.0].into_iter().step_by(cases(2, 1)) {
            for side in [1.0, -1.0] {
                let mut cloth = rectangle(0.3, 0.3, 12, 12, &POPLIN);
                place(&mut cloth, Quat::from_rotation_x(-1.3), Vec3::new(0.03, 0.6 * side, -0.02));
                cloth.particles.velocity.fill(Vec3::NEG_Y * speed * side);
                cloth.contacts.set_colliders([collider(shape.clone(), Vec3::ZERO, Quat::IDENTITY, 0.3)]);
                let mut passed = 0;
                for _ in 0..(0.6 / speed / TICK.dt).ceil() as u32 + 20 {
                    let before = positions(&cloth);
                    cloth.step(TICK, Vec3::ZERO);
                    let Shape::Mesh(mesh) = shape else { panic!("a mesh") };
                    // A way through the middle of the wall and back again is one around a ridge.
                    for (from, to) in before.iter().zip(positions(&cloth)) {
                        passed += mesh.triangles().filter(|t| passes(*t, *from, to)).count() % 2;
                    }
                }
                assert_eq!(passed, 0, "shape {which} at {speed} m/s from {side}");
                assert!(deepest(&cloth, shape, Quat::IDENTITY) < 1e-3, "shape {which} at {speed} m/s from {side}");
            }
        }
    }
}

/// Whether a straight way passes through a triangle.
fn passes([a, b, c]: [Vec3; 3], from: Vec3, to: Vec3) -> bool {
    let across = (b - a).cross(c - a);
    let [low, high] = [from, to].map(|end| across.dot(end - a));
    if (low < 0.0) == (high < 0.0) {
        return false;
    }
    let place = from.lerp(to, low / (low - high));
    [[a, b], [b, c], [c, a]].iter().all(|[u, v]| (*u - place).cross(*v - place).dot(across) > 0.0)
}

#[test]
fn a_needle_of_a_mesh_does_not_slip_through_between_particles() {
    // A spike that is thinner than a cell.
    let spike = [Vec3::new(-0.02, -0.3, 0.0), Vec3::new(0.02, -0.3, 0.0), Vec3::ZERO];
    for speed in [1.0, 10.0, 50.0] {
        let shape = Shape::triangle_mesh(&spike, &[0, 1, 2], 0.004).unwrap();
        let mut cloth = rectangle(0.5, 0.5, 10, 10, &POPLIN);
        place(&mut cloth, Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.013, 0.1, 0.021));
        let mut at = -0.1_f32;
        while at < 0.15 {
            let next = at + speed * TICK.dt;
            let pose = |y: f32| cloth_solver::Pose::new(Vec3::Y * y, Quat::IDENTITY);
            let motion = cloth_solver::Motion { from: pose(at), to: pose(next) };
            cloth.contacts.set_colliders([cloth_solver::contact::Collider {
                shape: shape.clone(),
                motion,
                friction: 0.3,
            }]);
            cloth.step(TICK, Vec3::ZERO);
            at = next;
            let tip = Vec3::Y * at;
            let through =
                cloth.topology.triangles.iter().any(|t| {
                    passes(t.map(|slot| cloth.particles.position.get(slot as usize)), tip, tip - Vec3::Y * 0.25)
                });
            assert!(!through, "the tip is through at {speed} m/s");
        }
    }
}
