//! How the cloths of a scene look.

use bevy::prelude::*;
use cloth_scene::{SceneCloth, SceneLook};

/// Colours of cloths that say nothing of theirs, in turn.
const COLORS: [Vec3; 4] = [
    Vec3::new(0.42, 0.045, 0.085),
    Vec3::new(0.10, 0.30, 0.45),
    Vec3::new(0.70, 0.58, 0.30),
    Vec3::new(0.16, 0.36, 0.20),
];

/// How a cloth looks, the `index`th of its scene.
pub fn look(spec: &SceneCloth, index: usize) -> SceneLook {
    spec.look.clone().unwrap_or(SceneLook { color: COLORS[index % COLORS.len()], ..default() })
}
