//! Convex solids.

use glam::{DMat3, DVec3, Vec2, Vec3};

use crate::ClothError;

/// Half-spaces of one solid at most: the cost of contact grows with them.
const MAX_PLANES: usize = 64;

/// How far from the origin of its frame a solid may reach, m.
const MAX_REACH: f64 = 1e4;

/// Corners nearer to each other, or to a plane, than this fraction of the solid's reach are one, or on it. An order of
/// magnitude above what the rounding of an f32 normal moves its plane at that distance.
const COINCIDENT: f64 = 1e-6;

/// Sine of the angle below which the directions of f32 normals are the same, an order of magnitude above their
/// rounding.
const PARALLEL: f64 = 1e-6;

/// A convex solid as the intersection of half-spaces, with its corners.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexHull {
    /// Outward unit normals and offsets: inside is `n · p <= d` for all, m.
    pub planes: Vec<(Vec3, f32)>,
    /// Corners, m.
    pub corners: Vec<Vec3>,
    /// Edges as pairs of corners.
    pub edges: Vec<[u32; 2]>,
    /// Radius of the sphere around the origin of the frame that holds all corners, m.
    pub radius: f32,
    /// Radius of a ball within, about the mean of the corners, m.
    pub(crate) inner_radius: f32,
    /// For each edge the directions from it into its two faces, of unit length.
    pub(crate) into_faces: Vec<[Vec3; 2]>,
}

impl ConvexHull {
    fn new(planes: Vec<(Vec3, f32)>, corners: Vec<Vec3>, edges: Vec<[u32; 2]>) -> Self {
        let radius = corners.iter().map(|corner| corner.length()).fold(0.0, f32::max);
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f32;
        let inner_radius = planes.iter().map(|(n, d)| d - n.dot(middle)).fold(f32::INFINITY, f32::min);
        let into_faces = edges.iter().map(|edge| into_faces(&planes, edge.map(|i| corners[i as usize]))).collect();
        Self { planes, corners, edges, radius, inner_radius, into_faces }
    }

    /// A box of half its size, m. Corner `i` lies at +x, +y, +z where bit 0, 1, 2 of `i` is set.
    pub(super) fn cuboid(half: Vec3) -> Self {
        let signs = |i: u32| Vec3::from([0, 1, 2].map(|bit| if i >> bit & 1 == 1 { 1.0 } else { -1.0 }));
        let planes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|n| [(n, n.dot(half)), (-n, n.dot(half))]);
        let edges = (0..8).flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit])).filter(|[a, b]| a != b);
        Self::new(planes.collect(), (0..8).map(|i| signs(i) * half).collect(), edges.collect())
    }

    /// A pyramid of half its base (x, z) and half its height, m; the apex is corner 4.
    pub(super) fn pyramid(half: Vec2, half_height: f32) -> Self {
        let corner = |x: f32, z: f32| Vec3::new(x * half.x, -half_height, z * half.y);
        let corners =
            vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0), Vec3::Y * half_height];
        let side = |outward: Vec3, half: f32| {
            let normal = (outward * (2.0 * half_height) + Vec3::Y * half).normalize();
            (normal, normal.y * half_height)
        };
        let planes = vec![
            (Vec3::NEG_Y, half_height),
            side(Vec3::X, half.x),
            side(Vec3::NEG_X, half.x),
            side(Vec3::Z, half.y),
            side(Vec3::NEG_Z, half.y),
        ];
        Self::new(planes, corners, vec![[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]])
    }

    /// The intersection of half-spaces `n · p <= d` with normals of any length.
    pub(super) fn intersection(planes: &[(Vec3, f32)]) -> Result<Self, ClothError> {
        let planes = distinct_unit(planes)?;
        // Without tolerance, planes that meet in one corner meet in several; enough to tell how large the solid is.
        let tolerance = COINCIDENT * reach(&corners(&planes, f64::EPSILON * MAX_REACH));
        let corners = corners(&planes, tolerance);
        check_solid(&planes, &corners, tolerance)?;
        let touches = |plane: &(DVec3, f64), corner: &DVec3| (plane.0.dot(*corner) - plane.1).abs() <= tolerance;
        // A plane that bounds the solid has a face, and a face has three corners.
        let planes: Vec<(DVec3, f64)> = planes
            .into_iter()
            .filter(|plane| corners.iter().filter(|corner| touches(plane, corner)).count() >= 3)
            .collect();
        // Two faces that share two corners share the edge between them.
        let is_edge = |a: &DVec3, b: &DVec3| planes.iter().filter(|p| touches(p, a) && touches(p, b)).count() >= 2;
        let pairs = (0..corners.len()).flat_map(|a| (a + 1..corners.len()).map(move |b| [a, b]));
        let edges = pairs.filter(|[a, b]| is_edge(&corners[*a], &corners[*b])).map(|edge| edge.map(|i| i as u32));
        let edges = edges.collect();
        let planes = planes.iter().map(|(n, d)| (n.as_vec3(), *d as f32)).collect();
        Ok(Self::new(planes, corners.iter().map(|c| c.as_vec3()).collect(), edges))
    }

    /// Signed distance from the surface to `p` (negative inside), m, and the outward normal there, of unit length.
    ///
    /// Outside it is the Euclidean distance to the nearest face, edge or corner; inside the plane of least depth.
    pub fn distance_and_normal(&self, p: Vec3) -> (f32, Vec3) {
        let (height, normal) = (self.planes.iter())
            .map(|(n, d)| (n.dot(p) - d, *n))
            .fold((f32::NAN, Vec3::Y), |most, plane| if most.0 >= plane.0 { most } else { plane });
        // No point of the solid is nearer than the plane that separates it most: if the foot on that plane belongs to
        // the solid, it is the nearest point, and no other face can have one.
        let (foot, rounding) = (p - normal * height, 4.0 * f32::EPSILON * self.radius);
        if height <= 0.0 || self.planes.iter().all(|(n, d)| *n == normal || n.dot(foot) <= d + rounding) {
            return (height, normal);
        }
        let mut nearest = (f32::INFINITY, Vec3::ZERO);
        for [a, b] in self.edges.iter().map(|edge| edge.map(|i| self.corners[i as usize])) {
            let along = (p - a).dot(b - a) / a.distance_squared(b);
            let away = p - a.lerp(b, along.clamp(0.0, 1.0));
            if away.length_squared() < nearest.0 {
                nearest = (away.length_squared(), away);
            }
        }
        // A difference as small as its rounding has no direction, nor has one whose square leaves the range of f32.
        let distance = nearest.0.sqrt();
        if distance.is_finite() && distance > f32::EPSILON * self.radius {
            (distance, nearest.1 / distance)
        } else {
            (height, normal)
        }
    }
}

