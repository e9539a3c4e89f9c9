//! Match and water in the hand of a pointer.

use bevy::picking::backend::HitData;
use bevy::picking::events::{Pointer, Press};
use bevy::picking::hover::HoverMap;
use bevy::picking::pointer::{PointerButton, PointerId, PointerPress};
use bevy::prelude::*;

use super::{ClothHit, ClothPicking, ClothTool};
use crate::damage::{Flammable, IgniteCloth, WetCloth};

/// How far a match reaches, m.
const MATCH: f32 = 0.02;

/// How far water spreads, m.
const SPLASH: f32 = 0.15;

/// How much water comes at once, kg/m², and then while the button is held, kg/(m² s).
const WATER: (f32, f32) = (0.5, 1.0);

/// The pointers that use their tool, each with the button that is down.
#[derive(Resource, Debug, Default)]
pub(crate) struct ToolsInUse(Vec<(PointerId, PointerButton)>);

/// Uses the tool on the cloth under a pointer when the button goes down.
pub(crate) fn take_up(
    press: On<Pointer<Press>>,
    settings: Res<ClothPicking>,
    cloths: Query<(), With<Flammable>>,
    mut tools: ResMut<ToolsInUse>,
    mut commands: Commands,
) {
    let entity = press.entity;
    // The event climbs up to the parents of what was hit.
    if entity != press.original_event_target() || !cloths.contains(entity) {
        return;
    }
    let Some(tool) = settings.tool(press.button) else { return };
    if apply(tool, WATER.0, entity, &press.hit, &mut commands) {
        tools.0.retain(|(pointer, _)| *pointer != press.pointer_id);
        tools.0.push((press.pointer_id, press.button));
    }
}

/// Goes on with it, on whatever cloth the pointer has come to, until the button is up.
pub(crate) fn go_on(
    settings: Res<ClothPicking>,
    pointers: Query<(&PointerId, &PointerPress)>,
    hovered: Res<HoverMap>,
    cloths: Query<(), With<Flammable>>,
    time: Res<Time>,
    mut tools: ResMut<ToolsInUse>,
    mut commands: Commands,
) {
    tools.0.retain(|(pointer, button)| {
        let press = pointers.iter().find(|(known, _)| *known == pointer).map(|(_, press)| press);
        let is_down = press.is_some_and(|press| match button {
            PointerButton::Primary => press.is_primary_pressed(),
            PointerButton::Secondary => press.is_secondary_pressed(),
            PointerButton::Middle => press.is_middle_pressed(),
        });
        is_down && matches!(settings.tool(*button), Some(ClothTool::Match | ClothTool::Water))
    });
    for (pointer, button) in &tools.0 {
        let (Some(tool), Some(hits)) = (settings.tool(*button), hovered.get(pointer)) else { continue };
        for (entity, hit) in hits.iter().filter(|(entity, _)| cloths.contains(**entity)) {
            apply(tool, WATER.1 * time.delta_secs(), *entity, hit, &mut commands);
        }
    }
}

/// Uses `tool` where a pointer meets a cloth; whether it does.
fn apply(tool: ClothTool, water: f32, entity: Entity, hit: &HitData, commands: &mut Commands) -> bool {
    let (Some(_), Some(position)) = (hit.extra_as::<ClothHit>(), hit.position) else { return false };
    match tool {
        ClothTool::Match => commands.trigger(IgniteCloth { entity, position, radius: MATCH }),
        ClothTool::Water => commands.trigger(WetCloth { entity, position, radius: SPLASH, water }),
        _ => return false,
    }
    true
}
