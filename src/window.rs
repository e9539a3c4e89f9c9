//! The demo in a window, with mouse, keys and transform gizmo.

use bevy::camera::RenderTarget;
use bevy::gizmos::transform_gizmo::TransformGizmoPlugin;
use bevy::prelude::*;
use bevy::window::WindowResolution;

use crate::camera::Canvas;
use crate::tools::ToolsPlugin;
use crate::{
    help::HelpPlugin, keys::KeysPlugin, menu::MenuPlugin, mouse::MousePlugin, save::SavePlugin, select::SelectPlugin,
    throw::ThrowPlugin,
};

/// Opens a window of `size` pixels and lets the user take part.
pub struct WindowedPlugin {
    /// Width and height in pixels.
    pub size: UVec2,
}

impl Plugin for WindowedPlugin {
    fn build(&self, app: &mut App) {
        let window = Window {
            title: "bevy_cloth".to_string(),
            resolution: WindowResolution::new(self.size.x, self.size.y),
            ..default()
        };
        app.add_plugins(DefaultPlugins.set(WindowPlugin { primary_window: Some(window), ..default() }))
            .insert_resource(Canvas(RenderTarget::default()))
            .add_plugins((MeshPickingPlugin, TransformGizmoPlugin, MousePlugin, SelectPlugin))
            .add_plugins((KeysPlugin, HelpPlugin, MenuPlugin, SavePlugin, ThrowPlugin, ToolsPlugin));
    }
}
