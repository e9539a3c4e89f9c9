//! Cells of a grid: in-plane shear and twist of four neighbouring particles.
//!
//! ```text
//!   p00 ── p10      u = mean edge along the weft, v = mean edge along the warp, in rest lengths
//!    │      │       shear  C = u·v                 energy ½ G a b C²
//!   p01 ── p11      twist  c = p00 + p11 − p10 − p01   energy ½ (2 D / a b) |c|²
//! ```
//!
//! Four colours (even and odd rows, even and odd columns): no two cells of a colour share a particle.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::batch::{Batches, gather, gather3, scatter3};
use super::wear::Wear;
use crate::lanes::{LANES, Vec3x8, load, splat, store};
use crate::{Grid, Particles, Soa3};

/// α̃ of the two constraints of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellModel<'a> {
    /// Shear.
    pub shear: ShearModel<'a>,
    /// a b/(2 D h²), 1/kg. `None` if the fabric does not resist twist.
    pub twist: Option<f32>,
}

/// How cells resist shear.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShearModel<'a> {
    /// Not at all.
    None,
    /// As a constraint of this compliance α̃ = 1/(G a b h²).
    Constraint(f32),
    /// By the force of this stress λ h² of each cell, per slot of its upper left corner.
    Stress(&'a [f32]),
}

/// Four corners of eight cells.
#[derive(Clone, Copy)]
struct Corners<S: Simd> {
    p00: Vec3x8<S>,
    p10: Vec3x8<S>,
    p01: Vec3x8<S>,
    p11: Vec3x8<S>,
}

/// Where the cells are: `mask` has 1 for a cell that is there and 0 for none, per slot of its upper left corner.
#[derive(Clone, Copy)]
pub(crate) struct Cells<'a> {
    pub grid: &'a Grid,
    pub mask: &'a [f32],
    pub inverse_mass: &'a [f32],
    pub model: CellModel<'a>,
}

