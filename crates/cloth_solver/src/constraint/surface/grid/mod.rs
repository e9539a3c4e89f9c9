//! The constraints of a grid: cells, then rows, then columns; and of what was taken apart, the same in lists.

mod solve;
mod sweep;

use fearless_simd::{Simd, f32x8};

use crate::constraint::kernel::cells::{CellModel, CellRows, Cells, ShearModel};
use crate::constraint::kernel::lines::{self, Bend, Elimination, How, Links8, Rows};
use crate::constraint::kernel::links::{Block, Worn};
use crate::constraint::kernel::shear::{STIFFEST, Stress};
use crate::constraint::kernel::sweep::Compliance;
use crate::constraint::surface::force::Woven;
use crate::constraint::surface::listed::Work;
use crate::constraint::surface::passes::Passes;
use crate::constraint::surface::patch::Patch;
use crate::constraint::tension::Sums;
use crate::constraint::wear::{self, Wear, WornGrid};
use crate::lanes::{LANES, load, splat, store};
use crate::topology::Along;
use crate::{Fabric, Grid, Particles, Soa3, Substep, Topology};

pub(in crate::constraint) use sweep::Sweep;

/// How runs of one spacing wide resist in a substep, and their spacing.
#[derive(Clone, Copy, Debug)]
pub(in crate::constraint) struct Stiffness {
    /// α̃ of the links, l/(Y width kick h), 1/kg.
    pub stretch: f32,
    /// α̃ of the bends, l³/(D width H²), 1/kg, H the longest substep; `None` if the fabric does not resist bending.
    bend: Option<f32>,
    /// See [`Bend`].
    filter: f32,
    share: f32,
    pub how: How,
    /// Rest distance between neighbours, m.
    pub spacing: f32,
}

/// ω² H² of the fastest wave of bending along one direction after filtering, H the longest substep.
const FASTEST_BENDING: f32 = 0.6;

/// The same of twist.
const FASTEST_TWIST: f32 = 0.3;

impl Stiffness {
    /// α̃ for constraints of runs of one spacing wide.
    #[inline(always)]
    pub fn of_one_spacing<S: Simd>(self, simd: S) -> Compliance<S> {
        #[expect(clippy::manual_map, reason = "a closure would lack the dispatched instruction set")]
        let bend = match self.bend {
            Some(bend) => Some(splat(simd, bend / self.share)),
            None => None,
        };
        Compliance { stretch: splat(simd, self.stretch), bend }
    }

    /// How runs of that width, in spacings, resist bending.
    #[inline(always)]
    pub fn bend<S: Simd>(self, simd: S, width: f32x8<S>) -> Option<Bend<S>> {
        match self.bend {
            Some(bend) => Some(Bend { compliance: splat(simd, bend) / width, filter: self.filter, share: self.share }),
            None => None,
        }
    }
}

/// What keeps a rectangle of fabric together, and the working memory to solve it.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct GridConstraints {
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
    /// The links of each block of eight rows or columns.
    weft: Links8,
    warp: Links8,
    stress: Stress,
    /// Every eight rows in lanes, one block after the other.
    rows: RowLanes,
    cell_rows: CellRows,
    /// For what was taken apart.
    work: Work,
    passes: Passes,
}

/// Rows in lanes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct RowLanes {
    position: Soa3,
    moved: Soa3,
    inverse_mass: Vec<f32>,
    elimination: Elimination,
}

