//! Tearing: whether the cloth may tear and how easily, what becomes of scraps, and how many pieces there are.

use bevy::prelude::*;
use bevy_cloth::{ClothPieces, Tearable};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

/// A factor on the strength is a few hundredths.
const FACTOR: Unit = Unit::new("", 1.0, 0.0005);

/// Shows how `cloth` tears.
pub fn tearing(ui: &mut egui::Ui, world: &mut World, cloth: Entity) {
    let mut may = world.entity(cloth).contains::<Tearable>();
    let hint = "It tears where its threads carry more than they can; it can be cut in any case.";
    if widgets::switch(ui, "may tear", hint, &mut may, None) {
        match may {
            true => drop(world.entity_mut(cloth).insert(Tearable::default())),
            false => drop(world.entity_mut(cloth).remove::<Tearable>()),
        }
    }
    widgets::edit(world, cloth, |tearable: &mut Tearable| values(ui, tearable));
    if let Some(pieces) = world.get::<ClothPieces>(cloth) {
        let count = pieces.pieces.len().to_string();
        widgets::reading(ui, "pieces", "Parts that hang together; a reset makes it one again.", count);
    }
}

fn values(ui: &mut egui::Ui, tearable: &mut Tearable) {
    let default = Tearable::default();
    let hint = "Factor on the strength of the fabric; a real curtain is too strong for a hand.";
    Value::new("scale", hint, FACTOR, f32::MIN_POSITIVE..=1e3).show(ui, &mut tearable.scale, default.scale);
    let hint = "Most particles that part in one tick.";
    Value::new("splits", hint, Unit::NONE, 1.0..=1000.0).show_count(ui, &mut tearable.splits, default.splits);
    let hint = "Factor on the strength ahead of a crack: the lower, the farther a tear runs.";
    Value::new("weakening", hint, Unit::NONE, 0.0..=1.0).show(ui, &mut tearable.weakening, default.weakening);
    let hint = "Factor on the strength around a pin, as of a heading tape or an eyelet.";
    Value::new("at pins", hint, Unit::NONE, f32::MIN_POSITIVE..=1e3).show(
        ui,
        &mut tearable.reinforcement,
        default.reinforcement,
    );
    let hint = "How far around a pin the fabric is reinforced.";
    Value::new("pins' reach", hint, Unit::METRES, 0.0..=1e3).show(ui, &mut tearable.reach, default.reach);
    let hint = "A loose piece with fewer triangles is removed in time.";
    Value::new("debris", hint, Unit::NONE, 0.0..=1e6).show_count(ui, &mut tearable.debris, default.debris);
    let hint = "How long debris stays before it is removed.";
    Value::new("debris stays", hint, Unit::SECONDS, 0.0..=1e6).show(
        ui,
        &mut tearable.debris_lifetime,
        default.debris_lifetime,
    );
}
