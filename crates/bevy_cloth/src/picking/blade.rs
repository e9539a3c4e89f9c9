//! The blade of a pointer: cuts every cloth that its ray sweeps over while a button is held.

use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::picking::backend::ray::RayMap;
use bevy::picking::pointer::{PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;

use super::backend::Shown;
use super::{ClothPicking, ClothTool};
use crate::damage::Whole;

/// How far a blade reaches, m.
const REACH: f32 = 1000.0;

/// The strokes of all pointers.
#[derive(Resource, Debug, Default)]
pub(crate) struct Strokes {
    going_on: Vec<Stroke>,
    /// How many there ever were.
    count: u64,
}

/// One stroke, from where the button went down.
#[derive(Debug)]
struct Stroke {
    number: u64,
    pointer: PointerId,
    button: PointerButton,
    at: Vec2,
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
    let mut ended = !settings.enabled && strokes.end(|_| true);
    for event in input.read() {
        let (pointer, location) = (event.pointer_id, &event.location);
        match event.action {
            PointerAction::Press(button) if settings.tool(button) == Some(ClothTool::Cut) => {
                ended |= strokes.end(|stroke| stroke.pointer == pointer);
                strokes.count += 1;
                let number = strokes.count;
                strokes.going_on.push(Stroke { number, pointer, button, at: location.position });
            }
            PointerAction::Release(button) => {
                ended |= strokes.end(|stroke| stroke.pointer == pointer && stroke.button == button);
            }
            PointerAction::Cancel => ended |= strokes.end(|stroke| stroke.pointer == pointer),
            PointerAction::Move { .. } => {
                let Some(stroke) = strokes.going_on.iter_mut().find(|stroke| stroke.pointer == pointer) else {
                    continue;
                };
                let from = std::mem::replace(&mut stroke.at, location.position);
                for (id, _) in rays.iter().filter(|(id, _)| id.pointer == pointer) {
                    let Ok((camera, place, layers)) = cameras.get(id.camera) else { continue };
                    let ray = |at: Vec2| ray(camera, place, at);
                    let (Some(first), Some(last)) = (ray(from), ray(location.position)) else { continue };
                    let which = [stroke.number, id.camera.to_bits()];
                    for (mut cloth, cloth_layers) in &mut cloths {
                        let seen = layers.unwrap_or_default().intersects(cloth_layers.unwrap_or_default());
                        if seen && shown.get(cloth.entity) {
                            let begun = cloth.history.strokes.take(which);
                            let stroke = cloth.sweep(begun, [first, last], REACH, true, &mut commands);
                            cloth.history.strokes.put(which, stroke);
                        }
                    }
                }
            }
            _ => {}
        }
    }
    if ended {
        let is_going_on = |number| strokes.going_on.iter().any(|stroke| stroke.number == number);
        cloths.iter_mut().for_each(|(mut cloth, _)| cloth.history.strokes.retain(is_going_on));
    }
}

impl Strokes {
    /// Ends those that are `over`; whether any is.
    fn end(&mut self, over: impl Fn(&Stroke) -> bool) -> bool {
        self.going_on.extract_if(.., |stroke| over(stroke)).count() > 0
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
