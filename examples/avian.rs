//! A trampoline and balls of avian: cloth and rigid bodies push each other.

use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothAvianPlugin, ClothPlugin, Fabric, Pins};

/// A new ball falls so often, s.
const PERIOD: f32 = 1.5;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, PhysicsPlugins::default()))
        .add_plugins((ClothPlugin::default(), ClothAvianPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, drop_balls)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // Held all around.
    let cells = 30;
    let rim = (0..=cells).flat_map(|i| [i, cells * (cells + 1) + i, i * (cells + 1), i * (cells + 1) + cells]);
    commands.spawn((
        Cloth::rectangle(3.0, 3.0).with_cells(cells, cells),
        Fabric::CANVAS,
        Pins::vertices(rim),
        MeshMaterial3d(materials.add(Color::srgb(0.15, 0.2, 0.4))),
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(Quat::from_rotation_x(-1.4)),
    ));
    commands.spawn((
        RigidBody::Static,
        Collider::half_space(Vec3::Y),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.45, 0.25))),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 3.0, 6.0).looking_at(Vec3::Y, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(3.0, 5.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn drop_balls(
    time: Res<Time>,
    mut next: Local<f32>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    if time.elapsed_secs() < *next {
        return;
    }
    *next += PERIOD;
    let radius = 0.2;
    commands.spawn((
        RigidBody::Dynamic,
        // All that cloth has to know of it.
        Collider::sphere(radius),
        Mass(2.0),
        Mesh3d(meshes.add(Sphere::new(radius))),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.33, 0.10))),
        Transform::from_xyz(0.5 * next.sin(), 3.0, -0.8),
    ));
}
