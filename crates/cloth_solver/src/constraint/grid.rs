//! The constraints of a grid: cells, then rows, then columns.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::cells::{CellModel, Cells, ShearModel};
use super::lines::{self, Block, Elimination, Rows};
use super::removed::{Along, Gone, Removed};
use super::shear::{Sheet, Stress};
use super::sweep;
use crate::lanes::{LANES, load, splat};
use crate::{Fabric, Grid, Particles, Soa3, Topology};

/// T h²/(m l) that a particle under a lasting load is given the inertia for. Warp and weft are solved one after the other,
/// so where both carry much they leave a strain of this order times the ratio of their loads' change over an edge.
const STATIC_LOAD: f32 = 0.25;

// A particle that has the inertia its load asks for must still count as loaded, or it would lose it again.
const _: () = assert!(STATIC_LOAD > lines::EXPLICIT_LOAD);

/// What keeps a rectangle of fabric together, and the working memory to solve it.
#[derive(Clone, Debug)]
pub(super) struct GridConstraints {
    pub grid: Grid,
    pub fabric: Fabric,
    cell_mask: Vec<f32>,
    removed: Option<Box<Removed>>,
    /// 1 inside, ½ for the outermost rows and columns, which stand for half the width; per row and per column slot.
    pub row_width: Vec<f32>,
    pub column_width: Vec<f32>,
    rows_position: Soa3,
    rows_inverse_mass: Vec<f32>,
    rows_moved: Soa3,
    rows_load: Vec<f32>,
    /// Multipliers of the links of each block of eight rows or columns.
    weft_lambda: Vec<f32>,
    warp_lambda: Vec<f32>,
    elimination: Elimination,
    stress: Stress,
}

impl GridConstraints {
    pub fn new(grid: Grid, topology: &Topology, fabric: &Fabric) -> Self {
        let (columns, rows, stride) = (grid.columns as usize, grid.rows as usize, grid.stride as usize);
        let mut cell_mask = vec![0.0; topology.slots()];
        for row in 0..rows - 1 {
            cell_mask[row * stride..row * stride + columns - 1].fill(1.0);
        }
        let widths = |count: usize, padded: usize| {
            let mut width = vec![1.0; padded];
            width[0] = 0.5;
            width[count - 1] = 0.5;
            width
        };
        Self {
            grid,
            fabric: *fabric,
            cell_mask,
            removed: None,
            row_width: widths(rows, rows.next_multiple_of(LANES)),
            column_width: widths(columns, stride),
            rows_position: Soa3::zeros(stride * LANES),
            rows_inverse_mass: vec![0.0; stride * LANES],
            rows_moved: Soa3::zeros(stride * LANES),
            rows_load: vec![0.0; stride * LANES],
            weft_lambda: vec![0.0; rows.next_multiple_of(LANES) * columns],
            warp_lambda: vec![0.0; stride * rows],
            elimination: Elimination::new(rows.max(columns)),
            stress: Stress::new(&grid),
        }
    }

    pub fn count(&self) -> usize {
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        let cells = (columns - 1) * (rows - 1);
        let mut count = columns * (rows - 1) + rows * (columns - 1);
        count += if self.fabric.shear > 0.0 { cells } else { 0 };
        count += if self.twist_stiffness() > 0.0 { cells } else { 0 };
        let (links, [bends_weft, bends_warp]) = self.removed.as_ref().map_or((0, [0; 2]), |removed| removed.count());
        count += if self.fabric.bend_warp > 0.0 { columns * (rows - 2) - bends_warp } else { 0 };
        count += if self.fabric.bend_weft > 0.0 { rows * (columns - 2) - bends_weft } else { 0 };
        count - links
    }

    /// Removes the link between two slots, and the bends over it; `false` if there is none.
    pub fn remove_link(&mut self, a: u32, b: u32) -> bool {
        let grid = self.grid;
        self.removed.get_or_insert_with(|| Box::new(Removed::new(&grid))).remove(&grid, a, b)
    }

    /// Whether link `k` of run `run`, of `count` particles, is gone.
    pub fn is_gone(&self, along: Along, run: usize, count: usize, k: usize) -> bool {
        self.removed.as_ref().is_some_and(|removed| removed.is_gone(along, run, count, k))
    }

