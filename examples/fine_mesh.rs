//! A fine mesh on coarse cloth: a shirt of mail, 324 rings that follow a cloth of 10 × 10 cells, and do not cost more than that.

use std::f32::consts::FRAC_PI_4;

use bevy::prelude::*;
use bevy_cloth::{Air, BoundTo, Cloth, ClothCollider, ClothPlugin, Fabric, Pins, Wind};

const SIZE: f32 = 1.0;
/// Rings along each side.
const RINGS: usize = 18;

fn main() -> AppExit {
    App::new().add_plugins((DefaultPlugins, ClothPlugin::default())).add_systems(Startup, setup).run()
}

/// Rings in the plane of a rectangle of cloth, every second one leaning the other way.
fn mail() -> Mesh {
    let step = SIZE / RINGS as f32;
    let ring = Torus { minor_radius: 0.13 * step, major_radius: 0.62 * step };
    let ring = ring.mesh().minor_resolution(6).major_resolution(14).build();
    let place = |index: usize| {
        let (column, row) = (index % RINGS, index / RINGS);
        let lean = if row.is_multiple_of(2) { 0.45 } else { -0.45 };
        let corner = Vec3::new(column as f32 + 0.5, row as f32 + 0.5, 0.0) * step - Vec3::new(SIZE, SIZE, 0.0) / 2.0;
        // A torus lies in xz.
        Transform::from_translation(corner).with_rotation(Quat::from_rotation_x(2.0 * FRAC_PI_4 + lean))
    };
    let mut rings = (0..RINGS * RINGS).map(|index| ring.clone().transformed_by(place(index)));
    let first = rings.next().expect("there are some");
    rings.fold(first, |mut all, ring| {
        all.merge(&ring).expect("all rings have the same attributes");
        all
    })
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let place = Transform::from_xyz(0.0, 1.2, 0.0);
    let cloth = commands.spawn((
        Cloth::rectangle(SIZE, SIZE).with_cells(10, 10),
        Fabric::CANVAS,
        (Pins::rods(3), Air::default(), Wind(Vec3::new(0.5, 0.0, -2.0))),
        place,
    ));
    let cloth = cloth.id();
    // That is all. The cloth itself is not drawn then.
    let steel = StandardMaterial { metallic: 0.7, perceptual_roughness: 0.35, ..Color::srgb(0.7, 0.72, 0.75).into() };
    commands.spawn((BoundTo(cloth), Mesh3d(meshes.add(mail())), MeshMaterial3d(materials.add(steel)), place));
    commands.spawn((
        ClothCollider::Sphere { radius: 0.25 },
        Mesh3d(meshes.add(Sphere::new(0.25))),
        MeshMaterial3d(materials.add(Color::srgb(0.7, 0.3, 0.2))),
        Transform::from_xyz(0.1, 0.95, -0.2),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.8, 1.2, 1.5).looking_at(Vec3::Y * 1.15, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(1.0, 3.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}
