//! A force of one's own: a magnet swings before a cloth with iron threads and pulls at it. A system put into `ClothSystems::Forces` runs
//! before every tick of the cloth, also in slow motion, and not while the clock is paused.

use bevy::prelude::*;
use bevy_cloth::{
    Cloth, ClothCollider, ClothFrame, ClothPlugin, ClothSchedule, ClothSleep, ClothSystems, ClothTopology, Fabric,
    Particles, Pins,
};

/// The magnet, and the acceleration that it gives cloth at its surface, m/s².
#[derive(Component)]
struct Magnet(f32);

/// Cloth that feels magnets.
#[derive(Component)]
struct Iron;

const RADIUS: f32 = 0.12;

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, swing)
        .add_systems(ClothSchedule, pull.in_set(ClothSystems::Forces))
        .run()
}

fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Cloth::rectangle(1.6, 1.2),
        Fabric::SILK_CHARMEUSE,
        Pins::top(),
        Iron,
        // Cloth that sleeps feels no force; what comes from outside the plugin does not wake it.
        ClothSleep::NEVER,
        MeshMaterial3d(materials.add(Color::srgb(0.45, 0.5, 0.6))),
    ));
    commands.spawn((
        Magnet(30.0),
        ClothCollider::Sphere { radius: RADIUS },
        Mesh3d(meshes.add(Sphere::new(RADIUS))),
        MeshMaterial3d(materials.add(Color::srgb(0.8, 0.15, 0.15))),
        Transform::from_xyz(0.0, -0.2, 0.35),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(1.6, 0.3, 1.9).looking_at(Vec3::NEG_Y * 0.1, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

fn swing(mut magnet: Single<&mut Transform, With<Magnet>>, time: Res<Time>) {
    magnet.translation.x = 0.5 * time.elapsed_secs().sin();
}

fn pull(
    mut cloths: Query<(&ClothTopology, &ClothFrame, &mut Particles), With<Iron>>,
    magnets: Query<(&Magnet, &GlobalTransform)>,
) {
    for (topology, frame, mut particles) in &mut cloths {
        for (magnet, place) in &magnets {
            // Particles and their forces are in the cloth's own frame.
            let center = frame.to_local(place.translation());
            for slot in topology.particles().map(|slot| slot as usize) {
                let way = center - particles.position.get(slot);
                // Falls with the square of the distance; within the magnet it is that of its surface.
                let strength = magnet.0 * RADIUS * RADIUS / way.length_squared().max(RADIUS * RADIUS);
                let force = particles.mass[slot] * strength * way.normalize_or_zero();
                particles.add_force(slot, force);
            }
        }
    }
}
