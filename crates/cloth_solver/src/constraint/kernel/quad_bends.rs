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

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::Soa3;
use crate::constraint::kernel::plan::Plan;
use crate::constraint::kernel::quad_cells::{Normal, fading};
use crate::lanes::{LANES, Vec3x8, load, select, splat, store};
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

/// Working memory for a line in lanes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Line {
    values: Soa3,
    near: Vec<f32>,
    far: Vec<f32>,
    /// Of closed lines, the columns of the last two bends below the diagonal.
    ring: [Vec<f32>; 2],
}

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
            line: Line {
                values: Soa3::zeros(length),
                near: vec![0.0; length],
                far: vec![0.0; length],
                ring: [vec![0.0; length], vec![0.0; length]],
            },
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

/// Eight lines of bends.
#[derive(Clone, Copy)]
struct Of<'a> {
    per_length: &'a [f32],
    stiffness: &'a [f32],
    weights: &'a [f32],
    stride: usize,
    count: usize,
}

/// The matrix next to a bend: what it has in common with itself, the one before and the one before that.
#[derive(Clone, Copy)]
struct Shared<S: Simd> {
    own: f32x8<S>,
    near: f32x8<S>,
    far: f32x8<S>,
}

impl Of<'_> {
    #[inline(always)]
    fn load<S: Simd>(self, simd: S, of: &[f32], k: usize) -> f32x8<S> {
        let round = if k >= 2 * self.count {
            2 * self.count
        } else if k >= self.count {
            self.count
        } else {
            0
        };
        load(simd, of, (k - round) * self.stride)
    }

    /// Those of bend `k`, which may be that many more than there are.
    #[inline(always)]
    fn shared<S: Simd, const CLOSED: bool>(self, simd: S, k: usize, scale: f32x8<S>, filter: f32x8<S>) -> Shared<S> {
        let zero = splat(simd, 0.0);
        let (count, k) = (self.count, k + self.count);
        let per_length = |by: usize| self.load(simd, self.per_length, k - by);
        let (after, before, before2) = (per_length(0), per_length(1), per_length(2));
        let (before, before2) = if CLOSED {
            (before, before2)
        } else {
            (if k - count >= 1 { before } else { zero }, if k - count >= 2 { before2 } else { zero })
        };
        let weight = |k: usize| self.load(simd, self.weights, k);
        let (w0, w1, w2) = (weight(k - 1), weight(k), weight(k + 1));
        let both = before + after;
        let stiffness = self.load(simd, self.stiffness, k) * scale;
        let compliance = splat(simd, 1.0) / stiffness.max(splat(simd, 1.0 / RIGID));
        Shared {
            own: compliance + filter * (before * before * w0 + both * both * w1 + after * after * w2),
            near: -(filter * before * (w0 * (before2 + before) + w1 * both)),
            far: filter * before * before2 * w0,
        }
    }
}

