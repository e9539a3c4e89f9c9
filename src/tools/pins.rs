//! Pins: the heads that show where cloth is pinned by hand. Pinning itself is the plugin's.

use bevy::light::NotShadowCaster;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_cloth::{ParticlePins, PinTarget};

use crate::scenes::paint;

/// Radius of a pin's head, m.
const HEAD: f32 = 0.018;
/// Its colour.
const COLOR: Color = Color::srgb(0.95, 0.20, 0.12);

/// The head of a pin: its cloth and particle.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Head(pub Entity, pub u32);

#[derive(Resource)]
struct Look(Handle<Mesh>, Handle<StandardMaterial>);

pub fn plugin(app: &mut App) {
    app.add_systems(Startup, forge).add_systems(Update, show.run_if(resource_exists::<Look>));
}

fn forge(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    commands.insert_resource(Look(meshes.add(Sphere::new(HEAD)), materials.add(paint(COLOR))));
}

/// Keeps a head at every particle that is pinned to the world.
fn show(
    cloths: Query<(Entity, &ParticlePins)>,
    heads: Query<(Entity, &Head, &Transform)>,
    look: Res<Look>,
    mut commands: Commands,
) {
    if cloths.is_empty() && heads.is_empty() {
        return;
    }
    let pinned = cloths.iter().flat_map(|(cloth, pins)| pins.held.iter().map(move |pin| (cloth, pin)));
    let in_world = pinned.filter(|(_, pin)| pin.to == PinTarget::World);
    let mut wanted: HashMap<Head, Vec3> = in_world.map(|(cloth, pin)| (Head(cloth, pin.particle), pin.at)).collect();
    for (entity, head, place) in &heads {
        if wanted.get(head) == Some(&place.translation) {
            wanted.remove(head);
        } else {
            commands.entity(entity).despawn();
        }
    }
    for (head, at) in wanted {
        let parts = (Mesh3d(look.0.clone()), MeshMaterial3d(look.1.clone()));
        commands.spawn((head, parts, Transform::from_translation(at), NotShadowCaster, Pickable::IGNORE));
    }
}
