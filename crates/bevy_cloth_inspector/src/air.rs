//! The air: whether the cloth feels it, wind and gusts, the selected wind zone, the selected fan.

use bevy::prelude::*;
use bevy_cloth::{Air, Fan, Gusts, Oscillation, Wind, WindZone, ZoneShape};
use bevy_egui::egui;

use crate::Selected;
use crate::widgets::{self, Unit};
use crate::world::edit_own_or_shared;

const METRE_PER_SECOND: Unit = Unit::new("m/s", 1.0, 0.02);
/// Degrees, for values in radians.
const DEGREES: Unit = Unit::new("°", 180.0 / std::f64::consts::PI, 0.2);
const PER_MINUTE: Unit = Unit::new("/min", 1.0, 0.05);

/// Shows wind and gusts, those of `cloth` or those of all, and the zone that is selected.
pub fn wind(ui: &mut egui::Ui, world: &mut World, cloth: Option<Entity>) {
    widgets::rows(ui, "wind", |ui| {
        if let Some(cloth) = cloth {
            let felt = world.entity(cloth).contains::<Air>();
            let mut feel = felt;
            widgets::row(ui, "air", "Without it no air acts on this cloth.", |ui| ui.checkbox(&mut feel, "acts"));
            match (felt, feel) {
                (false, true) => drop(world.entity_mut(cloth).insert(Air::default())),
                (true, false) => drop(world.entity_mut(cloth).remove::<Air>()),
                _ => {}
            }
        }
        edit_own_or_shared(world, cloth, |wind: &mut Wind| velocity(ui, "wind", &mut wind.0));
        edit_own_or_shared(world, cloth, |gusts: &mut Gusts| {
            let hint = "Root mean square of the gusts over the wind: 5 % in calm weather, 15 to 30 % in a town.";
            widgets::number_row(ui, "gusts", hint, &mut gusts.intensity, Unit::PERCENT);
            widgets::number_row(ui, "eddies", "Length of the largest.", &mut gusts.length, Unit::METRES);
            widgets::row(ui, "seed", "The same seed, the same gusts.", |ui| {
                ui.add(egui::DragValue::new(&mut gusts.seed).speed(0.1));
            });
        });
    });
    if let Some(selected) = selected_with::<WindZone>(world) {
        ui.separator();
        widgets::rows(ui, "wind zone", |ui| widgets::edit(world, selected, |wind: &mut WindZone| zone(ui, wind)));
    }
}

/// Shows the fan that is selected.
pub fn fan(ui: &mut egui::Ui, world: &mut World, selected: Entity) {
    widgets::rows(ui, "fan", |ui| {
        widgets::edit(world, selected, |fan: &mut Fan| {
            widgets::row(ui, "fan", "", |ui| ui.checkbox(&mut fan.on, "on"));
            widgets::number_row(ui, "speed", "Of the air at the outlet.", &mut fan.speed, METRE_PER_SECOND);
            widgets::number_row(ui, "diameter", "Of the outlet.", &mut fan.diameter, Unit::METRES);
            let hint = "Angle of the cone that its air stays within. A free jet fills 25° or so by itself.";
            widgets::number_row(ui, "area", hint, &mut fan.spread, DEGREES);
            let mut turns = fan.oscillation.is_some();
            widgets::row(ui, "oscillation", "From side to side.", |ui| ui.checkbox(&mut turns, "on"));
            fan.oscillation = turns.then(|| fan.oscillation.unwrap_or_default());
            if let Some(Oscillation { angle, rate }) = &mut fan.oscillation {
                widgets::number_row(ui, "to either side", "", angle, DEGREES);
                widgets::number_row(ui, "there and back", "", rate, PER_MINUTE);
            }
        });
    });
}

/// What is selected, if it has a component `C`.
pub fn selected_with<C: Component>(world: &World) -> Option<Entity> {
    world.resource::<Selected>().0.filter(|entity| world.get::<C>(*entity).is_some())
}

fn zone(ui: &mut egui::Ui, zone: &mut WindZone) {
    widgets::row(ui, "zone", "", |ui| {
        let size = match zone.shape {
            ZoneShape::Sphere { radius } => Vec3::splat(2.0 * radius),
            ZoneShape::Cuboid { size } => size,
        };
        ui.horizontal(|ui| {
            let is_ball = matches!(zone.shape, ZoneShape::Sphere { .. });
            if ui.selectable_label(is_ball, "ball").clicked() && !is_ball {
                zone.shape = ZoneShape::Sphere { radius: size.min_element() / 2.0 };
            }
            if ui.selectable_label(!is_ball, "box").clicked() && is_ball {
                zone.shape = ZoneShape::Cuboid { size };
            }
        });
    });
    match &mut zone.shape {
        ZoneShape::Sphere { radius } => widgets::number_row(ui, "radius", "", radius, Unit::METRES),
        ZoneShape::Cuboid { size } => {
            widgets::row(ui, "size", "Along x, y and z, m.", |ui| {
                widgets::numbers(ui, size.as_mut(), Unit { name: "", ..Unit::METRES });
            });
        }
    }
    velocity(ui, "adds", &mut zone.velocity);
    widgets::number_row(ui, "falloff", "From its edge inwards.", &mut zone.falloff, Unit::METRES);
}

fn velocity(ui: &mut egui::Ui, label: &str, velocity: &mut Vec3) {
    widgets::row(ui, label, "m/s, along x, y and z.", |ui| {
        widgets::numbers(ui, velocity.as_mut(), Unit { name: "", ..METRE_PER_SECOND });
    });
}
