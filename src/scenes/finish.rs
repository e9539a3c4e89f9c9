//! How the surfaces of things look.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use cloth_scene::Finish;

use super::setting::textures;

/// Colours of colliders that say nothing of theirs, in turn.
pub const SOLIDS: [Vec3; 4] = [
    Vec3::new(0.10, 0.42, 0.46),
    Vec3::new(0.82, 0.55, 0.16),
    Vec3::new(0.24, 0.30, 0.55),
    Vec3::new(0.45, 0.44, 0.42),
];

/// Textures that several things share.
#[derive(Resource, Clone, Debug)]
pub struct Grains {
    /// Light wood.
    pub oak: Handle<Image>,
    /// Grey stone.
    pub stone: Handle<Image>,
}

/// Makes what surfaces need.
pub struct FinishPlugin;

impl Plugin for FinishPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreStartup, grow);
    }
}

fn grow(mut commands: Commands, mut images: ResMut<Assets<Image>>) {
    commands.insert_resource(Grains { oak: images.add(textures::grain()), stone: images.add(textures::stone()) });
}

/// Makes materials.
#[derive(SystemParam)]
pub struct Finishes<'w> {
    materials: ResMut<'w, Assets<StandardMaterial>>,
    grains: Res<'w, Grains>,
}

impl Finishes<'_> {
    /// The material of a finish; `None` of what is not seen.
    pub fn material(&mut self, finish: Finish) -> Option<MeshMaterial3d<StandardMaterial>> {
        let of = |color: Vec3| Color::srgb(color.x, color.y, color.z);
        let oak = Some(self.grains.oak.clone());
        let material = match finish {
            Finish::Paint(color) => paint(of(color)),
            Finish::Ceramic(color) => StandardMaterial {
                base_color: of(color),
                perceptual_roughness: 0.25,
                clearcoat: 0.7,
                clearcoat_perceptual_roughness: 0.08,
                ..default()
            },
            Finish::Rubber(color) => {
                StandardMaterial { base_color: of(color), perceptual_roughness: 0.8, reflectance: 0.35, ..default() }
            }
            Finish::Wood => StandardMaterial {
                base_color: Color::srgb(0.80, 0.62, 0.43),
                base_color_texture: oak,
                perceptual_roughness: 0.55,
                ..default()
            },
            Finish::Walnut => StandardMaterial {
                base_color: Color::srgb(0.36, 0.23, 0.15),
                base_color_texture: oak,
                perceptual_roughness: 0.45,
                ..default()
            },
            Finish::Brass => StandardMaterial {
                base_color: Color::srgb(0.80, 0.62, 0.32),
                metallic: 0.9,
                perceptual_roughness: 0.3,
                ..default()
            },
            Finish::Steel => StandardMaterial {
                base_color: Color::srgb(0.62, 0.63, 0.65),
                metallic: 0.9,
                perceptual_roughness: 0.38,
                ..default()
            },
            Finish::Stone => StandardMaterial {
                base_color: Color::srgb(0.74, 0.72, 0.69),
                base_color_texture: Some(self.grains.stone.clone()),
                perceptual_roughness: 0.9,
                ..default()
            },
            Finish::Hidden => return None,
        };
        Some(MeshMaterial3d(self.materials.add(material)))
    }
}

/// A finish with some gloss, as of paint.
pub fn paint(color: Color) -> StandardMaterial {
    StandardMaterial { base_color: color, perceptual_roughness: 0.45, ..default() }
}
