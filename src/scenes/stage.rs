//! What several scenes stand on: ground, and the finish of things.

use bevy::prelude::*;
use bevy_cloth::ClothCollider;

/// Edge of the square of ground that is drawn, m.
const GROUND: f32 = 120.0;

/// Spawns solid ground.
pub fn spawn_ground(
    commands: &mut Commands,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
    place: Transform,
) -> Entity {
    commands
        .spawn((
            Name::new("ground"),
            ClothCollider::Ground,
            place,
            Mesh3d(meshes.add(Plane3d::default().mesh().size(GROUND, GROUND))),
            MeshMaterial3d(materials.add(matte(Color::srgb(0.66, 0.64, 0.61)))),
            Pickable::IGNORE,
        ))
        .id()
}

/// A finish without gloss, as of fabric.
pub fn matte(color: Color) -> StandardMaterial {
    StandardMaterial { base_color: color, perceptual_roughness: 0.95, reflectance: 0.3, ..default() }
}

/// A finish with some gloss, as of paint.
pub fn glossy(color: Color) -> StandardMaterial {
    StandardMaterial { base_color: color, perceptual_roughness: 0.45, ..default() }
}
