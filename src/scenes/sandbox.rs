//! The sandbox: a curtain on a rod, ground, three things to push through the curtain, and a fan to blow at it.

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothCollider, ClothLook, Fabric, Fan, Flammable, Pins, Tearable};

use super::curtain_rod;
use super::stage::{glossy, spawn_ground};
use crate::camera::Viewpoint;
use crate::select::Selectable;

/// Width and height of the curtain, m.
const CURTAIN: Vec2 = Vec2::new(2.0, 1.8);
/// Pins along its top.
const RODS: u32 = 6;
/// Height of the rod above the ground, m.
const ROD_HEIGHT: f32 = 2.15;

/// The middle of the fan's outlet, m.
const FAN: Vec3 = Vec3::new(-1.4, 1.1, 1.05);

/// Spawns the scene.
pub fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.insert_resource(Viewpoint { from: Vec3::new(1.5, 1.55, 3.9), to: Vec3::new(0.0, 1.05, 0.0) });
    spawn_ground(&mut commands, &mut meshes, &mut materials, Transform::IDENTITY);

    let curtain = (
        Name::new("curtain"),
        Selectable(1),
        Cloth::rectangle(CURTAIN.x, CURTAIN.y),
        Fabric::VELVET_CURTAIN,
        Pins::rods(RODS),
        Air::default(),
        Tearable::default(),
        Flammable::default(),
        ClothLook::velvet(Color::srgb(0.36, 0.03, 0.07)),
    );
    let rod = curtain_rod::spawn(&mut commands, Transform::from_xyz(0.0, ROD_HEIGHT, 0.0), curtain);
    commands.entity(rod).insert((Name::new("rod"), Selectable(2)));

    let mut solid = |name, number, collider, color, place| {
        let material = MeshMaterial3d(materials.add(glossy(color)));
        commands.spawn((Name::new(name), Selectable(number), collider, material, place));
    };
    solid(
        "sphere",
        3,
        ClothCollider::Sphere { radius: 0.3 },
        Color::srgb(0.10, 0.42, 0.46),
        Transform::from_xyz(-0.9, 0.95, -0.2),
    );
    solid(
        "pyramid",
        4,
        ClothCollider::Pyramid { base: Vec2::splat(0.8), height: 0.75 },
        Color::srgb(0.82, 0.55, 0.16),
        Transform::from_xyz(-0.75, 0.375, 0.85).with_rotation(Quat::from_rotation_y(0.5)),
    );
    solid(
        "capsule",
        5,
        ClothCollider::Capsule { radius: 0.16, length: 0.6 },
        Color::srgb(0.24, 0.30, 0.55),
        Transform::from_xyz(1.05, 0.46, 0.45),
    );
    commands.spawn((
        Name::new("fan"),
        Selectable(6),
        Fan { on: false, ..default() },
        Transform::from_translation(FAN).looking_at(Vec3::new(0.1, 1.05, 0.0), Vec3::Y),
    ));
}
