//! What the threads carry.

use super::{Constraints, Surface};
use crate::method::Method;
use crate::topology::Along;
use crate::{Particles, Topology, measure};

/// Tension along weft and warp at each slot, N/m, as a sum over the links there and the sum of their weights.
#[derive(Clone, Debug, Default)]
pub struct Tensions {
    weft: Vec<(f32, f32)>,
    warp: Vec<(f32, f32)>,
}

impl Tensions {
    /// Sums and weights along weft and along warp.
    pub fn along(&self) -> [&[(f32, f32)]; 2] {
        [&self.weft, &self.warp]
    }

    fn clear(&mut self, slots: usize) {
        for sums in [&mut self.weft, &mut self.warp] {
            sums.clear();
            sums.resize(slots, (0.0, 0.0));
        }
    }

    /// Adds `sum` with `weight` to a slot, along weft (0) or warp (1).
    pub(super) fn add(&mut self, along: usize, slot: u32, sum: f32, weight: f32) {
        let all = if along == 0 { &mut self.weft } else { &mut self.warp };
        let (sums, weights) = &mut all[slot as usize];
        *sums += sum;
        *weights += weight;
    }

    fn of(&mut self, along: Along) -> &mut [(f32, f32)] {
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
                    grid.add_tensions(along, -1.0 / (h * h * across), to.of(along));
                }
                if let Some(triangles) = grid.patch.as_mut().and_then(|patch| patch.triangles_mut()) {
                    triangles.add_tensions(h, to);
                }
            }
            (Surface::Mesh(mesh), method) if !method.steps_forces() && method != Method::Pbd => {
                mesh.triangles.add_tensions(h, to);
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
                to.add(along as usize, slot, stiffness[along as usize] * strain, 1.0);
            }
        }
    }
}
