//! A region with a wind of its own.

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec3;

use crate::ClothError;
use crate::lanes::{Frame, Vec3x8, splat};

/// A region in which the air moves in one direction, on top of whatever else it does. Placed and turned by a pose.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindZone {
    /// Its form. Default a ball of 1 m.
    pub shape: ZoneShape,
    /// Velocity that it adds, along the zone's own axes, m/s; each axis −1,000,000 to 1,000,000. Default 3 m/s along −z.
    pub velocity: Vec3,
    /// Distance from its edge inwards over which the wind comes up, m; 0..=10,000. Default 0.25.
    pub falloff: f32,
}

/// The form of a [`WindZone`], in its own frame.
#[cfg_attr(feature = "ecs", derive(bevy_reflect::Reflect))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ZoneShape {
    /// A ball around the origin.
    Sphere {
        /// Radius, m; 0.0001 to 10,000.
        radius: f32,
    },
    /// A box centred on the origin.
    Cuboid {
        /// Edge lengths, m; each 0.0001 to 10,000.
        size: Vec3,
    },
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for WindZone {
    fn default() -> Self {
        Self { shape: ZoneShape::Sphere { radius: 1.0 }, velocity: Vec3::new(0.0, 0.0, -3.0), falloff: 0.25 }
    }
}

impl WindZone {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        let size = |field, value| ClothError::check(field, value, 1e-4..=1e4, "1e-4..=1e4 m");
        match self.shape {
            ZoneShape::Sphere { radius } => size("WindZone::shape.radius", radius)?,
            ZoneShape::Cuboid { size: edges } => {
                edges.to_array().into_iter().try_for_each(|edge| size("WindZone::shape.size", edge))?;
            }
        }
        for axis in self.velocity.to_array() {
            let allowed = "-1,000,000..=1,000,000 m/s on each axis";
            ClothError::check("WindZone::velocity", axis, -1e6..=1e6, allowed)?;
        }
        ClothError::check("WindZone::falloff", self.falloff, 0.0..=1e4, "0..=1e4 m")
    }
}

/// A zone where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub zone: WindZone,
    pub frame: Frame,
}

impl Placed {
    /// What the zone adds to the velocity of the air at eight points, m/s.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, point: Vec3x8<S>) -> Vec3x8<S> {
        let p = self.frame.inverse_point(simd, point);
        let depth = match self.zone.shape {
            ZoneShape::Sphere { radius } => splat(simd, radius) - p.length(),
            ZoneShape::Cuboid { size } => {
                let half = Vec3x8::splat(simd, 0.5 * size);
                (half.x - p.x.abs()).min(half.y - p.y.abs()).min(half.z - p.z.abs())
            }
        };
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let part = (depth / splat(simd, self.zone.falloff.max(f32::MIN_POSITIVE))).max(zero).min(one);
        // Without a kink at either end.
        let part = part * part * (splat(simd, 3.0) - part * splat(simd, 2.0));
        self.frame.direction(simd, Vec3x8::splat(simd, self.zone.velocity)) * part
    }
}
