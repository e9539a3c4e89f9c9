//! Bending of the rows and columns of a mesh of quads, which may be curved at rest and whose links are of any length.
//!
//! ```text
//!         U             c = t₂ − t₁ of a line at x, less what of it lies in the surface at rest, by A and B
//!         │             A = R − L, B = D − U, n = A × B/|A × B|
//!    L ── x ── R        energy ½ K |c − κ n|², K = D w/l; κ n what it is at rest
//!         │
//!         D             its slope by all five particles, through n, too: nothing is turned as a whole, and no side is favoured but the
//!                       one that it was made with
//! ```
//!
//! As [`lines::bend`](super::lines::bend) the force is that where the substep begins; where it is too stiff for the substep it is
//! filtered, `(1/K H² + θ B W Bᵀ) s = c − κ n`, by the LDLᵀ factors of each line's pentadiagonal system. In a closed line the last two
//! bends are eliminated last.

mod line;

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use self::line::{Line, Of};
use crate::Soa3;
use crate::constraint::kernel::plan::Plan;
use crate::constraint::kernel::quad_cells::{Normal, fading};
use crate::lanes::{LANES, Vec3x8, load, select, splat};
use crate::topology::QuadsRest;

/// ω² H² of the fastest wave of bending along one direction after filtering, H the longest substep.
const FASTEST: f32 = 0.6;

/// 1/K of what does not bend.
const RIGID: f32 = 1e20;

/// Bends along one direction.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
struct Bends {
    /// 1 over the length of the link to the next particle; 0 where none is.
    per_length: Vec<f32>,
    /// K, N·m; 0 where nothing bends.
    stiffness: Vec<f32>,
    curl: Vec<f32>,
    skew: [Vec<f32>; 2],
    /// c − κ n, and then what pulls with it: H² times the slope of the energy.
    pull: Soa3,
    /// ω² of the fastest wave, 1/s².
    fastest: f32,
}

/// What resists bending in a mesh of quads.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(in crate::constraint) struct QuadBends {
    plan: Plan,
    along: [Bends; 2],
    /// The same of rows, eight in lanes: per length and stiffness.
    lanes: [Vec<f32>; 2],
    fading: Vec<f32>,
    /// Whether it is curved or its lines turn within the surface at rest.
    is_curved: bool,
    rows: [NodeRow; 3],
    line: Line,
    weights: Vec<f32>,
}

/// What the bends at a row of particles pull with, as the slope of the energy, on their neighbours right, left, below and above.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct NodeRow([Soa3; 4]);

impl QuadBends {
    /// Of lines whose bending stiffness is `bend` along rows and columns; `mass` is that of each slot were it in the middle of its cells,
    /// `worn` a factor on the stiffness around it.
    pub fn new(
        plan: Plan,
        rest: &QuadsRest,
        bend: [f32; 2],
        mass: impl Fn(usize) -> f32,
        worn: impl Fn(usize) -> f32,
    ) -> Self {
        let along = [0, 1].map(|along| {
            let links = &rest.links[along];
            let bends = &rest.bends[along];
            let per_length = plan.numbers(|slot| if links[slot].x > 0.0 { (1.0 / links[slot].x) as f32 } else { 0.0 });
            let stiffness = plan.numbers(|slot| bend[along] * bends[slot].shape as f32 * worn(slot));
            let mut fastest = 0.0_f32;
            for row in 0..plan.rows {
                for column in 0..plan.columns {
                    let at = plan.at(row, column);
                    let before = if along == 0 { at - 1 } else { at - plan.pitch };
                    let both = per_length[at] + per_length[before];
                    fastest = fastest.max(4.0 * both * both * stiffness[at] / mass(row * plan.stride + column));
                }
            }
            Bends {
                per_length,
                stiffness,
                curl: plan.numbers(|slot| bends[slot].curl as f32),
                skew: [plan.numbers(|slot| bends[slot].skew.x as f32), plan.numbers(|slot| bends[slot].skew.y as f32)],
                pull: Soa3::zeros(plan.len()),
                fastest,
            }
        });
        let is_curved = |slot: usize| {
            let size = rest.links[0][slot].x.max(rest.links[1][slot].x);
            (rest.bends.iter())
                .any(|bends| bends[slot].curl.abs().max(bends[slot].skew.abs().max_element() * size) > 1e-4)
        };
        let length = (plan.stride + LANES).max(plan.rows) * LANES;
        let row = || NodeRow([(); 4].map(|()| Soa3::zeros(plan.pitch + LANES)));
        Self {
            lanes: [&along[0].per_length, &along[0].stiffness].map(|of| plan.lanes(of, plan.rows)),
            fading: plan.numbers(|slot| fading(rest.stars[slot])),
            is_curved: (0..rest.cells.len()).any(is_curved),
            rows: [row(), row(), row()],
            line: Line::new(length),
            weights: vec![0.0; length],
            plan,
            along,
        }
    }

