//! The forms a collider can have.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::ClothError;

mod bound;
mod curved;
mod ellipsoid;
mod faces;
mod hull;
mod mesh;
pub(crate) mod segment;
#[cfg(feature = "parry")]
mod solids;
mod tree;

pub use curved::{Curved, Form};
pub use hull::ConvexHull;
pub use mesh::TriangleMesh;

/// The form of a collider, in its own frame, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball around the origin.
    Sphere {
        /// Radius, m.
        radius: f32,
    },
    /// A cylinder along y with half a ball at each end.
    Capsule {
        /// Radius, m.
        radius: f32,
        /// Half the distance between the centres of the two half-balls, m.
        half_length: f32,
    },
    /// A convex solid: box, pyramid, or any other.
    Convex(Arc<ConvexHull>),
    /// A convex solid with a curved surface: cylinder, cone, ellipsoid, rounded box.
    Curved(Arc<Curved>),
    /// Everything below y = 0: solid ground.
    HalfSpace,
    /// A wall along a triangle mesh or a height field.
    Mesh(Arc<TriangleMesh>),
}

/// `Ok` if `value` is a size a collider may have, 1e-4..=1e4 m.
fn check_size(field: &'static str, value: f32) -> Result<(), ClothError> {
    ClothError::check(field, value, 1e-4..=1e4, "1e-4..=1e4 m")
}

impl Shape {
    /// A ball; `radius` in 1e-4..=1e4 m.
    pub fn sphere(radius: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::Sphere.radius", radius)?;
        Ok(Self::Sphere { radius })
    }

    /// A capsule along y of `radius` (1e-4..=1e4 m) and overall length `length` between the centres of its half-balls
    /// (0..=1e4 m; 0 is a ball).
    pub fn capsule(radius: f32, length: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::Capsule.radius", radius)?;
        ClothError::check("ClothCollider::Capsule.length", length, 0.0..=1e4, "0..=1e4 m")?;
        Ok(Self::Capsule { radius, half_length: length / 2.0 })
    }

    /// A box centred on the origin with edge lengths `size`, m, each 1e-4..=1e4.
    pub fn cuboid(size: Vec3) -> Result<Self, ClothError> {
        check_size("ClothCollider::Cuboid.size.x", size.x)?;
        check_size("ClothCollider::Cuboid.size.y", size.y)?;
        check_size("ClothCollider::Cuboid.size.z", size.z)?;
        Ok(Self::Convex(Arc::new(ConvexHull::cuboid(size / 2.0))))
    }

    /// A pyramid on a rectangular base of `base` (x, z) m, centred: base at −height/2, apex at +height/2. Each number
    /// 1e-4..=1e4 m.
    pub fn pyramid(base: Vec2, height: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::Pyramid.base.x", base.x)?;
        check_size("ClothCollider::Pyramid.base.y", base.y)?;
        check_size("ClothCollider::Pyramid.height", height)?;
        Ok(Self::Convex(Arc::new(ConvexHull::pyramid(base / 2.0, height / 2.0))))
    }

    /// A box with rounded edges, centred on the origin: `size` are its overall edge lengths, m, each 1e-4..=1e4, and `radius` that of
    /// its edges, 1e-4 m or more and less than half the shortest of them.
    pub fn rounded_cuboid(size: Vec3, radius: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::RoundedCuboid.size.x", size.x)?;
        check_size("ClothCollider::RoundedCuboid.size.y", size.y)?;
        check_size("ClothCollider::RoundedCuboid.size.z", size.z)?;
        let core = size / 2.0 - radius;
        let is_less = core.min_element() > f32::EPSILON * size.max_element();
        if !((1e-4..=1e4).contains(&radius) && is_less) {
            let [field, allowed] =
                ["ClothCollider::RoundedCuboid.radius", "1e-4 m or more and less than half the shortest edge"];
            return Err(ClothError::OutOfRange { field, value: radius, allowed });
        }
        Ok(Self::curved(Form::RoundedCuboid { core, radius }))
    }

