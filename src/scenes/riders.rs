//! Things that stand on a cloth and weigh it down: they are seen where their weight hangs.

use bevy::camera::visibility::VisibilitySystems;
use bevy::prelude::*;
use bevy_cloth::{ClothFrame, ClothSystems, ClothTopology, Particles, ShownShape};

/// Stands on a cloth.
#[derive(Component, Clone, Copy, Debug)]
pub struct Rider {
    /// The cloth.
    pub cloth: Entity,
    /// The vertex of its mesh under it.
    pub vertex: u32,
    /// From its foot up to its middle, m.
    pub half: f32,
}

/// Keeps riders where they stand.
pub struct RidersPlugin;

impl Plugin for RidersPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, ride.after(ClothSystems::Draw).before(VisibilitySystems::CheckVisibility));
    }
}

fn ride(
    mut riders: Query<(Entity, &Rider, &mut Transform, &mut GlobalTransform)>,
    cloths: Query<(&ClothTopology, &Particles, &ClothFrame, &ShownShape)>,
    mut commands: Commands,
) {
    for (entity, rider, mut place, mut global) in &mut riders {
        let Ok((topology, particles, frame, shown)) = cloths.get(rider.cloth) else { continue };
        let Some(slot) = topology.vertex_particle.get(rider.vertex as usize).copied() else { continue };
        let around = topology.triangles.iter().filter(|triangle| triangle.contains(&slot));
        let simulated = |slot: u32| frame.to_world(particles.position.get(slot as usize));
        let at = |slot: u32| shown.in_world(slot).unwrap_or_else(|| simulated(slot));
        let normal = around.map(|[a, b, c]| (at(*b) - at(*a)).cross(at(*c) - at(*a))).sum::<Vec3>();
        let Some(normal) = normal.try_normalize() else {
            // The cloth under it is gone.
            commands.entity(entity).despawn();
            continue;
        };
        let up = if normal.y < 0.0 { -normal } else { normal };
        let wanted =
            Transform::from_translation(at(slot) + up * rider.half).with_rotation(Quat::from_rotation_arc(Vec3::Y, up));
        if *place != wanted {
            // After transforms are propagated, since only then the cloth is where it is drawn. It is nobody's child.
            (*place, *global) = (wanted, wanted.into());
        }
    }
}
