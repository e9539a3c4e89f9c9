//! The ball: a press throws one through the cursor.

use bevy::picking::pointer::PointerButton;
use bevy::prelude::*;
use bevy_cloth::ClothPicking;

use super::{ActiveTool, Tool};
use crate::throw::ThrowBall;

pub fn plugin(app: &mut App) {
    app.add_observer(throw);
}

fn throw(press: On<Pointer<Press>>, tool: Res<ActiveTool>, picking: Res<ClothPicking>, mut commands: Commands) {
    let is_first = press.entity == press.original_event_target();
    if is_first && tool.0 == Tool::Ball && press.button == PointerButton::Primary && picking.enabled {
        commands.trigger(ThrowBall);
    }
}