    /// Number of bends.
    pub fn count(&self) -> usize {
        let of = |bends: &Bends, row: usize| {
            let at = self.plan.at(row, 0);
            bends.stiffness[at..at + self.plan.columns].iter().filter(|stiffness| **stiffness > 0.0).count()
        };
        self.along.iter().map(|bends| (0..self.plan.rows).map(|row| of(bends, row)).sum::<usize>()).sum()
    }

    /// ω² H² of the fastest wave, without filter.
    pub fn fastest(&self, square: f32) -> f32 {
        self.along[0].fastest.max(self.along[1].fastest) * square
    }

    /// Moves every particle by `share` of the force at `position`, for substeps of that square of their length; `inverse_mass` with a
    /// margin, too.
    #[inline(always)]
    pub fn push<S: Simd>(
        &mut self,
        simd: S,
        position: &Soa3,
        inverse_mass: &[f32],
        moved: &mut Soa3,
        (square, share): (f32, f32),
    ) {
        let plan = self.plan;
        let filters = self.along.each_ref().map(|bends| {
            let fastest = bends.fastest * square;
            if fastest > FASTEST { 1.0 / FASTEST - 1.0 / fastest } else { 0.0 }
        });
        for row in 0..plan.rows {
            self.measure(simd, position, row, square, filters);
        }
        if filters[0] > 0.0 {
            self.filter_rows(simd, inverse_mass, square, filters[0]);
        }
        if filters[1] > 0.0 {
            self.filter_columns(simd, inverse_mass, square, filters[1]);
        }
        let share = splat(simd, share);
        let [mut above, mut here, mut below] = std::mem::take(&mut self.rows);
        above.0[2].fill(glam::Vec3::ZERO);
        self.node_row(simd, position, 0, &mut here);
        for row in 0..plan.rows {
            if row + 1 < plan.rows {
                self.node_row(simd, position, row + 1, &mut below);
            } else {
                below.0[3].fill(glam::Vec3::ZERO);
            }
            for column in (0..plan.stride).step_by(LANES) {
                let at = LANES + column;
                let own =
                    here.load(simd, 0, at) + here.load(simd, 1, at) + here.load(simd, 2, at) + here.load(simd, 3, at);
                let slope = here.load(simd, 0, at - 1)
                    + here.load(simd, 1, at + 1)
                    + above.load(simd, 2, at)
                    + below.load(simd, 3, at)
                    - own;
                let to = row * plan.stride + column;
                let w = load(simd, inverse_mass, plan.at(row, column)) * share;
                (Vec3x8::load(simd, moved, to) - slope * w).store(moved, to);
            }
            (above, here, below) = (here, below, above);
        }
        self.rows = [above, here, below];
    }

    /// c − κ n of the bends at a row of particles, times K H² where nothing is filtered.
    #[inline(always)]
    fn measure<S: Simd>(&mut self, simd: S, position: &Soa3, row: usize, square: f32, filters: [f32; 2]) {
        let plan = self.plan;
        for column in (0..plan.columns).step_by(LANES) {
            let at = plan.at(row, column);
            let star = Star::load(simd, position, at, plan.pitch);
            for along in 0..2 {
                let step = if along == 0 { 1 } else { plan.pitch };
                let bends = &mut self.along[along];
                let (before, after) = if along == 0 { (star.left, star.right) } else { (star.up, star.down) };
                let mut c = (after - star.x) * load(simd, &bends.per_length, at)
                    - (star.x - before) * load(simd, &bends.per_length, at - step);
                if self.is_curved {
                    let n = Normal::new(simd, star.a(), star.b(), load(simd, &self.fading, at)).n;
                    c = c
                        - star.a() * load(simd, &bends.skew[0], at)
                        - star.b() * load(simd, &bends.skew[1], at)
                        - n * load(simd, &bends.curl, at);
                }
                if filters[along] == 0.0 {
                    c = c * (load(simd, &bends.stiffness, at) * splat(simd, square));
                }
                c.store(&mut bends.pull, at);
            }
        }
    }