impl Line {
    /// `(1/K H² + θ B W Bᵀ) s = r`, r and then s its values.
    #[inline(always)]
    fn solve<S: Simd, const CLOSED: bool>(&mut self, simd: S, of: Of<'_>, square: f32, filter: f32) {
        let (scale, filter, zero, one) = (splat(simd, square), splat(simd, filter), splat(simd, 0.0), splat(simd, 1.0));
        let none = Vec3x8::splat(simd, glam::Vec3::ZERO);
        let count = if CLOSED { of.count - 2 } else { of.count };
        // Of the rows k − 1 and k − 2: the pivot's inverse and L⁻¹ r, the factor next to the diagonal.
        let (mut inverse1, mut inverse2, mut near1, mut y1, mut y2) = (zero, zero, zero, none, none);
        // Of a closed line: its last two bends, p and q.
        let (p, q) = (of.count.wrapping_sub(2), of.count.wrapping_sub(1));
        let (mut columns1, mut columns2) = ([zero; 2], [zero; 2]);
        let (mut right_p, mut right_q) = (none, none);
        let (mut pp, mut pq, mut qq) = (zero, zero, zero);
        for k in 0..count {
            let here = of.shared::<S, CLOSED>(simd, k, scale, filter);
            let (near, far) = (if k > 0 { here.near } else { zero }, if k > 1 { here.far } else { zero });
            let near = near - far * near1;
            let (near_factor, far_factor) = (near * inverse1, far * inverse2);
            let inverse = one / (here.own - near_factor * near - far_factor * far);
            let y = Vec3x8::load(simd, &self.values, k * LANES) - y1 * near_factor - y2 * far_factor;
            if CLOSED {
                let mut columns = [
                    zero - columns1[0] * near_factor - columns2[0] * far_factor,
                    zero - columns1[1] * near_factor - columns2[1] * far_factor,
                ];
                // What p and q have in common with the first two and the last two of the others.
                if k == 0 {
                    columns[0] += here.far;
                    columns[1] += here.near;
                }
                if k == 1 {
                    columns[1] += here.far;
                }
                if k + 2 == count {
                    columns[0] += of.shared::<S, CLOSED>(simd, p, scale, filter).far;
                }
                if k + 1 == count {
                    columns[0] += of.shared::<S, CLOSED>(simd, p, scale, filter).near;
                    columns[1] += of.shared::<S, CLOSED>(simd, q, scale, filter).far;
                }
                let scaled = [columns[0] * inverse, columns[1] * inverse];
                pp += columns[0] * scaled[0];
                pq += columns[0] * scaled[1];
                qq += columns[1] * scaled[1];
                right_p = right_p + y * scaled[0];
                right_q = right_q + y * scaled[1];
                store(scaled[0], &mut self.ring[0], k * LANES);
                store(scaled[1], &mut self.ring[1], k * LANES);
                (columns2, columns1) = (columns1, columns);
            }
            (y * inverse).store(&mut self.values, k * LANES);
            store(near_factor, &mut self.near, k * LANES);
            store(far_factor, &mut self.far, k * LANES);
            (inverse2, inverse1, near1, y2, y1) = (inverse1, inverse, near_factor, y1, y);
        }
        let (mut at_p, mut at_q) = (none, none);
        if CLOSED {
            let (of_p, of_q) =
                (of.shared::<S, CLOSED>(simd, p, scale, filter), of.shared::<S, CLOSED>(simd, q, scale, filter));
            right_p = Vec3x8::load(simd, &self.values, p * LANES) - right_p;
            right_q = Vec3x8::load(simd, &self.values, q * LANES) - right_q;
            // In a line of three they are next to each other both ways round.
            let both_ways = if of.count == 3 { of_q.near + of_p.far } else { of_q.near };
            let (pp, pq, qq) = (of_p.own - pp, both_ways - pq, of_q.own - qq);
            let factor = pq / pp;
            at_q = (right_q - right_p * factor) * (one / (qq - pq * factor));
            at_p = (right_p - at_q * pq) * (one / pp);
            at_p.store(&mut self.values, p * LANES);
            at_q.store(&mut self.values, q * LANES);
        }
        let (mut s1, mut s2) = (none, none);
        let (mut near1, mut far1, mut far2) = (zero, zero, zero);
        for k in (0..count).rev() {
            let mut s = Vec3x8::load(simd, &self.values, k * LANES) - s1 * near1 - s2 * far2;
            if CLOSED {
                s = s - at_p * load(simd, &self.ring[0], k * LANES) - at_q * load(simd, &self.ring[1], k * LANES);
            }
            s.store(&mut self.values, k * LANES);
            far2 = far1;
            near1 = load(simd, &self.near, k * LANES);
            far1 = load(simd, &self.far, k * LANES);
            (s2, s1) = (s1, s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LEVEL;

    /// A number in 0..1.
    fn noise(i: usize) -> f32 {
        let hash = (i as u32).wrapping_mul(0x9E37_79B9);
        ((hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8) as f32 / 16_777_216.0
    }

    /// The largest part of r that is left of it by s.
    fn left(count: usize, closed: bool) -> f32 {
        let len = count * LANES;
        let mut per_length: Vec<f32> = (0..len).map(|i| 20.0 + 60.0 * noise(i)).collect();
        let mut stiffness: Vec<f32> = (0..len).map(|i| 1e-3 * (1.0 + noise(i + 7000))).collect();
        let weights: Vec<f32> =
            (0..len).map(|i| if noise(i + 900) < 0.1 { 0.0 } else { 1e4 * (1.0 + noise(i + 99)) }).collect();
        if !closed {
            per_length[len - LANES..].fill(0.0);
            stiffness[..LANES].fill(0.0);
            stiffness[len - LANES..].fill(0.0);
        }
        let right: Vec<glam::Vec3> =
            (0..len).map(|i| glam::Vec3::new(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2))).collect();
        let mut line = Line {
            values: Soa3::from_slice(&right),
            near: vec![0.0; len],
            far: vec![0.0; len],
            ring: [vec![0.0; len], vec![0.0; len]],
        };
        let (square, filter) = (1e-3, 0.8);
        let of = Of { per_length: &per_length, stiffness: &stiffness, weights: &weights, stride: LANES, count };
        fearless_simd::dispatch!(*LEVEL, simd => if closed {
            line.solve::<_, true>(simd, of, square, filter);
        } else {
            line.solve::<_, false>(simd, of, square, filter);
        });
        let mut worst = 0.0_f32;
        for lane in 0..LANES {
            let at = |k: usize| k % count * LANES + lane;
            // B: of each bend, its particles and what it takes of them.
            let bends: Vec<[(usize, f32); 3]> = (0..count)
                .map(|k| {
                    let (before, after) = (per_length[at(k + count - 1)], per_length[at(k)]);
                    [((k + count - 1) % count, before), (k, -(before + after)), ((k + 1) % count, after)]
                })
                .collect();
            let is_there = |k: usize| closed || (k > 0 && k + 1 < count);
            for k in (0..count).filter(|k| is_there(*k)) {
                let mut sum = line.values.get(at(k)).as_dvec3() / f64::from(stiffness[at(k)] * square);
                for j in (0..count).filter(|j| is_there(*j)) {
                    for (p, a) in bends[k] {
                        for (q, b) in bends[j] {
                            if p == q {
                                sum += line.values.get(at(j)).as_dvec3() * f64::from(filter * a * b * weights[at(p)]);
                            }
                        }
                    }
                }
                worst = worst.max((sum.as_vec3() - right[at(k)]).length());
            }
        }
        worst
    }

    #[test]
    fn bends_of_open_and_closed_lines_of_any_length_solve_their_system() {
        for count in 3..20 {
            for closed in [false, true] {
                let left = left(count, closed);
                assert!(left < 2e-3, "{left} of {count}, closed: {closed}");
            }
        }
    }
}
