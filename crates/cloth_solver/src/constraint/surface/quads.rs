//! The constraints of a mesh of quads: what a [`grid`](super::grid) is to a rectangle, with a length and a width to every link.

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use glam::Vec2;

use super::grid::{column_block, gather, row_block, scatter};
use super::passes::Passes;
use crate::constraint::kernel::lines::{self, Elimination, How, Links8, Met, Rows};
use crate::constraint::kernel::links::Varied;
use crate::constraint::kernel::plan::Plan;
use crate::constraint::kernel::quad_bends::QuadBends;
use crate::constraint::kernel::quad_cells::QuadCells;
use crate::constraint::tension::Tensions;
use crate::constraint::wear::{Wear, index};
use crate::lanes::{LANES, splat};
use crate::tick::{Effort, Substep};
use crate::topology::{Along, Quads, QuadsRest};
use crate::{Fabric, Particles, Soa3, Topology};

/// The largest T h²/(m l) that a substep may have, as for the lines of a rectangle.
const LARGEST_LOAD: f32 = 0.5;

/// What keeps a mesh of quads together along its rows and columns.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct QuadConstraints {
    quads: Quads,
    plan: Plan,
    fabric: Fabric,
    rest: QuadsRest,
    /// 4 over the number of cells at each slot: what makes its mass that of a particle in the middle.
    surrounded: Vec<f32>,
    area: Vec<f32>,
    rows: Lines,
    columns: Lines,
    cells: Option<QuadCells>,
    bends: Option<QuadBends>,
    /// Where a substep begins, with a margin.
    position: Soa3,
    inverse_mass: Vec<f32>,
    in_lanes: [Soa3; 2],
    inverse_in_lanes: Vec<f32>,
    elimination: Elimination,
    passes: Passes,
}

/// All links of one direction, eight lines a block.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Lines {
    links: Links8,
    /// Factors, see [`Varied`].
    compliance: Vec<f32>,
    rest: Vec<f32>,
    shorter: Vec<f32>,
    /// Width of each link, m.
    width: Vec<f32>,
    /// Length that the factors are of, m.
    spacing: f32,
    /// Y, N/m.
    stiffness: f32,
}

impl QuadConstraints {
    /// `None` of a mesh that has no rows and columns.
    pub fn new(topology: &Topology, fabric: &Fabric) -> Option<Self> {
        let (quads, rest) = topology.quads_at_rest()?;
        let plan = Plan::new(&quads);
        let slots = plan.rows * plan.stride;
        let mut cells = vec![0.0_f32; slots];
        quads.cells().flat_map(|(row, column)| quads.cell(row, column)).for_each(|slot| cells[slot as usize] += 1.0);
        let stretch = |along: Along| if along == Along::Weft { fabric.stretch_weft } else { fabric.stretch_warp };
        let blocks = |runs: usize| runs.next_multiple_of(LANES);
        let lines = |along: Along, spacing: f32, len: usize, closed: bool| Lines {
            links: if closed { Links8::closed(len) } else { Links8::new(len) },
            compliance: vec![1.0; len],
            rest: vec![1.0; len],
            shorter: vec![1.0; len],
            width: vec![1.0; len],
            spacing,
            stiffness: stretch(along),
        };
        let Vec2 { x: across, y: down } = quads.grid.spacing;
        let in_lanes = blocks(plan.rows) * plan.stride;
        let mut made = Self {
            rows: lines(quads.along_rows(), across, blocks(plan.rows) * plan.columns, quads.closed),
            columns: lines(quads.along_columns(), down, plan.stride * plan.rows, false),
            surrounded: cells.into_iter().map(|count| 4.0 / count.max(1.0)).collect(),
            area: topology.area[..slots].to_vec(),
            position: Soa3::zeros(plan.len()),
            inverse_mass: vec![0.0; plan.len()],
            in_lanes: [Soa3::zeros(in_lanes), Soa3::zeros(in_lanes)],
            inverse_in_lanes: vec![0.0; in_lanes],
            elimination: Elimination::new(plan.columns.max(plan.rows)),
            passes: Passes::default(),
            cells: None,
            bends: None,
            fabric: *fabric,
            quads,
            plan,
            rest,
        };
        made.wear(None);
        Some(made)
    }

