//! Match and water in the hand of a pointer.

use bevy::picking::events::{Pointer, Press};
use bevy::prelude::*;

use super::{ClothHit, ClothPicking, FireTool};
use crate::damage::{Flammable, IgniteCloth, WetCloth};

/// How far a match reaches, m.
const MATCH: f32 = 0.02;

/// How far water spreads, m, and how much it is, kg/m².
const WATER: (f32, f32) = (0.15, 0.5);

/// Uses the tool on the cloth under a pointer when the button goes down.
pub(crate) fn use_tool(
    press: On<Pointer<Press>>,
    settings: Res<ClothPicking>,
    cloths: Query<(), With<Flammable>>,
    mut commands: Commands,
) {
    let entity = press.entity;
    // The event climbs up to the parents of what was hit.
    let hit = press.hit.extra_as::<ClothHit>().filter(|_| entity == press.original_event_target());
    let (Some(_), Some(position)) = (hit, press.hit.position) else { return };
    if !settings.enabled || settings.tool_button != Some(press.button) || !cloths.contains(entity) {
        return;
    }
    match settings.tool {
        FireTool::Match => commands.trigger(IgniteCloth { entity, position, radius: MATCH }),
        FireTool::Water => {
            let (radius, water) = WATER;
            commands.trigger(WetCloth { entity, position, radius, water });
        }
    }
}
