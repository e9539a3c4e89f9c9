//! How the fabric of a cloth looks. Nothing in here changes how it moves.

use cloth_solver::ClothError;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// How the fabric of a cloth looks.
#[derive(Serialize, Deserialize, Clone, Debug, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct SceneLook {
    /// How its threads cross. Default [`SceneWeave::Plain`].
    pub weave: SceneWeave,
    /// Its colour: red, green and blue (sRGB), 0..=1. Default that of unbleached cotton.
    pub color: Vec3,
    /// A second colour: of the weft, or of the pattern if there is one. Default none.
    pub second: Option<Vec3>,
    /// What is woven or printed in the second colour. Default nothing.
    pub pattern: ScenePattern,
    /// How much light shines through, 0..=1. Default: as usual for the weave.
    pub translucency: Option<f32>,
}

impl Default for SceneLook {
    fn default() -> Self {
        Self {
            weave: SceneWeave::default(),
            color: Vec3::new(0.93, 0.91, 0.86),
            second: None,
            pattern: ScenePattern::default(),
            translucency: None,
        }
    }
}

/// How the threads of a fabric cross.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneWeave {
    /// One over, one under: poplin, canvas, voile.
    #[default]
    Plain,
    /// Diagonal ribs: denim.
    Twill,
    /// Long floats that shine: satin.
    Satin,
    /// Loops: a towel.
    Terry,
    /// Knitted: jersey.
    Knit,
    /// A grid of stronger threads: flags, sails.
    Ripstop,
    /// A pile that stands up: velvet.
    Velvet,
}

/// What is woven or printed in the second colour.
#[derive(Serialize, Deserialize, Clone, Copy, Debug, Default, PartialEq)]
pub enum ScenePattern {
    /// Nothing.
    #[default]
    None,
    /// Vertical stripes of this width, m, 0.001..=10.
    Stripes(f32),
    /// Horizontal stripes of this width, m, 0.001..=10.
    Bars(f32),
    /// Checks of this width, m, 0.001..=10.
    Checks(f32),
    /// A band of this width inside the edge, m, 0.001..=10.
    Border(f32),
}

impl SceneLook {
    pub(crate) fn validate(&self) -> Result<(), ClothError> {
        let colors = [("SceneLook::color", Some(self.color)), ("SceneLook::second", self.second)];
        for (field, color) in colors.into_iter().filter_map(|(field, color)| Some((field, color?))) {
            for part in color.to_array() {
                ClothError::check(field, part, 0.0..=1.0, "0..=1 of red, green and blue")?;
            }
        }
        match self.pattern {
            ScenePattern::None => {}
            ScenePattern::Stripes(width)
            | ScenePattern::Bars(width)
            | ScenePattern::Checks(width)
            | ScenePattern::Border(width) => {
                ClothError::check("SceneLook::pattern", width, 1e-3..=10.0, "0.001..=10 m")?;
            }
        }
        let translucency = self.translucency.unwrap_or_default();
        ClothError::check("SceneLook::translucency", translucency, 0.0..=1.0, "0..=1")
    }
}
