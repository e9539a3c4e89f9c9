//! What is seen where a cloth is held: clothes pegs, rings.

use bevy::prelude::*;
use cloth_scene::Hardware;

/// The cloth is held by small things at these places of its own frame, m.
#[derive(Component, Clone, Debug)]
pub struct Fitted {
    /// Pegs or rings.
    pub what: Hardware,
    /// Where.
    pub at: Vec<Vec3>,
}

/// Shows what holds cloth.
pub struct HardwarePlugin;

impl Plugin for HardwarePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, fit);
    }
}

/// Width, height and depth of a half of a peg, m.
const PEG: Vec3 = Vec3::new(0.011, 0.075, 0.008);
/// Radii of a ring and of its wire, m.
const RING: (f32, f32) = (0.036, 0.004);

fn fit(
    mut commands: Commands,
    cloths: Query<(Entity, &Fitted), Added<Fitted>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (cloth, fitted) in &cloths {
        let (mesh, color, metallic, roughness) = match fitted.what {
            Hardware::Pegs => (Cuboid::from_size(PEG).mesh().build(), Color::srgb(0.78, 0.60, 0.40), 0.0, 0.7),
            _ => {
                let torus = Torus { minor_radius: RING.1, major_radius: RING.0 };
                (
                    torus.mesh().minor_resolution(10).major_resolution(32).build(),
                    Color::srgb(0.75, 0.75, 0.76),
                    0.9,
                    0.3,
                )
            }
        };
        let (mesh, material) = (
            meshes.add(mesh),
            materials.add(StandardMaterial {
                base_color: color,
                metallic,
                perceptual_roughness: roughness,
                ..default()
            }),
        );
        for at in &fitted.at {
            let places = match fitted.what {
                Hardware::Pegs => [-1.0_f32, 1.0]
                    .map(|side| {
                        Transform::from_translation(*at + Vec3::new(0.0, -0.008, side * 0.0055))
                            .with_rotation(Quat::from_rotation_x(side * 0.07))
                    })
                    .to_vec(),
                _ => vec![Transform::from_translation(*at - Vec3::X * RING.0 * 0.95)],
            };
            for place in places {
                commands.spawn((
                    Mesh3d(mesh.clone()),
                    MeshMaterial3d(material.clone()),
                    place,
                    Pickable::IGNORE,
                    ChildOf(cloth),
                ));
            }
        }
    }
}
