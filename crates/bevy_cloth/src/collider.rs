//! The authored components of solids that cloth cannot enter, and the shapes made of them.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use cloth_solver::contact::Shape;

use crate::prepare::ColliderState;

/// A solid that no cloth can enter, placed by its entity's [`Transform`].
///
/// A uniform scale of the transform multiplies all sizes but the thickness of a height field or a mesh. A scale that differs
/// between the axes makes an ellipsoid of a sphere; for a capsule it is an error, and for cylinder and cone if it differs
/// between x and z. Whatever is wrong is reported by [`ColliderRejected`](crate::ColliderRejected), and the collider stays out of the
/// simulation until it is changed.
///
/// A solid of several parts is an entity with children that each have a `ClothCollider`: they move with their parent.
///
/// A collider that moves carries the cloth with it: its pose is
/// interpolated over the substeps of a tick, and over the ticks of a frame if it is moved once a frame. A move of more than
/// 0.75 m in one tick is a jump: it is there at once, and sweeps nothing along.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[require(Transform, ColliderState)]
pub enum ClothCollider {
    /// A ball around the entity's origin; with a scale that differs between the axes an ellipsoid.
    Sphere {
        /// Radius, m; 0.0001 to 10,000.
        radius: f32,
    },
    /// An ellipsoid around the entity's origin.
    Ellipsoid {
        /// Semi-axes along x, y and z, m, each 0.0001 to 10,000.
        radii: Vec3,
    },
    /// A cylinder along the entity's y axis, centred on its origin.
    Cylinder {
        /// Radius, m; 0.0001 to 10,000.
        radius: f32,
        /// Height along y, m; 0.0001 to 10,000.
        height: f32,
    },
    /// A cone along the entity's y axis, apex up, centred on its origin at half its height.
    Cone {
        /// Radius of the base, m; 0.0001 to 10,000.
        radius: f32,
        /// Height along y, m; 0.0001 to 10,000.
        height: f32,
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
    /// A box with rounded edges, centred on the entity's origin.
    RoundedCuboid {
        /// Overall edge lengths, m, each 0.0001 to 10,000.
        size: Vec3,
        /// Radius of the edges, m; 0.0001 or more, and less than half the shortest edge. A scale that differs between the axes
        /// multiplies it by the smallest of its factors.
        radius: f32,
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
    /// The convex hull of points: the smallest convex solid that holds them.
    Hull {
        /// At least four points that do not lie in one plane, m, within 10,000 m of the origin. Those inside the solid cost nothing.
        /// The solid may have 256 faces.
        points: Vec<Vec3>,
    },
    /// A height field centred on the entity's origin: a wall along it, solid within half its thickness above and below.
    ///
    /// For ground that stays where it is. It may jump (a move of more than 0.75 m in one tick) or move slowly; what moves it fast costs
    /// much.
    HeightField {
        /// Extent along x and z, m, each 0.0001 to 10,000.
        size: Vec2,
        /// Number of cells along x and along z, each 1 to 4096.
        cells: UVec2,
        /// Heights along y, m, of the corners of the cells: `(cells.x + 1) * (cells.y + 1)`, x first, from −x and −z on; within
        /// ±10,000.
        heights: Vec<f32>,
        /// Thickness of the wall, m; 0.001 to 10. Cloth that gets to the other side of its middle stays there. Ignores scale.
        thickness: f32,
    },
    /// The triangles of the entity's own [`Mesh3d`], which may load later; until then nothing is in the way. A wall along them, solid
    /// within half its thickness on both sides: no solid, even if the mesh is closed.
    ///
    /// For scenery that stays where it is, of any number of triangles: what is not near a cloth costs nothing. It may jump or move
    /// slowly, as a height field may. The mesh must be a list of triangles kept in the main world. It is read again when it is modified.
    Mesh {
        /// Thickness of the wall, m; 0.001 to 10. The thicker, the cheaper it is for cloth that moves fast. Ignores scale.
        thickness: f32,
    },
    /// Triangles of your own: a wall along them as with [`ClothCollider::Mesh`], without a mesh asset.
    Triangles {
        /// Corners, m.
        positions: Vec<Vec3>,
        /// The corners of each triangle.
        triangles: Vec<[u32; 3]>,
        /// Thickness of the wall, m; 0.001 to 10. Ignores scale.
        thickness: f32,
    },
    /// Solid ground: everything below the entity's xz plane. Ignores scale.
    Ground,
}

impl Default for ClothCollider {
    /// A ball of half a metre.
    fn default() -> Self {
        Self::Sphere { radius: 0.5 }
    }
}

/// The shapes of all colliders as cloth meets them, those of meshes and the scale of the transform included: for systems that
/// ask how far something is from a collider, as for a ball that bounces off it. They are made in
/// [`ClothSystems::Build`](crate::ClothSystems::Build), when a collider changes.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::ColliderShapes;
/// fn depth(colliders: Query<(Entity, &GlobalTransform)>, shapes: ColliderShapes) {
///     for (entity, place) in &colliders {
///         let (_, rotation, translation) = place.to_scale_rotation_translation();
///         let origin = rotation.inverse() * -translation;
///         let distance = shapes.get(entity).map(|shape| shape.distance_and_normal(origin).0);
///         info!("the world's origin is {distance:?} m away from {entity}");
///     }
/// }
/// # App::new().add_systems(Update, depth);
/// ```
#[derive(SystemParam)]
pub struct ColliderShapes<'w, 's> {
    states: Query<'w, 's, &'static ColliderState>,
}

impl ColliderShapes<'_, '_> {
    /// The shape of a collider in its own frame, without its place and rotation. `None` if it is no collider, was refused, or
    /// waits for its mesh.
    pub fn get(&self, entity: Entity) -> Option<&Shape> {
        self.states.get(entity).ok()?.shape()
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
