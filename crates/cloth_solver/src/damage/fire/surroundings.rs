//! What is around a burning cloth.

use glam::Vec3;

use super::ROOM_TEMPERATURE;
use crate::ClothError;

/// What is around a burning cloth, in the cloth's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Velocity of the air at the fire, m/s, up to 1e6 in amount: flames lean with it. Default 0.
    pub wind: Vec3,
    /// Temperature of the air, K; 150..=373. Default 293.15.
    pub air: f32,
    /// The direction against gravity, of any length up to 1e6; zero where there is none. Default +y.
    pub up: Vec3,
}

impl Default for Surroundings {
    fn default() -> Self {
        Self { wind: Vec3::ZERO, air: ROOM_TEMPERATURE, up: Vec3::Y }
    }
}

/// Speed at which the hot gas of a flame rises in still air, m/s: √(g L) of a flame of a tenth of a metre.
const BUOYANT_SPEED: f32 = 1.0;

impl Surroundings {
    /// Velocity of the hot gas above a flame, m/s: it rises at 1 m/s against gravity, and the wind carries it along.
    pub fn stream(&self) -> Vec3 {
        self.up.normalize_or_zero() * BUOYANT_SPEED + self.wind
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Surroundings::wind", self.wind.length(), 0.0..=1e6, "0..=1e6 m/s in amount")?;
        ClothError::check("Surroundings::air", self.air, 150.0..=373.0, "150..=373 K")?;
        ClothError::check("Surroundings::up", self.up.length(), 0.0..=1e6, "a length of 0..=1e6")
    }
}
