//! The constraints of a grid: cells, then rows, then columns; and of what was taken apart, the same in lists.

mod solve;
mod sweep;

use fearless_simd::{Simd, f32x8};

use super::cells::{CellModel, Cells, ShearModel};
use super::force::Woven;
use super::lines::{self, Block, Rows};
use super::listed::Work;
use super::patch::Patch;
use super::shear::Stress;
use super::sweep::Compliance;
use super::tension::Sums;
use super::wear::{Wear, Worn, WornGrid};
use crate::lanes::{LANES, load, splat, store};
use crate::topology::Along;
use crate::{Fabric, Grid, Particles, Soa3, Topology};

pub(super) use solve::largest;
pub(super) use sweep::Sweep;

/// α̃ of the links and bends of runs of one spacing wide, and their spacing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    /// l/(Y width h²), 1/kg.
    pub stretch: f32,
    /// l³/(D width h²), 1/kg; `None` if the fabric does not resist bending.
    pub bend: Option<f32>,
    /// Rest distance between neighbours, m.
    pub spacing: f32,
}

impl Stiffness {
    /// Of eight runs of one spacing wide.
    #[inline(always)]
    pub fn of_one_spacing<S: Simd>(self, simd: S) -> Compliance<S> {
        #[expect(clippy::manual_map, reason = "a closure would lack the dispatched instruction set")]
        let bend = match self.bend {
            Some(bend) => Some(splat(simd, bend)),
            None => None,
        };
        Compliance { stretch: splat(simd, self.stretch), bend }
    }
}

/// What keeps a rectangle of fabric together, and the working memory to solve it.
#[derive(Clone, Debug)]
pub(super) struct GridConstraints {
    pub grid: Grid,
    pub fabric: Fabric,
    /// The root of the factor on the stiffness of each cell, per slot of its upper left corner: 0 where none is.
    cell_mask: Vec<f32>,
    worn: Option<Box<WornGrid>>,
    /// What was taken apart, if anything was.
    pub patch: Option<Box<Patch>>,
    /// The same, for methods that step forces.
    pub woven: Option<Box<Woven>>,
    /// 1 inside, ½ for the outermost rows and columns, which stand for half the width; per row and per column slot.
    pub row_width: Vec<f32>,
    pub column_width: Vec<f32>,
    work: Work,
    /// Multipliers of the links of each block of eight rows or columns.
    weft_lambda: Vec<f32>,
    warp_lambda: Vec<f32>,
    stress: Stress,
}

impl GridConstraints {
    pub fn new(grid: Grid, topology: &Topology, fabric: &Fabric) -> Self {
        let (columns, rows, stride) = (grid.columns as usize, grid.rows as usize, grid.stride as usize);
        let widths = |count: usize, padded: usize| {
            let mut width = vec![1.0; padded];
            width[0] = 0.5;
            width[count - 1] = 0.5;
            width
        };
        Self {
            grid,
            fabric: *fabric,
            cell_mask: whole_cells(topology, &grid),
            worn: None,
            patch: Patch::new(topology, fabric).map(Box::new),
            woven: None,
            row_width: widths(rows, rows.next_multiple_of(LANES)),
            column_width: widths(columns, stride),
            work: Work::new(rows.max(columns)),
            weft_lambda: vec![0.0; rows.next_multiple_of(LANES) * columns],
            warp_lambda: vec![0.0; stride * rows],
            stress: Stress::new(&grid),
        }
    }

    /// Takes over that the cloth was taken apart.
    pub fn follow(&mut self, topology: &Topology) {
        self.cell_mask = whole_cells(topology, &self.grid);
        self.patch = Patch::new(topology, &self.fabric).map(Box::new);
    }

    /// Makes ready to be asked for forces, or gives back what that takes.
    pub fn prepare_forces(&mut self, topology: &Topology, wanted: bool) {
        self.woven = if wanted { Woven::new(topology, &self.fabric).map(Box::new) } else { None };
    }

