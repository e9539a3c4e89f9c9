//! Fire: whether the cloth may burn and as what, and how it does.

use bevy::prelude::*;
use bevy_cloth::{ClothFire, ClothPicking, ClothTool, Contagion, Flammability, Flammable};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

const KILOWATT: Unit = Unit::new("kW/m²", 1e-3, 0.1);
const GRAM: Unit = Unit::new("g/(m²·s)", 1e3, 0.1);

/// Shows how `cloth` burns, and what the middle button does.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let mut may = world.entity(cloth).contains::<Flammable>();
    if widgets::switch(ui, "may burn", "It can be lit, and fire spreads over it.", &mut may, None) {
        match may {
            true => drop(world.entity_mut(cloth).insert(Flammable::default())),
            false => drop(world.entity_mut(cloth).remove::<Flammable>()),
        }
    }
    if world.contains_resource::<ClothPicking>() {
        widgets::edit_resource(world, |picking: &mut ClothPicking| {
            let hint = "What the middle mouse button does to cloth that may burn.";
            let tools = [(Some(ClothTool::Match), "match"), (Some(ClothTool::Water), "water")];
            widgets::choice(ui, "middle button", hint, &mut picking.middle, ClothPicking::default().middle, tools);
        });
    }
    widgets::edit(world, cloth, |flammable: &mut Flammable| level(ui, flammable));
    if let Some(fire) = world.get::<ClothFire>(cloth) {
        let hottest = fire.temperature().iter().fold(0.0_f32, |hottest, kelvin| hottest.max(*kelvin));
        widgets::reading(ui, "in flames", "Particles that burn at present.", fire.flaming().to_string());
        let hint = "Temperature of the hottest particle.";
        widgets::reading(ui, "hottest", hint, format!("{:.0} °C", hottest - 273.15));
    }
}

fn level(ui: &mut egui::Ui, flammable: &mut Flammable) {
    let mut is_heat = matches!(flammable, Flammable::Heat(_));
    let hint = "Heat that spreads through fabric and flames, or a rule of chance.";
    if widgets::choice(ui, "model", hint, &mut is_heat, true, [(true, "heat"), (false, "chance")]) {
        *flammable = if is_heat { Flammable::default() } else { Flammable::Contagion(Contagion::default()) };
    }
    match flammable {
        Flammable::Heat(rule) => heat(ui, rule),
        Flammable::Contagion(rule) => {
            let default = Contagion::default();
            let hint = "Damage that a burning edge gathers; at 1 it breaks.";
            Value::new("burning", hint, Unit::PER_SECOND, 1e-3..=1000.0).show(ui, &mut rule.rate, default.rate);
            let hint = "How often a fully damaged edge lights a neighbour.";
            Value::new("spread", hint, Unit::PER_SECOND, 0.0..=1000.0).show(ui, &mut rule.spread, default.spread);
            let mut seed = rule.seed.min(u64::from(u32::MAX)) as u32;
            let row = Value::new("seed", "The same seed gives the same fire.", Unit::NONE, 0.0..=1e9);
            let before = seed;
            row.show_count(ui, &mut seed, default.seed as u32);
            if seed != before {
                rule.seed = u64::from(seed);
            }
        }
    }
}

fn heat(ui: &mut egui::Ui, rule: &mut Flammability) {
    let hint = "Which fibre it burns as.";
    let presets = Flammability::PRESETS.iter().map(|(name, preset)| (*preset, *name));
    widgets::choice(ui, "burns as", hint, rule, Flammability::default(), presets);
    let default = Flammability::default();
    let hint = "Temperature at which it bursts into flame beside a flame.";
    Value::new("ignites at", hint, Unit::KELVIN, 400.0..=1000.0).show(ui, &mut rule.ignition, default.ignition);
    let hint = "Heat flux of the flame at its foot, over both faces.";
    Value::new("flame", hint, KILOWATT, 1e3..=1e6).show(ui, &mut rule.heat_flux, default.heat_flux);
    let reach = 1e-4..=10.0;
    let hint = "How far ahead a flame heats, upward in still air.";
    Value::new("reach up", hint, Unit::MILLIMETRES, reach.clone()).show(ui, &mut rule.reach_up, default.reach_up);
    let hint = "How far ahead a flame heats, to its sides.";
    let across = Value::new("reach across", hint, Unit::MILLIMETRES, reach.clone());
    across.show(ui, &mut rule.reach_across, default.reach_across);
    let hint = "How far ahead a flame heats, downward.";
    Value::new("reach down", hint, Unit::MILLIMETRES, reach).show(ui, &mut rule.reach_down, default.reach_down);
    let hint = "Mass that a burning area loses.";
    Value::new("mass loss", hint, GRAM, 1e-4..=10.0).show(ui, &mut rule.mass_loss_rate, default.mass_loss_rate);
    let hint = "Part of the mass that stays as char.";
    Value::new("char", hint, Unit::PERCENT, 0.0..=0.95).show(ui, &mut rule.char, default.char);
    let hint = "Part of its length by which it shrinks until it lights.";
    Value::new("shrinkage", hint, Unit::PERCENT, 0.0..=0.9).show(ui, &mut rule.shrinkage, default.shrinkage);
    let hint = "How long the char glows once the flame is out.";
    Value::new("afterglow", hint, Unit::SECONDS, 0.0..=1000.0).show(ui, &mut rule.afterglow, default.afterglow);
}
