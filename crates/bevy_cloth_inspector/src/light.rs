//! The directional lights: how bright, of which colour, with or without shadows.

use bevy::prelude::*;
use bevy_egui::egui;

use crate::widgets::{self, Unit, Value};

const LUX: Unit = Unit::new("lx", 1.0, 1.0);
const KELVIN: Unit = Unit::new("K", 1.0, 10.0);
/// Colour temperatures that can be chosen, K.
const TEMPERATURES: [f32; 2] = [1700.0, 15000.0];
/// Colour temperature of daylight, K.
const DAYLIGHT: f32 = 6500.0;

/// Shows every directional light.
pub fn show(ui: &mut egui::Ui, world: &mut World) {
    let mut lights: Vec<Entity> = world.query_filtered::<Entity, With<DirectionalLight>>().iter(world).collect();
    lights.sort_unstable_by_key(|entity| entity.index_u32());
    if lights.is_empty() {
        widgets::note(ui, "There is no directional light.");
    }
    for entity in lights {
        let name = world.get::<Name>(entity).map_or_else(|| entity.to_string(), ToString::to_string);
        ui.push_id(entity, |ui| {
            ui.strong(name);
            if let Some(light) = world.get::<DirectionalLight>(entity) {
                let mut after = *light;
                if values(ui, &mut after)
                    && let Some(mut light) = world.get_mut::<DirectionalLight>(entity)
                {
                    *light = after;
                }
            }
        });
    }
}

/// Shows a light. Tells whether it was changed.
fn values(ui: &mut egui::Ui, light: &mut DirectionalLight) -> bool {
    let default = DirectionalLight::default();
    let hint = "Light on a face that is turned to it: full sun has 100,000 lx, an office 500 lx.";
    let before = light.illuminance;
    Value::new("illuminance", hint, LUX, 0.0..=200_000.0).show(ui, &mut light.illuminance, default.illuminance);
    let mut changed = before != light.illuminance;
    let before = temperature(light.color);
    let mut kelvin = before;
    let [coldest, hottest] = TEMPERATURES;
    let hint = "Colour temperature: a candle has 1900 K, a lamp 2700 K, daylight 6500 K.";
    Value::new("temperature", hint, KELVIN, coldest..=hottest).show(ui, &mut kelvin, DAYLIGHT);
    if kelvin != before {
        light.color = glow(kelvin).into();
        changed = true;
    }
    changed |= widgets::color(ui, "colour", "Colour of the light.", &mut light.color, default.color);
    let hint = "Whether it throws shadows.";
    changed | widgets::switch(ui, "shadows", hint, &mut light.shadow_maps_enabled, None)
}

/// Colour of what glows at `kelvin`, with its brightest channel at 1: the Planckian locus by Kim et al. (2002).
fn glow(kelvin: f32) -> LinearRgba {
    let [coldest, hottest] = TEMPERATURES;
    let t = f64::from(kelvin.clamp(coldest, hottest));
    let cubic = |t: f64, [a, b, c, d]: [f64; 4]| ((a * t + b) * t + c) * t + d;
    let x = if t <= 4000.0 {
        cubic(1e3 / t, [-0.2661239, -0.2343589, 0.8776956, 0.179910])
    } else {
        cubic(1e3 / t, [-3.0258469, 2.1070379, 0.2226347, 0.240390])
    };
    let y = if t <= 2222.0 {
        cubic(x, [-1.1063814, -1.34811020, 2.18555832, -0.20219683])
    } else if t <= 4000.0 {
        cubic(x, [-0.9549476, -1.37418593, 2.09137015, -0.16748867])
    } else {
        cubic(x, [3.0817580, -5.87338670, 3.75112997, -0.37001483])
    };
    let xyz = Xyza::xyz((x / y) as f32, 1.0, ((1.0 - x - y) / y) as f32);
    let LinearRgba { red, green, blue, .. } = LinearRgba::from(xyz);
    let rgb = Vec3::new(red, green, blue).max(Vec3::ZERO);
    let [red, green, blue] = (rgb / rgb.max_element()).to_array();
    LinearRgba::rgb(red, green, blue)
}

/// The temperature whose glow has as much blue for its red as `color`, K.
fn temperature(color: Color) -> f32 {
    let blueness = |color: LinearRgba| color.blue / color.red.max(1e-6);
    let wanted = blueness(color.to_linear());
    let [mut low, mut high] = TEMPERATURES;
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if blueness(glow(middle)) < wanted { low = middle } else { high = middle }
    }
    // A bisection ends next to what it looks for.
    (0.5 * (low + high)).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_candle_is_orange_daylight_is_white_and_a_blue_sky_is_blue() {
        let [candle, day, sky] = [1900.0, 6600.0, 12000.0].map(glow);
        assert!(candle.red == 1.0 && candle.green < 0.4 && candle.blue < 0.05, "{candle:?}");
        assert!(day.red > 0.95 && day.green > 0.9 && day.blue > 0.95, "{day:?}");
        assert!(sky.blue == 1.0 && sky.red < 0.6, "{sky:?}");
    }

    #[test]
    fn the_temperature_of_a_glow_is_the_one_it_was_made_of() {
        for kelvin in [1700.0, 2700.0, 4000.0, 6500.0, 15000.0] {
            let found = temperature(glow(kelvin).into());
            assert!((found - kelvin).abs() <= 0.002 * kelvin + 1.0, "{found} K, {kelvin} K expected");
        }
    }
}
