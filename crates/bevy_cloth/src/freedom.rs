//! The authored component that says how far cloth may get from its place on what wears it.

use bevy::mesh::{MeshVertexAttribute, VertexFormat};
use bevy::prelude::*;
use cloth_solver::ClothError;

/// How free each vertex of a mesh is that is made a cloth: from 0, it stays at its place, to 1. See [`Freedom`].
pub const ATTRIBUTE_FREEDOM: MeshVertexAttribute =
    MeshVertexAttribute::new("ClothFreedom", 0x636c_6f74_6866, VertexFormat::Float32);

/// How far the particles of a worn cloth may get from their places, by what is painted on its mesh.
///
/// The place of a particle is where the joints of a skinned mesh take it; on any other cloth its rest position in the cloth's own
/// [`Transform`]. Its freedom is read from [`ATTRIBUTE_FREEDOM`], or from the red of the vertex colours of a mesh without it, and is 1
/// on a mesh without either and on a rectangle. A particle of freedom 0 is pinned to its place, as by
/// [`PinTarget::Cloth`](crate::PinTarget::Cloth). Pins of [`Pins`](crate::Pins) come first.
///
/// What gets too far in a substep comes to rest against its limit: that adds no speed. A collider may push it farther.
///
/// ```
/// # use bevy_cloth::Freedom;
/// // A coat: its hem swings up to 25 cm away, and sinks no more than 1 cm into the body.
/// let freedom = Freedom { distance: 0.25, backstop: 0.01 };
/// ```
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct Freedom {
    /// Largest distance of a particle of freedom 1 from its place, m, in the world; of one of freedom ½ half of that. 0 or more. Default
    /// infinite: painted freedom then only pins.
    pub distance: f32,
    /// How far a particle may get behind the surface through its place, against the normal there, m. 0 or more. Default infinite, as it
    /// must be where `distance` is: far from its place a particle is not behind anything.
    pub backstop: f32,
}

impl Default for Freedom {
    fn default() -> Self {
        Self { distance: f32::INFINITY, backstop: f32::INFINITY }
    }
}

impl Freedom {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Freedom::distance", self.distance, 0.0..=f32::INFINITY, "0 m or more")?;
        let least = if self.distance.is_finite() { 0.0 } else { f32::INFINITY };
        let allowed = "0 m or more, and infinite with an infinite distance";
        ClothError::check("Freedom::backstop", self.backstop, least..=f32::INFINITY, allowed)
    }

    /// Whether it keeps a free particle anywhere.
    pub(crate) fn limits(&self) -> bool {
        self.distance.is_finite()
    }
}
