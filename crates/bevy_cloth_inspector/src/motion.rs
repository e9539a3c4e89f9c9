//! Sleep and jumps of a cloth: whether it is advanced at present, and what counts as no motion.

use bevy::prelude::*;
use bevy_cloth::{ClothAsleep, ClothSleep, Teleport, TeleportPolicy, WakeCloth};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value, edit_own_or_shared};

/// Shows whether `cloth` sleeps, and when it does.
pub fn sleep(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let asleep = world.entity(cloth).contains::<ClothAsleep>();
    let hint = "Cloth at rest is not advanced until something could move it.";
    let wake = widgets::row(ui, "state", hint, |ui| {
        ui.label(if asleep { "asleep" } else { "awake" });
        asleep && ui.button("wake").on_hover_text("It falls asleep again if nothing moves it.").clicked()
    });
    if wake {
        world.trigger(WakeCloth { entity: cloth });
    }
    edit_own_or_shared(world, Some(cloth), |sleep: &mut ClothSleep| {
        let default = ClothSleep::default();
        widgets::switch(ui, "may sleep", "It falls asleep when it is at rest.", &mut sleep.enabled, default.enabled);
        let hint = "It is at rest while every particle is slower than this.";
        Value::new("slower than", hint, Unit::METRES_PER_SECOND, 0.0..=10.0).show(ui, &mut sleep.speed, default.speed);
        let hint = "How long it has to be at rest.";
        Value::new("for", hint, Unit::SECONDS, 0.0..=1e3).show(ui, &mut sleep.time, default.time);
        let hint = "Air that is slower does not wake it.";
        Value::new("wind below", hint, Unit::METRES_PER_SECOND, 0.0..=100.0).show(ui, &mut sleep.wind, default.wind);
    });
}

/// Shows what is a jump of `cloth`, and what it does then.
pub fn teleport(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    edit_own_or_shared(world, Some(cloth), |teleport: &mut Teleport| {
        let default = Teleport::default();
        let hint = "What it hangs on jumps if it moves farther in one tick.";
        Value::new("distance", hint, Unit::METRES, 0.0..=1e6).show(ui, &mut teleport.distance, default.distance);
        let hint = "What it hangs on jumps if it turns further in one tick; above 180° no turn is a jump.";
        Value::new("angle", hint, Unit::DEGREES_OF_RADIANS, 0.0..=10.0).show(ui, &mut teleport.angle, default.angle);
        let policies = [
            (TeleportPolicy::CarryAlong, "carry it along"),
            (TeleportPolicy::Reset, "reset its shape"),
            (TeleportPolicy::Simulate, "drag it there"),
        ];
        let hint = "What the cloth does at a jump.";
        widgets::choice(ui, "policy", hint, &mut teleport.policy, default.policy, policies);
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