impl Cells<'_> {
    /// Solves all cells once, every second cell of sixteen at a time, colour by colour.
    // No closure here: it would be compiled without the instruction set that `solve` is dispatched to.
    #[inline(always)]
    pub fn solve<S: Simd>(self, simd: S, position: &Soa3, moved: &mut Soa3) {
        let (stride, rows) = (self.grid.stride as usize, self.grid.rows as usize);
        for parity in 0..2 {
            for row in (parity..rows - 1).step_by(2) {
                for column in (0..self.grid.columns as usize - 1).step_by(2 * LANES) {
                    for odd in 0..2 {
                        self.solve_eight(simd, position, moved, row * stride + column + odd);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn solve_eight<S: Simd>(self, simd: S, position: &Soa3, moved: &mut Soa3, at: usize) {
        let w = self.weights(simd, at);
        let mut cell = Corners::load(simd, moved, at, self.grid);
        // Both from the same positions: one acts in the plane, the other across it.
        let start = Corners::load(simd, position, at, self.grid).diagonals();
        let still = start + cell.diagonals();
        if let Some(compliance) = self.model.twist {
            cell.untwist(simd, still, &w, compliance);
        }
        match self.model.shear {
            ShearModel::None => {}
            ShearModel::Constraint(compliance) => {
                let gradient = ShearGradient::new(simd, still, self.grid);
                cell.push(&gradient, gradient.value * w.on * gradient.scale(simd, &w, compliance), &w);
            }
            ShearModel::Stress(stress) => {
                let (lambda, _) = load_pair(simd, stress, at);
                cell.push(&ShearGradient::new(simd, start, self.grid), lambda * w.on, &w);
            }
        }
        cell.store(moved, at, self.grid);
    }

    #[inline(always)]
    fn weights<S: Simd>(self, simd: S, at: usize) -> Weights<S> {
        let (on, _) = load_pair(simd, self.mask, at);
        let (w00, w10) = load_pair(simd, self.inverse_mass, at);
        let (w01, w11) = load_pair(simd, self.inverse_mass, at + self.grid.stride as usize);
        Weights { on, w00, w10, w01, w11 }
    }
}

/// Cells of a rectangle that was taken apart whose corners lie anywhere, eight at a time.
#[derive(Clone, Debug)]
pub(crate) struct ListedCells {
    batches: Batches<4>,
    /// Factor on the stiffness of each cell; 0 where a lane is left over.
    mask: Vec<[f32; LANES]>,
}

impl ListedCells {
    /// Of the given corners.
    pub fn new(batches: Batches<4>) -> Self {
        Self { mask: batches.lanes(0.0, |_| 1.0), batches }
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.batches.source.iter().flatten().flatten().count()
    }

    /// Takes over what became of the particles.
    pub fn wear(&mut self, wear: Option<Wear<'_>>) {
        for (g, group) in self.batches.groups.iter().enumerate() {
            for lane in (0..LANES).filter(|lane| self.batches.source[g][*lane].is_some()) {
                let corners = [group[0][lane], group[1][lane], group[2][lane], group[3][lane]];
                self.mask[g][lane] = wear.map_or(1.0, |wear| wear.of_cell(corners));
            }
        }
    }

    /// Solves all once. Shear is a constraint here.
    #[inline(always)]
    pub fn solve<S: Simd>(&self, simd: S, particles: &mut Particles, grid: &Grid, model: CellModel<'_>) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        for (g, [a, b, c, d]) in self.batches.groups.iter().enumerate() {
            let w = Weights {
                on: f32x8::simd_from(simd, self.mask[g]),
                w00: gather(simd, inverse_mass, a),
                w10: gather(simd, inverse_mass, b),
                w01: gather(simd, inverse_mass, c),
                w11: gather(simd, inverse_mass, d),
            };
            let mut cell = Corners {
                p00: gather3(simd, moved, a),
                p10: gather3(simd, moved, b),
                p01: gather3(simd, moved, c),
                p11: gather3(simd, moved, d),
            };
            let start = Corners {
                p00: gather3(simd, position, a),
                p10: gather3(simd, position, b),
                p01: gather3(simd, position, c),
                p11: gather3(simd, position, d),
            };
            let still = start.diagonals() + cell.diagonals();
            if let Some(compliance) = model.twist {
                cell.untwist(simd, still, &w, compliance);
            }
            if let ShearModel::Constraint(compliance) = model.shear {
                let gradient = ShearGradient::new(simd, still, grid);
                cell.push(&gradient, gradient.value * w.on * gradient.scale(simd, &w, compliance), &w);
            }
            scatter3(cell.p00, moved, a);
            scatter3(cell.p10, moved, b);
            scatter3(cell.p01, moved, c);
            scatter3(cell.p11, moved, d);
        }
    }
}

/// What matters of the corners' positions: both diagonals, p11 − p00 and p10 − p01, and p00 + p11 − p10 − p01.
#[derive(Clone, Copy)]
struct Diagonals<S: Simd> {
    e: Vec3x8<S>,
    f: Vec3x8<S>,
    twist: Vec3x8<S>,
}

impl<S: Simd> core::ops::Add for Diagonals<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { e: self.e + b.e, f: self.f + b.f, twist: self.twist + b.twist }
    }
}

/// Inverse masses of the corners, and whether there is a cell.
#[derive(Clone, Copy)]
struct Weights<S: Simd> {
    on: f32x8<S>,
    w00: f32x8<S>,
    w10: f32x8<S>,
    w01: f32x8<S>,
    w11: f32x8<S>,
}

/// `C = u·v` and its gradients: `g11` at p11, `−g11` at p00, `g10` at p10, `−g10` at p01.
#[derive(Clone, Copy)]
struct ShearGradient<S: Simd> {
    value: f32x8<S>,
    g11: Vec3x8<S>,
    g10: Vec3x8<S>,
}

impl<S: Simd> ShearGradient<S> {
    #[inline(always)]
    fn new(simd: S, cell: Diagonals<S>, grid: &Grid) -> Self {
        // 2a u = e + f, 2b v = e − f.
        let Diagonals { e, f, .. } = cell;
        let (per_a, per_b) = (splat(simd, 0.5 / grid.spacing.x), splat(simd, 0.5 / grid.spacing.y));
        let (u, v) = ((e + f) * per_a, (e - f) * per_b);
        let (p, q) = (v * per_a, u * per_b);
        Self { value: u.dot(v), g11: p + q, g10: p - q }
    }

    /// 1/(Σ w |∇C|² + α̃).
    #[inline(always)]
    fn scale(&self, simd: S, w: &Weights<S>, compliance: f32) -> f32x8<S> {
        let weight = (w.w00 + w.w11) * self.g11.dot(self.g11) + (w.w10 + w.w01) * self.g10.dot(self.g10);
        splat(simd, 1.0) / (weight + splat(simd, compliance))
    }
}

impl<S: Simd> Corners<S> {
    #[inline(always)]
    fn load(simd: S, v: &Soa3, at: usize, grid: &Grid) -> Self {
        let (p00, p10) = load_pair3(simd, v, at);
        let (p01, p11) = load_pair3(simd, v, at + grid.stride as usize);
        Self { p00, p10, p01, p11 }
    }

    #[inline(always)]
    fn store(self, v: &mut Soa3, at: usize, grid: &Grid) {
        store_pair3(self.p00, self.p10, v, at);
        store_pair3(self.p01, self.p11, v, at + grid.stride as usize);
    }

    #[inline(always)]
    fn diagonals(self) -> Diagonals<S> {
        Diagonals {
            e: self.p11 - self.p00,
            f: self.p10 - self.p01,
            twist: (self.p00 - self.p10) + (self.p11 - self.p01),
        }
    }

    /// Takes out of the corners what is twisted in `of`.
    #[inline(always)]
    fn untwist(&mut self, simd: S, of: Diagonals<S>, w: &Weights<S>, compliance: f32) {
        let s = of.twist * (w.on / (w.w00 + w.w10 + w.w01 + w.w11 + splat(simd, compliance)));
        self.p00 = self.p00 - s * w.w00;
        self.p11 = self.p11 - s * w.w11;
        self.p10 = self.p10 + s * w.w10;
        self.p01 = self.p01 + s * w.w01;
    }

    /// Moves the corners by `−λ w ∇C`.
    #[inline(always)]
    fn push(&mut self, gradient: &ShearGradient<S>, lambda: f32x8<S>, w: &Weights<S>) {
        self.p11 = self.p11 - gradient.g11 * (lambda * w.w11);
        self.p00 = self.p00 + gradient.g11 * (lambda * w.w00);
        self.p10 = self.p10 - gradient.g10 * (lambda * w.w10);
        self.p01 = self.p01 + gradient.g10 * (lambda * w.w01);
    }
}

#[inline(always)]
fn load_pair<S: Simd>(simd: S, v: &[f32], i: usize) -> (f32x8<S>, f32x8<S>) {
    load(simd, v, i).deinterleave(load(simd, v, i + LANES))
}

#[inline(always)]
fn load_pair3<S: Simd>(simd: S, v: &Soa3, i: usize) -> (Vec3x8<S>, Vec3x8<S>) {
    let (x0, x1) = load_pair(simd, &v.x, i);
    let (y0, y1) = load_pair(simd, &v.y, i);
    let (z0, z1) = load_pair(simd, &v.z, i);
    (Vec3x8 { x: x0, y: y0, z: z0 }, Vec3x8 { x: x1, y: y1, z: z1 })
}

#[inline(always)]
fn store_pair3<S: Simd>(even: Vec3x8<S>, odd: Vec3x8<S>, v: &mut Soa3, i: usize) {
    for (even, odd, v) in [(even.x, odd.x, &mut v.x), (even.y, odd.y, &mut v.y), (even.z, odd.z, &mut v.z)] {
        let (low, high) = even.interleave(odd);
        store(low, v, i);
        store(high, v, i + LANES);
    }
}
