//! Fire: whether the cloth may burn and as what, and how it does.

use bevy::prelude::*;
use bevy_cloth::{ClothFire, ClothPicking, ClothTool, Contagion, Flammability, Flammable};
use bevy_egui::egui;

use crate::widgets::{self, Unit};

const KILOWATT: Unit = Unit::new("kW/m²", 1e-3, 0.1);
const KELVIN: Unit = Unit::new("K", 1.0, 0.5);
const GRAM: Unit = Unit::new("g/(m²·s)", 1e3, 0.1);
const SECONDS: Unit = Unit::new("s", 1.0, 0.05);
const PER_SECOND: Unit = Unit::new("1/s", 1.0, 0.01);

/// Shows how `cloth` burns, and what the middle button does.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    widgets::rows(ui, "fire", |ui| {
        let mut may = world.entity(cloth).contains::<Flammable>();
        if widgets::row(ui, "fire", "", |ui| ui.checkbox(&mut may, "may burn")).changed() {
            match may {
                true => drop(world.entity_mut(cloth).insert(Flammable::default())),
                false => drop(world.entity_mut(cloth).remove::<Flammable>()),
            }
        }
        if world.contains_resource::<ClothPicking>() {
            widgets::edit_resource(world, |picking: &mut ClothPicking| {
                widgets::row(ui, "middle button", "What it does to cloth that may burn.", |ui| {
                    ui.horizontal(|ui| {
                        ui.selectable_value(&mut picking.middle, Some(ClothTool::Match), "match");
                        ui.selectable_value(&mut picking.middle, Some(ClothTool::Water), "water");
                    });
                });
            });
        }
        widgets::edit(world, cloth, |flammable: &mut Flammable| level(ui, flammable));
        if let Some(fire) = world.get::<ClothFire>(cloth) {
            let hottest = fire.temperature().iter().fold(0.0_f32, |hottest, kelvin| hottest.max(*kelvin));
            widgets::row(ui, "in flames", "Particles.", |ui| ui.label(fire.flaming().to_string()));
            widgets::row(ui, "hottest", "", |ui| ui.label(format!("{:.0} °C", hottest - 273.15)));
        }
    });
}

fn level(ui: &mut egui::Ui, flammable: &mut Flammable) {
    let is_heat = matches!(flammable, Flammable::Heat(_));
    widgets::row(ui, "model", "Heat that spreads, or a rule of chance.", |ui| {
        ui.horizontal(|ui| {
            if ui.selectable_label(is_heat, "heat").clicked() && !is_heat {
                *flammable = Flammable::default();
            }
            if ui.selectable_label(!is_heat, "chance").clicked() && is_heat {
                *flammable = Flammable::Contagion(Contagion::default());
            }
        });
    });
    match flammable {
        Flammable::Heat(rule) => heat(ui, rule),
        Flammable::Contagion(rule) => {
            widgets::number_row(ui, "burning", "Rate at which damage grows.", &mut rule.rate, PER_SECOND);
            widgets::number_row(ui, "spread", "Rate at which it leaps to neighbours.", &mut rule.spread, PER_SECOND);
            widgets::row(ui, "seed", "The same seed, the same fire.", |ui| {
                ui.add(egui::DragValue::new(&mut rule.seed).speed(0.1));
            });
        }
    }
}

fn heat(ui: &mut egui::Ui, rule: &mut Flammability) {
    widgets::row(ui, "burns as", "", |ui| {
        let name = Flammability::PRESETS.iter().find(|(_, preset)| preset == rule).map_or("own", |(name, _)| name);
        egui::ComboBox::from_id_salt("flammability").selected_text(name).width(150.0).show_ui(ui, |ui| {
            for (name, preset) in Flammability::PRESETS {
                ui.selectable_value(rule, *preset, *name);
            }
        });
    });
    widgets::number_row(ui, "ignites at", "Beside a flame.", &mut rule.ignition, KELVIN);
    widgets::number_row(ui, "flame", "Heat flux at its foot, over both faces.", &mut rule.heat_flux, KILOWATT);
    widgets::number_row(ui, "reach up", "Preheat length along the flame.", &mut rule.reach_up, Unit::MILLIMETRES);
    widgets::number_row(ui, "across", "", &mut rule.reach_across, Unit::MILLIMETRES);
    widgets::number_row(ui, "down", "", &mut rule.reach_down, Unit::MILLIMETRES);
    widgets::number_row(ui, "mass loss", "Of a burning area.", &mut rule.mass_loss_rate, GRAM);
    widgets::number_row(ui, "char", "Part of the mass that stays.", &mut rule.char, Unit::PERCENT);
    widgets::number_row(ui, "shrinkage", "Until it lights.", &mut rule.shrinkage, Unit::PERCENT);
    widgets::number_row(ui, "afterglow", "", &mut rule.afterglow, SECONDS);
}
