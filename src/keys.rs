//! The keys, in one table that the help window shows.

use bevy::gizmos::transform_gizmo::{TransformGizmoMode, TransformGizmoSettings};
use bevy::input::InputSystems;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothClock, ClothColoring, ClothPicking, ClothTime, Fan, FireTool, ResetCloth, Shared};
use bevy_cloth_inspector::{InspectorOpen, Selected};
use bevy_egui::input::EguiWantsInput;
use bevy_egui::{EguiInput, EguiPreUpdateSet, egui};

use crate::help::HelpOpen;
use crate::select::Selectable;
use crate::throw::ThrowBall;

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    Help,
    Pause,
    Step,
    Reset,
    Coloring,
    FireTool,
    Fans,
    Throw,
    Inspector,
    Move,
    Turn,
    Delete,
    Deselect,
}

/// Every key: code, name and meaning.
const BINDINGS: [(KeyCode, &str, &str, Action); 13] = [
    (KeyCode::KeyH, "H", "show or hide this help", Action::Help),
    (KeyCode::Space, "Space", "pause or go on", Action::Pause),
    (KeyCode::KeyN, "N", "one step, then pause", Action::Step),
    (KeyCode::KeyR, "R", "reset all cloth, and make it whole", Action::Reset),
    (KeyCode::KeyC, "C", "colour by material, stress, strain, temperature, speed, contact", Action::Coloring),
    (KeyCode::KeyX, "X", "match or water for the middle button", Action::FireTool),
    (KeyCode::KeyF, "F", "switch the fans on or off", Action::Fans),
    (KeyCode::KeyT, "T", "throw a ball through the cursor; the ninth replaces the first", Action::Throw),
    (KeyCode::Tab, "Tab", "show or hide the inspector", Action::Inspector),
    (KeyCode::KeyW, "W", "handles move the selected object", Action::Move),
    (KeyCode::KeyE, "E", "handles turn the selected object: take a ring at its wide end", Action::Turn),
    (KeyCode::Delete, "Del", "delete the selected object", Action::Delete),
    (KeyCode::Escape, "Esc", "close the help, or deselect", Action::Deselect),
];

/// The keys of the numbers, in order from 1.
const DIGITS: [KeyCode; 9] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
];

/// Key and meaning, for the help.
pub fn descriptions() -> impl Iterator<Item = (&'static str, &'static str)> {
    BINDINGS.iter().map(|(_, key, meaning, _)| (*key, *meaning))
}

/// Listens to the keys.
pub struct KeysPlugin;

impl Plugin for KeysPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PreUpdate, keep_tab.after(EguiPreUpdateSet::ProcessInput).before(EguiPreUpdateSet::BeginPass))
            .add_systems(PreUpdate, (act, select_by_number).run_if(nothing_is_typed).after(InputSystems));
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
    mut help: ResMut<HelpOpen>,
    mut inspector: ResMut<InspectorOpen>,
    mut selected: ResMut<Selected>,
    clothes: Query<Entity, With<Cloth>>,
    mut fans: Query<&mut Fan>,
) {
    for (_, _, _, action) in BINDINGS.iter().filter(|(key, ..)| keys.just_pressed(*key)) {
        match action {
            Action::Help => help.0 = !help.0,
            Action::Pause if clock.is_paused() => clock.unpause(),
            Action::Pause => clock.pause(),
            Action::Step => {
                clock.pause();
                clock.step_once();
            }
            Action::Reset => clothes.iter().for_each(|entity| commands.trigger(ResetCloth { entity })),
            Action::Coloring => {
                let now = ClothColoring::ALL.iter().position(|known| *known == coloring.0).unwrap_or(0);
                coloring.0 = ClothColoring::ALL[(now + 1) % ClothColoring::ALL.len()];
            }
            Action::FireTool => {
                picking.tool = match picking.tool {
                    FireTool::Match => FireTool::Water,
                    FireTool::Water => FireTool::Match,
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
            Action::Delete => {
                if let Some(entity) = selected.0.take() {
                    commands.entity(entity).despawn();
                }
            }
            Action::Deselect if help.0 => help.0 = false,
            Action::Deselect => selected.0 = None,
        }
    }
}

fn select_by_number(
    keys: Res<ButtonInput<KeyCode>>,
    mut selected: ResMut<Selected>,
    selectables: Query<(Entity, &Selectable)>,
) {
    for (number, _) in (1..).zip(DIGITS).filter(|(_, key)| keys.just_pressed(*key)) {
        if let Some((entity, _)) = selectables.iter().find(|(_, selectable)| selectable.0 == number) {
            selected.0 = Some(entity);
        }
    }
}
