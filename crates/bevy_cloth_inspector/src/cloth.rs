//! The shape of a cloth: size, resolution, rods; and why it was refused, if it was.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothRejection, ClothSource, PinSelect, Pins, Resolution};
use bevy_egui::egui;

use crate::widgets::{self, Unit};

/// Shows the shape of `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    if let Some(rejection) = world.get::<ClothRejection>(entity) {
        widgets::refusal(ui, &rejection.error().to_string());
    }
    widgets::rows(ui, "cloth", |ui| {
        widgets::edit(world, entity, |cloth: &mut Cloth| source(ui, &mut cloth.source));
        widgets::edit(world, entity, |pins: &mut Pins| rods(ui, pins));
    });
}

fn source(ui: &mut egui::Ui, source: &mut ClothSource) {
    match source {
        ClothSource::Rectangle { size, resolution } => {
            widgets::number_row(ui, "width", "Along the weft.", &mut size.x, Unit::METRES);
            widgets::number_row(ui, "height", "Along the warp.", &mut size.y, Unit::METRES);
            widgets::row(ui, "resolution", "How finely the cloth is divided.", |ui| {
                ui.horizontal(|ui| resolve(ui, resolution, *size));
            });
        }
        ClothSource::Mesh => {
            widgets::row(ui, "shape", "", |ui| ui.label("its own mesh"));
        }
    }
}

/// Distance of neighbours or number of cells, whichever the cloth is told by.
fn resolve(ui: &mut egui::Ui, resolution: &mut Resolution, size: Vec2) {
    match resolution {
        Resolution::Spacing(spacing) => {
            widgets::number(ui, spacing, Unit::MILLIMETRES);
            if ui.button("cells").on_hover_text("Tell the number of cells instead.").clicked() && *spacing > 0.0 {
                *resolution = Resolution::Cells((size / *spacing).round().max(Vec2::ONE).as_uvec2());
            }
        }
        Resolution::Cells(cells) => {
            ui.add(egui::DragValue::new(&mut cells.x).speed(0.2));
            ui.label("×");
            ui.add(egui::DragValue::new(&mut cells.y).speed(0.2));
            if ui.button("mm").on_hover_text("Tell the distance of neighbours instead.").clicked() && cells.x > 0 {
                *resolution = Resolution::Spacing(size.x / cells.x as f32);
            }
        }
    }
}

fn rods(ui: &mut egui::Ui, pins: &mut Pins) {
    let groups = pins.0.len();
    let rods = pins.0.iter_mut().find_map(|group| match &mut group.select {
        PinSelect::Rods(rods) => Some(rods),
        _ => None,
    });
    widgets::row(ui, "rods", "Pins spread evenly along the top edge.", |ui| match rods {
        Some(rods) => {
            ui.add(egui::DragValue::new(rods).speed(0.05));
        }
        None => {
            ui.label(format!("none; {groups} other groups of pins"));
        }
    });
}