    /// A cylinder along y of `radius` and `height`, centred on the origin; each 1e-4..=1e4 m.
    pub fn cylinder(radius: f32, height: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::Cylinder.radius", radius)?;
        check_size("ClothCollider::Cylinder.height", height)?;
        Ok(Self::curved(Form::Cylinder { radius, half_height: height / 2.0 }))
    }

    /// A cone along y: base of `radius` at −`height`/2, apex at +`height`/2; each 1e-4..=1e4 m.
    pub fn cone(radius: f32, height: f32) -> Result<Self, ClothError> {
        check_size("ClothCollider::Cone.radius", radius)?;
        check_size("ClothCollider::Cone.height", height)?;
        Ok(Self::curved(Form::Cone { radius, half_height: height / 2.0 }))
    }

    /// An ellipsoid around the origin with semi-axes `radii`, m, each 1e-4..=1e4. A [`Shape::Sphere`] if they are the same.
    pub fn ellipsoid(radii: Vec3) -> Result<Self, ClothError> {
        check_size("ClothCollider::Ellipsoid.radii.x", radii.x)?;
        check_size("ClothCollider::Ellipsoid.radii.y", radii.y)?;
        check_size("ClothCollider::Ellipsoid.radii.z", radii.z)?;
        if radii == Vec3::splat(radii.x) {
            return Ok(Self::Sphere { radius: radii.x });
        }
        Ok(Self::curved(Form::Ellipsoid { half: radii }))
    }

    fn curved(form: Form) -> Self {
        Self::Curved(Arc::new(Curved::new(form)))
    }

    /// The intersection of 4 to 64 half-spaces `n · p <= d`; must be bounded (within 1e4 m of the origin) and hold a
    /// point in its inside. The normals `n` need not have unit length; half-spaces that cut nothing off are dropped.
    pub fn convex(planes: &[(Vec3, f32)]) -> Result<Self, ClothError> {
        ConvexHull::intersection(planes).map(|hull| Self::Convex(Arc::new(hull)))
    }

    /// Signed distance from the surface to `p` (negative inside), m, and the outward normal there, of unit length.
    ///
    /// Exact outside of every shape, and inside of a ball, a capsule and an ellipsoid. Inside any other convex solid it is the plane of
    /// least depth, the way out for a shallow particle. Never NaN for a finite `p`: where all directions are equal, the normal is +y at the centre of a sphere
    /// and +x on the axis of a capsule.
    pub fn distance_and_normal(&self, p: Vec3) -> (f32, Vec3) {
        match self {
            Self::Sphere { radius } => (p.length() - radius, p.normalize_or(Vec3::Y)),
            Self::Capsule { radius, half_length } => {
                let from_axis = p - Vec3::Y * p.y.clamp(-half_length, *half_length);
                (from_axis.length() - radius, from_axis.normalize_or(Vec3::X))
            }
            Self::Convex(hull) => hull.distance_and_normal(p),
            Self::Curved(curved) => curved.distance_and_normal(p),
            Self::HalfSpace => (p.y, Vec3::Y),
            Self::Mesh(mesh) => mesh.distance_and_normal(p),
        }
    }

    /// Radius of the sphere around the origin of the frame that holds the shape, m; infinite for a half-space.
    pub fn bounding_radius(&self) -> f32 {
        match self {
            Self::Sphere { radius } => *radius,
            Self::Capsule { radius, half_length } => radius + half_length,
            Self::Convex(hull) => hull.radius,
            Self::Curved(curved) => curved.bounding_radius(),
            Self::HalfSpace => f32::INFINITY,
            Self::Mesh(mesh) => mesh.radius(),
        }
    }

    /// Radius of a ball within, m; infinite for a half-space.
    pub(crate) fn inner_radius(&self) -> f32 {
        match self {
            Self::Sphere { radius } | Self::Capsule { radius, .. } => *radius,
            Self::Convex(hull) => hull.inner_radius,
            Self::Curved(curved) => curved.inner_radius(),
            Self::HalfSpace => f32::INFINITY,
            Self::Mesh(mesh) => mesh.half_thickness(),
        }
    }

