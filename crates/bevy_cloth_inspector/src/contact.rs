//! Contact of the selected solid: its friction, what it reports, and the force of the cloth on it.

use bevy::prelude::*;
use bevy_cloth::{ClothForce, ColliderFriction, ContactEvents};
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

/// Shows contact of the solid `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    let hint = "Its own friction in place of the fabric's.";
    own(ui, world, entity, "own friction", hint, ColliderFriction::default());
    widgets::edit(world, entity, |friction: &mut ColliderFriction| {
        let hint = "Coulomb friction coefficient between cloth and this solid.";
        let default = ColliderFriction::default().0;
        Value::new("friction", hint, Unit::NONE, 0.0..=10.0).show(ui, &mut friction.0, default);
    });
    let hint = "It sends an event when a cloth begins or ends to touch it.";
    own(ui, world, entity, "events", hint, ContactEvents);
    own(ui, world, entity, "measure force", "Measures the force of all cloth on it.", ClothForce::default());
    if let Some(force) = world.get::<ClothForce>(entity) {
        let text = format!("{:.3} N", force.force.length());
        widgets::reading(ui, "force", "Force of all cloth on it, mean over the last tick.", text);
        let text = format!("{:.3} N·m", force.torque.length());
        widgets::reading(ui, "torque", "Torque about its origin, mean over the last tick.", text);
        widgets::reading(ui, "touching", "Particles that touch it.", force.touching.to_string());
    }
}

/// A switch for a component.
fn own<C: Component>(
    ui: &mut egui::Ui,
    world: &mut World,
    entity: Entity,
    label: &'static str,
    hint: &'static str,
    component: C,
) {
    let mut has = world.entity(entity).contains::<C>();
    if widgets::switch(ui, label, hint, &mut has, None) {
        match has {
            true => drop(world.entity_mut(entity).insert(component)),
            false => drop(world.entity_mut(entity).remove::<C>()),
        }
    }
}
