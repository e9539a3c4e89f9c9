//! Contact of a cloth with itself: whether it keeps off itself and how, and what it finds.

use bevy::prelude::*;
use bevy_cloth::{ClothStats, Fabric, SelfContact};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

/// Shows how `cloth` keeps off itself.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let fabric = world.get::<Fabric>(cloth).copied().unwrap_or_default();
    let mut on = world.entity(cloth).contains::<SelfContact>();
    let hint = "Without it the cloth passes through itself, and nothing is computed.";
    if widgets::switch(ui, "self-contact", hint, &mut on, None) {
        match on {
            true => drop(world.entity_mut(cloth).insert(SelfContact::default())),
            false => drop(world.entity_mut(cloth).remove::<SelfContact>()),
        }
    }
    widgets::edit(world, cloth, |settings: &mut SelfContact| values(ui, settings, &fabric));
    if let Some(stats) = world.get::<ClothStats>(cloth).filter(|_| on) {
        found(ui, stats);
    }
}

fn values(ui: &mut egui::Ui, settings: &mut SelfContact, fabric: &Fabric) {
    let default = SelfContact::default();
    let hint = "Distance kept between two layers; the fabric's thickness unless it has its own.";
    let row = Value::new("distance", hint, Unit::MILLIMETRES, 1e-6..=0.1);
    own(ui, row, &mut settings.distance, fabric.thickness);
    let hint = "Coulomb friction of the cloth on itself; the fabric's unless it has its own.";
    own(ui, Value::new("friction", hint, Unit::NONE, 0.0..=10.0), &mut settings.friction, fabric.friction);
    let hint = "Rate at which layers that are too near part.";
    Value::new("rate", hint, Unit::PER_SECOND, 0.0..=1000.0).show(ui, &mut settings.rate, default.rate);
    let hint = "Most pairs that are followed, for each particle.";
    Value::new("budget", hint, Unit::NONE, 1.0..=1000.0).show_count(ui, &mut settings.budget, default.budget);
}

/// A number of its own, or that of the fabric, to which its reset button goes back.
fn own(ui: &mut egui::Ui, row: Value, value: &mut Option<f32>, of_fabric: f32) {
    let mut shown = value.unwrap_or(of_fabric);
    row.show(ui, &mut shown, of_fabric);
    if shown == of_fabric {
        *value = None;
    } else if Some(shown) != *value {
        *value = Some(shown);
    }
}

fn found(ui: &mut egui::Ui, stats: &ClothStats) {
    let hint = "Places at which it presses on itself.";
    widgets::reading(ui, "touching", hint, stats.self_contacts.to_string());
    let hint = "Edges that pass through a triangle; they are being drawn out.";
    widgets::reading(ui, "tangled", hint, stats.tangled.to_string());
    let bounded = if stats.self_contact_bounded { "too small" } else { "enough" };
    widgets::reading(ui, "budget is", "With too small a one the cloth may pass through itself.", bounded);
}

#[cfg(test)]
mod tests {
    use bevy_cloth::Cloth;

    use super::*;

    #[test]
    fn the_section_shows_a_cloth_with_and_without_it_and_looking_changes_nothing() {
        let wrong = SelfContact { distance: Some(5.0), budget: 0, ..default() };
        for settings in [None, Some(SelfContact::default()), Some(wrong)] {
            let mut world = World::new();
            let cloth = world.spawn((Cloth::default(), ClothStats::default())).id();
            if let Some(settings) = settings {
                world.entity_mut(cloth).insert(settings);
            }
            world.clear_trackers();
            let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| show(ui, &mut world, cloth));
            let now = world.entity(cloth).get_ref::<SelfContact>();
            assert_eq!(now.is_some(), settings.is_some());
            assert!(now.is_none_or(|now| !now.is_changed()));
        }
    }
}
