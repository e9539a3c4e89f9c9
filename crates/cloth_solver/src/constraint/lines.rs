//! Straight runs of particles, eight side by side: stretch solved exactly along each, and bending of each.
//!
//! A run is a row (weft) or a column (warp) of a grid. Eight runs are solved at once, one in each lane, so every
//! access is at unit stride:
//!
//! ```text
//!            lane  0  1  2  3  4  5  6  7
//!   particle 0     o  o  o  o  o  o  o  o      k-th vector of a block starts at base + k * stride
//!                  │  │  │  │  │  │  │  │
//!   particle 1     o  o  o  o  o  o  o  o
//! ```
//!
//! Columns are such blocks as they lie in memory (stride = the grid's); rows are first transposed, eight at a time,
//! into working memory (stride 8).

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::Soa3;
use crate::lanes::{LANES, Vec3x8, load, splat, store, transpose};

/// Eight runs of `count` particles each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// Where the first vector starts.
    pub base: usize,
    /// From one vector to the next.
    pub stride: usize,
    /// Particles in each run, at least 2.
    pub count: usize,
    /// Rest distance between neighbours, m.
    pub spacing: f32,
}

/// What the exact solve of a block keeps between its two passes: eight lanes per link.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    normal: Soa3,
    upper: Vec<f32>,
    /// Right-hand side after elimination, then the multipliers.
    lambda: Vec<f32>,
}

impl Elimination {
    /// For runs of up to `longest` particles.
    pub fn new(longest: usize) -> Self {
        let len = longest * LANES;
        Self { normal: Soa3::zeros(len), upper: vec![0.0; len], lambda: vec![0.0; len] }
    }
}

/// Solves the stretch constraints `|x_{k+1} − x_k| = spacing` of each run together: one Newton step of the XPBD
/// system (Macklin, Müller, Chentanez 2016), tridiagonal in the multipliers, by the Thomas algorithm:
/// `A_kk = w_k + w_{k+1} + α̃`, `A_{k−1,k} = −w_k n_{k−1}·n_k`, `A λ = −C`.
///
/// `compliance` is α̃ = α/h², 1/kg. Leaves the multipliers in `work`.
#[inline(always)]
pub(crate) fn stretch<S: Simd>(
    simd: S,
    block: Block,
    position: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
    work: &mut Elimination,
) {
    let Block { base, stride, count, spacing } = block;
    let zero = splat(simd, 0.0);
    let one = splat(simd, 1.0);
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let rest = splat(simd, spacing);

    let mut x = Vec3x8::load(simd, position, base);
    let mut w = load(simd, inverse_mass, base);
    let mut last = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut last_inverse, mut last_rhs) = (zero, zero);
    for k in 0..count - 1 {
        let next = base + (k + 1) * stride;
        let x_next = Vec3x8::load(simd, position, next);
        let w_next = load(simd, inverse_mass, next);
        let d = x_next - x;
        let length = d.length();
        // A link of no length has no direction: its normal is 0, not NaN, and it gets no correction.
        let normal = d * (one / length.max(tiny));
        let off = -(w * last.dot(normal));
        let upper = off * last_inverse;
        // Only neighbours that are both pinned, of an infinitely stiff fabric, make the pivot 0; λ is of no use there.
        let inverse = one / (w + w_next + compliance - off * upper).max(tiny);
        let rhs = (rest - length - off * last_rhs) * inverse;
        normal.store(&mut work.normal, k * LANES);
        store(upper, &mut work.upper, k * LANES);
        store(rhs, &mut work.lambda, k * LANES);
        (last, last_inverse, last_rhs) = (normal, inverse, rhs);
        (x, w) = (x_next, w_next);
    }

    // Back substitution; particle k+1 is corrected once the multipliers on both its sides are known.
    let mut lambda_above = zero;
    let mut pull_above = Vec3x8 { x: zero, y: zero, z: zero };
    for k in (0..count - 1).rev() {
        let at = base + (k + 1) * stride;
        let w = load(simd, inverse_mass, at);
        let upper_above = if k + 2 < count { load(simd, &work.upper, (k + 1) * LANES) } else { zero };
        let lambda = load(simd, &work.lambda, k * LANES) - upper_above * lambda_above;
        store(lambda, &mut work.lambda, k * LANES);
        let pull = Vec3x8::load(simd, &work.normal, k * LANES) * lambda;
        let x = Vec3x8::load(simd, position, at) + (pull - pull_above) * w;
        x.store(position, at);
        (lambda_above, pull_above) = (lambda, pull);
    }
    let w = load(simd, inverse_mass, base);
    let x = Vec3x8::load(simd, position, base) - pull_above * w;
    x.store(position, base);
}