impl RowLanes {
    fn new(grid: &Grid) -> Self {
        let slots = (grid.rows as usize).next_multiple_of(LANES) * grid.stride as usize;
        Self {
            position: Soa3::zeros(slots),
            moved: Soa3::zeros(slots),
            inverse_mass: vec![0.0; slots],
            elimination: Elimination::new(grid.columns.max(grid.rows) as usize),
        }
    }
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
            weft: Links8::new(rows.next_multiple_of(LANES) * columns),
            warp: Links8::new(stride * rows),
            stress: Stress::new(&grid),
            rows: RowLanes::new(&grid),
            cell_rows: CellRows::new(stride),
            work: Work::new(rows.max(columns)),
            passes: Passes::default(),
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
            Along::Weft => (self.grid.rows, self.grid.columns, &self.weft.lambda, &self.row_width),
            Along::Warp => (self.grid.columns, self.grid.rows, &self.warp.lambda, &self.column_width),
        };
        let grid = self.grid;
        let slot = move |run, k| match along {
            Along::Weft => grid.slot(run, k),
            Along::Warp => grid.slot(k, run),
        };
        let regular = (0..runs).filter(move |run| self.is_regular(along, *run as usize)).flat_map(move |run| {
            (0..count - 1).map(move |k| {
                let lambda = of[wear::index(run as usize, count as usize, k as usize)];
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
                let rows = self.row_lanes();
                let Self { rows: RowLanes { moved: Soa3 { x: tensions, y: weights, .. }, .. }, .. } = self;
                for first in (0..rows.rows).step_by(LANES) {
                    if !is_block(&self.patch, along, first) {
                        continue;
                    }
                    let block = row_block(&self.grid, first);
                    let width = load(simd, &self.row_width, first);
                    for numbers in [&mut *tensions, &mut *weights] {
                        numbers[block.base..block.base + LANES * rows.stride].fill(0.0);
                    }
                    add_to_ends(simd, block, &self.weft.lambda, scale, width, tensions, weights);
                    lines::scatter_rows(simd, tensions, block.base, &mut to.tension, rows, first);
                    lines::scatter_rows(simd, weights, block.base, &mut to.weight, rows, first);
                }
            }
            Along::Warp => {
                for base in (0..self.grid.stride as usize).step_by(LANES) {
                    if is_block(&self.patch, along, base) {
                        let (block, width) = (column_block(&self.grid, base), load(simd, &self.column_width, base));
                        add_to_ends(simd, block, &self.warp.lambda, scale, width, &mut to.tension, &mut to.weight);
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

    /// Root mean square of what the last substep, of that [`Substep::square`], left of `C + α̃ λ` in the links along warp and
    /// weft, in rest lengths.
    pub fn residual(&self, particles: &Particles, square: f32) -> f32 {
        let (mut sum, mut count) = (0.0_f64, 0);
        for along in [Along::Weft, Along::Warp] {
            let (stretch, spacing) = self.stretch(along, square);
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

    /// ω² H² of the fastest wave of bending along `along` in a substep of length H, s, without filter.
    pub fn fastest_bending(&self, along: Along, h: f32) -> f32 {
        let (bending, spacing) = match along {
            Along::Weft => (self.fabric.bend_weft, self.grid.spacing.x),
            Along::Warp => (self.fabric.bend_warp, self.grid.spacing.y),
        };
        16.0 * bending * h * h / (self.fabric.areal_density * spacing.powi(4))
    }

    /// ω² H² of the fastest wave of shear in a substep of length H, s, without filter.
    pub fn fastest_shear(&self, h: f32) -> f32 {
        let wave = self.fabric.shear * h * h / self.fabric.areal_density;
        4.0 * wave * (self.grid.spacing * self.grid.spacing).recip().element_sum()
    }

    /// The fabric's resistance to shear in `sub`, N/m: what even the most substeps of a tick leave too stiff is softer.
    fn shear(&self, sub: &Substep) -> f32 {
        let fastest = self.fastest_shear(sub.shortest);
        self.fabric.shear * if fastest > STIFFEST { STIFFEST / fastest } else { 1.0 }
    }

    /// α̃ of the links along `along` in a substep of that [`Substep::square`], and their rest length.
    fn stretch(&self, along: Along, square: f32) -> (f32, f32) {
        let (a, b) = (self.grid.spacing.x, self.grid.spacing.y);
        match along {
            Along::Weft => (a / (self.fabric.stretch_weft * b * square), a),
            Along::Warp => (b / (self.fabric.stretch_warp * a * square), b),
        }
    }

    /// How the runs along `along` resist in `sub`.
    fn stiffness(&self, along: Along, sub: &Substep) -> Stiffness {
        let (stretch, spacing) = self.stretch(along, sub.square());
        let (bending, across) = match along {
            Along::Weft => (self.fabric.bend_weft, self.grid.spacing.y),
            Along::Warp => (self.fabric.bend_warp, self.grid.spacing.x),
        };
        let (longest, fastest) = (sub.longest * sub.longest, self.fastest_bending(along, sub.longest));
        Stiffness {
            stretch,
            bend: (bending > 0.0).then(|| spacing.powi(3) / (bending * across * longest)),
            filter: if fastest > FASTEST_BENDING { 1.0 / FASTEST_BENDING - 1.0 / fastest } else { 0.0 },
            share: sub.share(),
            how: Passes::first(sub),
            spacing,
        }
    }

    #[inline(always)]
    fn solve_cells<S: Simd>(&self, simd: S, particles: &mut Particles, model: CellModel) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        if !matches!(model.shear, ShearModel::None) || model.twist.is_some() {
            Cells { grid: &self.grid, mask: &self.cell_mask, inverse_mass, model }.solve(simd, position, moved);
        }
    }

    /// α̃ of the cells against shear, in a substep of that [`Substep::square`].
    fn shear_compliance(&self, square: f32) -> f32 {
        1.0 / (self.fabric.shear * square * self.grid.spacing.x * self.grid.spacing.y)
    }

    /// α̃ of the cells against twist, if the fabric resists it.
    fn twist_compliance(&self, square: f32) -> Option<f32> {
        let twist = self.twist_stiffness() * square;
        (twist > 0.0).then(|| self.grid.spacing.x * self.grid.spacing.y / (2.0 * twist))
    }

    /// 2 D H²/(a b), kg, no stiffer than that no wave of twist is too fast for the longest substep H.
    fn twist(&self, sub: &Substep) -> f32 {
        let cell = self.grid.spacing.x * self.grid.spacing.y;
        let stiffness = 2.0 * self.twist_stiffness() * sub.longest * sub.longest / cell;
        stiffness.min(FASTEST_TWIST / 16.0 * self.fabric.areal_density * cell)
    }

    fn row_lanes(&self) -> Rows {
        Rows { rows: self.grid.rows as usize, stride: self.grid.stride as usize }
    }
}

/// The eight rows from `first` on, in lanes.
pub(in crate::constraint::surface) fn row_block(grid: &Grid, first: usize) -> Block {
    let (stride, count) = (grid.stride as usize, grid.columns as usize);
    Block { base: first * stride, stride: LANES, count, spacing: grid.spacing.x, links: first * count }
}

/// The eight columns from `base` on.
pub(in crate::constraint::surface) fn column_block(grid: &Grid, base: usize) -> Block {
    let (stride, count) = (grid.stride as usize, grid.rows as usize);
    Block { base, stride, count, spacing: grid.spacing.y, links: base * count }
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
        let tension = load(simd, lambda, block.link(k)) * scale;
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

/// Eight rows of vectors into lanes.
#[inline(always)]
pub(in crate::constraint::surface) fn gather<S: Simd>(
    simd: S,
    from: &Soa3,
    to: &mut Soa3,
    base: usize,
    rows: Rows,
    first: usize,
) {
    lines::gather_rows(simd, &from.x, &mut to.x, base, rows, first);
    lines::gather_rows(simd, &from.y, &mut to.y, base, rows, first);
    lines::gather_rows(simd, &from.z, &mut to.z, base, rows, first);
}

/// Eight rows of vectors back from lanes.
#[inline(always)]
pub(in crate::constraint::surface) fn scatter<S: Simd>(
    simd: S,
    from: &Soa3,
    base: usize,
    to: &mut Soa3,
    rows: Rows,
    first: usize,
) {
    lines::scatter_rows(simd, &from.x, base, &mut to.x, rows, first);
    lines::scatter_rows(simd, &from.y, base, &mut to.y, rows, first);
    lines::scatter_rows(simd, &from.z, base, &mut to.z, rows, first);
}
