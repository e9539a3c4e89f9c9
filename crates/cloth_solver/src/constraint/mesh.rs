//! The constraints of a mesh that is no grid: hinges, then triangles.

use fearless_simd::Simd;

use super::force::MeshForces;
use super::hinges::Hinges;
use super::triangles::Triangles;
use crate::{Fabric, Particles, Topology};

/// What keeps a mesh of fabric together.
#[derive(Clone, Debug)]
pub(super) struct MeshConstraints {
    pub triangles: Triangles,
    hinges: Option<Hinges>,
    pub fabric: Fabric,
    /// Only for methods that step forces.
    pub forces: Option<Box<MeshForces>>,
}

impl MeshConstraints {
    pub fn new(topology: &Topology, fabric: &Fabric) -> Self {
        let all = |count: usize| (0..count as u32).collect::<Vec<_>>();
        let bends = fabric.bend_warp > 0.0 || fabric.bend_weft > 0.0;
        Self {
            triangles: Triangles::new(topology, &all(topology.triangles.len()), fabric),
            fabric: *fabric,
            forces: None,
            hinges: (bends && !topology.hinges.is_empty())
                .then(|| Hinges::new(topology, &all(topology.hinges.len()), fabric)),
        }
    }

    /// Makes ready to be asked for forces, or gives back what that takes.
    pub fn prepare_forces(&mut self, topology: &Topology, wanted: bool) {
        if wanted != self.forces.is_some() {
            self.forces = wanted.then(|| {
                let all = (0..topology.triangles.len() as u32).collect();
                Box::new(MeshForces::new(topology, all, &self.fabric))
            });
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        self.triangles.count() + self.hinges.as_ref().map_or(0, Hinges::count)
    }

    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        if let Some(hinges) = &self.hinges {
            hinges.solve(simd, particles, h);
        }
        self.triangles.solve(simd, particles, h);
    }
}
