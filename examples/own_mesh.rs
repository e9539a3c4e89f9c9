//! Any triangle mesh becomes cloth: here an open tube, held by its upper rim. Where its texture wraps around, the mesh
//! has two vertices at one place; the cloth welds them, so that the tube does not come apart at its seam.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, Fabric, Pins};

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let tube = Cylinder::new(0.45, 1.0).mesh().resolution(64).segments(24).without_caps().build();
    commands.spawn((
        Cloth::mesh(),
        Mesh3d(meshes.add(tube)),
        Fabric::COTTON_POPLIN,
        Pins::top(),
        MeshMaterial3d(materials.add(Color::srgb(0.75, 0.7, 0.3))),
    ));
    commands.spawn((
        ClothCollider::Capsule { radius: 0.2, length: 0.8 },
        Mesh3d(meshes.add(Capsule3d::new(0.2, 0.8))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.5, 0.6))),
        Transform::from_xyz(0.32, -0.3, 0.2).with_rotation(Quat::from_rotation_z(0.3)),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.6, 0.9, 2.6).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
