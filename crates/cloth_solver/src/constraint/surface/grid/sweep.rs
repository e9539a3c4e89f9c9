//! Cells, rows and columns in colours.

use fearless_simd::Simd;

use super::{GridConstraints, RowLanes, Stiffness, column_block, gather, is_block, row_block, scatter, worn};
use crate::Particles;
use crate::constraint::kernel::cells::{CellModel, ShearModel};
use crate::constraint::kernel::lines;
use crate::constraint::kernel::sweep::{self, Compliance};
use crate::lanes::{LANES, load};
use crate::tick::Substep;
use crate::topology::Along;

/// How a grid is swept.
#[derive(Clone, Copy, Debug)]
pub(in crate::constraint) enum Sweep {
    /// With the fabric's compliance, in that substep.
    Compliant(Substep),
    /// Without any: distances to neighbours, right angles, and distances to the neighbours but one against bending.
    Rigid,
}

impl GridConstraints {
    /// Swept in colours: of XPBD once, of PBD, which knows no compliance, as often as asked.
    #[inline(always)]
    pub fn sweep<S: Simd>(&mut self, simd: S, particles: &mut Particles, how: Sweep) {
        let shears = self.fabric.shear > 0.0;
        let (model, weft, warp) = match how {
            Sweep::Compliant(sub) => {
                let square = sub.square();
                let shear =
                    if shears { ShearModel::Constraint(self.shear_compliance(square)) } else { ShearModel::None };
                let model = CellModel { shear, twist: self.twist_compliance(square) };
                (model, Some(self.stiffness(Along::Weft, &sub)), Some(self.stiffness(Along::Warp, &sub)))
            }
            // Not quite 0, for which cells that are all pinned or not there would have no solution.
            Sweep::Rigid => {
                let shear = if shears { ShearModel::Constraint(1e-20) } else { ShearModel::None };
                (CellModel { shear, twist: None }, None, None)
            }
        };
        self.solve_cells(simd, particles, model);
        if let Some(patch) = &mut self.patch {
            let square = if let Sweep::Compliant(sub) = how { sub.square() } else { f32::MAX };
            patch.solve_loose(simd, particles, &self.grid, model, square);
        }
        let rows = self.row_lanes();
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            let block = row_block(&self.grid, first);
            let RowLanes { position, moved, inverse_mass, .. } = &mut self.rows;
            gather(simd, &particles.position, position, block.base, rows, first);
            gather(simd, &particles.moved, moved, block.base, rows, first);
            lines::gather_rows(simd, &particles.inverse_mass, inverse_mass, block.base, rows, first);
            let worn = worn(&self.worn, Along::Weft, first, block);
            let compliance = wide(simd, weft, &self.row_width, first);
            sweep::block(simd, block, position, moved, inverse_mass, compliance, worn);
            scatter(simd, moved, block.base, &mut particles.moved, rows, first);
        }
        if let Some(patch) = &mut self.patch {
            patch.sweep(simd, Along::Weft, particles, weft, self.grid.spacing.x, &mut self.work);
        }
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let block = column_block(&self.grid, base);
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
        Some(stiffness) => {
            let (width, one) = (load(simd, width, first), stiffness.of_one_spacing(simd));
            let bend = match one.bend {
                Some(bend) => Some(bend / width),
                None => None,
            };
            Some(Compliance { stretch: one.stretch / width, bend })
        }
        None => None,
    }
}
