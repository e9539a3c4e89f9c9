//! Lift and drag of the air on each triangle.

use glam::Vec3;

use crate::{ClothError, Particles, Topology};

/// The air around a cloth and how it takes hold of it.
///
/// On a triangle of rest area A with unit normal n and mean velocity u the air, moving at w, pulls with
/// `½ ρ A |v| (C_t v_t + C_n (n·v) n) (1 − porosity)`, `v = w − u`, `v_t` its part along the triangle.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Density ρ, kg/m³; 0..=2000. Default 1.225, dry air at sea level and 15 °C.
    pub density: f32,
    /// Coefficient C_n of the force along the normal, dimensionless; 0..=10. Default 1.17, a square plate broadside
    /// (Hoerner 1965).
    pub normal: f32,
    /// Coefficient C_t of the force along the surface, dimensionless; 0..=10. Default 0.03.
    pub tangent: f32,
    /// Part of the wind that goes through, 0..=1. Default 0.
    pub porosity: f32,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Air {
    fn default() -> Self {
        Self { density: 1.225, normal: 1.17, tangent: 0.03, porosity: 0.0 }
    }
}

impl Air {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Air::density", self.density, 0.0..=2000.0, "0..=2000 kg/m³")?;
        ClothError::check("Air::normal", self.normal, 0.0..=10.0, "0..=10")?;
        ClothError::check("Air::tangent", self.tangent, 0.0..=10.0, "0..=10")?;
        ClothError::check("Air::porosity", self.porosity, 0.0..=1.0, "0..=1")
    }

    /// Adds the air's force on every triangle to [`Particles::force`] for a tick of `dt` seconds. `wind` gives the
    /// velocity of the air, m/s, at a point of the cloth's frame.
    ///
    /// What a particle gets within the tick never turns its motion against the air round: stable at any wind.
    pub fn blow(&self, topology: &Topology, particles: &mut Particles, dt: f32, wind: impl Fn(Vec3) -> Vec3) {
        let strength = 0.5 * self.density * (1.0 - self.porosity);
        if strength <= 0.0 || dt <= 0.0 {
            return;
        }
        for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
            let slots = triangle.map(|slot| slot as usize);
            let [a, b, c] = slots.map(|slot| particles.position.get(slot));
            let moving: Vec3 = slots.iter().map(|slot| particles.velocity.get(*slot)).sum::<Vec3>() / 3.0;
            let relative = wind((a + b + c) / 3.0) - moving;
            let speed = relative.length();
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let across = normal * normal.dot(relative);
            let area = 0.5 * rest.determinant().abs();
            // What would stop the lightest of its corners within the tick, per area.
            let lightest = |least: f32, slot: &usize| least.min(particles.mass[*slot] / topology.area[*slot]);
            let most = slots.iter().fold(f32::INFINITY, lightest) / dt;
            let along = relative - across;
            let push = |coefficient: f32| (strength * speed * coefficient).min(most) * area / 3.0;
            let force = across * push(self.normal) + along * push(self.tangent);
            for slot in slots {
                particles.add_force(slot, force * topology.air_share[slot]);
            }
        }
    }
}
