//! A model from Blender whose custom properties say what is cloth: a banner, a mirrored one that burns, and a tunic of two
//! fabrics. `assets/models/garments.py` makes the model; the table of names is in the module `bevy_cloth::gltf`.
//!
//! ```sh
//! cargo run --release --example gltf
//! ```

use bevy::camera::{primitives::Aabb, visibility::VisibilityClass};
use bevy::gltf::{
    GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneExtras, GltfSceneName,
};
use bevy::prelude::*;
use bevy::world_serialization::WorldAssetRoot;
use bevy_cloth::gltf::{GltfClothPlugin, gltf_plugin};
use bevy_cloth::{ClothPlugin, Shared, Wind};

fn main() -> AppExit {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins.set(gltf_plugin()), ClothPlugin::default(), GltfClothPlugin));
    register_types(&mut app);
    app.add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, mut wind: ResMut<Shared<Wind>>) {
    // Custom properties are read wherever the scene is spawned, however often.
    commands.spawn(WorldAssetRoot(assets.load("models/garments.glb#Scene0")));
    wind.0 = Wind(Vec3::new(2.0, 0.0, 0.5));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(6.5, 2.0, -0.7).looking_at(Vec3::new(0.0, 1.2, -1.0), Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(4.0, 5.0, 3.0).looking_at(Vec3::Y, Vec3::Y),
    ));
}

/// What a scene is made of. Not needed with Bevy's default features, with which types register themselves.
fn register_types(app: &mut App) {
    app.register_type::<Transform>().register_type::<GlobalTransform>().register_type::<TransformTreeChanged>();
    app.register_type::<Name>().register_type::<ChildOf>().register_type::<Children>();
    app.register_type::<Visibility>().register_type::<InheritedVisibility>().register_type::<ViewVisibility>();
    app.register_type::<VisibilityClass>().register_type::<Aabb>().register_type::<Mesh3d>();
    app.register_type::<MeshMaterial3d<StandardMaterial>>();
    app.register_type::<GltfExtras>().register_type::<GltfMeshExtras>().register_type::<GltfMaterialExtras>();
    app.register_type::<GltfSceneExtras>().register_type::<GltfSceneName>();
    app.register_type::<GltfMeshName>().register_type::<GltfMaterialName>();
}
