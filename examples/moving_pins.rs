//! Pins can follow any entity: two hands carry a towel by its corners and shake it.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothPlugin, Fabric, Pins};

/// A hand, and the phase of its movement, rad.
#[derive(Component)]
struct Hand(f32);

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, shake)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let skin = materials.add(Color::srgb(0.8, 0.6, 0.5));
    let ball = meshes.add(Sphere::new(0.05));
    let [left, right] = [(-0.5, 0.0), (0.5, 1.0)].map(|(x, phase)| {
        let place = Transform::from_xyz(x, 0.5, 0.0);
        commands.spawn((Hand(phase), Mesh3d(ball.clone()), MeshMaterial3d(skin.clone()), place)).id()
    });
    // A small box around each upper corner chooses the particles that a hand holds.
    let corner = |x: f32| Pins::region(Vec3::new(x - 0.06, 0.44, -0.1), Vec3::new(x + 0.06, 0.56, 0.1));
    commands.spawn((
        Cloth::rectangle(1.0, 1.0),
        Fabric::TERRY_TOWEL,
        corner(-0.5).to_entity(left).and(corner(0.5).to_entity(right)),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.85, 0.8))),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.8, 0.6, 3.0).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn shake(mut hands: Query<(&Hand, &mut Transform)>, time: Res<Time>) {
    for (hand, mut transform) in &mut hands {
        let angle = 5.0 * time.elapsed_secs() + hand.0;
        transform.translation.y = 0.5 + 0.12 * angle.sin();
        transform.translation.z = 0.25 * (0.5 * angle).sin();
    }
}
