//! The authored component that says what hangs on a cloth.

use bevy::prelude::*;
use cloth_solver::{ClothError, Particles, Topology};

use crate::pins::PinSelect;
use crate::prepare::{Skin, select};

/// Weights that hang on a cloth: any number of them, each on the particles it chooses, on top of the fabric's own mass.
///
/// Where two choose the same particle it carries both. Inserting, changing and removing `Weights` while the cloth runs
/// leaves its shape and motion as they are.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::*;
/// // A square of cotton with 50 g on its lower right corner.
/// let corner = PinSelect::Region { min: Vec3::new(0.49, -0.51, -0.1), max: Vec3::new(0.51, -0.49, 0.1) };
/// let cloth = (Cloth::rectangle(1.0, 1.0), Pins::corners(), Weights::one(corner, 0.05));
/// ```
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Weights(pub Vec<Weight>);

/// Something heavy on some particles of a cloth.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct Weight {
    /// Which particles carry it. If it chooses none, it weighs nothing.
    pub select: PinSelect,
    /// Mass, kg; 0 to 1,000,000. The chosen particles share it evenly. Default 0.1.
    pub mass: f32,
}

impl Default for Weight {
    fn default() -> Self {
        Self { select: PinSelect::default(), mass: 0.1 }
    }
}

impl Weights {
    /// One weight of `mass` (kg, 0 to 1,000,000), shared by the particles that `select` chooses.
    pub fn one(select: PinSelect, mass: f32) -> Self {
        Self(vec![Weight { select, mass }])
    }

    /// These weights and those of `other`.
    pub fn and(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }
}

/// What hangs on each particle of a running cloth: slot and kg.
#[derive(Component, Clone, Debug, Default)]
#[component(clone_behavior = Ignore)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Loads(Vec<(u32, f32)>);

impl Loads {
    /// Which particles `weights` choose, and how much each carries.
    pub fn find(weights: Option<&Weights>, topology: &Topology, skin: &Skin) -> Result<Self, ClothError> {
        let mut loads = Vec::new();
        for weight in weights.into_iter().flat_map(|weights| &weights.0) {
            ClothError::check("Weight::mass", weight.mass, 0.0..=1e6, "0..=1,000,000 kg")?;
            let chosen = select(&weight.select, topology, skin)?;
            let share = weight.mass / chosen.len().max(1) as f32;
            loads.extend(chosen.into_iter().map(|slot| (slot, share)));
        }
        Ok(Self(loads))
    }

    /// Adds the weights to particles that carry none yet. What hung on a particle that is burnt away is gone, too.
    pub fn hang(&self, particles: &mut Particles) -> Result<(), ClothError> {
        let there: Vec<_> = self.0.iter().filter(|(slot, _)| particles.mass[*slot as usize] > 0.0).collect();
        there.into_iter().try_for_each(|(slot, mass)| particles.add_mass(*slot as usize, *mass))
    }
}
