//! Saving the scene that is open to a file, and a notice that says so.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};

use crate::scenes::Present;

/// For how long the notice is shown, s.
const SHOWN: f32 = 6.0;

/// Writes the scene as it is now beside the program's working folder as `scene-1.ron`, counting up.
#[derive(Event, Clone, Copy, Debug)]
pub struct SaveScene;

/// What became of it, and until when that is shown, s.
#[derive(Resource, Clone, Debug)]
struct Notice {
    text: String,
    until: f32,
}

/// Saves scenes.
pub struct SavePlugin;

impl Plugin for SavePlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(save).add_systems(EguiPrimaryContextPass, show.run_if(resource_exists::<Notice>));
    }
}

fn save(_: On<SaveScene>, present: Present, time: Res<Time<Real>>, mut commands: Commands) {
    let free = (1..).map(|number| PathBuf::from(format!("scene-{number}.ron"))).find(|file| !file.exists());
    let file = free.unwrap_or_default();
    let text = match std::fs::write(&file, present.scene().to_ron()) {
        Ok(()) => format!("The scene is saved: open it again with --scene {}", file.display()),
        Err(error) => format!("The scene could not be saved as {}: {error}", file.display()),
    };
    info!("{text}");
    commands.insert_resource(Notice { text, until: time.elapsed_secs() + SHOWN });
}

fn show(mut contexts: EguiContexts, notice: Res<Notice>, time: Res<Time<Real>>, mut commands: Commands) -> Result {
    if time.elapsed_secs() > notice.until {
        commands.remove_resource::<Notice>();
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    egui::Area::new("saved".into()).anchor(egui::Align2::LEFT_BOTTOM, [12.0, -132.0]).show(context, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| ui.label(&notice.text));
    });
    Ok(())
}
