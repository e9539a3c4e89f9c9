//! What is around a scene: ground, and a meadow, a room or a studio. It is only seen.

mod meadow;
mod room;
pub mod textures;

use bevy::prelude::*;
use cloth_scene::Setting;

use super::OfScene;

/// Edge of the square of ground that is drawn in the open, m.
const GROUND: f32 = 300.0;

/// Spawns what is around a scene.
#[derive(Event, Clone, Copy, Debug)]
pub struct Build {
    /// What is around.
    pub setting: Setting,
    /// Height of the ground, m.
    pub height: f32,
}

/// Builds settings.
pub struct SettingPlugin;

impl Plugin for SettingPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(build);
    }
}

/// Makes things that are only seen.
struct Builder<'a, 'w, 's> {
    commands: &'a mut Commands<'w, 's>,
    meshes: &'a mut Assets<Mesh>,
    materials: &'a mut Assets<StandardMaterial>,
    images: &'a mut Assets<Image>,
    root: Entity,
}

impl Builder<'_, '_, '_> {
    fn put(&mut self, mesh: Mesh, material: &Handle<StandardMaterial>, place: Transform) -> Entity {
        let mesh = Mesh3d(self.meshes.add(mesh));
        let parts = (mesh, MeshMaterial3d(material.clone()), place, Pickable::IGNORE, ChildOf(self.root));
        self.commands.spawn(parts).id()
    }

    fn material(&mut self, material: StandardMaterial) -> Handle<StandardMaterial> {
        self.materials.add(material)
    }

    fn texture(&mut self, image: Image) -> Option<Handle<Image>> {
        Some(self.images.add(image))
    }

    /// A level square of `edge` (m), its texture repeated every `tile` (m).
    fn floor(&mut self, edge: f32, tile: f32, material: &Handle<StandardMaterial>) -> Entity {
        let mut mesh = Plane3d::default().mesh().size(edge, edge).build();
        textures::repeat(&mut mesh, edge / tile);
        // Tangents are for normal maps; a plane has none to give.
        self.put(mesh, material, Transform::IDENTITY)
    }
}

fn build(
    asked: On<Build>,
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    let root = (OfScene, Name::new("setting"), Transform::from_xyz(0.0, asked.height, 0.0), Visibility::default());
    let root = commands.spawn(root).id();
    let mut builder =
        Builder { commands: &mut commands, meshes: &mut meshes, materials: &mut materials, images: &mut images, root };
    match asked.setting {
        Setting::Plain => ground(&mut builder, Color::srgb(0.66, 0.64, 0.61)),
        Setting::Studio => ground(&mut builder, Color::srgb(0.80, 0.80, 0.81)),
        Setting::Meadow => meadow::build(&mut builder),
        Setting::Room => room::build(&mut builder),
    }
}

fn ground(builder: &mut Builder, base_color: Color) {
    let stone = builder.texture(textures::stone());
    let matt = builder.material(StandardMaterial {
        base_color,
        base_color_texture: stone,
        perceptual_roughness: 0.95,
        reflectance: 0.3,
        ..default()
    });
    builder.floor(GROUND, 3.0, &matt);
}
