//! Selecting by click or number, and the transform gizmo on what is selected.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{ClearColorConfig, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::transform_gizmo::{
    TransformGizmoFocus, TransformGizmoMode, TransformGizmoSettings, TransformGizmoState,
};
use bevy::picking::pointer::PointerButton;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth_inspector::Selected;

use crate::mouse::is_for_gizmo;

/// A press that moved farther than this before it was released is a drag, not a click; logical pixels.
const CLICK_RADIUS: f32 = 4.0;
/// How near to a handle of the gizmo a press takes hold of it, logical pixels.
const GIZMO_REACH: f32 = 12.0;

/// The render layer of the gizmo's handles, see `GIZMO_RENDER_LAYER` in `bevy_gizmos_render`.
const GIZMO_LAYER: usize = 15;

/// Something a click selects; the number is the key that selects it, too, if it is 1 to 9.
#[derive(Component, Clone, Copy, Debug)]
pub struct Selectable(pub u8);

/// Where the mouse went down, unless on the gizmo.
#[derive(Resource, Default)]
struct PressedAt(Option<Vec2>);

/// Selects what is clicked.
pub struct SelectPlugin;

impl Plugin for SelectPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PressedAt>()
            .add_systems(Startup, shape_gizmo)
            .add_systems(PostStartup, mend_overlay)
            .add_systems(Update, (focus_gizmo, show_overlay).run_if(resource_changed::<Selected>))
            .add_observer(note_press)
            .add_observer(select_clicked);
    }
}

fn shape_gizmo(mut settings: ResMut<TransformGizmoSettings>) {
    settings.mode = TransformGizmoMode::Translate;
    settings.axis_hit_distance = GIZMO_REACH;
    settings.confine_cursor = false;
}

/// The camera that Bevy draws the gizmo's handles with. Its marker is private; its layer is its own.
#[derive(Component)]
struct Overlay;

/// Bevy 0.19.1 spawns the overlay with the default clear colour, which wipes what the other cameras drew.
fn mend_overlay(mut commands: Commands, mut cameras: Query<(Entity, &mut Camera, &RenderLayers)>) {
    let layer = RenderLayers::layer(GIZMO_LAYER);
    for (entity, mut camera, _) in cameras.iter_mut().filter(|(_, _, layers)| **layers == layer) {
        camera.clear_color = ClearColorConfig::None;
        // It draws on the finished picture of the scene's camera, whose format it must share.
        commands.entity(entity).insert((Overlay, Hdr, Tonemapping::None));
    }
}

/// Without handles to show the overlay is not drawn at all.
fn show_overlay(selected: Res<Selected>, mut overlays: Query<&mut Camera, With<Overlay>>) {
    for mut camera in &mut overlays {
        camera.is_active = selected.0.is_some();
    }
}

fn note_press(press: On<Pointer<Press>>, mut pressed: ResMut<PressedAt>, gizmo: Res<TransformGizmoState>) {
    if press.button == PointerButton::Primary {
        pressed.0 = (!is_for_gizmo(&gizmo)).then_some(press.pointer_location.position);
    }
}

/// Selects the clicked entity or the nearest of its ancestors that can be selected; a click on nothing deselects.
fn select_clicked(
    click: On<Pointer<Click>>,
    pressed: Res<PressedAt>,
    mut selected: ResMut<Selected>,
    selectables: Query<(), With<Selectable>>,
    parents: Query<&ChildOf>,
    windows: Query<(), With<PrimaryWindow>>,
) {
    let clicked = click.original_event_target();
    let is_click = pressed.0.is_some_and(|start| start.distance(click.pointer_location.position) <= CLICK_RADIUS);
    // The event climbs to parents and window; it is answered once, where it starts.
    if click.entity != clicked || click.button != PointerButton::Primary || !is_click {
        return;
    }
    if windows.contains(clicked) {
        selected.0 = None;
    } else if let Some(entity) =
        std::iter::once(clicked).chain(parents.iter_ancestors(clicked)).find(|entity| selectables.contains(*entity))
    {
        selected.0 = Some(entity);
    }
}

/// Puts the gizmo on the selected object, or on what it hangs on: a curtain is moved by its rod.
fn focus_gizmo(
    mut commands: Commands,
    selected: Res<Selected>,
    focused: Query<Entity, With<TransformGizmoFocus>>,
    parents: Query<&ChildOf>,
) {
    let focus = selected.0.map(|entity| parents.root_ancestor(entity));
    for entity in focused.iter().filter(|entity| Some(*entity) != focus) {
        commands.entity(entity).remove::<TransformGizmoFocus>();
    }
    if let Some(entity) = focus {
        commands.entity(entity).insert(TransformGizmoFocus);
    }
}
