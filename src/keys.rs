//! The keys, in one table that the help window shows.

use bevy::gizmos::transform_gizmo::{TransformGizmoMode, TransformGizmoSettings};
use bevy::input::InputSystems;
use bevy::prelude::*;
use bevy_cloth::{ClothClock, ClothColoring, ClothPicking, ClothTime, ClothTool, Fan, Shared};
use bevy_cloth_inspector::{InspectorOpen, Selected};
use bevy_egui::input::EguiWantsInput;
use bevy_egui::{EguiInput, EguiPreUpdateSet, egui};

use crate::help::HelpOpen;
use crate::menu::MenuOpen;
use crate::record::TakePicture;
use crate::save::SaveScene;
use crate::scenes::{MENU, OpenScene};
use crate::select::SelectNeighbor;
use crate::throw::ThrowBall;
use crate::tools::{ActiveTool, DeleteSelected, DuplicateSelected, ReopenScene, ResetScene, Tool};

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    Help,
    Menu,
    Picture,
    Save,
    Pause,
    Step,
    Reset,
    Reopen,
    Coloring,
    FireTool,
    Fans,
    Throw,
    Inspector,
    Move,
    Turn,
    Scale,
    Next,
    Previous,
    Duplicate,
    Delete,
    Deselect,
}

/// Which other key a key wants to be held down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum With {
    /// None, and no Ctrl.
    Plain,
    /// Shift.
    Shift,
    /// Ctrl.
    Ctrl,
}

/// Every key: code, what is held down with it, name and meaning. Of those with the same code the first that fits holds.
const BINDINGS: [(KeyCode, With, &str, &str, Action); 21] = [
    (KeyCode::KeyH, With::Plain, "H", "show or hide this help", Action::Help),
    (KeyCode::KeyM, With::Plain, "M", "show or hide the scenes; 1 to 9 and 0 open one", Action::Menu),
    (KeyCode::F12, With::Plain, "F12", "take a picture of the window", Action::Picture),
    (KeyCode::F11, With::Plain, "F11", "save the scene as it is now, as a file that `--scene` opens", Action::Save),
    (KeyCode::Space, With::Plain, "Space", "pause or go on", Action::Pause),
    (KeyCode::KeyN, With::Plain, "N", "one step, then pause", Action::Step),
    (
        KeyCode::KeyR,
        With::Shift,
        "Shift+R",
        "open the scene anew: also settings, camera, time, colours",
        Action::Reopen,
    ),
    (KeyCode::KeyR, With::Plain, "R", "reset the scene: cloth whole, all objects back, balls gone", Action::Reset),
    (
        KeyCode::KeyC,
        With::Plain,
        "C",
        "colour by material, stress, strain, temperature, speed, contact",
        Action::Coloring,
    ),
    (KeyCode::KeyX, With::Plain, "X", "match or water for the middle button", Action::FireTool),
    (KeyCode::KeyF, With::Plain, "F", "switch the fans on or off", Action::Fans),
    (KeyCode::KeyT, With::Plain, "T", "throw a ball through the cursor; the ninth replaces the first", Action::Throw),
    (KeyCode::Tab, With::Plain, "Tab", "show or hide the inspector", Action::Inspector),
    (KeyCode::BracketRight, With::Plain, "]", "select the next object", Action::Next),
    (KeyCode::BracketLeft, With::Plain, "[", "select the previous object", Action::Previous),
    (KeyCode::KeyW, With::Plain, "W", "handles move the selected object", Action::Move),
    (KeyCode::KeyE, With::Plain, "E", "handles turn the selected object: take a ring at its wide end", Action::Turn),
    (KeyCode::KeyS, With::Plain, "S", "handles scale the selected object", Action::Scale),
    (KeyCode::KeyD, With::Ctrl, "Ctrl+D", "duplicate the selected object", Action::Duplicate),
    (KeyCode::Delete, With::Plain, "Del", "delete the selected object", Action::Delete),
    (KeyCode::Escape, With::Plain, "Esc", "close the scenes or the help, or deselect", Action::Deselect),
];

/// Key and meaning, for the help.
pub fn descriptions() -> impl Iterator<Item = (&'static str, &'static str)> {
    BINDINGS.iter().map(|(_, _, key, meaning, _)| (*key, *meaning))
}

/// Key and meaning of the tools, for the help.
pub fn tools() -> impl Iterator<Item = (String, String)> {
    Tool::ALL.iter().map(|tool| tool.face()).map(|face| (face.key_name.into(), format!("{}: {}", face.name, face.hint)))
}

/// Listens to the keys.
pub struct KeysPlugin;

