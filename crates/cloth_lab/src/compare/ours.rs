//! This project's own methods.

use cloth_solver::{Cloth, ClothError, Method, Tick};
use glam::Vec3;

use super::play::{Engine, RATE};
use super::scenes::Setup;

/// Gravity of every scene, m/s².
pub const GRAVITY: Vec3 = Vec3::new(0.0, -9.81, 0.0);

/// A sheet advanced by one of this project's methods.
pub struct Ours {
    cloth: Cloth,
    tick: Tick,
}

impl Ours {
    /// The sheet of `setup`, advanced with `method`.
    ///
    /// # Errors
    /// What in the scene is out of range.
    pub fn new(setup: &Setup, method: Method, substeps: u32, iterations: u32) -> Result<Self, ClothError> {
        Ok(Self { cloth: setup.cloth(method)?, tick: Tick { iterations, ..Tick::at_least(1.0 / RATE, substeps) } })
    }
}

impl Engine for Ours {
    fn tick(&mut self) -> bool {
        self.cloth.step(self.tick, GRAVITY);
        true
    }

    fn positions(&self, out: &mut Vec<Vec3>) {
        out.clear();
        out.extend(self.cloth.topology.vertex_particle.iter().map(|p| self.cloth.particles.position.get(*p as usize)));
    }
}
