//! The constraints of a mesh that is no grid: hinges, then triangles.

use fearless_simd::Simd;

use super::force::MeshForces;
use super::hinges::Hinges;
use super::triangles::Triangles;
use crate::{Fabric, Particles, Topology};

/// What keeps a mesh of fabric together.
#[derive(Clone, Debug)]
pub(super) struct MeshConstraints {
    triangles: Triangles,
    hinges: Option<Hinges>,
    fabric: Fabric,
    /// Only for methods that step forces.
    pub forces: Option<Box<MeshForces>>,
}

impl MeshConstraints {
    pub fn new(topology: &Topology, fabric: &Fabric) -> Self {
        let padding = topology.slots().saturating_sub(1) as u32;
        let bends = fabric.bend_warp > 0.0 || fabric.bend_weft > 0.0;
        Self {
            triangles: Triangles::new(topology, fabric, padding),
            fabric: *fabric,
            forces: None,
            hinges: (bends && !topology.hinges.is_empty()).then(|| Hinges::new(topology, fabric, padding)),
        }
    }

    /// Makes ready to be asked for forces, or gives back what that takes.
    pub fn prepare_forces(&mut self, topology: &Topology, wanted: bool) {
        if wanted != self.forces.is_some() {
            self.forces = wanted.then(|| Box::new(MeshForces::new(topology, &self.fabric)));
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.triangles.count() + self.hinges.as_ref().map_or(0, Hinges::count)
    }

    #[inline(always)]
    pub fn solve<S: Simd>(&self, simd: S, particles: &mut Particles, h: f32) {
        if let Some(hinges) = &self.hinges {
            hinges.solve(simd, particles, h);
        }
        self.triangles.solve(simd, particles, h);
    }
}
