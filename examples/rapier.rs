//! A strip of canvas tugs a crate of rapier over the ground: cloth pulls what it is pinned to.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothPlugin, ClothRapierPlugin, Fabric, Pins};
use bevy_rapier3d::prelude::*;

/// Pulls the strip.
#[derive(Component)]
struct Hand;

fn main() -> AppExit {
    App::new()
        // Cloth comes after each step of rapier, both in the fixed loop.
        .add_plugins((DefaultPlugins, RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()))
        .insert_resource(TimestepMode::Fixed { dt: 1.0 / 64.0, substeps: 1 })
        .add_plugins((ClothPlugin::default(), ClothRapierPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, pull)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let wood = materials.add(Color::srgb(0.7, 0.55, 0.4));
    let crate_place = Transform::from_xyz(-2.0, 0.25, 0.0);
    let cargo = (RigidBody::Dynamic, Collider::cuboid(0.25, 0.25, 0.25), ColliderMassProperties::Mass(5.0));
    let seen = (Mesh3d(meshes.add(Cuboid::from_length(0.5))), MeshMaterial3d(wood.clone()));
    let cargo = commands.spawn((cargo, Friction::coefficient(0.4), seen, crate_place)).id();
    let hand = (Hand, Mesh3d(meshes.add(Sphere::new(0.08))), MeshMaterial3d(wood));
    let hand = commands.spawn((hand, Transform::from_xyz(0.25, 0.5, 0.0))).id();
    // Its first row goes with the hand, its last one with the crate.
    let row = |row: u32| (0..=5).map(move |column| row * 6 + column);
    commands.spawn((
        Cloth::rectangle(0.25, 2.0).with_cells(5, 40),
        Fabric::CANVAS,
        Pins::vertices(row(0)).to_entity(hand).and(Pins::vertices(row(40)).to_entity(cargo)),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.05, 0.1))),
        Transform::from_xyz(-0.75, 0.5, 0.0).with_rotation(Quat::from_rotation_z(-FRAC_PI_2)),
    ));
    commands.spawn((
        Collider::halfspace(Vec3::Y).unwrap_or_default(),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.45, 0.25))),
        Transform::default(),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 2.5, 6.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(3.0, 5.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// To and fro.
fn pull(mut hands: Query<&mut Transform, With<Hand>>, time: Res<Time>) {
    for mut hand in &mut hands {
        let t = 0.8 * time.elapsed_secs();
        hand.translation = Vec3::new(0.25 + 1.5 * (1.0 - t.cos()), 0.6, 1.5 * t.sin());
    }
}
