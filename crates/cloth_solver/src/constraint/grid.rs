//! The constraints of a grid: cells, then rows, then columns.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::cells::{CellModel, Cells};
use super::lines::{self, Block, Elimination, Rows};
use crate::lanes::{LANES, load, splat, store};
use crate::{Fabric, Grid, Particles, Soa3, Topology};

/// The largest T h²/(m l) at which exactly solved lines are run, T summed over warp and weft. Their transverse waves are
/// explicit and have at most ω² = 4 T/(m l), so h ω < 2 asks for less than 1; the tension used is one substep old and
/// doubles from one to the next in an impact, which takes the rest.
const STABLE_LOAD: f32 = 0.25;

/// What keeps a rectangle of fabric together, and the working memory to solve it.
#[derive(Clone, Debug)]
pub(super) struct GridConstraints {
    grid: Grid,
    pub fabric: Fabric,
    cell_mask: Vec<f32>,
    /// 1 inside, ½ for the outermost rows and columns, which stand for half the width; per row and per column slot.
    row_width: Vec<f32>,
    column_width: Vec<f32>,
    rows_vector: Soa3,
    rows_inverse_mass: Vec<f32>,
    rows_load: Vec<f32>,
    elimination: Elimination,
    /// Tension over length of the lines through each particle in the last substep, N/m.
    load: Vec<f32>,
    /// Whether any particle has more inertia than mass.
    scaled: bool,
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
            row_width: widths(rows, rows.next_multiple_of(LANES)),
            column_width: widths(columns, stride),
            rows_vector: Soa3::zeros(stride * LANES),
            rows_inverse_mass: vec![0.0; stride * LANES],
            rows_load: vec![0.0; stride * LANES],
            load: vec![0.0; topology.slots()],
            scaled: false,
            elimination: Elimination::new(rows.max(columns)),
        }
    }

    pub fn count(&self) -> usize {
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        let cells = (columns - 1) * (rows - 1);
        let mut count = columns * (rows - 1) + rows * (columns - 1);
        count += if self.fabric.shear > 0.0 { cells } else { 0 };
        count += if self.twist_stiffness() > 0.0 { cells } else { 0 };
        count += if self.fabric.bend_warp > 0.0 { columns * (rows - 2) } else { 0 };
        count + if self.fabric.bend_weft > 0.0 { rows * (columns - 2) } else { 0 }
    }

    /// Bending stiffness against twist, N·m: the mean of warp and weft.
    fn twist_stiffness(&self) -> f32 {
        0.5 * (self.fabric.bend_warp + self.fabric.bend_weft)
    }

    /// Returns whether inverse masses were written, those of pinned particles among them.
    #[inline(always)]
    pub fn scale_masses<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) -> bool {
        let scale = splat(simd, h * h / STABLE_LOAD);
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let groups = || (0..self.load.len() / LANES).map(|group| group * LANES);
        let mut excess = splat(simd, f32::NEG_INFINITY);
        for i in groups() {
            excess = excess.max(load(simd, &self.load, i) * scale - load(simd, &particles.mass, i));
        }
        let overloaded = excess.reduce_max() > 0.0;
        if !overloaded && !self.scaled {
            return false;
        }
        for i in groups() {
            let mass = load(simd, &particles.mass, i);
            let w = one / mass.max(load(simd, &self.load, i) * scale);
            store(mass.simd_gt(zero).select(w, zero), &mut particles.inverse_mass, i);
        }
        self.scaled = overloaded;
        true
    }

    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        self.load.fill(0.0);
        self.solve_cells(simd, particles, h);
        self.solve_rows(simd, particles, h);
        self.solve_columns(simd, particles, h);
    }

    #[inline(always)]
    fn solve_cells<S: Simd>(&self, simd: S, particles: &mut Particles, h: f32) {
        let Particles { position, inverse_mass, .. } = particles;
        let model = self.cell_model(h * h);
        if model.shear.is_some() || model.twist.is_some() {
            Cells { grid: &self.grid, mask: &self.cell_mask, inverse_mass, model }.solve(simd, position);
        }
    }

    /// Compliance of a cell against `scale` times its stiffness.
    fn cell_model(&self, scale: f32) -> CellModel {
        let area = self.grid.spacing.x * self.grid.spacing.y;
        let (shear, twist) = (self.fabric.shear * scale, self.twist_stiffness() * scale);
        CellModel {
            shear: (shear > 0.0).then(|| 1.0 / (shear * area)),
            twist: (twist > 0.0).then(|| area / (2.0 * twist)),
        }
    }

    /// Takes from the rates of shear, twist and bending what the fabric's dashpots take in `dt`.
    #[inline(always)]
    pub fn damp<S: Simd>(&mut self, simd: S, particles: &mut Particles, dt: f32) {
        let scale = self.fabric.damping * dt;
        let Particles { position, velocity, inverse_mass, .. } = particles;
        let model = self.cell_model(scale);
        if model.shear.is_some() || model.twist.is_some() {
            Cells { grid: &self.grid, mask: &self.cell_mask, inverse_mass, model }.damp(simd, position, velocity);
        }
        if self.fabric.bend_weft > 0.0 {
            let rows = self.rows();
            for first in (0..rows.rows).step_by(LANES) {
                self.gather(simd, velocity, inverse_mass, first);
                let compliance = self.bend_weft_compliance(simd, first, scale);
                let (block, w) = (self.row_block(), &self.rows_inverse_mass);
                lines::bend(simd, block, &mut self.rows_vector, w, compliance);
                self.scatter(simd, velocity, first);
            }
        }
        if self.fabric.bend_warp > 0.0 {
            for base in (0..self.grid.stride as usize).step_by(LANES) {
                let compliance = self.bend_warp_compliance(simd, base, scale);
                lines::bend(simd, self.column_block(base), velocity, inverse_mass, compliance);
            }
        }
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

    /// l³/(D width) over `scale`, for eight rows.
    #[inline(always)]
    fn bend_weft_compliance<S: Simd>(&self, simd: S, first: usize, scale: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, a * a * a / (self.fabric.bend_weft * b * scale)) / load(simd, &self.row_width, first)
    }

    /// l³/(D width) over `scale`, for eight columns.
    #[inline(always)]
    fn bend_warp_compliance<S: Simd>(&self, simd: S, base: usize, scale: f32) -> f32x8<S> {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        splat(simd, b * b * b / (self.fabric.bend_warp * a * scale)) / load(simd, &self.column_width, base)
    }

    /// Eight rows of `vector` and the inverse masses into lanes.
    #[inline(always)]
    fn gather<S: Simd>(&mut self, simd: S, vector: &Soa3, inverse_mass: &[f32], first: usize) {
        let (to, rows) = (&mut self.rows_vector, Rows { rows: self.grid.rows as usize, stride: self.grid.stride as usize });
        lines::gather_rows(simd, &vector.x, &mut to.x, rows, first);
        lines::gather_rows(simd, &vector.y, &mut to.y, rows, first);
        lines::gather_rows(simd, &vector.z, &mut to.z, rows, first);
        lines::gather_rows(simd, inverse_mass, &mut self.rows_inverse_mass, rows, first);
    }

    /// Eight rows back from lanes.
    #[inline(always)]
    fn scatter<S: Simd>(&self, simd: S, vector: &mut Soa3, first: usize) {
        let (from, rows) = (&self.rows_vector, self.rows());
        lines::scatter_rows(simd, &from.x, &mut vector.x, rows, first);
        lines::scatter_rows(simd, &from.y, &mut vector.y, rows, first);
        lines::scatter_rows(simd, &from.z, &mut vector.z, rows, first);
    }

    /// Bending and stretch along the weft.
    #[inline(always)]
    fn solve_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        let (rows, block) = (self.rows(), self.row_block());
        let stretch = splat(simd, a / (self.fabric.stretch_weft * b * h * h));
        for first in (0..rows.rows).step_by(LANES) {
            self.gather(simd, &particles.position, &particles.inverse_mass, first);
            let stretch = stretch / load(simd, &self.row_width, first);
            let bend = (self.fabric.bend_weft > 0.0).then(|| self.bend_weft_compliance(simd, first, h * h));
            let (x, w) = (&mut self.rows_vector, &self.rows_inverse_mass);
            if let Some(compliance) = bend {
                lines::bend(simd, block, x, w, compliance);
            }
            lines::stretch(simd, block, x, w, stretch, &mut self.elimination);
            self.scatter(simd, &mut particles.position, first);
            self.rows_load.fill(0.0);
            lines::record_load(simd, block, &self.elimination, &mut self.rows_load, h);
            lines::scatter_rows(simd, &self.rows_load, &mut self.load, rows, first);
        }
    }

    /// Bending and stretch along the warp.
    #[inline(always)]
    fn solve_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, h: f32) {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        let stretch = splat(simd, b / (self.fabric.stretch_warp * a * h * h));
        let Particles { position, inverse_mass, .. } = particles;
        for base in (0..self.grid.stride as usize).step_by(LANES) {
            let block = self.column_block(base);
            if self.fabric.bend_warp > 0.0 {
                lines::bend(simd, block, position, inverse_mass, self.bend_warp_compliance(simd, base, h * h));
            }
            let stretch = stretch / load(simd, &self.column_width, base);
            lines::stretch(simd, block, position, inverse_mass, stretch, &mut self.elimination);
            lines::record_load(simd, block, &self.elimination, &mut self.load, h);
        }
    }
}
