//! Duplicating and deleting whole objects.

use bevy::camera::Camera3d;
use bevy::camera::primitives::Aabb;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_cloth::{Fan, Grabs, ParticlePins};
use bevy_cloth_inspector::Selected;

use super::reset::{Deleted, MadeInPlay, Opened};
use crate::throw::Ball;

/// The farthest a copy is put beside its original, m.
const FARTHEST: f32 = 0.6;
/// How far, in widths of the original.
const WIDTHS: f32 = 1.1;

/// Copies the selected object, or what it hangs on, and selects the copy.
#[derive(Event, Clone, Copy, Debug)]
pub struct DuplicateSelected;

/// Deletes the selected object. What the scene was opened with comes back when the scene is reset.
#[derive(Event, Clone, Copy, Debug)]
pub struct DeleteSelected;

pub fn plugin(app: &mut App) {
    app.add_observer(duplicate).add_observer(delete);
}

fn duplicate(
    _: On<DuplicateSelected>,
    mut selected: ResMut<Selected>,
    parents: Query<&ChildOf>,
    objects: Query<(&Transform, Option<&Name>, Has<Fan>)>,
    balls: Query<&Ball>,
    bounds: Query<(&Aabb, &GlobalTransform)>,
    children: Query<&Children>,
    cameras: Query<&GlobalTransform, With<Camera3d>>,
    mut commands: Commands,
) {
    let Some(root) = selected.0.map(|entity| parents.root_ancestor(entity)) else { return };
    let Ok((place, name, is_fan)) = objects.get(root) else { return };
    let right = cameras.iter().next().map_or(Vec3::X, |camera| *camera.right());
    let right = right.with_y(0.0).normalize_or(Vec3::X);
    let parts = std::iter::once(root).chain(children.iter_descendants(root));
    let half_widths = parts.filter_map(|part| bounds.get(part).ok()).map(|(bounds, place)| {
        let across = place.affine().matrix3.transpose() * Vec3A::from(right);
        across.abs().dot(bounds.half_extents)
    });
    let width = 2.0 * half_widths.fold(0.1, f32::max);
    let beside = Transform { translation: place.translation + right * (WIDTHS * width).min(FARTHEST), ..*place };
    let copy = commands
        .entity(root)
        .clone_and_spawn_with_opt_out(move |cloner| {
            // A fan gets a body of its own, as every new one does.
            cloner.linked_cloning(!is_fan).deny::<(Opened, Grabs, ParticlePins)>();
        })
        .insert((MadeInPlay, beside))
        .id();
    if let Some(name) = name {
        commands.entity(copy).insert(Name::new(format!("{} copy", name.trim_end_matches(" copy"))));
    }
    if balls.contains(root) {
        let last = balls.iter().map(|ball| ball.number).max().unwrap_or(0);
        if let Ok(ball) = balls.get(root) {
            commands.entity(copy).insert(ball.renumbered(last + 1));
        }
    }
    selected.0 = Some(copy);
}

fn delete(
    _: On<DeleteSelected>,
    mut selected: ResMut<Selected>,
    made: Query<(), With<MadeInPlay>>,
    parents: Query<&ChildOf>,
    mut commands: Commands,
) {
    let Some(entity) = selected.0.take() else { return };
    if made.contains(parents.root_ancestor(entity)) {
        commands.entity(entity).despawn();
    } else {
        commands.entity(entity).insert(Deleted).insert_recursive::<Children>(Disabled);
    }
}