    /// Root mean square of what the last substep, of length `h`, left of `C + α̃ λ` in the links along warp and weft, in
    /// rest lengths.
    pub fn residual(&self, particles: &Particles, h: f32) -> f32 {
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        let compliance = |along: f32, across: f32, stiffness: f32| along / (stiffness * across * h * h);
        let weft = compliance(a, b, self.fabric.stretch_weft);
        let warp = compliance(b, a, self.fabric.stretch_warp);
        let at = |row: usize, column: usize| particles.position.get(row * self.grid.stride as usize + column);
        // The multiplier of link k of run `run`: blocks of eight runs, eight lanes per link.
        let lambda =
            |of: &[f32], run: usize, count: usize, k: usize| of[(run / LANES * count + k) * LANES + run % LANES];
        let mut sum = 0.0_f64;
        let mut add = |length: f32, rest: f32, slack: f32| sum += f64::from((length - rest + slack) / rest).powi(2);
        for row in 0..rows {
            for k in (0..columns - 1).filter(|k| !self.is_gone(Along::Weft, row, columns, *k)) {
                let slack = weft / self.row_width[row] * lambda(&self.weft_lambda, row, columns, k);
                add(at(row, k).distance(at(row, k + 1)), a, slack);
            }
        }
        for column in 0..columns {
            for k in (0..rows - 1).filter(|k| !self.is_gone(Along::Warp, column, rows, *k)) {
                let slack = warp / self.column_width[column] * lambda(&self.warp_lambda, column, rows, k);
                add(at(k, column).distance(at(k + 1, column)), b, slack);
            }
        }
        let gone = self.removed.as_ref().map_or(0, |removed| removed.count().0);
        (sum / (rows * (columns - 1) + columns * (rows - 1) - gone) as f64).sqrt() as f32
    }

    /// Bending stiffness against twist, N·m: the mean of warp and weft.
    fn twist_stiffness(&self) -> f32 {
        0.5 * (self.fabric.bend_warp + self.fabric.bend_weft)
    }

