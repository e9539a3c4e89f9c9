//! A silk scarf falls on a ball and the ground. Anything with a `ClothCollider` stops cloth; it need not be visible.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, Fabric};

const RADIUS: f32 = 0.4;

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // A rectangle stands in the xy plane: turned about x it lies flat.
    commands.spawn((
        Cloth::rectangle(1.4, 1.4),
        Fabric::SILK_CHARMEUSE,
        MeshMaterial3d(materials.add(Color::srgb(0.2, 0.35, 0.7))),
        Transform::from_xyz(0.0, 1.3, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
    ));
    commands.spawn((
        ClothCollider::Sphere { radius: RADIUS },
        Mesh3d(meshes.add(Sphere::new(RADIUS))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.6, 0.3))),
        Transform::from_xyz(0.0, 0.7, 0.0),
    ));
    commands.spawn((
        ClothCollider::Ground,
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.6, 0.6))),
    ));
    commands
        .spawn((Camera3d::default(), Transform::from_xyz(1.2, 1.6, 2.4).looking_at(Vec3::new(0.0, 0.6, 0.0), Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
