//! The air: whether the cloth feels it, wind and gusts, the selected wind zone, the selected fan.

use bevy::prelude::*;
use bevy_cloth::{Air, Fan, Gusts, Oscillation, Wind, WindZone, ZoneShape};
use bevy_egui::egui;

use crate::Selected;
use crate::widgets::{self, Unit, Value, edit_own_or_shared};

const PER_MINUTE: Unit = Unit::new("/min", 1.0, 0.05);
const KILOGRAM_PER_CUBIC_METRE: Unit = Unit::new("kg/m³", 1.0, 0.005);

/// Shows the air, wind and gusts, those of `cloth` or those of all, and the zone that is selected.
pub fn wind(ui: &mut egui::Ui, world: &mut World, cloth: Option<Entity>) {
    if let Some(cloth) = cloth {
        let felt = world.entity(cloth).contains::<Air>();
        let mut feel = felt;
        widgets::switch(ui, "air", "Without it no air acts on this cloth.", &mut feel, None);
        match (felt, feel) {
            (false, true) => drop(world.entity_mut(cloth).insert(Air::default())),
            (true, false) => drop(world.entity_mut(cloth).remove::<Air>()),
            _ => {}
        }
        widgets::edit(world, cloth, |air: &mut Air| density(ui, air));
    }
    edit_own_or_shared(world, cloth, |wind: &mut Wind| {
        let hint = "Velocity of the air along x, y and z.";
        Value::new("wind", hint, Unit::METRES_PER_SECOND, -1e6..=1e6).show_vec3(ui, &mut wind.0, Vec3::ZERO);
    });
    edit_own_or_shared(world, cloth, |gusts: &mut Gusts| {
        let default = Gusts::default();
        let hint = "Root mean square of the gusts over the wind: 5 % in calm weather, 15 to 30 % in a town.";
        Value::new("gusts", hint, Unit::PERCENT, 0.0..=2.0).show(ui, &mut gusts.intensity, default.intensity);
        let hint = "Length of the largest eddies.";
        Value::new("eddies", hint, Unit::METRES, 0.01..=1e4).show(ui, &mut gusts.length, default.length);
        let mut seed = gusts.seed.min(u64::from(u32::MAX)) as u32;
        let before = seed;
        let row = Value::new("seed", "The same seed gives the same gusts.", Unit::NONE, 0.0..=1e9);
        row.show_count(ui, &mut seed, default.seed as u32);
        if seed != before {
            gusts.seed = u64::from(seed);
        }
    });
    if let Some(selected) = selected_with::<WindZone>(world) {
        ui.separator();
        widgets::edit(world, selected, |wind: &mut WindZone| zone(ui, wind));
    }
}

fn density(ui: &mut egui::Ui, air: &mut Air) {
    let default = Air::default();
    let hint = "Mass of a cubic metre of air.";
    Value::new("density", hint, KILOGRAM_PER_CUBIC_METRE, 0.0..=2000.0).show(ui, &mut air.density, default.density);
    let hint = "Drag coefficient of cloth that meets the air with its face.";
    Value::new("drag, face", hint, Unit::NONE, 0.0..=10.0).show(ui, &mut air.normal, default.normal);
    let hint = "Drag coefficient of cloth along which the air flows.";
    Value::new("drag, along", hint, Unit::NONE, 0.0..=10.0).show(ui, &mut air.tangent, default.tangent);
    let hint = "Part of the air that passes through the fabric.";
    Value::new("porosity", hint, Unit::PERCENT, 0.0..=1.0).show(ui, &mut air.porosity, default.porosity);
}

/// Shows the fan that is selected.
pub fn fan(ui: &mut egui::Ui, world: &mut World, selected: Entity) {
    widgets::edit(world, selected, |fan: &mut Fan| {
        let default = Fan::default();
        widgets::switch(ui, "runs", "Whether the fan blows.", &mut fan.on, default.on);
        let hint = "Speed of the air at the outlet.";
        Value::new("speed", hint, Unit::METRES_PER_SECOND, 0.0..=1e3).show(ui, &mut fan.speed, default.speed);
        let hint = "Diameter of the outlet.";
        Value::new("diameter", hint, Unit::METRES, 0.01..=100.0).show(ui, &mut fan.diameter, default.diameter);
        let hint = "Angle of the cone that its air stays within; a free jet fills 25° or so by itself.";
        Value::new("area", hint, Unit::DEGREES_OF_RADIANS, 0.0..=2.5).show(ui, &mut fan.spread, default.spread);
        let mut turns = fan.oscillation.is_some();
        widgets::switch(ui, "turns", "Whether it turns from side to side.", &mut turns, false);
        fan.oscillation = turns.then(|| fan.oscillation.unwrap_or_default());
        if let Some(Oscillation { angle, rate }) = &mut fan.oscillation {
            let default = Oscillation::default();
            let hint = "How far it turns to either side.";
            Value::new("to either side", hint, Unit::DEGREES_OF_RADIANS, 0.0..=3.2).show(ui, angle, default.angle);
            let hint = "How often it turns there and back.";
            Value::new("there and back", hint, PER_MINUTE, 0.0..=600.0).show(ui, rate, default.rate);
        }
    });
}

/// What is selected, if it has a component `C`.
pub fn selected_with<C: Component>(world: &World) -> Option<Entity> {
    world.resource::<Selected>().0.filter(|entity| world.get::<C>(*entity).is_some())
}

fn zone(ui: &mut egui::Ui, zone: &mut WindZone) {
    let default = WindZone::default();
    let mut is_ball = matches!(zone.shape, ZoneShape::Sphere { .. });
    if widgets::choice(ui, "zone", "Form of the region.", &mut is_ball, None, [(true, "ball"), (false, "box")]) {
        zone.shape = match zone.shape {
            ZoneShape::Sphere { radius } => ZoneShape::Cuboid { size: Vec3::splat(2.0 * radius) },
            ZoneShape::Cuboid { size } => ZoneShape::Sphere { radius: size.min_element() / 2.0 },
        };
    }
    match &mut zone.shape {
        ZoneShape::Sphere { radius } => {
            Value::new("radius", "Radius of the ball.", Unit::METRES, 1e-4..=1e4).show(ui, radius, None);
        }
        ZoneShape::Cuboid { size } => {
            Value::new("size", "Along x, y and z.", Unit::METRES, 1e-4..=1e4).show_vec3(ui, size, None);
        }
    }
    let hint = "Wind that it adds, along x, y and z.";
    Value::new("adds", hint, Unit::METRES_PER_SECOND, -1e6..=1e6).show_vec3(ui, &mut zone.velocity, default.velocity);
    let hint = "Width of the soft edge, from the border inwards.";
    Value::new("falloff", hint, Unit::METRES, 0.0..=1e4).show(ui, &mut zone.falloff, default.falloff);
}
