//! The constraints of a mesh that is no grid: bending, then triangles, then strips of triangles.

use fearless_simd::Simd;

use super::bending::Bending;
use super::force::MeshForces;
use super::hinges::Hinges;
use super::strips::{Packs, Strips};
use super::tension::Tensions;
use super::triangles::{Of, Triangles};
use super::wear::Wear;
use crate::method::Method;
use crate::topology::Along;
use crate::{Fabric, Particles, Topology};

/// What keeps a mesh of fabric together.
#[derive(Clone, Debug)]
pub(super) struct MeshConstraints {
    triangles: Triangles,
    /// Stretch along weft and warp, where the method solves it along strips.
    strips: Option<Box<[Strips; 2]>>,
    packs: Packs,
    bending: Option<Box<Bending>>,
    /// Instead, where bending is rigid.
    hinges: Option<Hinges>,
    pub fabric: Fabric,
    /// Only for methods that step forces.
    pub forces: Option<Box<MeshForces>>,
}

impl MeshConstraints {
    pub fn new(topology: &Topology, fabric: &Fabric, method: Method) -> Self {
        let all = |count: usize| (0..count as u32).collect::<Vec<_>>();
        let mut made = Self {
            triangles: Triangles::new(topology, &all(topology.triangles.len()), fabric),
            strips: None,
            packs: Packs::new(topology.slots()),
            bending: None,
            hinges: None,
            fabric: *fabric,
            forces: None,
        };
        made.prepare(topology, method);
        made
    }

    /// Makes ready for `method`, and gives back what only others need.
    pub fn prepare(&mut self, topology: &Topology, method: Method) {
        if method.steps_forces() != self.forces.is_some() {
            self.forces = method.steps_forces().then(|| {
                let all = (0..topology.triangles.len() as u32).collect();
                Box::new(MeshForces::new(topology, all, &self.fabric))
            });
        }
        let fabric = &self.fabric;
        let bends = !method.steps_forces() && (fabric.bend_warp > 0.0 || fabric.bend_weft > 0.0);
        let is_rigid = method == Method::Pbd;
        if (bends && is_rigid) != self.hinges.is_some() {
            let all: Vec<u32> = (0..topology.hinges.len() as u32).collect();
            self.hinges = (bends && is_rigid).then(|| Hinges::new(topology, &all, fabric));
        }
        if (bends && !is_rigid) != self.bending.is_some() {
            self.bending = if bends && !is_rigid { Bending::new(topology, fabric).map(Box::new) } else { None };
        }
        if (method == Method::XpbdLines) != self.strips.is_some() {
            let strips = |along| Strips::new(topology, along, &self.fabric);
            self.strips = (method == Method::XpbdLines).then(|| Box::new([Along::Weft, Along::Warp].map(strips)));
        }
    }

    /// The constraints of the same fabric over what became of the mesh.
    pub fn follow(&mut self, now: &Topology, method: Method) {
        let watched = self.triangles.is_watched();
        *self = Self::new(now, &self.fabric, method);
        if watched {
            self.triangles.watch();
        }
    }

    /// Takes over what became of the particles.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        self.triangles.wear(wear);
        self.strips.iter_mut().flat_map(|strips| strips.iter_mut()).for_each(|strips| strips.wear(wear));
    }

    /// Adds the tensions in the last solve of a substep of length `h`.
    pub fn add_tensions(&mut self, h: f32, to: &mut Tensions) {
        match &self.strips {
            Some(strips) => strips.iter().for_each(|strips| strips.add_tensions(h, to)),
            None => self.triangles.add_tensions(h, to),
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        let of_triangles = match &self.strips {
            Some(strips) => self.triangles.count(Of::Shear) + strips.iter().map(Strips::count).sum::<usize>(),
            None => self.triangles.count(Of::All),
        };
        let bends = self.bending.as_ref().map_or(0, |bending| bending.count());
        of_triangles + bends + self.hinges.as_ref().map_or(0, Hinges::count)
    }

    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        if let Some(bending) = &mut self.bending {
            bending.solve(simd, particles, h);
        }
        if let Some(hinges) = &self.hinges {
            hinges.solve(simd, particles, h);
        }
        match &mut self.strips {
            None => self.triangles.solve(simd, particles, h, Of::All),
            Some(strips) => {
                self.triangles.solve(simd, particles, h, Of::Shear);
                self.packs.solve(simd, particles, &mut **strips, h);
            }
        }
    }
}
