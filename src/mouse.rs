//! To whom a drag of the mouse belongs: the cloth, the transform gizmo, a panel, or the camera.
//!
//! The cloth comes first. The camera takes a drag only where it begins over nothing, or with Alt held down.

use bevy::gizmos::transform_gizmo::{TransformGizmoState, TransformGizmoSystems};
use bevy::input::InputSystems;
use bevy::picking::PickingSystems;
use bevy::picking::hover::HoverMap;
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth::ClothPicking;
use bevy_egui::input::EguiWantsInput;
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraSystemSet};

/// Decides who gets the mouse.
pub struct MousePlugin;

impl Plugin for MousePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, lend_to_cloth.after(InputSystems).before(PickingSystems::Backend))
            .add_systems(PostUpdate, lend_to_camera.before(PanOrbitCameraSystemSet))
            .configure_sets(PostUpdate, TransformGizmoSystems.run_if(gizmo_may_work));
    }
}

/// Buttons that do something to cloth while they are held.
const TO_CLOTH: [MouseButton; 3] = [MouseButton::Left, MouseButton::Right, MouseButton::Middle];

/// The cloth may be grabbed and cut unless the press is meant for a panel, the gizmo or, by a key held down, the camera. A
/// drag keeps what it began with.
fn lend_to_cloth(
    mut cloth: ResMut<ClothPicking>,
    gizmo: Res<TransformGizmoState>,
    mouse: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
    panels: Res<EguiWantsInput>,
) {
    if TO_CLOTH.iter().any(|button| mouse.pressed(*button) && !mouse.just_pressed(*button)) {
        return;
    }
    let enabled = !panels.wants_any_pointer_input() && !is_for_gizmo(&gizmo) && !is_for_camera(&keys);
    if cloth.enabled != enabled {
        cloth.enabled = enabled;
    }
}

/// The camera keeps what it has for as long as the button is down.
fn lend_to_camera(
    mut cameras: Query<&mut PanOrbitCamera>,
    mut drag_is_camera: Local<bool>,
    gizmo: Res<TransformGizmoState>,
    mouse: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
    panels: Res<EguiWantsInput>,
    hovered: Res<HoverMap>,
    windows: Query<(), With<PrimaryWindow>>,
) {
    if mouse.just_pressed(MouseButton::Left) {
        let over_something = hovered
            .get(&PointerId::Mouse)
            .is_some_and(|entities| entities.keys().any(|entity| !windows.contains(*entity)));
        *drag_is_camera =
            !panels.wants_any_pointer_input() && !is_for_gizmo(&gizmo) && (is_for_camera(&keys) || !over_something);
    }
    let enabled = if mouse.pressed(MouseButton::Left) { *drag_is_camera } else { !panels.wants_any_pointer_input() };
    for mut camera in &mut cameras {
        if camera.enabled != enabled {
            camera.enabled = enabled;
        }
    }
}

/// Whether a press here would take hold of the gizmo, or has.
pub fn is_for_gizmo(gizmo: &TransformGizmoState) -> bool {
    gizmo.active || gizmo.hovered_axis.is_some()
}

fn is_for_camera(keys: &ButtonInput<KeyCode>) -> bool {
    keys.any_pressed([KeyCode::AltLeft, KeyCode::AltRight])
}

/// The gizmo finishes what it has begun, and begins nothing under a panel or while Alt is held down.
fn gizmo_may_work(
    gizmo: Res<TransformGizmoState>,
    panels: Res<EguiWantsInput>,
    keys: Res<ButtonInput<KeyCode>>,
) -> bool {
    gizmo.active || !(panels.wants_any_pointer_input() || is_for_camera(&keys))
}