/// The directions from an edge into its two faces: the two planes nearest to both of its ends. The way into one is the way below
/// the other.
fn into_faces(planes: &[(Vec3, f32)], [a, b]: [Vec3; 2]) -> [Vec3; 2] {
    let mut nearest = [(f32::INFINITY, Vec3::ZERO); 2];
    for (n, d) in planes {
        let off = (n.dot(a) - d).abs() + (n.dot(b) - d).abs();
        if off < nearest[0].0 {
            nearest = [(off, *n), nearest[0]];
        } else if off < nearest[1].0 {
            nearest[1] = (off, *n);
        }
    }
    let [m, n] = nearest.map(|(_, normal)| normal);
    [(m * m.dot(n) - n).normalize_or_zero(), (n * m.dot(n) - m).normalize_or_zero()]
}

/// The planes with unit normals; of those that face the same way only the innermost.
fn distinct_unit(planes: &[(Vec3, f32)]) -> Result<Vec<(DVec3, f64)>, ClothError> {
    let count = planes.len() as f32;
    ClothError::check("ClothCollider::Convex.planes.len()", count, 4.0..=MAX_PLANES as f32, "4..=64")?;
    let mut distinct: Vec<(DVec3, f64)> = Vec::with_capacity(planes.len());
    for (normal, offset) in planes {
        let length = normal.as_dvec3().length();
        let [field, allowed] = ["length of a normal of ClothCollider::Convex.planes", "above 0 and finite"];
        ClothError::check(field, length as f32, f32::MIN_POSITIVE..=f32::MAX, allowed)?;
        let (unit, offset) = (normal.as_dvec3() / length, f64::from(*offset) / length);
        let field = "offset of ClothCollider::Convex.planes by normals of length 1";
        ClothError::check(field, offset as f32, -1e4..=1e4, "-1e4..=1e4 m")?;
        match distinct.iter_mut().find(|(other, _)| other.distance(unit) < PARALLEL) {
            Some(same) if offset < same.1 => *same = (unit, offset),
            Some(_) => {}
            None => distinct.push((unit, offset)),
        }
    }
    Ok(distinct)
}

