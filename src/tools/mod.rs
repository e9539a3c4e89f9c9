//! The tools: what the left button does to cloth and scene, and what is done to whole objects.
//!
//! | file | what |
//! |---|---|
//! | `palette` | the row of buttons, the hint line, the cursor |
//! | `ball`, `blow`, `pins` | the tools of the same name; hand, scissors, match and water are [`ClothTool`]s of the plugin |
//! | `rings` | the hand slides a ring along its rod |
//! | `handles` | the gizmo's handles move, turn and scale the selected object |
//! | `edit` | duplicate and delete |
//! | `reset` | the scene as it was opened |

mod ball;
mod blow;
mod edit;
mod handles;
mod palette;
mod pins;
mod reset;
mod rings;
#[cfg(test)]
mod tests;

use bevy::prelude::*;
use bevy_cloth::{ClothPicking, ClothTool};
use bevy_egui::egui::CursorIcon;

pub use edit::{DeleteSelected, DuplicateSelected};
pub use handles::Dragged;
pub use reset::{MadeInPlay, ReopenScene, ResetScene};

/// What the left button does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Grabs and rips cloth, slides rings, selects objects.
    #[default]
    Hand,
    /// Cuts cloth.
    Scissors,
    /// Lights cloth.
    Match,
    /// Puts out cloth and wets it.
    Water,
    /// Pins cloth and takes pins out.
    Pin,
    /// Throws a ball.
    Ball,
    /// Blows at cloth.
    Blow,
}

/// The tool that was chosen.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActiveTool(pub Tool);

/// How a tool is shown, and the key that takes it.
pub struct Face {
    /// One character.
    pub icon: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its key.
    pub key: KeyCode,
    /// The name of the key.
    pub key_name: &'static str,
    /// What to do with it.
    pub hint: &'static str,
    /// How the cursor looks over the scene.
    pub cursor: CursorIcon,
}

impl Tool {
    /// All, in the order of the palette.
    pub const ALL: [Self; 7] =
        [Self::Hand, Self::Scissors, Self::Match, Self::Water, Self::Pin, Self::Ball, Self::Blow];

    /// How it is shown.
    pub const fn face(self) -> Face {
        let (icon, name, key, key_name, hint, cursor) = match self {
            Self::Hand => {
                let hint = "drag cloth to pull or rip it, a ring along its rod; click an object to select it";
                ("✋", "Hand", KeyCode::F1, "F1", hint, CursorIcon::Grab)
            }
            Self::Scissors => {
                let hint = "drag to cut; the right button cuts with any tool";
                ("✂", "Scissors", KeyCode::F2, "F2", hint, CursorIcon::Crosshair)
            }
            Self::Match => {
                let hint = "hold on cloth to light it; the middle button does so with any tool";
                ("🔥", "Match", KeyCode::F3, "F3", hint, CursorIcon::Cell)
            }
            Self::Water => {
                let hint = "hold on cloth to put it out and wet it; X gives water to the middle button";
                ("💧", "Water", KeyCode::F4, "F4", hint, CursorIcon::Cell)
            }
            Self::Pin => {
                let hint = "click cloth to pin it where it is, click a pin to take it out";
                ("📌", "Pin", KeyCode::F5, "F5", hint, CursorIcon::PointingHand)
            }
            Self::Ball => {
                ("⚽", "Ball", KeyCode::F6, "F6", "click to throw; T throws with any tool", CursorIcon::Crosshair)
            }
            Self::Blow => {
                let hint = "hold to blow through the cursor; the wheel changes the strength";
                ("💨", "Blow", KeyCode::F7, "F7", hint, CursorIcon::Crosshair)
            }
        };
        Face { icon, name, key, key_name, hint, cursor }
    }

    /// What the plugin does with the left button.
    fn to_cloth(self) -> Option<ClothTool> {
        match self {
            Self::Hand => Some(ClothTool::Grab),
            Self::Scissors => Some(ClothTool::Cut),
            Self::Match => Some(ClothTool::Match),
            Self::Water => Some(ClothTool::Water),
            Self::Pin => Some(ClothTool::Pin),
            Self::Ball | Self::Blow => None,
        }
    }

    /// Whether it works wherever the button goes down, also over nothing. Then a drag over nothing is not the camera's.
    pub fn works_anywhere(self) -> bool {
        matches!(self, Self::Scissors | Self::Ball | Self::Blow)
    }

    /// Whether a click selects what is clicked: always with the hand; with the others only what they do nothing to.
    pub fn selects(self, is_cloth: bool) -> bool {
        match self {
            Self::Hand => true,
            Self::Scissors | Self::Match | Self::Water | Self::Pin => !is_cloth,
            Self::Ball | Self::Blow => false,
        }
    }
}

/// Adds the tools and what is done to whole objects.
pub struct ToolsPlugin;

impl Plugin for ToolsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ActiveTool>()
            .add_systems(PreUpdate, take_up.run_if(resource_changed::<ActiveTool>))
            .add_plugins((palette::plugin, ball::plugin, blow::plugin, pins::plugin, rings::plugin))
            .add_plugins((handles::plugin, edit::plugin, reset::plugin));
    }
}

/// Gives the left button the chosen tool.
fn take_up(tool: Res<ActiveTool>, mut picking: ResMut<ClothPicking>) {
    picking.primary = tool.0.to_cloth();
}
