//! Cells and bending as forces, then rows and columns exactly, in passes.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::{GridConstraints, RowLanes, Stiffness, column_block, gather, is_block, row_block, scatter, worn};
use crate::constraint::kernel::cells::{CellForces, CellModel, ShearModel};
use crate::constraint::kernel::lines::{self, Met};
use crate::constraint::kernel::links::{Block, New, Worn};
use crate::constraint::kernel::shear::Sheet;
use crate::lanes::{LANES, load, splat};
use crate::tick::{Effort, Substep};
use crate::topology::Along;
use crate::{Fabric, Particles};

/// The largest T h²/(m l) that a substep may have: half of that for which [`lines::filter`] is made, since in crumpled cloth the waves
/// of shear and bending add to those of tension.
const LARGEST_LOAD: f32 = 0.5;

impl GridConstraints {
    /// Once in a substep.
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) -> Effort {
        self.push_cells(simd, particles, sub);
        let mut stiffness = [self.stiffness(Along::Weft, sub), self.stiffness(Along::Warp, sub)];
        // All forces before any row or column is solved exactly: what pushes after the rows, these would answer only in the next substep,
        // and a pull that comes late feeds a swing.
        self.bend_columns(simd, particles, stiffness[1]);
        if let Some(patch) = &mut self.patch {
            for along in [Along::Weft, Along::Warp] {
                patch.bend(simd, along, particles, stiffness[along as usize], &mut self.work);
            }
        }
        let rows = self.solve_rows::<S, true>(simd, particles, stiffness[0]);
        let columns = self.solve_columns::<S, true>(simd, particles, stiffness[1]);
        let loads = [rows, columns].map(|met| met.load.reduce_max());
        let mut met = rows.and(columns);
        let links = [self.grid.rows * (self.grid.columns - 1), self.grid.columns * (self.grid.rows - 1)];
        let mean_load = rows.mean_load(links[0] as usize).max(columns.mean_load(links[1] as usize));
        if loads[0] > lines::UNFILTERED_LOAD {
            self.filter_rows(simd, particles, sub.square());
        }
        if loads[1] > lines::UNFILTERED_LOAD {
            self.filter_columns(simd, particles, sub.square());
        }
        let (load, turned) = (met.load.reduce_max(), met.turned.reduce_max() > 0.0);
        self.passes.begin(sub, met.change.reduce_max());
        while self.passes.is_due() {
            for stiffness in &mut stiffness {
                stiffness.how = self.passes.how(sub);
            }
            let rows = self.solve_rows::<S, false>(simd, particles, stiffness[0]);
            met = rows.and(self.solve_columns::<S, false>(simd, particles, stiffness[1]));
            // What this pass over the rows moved is what the columns before had left.
            self.passes.done(rows.left.reduce_max(), met.shift.reduce_max());
        }
        if let Some(how) = self.passes.last(sub, met.change.reduce_max()) {
            self.solve_rows::<S, false>(simd, particles, Stiffness { how, ..stiffness[0] });
        }
        Effort { load: load / LARGEST_LOAD, mean_load, motion: met.change.reduce_max().sqrt(), turned }
    }

    /// Shear and twist, and whatever is no thread.
    #[inline(always)]
    fn push_cells<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) {
        let Fabric { areal_density, .. } = self.fabric;
        let shear = self.shear(sub);
        if shear > 0.0 {
            let sheet = Sheet { grid: &self.grid, mask: &self.cell_mask, shear, density: areal_density };
            self.stress.find(simd, sheet, &particles.position, &particles.inverse_mass, sub.longest);
        }
        let forces = CellForces {
            grid: &self.grid,
            mask: &self.cell_mask,
            stress: if shear > 0.0 { Some(&self.stress.lambda) } else { None },
            twist: self.twist(sub),
            share: sub.share(),
        };
        if shear > 0.0 || forces.twist > 0.0 {
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            forces.push(simd, position, inverse_mass, moved, &mut self.cell_rows);
        }
        if self.patch.is_some() {
            let longest = sub.longest * sub.longest;
            let shears =
                if shear > 0.0 { ShearModel::Constraint(self.shear_compliance(longest)) } else { ShearModel::None };
            let model = CellModel { shear: shears, twist: self.twist_compliance(longest) };
            if let Some(patch) = &mut self.patch {
                patch.push_loose(simd, particles, &self.grid, model, sub);
            }
        }
    }

    /// Bending of the columns.
    #[inline(always)]
    fn bend_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, stiffness: Stiffness) {
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let (block, width) = (column_block(&self.grid, base), load(simd, &self.column_width, base));
            let Some(bend) = stiffness.bend(simd, width) else { return };
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let elimination = &mut self.rows.elimination;
            match worn(&self.worn, Along::Warp, base, block) {
                None => lines::bend(simd, block, position, moved, inverse_mass, bend, New, elimination),
                Some(worn) => lines::bend(simd, block, position, moved, inverse_mass, bend, worn, elimination),
            }
        }
    }

    /// A pass along the weft; the first one after bending.
    #[inline(always)]
    fn solve_rows<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        stiffness: Stiffness,
    ) -> Met<S> {
        let mut met = Met::nothing(simd);
        let rows = self.row_lanes();
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            let (block, width) = (row_block(&self.grid, first), load(simd, &self.row_width, first));
            let RowLanes { position, moved, inverse_mass, .. } = &mut self.rows;
            if FIRST {
                gather(simd, &particles.position, position, block.base, rows, first);
                lines::gather_rows(simd, &particles.inverse_mass, inverse_mass, block.base, rows, first);
            }
            gather(simd, &particles.moved, moved, block.base, rows, first);
            let worn = worn(&self.worn, Along::Weft, first, block);
            let RowLanes { position, moved, inverse_mass, elimination } = &mut self.rows;
            if FIRST && let Some(bend) = stiffness.bend(simd, width) {
                match worn {
                    None => lines::bend(simd, block, position, moved, inverse_mass, bend, New, elimination),
                    Some(worn) => lines::bend(simd, block, position, moved, inverse_mass, bend, worn, elimination),
                }
            }
            let on = On { block, position, moved, inverse_mass };
            met = met.and(on.stretch::<S, FIRST>(simd, stiffness, width, worn, &mut self.weft));
            scatter(simd, moved, block.base, &mut particles.moved, rows, first);
        }
        match &mut self.patch {
            Some(patch) => met.and(patch.solve::<S, FIRST>(simd, Along::Weft, particles, stiffness, &mut self.work)),
            None => met,
        }
    }

    /// A pass along the warp.
    #[inline(always)]
    fn solve_columns<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        stiffness: Stiffness,
    ) -> Met<S> {
        let mut met = Met::nothing(simd);
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if !is_block(&self.patch, Along::Warp, base) {
                continue;
            }
            let (block, width) = (column_block(&self.grid, base), load(simd, &self.column_width, base));
            let worn = worn(&self.worn, Along::Warp, base, block);
            let Particles { position, moved, inverse_mass, .. } = &mut *particles;
            let on = On { block, position, moved, inverse_mass };
            met = met.and(on.stretch::<S, FIRST>(simd, stiffness, width, worn, &mut self.warp));
        }
        match &mut self.patch {
            Some(patch) => met.and(patch.solve::<S, FIRST>(simd, Along::Warp, particles, stiffness, &mut self.work)),
            None => met,
        }
    }

    #[inline(always)]
    fn filter_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles, square: f32) {
        let rows = self.row_lanes();
        for first in (0..rows.rows).step_by(LANES).filter(|first| is_block(&self.patch, Along::Weft, *first)) {
            let block = row_block(&self.grid, first);
            let RowLanes { position, moved, inverse_mass, elimination } = &mut self.rows;
            gather(simd, &particles.moved, moved, block.base, rows, first);
            lines::filter::<S, false>(simd, block, position, moved, inverse_mass, &mut self.weft, elimination, square);
            scatter(simd, moved, block.base, &mut particles.moved, rows, first);
        }
        if let Some(patch) = &mut self.patch {
            patch.filter(simd, Along::Weft, particles, self.grid.spacing.x, &mut self.work, square);
        }
    }

    #[inline(always)]
    fn filter_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, square: f32) {
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            if is_block(&self.patch, Along::Warp, base) {
                let Particles { position, moved, inverse_mass, .. } = &mut *particles;
                let block = column_block(&self.grid, base);
                lines::filter::<S, false>(
                    simd,
                    block,
                    position,
                    moved,
                    inverse_mass,
                    &mut self.warp,
                    &mut self.rows.elimination,
                    square,
                );
            }
        }
        if let Some(patch) = &mut self.patch {
            patch.filter(simd, Along::Warp, particles, self.grid.spacing.y, &mut self.work, square);
        }
    }
}

/// What a pass works on.
struct On<'a> {
    block: Block,
    position: &'a crate::Soa3,
    moved: &'a mut crate::Soa3,
    inverse_mass: &'a [f32],
}

impl On<'_> {
    #[inline(always)]
    fn stretch<S: Simd, const FIRST: bool>(
        self,
        simd: S,
        stiffness: Stiffness,
        width: f32x8<S>,
        worn: Option<Worn<'_>>,
        links: &mut lines::Links8,
    ) -> Met<S> {
        let Self { block, position, moved, inverse_mass } = self;
        let compliance = (splat(simd, stiffness.stretch) / width, stiffness.how);
        match worn {
            None => {
                lines::stretch::<S, _, FIRST, false>(simd, block, position, moved, inverse_mass, compliance, New, links)
            }
            Some(worn) => lines::stretch::<S, _, FIRST, false>(
                simd,
                block,
                position,
                moved,
                inverse_mass,
                compliance,
                worn,
                links,
            ),
        }
    }
}