/// The corners of the intersection of `planes` with the cube of half-size [`MAX_REACH`], which makes it bounded.
fn corners(planes: &[(DVec3, f64)], tolerance: f64) -> Vec<DVec3> {
    let cube = DMat3::IDENTITY.to_cols_array_2d().map(DVec3::from);
    let cube = cube.into_iter().flat_map(|n| [(n, MAX_REACH), (-n, MAX_REACH)]);
    let all: Vec<(DVec3, f64)> = planes.iter().copied().chain(cube).collect();
    let mut corners: Vec<DVec3> = Vec::new();
    for (k, c) in all.iter().enumerate() {
        for (j, b) in all[..k].iter().enumerate() {
            for a in &all[..j] {
                let normals = DMat3::from_cols(a.0, b.0, c.0).transpose();
                if normals.determinant().abs() < PARALLEL {
                    continue;
                }
                let corner = normals.inverse() * DVec3::new(a.1, b.1, c.1);
                let inside = all.iter().all(|(n, d)| n.dot(corner) <= d + tolerance);
                if inside && corners.iter().all(|other| other.distance(corner) > tolerance) {
                    corners.push(corner);
                }
            }
        }
    }
    corners
}

/// The largest coordinate of any corner, m.
fn reach(corners: &[DVec3]) -> f64 {
    corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max)
}

