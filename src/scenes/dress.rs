//! How the cloths of a scene look.

use bevy::prelude::*;
use bevy_cloth::{ClothLook, Pattern, Weave};
use cloth_scene::{SceneCloth, ScenePattern, SceneWeave};

/// Colours of cloths that say nothing of theirs, in turn.
const COLORS: [Color; 4] = [
    Color::srgb(0.42, 0.045, 0.085),
    Color::srgb(0.10, 0.30, 0.45),
    Color::srgb(0.70, 0.58, 0.30),
    Color::srgb(0.16, 0.36, 0.20),
];

/// How a cloth looks, the `index`th of its scene.
pub fn look(spec: &SceneCloth, index: usize) -> ClothLook {
    let Some(look) = &spec.look else { return ClothLook::new(Weave::Plain, COLORS[index % COLORS.len()]) };
    let color = |color: Vec3| Color::srgb(color.x, color.y, color.z);
    let weave = match look.weave {
        SceneWeave::Plain => Weave::Plain,
        SceneWeave::Twill => Weave::Twill,
        SceneWeave::Satin => Weave::Satin,
        SceneWeave::Terry => Weave::Terry,
        SceneWeave::Knit => Weave::Knit,
        SceneWeave::Ripstop => Weave::Ripstop,
        SceneWeave::Velvet => Weave::Velvet,
    };
    let usual = ClothLook::new(weave, color(look.color));
    ClothLook {
        second: look.second.map(color),
        pattern: match look.pattern {
            ScenePattern::None => Pattern::None,
            ScenePattern::Stripes(width) => Pattern::Stripes { width, across: false },
            ScenePattern::Bars(width) => Pattern::Stripes { width, across: true },
            ScenePattern::Checks(width) => Pattern::Check { width },
            ScenePattern::Border(width) => Pattern::Border { width },
        },
        translucency: look.translucency.unwrap_or(usual.translucency),
        ..usual
    }
}
