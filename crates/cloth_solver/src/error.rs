//! What authored data can be wrong about, and how it is told.

/// Why a cloth, a fabric or a collider was not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClothError {
    /// A number outside its allowed range (a NaN is outside every range).
    #[error("`{field}` is {value}, allowed is {allowed}")]
    OutOfRange {
        /// Path of the field as the user wrote it, e.g. `Fabric::areal_density`.
        field: &'static str,
        /// The value found.
        value: f32,
        /// The allowed range with its unit, e.g. `0.001..=10 kg/m²`.
        allowed: &'static str,
    },
    /// A mesh without any triangle.
    #[error("`{field}` has no triangles, allowed is at least 1 triangle")]
    NoTriangles {
        /// Path of the field as the user wrote it.
        field: &'static str,
    },
    /// A triangle index past the last vertex.
    #[error("triangle {triangle} has vertex index {index}, allowed is 0..{vertices}")]
    IndexOutOfRange {
        /// The triangle's place in the index list.
        triangle: usize,
        /// The index found.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// An index list whose length is not a multiple of three, or another topology than a triangle list.
    #[error("the mesh is not a triangle list: {reason}")]
    NotTriangleList {
        /// What was found instead.
        reason: String,
    },
    /// A vertex whose position is NaN or infinite.
    #[error("vertex {vertex} has a position that is not finite: {position}")]
    VertexNotFinite {
        /// The vertex.
        vertex: usize,
        /// The position found.
        position: glam::Vec3,
    },
    /// No triangle has an area once vertices at the same place are welded; told is the first.
    #[error("no triangle has an area: that of triangle {triangle} is {area} m², allowed is more than {smallest} m²")]
    DegenerateTriangle {
        /// The triangle's place in the index list.
        triangle: usize,
        /// Its area, m².
        area: f32,
        /// The smallest area allowed for this mesh, m².
        smallest: f32,
    },
    /// A vertex named by a pin or a weight that belongs to no triangle, and so has no particle.
    #[error("`{field}` names vertex {vertex}, which belongs to no triangle; allowed is a vertex that one does")]
    LoneVertex {
        /// Path of the field as the user wrote it.
        field: &'static str,
        /// The vertex named.
        vertex: u32,
    },
    /// A particle named by a pin, grab or tether that the cloth does not have.
    #[error("`{field}` names particle {particle}, allowed is a particle of the cloth ({particles} of them)")]
    NoSuchParticle {
        /// Path of the field as the user wrote it.
        field: &'static str,
        /// The particle named.
        particle: u32,
        /// Number of particles.
        particles: usize,
    },
    /// A cloth of a group that does not keep off itself.
    #[error("cloth {index} of the group has no contact with itself")]
    NoSelfContact {
        /// Its number.
        index: usize,
    },
}

impl ClothError {
    /// `Ok` if `value` lies within `range` (bounds included), else [`ClothError::OutOfRange`]. NaN is never within.
    pub fn check(
        field: &'static str,
        value: f32,
        range: core::ops::RangeInclusive<f32>,
        allowed: &'static str,
    ) -> Result<(), Self> {
        if range.contains(&value) { Ok(()) } else { Err(Self::OutOfRange { field, value, allowed }) }
    }
}
