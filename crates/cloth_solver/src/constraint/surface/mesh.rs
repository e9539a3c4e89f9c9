//! The constraints of a mesh that is no grid: bending, then triangles, then strips of triangles; or, of a mesh of quads, all along its
//! rows and columns.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use crate::constraint::kernel::bending::Bending;
use crate::constraint::kernel::hinges::Hinges;
use crate::constraint::kernel::mesh_shear::MeshShear;
use crate::constraint::kernel::strips::{Packs, Strips};
use crate::constraint::kernel::triangles::{Of, Triangles};
use crate::constraint::surface::force::MeshForces;
use crate::constraint::surface::passes::Passes;
use crate::constraint::surface::quads::QuadConstraints;
use crate::constraint::tension::Tensions;
use crate::constraint::wear::Wear;
use crate::method::Method;
use crate::tick::{Effort, Substep};
use crate::topology::Along;
use crate::{Fabric, Particles, Topology};

/// The largest T h²/(m l) up to which waves across strips are stable as they are.
const LARGEST_LOAD: f32 = 0.3;

/// What is beyond is more than the most substeps resolve: then waves are slowed. A little more than [`LARGEST_LOAD`], as a substep is
/// accepted that is a little too long.
const UNSTABLE_LOAD: f32 = 1.35 * LARGEST_LOAD;

/// What keeps a mesh of fabric together.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct MeshConstraints {
    triangles: Triangles,
    shear: Option<Box<MeshShear>>,
    /// In place of all others, of a mesh of quads where the method solves lines.
    quads: Option<Box<QuadConstraints>>,
    /// Stretch along weft and warp, where the method solves it along strips.
    strips: Option<Box<[Strips; 2]>>,
    packs: Packs,
    bending: Option<Box<Bending>>,
    /// Instead, where bending is rigid.
    hinges: Option<Hinges>,
    pub fabric: Fabric,
    passes: Passes,
    /// Only for methods that step forces.
    pub forces: Option<Box<MeshForces>>,
}

impl MeshConstraints {
    pub fn new(topology: &Topology, fabric: &Fabric, method: Method) -> Self {
        let all = |count: usize| (0..count as u32).collect::<Vec<_>>();
        let mut made = Self {
            triangles: Triangles::new(topology, &all(topology.triangles.len()), fabric),
            shear: None,
            quads: None,
            strips: None,
            packs: Packs::default(),
            bending: None,
            hinges: None,
            fabric: *fabric,
            passes: Passes::default(),
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
        self.quads =
            if method == Method::XpbdLines { QuadConstraints::new(topology, fabric).map(Box::new) } else { None };
        if self.quads.is_some() {
            (self.hinges, self.bending, self.strips, self.shear) = (None, None, None, None);
            return;
        }
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
            self.packs = Packs::new(topology.slots());
            self.packs.fit(self.strips.as_ref().map_or(&[], |strips| strips.as_slice()));
            self.shear = self.strips.as_ref().and_then(|_| MeshShear::new(topology, fabric).map(Box::new));
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
        if let Some(quads) = &mut self.quads {
            quads.wear(wear);
        }
        self.strips.iter_mut().flat_map(|strips| strips.iter_mut()).for_each(|strips| strips.wear(wear));
        if let Some(shear) = &mut self.shear {
            shear.wear(wear);
        }
    }

    /// Adds the tensions in the last substep, of that [`Substep::square`].
    pub fn add_tensions(&mut self, square: f32, to: &mut Tensions) {
        match (&self.quads, &self.strips) {
            (Some(quads), _) => quads.add_tensions(square, to),
            (None, Some(strips)) => strips.iter().for_each(|strips| strips.add_tensions(square, to)),
            (None, None) => self.triangles.add_tensions(square, to),
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        if let Some(quads) = &self.quads {
            return quads.count();
        }
        let of_triangles = match &self.strips {
            Some(strips) => {
                let shear = self.shear.as_ref().map_or(0, |shear| shear.count());
                shear + strips.iter().map(Strips::count).sum::<usize>()
            }
            None => self.triangles.count(),
        };
        let bends = self.bending.as_ref().map_or(0, |bending| bending.count());
        of_triangles + bends + self.hinges.as_ref().map_or(0, Hinges::count)
    }

    /// ω² H² of the fastest waves of bending and of shear in a substep of length H, s, without filter.
    pub fn fastest(&self, particles: &Particles, h: f32) -> [f32; 2] {
        if let Some(quads) = &self.quads {
            return quads.fastest(h);
        }
        let bending = self.bending.as_ref().map_or(0.0, |bending| bending.fastest(&particles.inverse_mass, h * h));
        [bending, self.shear.as_ref().map_or(0.0, |shear| shear.fastest(h * h))]
    }

    /// Once in a substep.
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) -> Effort {
        if let Some(quads) = &mut self.quads {
            return quads.solve(simd, particles, sub);
        }
        if let Some(bending) = &mut self.bending {
            bending.push(simd, particles, sub);
        }
        if let Some(shear) = &mut self.shear {
            shear.push(simd, particles, sub);
        }
        let Some(strips) = &mut self.strips else {
            self.triangles.solve(simd, particles, sub.square(), Of::All);
            return Effort::default();
        };
        self.packs.take(particles);
        let mut met = self.packs.solve::<S, true>(simd, &mut **strips, (sub.square(), Passes::first(sub)));
        let (load, turned) = (met.load.reduce_max(), met.turned.reduce_max() > 0.0);
        if load > UNSTABLE_LOAD {
            self.packs.slow_waves(simd, &mut **strips);
        }
        self.passes.begin(sub, met.change.reduce_max());
        while self.passes.is_due() {
            met = self.packs.solve::<S, false>(simd, &mut **strips, (sub.square(), self.passes.how(sub)));
            self.passes.done(met.left.reduce_max(), met.shift.reduce_max());
        }
        self.packs.give(particles);
        Effort { load: load / LARGEST_LOAD, mean_load: 0.0, motion: met.change.reduce_max().sqrt(), turned }
    }

    /// Rigidly, once.
    #[inline(always)]
    pub fn solve_rigidly<S: Simd>(&mut self, simd: S, particles: &mut Particles) {
        if let Some(hinges) = &self.hinges {
            hinges.solve(simd, particles, f32::MAX);
        }
        self.triangles.solve(simd, particles, f32::MAX, Of::All);
    }
}
