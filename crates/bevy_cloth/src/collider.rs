//! The authored components of solids that cloth cannot enter.

use bevy::prelude::*;

use crate::prepare::ColliderState;

/// A solid that no cloth can enter, placed by its entity's [`Transform`].
///
/// A uniform scale of the transform multiplies all sizes. Cuboid, pyramid and convex solid take a scale that differs
/// between the axes too; for sphere and capsule such a scale is an error, told by
/// [`ColliderRejected`](crate::ColliderRejected). A collider that moves carries the cloth with it: its pose is
/// interpolated over the substeps of a tick, and over the ticks of a frame if it is moved once a frame. A move of more than
/// 0.75 m in one tick is a jump: it is there at once, and sweeps nothing along.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Transform, ColliderState)]
pub enum ClothCollider {
    /// A ball around the entity's origin.
    Sphere {
        /// Radius, m; 0.0001 to 10,000.
        radius: f32,
    },
    /// A cylinder along the entity's y axis with half a ball at each end.
    Capsule {
        /// Radius, m; 0.0001 to 10,000.
        radius: f32,
        /// Distance between the centres of the two half-balls, m.
        length: f32,
    },
    /// A box centred on the entity's origin.
    Cuboid {
        /// Edge lengths, m.
        size: Vec3,
    },
    /// A pyramid on a rectangular base, apex up, centred on the entity's origin at half its height.
    Pyramid {
        /// Edge lengths of the base along x and z, m.
        base: Vec2,
        /// Height along y, m.
        height: f32,
    },
    /// Any convex solid: where `n · p <= w` for all planes `(n, w)`. It must be bounded and hold a point.
    Convex {
        /// Outward normals (x, y, z, of any length but 0) and offsets (w, in units of that length), m.
        planes: Vec<Vec4>,
    },
    /// Solid ground: everything below the entity's xz plane. Takes no notice of scale.
    Ground,
}

impl Default for ClothCollider {
    /// A ball of half a metre.
    fn default() -> Self {
        Self::Sphere { radius: 0.5 }
    }
}

/// Coulomb friction of a [`ClothCollider`] against every cloth, dimensionless, 0 to 10. Without it the friction of
/// the cloth's [`Fabric`](crate::Fabric) holds.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct ColliderFriction(pub f32);

impl Default for ColliderFriction {
    /// Cotton on wood, 0.4.
    fn default() -> Self {
        Self(0.4)
    }
}
