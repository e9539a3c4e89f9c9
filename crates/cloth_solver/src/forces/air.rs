//! Lift and drag of the air on each triangle.

use glam::Vec3;

use crate::{ClothError, Particles, Soa3, Topology};

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

    /// Adds the air's force on every face to [`Particles::force`] for a tick of `dt` seconds. `wind` gives the velocity of
    /// the air, m/s, at a point of the cloth's frame. The faces of a rectangle are its cells, whose corners share their
    /// force evenly, as they do their mass; those of any other mesh its triangles.
    ///
    /// What a particle gets within the tick never turns its motion against the air round: stable at any wind.
    pub fn blow(&self, topology: &Topology, particles: &mut Particles, dt: f32, wind: impl Fn(Vec3) -> Vec3) {
        let strength = 0.5 * self.density * (1.0 - self.porosity);
        if strength <= 0.0 || dt <= 0.0 {
            return;
        }
        let slots = particles.slots();
        let mut force = particles.force.take().unwrap_or_else(|| Soa3::zeros(slots));
        let gust = Gust { air: self, strength, topology, particles, dt };
        match topology.grid {
            Some(grid) => {
                let area = grid.spacing.x * grid.spacing.y;
                for (row, column) in grid.cells() {
                    let corners = grid.cell(row, column).map(|slot| slot as usize);
                    let [p00, p10, p01, p11] = corners.map(|slot| particles.position.get(slot));
                    gust.push(corners, (p11 - p00).cross(p10 - p01), area, &wind, &mut force);
                }
            }
            None => {
                for (triangle, rest) in topology.triangles.iter().zip(&topology.triangle_rest) {
                    let corners = triangle.map(|slot| slot as usize);
                    let [a, b, c] = corners.map(|slot| particles.position.get(slot));
                    gust.push(corners, (b - a).cross(c - a), 0.5 * rest.determinant().abs(), &wind, &mut force);
                }
            }
        }
        particles.force = Some(force);
    }
}

/// The air of one tick.
struct Gust<'a> {
    air: &'a Air,
    /// ½ ρ (1 − porosity), kg/m³.
    strength: f32,
    topology: &'a Topology,
    particles: &'a Particles,
    dt: f32,
}

impl Gust<'_> {
    /// Adds the force on one face to its corners. `normal` may have any length.
    fn push<const N: usize>(
        &self,
        corners: [usize; N],
        normal: Vec3,
        area: f32,
        wind: &impl Fn(Vec3) -> Vec3,
        force: &mut Soa3,
    ) {
        let Particles { position, velocity, mass, .. } = self.particles;
        let share = 1.0 / N as f32;
        let middle = corners.iter().map(|slot| position.get(*slot)).sum::<Vec3>() * share;
        let relative = wind(middle) - corners.iter().map(|slot| velocity.get(*slot)).sum::<Vec3>() * share;
        let speed = relative.length();
        let normal = normal.normalize_or_zero();
        let across = normal * normal.dot(relative);
        let along = relative - across;
        // What would stop the lightest of the corners within the tick, per area.
        let lightest = |least: f32, slot: &usize| least.min(mass[*slot] / self.topology.area[*slot]);
        let most = corners.iter().fold(f32::INFINITY, lightest) / self.dt;
        let pull = |coefficient: f32| (self.strength * speed * coefficient).min(most) * area * share;
        let each = across * pull(self.air.normal) + along * pull(self.air.tangent);
        for slot in corners {
            force.set(slot, force.get(slot) + each);
        }
    }
}
