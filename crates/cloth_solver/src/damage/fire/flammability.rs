//! How a fabric burns.

use crate::ClothError;

/// How a fabric burns: its heat balance, and the flame that stands on it.
///
/// A thin fabric of areal density σ lights after `σ c (T_ig − T₀) / q` in a heat flux q, and fire spreads along it at
/// `v = q δ / (σ c (T_ig − T₀))`: δ is the preheat length, the way along which the full flux would heat as much as the
/// flame does (Markstein and de Ris 1973; Drysdale, *An Introduction to Fire Dynamics*). Heavier fabric burns slower,
/// as 1/σ. The flux falls from q at the foot of the flame to nothing at 2 δ, so that a fire which climbs grows for a
/// second or two before it is as fast as that.
///
/// Temperatures of ignition and melting and specific heats are measured, and scatter among sources; the preheat lengths
/// of [`Flammability::COTTON`] and [`Flammability::POLYESTER`] follow from the spread that Mathur, Vikas and Kale
/// measured on hanging panels (*An Experimental Study on Burning of Vertical Cloth Panels*, 2011; polyester taken as
/// 100 g/m²). Mass loss rates, shrinkage and afterglow are estimates.
#[cfg_attr(feature = "ecs", derive(bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flammability {
    /// Specific heat c, J/(kg·K); 100..=10,000. Default 1340.
    pub specific_heat: f32,
    /// Thermal conductivity along the cloth, W/(m·K); 0..=10. Default 0.06. What it carries is little beside a flame.
    pub conductivity: f32,
    /// Temperature at which it bursts into flame beside a flame (piloted ignition), K; 400..=1000. Default 623.
    pub ignition: f32,
    /// Temperature from which it is consumed, in flames or not, K; 380 to [`Flammability::ignition`]. The melting point
    /// of a thermoplastic, which melts away from heat before it burns; for other fabrics that at which they char.
    /// Default 623.
    pub decomposition: f32,
    /// Net heat flux of the flame at its foot into the cloth, over both faces, W/m²; 1000..=1e6. Default 50,000.
    pub heat_flux: f32,
    /// Preheat length along the flame, upward in still air, m; 1e-4..=10. Default 0.12.
    pub reach_up: f32,
    /// Preheat length across the flame, m; 1e-4..=10. Default 0.0146.
    pub reach_across: f32,
    /// Preheat length against the flame, downward in still air, m; 1e-4..=10. Default 0.0027.
    pub reach_down: f32,
    /// Mass that a burning area loses, kg/(m²·s); 1e-4..=10. Default 0.03.
    pub mass_loss_rate: f32,
    /// Part of the mass that stays as char, 0..=0.95. Default 0.1.
    pub char: f32,
    /// Part of its length by which it shrinks until it lights, 0..=0.9. Default 0.06.
    pub shrinkage: f32,
    /// How long the char glows once the flame is out, s; 0..=1000. Default 8.
    pub afterglow: f32,
}

#[cfg(feature = "ecs")]
use bevy_reflect::prelude::ReflectDefault;

impl Default for Flammability {
    /// [`Flammability::COTTON`].
    fn default() -> Self {
        Self::COTTON
    }
}

impl Flammability {
    /// Cotton, linen, viscose and other cellulose. Ignites at 288–400 °C.
    pub const COTTON: Self = Self {
        specific_heat: 1340.0,
        conductivity: 0.06,
        ignition: 623.15,
        decomposition: 623.15,
        heat_flux: 50e3,
        reach_up: 0.12,
        reach_across: 0.0146,
        reach_down: 0.0027,
        mass_loss_rate: 0.03,
        char: 0.1,
        shrinkage: 0.06,
        afterglow: 8.0,
    };

    /// Wool: slow to light (224–570 °C), with much char. That it often goes out by itself is not modelled. The flame is
    /// estimated, weaker than cotton's.
    pub const WOOL: Self = Self {
        specific_heat: 1360.0,
        conductivity: 0.05,
        ignition: 843.15,
        decomposition: 523.15,
        heat_flux: 35e3,
        reach_up: 0.06,
        mass_loss_rate: 0.02,
        char: 0.28,
        shrinkage: 0.1,
        afterglow: 1.0,
        ..Self::COTTON
    };

    /// Silk: burns as wool does. Estimated.
    pub const SILK: Self = Self { specific_heat: 1380.0, char: 0.3, ..Self::WOOL };

