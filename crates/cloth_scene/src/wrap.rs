//! A cloth whose rest shape goes around an upright axis: a skirt, a sleeve, a cape.

use core::f32::consts::{PI, TAU};

use cloth_solver::ClothError;
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Bends a rectangle around the y axis of the cloth's frame: its rows become arcs of ellipses, its columns run down over the rings.
/// The middle of each row lies at +z; a full turn closes behind, at −z. What is bent at rest stays bent.
///
/// ```
/// let wrap: cloth_scene::SceneWrap =
///     ron::from_str("(rings: [(at: 0, radii: (0.1, 0.1)), (at: -0.5, radii: (0.3, 0.2))])")?;
/// assert!((wrap.point(glam::Vec2::new(0.5, 1.0)) - glam::Vec3::new(0.0, -0.5, 0.2)).length() < 1e-6);
/// # Ok::<(), ron::error::SpannedError>(())
/// ```
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneWrap {
    /// The outline from top to bottom, 2..=100 rings. Rows are spread evenly along it. Default two rings of 0.2 m, 0.5 m apart.
    pub rings: Vec<SceneRing>,
    /// How far it goes around, degrees, 10..=360. At 360 it is closed: its left and right edges are one. Default 360.
    pub arc: f32,
    /// Number of pleats around, 0..=200. Default 0.
    pub pleats: u32,
    /// Depth of the pleats at the bottom, from their middle, m, 0..=0.2; it grows evenly from 0 at the top. Default 0.
    pub depth: f32,
}

/// A ring of a [`SceneWrap`].
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SceneRing {
    /// Its height above the middle of the cloth's frame, m, −10..=10.
    pub at: f32,
    /// Its half-axes along x and z, m, 0.01..=10.
    pub radii: Vec2,
}

impl Default for SceneWrap {
    fn default() -> Self {
        let ring = |at| SceneRing { at, radii: Vec2::splat(0.2) };
        Self { rings: vec![ring(0.0), ring(-0.5)], arc: 360.0, pleats: 0, depth: 0.0 }
    }
}

impl SceneWrap {
    /// Where a point of the rectangle lies at rest, m, in the cloth's own frame; `part` is its part of width (from the left) and height
    /// (from the top).
    pub fn point(&self, part: Vec2) -> Vec3 {
        let ring = self.ring(part.y);
        // The two edges of a closed one are the same points to the last bit.
        let around = if self.arc >= 360.0 && part.x >= 1.0 { 0.0 } else { part.x };
        let angle = (around - 0.5) * self.arc * (PI / 180.0);
        let pleat = self.depth * part.y * (TAU * self.pleats as f32 * around).cos();
        let radii = ring.radii + pleat;
        Vec3::new(radii.x * angle.sin(), ring.at, radii.y * angle.cos())
    }

    /// The ring at that part of the way down the outline.
    fn ring(&self, part: f32) -> SceneRing {
        let way = |pair: &[SceneRing]| {
            (pair[0].at - pair[1].at).hypot((pair[0].radii - pair[1].radii).length() * 0.5_f32.sqrt())
        };
        let mut left = part.clamp(0.0, 1.0) * self.rings.windows(2).map(way).sum::<f32>();
        for pair in self.rings.windows(2) {
            let length = way(pair);
            if left <= length {
                let part = if length > 0.0 { left / length } else { 0.0 };
                return SceneRing {
                    at: pair[0].at + part * (pair[1].at - pair[0].at),
                    radii: pair[0].radii.lerp(pair[1].radii, part),
                };
            }
            left -= length;
        }
        self.rings.last().copied().unwrap_or_default()
    }

    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("SceneWrap::rings", self.rings.len() as f32, 2.0..=100.0, "2..=100 rings")?;
        for ring in &self.rings {
            ClothError::check("SceneRing::at", ring.at, -10.0..=10.0, "-10..=10 m")?;
            for radius in ring.radii.to_array() {
                ClothError::check("SceneRing::radii", radius, 0.01..=10.0, "0.01..=10 m")?;
            }
        }
        ClothError::check("SceneWrap::arc", self.arc, 10.0..=360.0, "10..=360°")?;
        ClothError::check("SceneWrap::pleats", self.pleats as f32, 0.0..=200.0, "0..=200")?;
        ClothError::check("SceneWrap::depth", self.depth, 0.0..=0.2, "0..=0.2 m")
    }
}
