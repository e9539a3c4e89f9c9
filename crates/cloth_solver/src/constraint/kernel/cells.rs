//! Cells of a grid: in-plane shear and twist of four neighbouring particles.
//!
//! ```text
//!   p00 ── p10      u = mean edge along the weft, v = mean edge along the warp, in rest lengths
//!    │      │       shear  C = u·v                 energy ½ G a b C²
//!   p01 ── p11      twist  c = p00 + p11 − p10 − p01   energy ½ (2 D / a b) |c|²
//! ```
//!
//! As forces where a substep begins: they turn nothing as a whole, and need no order. Where they are swept as constraints, in four
//! colours (even and odd rows, even and odd columns): no two cells of a colour share a particle.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::batch::{Batches, gather, gather3, scatter3};
use crate::constraint::wear::Wear;
use crate::lanes::{LANES, Vec3x8, load, splat, store};
use crate::{Grid, Particles, Soa3};

/// α̃ of the two constraints of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellModel {
    /// Shear.
    pub shear: ShearModel,
    /// a b/(2 D h²), 1/kg. `None` if the fabric does not resist twist.
    pub twist: Option<f32>,
}

/// How cells resist shear.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShearModel {
    /// Not at all.
    None,
    /// As a constraint of this compliance α̃ = 1/(G a b h²).
    Constraint(f32),
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
    pub model: CellModel,
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
        let still = Corners::load(simd, position, at, self.grid).diagonals() + cell.diagonals();
        if let Some(compliance) = self.model.twist {
            cell.untwist(simd, still, &w, compliance);
        }
        match self.model.shear {
            ShearModel::None => {}
            ShearModel::Constraint(compliance) => {
                let gradient = ShearGradient::new(simd, still, self.grid);
                cell.push(&gradient, gradient.value * w.on * gradient.scale(simd, &w, compliance), &w);
            }
        }
        // A row of eight slots ends with them: what follows is another row of the same cells, not theirs to write.
        cell.store(moved, at, self.grid, at % self.grid.stride as usize + LANES < self.grid.stride as usize);
    }

    #[inline(always)]
    fn weights<S: Simd>(self, simd: S, at: usize) -> Weights<S> {
        let (on, _) = load_pair(simd, self.mask, at);
        let (w00, w10) = load_pair(simd, self.inverse_mass, at);
        let (w01, w11) = load_pair(simd, self.inverse_mass, at + self.grid.stride as usize);
        Weights { on, w00, w10, w01, w11 }
    }
}

/// What cells of a grid pull with, in the longest substep.
#[derive(Clone, Copy)]
pub(crate) struct CellForces<'a> {
    pub grid: &'a Grid,
    /// 1 for a cell that is there, 0 for none, per slot of its upper left corner.
    pub mask: &'a [f32],
    /// λ H² of the shear of each cell, per slot of its upper left corner, N·s²; `None` if the fabric does not resist shear.
    pub stress: Option<&'a [f32]>,
    /// 2 D H²/(a b), kg; 0 if the fabric does not resist twist.
    pub twist: f32,
    /// The part of it that acts in this substep: see [`crate::Substep::share`].
    pub share: f32,
}

/// Forces of a row of cells on their corners: A, B and s with `−A − s`, `B + s` on the lower two and `A − s`, `s − B` on the
/// upper two; eight entries of nothing before the first cell.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Row {
    a: Soa3,
    b: Soa3,
    s: Soa3,
}

/// Working memory: the row of cells above and below a row of particles.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(crate) struct CellRows([Row; 2]);

impl CellRows {
    /// For a grid of that stride.
    pub fn new(stride: usize) -> Self {
        let numbers = || Soa3::zeros(stride + LANES);
        let row = || Row { a: numbers(), b: numbers(), s: numbers() };
        Self([row(), row()])
    }
}

