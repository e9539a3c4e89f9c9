//! How a scene is shown. Nothing in here changes how cloth moves.

use cloth_solver::ClothError;
use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{ScenePlace, SceneShape};

/// How a scene is shown: where it is, at what time of day, and from where it is looked at.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneView {
    /// The camera. Default: placed so that all that moves is seen.
    pub camera: Option<SceneCamera>,
    /// What is around. Default [`Setting::Plain`].
    pub setting: Setting,
    /// Time of day, hours, 0..=24: the sun rises at 6, stands highest at 12 and sets at 18. Default 10.
    pub hour: f32,
    /// From where the sun shines at noon, degrees about y from +z (towards the viewer), −360..=360: 90 is from +x. Default −35.
    pub noon: f32,
    /// How much of the sky is clouded, 0 (clear) to 1 (overcast, no sunlight). Default 0.3.
    pub clouds: f32,
    /// How much brighter the picture is than at normal exposure, stops, −8..=8. Default 0.
    pub exposure: f32,
    /// What is told beside the picture. Default nothing.
    pub readout: Readout,
}

impl Default for SceneView {
    fn default() -> Self {
        Self {
            camera: None,
            setting: Setting::default(),
            hour: 10.0,
            noon: -35.0,
            clouds: 0.3,
            exposure: 0.0,
            readout: Readout::default(),
        }
    }
}

impl SceneView {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("SceneView::hour", self.hour, 0.0..=24.0, "0..=24 h")?;
        ClothError::check("SceneView::noon", self.noon, -360.0..=360.0, "-360..=360°")?;
        ClothError::check("SceneView::clouds", self.clouds, 0.0..=1.0, "0..=1")?;
        ClothError::check("SceneView::exposure", self.exposure, -8.0..=8.0, "-8..=8 stops")?;
        let Some(camera) = &self.camera else { return Ok(()) };
        for (field, place) in [("SceneCamera::from", camera.from), ("SceneCamera::to", camera.to)] {
            place
                .to_array()
                .into_iter()
                .try_for_each(|axis| ClothError::check(field, axis, -1e4..=1e4, "-10,000..=10,000 m on each axis"))?;
        }
        let distance = camera.from.distance(camera.to);
        ClothError::check("SceneCamera::from", distance, 0.01..=3e4, "at least 0.01 m away from `to`")?;
        ClothError::check("SceneCamera::field", camera.field, 5.0..=150.0, "5..=150°")
    }
}

/// From where a scene is looked at.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SceneCamera {
    /// The place of the camera, m.
    pub from: Vec3,
    /// The point in the middle of the picture, m.
    pub to: Vec3,
    /// Vertical field of view, degrees, 5..=150. Default 45.
    #[serde(default = "field")]
    pub field: f32,
}

/// Vertical field of view unless told otherwise, degrees.
pub(crate) const FIELD: f32 = 45.0;

fn field() -> f32 {
    FIELD
}

/// What is around a scene. It is only seen: cloth meets the colliders, and nothing else.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Setting {
    /// Bare ground under the sky.
    #[default]
    Plain,
    /// Grass under the sky, with hills far away.
    Meadow,
    /// A room with a wooden floor and a window behind, 6 m wide.
    Room,
    /// A studio: a seamless backdrop and soft light from above.
    Studio,
}

/// What is told beside the picture.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Readout {
    /// Nothing.
    #[default]
    None,
    /// How far the cloths of the scene differ from the first of them, and what each costs, as graphs.
    Compare,
    /// For each cloth that burns: since when, how far it is charred from where it was lit, and how fast that grows.
    Fire,
}

/// How the surface of a thing looks.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// Paint of this colour: red, green and blue (sRGB), 0..=1.
    Paint(Vec3),
    /// Glazed ceramic of this colour.
    Ceramic(Vec3),
    /// Rubber of this colour.
    Rubber(Vec3),
    /// Light oak.
    Wood,
    /// Dark walnut.
    Walnut,
    /// Polished brass.
    Brass,
    /// Brushed steel.
    Steel,
    /// Grey stone.
    Stone,
    /// It is not seen.
    Hidden,
}

impl Finish {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        match self {
            Self::Paint(color) | Self::Ceramic(color) | Self::Rubber(color) => {
                color.to_array().into_iter().try_for_each(|part| {
                    ClothError::check("Finish::color", part, 0.0..=1.0, "0..=1 of red, green and blue")
                })
            }
            _ => Ok(()),
        }
    }
}

/// Something that is only seen: cloth passes through it.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SceneProp {
    /// Its form.
    pub shape: SceneShape,
    /// How its surface looks.
    pub finish: Finish,
    /// Where it is.
    #[serde(default)]
    pub place: ScenePlace,
}
