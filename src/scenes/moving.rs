//! Colliders, and what holds cloths, that move in the course of a scene.

use bevy::gizmos::transform_gizmo::TransformGizmoState;
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothSchedule, ClothSystems};
use cloth_scene::SceneMotion;

use super::Opened;

/// Moves as its scene says, until it is moved by hand: then it stays.
#[derive(Component, Clone, Debug)]
pub struct Moving {
    motion: SceneMotion,
    /// Its own place.
    home: Transform,
    /// Where it was put last.
    last: Transform,
}

impl Moving {
    /// Moves about its own place, `home`.
    pub fn new(motion: &SceneMotion, home: Transform) -> Self {
        Self { motion: motion.clone(), home, last: home }
    }
}

/// Moves what moves.
pub struct MovingPlugin;

impl Plugin for MovingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(ClothSchedule, go.before(ClothSystems::Prepare));
    }
}

fn go(
    mut movers: Query<(Entity, &mut Moving, &mut Transform)>,
    clock: Res<Time<ClothClock>>,
    opened: Res<Opened>,
    gizmo: Option<Res<TransformGizmoState>>,
    mut commands: Commands,
) {
    let time = clock.elapsed_secs_f64() - opened.at;
    let dragged = gizmo.filter(|gizmo| gizmo.active).and_then(|gizmo| gizmo.entity);
    for (entity, mut moving, mut place) in &mut movers {
        if dragged == Some(entity) || *place != moving.last {
            commands.entity(entity).remove::<Moving>();
            continue;
        }
        let pose = moving.motion.at(time);
        let next = moving.home * Transform::from_translation(pose.position).with_rotation(pose.rotation);
        if *place != next {
            *place = next;
        }
        moving.last = next;
    }
}
