//! A slider for the speed of each mannequin.

use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};
use cloth_scene::SceneFigure;

use crate::scenes::Mannequin;

/// Width of the slider, logical pixels.
const WIDTH: f32 = 170.0;

/// Shows the sliders.
pub fn show(mut contexts: EguiContexts, mut mannequins: Query<(Entity, &mut Mannequin)>) -> Result {
    let context = contexts.ctx_mut()?;
    egui::Area::new("walk".into()).anchor(egui::Align2::LEFT_TOP, [12.0, 52.0]).show(context, |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            ui.spacing_mut().slider_width = WIDTH;
            for (_, mut mannequin) in mannequins.iter_mut().sort::<Entity>() {
                let mut speed = mannequin.figure.speed;
                let slider = egui::Slider::new(&mut speed, 0.0..=SceneFigure::MOST_SPEED);
                let slider = slider.suffix(" m/s").fixed_decimals(1).text("speed");
                let hint = "How fast the mannequin walks: 0 it stands, from 2 m/s on it runs.";
                if ui.add(slider).on_hover_text(hint).changed() {
                    mannequin.figure.speed = speed;
                }
            }
        });
    });
    Ok(())
}
