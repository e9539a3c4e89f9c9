//! The ball that is thrown from the camera through the cursor.

mod flight;
#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;

use bevy::camera::Camera3d;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_cloth::{ClothClock, ClothCollider, ClothForce, ClothSchedule, ClothSystems, ClothTime};
use bevy_egui::input::EguiWantsInput;

use crate::scenes::{OfScene, paint};
use crate::select::Selectable;
use crate::shapes::mesh_of;
use crate::tools::MadeInPlay;

pub use flight::Ball;

/// Radius of a ball, m: that of a football.
const RADIUS: f32 = 0.11;
/// The most balls there are: the next one replaces the oldest.
pub const MOST: usize = 8;
/// How far in front of the camera a ball appears, m.
const REACH: f32 = 0.5;
/// Colour of a ball.
const COLOR: Color = Color::srgb(0.85, 0.33, 0.10);

/// Throws a ball from the camera through the cursor. If the cursor is outside of the scene, through the scene's middle.
#[derive(Event, Clone, Copy, Debug)]
pub struct ThrowBall;

/// How fast a ball is thrown, m/s, in [`ThrowSpeed::RANGE`]. Default 12.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct ThrowSpeed(pub f32);

impl ThrowSpeed {
    /// The speeds that can be chosen, m/s. A collider faster than 0.75 m in a tick would count as teleported.
    pub const RANGE: RangeInclusive<f32> = 1.0..=40.0;
}

impl Default for ThrowSpeed {
    fn default() -> Self {
        Self(12.0)
    }
}

/// The visible body of a ball, a child of it: drawn between the last two ticks, as cloth is.
#[derive(Component)]
struct Body;

/// Throws balls.
pub struct ThrowPlugin;

impl Plugin for ThrowPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ThrowSpeed>().add_observer(throw);
    }
}

/// Lets balls fly, thrown ones and those of a scene.
pub struct FlightPlugin;

impl Plugin for FlightPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(ClothSchedule, flight::fly.before(ClothSystems::Prepare))
            .add_systems(Update, give_bodies_meshes)
            .add_systems(PostUpdate, place_bodies.after(ClothSystems::Draw));
    }
}

fn throw(
    _: On<ThrowBall>,
    speed: Res<ThrowSpeed>,
    panels: Res<EguiWantsInput>,
    windows: Query<&Window, With<PrimaryWindow>>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    balls: Query<(Entity, &Ball)>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    (mut material, mut count): (Local<Option<Handle<StandardMaterial>>>, Local<u32>),
    mut commands: Commands,
) {
    let active = cameras.iter().filter(|(camera, _)| camera.is_active);
    let Some((camera, eye)) = active.min_by_key(|(camera, _)| camera.order) else { return };
    let Some(view) = camera.logical_viewport_rect() else { return };
    let cursor = windows.single().ok().and_then(Window::cursor_position);
    let aim = cursor.filter(|at| view.contains(*at) && !panels.wants_any_pointer_input()).unwrap_or(view.center());
    let Ok(ray) = camera.viewport_to_world(eye, aim) else { return };
    let mut known: Vec<_> =
        balls.iter().filter(|(_, ball)| ball.number > 0).map(|(entity, ball)| (ball.number, entity)).collect();
    known.sort_unstable();
    let surplus = (known.len() + 1).saturating_sub(MOST);
    known.iter().take(surplus).for_each(|(_, oldest)| commands.entity(*oldest).despawn());
    *count += 1;
    let material = material.get_or_insert_with(|| materials.add(paint(COLOR))).clone();
    let at = ray.origin + ray.direction * REACH;
    let ball = ball(Ball::new(*count, at, ray.direction * speed.0), at, RADIUS, MeshMaterial3d(material));
    commands.spawn((Name::new(format!("ball {}", *count)), MadeInPlay, ball));
}

/// A ball that flies: what scene and tool spawn. One of a scene has the number 0: no thrown one replaces it.
pub fn ball(ball: Ball, at: Vec3, radius: f32, material: MeshMaterial3d<StandardMaterial>) -> impl Bundle {
    (
        OfScene,
        Selectable(0),
        ball,
        ClothCollider::Sphere { radius },
        ClothForce::default(),
        Transform::from_translation(at),
        Visibility::default(),
        children![(Body, material)],
    )
}

/// Gives the body of every new or changed ball the mesh of its shape.
fn give_bodies_meshes(
    balls: Query<(&ClothCollider, &Children), (With<Ball>, Changed<ClothCollider>)>,
    bodies: Query<(), With<Body>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (collider, children) in &balls {
        if let Some(mesh) = mesh_of(collider) {
            let mesh = meshes.add(mesh);
            for body in children.iter().filter(|child| bodies.contains(*child)) {
                commands.entity(body).insert(Mesh3d(mesh.clone()));
            }
        }
    }
}

/// Draws every ball where it is between the last two ticks.
fn place_bodies(
    balls: Query<(&Ball, &Transform)>,
    mut bodies: Query<(&ChildOf, &mut GlobalTransform), With<Body>>,
    time: Res<Time<ClothClock>>,
) {
    for (parent, mut shown) in &mut bodies {
        if let Ok((ball, now)) = balls.get(parent.parent()) {
            let translation = ball.shown_at(now.translation, time.interpolation());
            *shown = GlobalTransform::from(Transform { translation, ..*now });
        }
    }
}
