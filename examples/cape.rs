//! A worn cape: it is pinned at the shoulders of a figure that walks in a circle, and stays on them at any frame rate.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothCollider, ClothPlugin, Fabric, Pins};

/// Swings about its upper end as the figure walks, so far, rad.
#[derive(Component)]
struct Limb(f32);

#[derive(Component)]
struct Walker;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        // Once a frame, as a game does; it would be the same in `FixedUpdate` or by an animation.
        .add_systems(Update, walk)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let wood = materials.add(Color::srgb(0.7, 0.55, 0.4));
    // A capsule that is seen, and that cloth cannot enter.
    let mut part = |radius: f32, length: f32, at: Vec3| {
        let (mesh, place) = (meshes.add(Capsule3d::new(radius, length)), Transform::from_translation(at));
        (ClothCollider::Capsule { radius, length }, Mesh3d(mesh), MeshMaterial3d(wood.clone()), place)
    };
    let walker = commands.spawn((Walker, Transform::default(), Visibility::default())).id();
    commands.spawn((part(0.15, 0.4, Vec3::Y * 1.2), ChildOf(walker)));
    commands.spawn((part(0.1, 0.06, Vec3::Y * 1.7), ChildOf(walker)));
    let mut shoulders = part(0.07, 0.3, Vec3::Y * 1.43);
    shoulders.3.rotate_z(FRAC_PI_2);
    commands.spawn((shoulders, ChildOf(walker)));
    for side in [-1.0, 1.0] {
        for (hang, radius, length, swing) in
            [(Vec3::new(0.1, 0.9, 0.0), 0.08, 0.7, 0.5), (Vec3::new(0.24, 1.4, 0.0), 0.05, 0.5, -0.4)]
        {
            let joint = Transform::from_translation(hang * Vec3::new(side, 1.0, 1.0));
            let limb = commands.spawn((Limb(swing * side), joint, Visibility::default(), ChildOf(walker))).id();
            commands.spawn((part(radius, length, Vec3::NEG_Y * length / 2.0), ChildOf(limb)));
        }
    }
    // Its top edge lies on the shoulders, behind the neck; its entity is a child of the figure.
    commands.spawn((
        Cloth::rectangle(0.5, 1.1),
        Fabric::VELVET_CURTAIN,
        (Pins::top(), Air::default()),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.05, 0.1))),
        Transform::from_xyz(0.0, 0.95, 0.19).with_rotation(Quat::from_rotation_x(-0.1)),
        ChildOf(walker),
    ));
    let lawn = MeshMaterial3d(materials.add(Color::srgb(0.3, 0.45, 0.25)));
    commands.spawn((ClothCollider::Ground, Mesh3d(meshes.add(Plane3d::default().mesh().size(20.0, 20.0))), lawn));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 2.2, 6.0).looking_at(Vec3::Y * 0.8, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(3.0, 5.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn walk(
    mut walkers: Query<&mut Transform, With<Walker>>,
    mut limbs: Query<(&Limb, &mut Transform), Without<Walker>>,
    time: Res<Time>,
) {
    let (speed, radius) = (2.0, 1.5);
    let angle = time.elapsed_secs() * speed / radius;
    for mut place in &mut walkers {
        place.translation =
            Vec3::new(angle.sin(), 0.02 * (2.0 * 9.0 * angle).sin(), angle.cos()) * Vec3::new(radius, 1.0, radius);
        place.rotation = Quat::from_rotation_y(angle - FRAC_PI_2);
    }
    for (Limb(swing), mut place) in &mut limbs {
        place.rotation = Quat::from_rotation_x(swing * (9.0 * angle).sin());
    }
}
