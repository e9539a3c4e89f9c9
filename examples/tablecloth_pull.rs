//! The old trick: two hands take a tablecloth by its edge and pull it off the table. Slow is not enough; it has to be one swift pull.

use std::f32::consts::FRAC_PI_2;

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothCollider, ClothPlugin, ColliderFriction, Fabric, Pins};

/// When the hands begin to pull, s, how fast they become, m/s², and how far they go, m.
const PULL: (f32, f32, f32) = (2.5, 12.0, 1.8);

/// Depth of the cloth, m: it hangs over the front of the table.
const DEPTH: f32 = 1.3;

/// A hand, and where it waits.
#[derive(Component)]
struct Hand(Vec3);

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, pull)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let size = Vec3::new(1.4, 0.06, 0.9);
    commands.spawn((
        ClothCollider::Cuboid { size },
        ColliderFriction(0.2),
        Mesh3d(meshes.add(Cuboid::from_size(size))),
        MeshMaterial3d(materials.add(Color::srgb(0.45, 0.3, 0.2))),
        Transform::from_xyz(0.0, 0.7, 0.0),
    ));
    let [skin, white] = [Color::srgb(0.8, 0.6, 0.5), Color::srgb(0.85, 0.85, 0.8)].map(|color| materials.add(color));
    let ball = meshes.add(Sphere::new(0.04));
    // The cloth lies in the xz plane once it is turned; its lower edge is the front one, at z = DEPTH / 2.
    let [left, right] = [-0.6, 0.6].map(|x| {
        let at = Vec3::new(x, 0.75, DEPTH / 2.0);
        let place = Transform::from_translation(at);
        commands.spawn((Hand(at), Mesh3d(ball.clone()), MeshMaterial3d(skin.clone()), place)).id()
    });
    let edge = |x: f32| {
        let (x, y) = (x - 0.08, -DEPTH / 2.0 - 0.01);
        Pins::region(Vec3::new(x, y, -0.1), Vec3::new(x + 0.16, y + 0.03, 0.1))
    };
    commands.spawn((
        Cloth::rectangle(1.4, DEPTH),
        Fabric::COTTON_POPLIN,
        edge(-0.6).to_entity(left).and(edge(0.6).to_entity(right)),
        MeshMaterial3d(white),
        Transform::from_xyz(0.0, 0.75, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2)),
    ));
    commands.spawn((
        ClothCollider::Ground,
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.6, 0.6))),
    ));
    commands
        .spawn((Camera3d::default(), Transform::from_xyz(2.0, 1.7, 2.4).looking_at(Vec3::new(0.0, 0.6, 0.4), Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 4.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn pull(mut hands: Query<(&Hand, &mut Transform)>, time: Res<Time>) {
    let (begin, acceleration, distance) = PULL;
    let since = (time.elapsed_secs() - begin).max(0.0);
    for (hand, mut place) in &mut hands {
        place.translation = hand.0 + Vec3::Z * (0.5 * acceleration * since * since).min(distance);
    }
}