    /// The triangle mesh, if it is one.
    #[inline(always)]
    pub(crate) fn mesh(&self) -> Option<&TriangleMesh> {
        if let Self::Mesh(mesh) = self { Some(mesh) } else { None }
    }

    /// Signed distance from the surface to `p` where that is inside, m; outside it may be infinite.
    pub(crate) fn depth(&self, p: Vec3) -> f32 {
        self.mesh().map_or_else(|| self.distance_and_normal(p).0, |mesh| mesh.depth(p))
    }

    /// Whether `other` is the same shape: cheap where both share one solid.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Convex(a), Self::Convex(b)) if Arc::ptr_eq(a, b) => true,
            (Self::Curved(a), Self::Curved(b)) if Arc::ptr_eq(a, b) => true,
            (Self::Mesh(a), Self::Mesh(b)) if Arc::ptr_eq(a, b) => true,
            _ => self == other,
        }
    }

    /// The points and segments that triangles and edges of a cloth are tested against: what fits between particles.
    pub(crate) fn features(&self, points: &mut Vec<Vec3>, segments: &mut Vec<[Vec3; 2]>) {
        match self {
            Self::Sphere { .. } => points.push(Vec3::ZERO),
            Self::Capsule { half_length, .. } => {
                let ends = [Vec3::Y * -half_length, Vec3::Y * *half_length];
                points.extend(ends);
                if *half_length > 0.0 {
                    segments.push(ends);
                }
            }
            Self::Convex(_) | Self::Curved(_) => {
                if let Some((hull, _)) = self.solid() {
                    points.extend(&hull.corners);
                    segments.extend(hull.edges.iter().map(|edge| edge.map(|i| hull.corners[i as usize])));
                }
            }
            // Those of a mesh depend on where the cloth is.
            Self::HalfSpace | Self::Mesh(_) => {}
        }
    }

    /// The polyhedron whose corners and edges triangles and edges of a cloth meet, and at which distance, m.
    #[inline(always)]
    pub(crate) fn solid(&self) -> Option<(&ConvexHull, f32)> {
        match self {
            Self::Convex(hull) => Some((hull, 0.0)),
            Self::Curved(curved) => Some((curved.hull(), curved.rounding())),
            Self::Sphere { .. } | Self::Capsule { .. } | Self::HalfSpace | Self::Mesh(_) => None,
        }
    }

    /// The least radius of curvature of a surface without edges, m; `None` where there are edges.
    pub(crate) fn least_curvature_radius(&self) -> Option<f32> {
        match self {
            Self::Sphere { radius } | Self::Capsule { radius, .. } => Some(*radius),
            Self::Convex(_) | Self::Mesh(_) => None,
            Self::Curved(curved) => curved.least_curvature_radius(),
            Self::HalfSpace => Some(f32::INFINITY),
        }
    }

    /// How far the surface is from its points and segments, m.
    pub(crate) fn feature_radius(&self) -> f32 {
        match self {
            Self::Sphere { radius } | Self::Capsule { radius, .. } => *radius,
            Self::Curved(curved) => curved.rounding(),
            Self::Mesh(mesh) => mesh.half_thickness(),
            Self::Convex(_) | Self::HalfSpace => 0.0,
        }
    }

    /// Lowest and highest corner of the box along the axes that holds the shape, m.
    pub(crate) fn bounds(&self) -> [Vec3; 2] {
        match self {
            Self::Sphere { radius } => [Vec3::splat(-radius), Vec3::splat(*radius)],
            Self::Capsule { radius, half_length } => {
                let high = Vec3::new(*radius, radius + half_length, *radius);
                [-high, high]
            }
            Self::Convex(hull) => hull
                .corners
                .iter()
                .fold([Vec3::MAX, Vec3::MIN], |[low, high], corner| [low.min(*corner), high.max(*corner)]),
            Self::Curved(curved) => {
                let half = curved.half_extent();
                [-half, half]
            }
            Self::Mesh(mesh) => mesh.bounds(),
            Self::HalfSpace => [Vec3::NEG_INFINITY, Vec3::new(f32::INFINITY, 0.0, f32::INFINITY)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: (f32, Vec3), distance: f32, normal: Vec3) {
        let close = (found.0 - distance).abs() < 1e-6 && (found.1 - normal).length() < 1e-6;
        assert!(close, "found {found:?}, expected {distance} and {normal}");
    }

    #[test]
    fn a_sphere_is_as_far_as_its_centre_less_its_radius() {
        let sphere = Shape::sphere(0.5).unwrap();
        close(sphere.distance_and_normal(Vec3::X * 2.0), 1.5, Vec3::X);
        close(sphere.distance_and_normal(Vec3::NEG_Z * 0.1), -0.4, Vec3::NEG_Z);
    }

    #[test]
    fn a_capsule_is_as_far_as_its_axis_less_its_radius() {
        let capsule = Shape::capsule(0.5, 2.0).unwrap();
        close(capsule.distance_and_normal(Vec3::new(2.0, 0.7, 0.0)), 1.5, Vec3::X);
        close(capsule.distance_and_normal(Vec3::new(0.0, 3.0, 0.0)), 1.5, Vec3::Y);
        close(capsule.distance_and_normal(Vec3::new(0.0, -1.3, 0.4)), 0.0, Vec3::new(0.0, -0.6, 0.8));
        assert_eq!(Shape::capsule(0.5, 0.0).unwrap().bounding_radius(), 0.5);
    }

    #[test]
    fn the_ground_is_everything_below_zero() {
        close(Shape::HalfSpace.distance_and_normal(Vec3::new(4.0, -0.3, 7.0)), -0.3, Vec3::Y);
        assert_eq!(Shape::HalfSpace.bounding_radius(), f32::INFINITY);
    }

    #[test]
    fn where_every_direction_is_as_good_the_normal_is_a_fixed_axis() {
        close(Shape::sphere(0.5).unwrap().distance_and_normal(Vec3::ZERO), -0.5, Vec3::Y);
        close(Shape::capsule(0.5, 2.0).unwrap().distance_and_normal(Vec3::Y), -0.5, Vec3::X);
    }

    #[test]
    fn distance_and_normal_of_finite_points_are_never_nan() {
        let shapes = [
            Shape::sphere(1.0).unwrap(),
            Shape::capsule(0.1, 1.0).unwrap(),
            Shape::cuboid(Vec3::ONE).unwrap(),
            Shape::pyramid(Vec2::ONE, 1.0).unwrap(),
            Shape::HalfSpace,
        ];
        for shape in &shapes {
            for size in [0.0, f32::MIN_POSITIVE, 1e-30, 0.5, 1.0, 1e20, f32::MAX] {
                for direction in [Vec3::X, Vec3::NEG_Y, Vec3::ONE, Vec3::new(-1.0, 1.0, 0.0)] {
                    let (distance, normal) = shape.distance_and_normal(direction * size);
                    assert!(!distance.is_nan(), "{shape:?} at {size}");
                    assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?} at {size}: {normal}");
                }
            }
        }
    }

    #[test]
    fn a_wrong_size_is_refused_by_name() {
        let field = |result: Result<Shape, ClothError>| match result {
            Err(ClothError::OutOfRange { field, .. }) => field,
            other => panic!("{other:?}"),
        };
        assert_eq!(field(Shape::sphere(f32::NAN)), "ClothCollider::Sphere.radius");
        assert_eq!(field(Shape::sphere(0.0)), "ClothCollider::Sphere.radius");
        assert_eq!(field(Shape::capsule(1.0, -1.0)), "ClothCollider::Capsule.length");
        assert_eq!(field(Shape::cuboid(Vec3::new(1.0, 2e4, 1.0))), "ClothCollider::Cuboid.size.y");
        assert_eq!(field(Shape::pyramid(Vec2::new(1.0, -1.0), 1.0)), "ClothCollider::Pyramid.base.y");
        assert_eq!(field(Shape::pyramid(Vec2::ONE, f32::INFINITY)), "ClothCollider::Pyramid.height");
    }
}
