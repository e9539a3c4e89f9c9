//! A towel falls on its edge and lies down in folds. With `SelfContact` a cloth keeps off itself; without it the folds pass through
//! each other.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, Fabric, SelfContact};

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Cloth::rectangle(0.5, 1.0).with_spacing(0.02),
        Fabric::TERRY_TOWEL,
        SelfContact::default(),
        MeshMaterial3d(materials.add(Color::srgb(0.25, 0.5, 0.55))),
        // Upright, tilted a little, so that it does not fall straight into its own plane.
        Transform::from_xyz(0.0, 0.6, 0.0).with_rotation(Quat::from_rotation_x(0.15)),
    ));
    commands.spawn((
        ClothCollider::Ground,
        Mesh3d(meshes.add(Plane3d::default().mesh().size(4.0, 4.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.6, 0.6))),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.5, 0.45, 0.85).looking_at(Vec3::new(0.0, 0.05, 0.1), Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(1.0, 2.0, 1.5).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
