//! To whom a drag of the mouse belongs: the cloth or another tool, the transform gizmo, a panel, or the camera.
//!
//! The tool comes first. The camera takes a drag only where it begins over nothing and the tool does nothing there, or with
//! Alt held down.

use bevy::ecs::system::SystemParam;
use bevy::gizmos::transform_gizmo::{TransformGizmoState, TransformGizmoSystems};
use bevy::input::InputSystems;
use bevy::picking::PickingSystems;
use bevy::picking::hover::HoverMap;
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth::{ClothPicking, Grabs};
use bevy_egui::input::EguiWantsInput;
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraSystemSet};

use crate::tools::ActiveTool;

/// Decides who gets the mouse.
pub struct MousePlugin;

impl Plugin for MousePlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, lend_to_tools.after(InputSystems).before(PickingSystems::Backend))
            .add_systems(PostUpdate, lend_to_camera.before(PanOrbitCameraSystemSet))
            .configure_sets(PostUpdate, TransformGizmoSystems.run_if(gizmo_may_work));
    }
}

/// Buttons that do something to cloth while they are held.
const TO_CLOTH: [MouseButton; 3] = [MouseButton::Left, MouseButton::Right, MouseButton::Middle];

/// What says whose the mouse is.
#[derive(SystemParam)]
pub struct Mouse<'w, 's> {
    gizmo: Res<'w, TransformGizmoState>,
    buttons: Res<'w, ButtonInput<MouseButton>>,
    keys: Res<'w, ButtonInput<KeyCode>>,
    panels: Res<'w, EguiWantsInput>,
    grabbed: Query<'w, 's, (), With<Grabs>>,
}

impl Mouse<'_, '_> {
    /// Whether a press is meant for a tool, not for a panel, the gizmo or, by a key held down, the camera.
    pub fn is_for_tool(&self) -> bool {
        !self.panels.wants_any_pointer_input() && !is_for_gizmo(&self.gizmo) && !is_for_camera(&self.keys)
    }

    /// Whether the hand holds cloth.
    pub fn holds(&self) -> bool {
        self.buttons.pressed(MouseButton::Left) && !self.grabbed.is_empty()
    }

    /// Whether a button is down that was down before.
    pub fn drags(&self) -> bool {
        TO_CLOTH.iter().any(|button| self.buttons.pressed(*button) && !self.buttons.just_pressed(*button))
    }
}

/// The tools work unless the press is meant for someone else. A drag keeps what it began with.
fn lend_to_tools(mut cloth: ResMut<ClothPicking>, mouse: Mouse) {
    let enabled = mouse.is_for_tool();
    if !mouse.drags() && cloth.enabled != enabled {
        cloth.enabled = enabled;
    }
}

/// The camera keeps what it has for as long as the button is down.
fn lend_to_camera(
    mut cameras: Query<&mut PanOrbitCamera>,
    mut drag_is_camera: Local<bool>,
    mouse: Mouse,
    tool: Res<ActiveTool>,
    hovered: Res<HoverMap>,
    windows: Query<(), With<PrimaryWindow>>,
) {
    if mouse.buttons.just_pressed(MouseButton::Left) {
        let over_something = hovered
            .get(&PointerId::Mouse)
            .is_some_and(|entities| entities.keys().any(|entity| !windows.contains(*entity)));
        let is_tool = over_something || tool.0.works_anywhere();
        let is_free = !mouse.panels.wants_any_pointer_input() && !is_for_gizmo(&mouse.gizmo);
        *drag_is_camera = is_free && (is_for_camera(&mouse.keys) || !is_tool);
    }
    let pressed = mouse.buttons.pressed(MouseButton::Left);
    let enabled = if pressed { *drag_is_camera } else { !mouse.panels.wants_any_pointer_input() };
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
