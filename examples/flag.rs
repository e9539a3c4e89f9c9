//! A flag on its pole in a gusty wind. Up and down arrow change the wind.

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothPlugin, ClothSubdivision, Fabric, Gusts, Pins, Shared, Wind};

/// Height and radius of the pole, m.
const POLE: (f32, f32) = (3.0, 0.03);

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        // The wind of the whole scene. A component `Wind` on a cloth overrides it.
        .insert_resource(Shared(Wind(Vec3::new(7.0, 0.0, 1.0))))
        .insert_resource(Shared(Gusts { intensity: 0.25, ..default() }))
        .add_systems(Startup, setup)
        .add_systems(Update, change_wind)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Cloth::rectangle(1.5, 0.9),
        Fabric::FLAG_POLYESTER,
        // The particles of its left side: those in a thin box about it, in the cloth's own frame.
        Pins::region(Vec3::new(-0.76, -0.5, -0.1), Vec3::new(-0.74, 0.5, 0.1)),
        // Without it a cloth feels no wind.
        Air::default(),
        ClothSubdivision::X2,
        MeshMaterial3d(materials.add(Color::srgb(0.75, 0.12, 0.12))),
        Transform::from_xyz(0.75 + POLE.1, POLE.0 - 0.5, 0.0),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Cylinder::new(POLE.1, POLE.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.85, 0.85))),
        Transform::from_xyz(0.0, POLE.0 / 2.0, 0.0),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.35, 0.45, 0.3))),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(1.4, 1.6, 3.2).looking_at(Vec3::new(0.75, 2.3, 0.0), Vec3::Y),
    ));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn change_wind(keys: Res<ButtonInput<KeyCode>>, mut wind: ResMut<Shared<Wind>>, time: Res<Time>) {
    let change = f32::from(keys.pressed(KeyCode::ArrowUp)) - f32::from(keys.pressed(KeyCode::ArrowDown));
    if change != 0.0 {
        wind.0.0.x = (wind.0.0.x + 4.0 * change * time.delta_secs()).clamp(0.0, 20.0);
    }
}
