//! Sleep and jumps of a cloth: whether it is advanced at present, and what counts as no motion.

use bevy::prelude::*;
use bevy_cloth::{ClothAsleep, ClothSleep, Teleport, TeleportPolicy, WakeCloth};
use bevy_egui::egui;

use crate::widgets::{self, Unit};
use crate::world::edit_own_or_shared;

const SECONDS: Unit = Unit::new("s", 1.0, 0.05);
const METRE_PER_SECOND: Unit = Unit::new("m/s", 1.0, 0.002);
const RADIANS: Unit = Unit::new("rad", 1.0, 0.01);

/// Shows whether `cloth` sleeps, and when it does.
pub fn sleep(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    widgets::rows(ui, "sleep", |ui| {
        let asleep = world.entity(cloth).contains::<ClothAsleep>();
        let hint = "Cloth at rest is not advanced until something could move it.";
        let wake = widgets::row(ui, "state", hint, |ui| {
            ui.horizontal(|ui| {
                ui.label(if asleep { "asleep" } else { "awake" });
                asleep && ui.button("wake").on_hover_text("It falls asleep again if nothing moves it.").clicked()
            })
            .inner
        });
        if wake {
            world.trigger(WakeCloth { entity: cloth });
        }
        edit_own_or_shared(world, Some(cloth), |sleep: &mut ClothSleep| {
            widgets::row(ui, "may sleep", hint, |ui| ui.checkbox(&mut sleep.enabled, ""));
            let hint = "Every particle is slower; 0..=10 m/s.";
            widgets::number_row(ui, "slower than", hint, &mut sleep.speed, METRE_PER_SECOND);
            widgets::number_row(ui, "for", "For so long; 0..=1,000 s.", &mut sleep.time, SECONDS);
            let hint = "Slower air does not wake it; 0..=100 m/s.";
            widgets::number_row(ui, "wind below", hint, &mut sleep.wind, METRE_PER_SECOND);
            reset(ui, sleep);
        });
    });
}

/// Shows what is a jump of `cloth`, and what it does then.
pub fn teleport(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    widgets::rows(ui, "teleport", |ui| {
        edit_own_or_shared(world, Some(cloth), |teleport: &mut Teleport| {
            let hint = "What it hangs on jumps if it goes farther in one tick; 0..=1,000,000 m.";
            widgets::number_row(ui, "distance", hint, &mut teleport.distance, Unit::METRES);
            let hint = "Or turns further; 0..=10 rad. Above π no turn is a jump.";
            widgets::number_row(ui, "angle", hint, &mut teleport.angle, RADIANS);
            widgets::row(ui, "policy", "What the cloth does then.", |ui| policy(ui, &mut teleport.policy));
            reset(ui, teleport);
        });
    });
}

fn policy(ui: &mut egui::Ui, policy: &mut TeleportPolicy) {
    let choices = [
        (TeleportPolicy::CarryAlong, "carry along", "It goes along in one piece."),
        (TeleportPolicy::Reset, "reset", "It is there in its rest shape."),
        (TeleportPolicy::Simulate, "simulate", "There are no jumps: it is dragged there."),
    ];
    let shown = choices.iter().find(|(choice, ..)| choice == policy).map_or("", |(_, name, _)| name);
    egui::ComboBox::from_id_salt("teleport policy").selected_text(shown).width(150.0).show_ui(ui, |ui| {
        for (choice, name, hint) in choices {
            ui.selectable_value(policy, choice, name).on_hover_text(hint);
        }
    });
}

/// A button that brings back the default.
fn reset<C: Default + PartialEq>(ui: &mut egui::Ui, value: &mut C) {
    let default = C::default();
    widgets::row(ui, "", "", |ui| {
        let button = ui.add_enabled(*value != default, egui::Button::new("⟲ default"));
        if button.on_hover_text("All values of this section.").clicked() {
            *value = default;
        }
    });
}

#[cfg(test)]
mod tests {
    use bevy_cloth::{Cloth, Shared};

    use super::*;

    /// Draws both sections once.
    fn draw(world: &mut World, cloth: Entity) {
        let context = egui::Context::default();
        let _ = context.run_ui(egui::RawInput::default(), |ui| {
            sleep(ui, world, cloth);
            teleport(ui, world, cloth);
        });
    }

    #[test]
    fn the_sections_show_the_shared_values_or_those_of_the_cloth_and_looking_changes_nothing() {
        for own in [false, true] {
            let mut world = World::new();
            world.insert_resource(Shared(ClothSleep::NEVER));
            world.insert_resource(Shared(Teleport { distance: 3.0, ..default() }));
            let cloth = world.spawn(Cloth::default()).id();
            if own {
                world.entity_mut(cloth).insert((ClothSleep::default(), Teleport::default()));
            }
            world.clear_trackers();
            draw(&mut world, cloth);
            assert!(!world.resource_ref::<Shared<ClothSleep>>().is_changed());
            assert!(!world.resource_ref::<Shared<Teleport>>().is_changed());
            let changed =
                |world: &World| world.entity(cloth).get_ref::<Teleport>().is_some_and(|value| value.is_changed());
            assert!(!changed(&world));
        }
    }
}
