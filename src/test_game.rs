//! The game without renderer and panels, for tests: the real input, picking, transforms, gizmo and cloth.

use std::time::Duration;

use bevy::camera::visibility::calculate_bounds;
use bevy::camera::{CameraProjection, RenderTargetInfo};
use bevy::gizmos::transform_gizmo::TransformGizmoPlugin;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::{MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::input::touch::TouchPhase;
use bevy::input::{ButtonState, InputPlugin};
use bevy::picking::DefaultPickingPlugins;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{CursorMoved, PrimaryWindow, WindowEvent, WindowResolution};
use bevy_cloth::*;
use bevy_cloth_inspector::{Hovered, InspectorOpen, PanelWidth, Selected};
use bevy_egui::input::EguiWantsInput;

use crate::fans::FansPlugin;
use crate::help::HelpOpen;
use crate::keys::KeysPlugin;
use crate::menu::MenuOpen;
use crate::mouse::MousePlugin;
use crate::scenes::curtain_rod::CurtainRodPlugin;
use crate::select::SelectPlugin;
use crate::shapes::ShapesPlugin;
use crate::throw::{FlightPlugin, ThrowPlugin};
use crate::tools::ToolsPlugin;

/// Size of the window, pixels.
pub const PIXELS: UVec2 = UVec2::new(800, 600);
/// The middle of the window.
pub const MIDDLE: Vec2 = Vec2::new(400.0, 300.0);
/// Length of a tick: Bevy's default fixed timestep, 64 Hz.
const TICK: Duration = Duration::from_micros(15625);
/// Ticks in a second.
pub const TICKS_PER_SECOND: usize = 64;

/// A game whose camera looks from (0, 1.5, 4) along −z, without ground.
pub struct Game {
    pub app: App,
    pub window: Entity,
    cursor: Vec2,
}

impl Game {
    /// With a frame every tick.
    pub fn new() -> Self {
        Self::with_frames(1)
    }

    /// With a frame every so many ticks.
    pub fn with_frames(ticks: u32) -> Self {
        let window = Window { resolution: WindowResolution::new(PIXELS.x, PIXELS.y), ..default() };
        let window = WindowPlugin { primary_window: Some(window), ..default() };
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, InputPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin))
            .add_plugins((window, DefaultPickingPlugins, MeshPickingPlugin, TransformGizmoPlugin))
            .init_asset::<StandardMaterial>()
            .init_resource::<EguiWantsInput>()
            .init_resource::<HelpOpen>()
            .init_resource::<MenuOpen>()
            .init_resource::<InspectorOpen>()
            .init_resource::<PanelWidth>()
            .init_resource::<Selected>()
            .init_resource::<Hovered>()
            .insert_resource(TimeUpdateStrategy::ManualDuration(TICK * ticks))
            .add_plugins((
                ClothPlugin::default(),
                ShapesPlugin,
                FansPlugin,
                CurtainRodPlugin,
                MousePlugin,
                SelectPlugin,
                KeysPlugin,
            ))
            .add_plugins((ThrowPlugin, FlightPlugin, ToolsPlugin));
        // Mesh picking needs what the renderer adds to a mesh.
        app.add_systems(PostUpdate, calculate_bounds).register_required_components::<Mesh3d, Visibility>();
        // Without a renderer nothing is ever visible in a view.
        app.world_mut().resource_mut::<MeshPickingSettings>().ray_cast_visibility = RayCastVisibility::Any;
        let mut camera = Camera::default();
        camera.computed.target_info = Some(RenderTargetInfo { physical_size: PIXELS, scale_factor: 1.0 });
        let lens = PerspectiveProjection { aspect_ratio: PIXELS.x as f32 / PIXELS.y as f32, ..default() };
        camera.computed.clip_from_view = lens.get_clip_from_view();
        app.world_mut().spawn((Camera3d::default(), camera, Transform::from_xyz(0.0, 1.5, 4.0)));
        let mut windows = app.world_mut().query_filtered::<Entity, With<PrimaryWindow>>();
        let window = windows.single(app.world()).unwrap();
        app.update();
        let mut game = Self { app, window, cursor: MIDDLE };
        game.point_at(MIDDLE);
        game
    }

    /// Moves the mouse to a pixel.
    pub fn point_at(&mut self, cursor: Vec2) {
        let delta = Some(cursor - std::mem::replace(&mut self.cursor, cursor));
        let mut window = self.app.world_mut().get_mut::<Window>(self.window).unwrap();
        window.set_physical_cursor_position(Some(cursor.as_dvec2()));
        let moved = CursorMoved { window: self.window, position: cursor, delta };
        self.app.world_mut().write_message(WindowEvent::CursorMoved(moved.clone()));
        self.app.world_mut().write_message(moved);
    }

    /// Moves the mouse there in many small steps, one each frame.
    pub fn drag_to(&mut self, to: Vec2) {
        let from = self.cursor;
        for step in 1..=20 {
            self.point_at(from.lerp(to, step as f32 / 20.0));
            self.app.update();
        }
    }

    /// Presses a button of the mouse, or releases it.
    pub fn button(&mut self, button: MouseButton, state: ButtonState) {
        let input = MouseButtonInput { button, state, window: self.window };
        self.app.world_mut().write_message(WindowEvent::MouseButtonInput(input));
        self.app.world_mut().write_message(input);
        self.app.update();
    }

    /// Presses the left button.
    pub fn press_left(&mut self) {
        // The pointer is where the mouse is before it is pressed there.
        self.app.update();
        self.button(MouseButton::Left, ButtonState::Pressed);
    }

    /// Releases the left button.
    pub fn release_left(&mut self) {
        self.button(MouseButton::Left, ButtonState::Released);
    }

    /// Turns the wheel of the mouse by so many notches.
    pub fn turn_wheel(&mut self, notches: f32) {
        let (unit, phase) = (MouseScrollUnit::Line, TouchPhase::Moved);
        let wheel = MouseWheel { unit, x: 0.0, y: notches, window: self.window, phase };
        self.app.world_mut().write_message(wheel);
        self.app.update();
    }

    /// Clicks at a pixel.
    pub fn click(&mut self, at: Vec2) {
        self.point_at(at);
        self.press_left();
        self.release_left();
    }

    /// Presses a key and releases it.
    pub fn press(&mut self, key: KeyCode) {
        self.press_with(key, None);
    }

    /// Presses a key and releases it while another is held down.
    pub fn press_with(&mut self, key: KeyCode, held: Option<KeyCode>) {
        if let Some(held) = held {
            self.key(held, ButtonState::Pressed);
        }
        self.key(key, ButtonState::Pressed);
        self.key(key, ButtonState::Released);
        if let Some(held) = held {
            self.key(held, ButtonState::Released);
        }
    }

    fn key(&mut self, key_code: KeyCode, state: ButtonState) {
        let window = self.window;
        let key = KeyboardInput { key_code, logical_key: Key::F35, state, text: None, repeat: false, window };
        self.app.world_mut().write_message(key);
        self.app.update();
    }

    /// Lets that many seconds pass.
    pub fn run(&mut self, seconds: f32) {
        (0..(seconds * TICKS_PER_SECOND as f32) as usize).for_each(|_| self.app.update());
    }

    /// Stops the clock of the cloth.
    pub fn pause(&mut self) {
        self.app.world_mut().resource_mut::<Time<ClothClock>>().pause();
    }

    /// Where an entity stands, m.
    pub fn place(&self, entity: Entity) -> Vec3 {
        self.app.world().get::<Transform>(entity).unwrap().translation
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    /// A component of an entity that must have it.
    pub fn get<T: Component>(&self, entity: Entity) -> &T {
        self.app.world().get::<T>(entity).unwrap_or_else(|| panic!("{entity} has no {}", std::any::type_name::<T>()))
    }

    /// The pixel at which a point of the world is seen.
    pub fn pixel_of(&mut self, point: Vec3) -> Vec2 {
        let mut cameras = self.app.world_mut().query::<(&Camera, &GlobalTransform)>();
        let (camera, eye) = cameras.single(self.app.world()).unwrap();
        camera.world_to_viewport(eye, point).unwrap()
    }
}