impl Plugin for KeysPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, keep_tab.after(EguiPreUpdateSet::ProcessInput).before(EguiPreUpdateSet::BeginPass))
            .add_systems(PreUpdate, (act, take_tool, open_by_number).run_if(nothing_is_typed).after(InputSystems));
    }
}

fn nothing_is_typed(panels: Res<EguiWantsInput>) -> bool {
    !panels.wants_keyboard_input()
}

/// Tab is the inspector's key here: egui would give the keyboard to its first widget.
fn keep_tab(mut inputs: Query<&mut EguiInput>, panels: Res<EguiWantsInput>) {
    if !panels.wants_keyboard_input() {
        for mut input in &mut inputs {
            input.events.retain(|event| !matches!(event, egui::Event::Key { key: egui::Key::Tab, .. }));
        }
    }
}

fn act(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    mut clock: ResMut<Time<ClothClock>>,
    (mut coloring, mut picking): (ResMut<Shared<ClothColoring>>, ResMut<ClothPicking>),
    mut gizmo: ResMut<TransformGizmoSettings>,
    (mut help, mut menu): (ResMut<HelpOpen>, ResMut<MenuOpen>),
    mut inspector: ResMut<InspectorOpen>,
    mut selected: ResMut<Selected>,
    mut fans: Query<&mut Fan>,
) {
    for action in pressed(&keys) {
        match action {
            Action::Help => help.0 = !help.0,
            Action::Menu => menu.0 = !menu.0,
            Action::Picture => commands.trigger(TakePicture),
            Action::Save => commands.trigger(SaveScene),
            Action::Pause if clock.is_paused() => clock.unpause(),
            Action::Pause => clock.pause(),
            Action::Step => {
                clock.pause();
                clock.step_once();
            }
            Action::Reset => commands.trigger(ResetScene),
            Action::Reopen => commands.trigger(ReopenScene),
            Action::Coloring => {
                let now = ClothColoring::ALL.iter().position(|known| *known == coloring.0).unwrap_or(0);
                coloring.0 = ClothColoring::ALL[(now + 1) % ClothColoring::ALL.len()];
            }
            Action::FireTool => {
                picking.middle = match picking.middle {
                    Some(ClothTool::Match) => Some(ClothTool::Water),
                    _ => Some(ClothTool::Match),
                }
            }
            Action::Fans => {
                let on = !fans.iter().any(|fan| fan.on);
                fans.iter_mut().for_each(|mut fan| fan.on = on);
            }
            Action::Throw => commands.trigger(ThrowBall),
            Action::Inspector => inspector.0 = !inspector.0,
            Action::Move => gizmo.mode = TransformGizmoMode::Translate,
            Action::Turn => gizmo.mode = TransformGizmoMode::Rotate,
            Action::Scale => gizmo.mode = TransformGizmoMode::Scale,
            Action::Next => commands.trigger(SelectNeighbor::Next),
            Action::Previous => commands.trigger(SelectNeighbor::Previous),
            Action::Duplicate => commands.trigger(DuplicateSelected),
            Action::Delete => commands.trigger(DeleteSelected),
            Action::Deselect if menu.0 => menu.0 = false,
            Action::Deselect if help.0 => help.0 = false,
            Action::Deselect => selected.0 = None,
        }
    }
}

/// What the keys that have just gone down do.
fn pressed(keys: &ButtonInput<KeyCode>) -> Vec<Action> {
    let shift = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let ctrl = keys.any_pressed([KeyCode::ControlLeft, KeyCode::ControlRight]);
    let fits = |with: With| match with {
        With::Plain => !ctrl,
        With::Shift => shift && !ctrl,
        With::Ctrl => ctrl,
    };
    let action = |code: &KeyCode| BINDINGS.iter().find(|(key, with, ..)| key == code && fits(*with));
    keys.get_just_pressed().filter_map(action).map(|(.., action)| *action).collect()
}

fn take_tool(keys: Res<ButtonInput<KeyCode>>, active: Option<ResMut<ActiveTool>>) {
    let tool = Tool::ALL.into_iter().find(|tool| keys.just_pressed(tool.face().key));
    if let (Some(tool), Some(mut active)) = (tool, active) {
        active.set_if_neq(ActiveTool(tool));
    }
}

/// The keys of the numbers, in order from 1; 0 is the tenth.
const DIGITS: [KeyCode; 10] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
    KeyCode::Digit0,
];

fn open_by_number(keys: Res<ButtonInput<KeyCode>>, mut commands: Commands) {
    for (entry, _) in MENU.iter().zip(DIGITS).filter(|(_, key)| keys.just_pressed(*key)) {
        commands.trigger(OpenScene(entry.scene()));
    }
}