    /// Polyester (PET): melts at 255 °C and draws back from the flame, lights at 372–485 °C. Its burning drops are not
    /// modelled.
    pub const POLYESTER: Self = Self {
        specific_heat: 1300.0,
        conductivity: 0.14,
        ignition: 700.0,
        decomposition: 528.0,
        reach_up: 0.021,
        reach_across: 0.0106,
        mass_loss_rate: 0.05,
        char: 0.05,
        shrinkage: 0.3,
        afterglow: 0.0,
        ..Self::COTTON
    };

    /// Nylon: melts at 215–260 °C, lights at 354–425 °C. The flame is taken from polyester.
    pub const NYLON: Self = Self {
        specific_heat: 1600.0,
        conductivity: 0.25,
        ignition: 680.0,
        decomposition: 510.0,
        char: 0.02,
        ..Self::POLYESTER
    };

    /// All presets under the names shown to a user, the default first.
    pub const PRESETS: &[(&'static str, Self)] = &[
        ("Cotton", Self::COTTON),
        ("Wool", Self::WOOL),
        ("Silk", Self::SILK),
        ("Polyester", Self::POLYESTER),
        ("Nylon", Self::NYLON),
    ];

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        let check = ClothError::check;
        let reach = |field, value| check(field, value, 1e-4..=10.0, "1e-4..=10 m");
        check("Flammability::specific_heat", self.specific_heat, 100.0..=1e4, "100..=10,000 J/(kg·K)")?;
        check("Flammability::conductivity", self.conductivity, 0.0..=10.0, "0..=10 W/(m·K)")?;
        check("Flammability::ignition", self.ignition, 400.0..=1000.0, "400..=1000 K")?;
        let allowed = "380 K to Flammability::ignition";
        check("Flammability::decomposition", self.decomposition, 380.0..=self.ignition, allowed)?;
        check("Flammability::heat_flux", self.heat_flux, 1e3..=1e6, "1000..=1e6 W/m²")?;
        reach("Flammability::reach_up", self.reach_up)?;
        reach("Flammability::reach_across", self.reach_across)?;
        reach("Flammability::reach_down", self.reach_down)?;
        check("Flammability::mass_loss_rate", self.mass_loss_rate, 1e-4..=10.0, "1e-4..=10 kg/(m²·s)")?;
        check("Flammability::char", self.char, 0.0..=0.95, "0..=0.95")?;
        check("Flammability::shrinkage", self.shrinkage, 0.0..=0.9, "0..=0.9")?;
        check("Flammability::afterglow", self.afterglow, 0.0..=1000.0, "0..=1000 s")
    }
}

/// Fire as a contagion among the edges of a cloth, which knows no heat: a burning edge gathers damage and now and then
/// lights one of its neighbours, the more often the more it is burnt; fully damaged it breaks.
///
/// Cheap, and ragged by chance. It knows no direction and no fabric, and depends on the mesh: a fire crosses so many
/// edges a second. [`Flammability`] is the accurate level.
#[cfg_attr(feature = "ecs", derive(bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contagion {
    /// Damage that a burning edge gathers, 1/s, of 1 at which it breaks; 0.001..=1000. Default 0.3.
    pub rate: f32,
    /// How often a fully damaged edge would light a neighbour, 1/s; one damaged by a part does so that part as often;
    /// 0..=1000. Default 10.
    pub spread: f32,
    /// Seed of the chance: the same seed, the same fire. Default 0.
    pub seed: u64,
}

impl Default for Contagion {
    fn default() -> Self {
        Self { rate: 0.3, spread: 10.0, seed: 0 }
    }
}

impl Contagion {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Contagion::rate", self.rate, 1e-3..=1000.0, "0.001..=1000 1/s")?;
        ClothError::check("Contagion::spread", self.spread, 0.0..=1000.0, "0..=1000 1/s")
    }
}

/// How accurately the fire of a cloth is modelled.
#[cfg_attr(feature = "ecs", derive(bevy_ecs::component::Component, bevy_reflect::Reflect))]
#[cfg_attr(feature = "ecs", reflect(Default))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flammable {
    /// By heat: conduction, flames, radiation, moisture and fuel. The default, as [`Flammability::COTTON`].
    Heat(Flammability),
    /// By chance: edges that light one another.
    Contagion(Contagion),
}

impl Default for Flammable {
    fn default() -> Self {
        Self::Heat(Flammability::COTTON)
    }
}

impl Flammable {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        match self {
            Self::Heat(fabric) => fabric.validate(),
            Self::Contagion(contagion) => contagion.validate(),
        }
    }
}