/// Adds to `load` of each particle of the runs the larger tension of its two links in the last [`stretch`], over the
/// rest length: −λ/(h² l), N/m.
#[inline(always)]
pub(crate) fn record_load<S: Simd>(simd: S, block: Block, work: &Elimination, load_: &mut [f32], h: f32) {
    let Block { base, stride, count, spacing } = block;
    let scale = splat(simd, -1.0 / (h * h * spacing));
    let mut before = splat(simd, 0.0);
    for k in 0..count {
        let after = if k + 1 < count { load(simd, &work.lambda, k * LANES) * scale } else { splat(simd, 0.0) };
        let at = base + k * stride;
        store(load(simd, load_, at) + before.max(after), load_, at);
        before = after;
    }
}

/// Bending of each run: at every inner particle the vector constraint `x_{k−1} − 2 x_k + x_{k+1} = 0`, whose energy
/// `½ D (width/l) |t₂ − t₁|²` is that of a hinge of angle θ, `|t₂ − t₁| = 2 sin(θ/2)` (isometric bending, Bergou et al.
/// 2006, along a line). It is linear in the positions, so it needs no normals and has no degenerate configuration.
///
/// `compliance` is l³/(D width h²), 1/kg. Three colours: no two constraints of a colour share a particle.
#[inline(always)]
pub(crate) fn bend<S: Simd>(
    simd: S,
    block: Block,
    position: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
) {
    let Block { base, stride, count, .. } = block;
    let two = splat(simd, 2.0);
    let four = splat(simd, 4.0);
    for colour in 1..=3 {
        let mut k = colour;
        while k + 1 < count {
            let (before, at, after) = (base + (k - 1) * stride, base + k * stride, base + (k + 1) * stride);
            let (x0, x1, x2) = (
                Vec3x8::load(simd, position, before),
                Vec3x8::load(simd, position, at),
                Vec3x8::load(simd, position, after),
            );
            let (w0, w1, w2) =
                (load(simd, inverse_mass, before), load(simd, inverse_mass, at), load(simd, inverse_mass, after));
            let curl = x0 + x2 - x1 * two;
            let s = curl * (splat(simd, 1.0) / (w0 + four * w1 + w2 + compliance));
            (x0 - s * w0).store(position, before);
            (x1 + s * (two * w1)).store(position, at);
            (x2 - s * w2).store(position, after);
            k += 3;
        }
    }
}

/// Copies rows `first..first + 8` of a grid into lanes: particle `c` of row `first + lane` goes to lane `lane` of
/// vector `c`. Rows past the last repeat it.
#[inline(always)]
pub(crate) fn gather_rows<S: Simd>(simd: S, from: &[f32], to: &mut [f32], grid: Rows, first: usize) {
    for c in (0..grid.stride).step_by(LANES) {
        let block = core::array::from_fn(|lane| {
            load(simd, from, (first + lane).min(grid.rows - 1) * grid.stride + c)
        });
        for (i, column) in transpose(block).into_iter().enumerate() {
            store(column, to, (c + i) * LANES);
        }
    }
}

/// The way back of [`gather_rows`].
#[inline(always)]
pub(crate) fn scatter_rows<S: Simd>(simd: S, from: &[f32], to: &mut [f32], grid: Rows, first: usize) {
    for c in (0..grid.stride).step_by(LANES) {
        let block = core::array::from_fn(|i| load(simd, from, (c + i) * LANES));
        for (lane, row) in transpose(block).into_iter().enumerate().take(grid.rows - first) {
            store(row, to, (first + lane) * grid.stride + c);
        }
    }
}

/// Rows of a grid as they lie in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    /// Number of rows.
    pub rows: usize,
    /// Slots from one row to the next.
    pub stride: usize,
}
