//! The hand of a pointer: takes hold of a cloth, pulls it, lets go.

use bevy::camera::Camera;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::events::{Pointer, Press};
use bevy::picking::pointer::{PointerAction, PointerButton, PointerId, PointerInput, PointerMap};
use bevy::prelude::*;

use super::{ClothHit, ClothPicking, ClothTool};
use crate::cloth::ClothTopology;
use crate::settings::{Grab, Grabs};

/// What all pointers hold.
#[derive(Resource, Debug, Default)]
pub(crate) struct Hands {
    holds: Vec<Hold>,
    /// How many hands there ever were.
    count: u32,
}

/// What one pointer holds. It moves in the plane through the point it took, square to the view.
#[derive(Debug)]
struct Hold {
    pointer: PointerId,
    button: PointerButton,
    camera: Entity,
    cloth: Entity,
    hand: u32,
    through: Vec3,
    facing: InfinitePlane3d,
}

/// Takes hold of the cloth under a pointer when the button goes down.
pub(crate) fn grab(
    press: On<Pointer<Press>>,
    settings: Res<ClothPicking>,
    cloths: Query<(), With<ClothTopology>>,
    cameras: Query<&GlobalTransform, With<Camera>>,
    mut hands: ResMut<Hands>,
    mut commands: Commands,
) {
    let (cloth, camera) = (press.entity, press.hit.camera);
    // The event climbs up to the parents of what was hit.
    let hit = press.hit.extra_as::<ClothHit>().filter(|_| cloth == press.original_event_target());
    let (Some(hit), Some(through), Ok(view)) = (hit, press.hit.position, cameras.get(camera)) else { return };
    if settings.tool(press.button) != Some(ClothTool::Grab) || !cloths.contains(cloth) {
        return;
    }
    hands.let_go(&mut commands, |hold| hold.pointer == press.pointer_id);
    hands.count = hands.count.wrapping_add(1);
    let hand = u32::MAX - hands.count;
    let facing = InfinitePlane3d { normal: view.back() };
    hands.holds.push(Hold { pointer: press.pointer_id, button: press.button, camera, cloth, hand, through, facing });
    let ClothPicking { stiffness, max_force, .. } = *settings;
    let grab = Grab { hand, triangle: hit.triangle, weights: hit.weights, target: through, stiffness, max_force };
    commands.entity(cloth).entry::<Grabs>().or_default().and_modify(move |mut grabs| grabs.0.push(grab));
}

impl Hands {
    /// Opens every hand whose hold is `over`.
    fn let_go(&mut self, commands: &mut Commands, over: impl Fn(&Hold) -> bool) {
        for hold in self.holds.extract_if(.., |hold| over(hold)) {
            let hand = hold.hand;
            commands.queue(move |world: &mut World| {
                let Ok(mut cloth) = world.get_entity_mut(hold.cloth) else { return };
                let empty = cloth.get_mut::<Grabs>().is_some_and(|mut grabs| {
                    grabs.0.retain(|grab| grab.hand != hand);
                    grabs.0.is_empty()
                });
                if empty {
                    cloth.remove::<Grabs>();
                }
            });
        }
    }
}

/// Lets go when the button goes up or the pointer is cancelled, wherever it is by then, and when the pointer is gone
/// or picking switched off.
pub(crate) fn release(
    mut input: MessageReader<PointerInput>,
    settings: Res<ClothPicking>,
    pointers: Res<PointerMap>,
    mut hands: ResMut<Hands>,
    mut commands: Commands,
) {
    if hands.holds.is_empty() {
        input.clear();
        return;
    }
    // Only the last word counts: a button that went up and down again in one frame has taken a new hold.
    let mut last = Vec::new();
    for event in input.read() {
        let (button, over) = match event.action {
            PointerAction::Press(button) => (Some(button), false),
            PointerAction::Release(button) => (Some(button), true),
            PointerAction::Cancel => (None, true),
            _ => continue,
        };
        last.retain(|(pointer, known, _)| *pointer != event.pointer_id || (button.is_some() && *known != button));
        last.push((event.pointer_id, button, over));
    }
    let gone = |hold: &Hold| !settings.enabled || pointers.get_entity(hold.pointer).is_none();
    let opened = |hold: &Hold| {
        let concerns = |button: &Option<PointerButton>| button.is_none_or(|button| button == hold.button);
        last.iter().any(|(pointer, button, over)| *over && *pointer == hold.pointer && concerns(button))
    };
    hands.let_go(&mut commands, |hold| gone(hold) || opened(hold));
}

/// Moves every hand to where its pointer is, also when only the camera moved.
pub(crate) fn pull(
    rays: Res<RayMap>,
    settings: Res<ClothPicking>,
    mut hands: ResMut<Hands>,
    mut grabs: Query<&mut Grabs>,
) {
    if hands.holds.is_empty() {
        return;
    }
    hands.holds.retain(|hold| {
        let Ok(mut grabs) = grabs.get_mut(hold.cloth) else { return false };
        let Some(index) = grabs.0.iter().position(|grab| grab.hand == hold.hand) else { return false };
        // A pointer outside the camera's view has no ray: the hand stays.
        let ray = rays.map.get(&RayId::new(hold.camera, hold.pointer));
        let distance = ray.and_then(|ray| ray.intersect_plane(hold.through, hold.facing));
        let target = ray.zip(distance).map_or(grabs.0[index].target, |(ray, distance)| ray.get_point(distance));
        let ClothPicking { stiffness, max_force, .. } = *settings;
        let moved = Grab { target, stiffness, max_force, ..grabs.0[index] };
        if grabs.0[index] != moved {
            grabs.0[index] = moved;
        }
        true
    });
}