    /// Takes over what became of the particles; `None` makes all as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        let grid = self.grid;
        match wear {
            Some(wear) => self.worn.get_or_insert_with(|| Box::new(WornGrid::new(&grid))).update(&grid, wear),
            None => self.worn = None,
        }
        for (row, column) in grid.cells() {
            let corners = grid.cell(row, column);
            let mask = &mut self.cell_mask[corners[0] as usize];
            if *mask > 0.0 {
                *mask = wear.map_or(1.0, |wear| wear.of_cell(corners).sqrt());
            }
        }
        if let Some(patch) = &mut self.patch {
            patch.wear(wear);
        }
    }

    pub fn count(&self) -> usize {
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        let of_cell = usize::from(self.fabric.shear > 0.0) + usize::from(self.twist_stiffness() > 0.0);
        let (bends_weft, bends_warp) = (self.fabric.bend_weft > 0.0, self.fabric.bend_warp > 0.0);
        let cells = self.cell_mask.iter().filter(|mask| **mask > 0.0).count() * of_cell;
        let regular = |along, runs: usize, count: usize, bends: bool| {
            let links = count - 1 + if bends { count - 2 } else { 0 };
            (0..runs).filter(|run| self.is_regular(along, *run)).count() * links
        };
        let regular = regular(Along::Weft, rows, columns, bends_weft) + regular(Along::Warp, columns, rows, bends_warp);
        cells + regular + self.patch.as_ref().map_or(0, |patch| patch.count(of_cell, bends_weft, bends_warp))
    }

    /// Whether the row or column `run` is solved where it lies.
    fn is_regular(&self, along: Along, run: usize) -> bool {
        self.patch.as_ref().is_none_or(|patch| patch.is_regular(along, run))
    }

    /// The links of rows and columns and of what was taken apart: ends, λ of the last substep, N·s², and 1/width in spacings.
    pub fn links(&self, along: Along) -> impl Iterator<Item = ([u32; 2], f32, f32)> + '_ {
        let (runs, count, of, width) = match along {
            Along::Weft => (self.grid.rows, self.grid.columns, &self.weft_lambda, &self.row_width),
            Along::Warp => (self.grid.columns, self.grid.rows, &self.warp_lambda, &self.column_width),
        };
        let grid = self.grid;
        let slot = move |run, k| match along {
            Along::Weft => grid.slot(run, k),
            Along::Warp => grid.slot(k, run),
        };
        let regular = (0..runs).filter(move |run| self.is_regular(along, *run as usize)).flat_map(move |run| {
            (0..count - 1).map(move |k| {
                let lambda = of[super::wear::index(run as usize, count as usize, k as usize)];
                ([slot(run, k), slot(run, k + 1)], lambda, 1.0 / width[run as usize])
            })
        });
        regular.chain(self.patch.iter().flat_map(move |patch| patch.links(along)))
    }

    /// Adds the tension of the links along `along`, `scale` times λ, weighed by width, to both their ends.
    #[inline(always)]
    pub fn add_tensions<S: Simd>(&mut self, simd: S, along: Along, scale: f32, to: &mut Sums) {
        let scale = splat(simd, scale);
        match along {
            Along::Weft => {
                let (rows, block) = (self.rows(), self.row_block());
                let Work { inverse_mass: weights, load: tensions, .. } = &mut self.work;
                for first in (0..rows.rows).step_by(LANES) {
                    if !is_block(&self.patch, along, first) {
                        continue;
                    }
                    let width = load(simd, &self.row_width, first);
                    tensions.fill(0.0);
                    weights.fill(0.0);
                    let lambda = multipliers(&mut self.weft_lambda, block, first);
                    add_to_ends(simd, block, lambda, scale, width, tensions, weights);
                    lines::scatter_rows(simd, tensions, &mut to.tension, rows, first);
                    lines::scatter_rows(simd, weights, &mut to.weight, rows, first);
                }
            }
            Along::Warp => {
                for base in (0..self.grid.stride as usize).step_by(LANES) {
                    if is_block(&self.patch, along, base) {
                        let (block, width) = (self.column_block(base), load(simd, &self.column_width, base));
                        let lambda = multipliers(&mut self.warp_lambda, block, base);
                        add_to_ends(simd, block, lambda, scale, width, &mut to.tension, &mut to.weight);
                    }
                }
            }
        }
        for (ends, lambda, narrow) in self.patch.iter().flat_map(|patch| patch.links(along)) {
            for slot in ends {
                to.tension[slot as usize] += scale[0] * lambda;
                to.weight[slot as usize] += 1.0 / narrow;
            }
        }
    }

    /// Root mean square of what the last substep, of length `h`, left of `C + α̃ λ` in the links along warp and weft, in
    /// rest lengths.
    pub fn residual(&self, particles: &Particles, h: f32) -> f32 {
        let (mut sum, mut count) = (0.0_f64, 0);
        for along in [Along::Weft, Along::Warp] {
            let Stiffness { stretch, spacing, .. } = self.stiffness(along, h);
            for ([a, b], lambda, narrow) in self.links(along) {
                let length = particles.position.get(a as usize).distance(particles.position.get(b as usize));
                sum += f64::from((length - spacing + stretch * narrow * lambda) / spacing).powi(2);
                count += 1;
            }
        }
        (sum / f64::from(count.max(1))).sqrt() as f32
    }

    /// 1 for each cell that lies where it was made, per slot of its upper left corner, else 0.
    pub fn cell_mask(&self) -> &[f32] {
        &self.cell_mask
    }

    /// Whether all particles of the rectangle have the same of these coordinates.
    pub fn is_level(&self, coordinates: &[f32]) -> bool {
        let (columns, stride) = (self.grid.columns as usize, self.grid.stride as usize);
        coordinates
            .chunks(stride)
            .take(self.grid.rows as usize)
            .all(|row| row[..columns].iter().all(|x| *x == coordinates[0]))
    }

    /// Bending stiffness against twist, N·m: the mean of warp and weft.
    fn twist_stiffness(&self) -> f32 {
        0.5 * (self.fabric.bend_warp + self.fabric.bend_weft)
    }

    /// α̃ of the runs along `along` in a substep of length `h`.
    fn stiffness(&self, along: Along, h: f32) -> Stiffness {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        let Fabric { stretch_weft, stretch_warp, bend_weft, bend_warp, .. } = self.fabric;
        let (stretch, bend, along, across) = match along {
            Along::Weft => (stretch_weft, bend_weft, a, b),
            Along::Warp => (stretch_warp, bend_warp, b, a),
        };
        Stiffness {
            stretch: along / (stretch * across * h * h),
            bend: (bend > 0.0).then(|| along * along * along / (bend * across * h * h)),
            spacing: along,
        }
    }

    #[inline(always)]
    fn solve_cells<S: Simd>(&self, simd: S, particles: &mut Particles, model: CellModel<'_>) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        if !matches!(model.shear, ShearModel::None) || model.twist.is_some() {
            Cells { grid: &self.grid, mask: &self.cell_mask, inverse_mass, model }.solve(simd, position, moved);
        }
    }

    /// α̃ of the cells against shear.
    fn shear_compliance(&self, h: f32) -> f32 {
        1.0 / (self.fabric.shear * h * h * self.grid.spacing.x * self.grid.spacing.y)
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
}

