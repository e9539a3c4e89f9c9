//! Selecting by click or key, what a click would select, and the look of the transform gizmo.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{ClearColorConfig, Hdr};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::transform_gizmo::{TransformGizmoMode, TransformGizmoSettings, TransformGizmoState};
use bevy::picking::PickingSystems;
use bevy::picking::hover::HoverMap;
use bevy::picking::pointer::{PointerButton, PointerId};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth::Cloth;
use bevy_cloth_inspector::{Hovered, Selected};

use crate::mouse::{Mouse, is_for_gizmo};
use crate::tools::ActiveTool;

/// A press that moved farther than this before it was released is a drag, not a click; logical pixels.
const CLICK_RADIUS: f32 = 4.0;
/// How near to a handle of the gizmo a press takes hold of it, logical pixels.
const GIZMO_REACH: f32 = 12.0;

/// The render layer of the gizmo's handles, see `GIZMO_RENDER_LAYER` in `bevy_gizmos_render`.
const GIZMO_LAYER: usize = 15;

/// Something a click selects. The number is its turn when the keys go through all objects; 0 is the last.
#[derive(Component, Clone, Copy, Debug)]
pub struct Selectable(pub u8);

/// Selects the object after the selected one, or before it.
#[derive(Event, Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelectNeighbor {
    /// The one after it; without one selected the first.
    Next,
    /// The one before it; without one selected the last.
    Previous,
}

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
            .add_systems(PreUpdate, point_out.in_set(PickingSystems::PostHover))
            .add_systems(Update, show_overlay.run_if(resource_changed::<Selected>))
            .add_observer(note_press)
            .add_observer(select_clicked)
            .add_observer(select_neighbor);
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
    tool: Res<ActiveTool>,
    mut selected: ResMut<Selected>,
    objects: Query<Has<Cloth>, With<Selectable>>,
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
        if !tool.0.works_anywhere() {
            selected.0 = None;
        }
    } else if let Some(entity) = selectable(clicked, &tool, &objects, &parents) {
        selected.0 = Some(entity);
    }
}

/// The nearest of an entity and its ancestors that can be selected, if the tool lets it.
fn selectable(
    entity: Entity,
    tool: &ActiveTool,
    objects: &Query<Has<Cloth>, With<Selectable>>,
    parents: &Query<&ChildOf>,
) -> Option<Entity> {
    let mut line = std::iter::once(entity).chain(parents.iter_ancestors(entity));
    let (entity, is_cloth) = line.find_map(|entity| Some((entity, objects.get(entity).ok()?)))?;
    tool.0.selects(is_cloth).then_some(entity)
}

/// Points out what a click would select, while no button is down.
fn point_out(
    hovered: Res<HoverMap>,
    mouse: Mouse,
    tool: Res<ActiveTool>,
    mut pointed: ResMut<Hovered>,
    objects: Query<Has<Cloth>, With<Selectable>>,
    parents: Query<&ChildOf>,
) {
    let hits = hovered.get(&PointerId::Mouse).filter(|_| mouse.is_for_tool() && !mouse.drags());
    let nearest = hits.and_then(|hits| hits.iter().min_by(|a, b| a.1.depth.total_cmp(&b.1.depth)));
    let entity = nearest.and_then(|(entity, _)| selectable(*entity, &tool, &objects, &parents));
    pointed.set_if_neq(Hovered(entity));
}

/// Answers [`SelectNeighbor`].
fn select_neighbor(asked: On<SelectNeighbor>, mut selected: ResMut<Selected>, objects: Query<(Entity, &Selectable)>) {
    let mut all: Vec<_> = objects.iter().map(|(entity, turn)| (turn.0.wrapping_sub(1), entity)).collect();
    all.sort_unstable();
    let now = all.iter().position(|(_, entity)| Some(*entity) == selected.0);
    let next = match (*asked, now) {
        _ if all.is_empty() => return,
        (SelectNeighbor::Next, now) => now.map_or(0, |now| (now + 1) % all.len()),
        (SelectNeighbor::Previous, now) => (now.unwrap_or(0) + all.len() - 1) % all.len(),
    };
    selected.0 = Some(all[next].1);
}