    /// What the bends at a row of particles pull with.
    #[inline(always)]
    fn node_row<S: Simd>(&self, simd: S, position: &Soa3, row: usize, to: &mut NodeRow) {
        let Plan { pitch, columns, closed, .. } = self.plan;
        let zero = splat(simd, 0.0);
        let none = Vec3x8::splat(simd, glam::Vec3::ZERO);
        for column in (0..columns).step_by(LANES) {
            let at = self.plan.at(row, column);
            let [weft, warp] = &self.along;
            let (s, t) = (Vec3x8::load(simd, &weft.pull, at), Vec3x8::load(simd, &warp.pull, at));
            let (right, left) = (load(simd, &weft.per_length, at), load(simd, &weft.per_length, at - 1));
            let (down, up) = (load(simd, &warp.per_length, at), load(simd, &warp.per_length, at - pitch));
            let mut pulls = [s * right, s * left, t * down, t * up];
            if self.is_curved {
                let star = Star::load(simd, position, at, pitch);
                let (a, b) = (star.a(), star.b());
                let on_n = s * load(simd, &weft.curl, at) + t * load(simd, &warp.curl, at);
                let turn = Normal::new(simd, a, b, load(simd, &self.fading, at)).slope(simd, on_n);
                let on_a = none - s * load(simd, &weft.skew[0], at) - t * load(simd, &warp.skew[0], at) - b.cross(turn);
                let on_b = none - s * load(simd, &weft.skew[1], at) - t * load(simd, &warp.skew[1], at) - turn.cross(a);
                pulls = [pulls[0] + on_a, pulls[1] - on_a, pulls[2] + on_b, pulls[3] - on_b];
            }
            // Where there is no neighbour it is the particle itself that A and B end at.
            let there = [right, left, down, up];
            for i in 0..4 {
                select(there[i].simd_gt(zero), pulls[i], none).store(&mut to.0[i], LANES + column);
            }
        }
        if closed {
            let [right, left, ..] = &mut to.0;
            right.set(LANES - 1, right.get(LANES + columns - 1));
            left.set(LANES + columns, left.get(LANES));
        }
    }

    #[inline(always)]
    fn filter_rows<S: Simd>(&mut self, simd: S, inverse_mass: &[f32], square: f32, filter: f32) {
        let Self { plan, along: [Bends { pull, .. }, _], lanes: [per_length, stiffness], line, weights, .. } = self;
        let Plan { rows, columns, closed, .. } = *plan;
        for first in (0..rows).step_by(LANES) {
            plan.gather(simd, inverse_mass, weights, rows, first, columns);
            plan.gather(simd, &pull.x, &mut line.values.x, rows, first, columns);
            plan.gather(simd, &pull.y, &mut line.values.y, rows, first, columns);
            plan.gather(simd, &pull.z, &mut line.values.z, rows, first, columns);
            let block = plan.block(first);
            let of = Of {
                per_length: &per_length[block..],
                stiffness: &stiffness[block..],
                weights,
                stride: LANES,
                count: columns,
            };
            if closed {
                line.solve::<S, true>(simd, of, square, filter);
            } else {
                line.solve::<S, false>(simd, of, square, filter);
            }
            plan.scatter(simd, &line.values.x, &mut pull.x, rows, first, columns);
            plan.scatter(simd, &line.values.y, &mut pull.y, rows, first, columns);
            plan.scatter(simd, &line.values.z, &mut pull.z, rows, first, columns);
        }
    }

    #[inline(always)]
    fn filter_columns<S: Simd>(&mut self, simd: S, inverse_mass: &[f32], square: f32, filter: f32) {
        let Self { plan, along: [_, Bends { pull, per_length, stiffness, .. }], line, .. } = self;
        for column in (0..plan.columns).step_by(LANES) {
            let at = plan.at(0, column);
            for k in 0..plan.rows {
                Vec3x8::load(simd, pull, at + k * plan.pitch).store(&mut line.values, k * LANES);
            }
            let of = Of {
                per_length: &per_length[at..],
                stiffness: &stiffness[at..],
                weights: &inverse_mass[at..],
                stride: plan.pitch,
                count: plan.rows,
            };
            line.solve::<S, false>(simd, of, square, filter);
            for k in 0..plan.rows {
                Vec3x8::load(simd, &line.values, k * LANES).store(pull, at + k * plan.pitch);
            }
        }
    }
}

/// Particles and their neighbours.
#[derive(Clone, Copy)]
struct Star<S: Simd> {
    x: Vec3x8<S>,
    left: Vec3x8<S>,
    right: Vec3x8<S>,
    up: Vec3x8<S>,
    down: Vec3x8<S>,
}

impl<S: Simd> Star<S> {
    #[inline(always)]
    fn load(simd: S, position: &Soa3, at: usize, pitch: usize) -> Self {
        Self {
            x: Vec3x8::load(simd, position, at),
            left: Vec3x8::load(simd, position, at - 1),
            right: Vec3x8::load(simd, position, at + 1),
            up: Vec3x8::load(simd, position, at - pitch),
            down: Vec3x8::load(simd, position, at + pitch),
        }
    }

    #[inline(always)]
    fn a(self) -> Vec3x8<S> {
        self.right - self.left
    }

    #[inline(always)]
    fn b(self) -> Vec3x8<S> {
        self.down - self.up
    }
}

impl NodeRow {
    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, which: usize, at: usize) -> Vec3x8<S> {
        Vec3x8::load(simd, &self.0[which], at)
    }
}