/// `Ok` if the corners span a bounded solid.
fn check_solid(planes: &[(DVec3, f64)], corners: &[DVec3], tolerance: f64) -> Result<(), ClothError> {
    let count = corners.len() as f32;
    ClothError::check("number of corners of ClothCollider::Convex", count, 4.0..=f32::MAX, "4 or more")?;
    let reach = reach(corners);
    if reach >= MAX_REACH - tolerance {
        let [field, allowed] = ["reach of ClothCollider::Convex", "below 1e4 m: half-spaces that enclose a solid"];
        return Err(ClothError::OutOfRange { field, value: reach as f32, allowed });
    }
    let middle = corners.iter().sum::<DVec3>() / f64::from(count);
    let depth = planes.iter().map(|(n, d)| d - n.dot(middle)).fold(f64::INFINITY, f64::min);
    if depth <= tolerance {
        let [field, allowed] = ["depth of ClothCollider::Convex", "above 1e-6 of its reach"];
        return Err(ClothError::OutOfRange { field, value: depth as f32, allowed });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    /// The point of triangle `abc` nearest to `p`, by the regions of Ericson, *Real-Time Collision Detection* 5.1.5, in
    /// the slow form: the foot on the plane if it is inside, else the nearest of three segments.
    fn nearest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
        let normal = (b - a).cross(c - a);
        let foot = p - normal * (p - a).dot(normal) / normal.length_squared();
        let inside = [[a, b], [b, c], [c, a]].iter().all(|[u, v]| (v - u).cross(foot - u).dot(normal) >= 0.0);
        if inside && foot.is_finite() {
            return foot;
        }
        let on_segment = |[u, v]: [DVec3; 2]| u.lerp(v, ((p - u).dot(v - u) / u.distance_squared(v)).clamp(0.0, 1.0));
        let feet = [[a, b], [b, c], [c, a]].map(on_segment);
        feet.into_iter().min_by(|u, v| u.distance(p).total_cmp(&v.distance(p))).unwrap()
    }

    /// Distance from `p` to a solid it is outside of: the smallest to any triangle of corners, each of which lies in the
    /// solid, and some of which are its faces.
    fn brute_force_distance(hull: &ConvexHull, p: Vec3) -> f32 {
        let corners: Vec<DVec3> = hull.corners.iter().map(|c| c.as_dvec3()).collect();
        let mut smallest = f64::INFINITY;
        for i in 0..corners.len() {
            for j in 0..i {
                for k in 0..j {
                    let triangle = [corners[i], corners[j], corners[k]];
                    smallest = smallest.min(nearest_on_triangle(p.as_dvec3(), triangle).distance(p.as_dvec3()));
                }
            }
        }
        smallest as f32
    }

    fn check_distance(hull: &ConvexHull, p: Vec3) -> Result<(), TestCaseError> {
        let (distance, normal) = hull.distance_and_normal(p);
        prop_assert!((normal.length() - 1.0).abs() < 1e-5);
        let foot = p - normal * distance;
        let height = |p: Vec3| hull.planes.iter().map(|(n, d)| n.dot(p) - d).fold(f32::NEG_INFINITY, f32::max);
        if height(p) > 0.0 {
            let expected = brute_force_distance(hull, p);
            prop_assert!((distance - expected).abs() < 1e-4, "{distance} instead of {expected} at {p}");
            prop_assert!(height(foot) < 1e-4, "the foot {foot} of {p} is {} outside", height(foot));
        } else {
            prop_assert_eq!(distance, height(p));
        }
        Ok(())
    }

    fn vector(range: core::ops::Range<f32>) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(range).prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

        #[test]
        fn the_distance_to_a_box_or_pyramid_is_what_brute_force_finds(
            half in vector(0.1..2.0), points in prop::collection::vec(vector(-4.0..4.0), 20),
        ) {
            for hull in [ConvexHull::cuboid(half), ConvexHull::pyramid(Vec2::new(half.x, half.z), half.y)] {
                points.iter().try_for_each(|p| check_distance(&hull, *p))?;
            }
        }

        #[test]
        fn any_solid_obeys_eulers_formula_and_brute_force(
            cuts in prop::collection::vec((vector(-1.0..1.0), 0.3_f32..1.5), 0..8),
            points in prop::collection::vec(vector(-3.0..3.0), 5),
        ) {
            let cube = ConvexHull::cuboid(Vec3::ONE).planes;
            let cuts = cuts.into_iter().filter(|(n, _)| n.length() > 0.1).map(|(n, d)| (n, d * n.length()));
            let hull = ConvexHull::intersection(&cube.into_iter().chain(cuts).collect::<Vec<_>>()).unwrap();
            prop_assert_eq!(hull.corners.len() + hull.planes.len(), hull.edges.len() + 2, "{:?}", hull);
            points.iter().try_for_each(|p| check_distance(&hull, *p))?;
        }
    }

    /// Corners and edges as places, in an order of their own.
    fn places(hull: &ConvexHull) -> (Vec<[i32; 3]>, Vec<[[i32; 3]; 2]>) {
        let place = |c: &Vec3| (*c * 1e4).round().as_ivec3().to_array();
        let mut corners: Vec<_> = hull.corners.iter().map(place).collect();
        let mut edges: Vec<_> = (hull.edges.iter())
            .map(|edge| edge.map(|i| place(&hull.corners[i as usize])))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        corners.sort_unstable();
        edges.sort_unstable();
        (corners, edges)
    }

    #[test]
    fn boxes_and_pyramids_are_the_intersections_of_their_own_planes() {
        for hull in [
            ConvexHull::cuboid(Vec3::new(0.5, 1.0, 2.0)),
            ConvexHull::pyramid(Vec2::new(0.5, 0.7), 1.0),
            ConvexHull::pyramid(Vec2::new(2.0, 1.5), 0.05),
        ] {
            let again = ConvexHull::intersection(&hull.planes).unwrap();
            assert_eq!(places(&again), places(&hull));
            assert!((again.radius - hull.radius).abs() < 1e-5);
            assert_eq!(again.planes.len(), hull.planes.len());
        }
    }

    #[test]
    fn a_half_space_that_cuts_nothing_off_is_dropped() {
        let cube = ConvexHull::cuboid(Vec3::ONE);
        let (corner, edge) = ((Vec3::ONE, 3.0), (Vec3::new(1.0, 1.0, 0.0), 2.0));
        for idle in [(Vec3::X, 1.5), (Vec3::X * 3.0, 3.0), (Vec3::ONE, 9.0), corner, edge] {
            let mut planes = cube.planes.clone();
            planes.insert(0, idle);
            let hull = ConvexHull::intersection(&planes).unwrap();
            assert_eq!(hull.planes.len(), 6, "{idle:?}");
            assert_eq!(places(&hull), places(&cube), "{idle:?}");
        }
    }

    #[test]
    fn half_spaces_that_enclose_no_solid_are_refused() {
        let cube = ConvexHull::cuboid(Vec3::ONE).planes;
        let refused = |planes: &[(Vec3, f32)]| match ConvexHull::intersection(planes) {
            Err(ClothError::OutOfRange { field, .. }) => field,
            other => panic!("{other:?}"),
        };
        let with = |plane| cube.iter().copied().chain([plane]).collect::<Vec<_>>();
        assert!(refused(&[]).contains("planes.len()"));
        assert!(refused(&cube[..5]).contains("reach"));
        assert!(refused(&cube[..4]).contains("reach"));
        assert!(refused(&with((Vec3::X, -1.5))).contains("corners"));
        assert!(refused(&with((Vec3::X, -1.0))).contains("depth"));
        assert!(refused(&with((Vec3::ZERO, 1.0))).contains("normal"));
        assert!(refused(&with((Vec3::NAN, 1.0))).contains("normal"));
        assert!(refused(&with((Vec3::X, f32::NAN))).contains("offset"));
    }
}
