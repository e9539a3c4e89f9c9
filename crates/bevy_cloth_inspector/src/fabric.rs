//! What a cloth is made of: preset, and every value with its unit.

use bevy::prelude::*;
use bevy_cloth::Fabric;
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

const NEWTON_PER_METRE: Unit = Unit::new("N/m", 1.0, 0.5);
const MICRONEWTON_METRE: Unit = Unit::new("µN·m", 1e6, 0.05);
const GRAM_PER_SQUARE_METRE: Unit = Unit::new("g/m²", 1e3, 0.5);

/// Shows the fabric of `entity`.
pub fn show(ui: &mut egui::Ui, world: &mut World, entity: Entity) {
    widgets::edit(world, entity, |fabric: &mut Fabric| {
        let hint = "A measured or estimated fabric to start from.";
        let presets = Fabric::PRESETS.iter().map(|(name, preset)| (*preset, *name));
        widgets::choice(ui, "preset", hint, fabric, None, presets);
        let default = chosen(ui, entity, fabric);
        values(ui, fabric, &default);
    });
}

/// The preset that was chosen last, to which values go back; without one the default fabric.
fn chosen(ui: &egui::Ui, entity: Entity, fabric: &Fabric) -> Fabric {
    let id = egui::Id::new(("chosen preset", entity));
    let preset = Fabric::PRESETS.iter().position(|(_, preset)| preset == fabric);
    let last = ui.data_mut(|data| {
        if let Some(preset) = preset {
            data.insert_temp(id, preset);
        }
        data.get_temp::<usize>(id)
    });
    last.and_then(|index| Fabric::PRESETS.get(index)).map_or_else(Fabric::default, |(_, preset)| *preset)
}

fn values(ui: &mut egui::Ui, fabric: &mut Fabric, default: &Fabric) {
    let stiffness = 1e-2..=1e9;
    Value::new("mass", "Mass of a square metre of the fabric.", GRAM_PER_SQUARE_METRE, 1e-5..=100.0).show(
        ui,
        &mut fabric.areal_density,
        default.areal_density,
    );
    Value::new("thickness", "Thickness of the fabric; contact keeps half of it clear.", Unit::MILLIMETRES, 1e-6..=0.1)
        .show(ui, &mut fabric.thickness, default.thickness);
    Value::new("stretch, warp", "Stiffness against stretch along the warp.", NEWTON_PER_METRE, stiffness.clone()).show(
        ui,
        &mut fabric.stretch_warp,
        default.stretch_warp,
    );
    Value::new("stretch, weft", "Stiffness against stretch along the weft.", NEWTON_PER_METRE, stiffness).show(
        ui,
        &mut fabric.stretch_weft,
        default.stretch_weft,
    );
    Value::new("shear", "Stiffness against shear in the plane of the fabric.", NEWTON_PER_METRE, 0.0..=1e9).show(
        ui,
        &mut fabric.shear,
        default.shear,
    );
    Value::new("bending, warp", "Stiffness against curvature along the warp.", MICRONEWTON_METRE, 0.0..=1e4).show(
        ui,
        &mut fabric.bend_warp,
        default.bend_warp,
    );
    Value::new("bending, weft", "Stiffness against curvature along the weft.", MICRONEWTON_METRE, 0.0..=1e4).show(
        ui,
        &mut fabric.bend_weft,
        default.bend_weft,
    );
    Value::new("damping", "Rate at which motion inside the fabric fades.", Unit::PER_SECOND, 0.0..=1000.0).show(
        ui,
        &mut fabric.damping,
        default.damping,
    );
    Value::new("friction", "Coulomb friction coefficient against solids.", Unit::NONE, 0.0..=10.0).show(
        ui,
        &mut fabric.friction,
        default.friction,
    );
    let hint = "Tension at which it tears, if it may tear.";
    Value::new("strength", hint, NEWTON_PER_METRE, f32::MIN_POSITIVE..=1e9).show(
        ui,
        &mut fabric.strength,
        default.strength,
    );
    Value::new("stretch limit", "Largest strain the fabric takes in use.", Unit::PERCENT, 1e-4..=10.0).show(
        ui,
        &mut fabric.stretch_limit,
        default.stretch_limit,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_back_to_the_preset_that_was_chosen_last() {
        let (_, preset) = Fabric::PRESETS[3];
        let entity = Entity::PLACEHOLDER;
        let _ = egui::Context::default().run_ui(egui::RawInput::default(), |ui| {
            assert_eq!(chosen(ui, entity, &Fabric { friction: 0.123, ..preset }), Fabric::default());
            assert_eq!(chosen(ui, entity, &preset), preset);
            assert_eq!(chosen(ui, entity, &Fabric { friction: 0.123, ..preset }), preset);
        });
    }
}
