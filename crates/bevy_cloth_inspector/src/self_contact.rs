//! Contact of a cloth with itself: whether it keeps off itself and how, and what it finds.

use bevy::prelude::*;
use bevy_cloth::{ClothStats, Fabric, SelfContact};
use bevy_egui::egui;

use crate::widgets::{self, Unit};

const PER_SECOND: Unit = Unit::new("1/s", 1.0, 0.1);

/// Shows how `cloth` keeps off itself.
pub fn show(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let fabric = world.get::<Fabric>(cloth).copied().unwrap_or_default();
    widgets::rows(ui, "self-contact", |ui| {
        let mut on = world.entity(cloth).contains::<SelfContact>();
        let hint = "Without it the cloth passes through itself, and nothing is computed.";
        if widgets::row(ui, "self-contact", hint, |ui| ui.checkbox(&mut on, "keeps off itself")).changed() {
            match on {
                true => drop(world.entity_mut(cloth).insert(SelfContact::default())),
                false => drop(world.entity_mut(cloth).remove::<SelfContact>()),
            }
        }
        widgets::edit(world, cloth, |settings: &mut SelfContact| values(ui, settings, &fabric));
        if let Some(stats) = world.get::<ClothStats>(cloth).filter(|_| on) {
            found(ui, stats);
        }
    });
}

fn values(ui: &mut egui::Ui, settings: &mut SelfContact, fabric: &Fabric) {
    let hint = "Kept between two layers; 0.001..=100 mm. Unless it is its own, the thickness of the fabric.";
    own(ui, "distance", hint, &mut settings.distance, fabric.thickness, Unit::MILLIMETRES);
    let hint = "Coulomb friction coefficient of the cloth on itself; 0..=10. Unless it is its own, that of the fabric.";
    own(ui, "friction", hint, &mut settings.friction, fabric.friction, Unit::NONE);
    let hint = "Rate at which what layers lack of the distance fades; 0..=1,000 1/s.";
    widgets::number_row(ui, "rate", hint, &mut settings.rate, PER_SECOND);
    let hint = "Most pairs that are followed, for each particle; 1..=1,000.";
    widgets::row(ui, "budget", hint, |ui| ui.add(egui::DragValue::new(&mut settings.budget).speed(0.2)));
    let default = SelfContact::default();
    widgets::row(ui, "", "", |ui| {
        let button = ui.add_enabled(*settings != default, egui::Button::new("⟲ default"));
        if button.on_hover_text("All values of this section.").clicked() {
            *settings = default;
        }
    });
}

/// A number of its own, or that of the fabric.
fn own(ui: &mut egui::Ui, label: &str, hint: &str, value: &mut Option<f32>, of_fabric: f32, unit: Unit) {
    widgets::row(ui, label, hint, |ui| {
        ui.horizontal(|ui| {
            let mut is_own = value.is_some();
            if ui.checkbox(&mut is_own, "").on_hover_text("A value of its own.").changed() {
                *value = is_own.then_some(of_fabric);
            }
            match value {
                Some(value) => widgets::number(ui, value, unit),
                None => _ = ui.weak("of the fabric"),
            }
        })
    });
}

fn found(ui: &mut egui::Ui, stats: &ClothStats) {
    let mut line = |label, hint, value: String| widgets::row(ui, label, hint, |ui| ui.monospace(value));
    line("touching", "Places at which it presses on itself.", stats.self_contacts.to_string());
    line("tangled", "Edges that pass through a triangle; they are being drawn out.", stats.tangled.to_string());
    let bounded = if stats.self_contact_bounded { "too small" } else { "enough" };
    line("budget is", "With too small a one the cloth may pass through itself.", bounded.into());
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
