//! Coarse cloth drawn smoothly. Three times the same towel of 12 × 12 cells over a ball, and the same scarf held by a corner: drawn as it is
//! simulated, with each edge in two, and with each edge in four.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, ClothSubdivision, Fabric, Pins};

const RADIUS: f32 = 0.22;

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let ball = meshes.add(Sphere::new(RADIUS));
    let skin = materials.add(Color::srgb(0.8, 0.6, 0.3));
    for (x, subdivision) in [-0.95, 0.0, 0.95].into_iter().zip(ClothSubdivision::ALL) {
        commands.spawn((
            Cloth::rectangle(0.9, 0.9).with_cells(12, 12),
            Fabric::TERRY_TOWEL,
            // That is all. To have all cloth drawn so, insert the resource `Shared(subdivision)`.
            subdivision,
            MeshMaterial3d(materials.add(Color::srgb(0.2, 0.45, 0.6))),
            Transform::from_xyz(x, 0.6, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
        ));
        commands.spawn((
            ClothCollider::Sphere { radius: RADIUS },
            Mesh3d(ball.clone()),
            MeshMaterial3d(skin.clone()),
            Transform::from_xyz(x, 0.3, 0.0),
        ));
        commands.spawn((
            Cloth::rectangle(0.6, 0.6).with_cells(12, 12),
            Fabric::SILK_CHARMEUSE,
            subdivision,
            // By its upper left corner.
            Pins::vertices([0]),
            MeshMaterial3d(materials.add(Color::srgb(0.7, 0.25, 0.2))),
            Transform::from_xyz(x + 0.3, 1.15, -0.5).with_rotation(Quat::from_rotation_x(0.5)),
        ));
    }
    commands.spawn((
        ClothCollider::Ground,
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.6, 0.6))),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 1.1, 2.1).looking_at(Vec3::new(0.0, 0.65, 0.0), Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