/// Adds the tension of each link of eight runs, and its width, to both its ends.
#[inline(always)]
fn add_to_ends<S: Simd>(
    simd: S,
    block: Block,
    lambda: &[f32],
    scale: f32x8<S>,
    width: f32x8<S>,
    tensions: &mut [f32],
    weights: &mut [f32],
) {
    for k in 0..block.count - 1 {
        let tension = load(simd, lambda, k * LANES) * scale;
        for at in [block.at(k), block.at(k + 1)] {
            store(load(simd, tensions, at) + tension, tensions, at);
            store(load(simd, weights, at) + width, weights, at);
        }
    }
}

/// 1 for each cell of a rectangle that lies where it was made, per slot of its upper left corner, else 0.
fn whole_cells(topology: &Topology, grid: &Grid) -> Vec<f32> {
    let mut mask = vec![0.0; (grid.rows * grid.stride) as usize + 2 * LANES];
    for (row, column) in grid.cells() {
        let corners = grid.cell(row, column);
        if topology.cell(grid, row, column) == Some(corners) {
            mask[corners[0] as usize] = 1.0;
        }
    }
    mask
}

/// Whether the block that starts with run `first` is solved where it lies.
fn is_block(patch: &Option<Box<Patch>>, along: Along, first: usize) -> bool {
    patch.as_ref().is_none_or(|patch| patch.is_regular(along, first))
}

/// What became of the links along `along` of the block that starts with run `first`.
fn worn(worn: &Option<Box<WornGrid>>, along: Along, first: usize, block: Block) -> Option<Worn<'_>> {
    worn.as_ref().map(|worn| worn.block(along, first, block))
}

/// α̃ of eight runs of the widths from `first` on.
#[inline(always)]
fn compliance<S: Simd>(simd: S, stiffness: Stiffness, width: &[f32], first: usize) -> Compliance<S> {
    let (width, one) = (load(simd, width, first), stiffness.of_one_spacing(simd));
    #[expect(clippy::manual_map, reason = "a closure would lack the dispatched instruction set")]
    let bend = match one.bend {
        Some(bend) => Some(bend / width),
        None => None,
    };
    Compliance { stretch: one.stretch / width, bend }
}

impl Work {
    /// Eight rows into lanes.
    #[inline(always)]
    fn gather_rows<S: Simd>(&mut self, simd: S, particles: &Particles, rows: Rows, first: usize) {
        gather(simd, &particles.position, &mut self.position, rows, first);
        gather(simd, &particles.moved, &mut self.moved, rows, first);
        lines::gather_rows(simd, &particles.inverse_mass, &mut self.inverse_mass, rows, first);
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
fn multipliers(lambda: &mut [f32], block: Block, first: usize) -> &mut [f32] {
    &mut lambda[first * block.count..(first + LANES) * block.count]
}
