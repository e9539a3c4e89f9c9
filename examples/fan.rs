//! A fan blows at a towel on a line and turns from side to side; the post before it keeps the wind off.

use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothClock, ClothCollider, ClothPlugin, Fabric, Fan, Oscillation, Pins};

/// The disc that shows where the fan blows.
#[derive(Component)]
struct Disc;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(Update, turn)
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    // Only cloth with `Air` feels the fan.
    commands.spawn((
        Cloth::rectangle(1.2, 1.0),
        Fabric::TERRY_TOWEL,
        Pins::rods(4),
        Air::default(),
        MeshMaterial3d(materials.add(Color::srgb(0.85, 0.6, 0.3))),
    ));
    // It blows along its −z, as everything looks in Bevy.
    let oscillation = Some(Oscillation { angle: 0.5, rate: 12.0 });
    let fan = Fan { diameter: 0.4, speed: 7.0, oscillation, ..default() };
    let place = Transform::from_xyz(-0.8, 0.0, 1.4).looking_at(Vec3::ZERO, Vec3::Y);
    let disc = (
        Disc,
        Mesh3d(meshes.add(Cylinder::new(fan.diameter / 2.0, 0.05))),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.35, 0.4))),
    );
    commands.spawn((fan, place, Visibility::default())).with_child(disc);
    commands.spawn((
        ClothCollider::Capsule { radius: 0.05, length: 1.5 },
        Mesh3d(meshes.add(Capsule3d::new(0.05, 1.5))),
        MeshMaterial3d(materials.add(Color::srgb(0.5, 0.4, 0.35))),
        Transform::from_xyz(-0.3, 0.0, 0.6),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(1.9, 0.7, 2.6).looking_at(Vec3::Z * 0.3, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// The fan's own transform stays as it is; what is seen of it turns as its air does.
fn turn(fans: Query<&Fan>, mut discs: Query<(&mut Transform, &ChildOf), With<Disc>>, clock: Res<Time<ClothClock>>) {
    for (mut disc, child_of) in &mut discs {
        let Some(oscillation) = fans.get(child_of.parent()).ok().and_then(|fan| fan.oscillation) else { continue };
        let angle = oscillation.angle(clock.elapsed_secs_f64());
        // A cylinder stands along y; the disc faces along z.
        disc.rotation = Quat::from_rotation_y(angle) * Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    }
}
