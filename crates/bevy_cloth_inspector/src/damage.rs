//! Tearing: whether the cloth may tear and how easily, what becomes of scraps, and how many pieces there are.

use bevy::prelude::*;
use bevy_cloth::{ClothPieces, Tearable};
use bevy_egui::egui;

use crate::widgets::{self, Unit};

const SECONDS: Unit = Unit::new("s", 1.0, 0.05);
/// A factor on the strength is a few hundredths.
const FACTOR: Unit = Unit::new("", 1.0, 0.0005);

/// Shows how `cloth` tears.
pub fn tearing(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    widgets::rows(ui, "tearing", |ui| {
        let mut may = world.entity(cloth).contains::<Tearable>();
        let hint = "Where its threads carry more than they can. It can be cut in any case.";
        if widgets::row(ui, "tearing", hint, |ui| ui.checkbox(&mut may, "may tear")).changed() {
            allow(world, cloth, may);
        }
        widgets::edit(world, cloth, |tearable: &mut Tearable| values(ui, tearable));
        if let Some(pieces) = world.get::<ClothPieces>(cloth) {
            let count = pieces.pieces.len();
            widgets::row(ui, "pieces", "Reset makes it one again.", |ui| ui.label(count.to_string()));
        }
    });
}

fn allow(world: &mut World, cloth: Entity, may: bool) {
    if may {
        world.entity_mut(cloth).insert(Tearable::default());
    } else {
        world.entity_mut(cloth).remove::<Tearable>();
    }
}

fn values(ui: &mut egui::Ui, tearable: &mut Tearable) {
    let hint = "Factor on the fabric's strength. A real curtain is too strong for a hand: 0.02.";
    widgets::number_row(ui, "scale", hint, &mut tearable.scale, FACTOR);
    count(ui, "splits", "Most particles that part in a tick.", &mut tearable.splits);
    let hint = "Factor on the strength ahead of a crack: the lower, the farther a tear runs.";
    widgets::number_row(ui, "weakening", hint, &mut tearable.weakening, Unit::NONE);
    let hint = "Factor on the strength around a pin: a heading tape, an eyelet.";
    widgets::number_row(ui, "at pins", hint, &mut tearable.reinforcement, Unit::NONE);
    widgets::number_row(ui, "pins' reach", "How far around a pin it is as strong.", &mut tearable.reach, Unit::METRES);
    count(ui, "debris", "A loose piece with fewer triangles is taken out in time.", &mut tearable.debris);
    widgets::number_row(ui, "debris stays", "", &mut tearable.debris_lifetime, SECONDS);
}

fn count(ui: &mut egui::Ui, label: &str, hint: &str, value: &mut u32) {
    widgets::row(ui, label, hint, |ui| ui.add(egui::DragValue::new(value).speed(0.1)));
}
