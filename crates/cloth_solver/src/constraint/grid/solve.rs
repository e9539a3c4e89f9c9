//! Cells by their stress, rows and columns exactly, and the inertia that their loads ask for.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::super::cells::{CellModel, ShearModel};
use super::super::lines;
use super::super::listed::Work;
use super::super::shear::Sheet;
use super::{GridConstraints, Stiffness, compliance, gather, is_block, multipliers, scatter, worn};
use crate::lanes::{LANES, splat};
use crate::topology::Along;
use crate::{Fabric, Particles};

/// T h²/(m l) that a particle under a lasting load is given the inertia for. Warp and weft are solved one after the other,
/// so where both carry much they leave a strain of this order times the ratio of their loads' change over an edge.
const STATIC_LOAD: f32 = 0.25;

// A particle that has the inertia its load asks for must still count as loaded, or it would lose it again.
const _: () = assert!(STATIC_LOAD > lines::EXPLICIT_LOAD);

impl GridConstraints {
    /// Once in a substep of length `h`.
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        let Fabric { shear, areal_density, .. } = self.fabric;
        let mut stress = std::mem::take(&mut self.stress);
        if shear > 0.0 {
            let sheet = Sheet { grid: &self.grid, mask: &self.cell_mask, shear, density: areal_density };
            stress.find(simd, sheet, &particles.position, &particles.inverse_mass, h);
        }
        let model = if shear > 0.0 { ShearModel::Stress(&stress.lambda) } else { ShearModel::None };
        self.solve_cells(simd, particles, CellModel { shear: model, twist: self.twist_compliance(h) });
        self.stress = stress;
        let listed = if shear > 0.0 { ShearModel::Constraint(self.shear_compliance(h)) } else { ShearModel::None };
        let listed = CellModel { shear: listed, twist: self.twist_compliance(h) };
        if let Some(patch) = &mut self.patch {
            patch.solve_loose(simd, particles, &self.grid, listed, h);
        }
        let (weft, warp) = (self.stiffness(Along::Weft, h), self.stiffness(Along::Warp, h));
        let mut weft_load = self.solve_rows(simd, particles, weft);
        if let Some(patch) = &mut self.patch {
            weft_load = weft_load.max(patch.solve(simd, Along::Weft, particles, weft, &mut self.work));
        }
        let mut warp_load = self.solve_columns(simd, particles, warp);
        if let Some(patch) = &mut self.patch {
            warp_load = warp_load.max(patch.solve(simd, Along::Warp, particles, warp, &mut self.work));
        }
        if weft_load > lines::EXPLICIT_LOAD {
            self.soften_rows(simd, particles);
        }
        if warp_load > lines::EXPLICIT_LOAD {
            self.soften_columns(simd, particles);
        }
    }

    #[inline(always)]
    fn soften_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles) {
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            let Work { moved, inverse_mass, load: inertia, elimination, .. } = &mut self.work;
            gather(simd, &particles.moved, moved, rows, first);
            lines::gather_rows(simd, &particles.inverse_mass, inverse_mass, rows, first);
            let lambda = multipliers(&mut self.weft_lambda, block, first);
            lines::soften(simd, block, moved, inverse_mass, lambda, elimination);
            scatter(simd, moved, &mut particles.moved, rows, first);
            inertia.fill(0.0);
            lines::record_load(simd, block, lambda, STATIC_LOAD.recip(), inertia);
            lines::scatter_rows(simd, inertia, &mut particles.load, rows, first);
        }
        if let Some(patch) = &self.patch {
            let spacing = self.grid.spacing.x;
            patch.soften(simd, Along::Weft, particles, spacing, STATIC_LOAD.recip(), &mut self.work);
        }
    }

    #[inline(always)]
    fn soften_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles) {
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let block = self.column_block(base);
            let lambda = multipliers(&mut self.warp_lambda, block, base);
            let Particles { moved, inverse_mass, load: inertia, .. } = &mut *particles;
            lines::soften(simd, block, moved, inverse_mass, lambda, &mut self.work.elimination);
            lines::record_load(simd, block, lambda, STATIC_LOAD.recip(), inertia);
        }
        if let Some(patch) = &self.patch {
            let spacing = self.grid.spacing.y;
            patch.soften(simd, Along::Warp, particles, spacing, STATIC_LOAD.recip(), &mut self.work);
        }
    }

    /// Bending and stretch along the weft.
    #[inline(always)]
    fn solve_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles, stiffness: Stiffness) -> f32 {
        let mut largest = splat(simd, 0.0);
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            self.work.gather_rows(simd, particles, rows, first);
            let compliance = compliance(simd, stiffness, &self.row_width, first);
            let worn = worn(&self.worn, Along::Weft, first, block);
            let lambda = multipliers(&mut self.weft_lambda, block, first);
            let Work { position, moved, inverse_mass, elimination, .. } = &mut self.work;
            let load_ratio =
                lines::solve(simd, block, position, moved, inverse_mass, compliance, worn, lambda, elimination);
            largest = largest.max(load_ratio);
            scatter(simd, moved, &mut particles.moved, rows, first);
        }
        largest.reduce_max()
    }

    /// Bending and stretch along the warp.
    #[inline(always)]
    fn solve_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, stiffness: Stiffness) -> f32 {
        let mut largest = splat(simd, 0.0);
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let block = self.column_block(base);
            let compliance = compliance(simd, stiffness, &self.column_width, base);
            let worn = worn(&self.worn, Along::Warp, base, block);
            let lambda = multipliers(&mut self.warp_lambda, block, base);
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let work = &mut self.work.elimination;
            let load_ratio = lines::solve(simd, block, position, moved, inverse_mass, compliance, worn, lambda, work);
            largest = largest.max(load_ratio);
        }
        largest.reduce_max()
    }
}

/// The load of the largest lane.
#[inline(always)]
pub(in super::super) fn largest<S: Simd>(load: f32x8<S>) -> f32 {
    load.reduce_max()
}
