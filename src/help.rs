//! The help window: what mouse and keys do.

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};

use crate::keys;

/// Whether the help is open.
#[derive(Resource, Default)]
pub struct HelpOpen(pub bool);

/// Height of the help's title and of what is kept free above and below, points.
const FRAME: f32 = 150.0;

/// What the mouse does.
const MOUSE: [(&str, &str); 10] = [
    ("left button", "the tool chosen in the row below; with the hand:"),
    ("left drag on cloth", "grab and pull; what may tear, rips; R makes it whole"),
    ("left drag on a ring", "slide it along its rod"),
    ("left click", "select an object; on nothing: deselect"),
    ("right drag on cloth", "cut, with any tool"),
    ("middle button on cloth", "hold a match to it; with X pour water instead"),
    ("left drag on a handle", "move, turn or scale the selected object"),
    ("left drag on nothing", "orbit; anywhere with Alt"),
    ("Shift + left drag", "pan"),
    ("wheel", "zoom; while blowing: strength"),
];

/// Shows the help.
pub struct HelpPlugin;

impl Plugin for HelpPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<HelpOpen>().add_systems(EguiPrimaryContextPass, (show_help, show_hint));
    }
}

fn show_help(mut contexts: EguiContexts, mut open: ResMut<HelpOpen>) -> Result {
    let context = contexts.ctx_mut()?;
    let height = context.content_rect().height() - FRAME;
    let mut is_open = open.0;
    egui::Window::new("Help").open(&mut is_open).resizable(false).default_pos([24.0, 24.0]).show(context, |ui| {
        egui::ScrollArea::vertical().max_height(height).show(ui, |ui| {
            table(ui, "Mouse", MOUSE.iter().map(|(key, meaning)| ((*key).into(), (*meaning).into())));
            table(ui, "Tools", keys::tools());
            table(ui, "Keys", keys::descriptions().map(|(key, meaning)| (key.into(), meaning.into())));
        });
    });
    if open.0 != is_open {
        open.0 = is_open;
    }
    Ok(())
}

fn table(ui: &mut egui::Ui, title: &str, rows: impl Iterator<Item = (String, String)>) {
    ui.strong(title);
    egui::Grid::new(title).num_columns(2).striped(true).show(ui, |ui| {
        for (key, meaning) in rows {
            ui.monospace(key);
            ui.label(meaning);
            ui.end_row();
        }
    });
    ui.add_space(6.0);
}

/// A line in the corner that tells where help is.
fn show_hint(mut contexts: EguiContexts, open: Res<HelpOpen>) -> Result {
    if !open.0 {
        let context = contexts.ctx_mut()?;
        egui::Area::new("hint".into())
            .anchor(egui::Align2::LEFT_BOTTOM, [12.0, -10.0])
            .interactable(false)
            .show(context, |ui| ui.label(egui::RichText::new("H: help").color(egui::Color32::from_gray(50))));
    }
    Ok(())
}
