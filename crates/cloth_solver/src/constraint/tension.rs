//! What the threads carry.

use fearless_simd::dispatch;

use super::{Constraints, Surface};
use crate::lanes::LEVEL;
use crate::method::Method;
use crate::topology::Along;
use crate::{Particles, Topology, measure};

/// Tension along one direction at each slot: the sum over the links there, and the sum of their weights; the mean is in N/m.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    /// Sum of the tensions.
    pub tension: Vec<f32>,
    /// Sum of the weights.
    pub weight: Vec<f32>,
}

/// Tension along weft and warp at each slot.
#[derive(Clone, Debug, Default)]
pub struct Tensions {
    weft: Sums,
    warp: Sums,
}

impl Tensions {
    /// Along weft and along warp.
    pub fn along(&self) -> [&Sums; 2] {
        [&self.weft, &self.warp]
    }

    fn clear(&mut self, slots: usize) {
        for numbers in [&mut self.weft, &mut self.warp].into_iter().flat_map(|of| [&mut of.tension, &mut of.weight]) {
            numbers.clear();
            numbers.resize(slots, 0.0);
        }
    }

    /// Adds `tension` with `weight` to a slot.
    pub(super) fn add(&mut self, along: Along, slot: u32, tension: f32, weight: f32) {
        let of = self.of(along);
        of.tension[slot as usize] += tension;
        of.weight[slot as usize] += weight;
    }

    fn of(&mut self, along: Along) -> &mut Sums {
        match along {
            Along::Weft => &mut self.weft,
            Along::Warp => &mut self.warp,
        }
    }
}

impl Constraints {
    /// Finds the tension at each slot at the end of a substep of length `h`, s. From the multipliers where the method keeps
    /// them, else from the strains.
    pub(crate) fn tensions(&mut self, topology: &Topology, particles: &Particles, h: f32, to: &mut Tensions) {
        to.clear(topology.slots());
        match (&mut self.surface, self.method) {
            (Surface::Grid(grid), Method::XpbdLines) => {
                let spacing = grid.grid.spacing;
                for (along, across) in [(Along::Weft, spacing.y), (Along::Warp, spacing.x)] {
                    let scale = -1.0 / (h * h * across);
                    dispatch!(*LEVEL, simd => grid.add_tensions(simd, along, scale, to.of(along)));
                }
                if let Some(triangles) = grid.patch.as_mut().and_then(|patch| patch.triangles_mut()) {
                    triangles.add_tensions(h, to);
                }
            }
            (Surface::Mesh(mesh), method) if !method.steps_forces() && method != Method::Pbd => {
                mesh.add_tensions(topology, h, to);
            }
            (Surface::Grid(_) | Surface::Mesh(_), _) => self.strains(topology, particles, to),
            (Surface::Empty, _) => {}
        }
    }

    fn strains(&self, topology: &Topology, particles: &Particles, to: &mut Tensions) {
        let fabric = match &self.surface {
            Surface::Grid(grid) => grid.fabric,
            Surface::Mesh(mesh) => mesh.fabric,
            Surface::Empty => return,
        };
        let stiffness = [fabric.stretch_weft, fabric.stretch_warp];
        for (slots, along, strain) in measure::threads_and_strains(topology, particles) {
            for slot in slots {
                to.add(along, slot, stiffness[along as usize] * strain, 1.0);
            }
        }
    }
}
