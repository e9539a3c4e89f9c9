//! The forms of colliders and props.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// The form of a collider.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub enum SceneShape {
    /// A ball.
    Sphere {
        /// Radius, m.
        radius: f32,
    },
    /// A cylinder along y with half a ball at each end.
    Capsule {
        /// Radius, m.
        radius: f32,
        /// Distance between the centres of the half-balls, m.
        length: f32,
    },
    /// A box.
    Cuboid {
        /// Edge lengths, m.
        size: Vec3,
    },
    /// A pyramid, apex up, its middle at half its height.
    Pyramid {
        /// Edge lengths of the base, m.
        base: Vec2,
        /// Height, m.
        height: f32,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Semi-axes, m, each 1e-4..=1e4.
        radii: Vec3,
    },
    /// A cylinder along y, its middle at half its height.
    Cylinder {
        /// Radius, m, 1e-4..=1e4.
        radius: f32,
        /// Height, m, 1e-4..=1e4.
        height: f32,
    },
    /// A cone along y, apex up, its middle at half its height.
    Cone {
        /// Radius of the base, m, 1e-4..=1e4.
        radius: f32,
        /// Height, m, 1e-4..=1e4.
        height: f32,
    },
    /// A box with rounded edges.
    RoundedCuboid {
        /// Overall edge lengths, m, each 1e-4..=1e4.
        size: Vec3,
        /// Radius of the edges, m, 1e-4 or more and less than half the shortest edge.
        radius: f32,
    },
    /// Everything below the xz plane.
    Ground,
}