    /// Swept in colours: of XPBD once, of PBD, which knows no compliance, as often as asked.
    #[inline(always)]
    pub fn sweep<S: Simd>(&mut self, simd: S, particles: &mut Particles, how: Sweep) {
        let shears = self.fabric.shear > 0.0;
        let model = match how {
            Sweep::Compliant { h } => {
                let compliance = 1.0 / (self.fabric.shear * h * h * self.grid.spacing.x * self.grid.spacing.y);
                let shear = if shears { ShearModel::Constraint(compliance) } else { ShearModel::None };
                CellModel { shear, twist: self.twist_compliance(h) }
            }
            // Not quite 0, for which cells that are all pinned or not there would have no solution.
            Sweep::Rigid => {
                CellModel { shear: if shears { ShearModel::Constraint(1e-20) } else { ShearModel::None }, twist: None }
            }
        };
        self.solve_cells(simd, particles, model);
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES) {
            gather(simd, &particles.position, &mut self.rows_position, rows, first);
            gather(simd, &particles.moved, &mut self.rows_moved, rows, first);
            lines::gather_rows(simd, &particles.inverse_mass, &mut self.rows_inverse_mass, rows, first);
            let bends = self.fabric.bend_weft > 0.0;
            let compliance = match how {
                Sweep::Rigid => None,
                Sweep::Compliant { h } => Some(Compliance {
                    stretch: self.stretch_weft_compliance(simd, first, h),
                    bend: if bends { Some(self.bend_weft_compliance(simd, first, h)) } else { None },
                }),
            };
            let gone = gone(&self.removed, Along::Weft, first, block);
            let (x, moved, w) = (&self.rows_position, &mut self.rows_moved, &self.rows_inverse_mass);
            sweep_block(simd, block, x, moved, w, compliance, gone);
            scatter(simd, moved, &mut particles.moved, rows, first);
        }
        let Particles { position, moved, inverse_mass, .. } = particles;
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            let bends = self.fabric.bend_warp > 0.0;
            let compliance = match how {
                Sweep::Rigid => None,
                Sweep::Compliant { h } => Some(Compliance {
                    stretch: self.stretch_warp_compliance(simd, base, h),
                    bend: if bends { Some(self.bend_warp_compliance(simd, base, h)) } else { None },
                }),
            };
            let block = self.column_block(base);
            let gone = gone(&self.removed, Along::Warp, base, block);
            sweep_block(simd, block, position, moved, inverse_mass, compliance, gone);
        }
    }

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
        let weft = self.solve_rows(simd, particles, h);
        let warp = self.solve_columns(simd, particles, h);
        if weft > lines::EXPLICIT_LOAD {
            self.soften_rows(simd, particles);
        }
        if warp > lines::EXPLICIT_LOAD {
            self.soften_columns(simd, particles);
        }
    }

    #[inline(always)]
    fn soften_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles) {
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES) {
            gather(simd, &particles.moved, &mut self.rows_moved, rows, first);
            lines::gather_rows(simd, &particles.inverse_mass, &mut self.rows_inverse_mass, rows, first);
            let lambda = links(&mut self.weft_lambda, block, first);
            let (moved, w) = (&mut self.rows_moved, &self.rows_inverse_mass);
            lines::soften(simd, block, moved, w, lambda, &mut self.elimination);
            scatter(simd, moved, &mut particles.moved, rows, first);
            self.rows_load.fill(0.0);
            lines::record_load(simd, block, lambda, STATIC_LOAD.recip(), &mut self.rows_load);
            lines::scatter_rows(simd, &self.rows_load, &mut particles.load, rows, first);
        }
    }

    #[inline(always)]
    fn soften_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles) {
        let Particles { moved, inverse_mass, load: inertia, .. } = particles;
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            let block = self.column_block(base);
            let lambda = links(&mut self.warp_lambda, block, base);
            lines::soften(simd, block, moved, inverse_mass, lambda, &mut self.elimination);
            lines::record_load(simd, block, lambda, STATIC_LOAD.recip(), inertia);
        }
    }

    #[inline(always)]
    fn solve_cells<S: Simd>(&self, simd: S, particles: &mut Particles, model: CellModel<'_>) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        if !matches!(model.shear, ShearModel::None) || model.twist.is_some() {
            Cells { grid: &self.grid, mask: &self.cell_mask, inverse_mass, model }.solve(simd, position, moved);
        }
    }

    /// α̃ of the cells against twist, if the fabric resists it.
    fn twist_compliance(&self, h: f32) -> Option<f32> {
        let twist = self.twist_stiffness() * h * h;
        (twist > 0.0).then(|| self.grid.spacing.x * self.grid.spacing.y / (2.0 * twist))
    }

    fn rows(&self) -> Rows {
        Rows { rows: self.grid.rows as usize, stride: self.grid.stride as usize }
    }

    fn row_block(&self) -> Block {
        Block { base: 0, stride: LANES, count: self.grid.columns as usize, spacing: self.grid.spacing.x }
    }

    fn column_block(&self, base: usize) -> Block {
        let (stride, count) = (self.grid.stride as usize, self.grid.rows as usize);
        Block { base, stride, count, spacing: self.grid.spacing.y }
    }

    /// l/(Y width h²), for eight rows.
    #[inline(always)]
    fn stretch_weft_compliance<S: Simd>(&self, simd: S, first: usize, h: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, a / (self.fabric.stretch_weft * b * h * h)) / load(simd, &self.row_width, first)
    }

    /// l/(Y width h²), for eight columns.
    #[inline(always)]
    fn stretch_warp_compliance<S: Simd>(&self, simd: S, base: usize, h: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, b / (self.fabric.stretch_warp * a * h * h)) / load(simd, &self.column_width, base)
    }

    /// l³/(D width h²), for eight rows.
    #[inline(always)]
    fn bend_weft_compliance<S: Simd>(&self, simd: S, first: usize, h: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, a * a * a / (self.fabric.bend_weft * b * h * h)) / load(simd, &self.row_width, first)
    }

    /// l³/(D width h²), for eight columns.
    #[inline(always)]
    fn bend_warp_compliance<S: Simd>(&self, simd: S, base: usize, h: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, b * b * b / (self.fabric.bend_warp * a * h * h)) / load(simd, &self.column_width, base)
    }

    /// Bending and stretch along the weft.
    #[inline(always)]
    fn solve_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) -> f32 {
        let mut largest = splat(simd, 0.0);
        let (rows, block) = (self.rows(), self.row_block());
        for first in (0..rows.rows).step_by(LANES) {
            gather(simd, &particles.position, &mut self.rows_position, rows, first);
            gather(simd, &particles.moved, &mut self.rows_moved, rows, first);
            lines::gather_rows(simd, &particles.inverse_mass, &mut self.rows_inverse_mass, rows, first);
            let stretch = self.stretch_weft_compliance(simd, first, h);
            let bend = (self.fabric.bend_weft > 0.0).then(|| self.bend_weft_compliance(simd, first, h));
            let (x, moved, w) = (&self.rows_position, &mut self.rows_moved, &self.rows_inverse_mass);
            let gone = gone(&self.removed, Along::Weft, first, block);
            if let Some(compliance) = bend {
                lines::bend(simd, block, x, moved, w, compliance, gone, &mut self.elimination);
            }
            let lambda = links(&mut self.weft_lambda, block, first);
            let load_ratio = lines::stretch(simd, block, x, moved, w, stretch, gone, lambda, &mut self.elimination);
            largest = largest.max(load_ratio);
            scatter(simd, moved, &mut particles.moved, rows, first);
        }
        largest.reduce_max()
    }

    /// Bending and stretch along the warp.
    #[inline(always)]
    fn solve_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) -> f32 {
        let mut largest = splat(simd, 0.0);
        let Particles { position, moved, inverse_mass, .. } = particles;
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            let block = self.column_block(base);
            let gone = gone(&self.removed, Along::Warp, base, block);
            let bend = self.bend_warp_compliance(simd, base, h);
            let stretch = self.stretch_warp_compliance(simd, base, h);
            let (lambda, work) = (links(&mut self.warp_lambda, block, base), &mut self.elimination);
            if self.fabric.bend_warp > 0.0 {
                lines::bend(simd, block, position, moved, inverse_mass, bend, gone, work);
            }
            let load_ratio = lines::stretch(simd, block, position, moved, inverse_mass, stretch, gone, lambda, work);
            largest = largest.max(load_ratio);
        }
        largest.reduce_max()
    }
}

