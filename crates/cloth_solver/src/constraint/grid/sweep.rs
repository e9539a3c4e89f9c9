//! Cells, rows and columns in colours.

use fearless_simd::Simd;

use super::super::cells::{CellModel, ShearModel};
use super::super::listed::Work;
use super::super::sweep::{self, Compliance};
use super::{GridConstraints, Stiffness, compliance, is_block, scatter, worn};
use crate::Particles;
use crate::lanes::LANES;
use crate::topology::Along;

/// How a grid is swept.
#[derive(Clone, Copy, Debug)]
pub(in super::super) enum Sweep {
    /// With the fabric's compliance, in a substep of length `h`, s.
    Compliant { h: f32 },
    /// Without any: distances to neighbours, right angles, and distances to the neighbours but one against bending.
    Rigid,
}

impl GridConstraints {
    /// Swept in colours: of XPBD once, of PBD, which knows no compliance, as often as asked.
    #[inline(always)]
    pub fn sweep<S: Simd>(&mut self, simd: S, particles: &mut Particles, how: Sweep) {
        let shears = self.fabric.shear > 0.0;
        let (model, weft, warp) = match how {
            Sweep::Compliant { h } => {
                let shear = if shears { ShearModel::Constraint(self.shear_compliance(h)) } else { ShearModel::None };
                let model = CellModel { shear, twist: self.twist_compliance(h) };
                (model, Some(self.stiffness(Along::Weft, h)), Some(self.stiffness(Along::Warp, h)))
            }
            // Not quite 0, for which cells that are all pinned or not there would have no solution.
            Sweep::Rigid => {
                let shear = if shears { ShearModel::Constraint(1e-20) } else { ShearModel::None };
                (CellModel { shear, twist: None }, None, None)
            }
        };
        self.solve_cells(simd, particles, model);
        if let Some(patch) = &mut self.patch {
            let h = if let Sweep::Compliant { h } = how { h } else { f32::MAX.sqrt() };
            patch.solve_loose(simd, particles, &self.grid, model, h);
        }
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            self.work.gather_rows(simd, particles, rows, first);
            let worn = worn(&self.worn, Along::Weft, first, block);
            let compliance = wide(simd, weft, &self.row_width, first);
            let Work { position, moved, inverse_mass, .. } = &mut self.work;
            sweep::block(simd, block, position, moved, inverse_mass, compliance, worn);
            scatter(simd, &self.work.moved, &mut particles.moved, rows, first);
        }
        if let Some(patch) = &mut self.patch {
            patch.sweep(simd, Along::Weft, particles, weft, self.grid.spacing.x, &mut self.work);
        }
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let block = self.column_block(base);
            let worn = worn(&self.worn, Along::Warp, base, block);
            let compliance = wide(simd, warp, &self.column_width, base);
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            sweep::block(simd, block, position, moved, inverse_mass, compliance, worn);
        }
        if let Some(patch) = &mut self.patch {
            patch.sweep(simd, Along::Warp, particles, warp, self.grid.spacing.y, &mut self.work);
        }
    }
}

/// α̃ of eight runs, if they give.
#[inline(always)]
fn wide<S: Simd>(simd: S, stiffness: Option<Stiffness>, width: &[f32], first: usize) -> Option<Compliance<S>> {
    #[expect(clippy::manual_map, reason = "a closure would lack the dispatched instruction set")]
    match stiffness {
        Some(stiffness) => Some(compliance(simd, stiffness, width, first)),
        None => None,
    }
}
