//! Blowing: while the button is held, a fan blows from the camera through the cursor.

use std::ops::RangeInclusive;

use bevy::input::mouse::{AccumulatedMouseScroll, MouseScrollUnit};
use bevy::picking::PickingSystems;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::{PointerButton, PointerId, PointerPress};
use bevy::prelude::*;
use bevy_cloth::{Air, Cloth, ClothPicking, Fan};

use super::{ActiveTool, Tool};
use crate::fans::Bodiless;

/// Diameter of the fan, m.
const DIAMETER: f32 = 0.4;
/// How far in front of the camera it is, m.
const REACH: f32 = 0.3;
/// What a notch of the wheel multiplies the speed by.
const NOTCH: f32 = 1.15;
/// How many pixels of a touch pad are a notch.
const PIXELS: f32 = 40.0;

/// Speed of the air at the camera, m/s, in [`BlowSpeed::RANGE`]. Default 12. It slows down on its way: 4 m from the camera
/// it is 0.6 of that.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct BlowSpeed(pub f32);

impl BlowSpeed {
    /// The speeds that can be chosen, m/s.
    pub const RANGE: RangeInclusive<f32> = 1.0..=40.0;
}

impl Default for BlowSpeed {
    fn default() -> Self {
        Self(12.0)
    }
}

/// The fan of a pointer that blows.
#[derive(Component, Clone, Copy, Debug)]
pub struct HandFan {
    pointer: PointerId,
    camera: Entity,
}

/// A cloth that has [`Air`] only while something blows: its scene has none.
#[derive(Component)]
struct Aired;

pub fn plugin(app: &mut App) {
    app.init_resource::<BlowSpeed>().add_observer(begin).add_systems(
        PreUpdate,
        (set_strength, follow).chain().in_set(PickingSystems::PostHover).run_if(any_with_component::<HandFan>),
    );
}

fn begin(
    press: On<Pointer<Press>>,
    tool: Res<ActiveTool>,
    picking: Res<ClothPicking>,
    rays: Option<Res<RayMap>>,
    still: Query<Entity, (With<Cloth>, Without<Air>)>,
    speed: Res<BlowSpeed>,
    mut commands: Commands,
) {
    let is_first = press.entity == press.original_event_target();
    if !is_first || tool.0 != Tool::Blow || press.button != PointerButton::Primary || !picking.enabled {
        return;
    }
    // A press on nothing names no camera.
    let pointer = press.pointer_id;
    let ray = rays.as_ref().and_then(|rays| rays.iter().find(|(id, _)| id.pointer == pointer));
    let Some((RayId { camera, .. }, ray)) = ray else { return };
    let fan = Fan { on: true, diameter: DIAMETER, speed: speed.0, ..default() };
    commands.spawn((Name::new("breath"), HandFan { pointer, camera: *camera }, Bodiless, fan, place(ray)));
    for cloth in &still {
        commands.entity(cloth).insert((Air::default(), Aired));
    }
}

fn place(ray: &Ray3d) -> Transform {
    Transform::from_translation(ray.get_point(REACH)).looking_to(ray.direction, Vec3::Y)
}

fn set_strength(scroll: Option<Res<AccumulatedMouseScroll>>, mut speed: ResMut<BlowSpeed>) {
    let Some(scroll) = scroll.filter(|scroll| scroll.delta.y != 0.0) else { return };
    let notches = match scroll.unit {
        MouseScrollUnit::Line => scroll.delta.y,
        MouseScrollUnit::Pixel => scroll.delta.y / PIXELS,
    };
    let (least, most) = BlowSpeed::RANGE.into_inner();
    speed.0 = (speed.0 * NOTCH.powf(notches)).clamp(least, most);
}

/// Aims every such fan until its button is up, the tool is put away, or the pointer belongs to something else.
fn follow(
    mut fans: Query<(Entity, &HandFan, &mut Fan, &mut Transform)>,
    pointers: Query<(&PointerId, &PointerPress)>,
    tool: Res<ActiveTool>,
    rays: Res<RayMap>,
    speed: Res<BlowSpeed>,
    aired: Query<Entity, With<Aired>>,
    mut commands: Commands,
) {
    for (entity, hand, mut fan, mut at) in &mut fans {
        let is_down = pointers.iter().any(|(known, press)| *known == hand.pointer && press.is_primary_pressed());
        if !is_down || tool.0 != Tool::Blow {
            commands.entity(entity).despawn();
            for cloth in &aired {
                commands.entity(cloth).remove::<(Air, Aired)>();
            }
            continue;
        }
        // A pointer outside the camera's view has no ray: the fan stays.
        if let Some(ray) = rays.map.get(&RayId::new(hand.camera, hand.pointer)) {
            at.set_if_neq(place(ray));
        }
        if fan.speed != speed.0 {
            fan.speed = speed.0;
        }
    }
}
