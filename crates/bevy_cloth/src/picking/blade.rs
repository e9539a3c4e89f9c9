//! The blade of a pointer: cuts every cloth that its ray sweeps over while a button is held.

use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::pointer::{PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;

use super::ClothPicking;
use super::backend::Shown;
use crate::damage::{CutStroke, Whole};

/// How far a blade reaches, m.
const REACH: f32 = 1000.0;

/// The strokes of all pointers.
#[derive(Resource, Debug, Default)]
pub(crate) struct Strokes(Vec<Stroke>);

/// One stroke, from where the button went down.
#[derive(Debug)]
struct Stroke {
    pointer: PointerId,
    button: PointerButton,
    at: Vec2,
    /// Where it left off in each cloth, seen by each camera.
    cuts: Vec<(Entity, Entity, CutStroke)>,
}

/// Follows every event of the pointers, also if there are many in a frame: what lies between two is swept over.
pub(crate) fn cut(
    mut input: MessageReader<PointerInput>,
    settings: Res<ClothPicking>,
    rays: Res<RayMap>,
    cameras: Query<(&Camera, &GlobalTransform, Option<&RenderLayers>)>,
    mut cloths: Query<(Whole, Option<&RenderLayers>)>,
    shown: Shown,
    mut strokes: ResMut<Strokes>,
    mut commands: Commands,
) {
    if !settings.enabled {
        strokes.0.clear();
    }
    for event in input.read() {
        let (pointer, location) = (event.pointer_id, &event.location);
        match event.action {
            PointerAction::Press(button) if settings.enabled && settings.cut_button == Some(button) => {
                strokes.0.retain(|stroke| stroke.pointer != pointer);
                strokes.0.push(Stroke { pointer, button, at: location.position, cuts: Vec::new() });
            }
            PointerAction::Release(button) => {
                strokes.0.retain(|stroke| stroke.pointer != pointer || stroke.button != button);
            }
            PointerAction::Cancel => strokes.0.retain(|stroke| stroke.pointer != pointer),
            PointerAction::Move { .. } => {
                let Some(stroke) = strokes.0.iter_mut().find(|stroke| stroke.pointer == pointer) else { continue };
                let from = std::mem::replace(&mut stroke.at, location.position);
                for (id, _) in rays.iter().filter(|(id, _)| id.pointer == pointer) {
                    let Ok((camera, place, layers)) = cameras.get(id.camera) else { continue };
                    let ray = |at: Vec2| ray(camera, place, at);
                    let (Some(first), Some(last)) = (ray(from), ray(location.position)) else { continue };
                    for (mut cloth, cloth_layers) in &mut cloths {
                        let seen = layers.unwrap_or_default().intersects(cloth_layers.unwrap_or_default());
                        if seen && shown.get(cloth.entity) {
                            stroke.of(id.camera, cloth.entity).sweep(&mut cloth, first, last, REACH, &mut commands);
                        }
                    }
                }
            }
            _ => {}
        }
    }
}

impl Stroke {
    fn of(&mut self, camera: Entity, cloth: Entity) -> &mut CutStroke {
        let known = self.cuts.iter().position(|(from, in_, _)| (*from, *in_) == (camera, cloth));
        let at = known.unwrap_or_else(|| {
            self.cuts.push((camera, cloth, CutStroke::default()));
            self.cuts.len() - 1
        });
        &mut self.cuts[at].2
    }
}

/// The ray of a camera through a point of its target.
fn ray(camera: &Camera, place: &GlobalTransform, at: Vec2) -> Option<Ray3d> {
    let corner = camera.viewport.as_ref().map(|viewport| camera.to_logical(viewport.physical_position));
    let corner = match corner {
        Some(corner) => corner?,
        None => Vec2::ZERO,
    };
    camera.viewport_to_world(place, at - corner).ok()
}
