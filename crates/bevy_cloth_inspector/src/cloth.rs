//! The shape of a cloth: size, resolution, rods; and why it was refused, if it was.

use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothRejection, ClothSource, PinSelect, Pins, Resolution};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

/// Shows the shape of `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    if let Some(rejection) = world.get::<ClothRejection>(entity) {
        widgets::refusal(ui, &rejection.error().to_string());
    }
    widgets::edit(world, entity, |cloth: &mut Cloth| source(ui, &mut cloth.source));
    widgets::edit(world, entity, |pins: &mut Pins| rods(ui, pins));
}

fn source(ui: &mut egui::Ui, source: &mut ClothSource) {
    match source {
        ClothSource::Rectangle { size, resolution } => {
            Value::new("width", "Width, along the weft.", Unit::METRES, 1e-4..=1e4).show(ui, &mut size.x, None);
            Value::new("height", "Height, along the warp.", Unit::METRES, 1e-4..=1e4).show(ui, &mut size.y, None);
            resolve(ui, resolution, *size);
        }
        ClothSource::Mesh => {
            widgets::reading(ui, "shape", "Where the rest shape comes from.", "its own mesh");
        }
    }
}

/// Distance of neighbours or number of cells, whichever the cloth is given by.
fn resolve(ui: &mut egui::Ui, resolution: &mut Resolution, size: Vec2) {
    let mut by_cells = matches!(resolution, Resolution::Cells(_));
    let choices = [(false, "a distance"), (true, "cells")];
    if widgets::choice(ui, "divided by", "How its resolution is given.", &mut by_cells, None, choices) {
        *resolution = match *resolution {
            Resolution::Spacing(spacing) if spacing > 0.0 => {
                Resolution::Cells((size / spacing).round().max(Vec2::ONE).as_uvec2())
            }
            Resolution::Cells(cells) if cells.x > 0 => Resolution::Spacing(size.x / cells.x as f32),
            same => same,
        };
    }
    match resolution {
        Resolution::Spacing(spacing) => {
            let hint = "Distance between neighbouring particles; half of it takes four times the particles.";
            Value::new("distance", hint, Unit::MILLIMETRES, 1e-6..=1e4).show(ui, spacing, Cloth::DEFAULT_SPACING);
        }
        Resolution::Cells(cells) => {
            let across = Value::new("cells across", "Cells over the width.", Unit::NONE, 1.0..=4000.0);
            across.show_count(ui, &mut cells.x, None);
            let down = Value::new("cells down", "Cells over the height.", Unit::NONE, 1.0..=4000.0);
            down.show_count(ui, &mut cells.y, None);
        }
    }
}

fn rods(ui: &mut egui::Ui, pins: &mut Pins) {
    let groups = pins.0.len();
    let rods = pins.0.iter_mut().find_map(|group| match &mut group.select {
        PinSelect::Rods(rods) => Some(rods),
        _ => None,
    });
    let hint = "Pins spread evenly along the top edge.";
    match rods {
        Some(rods) => _ = Value::new("rods", hint, Unit::NONE, 0.0..=1e5).show_count(ui, rods, None),
        None => widgets::reading(ui, "pins", "What holds the cloth.", format!("{groups} groups")),
    }
}
