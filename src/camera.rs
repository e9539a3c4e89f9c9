//! The camera that orbits the scene, and the one that draws the panels on top.

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{ClearColorConfig, Hdr, RenderTarget, ShadowLodOrigin, Viewport};
use bevy::gizmos::transform_gizmo::TransformGizmoCamera;
use bevy::prelude::*;
use bevy_cloth_inspector::{CameraTarget, PanelWidth};
use bevy_egui::{EguiGlobalSettings, PrimaryEguiContext};
use bevy_panorbit_camera::{PanOrbitCamera, PanOrbitCameraPlugin};

use crate::look;

/// Draws after the scene (0) and the transform gizmo (1).
const PANELS_ORDER: isize = 2;

/// Where the cameras draw to: a window or a picture.
#[derive(Resource, Clone)]
pub struct Canvas(pub RenderTarget);

/// Where a scene is looked at from at first. Changing it moves the camera there.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Viewpoint {
    /// The camera's place, m.
    pub from: Vec3,
    /// The point in the middle of the picture, m.
    pub to: Vec3,
    /// Vertical field of view, degrees.
    pub field: f32,
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self { from: Vec3::new(1.5, 1.5, 4.0), to: Vec3::Y, field: 45.0 }
    }
}

/// Adds both cameras.
pub struct CameraPlugin;

impl Plugin for CameraPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(PanOrbitCameraPlugin)
            .init_resource::<Viewpoint>()
            .add_systems(Startup, spawn_cameras)
            .add_systems(
                Update,
                (leave_room_for_panel, look_from.run_if(resource_changed::<Viewpoint>), share_target).chain(),
            );
        app.world_mut().resource_mut::<EguiGlobalSettings>().auto_create_primary_context = false;
    }
}

fn spawn_cameras(mut commands: Commands, canvas: Res<Canvas>) {
    commands.spawn((
        Name::new("Camera"),
        Camera3d::default(),
        canvas.0.clone(),
        TransformGizmoCamera,
        // Said of itself of a window only; Bevy warns of lights without one.
        ShadowLodOrigin,
        PanOrbitCamera {
            button_orbit: MouseButton::Left,
            button_pan: MouseButton::Left,
            modifier_pan: Some(KeyCode::ShiftLeft),
            zoom_lower_limit: 0.8,
            zoom_sensitivity: 0.5,
            zoom_upper_limit: Some(30.0),
            pitch_lower_limit: Some(-0.2),
            use_real_time: true,
            ..default()
        },
        CameraTarget::default(),
        look::eyes(),
    ));
    commands.spawn((
        Name::new("Camera of the panels"),
        Camera2d,
        PrimaryEguiContext,
        canvas.0.clone(),
        RenderLayers::none(),
        // Cameras that draw on one picture must agree on its format.
        Hdr,
        Camera { order: PANELS_ORDER, clear_color: ClearColorConfig::None, ..default() },
    ));
}

/// Takes the camera to where the scene is to be looked at from.
fn look_from(mut cameras: Query<(&mut Transform, &mut PanOrbitCamera, &mut Projection)>, viewpoint: Res<Viewpoint>) {
    let Viewpoint { from, to, field } = *viewpoint;
    for (mut place, mut orbit, mut projection) in &mut cameras {
        *place = Transform::from_translation(from).looking_at(to, Vec3::Y);
        (orbit.focus, orbit.yaw, orbit.pitch, orbit.radius) = (to, None, None, None);
        orbit.initialized = false;
        if let Projection::Perspective(lens) = &mut *projection {
            lens.fov = field.to_radians();
        }
    }
}

/// The inspector shows what the camera looks at; where the user changes that or the camera's place, the camera orbits on from there.
fn share_target(mut cameras: Query<(&mut PanOrbitCamera, &mut CameraTarget)>) {
    for (mut orbit, mut target) in &mut cameras {
        if target.is_changed() && !target.is_added() {
            orbit.focus = target.0;
            (orbit.yaw, orbit.pitch, orbit.radius) = (None, None, None);
            orbit.initialized = false;
        } else if target.0 != orbit.focus {
            target.bypass_change_detection().0 = orbit.focus;
        }
    }
}

/// The scene is drawn beside the inspector, not behind it.
fn leave_room_for_panel(mut cameras: Query<&mut Camera, With<PanOrbitCamera>>, panel: Res<PanelWidth>) {
    for mut camera in &mut cameras {
        let Some(info) = &camera.computed.target_info else { continue };
        let whole = info.physical_size;
        let taken = (panel.0 * info.scale_factor).round() as u32;
        let left = UVec2::new(whole.x.saturating_sub(taken), whole.y);
        let viewport = (taken > 0 && left.x > 0 && left.y > 0).then(|| Viewport { physical_size: left, ..default() });
        if camera.viewport.as_ref().map(|viewport| viewport.physical_size)
            != viewport.as_ref().map(|viewport| viewport.physical_size)
        {
            camera.viewport = viewport;
        }
    }
}