impl CellForces<'_> {
    /// Moves every particle by the forces of its cells.
    #[inline(always)]
    pub fn push<S: Simd>(self, simd: S, position: &Soa3, inverse_mass: &[f32], moved: &mut Soa3, rows: &mut CellRows) {
        let (stride, count) = (self.grid.stride as usize, self.grid.rows as usize);
        let [above, below] = &mut rows.0;
        for all in [&mut above.a, &mut above.b, &mut above.s] {
            all.fill(glam::Vec3::ZERO);
        }
        let share = splat(simd, self.share);
        for row in 0..count {
            if row + 1 < count {
                self.find(simd, position, row, below);
            } else {
                for all in [&mut below.a, &mut below.b, &mut below.s] {
                    all.fill(glam::Vec3::ZERO);
                }
            }
            for column in (0..stride).step_by(LANES) {
                let (right, left) = (column + LANES, column + LANES - 1);
                let vector = |of: &Soa3, at: usize| Vec3x8::load(simd, of, at);
                // The cells at the right and left below, then above.
                let force = (vector(&below.a, right) - vector(&below.s, right))
                    + (vector(&below.s, left) - vector(&below.b, left))
                    + (vector(&above.b, right) + vector(&above.s, right))
                    - (vector(&above.a, left) + vector(&above.s, left));
                let at = row * stride + column;
                let w = load(simd, inverse_mass, at) * share;
                (Vec3x8::load(simd, moved, at) + force * w).store(moved, at);
            }
            std::mem::swap(above, below);
        }
    }

    /// The forces of the cells below `row`.
    #[inline(always)]
    fn find<S: Simd>(self, simd: S, position: &Soa3, row: usize, to: &mut Row) {
        let (stride, grid) = (self.grid.stride as usize, self.grid);
        let twist = splat(simd, self.twist);
        for column in (0..stride).step_by(LANES) {
            let at = row * stride + column;
            let corners = Corners {
                p00: Vec3x8::load(simd, position, at),
                p10: Vec3x8::load(simd, position, at + 1),
                p01: Vec3x8::load(simd, position, at + stride),
                p11: Vec3x8::load(simd, position, at + stride + 1),
            };
            let cell = corners.diagonals();
            let on = load(simd, self.mask, at);
            (cell.twist * (twist * on)).store(&mut to.s, column + LANES);
            if let Some(stress) = self.stress {
                let gradient = ShearGradient::new(simd, cell, grid);
                let lambda = load(simd, stress, at) * on;
                (gradient.g11 * lambda).store(&mut to.a, column + LANES);
                (gradient.g10 * lambda).store(&mut to.b, column + LANES);
            }
        }
    }
}

