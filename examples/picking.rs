//! What is under the pointer: an arrow stands on the cloth there, the title of the window tells the triangle and how fast it moves, and a
//! click is told in the log. Drag with the left mouse button to see it move.

use bevy::picking::hover::HoverMap;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothHit, ClothPlugin, ClothTopology, Fabric, Particles, Pins};

fn main() -> AppExit {
    App::new()
        .add_plugins((DefaultPlugins, ClothPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(Update, show)
        .add_observer(on_click)
        .run()
}

fn setup(mut commands: Commands, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.spawn((
        Name::new("towel"),
        Cloth::rectangle(1.2, 1.0),
        Fabric::TERRY_TOWEL,
        Pins::rods(3),
        MeshMaterial3d(materials.add(Color::srgb(0.3, 0.5, 0.65))),
    ));
    commands.spawn((Camera3d::default(), Transform::from_xyz(1.3, 0.4, 1.7).looking_at(Vec3::ZERO, Vec3::Y)));
    commands.spawn((
        DirectionalLight { shadow_maps_enabled: true, ..default() },
        Transform::from_xyz(2.0, 3.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
}

/// What hovers is listed for each pointer and entity; of a cloth it carries a `ClothHit`.
fn show(
    hovered: Res<HoverMap>,
    cloths: Query<(NameOrEntity, &ClothTopology, &Particles)>,
    mut window: Single<&mut Window>,
    mut gizmos: Gizmos,
) {
    window.title = "nothing under the pointer".into();
    for (entity, hit) in hovered.values().flatten() {
        let (Ok((name, topology, particles)), Some(at)) = (cloths.get(*entity), hit.extra_as::<ClothHit>()) else {
            continue;
        };
        let (Some(position), Some(normal)) = (hit.position, hit.normal) else { continue };
        let corners = topology.triangles[at.triangle as usize].map(|slot| particles.velocity.get(slot as usize));
        let velocity = corners[0] * at.weights.x + corners[1] * at.weights.y + corners[2] * at.weights.z;
        window.title = format!("{name}: triangle {}, {:.2} m/s", at.triangle, velocity.length());
        gizmos.arrow(position, position + 0.3 * normal, Color::srgb(1.0, 0.8, 0.2));
    }
}

fn on_click(mut click: On<Pointer<Click>>) {
    // Else the window would be told of it, too.
    click.propagate(false);
    if let Some(hit) = click.hit.extra_as::<ClothHit>() {
        info!("clicked at {:?}, nearest to particle {} of {}", click.hit.position, hit.particle, click.entity);
    }
}