/// What is removed of the links along `along` of the block that starts with run `first`.
fn gone(removed: &Option<Box<Removed>>, along: Along, first: usize, block: Block) -> Gone<'_> {
    removed.as_ref().map_or(Gone::NONE, |removed| removed.block(along, first, block))
}

/// How a grid is swept.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sweep {
    /// With the fabric's compliance, in a substep of length `h`, s.
    Compliant { h: f32 },
    /// Without any: distances to neighbours, right angles, and distances to the neighbours but one against bending.
    Rigid,
}

/// α̃ of eight runs; no bending if the fabric does not resist it.
struct Compliance<S: Simd> {
    stretch: f32x8<S>,
    bend: Option<f32x8<S>>,
}

/// Sweeps eight runs, rigidly without compliance.
#[inline(always)]
fn sweep_block<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: Option<Compliance<S>>,
    gone: Gone<'_>,
) {
    match compliance {
        Some(Compliance { stretch, bend }) => {
            if let Some(bend) = bend {
                sweep::bend(simd, block, position, moved, inverse_mass, bend, gone);
            }
            sweep::stretch(simd, block, position, moved, inverse_mass, stretch, gone);
        }
        None => {
            let rigid = splat(simd, 0.0);
            for from in 0..2 {
                let (block, gone) = (block.every_second(from), gone.every_second(from));
                if block.count > 1 {
                    sweep::stretch(simd, block, position, moved, inverse_mass, rigid, gone);
                }
            }
            sweep::stretch(simd, block, position, moved, inverse_mass, rigid, gone);
        }
    }
}

/// Eight rows of vectors into lanes.
#[inline(always)]
fn gather<S: Simd>(simd: S, from: &Soa3, to: &mut Soa3, rows: Rows, first: usize) {
    lines::gather_rows(simd, &from.x, &mut to.x, rows, first);
    lines::gather_rows(simd, &from.y, &mut to.y, rows, first);
    lines::gather_rows(simd, &from.z, &mut to.z, rows, first);
}

/// Eight rows of vectors back from lanes.
#[inline(always)]
fn scatter<S: Simd>(simd: S, from: &Soa3, to: &mut Soa3, rows: Rows, first: usize) {
    lines::scatter_rows(simd, &from.x, &mut to.x, rows, first);
    lines::scatter_rows(simd, &from.y, &mut to.y, rows, first);
    lines::scatter_rows(simd, &from.z, &mut to.z, rows, first);
}

/// The multipliers of the block that starts with row or column `first`.
fn links(lambda: &mut [f32], block: Block, first: usize) -> &mut [f32] {
    &mut lambda[first * block.count..(first + LANES) * block.count]
}
