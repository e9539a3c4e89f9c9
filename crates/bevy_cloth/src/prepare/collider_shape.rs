//! The solver's shape of an authored collider under the scale of its transform.

use bevy::prelude::*;
use cloth_solver::ClothError;
use cloth_solver::contact::Shape;

use super::source::positions_and_indices;
use crate::collider::ClothCollider;

/// A scale that changes by less than this part of itself is the same scale.
pub(super) const SCALE_TOLERANCE: f32 = 1e-4;

/// The shape of `collider` under `scale`. `mesh` is needed for [`ClothCollider::Mesh`].
pub(super) fn shape(collider: &ClothCollider, scale: Vec3, mesh: Option<&Mesh>) -> Result<Shape, ClothError> {
    let size = scale.abs();
    match collider {
        ClothCollider::Sphere { radius } => {
            let ball = Shape::sphere(*radius)?;
            match ratio(size) {
                _ if size == Vec3::ONE => Ok(ball),
                Some(factor) => Shape::sphere(radius * factor),
                None => Shape::ellipsoid(*radius * size),
            }
        }
        ClothCollider::Ellipsoid { radii } => Shape::ellipsoid(*radii * size),
        ClothCollider::Cylinder { radius, height } => Shape::cylinder(radius * round(size)?, height * size.y),
        ClothCollider::Cone { radius, height } => Shape::cone(radius * round(size)?, height * size.y),
        ClothCollider::Capsule { radius, length } => {
            let allowed = "the same on all axes for a capsule";
            let factor = ratio(size).ok_or_else(|| scale_error(size, allowed))?;
            Shape::capsule(radius * factor, length * factor)
        }
        ClothCollider::Cuboid { size: edges } => Shape::cuboid(*edges * size),
        ClothCollider::RoundedCuboid { size: edges, radius } => {
            Shape::rounded_cuboid(*edges * size, radius * size.min_element())
        }
        ClothCollider::Pyramid { base, height } => Shape::pyramid(*base * Vec2::new(size.x, size.z), height * size.y),
        ClothCollider::Convex { planes } => {
            // A point p of the scaled solid is inside where n · (p / scale) <= w.
            let planes = planes.iter().map(|plane| scaled(*plane, scale)).collect::<Result<Vec<_>, _>>()?;
            Shape::convex(&planes)
        }
        ClothCollider::Hull { points } => {
            let points: Vec<Vec3> = points.iter().map(|point| *point * scale).collect();
            Shape::hull(&points)
        }
        ClothCollider::HeightField { size: extent, cells, heights, thickness } => {
            let heights = mirrored(heights, cells.x as usize + 1, scale);
            Shape::height_field(*extent * Vec2::new(size.x, size.z), *cells, &heights, *thickness)
        }
        ClothCollider::Mesh { thickness } => {
            let mesh = mesh.ok_or(ClothError::NoTriangles { field: "ClothCollider::Mesh" })?;
            let (positions, indices) = positions_and_indices(mesh, scale)?;
            Shape::triangle_mesh(&positions, &indices, *thickness)
        }
        ClothCollider::Triangles { positions, triangles, thickness } => {
            let positions: Vec<Vec3> = positions.iter().map(|position| *position * scale).collect();
            Shape::triangle_mesh(&positions, triangles.as_flattened(), *thickness)
        }
        ClothCollider::Ground => Ok(Shape::HalfSpace),
    }
}

/// The factor that is the same on all axes, if it is.
fn ratio(size: Vec3) -> Option<f32> {
    let is_same = |axis: f32| (axis - size.x).abs() <= SCALE_TOLERANCE * size.x;
    (is_same(size.y) && is_same(size.z)).then_some(size.x)
}

/// The factor across the y axis.
fn round(size: Vec3) -> Result<f32, ClothError> {
    let allowed = "the same along x and z for a cylinder or a cone";
    ratio(Vec3::new(size.x, size.x, size.z)).ok_or_else(|| scale_error(size, allowed))
}

fn scale_error(size: Vec3, allowed: &'static str) -> ClothError {
    let odd = size.to_array().into_iter().find(|axis| (axis - size.x).abs() > SCALE_TOLERANCE * size.x);
    ClothError::OutOfRange { field: "Transform::scale", value: odd.unwrap_or(size.x), allowed }
}

/// The heights of a field under `scale`, in the order of the places that they are at then.
fn mirrored(heights: &[f32], columns: usize, scale: Vec3) -> Vec<f32> {
    let mut heights: Vec<f32> = heights.iter().map(|height| height * scale.y).collect();
    if scale.x < 0.0 {
        heights.chunks_mut(columns).for_each(<[f32]>::reverse);
    }
    if scale.z < 0.0 {
        heights = heights.rchunks(columns).flatten().copied().collect();
    }
    heights
}

fn scaled(plane: Vec4, scale: Vec3) -> Result<(Vec3, f32), ClothError> {
    let normal = plane.truncate() / scale;
    let length = normal.length();
    if !(length.is_finite() && length > 0.0) {
        let allowed = "planes with a normal that is finite and not zero";
        return Err(ClothError::OutOfRange { field: "ClothCollider::Convex.planes", value: length, allowed });
    }
    Ok((normal / length, plane.w / length))
}
