//! What a cloth is made of: preset, and every value with its unit.

use bevy::prelude::*;
use bevy_cloth::Fabric;
use bevy_egui::egui;

use crate::widgets::{self, Unit};

const NEWTON_PER_METRE: Unit = Unit::new("N/m", 1.0, 0.5);
const MICRONEWTON_METRE: Unit = Unit::new("µN·m", 1e6, 0.05);
const GRAM_PER_SQUARE_METRE: Unit = Unit::new("g/m²", 1e3, 0.5);
const PER_SECOND: Unit = Unit::new("1/s", 1.0, 0.01);

/// Shows the fabric of `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    widgets::edit(world, entity, |fabric: &mut Fabric| {
        widgets::rows(ui, "fabric", |ui| {
            widgets::row(ui, "preset", "A measured or estimated fabric to start from.", |ui| preset(ui, fabric));
            values(ui, fabric);
        });
    });
}

fn preset(ui: &mut egui::Ui, fabric: &mut Fabric) {
    let name = Fabric::PRESETS.iter().find(|(_, preset)| preset == fabric).map_or("own", |(name, _)| name);
    egui::ComboBox::from_id_salt("preset").selected_text(name).width(150.0).show_ui(ui, |ui| {
        for (name, preset) in Fabric::PRESETS {
            ui.selectable_value(fabric, *preset, *name);
        }
    });
}

fn values(ui: &mut egui::Ui, fabric: &mut Fabric) {
    let mut value = |label, hint, value: &mut f32, unit| widgets::number_row(ui, label, hint, value, unit);
    value("mass", "Mass per area.", &mut fabric.areal_density, GRAM_PER_SQUARE_METRE);
    value("thickness", "", &mut fabric.thickness, Unit::MILLIMETRES);
    value("stretch, warp", "Membrane stiffness along the warp.", &mut fabric.stretch_warp, NEWTON_PER_METRE);
    value("stretch, weft", "Membrane stiffness along the weft.", &mut fabric.stretch_weft, NEWTON_PER_METRE);
    value("shear", "In-plane shear stiffness.", &mut fabric.shear, NEWTON_PER_METRE);
    value("bending, warp", "Stiffness against curvature along the warp.", &mut fabric.bend_warp, MICRONEWTON_METRE);
    value("bending, weft", "Stiffness against curvature along the weft.", &mut fabric.bend_weft, MICRONEWTON_METRE);
    value("damping", "Rate at which inner motion fades.", &mut fabric.damping, PER_SECOND);
    value("friction", "Coulomb friction coefficient.", &mut fabric.friction, Unit::NONE);
    value("strength", "Tension at which it tears, where it may.", &mut fabric.strength, NEWTON_PER_METRE);
    value("stretch limit", "Largest strain the fabric takes in use.", &mut fabric.stretch_limit, Unit::PERCENT);
}
