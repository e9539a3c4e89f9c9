//! Colliders of an engine as ours. Both engines have their shapes from `parry3d`, each from a version of its own: hence a macro.

use bevy::prelude::*;

use crate::collider::ClothCollider;

/// One of the colliders that the collider of an engine becomes, and where it is in the frame of that.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub collider: ClothCollider,
    /// Without scale.
    pub place: Transform,
}

impl Part {
    /// At the origin.
    pub fn here(collider: ClothCollider) -> Self {
        Self { collider, place: Transform::IDENTITY }
    }

    /// Seen from where it is at `translation` and `rotation`.
    pub fn at(mut self, translation: Vec3, rotation: Quat) -> Self {
        self.place.translation = translation + rotation * self.place.translation;
        self.place.rotation = rotation * self.place.rotation;
        self
    }
}

/// What of a shape has no counterpart.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum NoCounterpart {
    /// A kind of shape.
    #[error("there is no collider for cloth of the shape {0}")]
    Kind(&'static str),
    /// A scale that shears parts of it.
    #[error("a scale that differs between the axes shears the parts of its shape")]
    Sheared,
}

/// What becomes of a shape that an engine has scaled by `scale`, under a transform that scales by that again.
pub(super) fn unscaled(mut parts: Vec<Part>, scale: Vec3) -> Result<Vec<Part>, NoCounterpart> {
    if scale == Vec3::ONE {
        return Ok(parts);
    }
    let is_uniform = (scale - Vec3::splat(scale.x)).abs().max_element() <= 1e-4 * scale.x.abs();
    for Part { collider, place } in &mut parts {
        if !is_uniform && place.rotation != Quat::IDENTITY {
            return Err(NoCounterpart::Sheared);
        }
        let size = scale.abs();
        place.translation /= scale;
        match collider {
            ClothCollider::Sphere { radius } => *radius /= size.x,
            ClothCollider::Cuboid { size: edges } => *edges /= size,
            ClothCollider::RoundedCuboid { size: edges, radius } => {
                *edges /= size;
                *radius /= size.min_element();
            }
            ClothCollider::Capsule { radius, length: height }
            | ClothCollider::Cylinder { radius, height }
            | ClothCollider::Cone { radius, height } => {
                *radius /= size.x;
                *height /= size.y;
            }
            ClothCollider::Hull { points } => points.iter_mut().for_each(|point| *point /= scale),
            ClothCollider::Triangles { positions, .. } => positions.iter_mut().for_each(|point| *point /= scale),
            _ => {}
        }
    }
    Ok(parts)
}

/// Makes `fn parts(shape, wall) -> Result<Vec<Part>, NoCounterpart>` for the shapes of the `parry` in scope; `wall` is the thickness of
/// triangle meshes, m.
macro_rules! translate_shapes {
    () => {
        fn parts(
            shape: &dyn parry::shape::Shape,
            wall: f32,
        ) -> Result<Vec<$crate::engines::shapes::Part>, $crate::engines::shapes::NoCounterpart> {
            use parry::shape::TypedShape;
            use $crate::ClothCollider;
            use $crate::engines::shapes::{NoCounterpart, Part};
            let triangles = |positions: Vec<Vec3>, triangles: Vec<[u32; 3]>| {
                vec![Part::here(ClothCollider::Triangles { positions, triangles, thickness: wall })]
            };
            Ok(match shape.as_typed_shape() {
                TypedShape::Ball(ball) => vec![Part::here(ClothCollider::Sphere { radius: ball.radius })],
                TypedShape::Cuboid(cuboid) => {
                    vec![Part::here(ClothCollider::Cuboid { size: 2.0 * cuboid.half_extents })]
                }
                TypedShape::RoundCuboid(round) => {
                    let size = 2.0 * (round.inner_shape.half_extents + round.border_radius);
                    vec![Part::here(ClothCollider::RoundedCuboid { size, radius: round.border_radius })]
                }
                TypedShape::Capsule(capsule) => {
                    let (a, b) = (capsule.segment.a, capsule.segment.b);
                    let collider = ClothCollider::Capsule { radius: capsule.radius, length: a.distance(b) };
                    let up = (b - a).normalize_or(Vec3::Y);
                    let rotation =
                        if up.y.abs() >= 1.0 { Quat::IDENTITY } else { Quat::from_rotation_arc(Vec3::Y, up) };
                    vec![Part::here(collider).at(0.5 * (a + b), rotation)]
                }
                TypedShape::Cylinder(cylinder) => {
                    let (radius, height) = (cylinder.radius, 2.0 * cylinder.half_height);
                    vec![Part::here(ClothCollider::Cylinder { radius, height })]
                }
                TypedShape::Cone(cone) => {
                    let (radius, height) = (cone.radius, 2.0 * cone.half_height);
                    vec![Part::here(ClothCollider::Cone { radius, height })]
                }
                TypedShape::ConvexPolyhedron(solid) => {
                    vec![Part::here(ClothCollider::Hull { points: solid.points().to_vec() })]
                }
                TypedShape::HalfSpace(space) => {
                    let normal: Vec3 = space.normal.into();
                    let rotation = Quat::from_rotation_arc(Vec3::Y, normal.normalize_or(Vec3::Y));
                    vec![Part::here(ClothCollider::Ground).at(Vec3::ZERO, rotation)]
                }
                TypedShape::HeightField(field) => {
                    let (positions, indices) = field.to_trimesh();
                    triangles(positions, indices)
                }
                TypedShape::TriMesh(mesh) => triangles(mesh.vertices().to_vec(), mesh.indices().to_vec()),
                TypedShape::Triangle(triangle) => triangles(vec![triangle.a, triangle.b, triangle.c], vec![[0, 1, 2]]),
                TypedShape::Compound(compound) => {
                    let mut all = Vec::new();
                    for (pose, shape) in compound.shapes() {
                        let inner = parts(&**shape, wall)?;
                        all.extend(inner.into_iter().map(|part| part.at(pose.translation, pose.rotation)));
                    }
                    all
                }
                TypedShape::Segment(_) => return Err(NoCounterpart::Kind("segment")),
                TypedShape::Polyline(_) => return Err(NoCounterpart::Kind("polyline")),
                TypedShape::Voxels(_) => return Err(NoCounterpart::Kind("voxels")),
                TypedShape::RoundTriangle(_) => return Err(NoCounterpart::Kind("round triangle")),
                TypedShape::RoundCylinder(_) => return Err(NoCounterpart::Kind("round cylinder")),
                TypedShape::RoundCone(_) => return Err(NoCounterpart::Kind("round cone")),
                TypedShape::RoundConvexPolyhedron(_) => return Err(NoCounterpart::Kind("round convex polyhedron")),
                TypedShape::Custom(_) => return Err(NoCounterpart::Kind("custom")),
            })
        }
    };
}

pub(super) use translate_shapes;