/// Cells of a rectangle that was taken apart whose corners lie anywhere, eight at a time.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
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

    /// Solves all once as constraints.
    #[inline(always)]
    pub fn solve<S: Simd>(&self, simd: S, particles: &mut Particles, grid: &Grid, model: CellModel) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        for (g, slots) in self.batches.groups.iter().enumerate() {
            let w = self.weights(simd, g, inverse_mass);
            let mut cell = Corners::gather(simd, moved, slots);
            let still = Corners::gather(simd, position, slots).diagonals() + cell.diagonals();
            if let Some(compliance) = model.twist {
                cell.untwist(simd, still, &w, compliance);
            }
            if let ShearModel::Constraint(compliance) = model.shear {
                let gradient = ShearGradient::new(simd, still, grid);
                cell.push(&gradient, gradient.value * w.on * gradient.scale(simd, &w, compliance), &w);
            }
            cell.scatter(moved, slots);
        }
    }

    /// Moves every particle by the forces of its cells in a substep, no stiffer than that resolves; `model` for the longest one.
    #[inline(always)]
    pub fn push<S: Simd>(&self, simd: S, particles: &mut Particles, grid: &Grid, model: CellModel, share: f32) {
        let Particles { position, moved, inverse_mass, .. } = particles;
        let (share, zero) = (splat(simd, share), Vec3x8::splat(simd, glam::Vec3::ZERO));
        for (g, slots) in self.batches.groups.iter().enumerate() {
            let w = self.weights(simd, g, inverse_mass);
            let start = Corners::gather(simd, position, slots).diagonals();
            let mut push = Corners { p00: zero, p10: zero, p01: zero, p11: zero };
            if let Some(compliance) = model.twist {
                let weight = w.w00 + w.w10 + w.w01 + w.w11;
                let scale = share / (splat(simd, compliance) + weight * splat(simd, RESOLVED));
                push.twist(start.twist * (w.on * scale), &w);
            }
            if let ShearModel::Constraint(compliance) = model.shear {
                let gradient = ShearGradient::new(simd, start, grid);
                let scale = share / (splat(simd, compliance) + gradient.weight(&w) * splat(simd, RESOLVED));
                push.push(&gradient, gradient.value * w.on * scale, &w);
            }
            let mut cell = Corners::gather(simd, moved, slots);
            cell.p00 = cell.p00 + push.p00;
            cell.p10 = cell.p10 + push.p10;
            cell.p01 = cell.p01 + push.p01;
            cell.p11 = cell.p11 + push.p11;
            cell.scatter(moved, slots);
        }
    }

    #[inline(always)]
    fn weights<S: Simd>(&self, simd: S, g: usize, inverse_mass: &[f32]) -> Weights<S> {
        let [a, b, c, d] = &self.batches.groups[g];
        Weights {
            on: f32x8::simd_from(simd, self.mask[g]),
            w00: gather(simd, inverse_mass, a),
            w10: gather(simd, inverse_mass, b),
            w01: gather(simd, inverse_mass, c),
            w11: gather(simd, inverse_mass, d),
        }
    }
}

/// How much of Σ w |∇C|² a force alone may be stiff by, for those of all neighbours to stay stable together.
const RESOLVED: f32 = 2.0;

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
        splat(simd, 1.0) / (self.weight(w) + splat(simd, compliance))
    }

    /// Σ w |∇C|².
    #[inline(always)]
    fn weight(&self, w: &Weights<S>) -> f32x8<S> {
        (w.w00 + w.w11) * self.g11.dot(self.g11) + (w.w10 + w.w01) * self.g10.dot(self.g10)
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
    fn store(self, v: &mut Soa3, at: usize, grid: &Grid, both: bool) {
        store_pair3(self.p00, self.p10, v, at, both);
        store_pair3(self.p01, self.p11, v, at + grid.stride as usize, both);
    }

    #[inline(always)]
    fn gather(simd: S, v: &Soa3, [a, b, c, d]: &[[u32; LANES]; 4]) -> Self {
        Self { p00: gather3(simd, v, a), p10: gather3(simd, v, b), p01: gather3(simd, v, c), p11: gather3(simd, v, d) }
    }

    #[inline(always)]
    fn scatter(self, v: &mut Soa3, [a, b, c, d]: &[[u32; LANES]; 4]) {
        scatter3(self.p00, v, a);
        scatter3(self.p10, v, b);
        scatter3(self.p01, v, c);
        scatter3(self.p11, v, d);
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
        self.twist(of.twist * (w.on / (w.w00 + w.w10 + w.w01 + w.w11 + splat(simd, compliance))), w);
    }

    /// Moves the corners by `∓s w`.
    #[inline(always)]
    fn twist(&mut self, s: Vec3x8<S>, w: &Weights<S>) {
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
fn store_pair3<S: Simd>(even: Vec3x8<S>, odd: Vec3x8<S>, v: &mut Soa3, i: usize, both: bool) {
    for (even, odd, v) in [(even.x, odd.x, &mut v.x), (even.y, odd.y, &mut v.y), (even.z, odd.z, &mut v.z)] {
        let (low, high) = even.interleave(odd);
        store(low, v, i);
        if both {
            store(high, v, i + LANES);
        }
    }
}
