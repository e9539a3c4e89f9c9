//! The shortest way to cloth: a curtain that hangs on five pins. Drag it with the left mouse button.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothPlugin, Fabric, Pins};

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Cloth::rectangle(2.0, 1.5),
        Fabric::VELVET_CURTAIN,
        Pins::rods(5),
        MeshMaterial3d(materials.add(Color::srgb(0.55, 0.1, 0.15))),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.8, 0.3, 3.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