    /// Takes over what became of the particles; `None` makes all as good as new.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        let Plan { rows, columns, stride, .. } = self.plan;
        for row in 0..rows.next_multiple_of(LANES) {
            for k in 0..columns {
                let slot = row.min(rows - 1) * stride + k;
                let next = if k + 1 < columns { slot + 1 } else { slot + 1 - columns };
                let link = self.rest.links[0][slot];
                self.rows.set(index(row, columns, k), link, [slot, next], wear);
            }
        }
        for column in 0..stride {
            for k in 0..rows - 1 {
                let slot = k * stride + column.min(columns - 1);
                self.columns.set(index(column, rows, k), self.rest.links[1][slot], [slot, slot + stride], wear);
            }
        }
        let fabric = &self.fabric;
        let bend = |along: Along| if along == Along::Weft { fabric.bend_weft } else { fabric.bend_warp };
        let bends = [bend(self.quads.along_rows()), bend(self.quads.along_columns())];
        let twist = 0.5 * (fabric.bend_warp + fabric.bend_weft);
        let mass = |slot: usize| fabric.areal_density * self.area[slot] * self.surrounded[slot];
        let corners = |slot: usize| {
            let corners = self.quads.cell((slot / stride) as u32, (slot % stride) as u32);
            corners.map(|slot| slot as usize)
        };
        if fabric.shear > 0.0 || twist > 0.0 {
            let worn = |slot: usize| wear.map_or(1.0, |wear| wear.of_cell(corners(slot).map(|slot| slot as u32)));
            self.cells = Some(QuadCells::new(self.plan, &self.rest, [fabric.shear, twist], mass, corners, worn));
        }
        if bends[0] > 0.0 || bends[1] > 0.0 {
            let worn = |slot: usize| wear.map_or(1.0, |wear| wear.stiffness[slot]);
            self.bends = Some(QuadBends::new(self.plan, &self.rest, bends, mass, worn));
        }
    }

    /// Number of constraints.
    pub fn count(&self) -> usize {
        let there = |links: &[glam::DVec2]| links.iter().filter(|link| link.x > 0.0).count();
        let fabric = &self.fabric;
        let of_cell = usize::from(fabric.shear > 0.0) + usize::from(fabric.bend_warp + fabric.bend_weft > 0.0);
        let cells = self.plan.across * (self.plan.rows - 1) * of_cell;
        let bends = self.bends.as_ref().map_or(0, QuadBends::count);
        self.rest.links.iter().map(|links| there(links)).sum::<usize>() + cells + bends
    }

    /// ω² H² of the fastest waves of bending and of shear in a substep of length H, s, without filter.
    pub fn fastest(&self, h: f32) -> [f32; 2] {
        let bending = self.bends.as_ref().map_or(0.0, |bends| bends.fastest(h * h));
        [bending, self.cells.as_ref().map_or(0.0, |cells| cells.fastest(h * h))]
    }

    /// Adds the tensions in the last substep, of that [`Substep::square`].
    pub fn add_tensions(&self, square: f32, to: &mut Tensions) {
        let Plan { rows, columns, stride, closed, .. } = self.plan;
        let mut add = |along: Along, lines: &Lines, at: usize, slots: [usize; 2]| {
            let width = lines.width[at];
            let force = -lines.links.lambda[at] / square;
            slots.into_iter().for_each(|slot| to.add(along, slot as u32, force / width, width));
        };
        for row in 0..rows {
            for k in 0..if closed { columns } else { columns - 1 } {
                let slot = row * stride + k;
                let next = if k + 1 < columns { slot + 1 } else { slot + 1 - columns };
                add(self.quads.along_rows(), &self.rows, index(row, columns, k), [slot, next]);
            }
        }
        for column in 0..columns {
            for k in 0..rows - 1 {
                let slot = k * stride + column;
                add(self.quads.along_columns(), &self.columns, index(column, rows, k), [slot, slot + stride]);
            }
        }
    }

    /// Once in a substep.
    #[inline(always)]
    pub fn solve<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) -> Effort {
        self.push(simd, particles, sub);
        let first = Passes::first(sub);
        let rows = self.solve_rows::<S, true>(simd, particles, sub.square(), first);
        let columns = self.solve_columns::<S, true>(simd, particles, sub.square(), first);
        let loads = [rows, columns].map(|met| met.load.reduce_max());
        let mut met = rows.and(columns);
        let links = [self.plan.rows * self.plan.across, self.plan.columns * (self.plan.rows - 1)];
        let mean_load = rows.mean_load(links[0]).max(columns.mean_load(links[1]));
        if loads[0] > lines::UNFILTERED_LOAD {
            self.filter_rows(simd, particles, sub.square());
        }
        if loads[1] > lines::UNFILTERED_LOAD {
            self.filter_columns(simd, particles, sub.square());
        }
        let (load, turned) = (met.load.reduce_max(), met.turned.reduce_max() > 0.0);
        self.passes.begin(sub, met.change.reduce_max());
        while self.passes.is_due() {
            let how = self.passes.how(sub);
            let rows = self.solve_rows::<S, false>(simd, particles, sub.square(), how);
            met = rows.and(self.solve_columns::<S, false>(simd, particles, sub.square(), how));
            self.passes.done(rows.left.reduce_max(), met.shift.reduce_max());
        }
        if let Some(how) = self.passes.last(sub, met.change.reduce_max()) {
            self.solve_rows::<S, false>(simd, particles, sub.square(), how);
        }
        Effort { load: load / LARGEST_LOAD, mean_load, motion: met.change.reduce_max().sqrt(), turned }
    }

    /// Shear, twist and bending.
    #[inline(always)]
    fn push<S: Simd>(&mut self, simd: S, particles: &mut Particles, sub: &Substep) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        self.plan.fill3(position, &mut self.position);
        self.plan.fill(inverse_mass, &mut self.inverse_mass);
        let lengths = (sub.longest * sub.longest, sub.share());
        if let Some(cells) = &mut self.cells {
            cells.soften(sub.shortest);
            cells.find(simd, &self.position, &self.inverse_mass, lengths.0);
            cells.push(simd, &self.position, inverse_mass, moved, lengths);
        }
        if let Some(bends) = &mut self.bends {
            bends.push(simd, &self.position, &self.inverse_mass, moved, lengths);
        }
    }

    #[inline(always)]
    fn solve_rows<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        square: f32,
        how: How,
    ) -> Met<S> {
        let Self { plan, quads, in_lanes: [position, moved], inverse_in_lanes, .. } = self;
        let rows = Rows { rows: plan.rows, stride: plan.stride };
        let lines = &mut self.rows;
        let stiffness = (splat(simd, lines.alpha(square)), how);
        let mut met = Met::nothing(simd);
        for first in (0..rows.rows).step_by(LANES) {
            let block = row_block(&quads.grid, first);
            if FIRST {
                gather(simd, &particles.position, position, block.base, rows, first);
                lines::gather_rows(simd, &particles.inverse_mass, inverse_in_lanes, block.base, rows, first);
            }
            gather(simd, &particles.moved, moved, block.base, rows, first);
            let Lines { links, compliance, rest, shorter, .. } = &mut *lines;
            let of = varied(compliance, rest, shorter, block.links);
            met = met.and(if quads.closed {
                lines::stretch::<S, _, FIRST, true>(
                    simd,
                    block,
                    position,
                    moved,
                    inverse_in_lanes,
                    stiffness,
                    of,
                    links,
                )
            } else {
                lines::stretch::<S, _, FIRST, false>(
                    simd,
                    block,
                    position,
                    moved,
                    inverse_in_lanes,
                    stiffness,
                    of,
                    links,
                )
            });
            scatter(simd, moved, block.base, &mut particles.moved, rows, first);
        }
        met
    }

    #[inline(always)]
    fn solve_columns<S: Simd, const FIRST: bool>(
        &mut self,
        simd: S,
        particles: &mut Particles,
        square: f32,
        how: How,
    ) -> Met<S> {
        let Particles { position, moved, inverse_mass, .. } = particles;
        let lines = &mut self.columns;
        let stiffness = (splat(simd, lines.alpha(square)), how);
        let mut met = Met::nothing(simd);
        for base in (0..self.plan.stride).step_by(LANES) {
            let block = column_block(&self.quads.grid, base);
            let Lines { links, compliance, rest, shorter, .. } = &mut *lines;
            let of = varied(compliance, rest, shorter, block.links);
            met = met.and(lines::stretch::<S, _, FIRST, false>(
                simd,
                block,
                position,
                moved,
                inverse_mass,
                stiffness,
                of,
                links,
            ));
        }
        met
    }

    #[inline(always)]
    fn filter_rows<S: Simd>(&mut self, simd: S, particles: &mut Particles, square: f32) {
        let Self { plan, quads, in_lanes: [position, moved], inverse_in_lanes: w, elimination: work, .. } = self;
        let (rows, links) = (Rows { rows: plan.rows, stride: plan.stride }, &mut self.rows.links);
        for first in (0..rows.rows).step_by(LANES) {
            let block = row_block(&quads.grid, first);
            gather(simd, &particles.moved, moved, block.base, rows, first);
            if quads.closed {
                lines::filter::<S, true>(simd, block, position, moved, w, links, work, square);
            } else {
                lines::filter::<S, false>(simd, block, position, moved, w, links, work, square);
            }
            scatter(simd, moved, block.base, &mut particles.moved, rows, first);
        }
    }

    #[inline(always)]
    fn filter_columns<S: Simd>(&mut self, simd: S, particles: &mut Particles, square: f32) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        let (links, work) = (&mut self.columns.links, &mut self.elimination);
        for base in (0..self.plan.stride).step_by(LANES) {
            let block = column_block(&self.quads.grid, base);
            lines::filter::<S, false>(simd, block, position, moved, inverse_mass, links, work, square);
        }
    }
}

/// The links of a block from `first` on.
fn varied<'a>(compliance: &'a [f32], rest: &'a [f32], shorter: &'a [f32], first: usize) -> Varied<'a> {
    Varied { compliance: &compliance[first..], rest: &rest[first..], shorter: &shorter[first..] }
}

impl Lines {
    /// α̃ of a link of the mean length and as wide as it is long, in a substep of that [`Substep::square`].
    fn alpha(&self, square: f32) -> f32 {
        1.0 / (self.stiffness * square)
    }

    /// Takes note of one link: its length and width at rest, m.
    fn set(&mut self, at: usize, link: glam::DVec2, ends: [usize; 2], wear: Option<Wear<'_>>) {
        if link.x <= 0.0 {
            return;
        }
        let ends = ends.map(|slot| slot as u32);
        let (compliance, rest) = wear.map_or((1.0, 1.0), |wear| (wear.compliance(ends), wear.rest(ends)));
        let (length, width) = (link.x as f32, link.y as f32);
        self.compliance[at] = length / width * compliance;
        self.rest[at] = length / self.spacing * rest;
        self.shorter[at] = self.spacing / length;
        self.width[at] = width;
    }
}
