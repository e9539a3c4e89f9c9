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

use super::sweep::Compliance;
use super::wear::{Links, New, Worn};
use crate::Soa3;
use crate::lanes::{LANES, Vec3x8, load, splat, store, transpose};

/// T h²/(m l) up to which the waves across a line are left explicit: those of warp and weft add up, and the limit is ⅓.
pub(crate) const EXPLICIT_LOAD: f32 = 0.22;

/// Up to which T h²/(m l), predicted strain and 1 − cos of the turn within a substep a link pulls along the direction it had
/// when the substep began; beyond three times as much it pulls along the one it is predicted to have. See [`stretch`].
const CALM_LOAD: f32 = 0.18;
const CALM_STRAIN: f32 = 0.008;
const CALM_TURN: f32 = 0.025;

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

impl Block {
    /// Where the vector of the k-th particles starts.
    pub const fn at(&self, k: usize) -> usize {
        self.base + k * self.stride
    }

    /// Every second particle from the first (`0`) or second (`1`) on.
    pub const fn every_second(&self, from: usize) -> Self {
        Self {
            base: self.base + from * self.stride,
            stride: 2 * self.stride,
            count: (self.count + 1 - from) / 2,
            spacing: 2.0 * self.spacing,
        }
    }
}

/// What the exact solve of a block keeps between its two passes: eight lanes per particle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    vector: Soa3,
    upper: Vec<f32>,
    far: Vec<f32>,
}

impl Elimination {
    /// For runs of up to `longest` particles.
    pub fn new(longest: usize) -> Self {
        let len = longest * LANES;
        Self { vector: Soa3::zeros(len), upper: vec![0.0; len], far: vec![0.0; len] }
    }
}

/// Bending and stretch of each run, with the factors of its links if they are worn; multipliers and load as [`stretch`] leaves
/// them.
#[inline(always)]
pub(crate) fn solve<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: Compliance<S>,
    worn: Option<Worn<'_>>,
    lambda: &mut [f32],
    work: &mut Elimination,
) -> f32x8<S> {
    let Compliance { stretch: along, bend: across } = compliance;
    match worn {
        None => {
            if let Some(across) = across {
                bend(simd, block, position, moved, inverse_mass, across, New, work);
            }
            stretch(simd, block, position, moved, inverse_mass, along, New, lambda, work)
        }
        Some(worn) => {
            if let Some(across) = across {
                bend(simd, block, position, moved, inverse_mass, across, worn, work);
            }
            stretch(simd, block, position, moved, inverse_mass, along, worn, lambda, work)
        }
    }
}

/// How far a link pulls along the direction it had: 1 in calm, 0 in a storm. From T h²/(m l), strain and 1 − cos of the turn.
#[inline(always)]
pub(super) fn calm<S: Simd>(simd: S, load_ratio: f32x8<S>, strain: f32x8<S>, turn: f32x8<S>) -> f32x8<S> {
    let storm = (load_ratio * splat(simd, 0.5 / CALM_LOAD))
        .max(strain.abs() * splat(simd, 0.5 / CALM_STRAIN))
        .max(turn * splat(simd, 0.5 / CALM_TURN));
    (splat(simd, 1.5) - storm).max(splat(simd, 0.0)).min(splat(simd, 1.0))
}

/// Solves the stretch constraints `|x_{k+1} − x_k| = spacing` of each run together: one Newton step of the XPBD
/// system (Macklin, Müller, Chentanez 2016), tridiagonal in the multipliers, by the Thomas algorithm:
/// `A_kk = (w_k + w_{k+1}) p_k·p_k + α̃`, `A_{k−1,k} = −w_k p_{k−1}·p_k`, `A λ = −C`; p_k is the direction link k pulls along.
///
/// XPBD pulls along the direction n_k a link is predicted to have, which is implicit for the waves across the line and damps them as implicit Euler does: a curtain
/// would lose a twelfth of its swing in five seconds. Pulled along the direction at the start of the substep, as in SHAKE
/// (Ryckaert, Ciccotti, Berendsen 1977), waves and swings keep their energy and the whole its angular momentum, while the
/// constraint still holds at the end. That is explicit for the waves, so it is left where it could not be resolved: under a
/// high load, in an impact, in a whip (`CALM_*`).
///
/// `compliance` is α̃ = α/h², 1/kg. Leaves the multipliers in `lambda`, eight lanes per link, and returns the largest
/// T h²/(m l) = −λ/(m l) of each run, m the lighter end of a link.
#[inline(always)]
fn stretch<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
    links: impl Links,
    lambda: &mut [f32],
    work: &mut Elimination,
) -> f32x8<S> {
    let Block { base, stride, count, spacing } = block;
    let zero = splat(simd, 0.0);
    let one = splat(simd, 1.0);
    let tiny = splat(simd, f32::MIN_POSITIVE);
    let rest = splat(simd, spacing);
    let per_spacing = splat(simd, 1.0 / spacing);

    let mut x = Vec3x8::load(simd, position, base);
    let mut moves = Vec3x8::load(simd, moved, base);
    let mut w = load(simd, inverse_mass, base);
    let mut last = Vec3x8 { x: zero, y: zero, z: zero };
    let (mut last_inverse, mut last_rhs) = (zero, zero);
    for k in 0..count - 1 {
        let next = base + (k + 1) * stride;
        let (x_next, moves_next) = (Vec3x8::load(simd, position, next), Vec3x8::load(simd, moved, next));
        let w_next = load(simd, inverse_mass, next);
        let before = x_next - x;
        let d = before + (moves_next - moves);
        let length = d.length();
        let rest = links.rest(simd, k, rest);
        // A link of no length has no direction: its normal is 0, not NaN, and it gets no correction.
        let normal = d * (one / length.max(tiny));
        let before = before * (one / before.length().max(tiny));
        let load_ratio = load(simd, lambda, k * LANES) * w.max(w_next) * (zero - per_spacing);
        let share = calm(simd, load_ratio, (length - rest) * per_spacing, one - before.dot(normal));
        let pull = normal + (before - normal) * share;
        let off = -(w * last.dot(pull));
        let upper = off * last_inverse;
        // Only neighbours that are both pinned, of an infinitely stiff fabric, make the pivot 0; λ is of no use there.
        let inverse =
            one / ((w + w_next) * pull.dot(pull) + links.compliance(simd, k, compliance) - off * upper).max(tiny);
        let rhs = (rest - length - off * last_rhs) * inverse;
        pull.store(&mut work.vector, k * LANES);
        store(upper, &mut work.upper, k * LANES);
        store(rhs, lambda, k * LANES);
        (last, last_inverse, last_rhs) = (pull, inverse, rhs);
        (x, moves, w) = (x_next, moves_next, w_next);
    }

    // Back substitution; particle k+1 is corrected once the multipliers on both its sides are known.
    let (mut lambda_above, mut load_ratio) = (zero, zero);
    let mut pull_above = Vec3x8 { x: zero, y: zero, z: zero };
    for k in (0..count - 1).rev() {
        let at = base + (k + 1) * stride;
        let w = load(simd, inverse_mass, at);
        let upper_above = if k + 2 < count { load(simd, &work.upper, (k + 1) * LANES) } else { zero };
        let multiplier = load(simd, lambda, k * LANES) - upper_above * lambda_above;
        store(multiplier, lambda, k * LANES);
        load_ratio = load_ratio.max(-(multiplier.min(lambda_above) * w));
        let pull = Vec3x8::load(simd, &work.vector, k * LANES) * multiplier;
        (Vec3x8::load(simd, moved, at) + (pull - pull_above) * w).store(moved, at);
        (lambda_above, pull_above) = (multiplier, pull);
    }
    let w = load(simd, inverse_mass, base);
    (Vec3x8::load(simd, moved, base) - pull_above * w).store(moved, base);
    load_ratio.max(-(lambda_above * w)) * splat(simd, 1.0 / spacing)
}

/// Adds `scale` T h²/l to `inertia` of each particle, kg, T the larger tension of its two links in the last [`stretch`].
#[inline(always)]
pub(crate) fn record_load<S: Simd>(simd: S, block: Block, lambda: &[f32], scale: f32, inertia: &mut [f32]) {
    let Block { base, stride, count, spacing } = block;
    let zero = splat(simd, 0.0);
    let scale = splat(simd, -scale / spacing);
    let mut before = zero;
    for k in 0..count {
        let after = if k + 1 < count { load(simd, lambda, k * LANES) * scale } else { zero };
        let at = base + k * stride;
        store(load(simd, inertia, at) + before.max(after).max(zero), inertia, at);
        before = after;
    }
}

/// Makes the transverse waves of taut runs implicit: `(M + θ h² G) Δ' = M Δ`, Δ what each particle moved in this
/// substep, G the string's stiffness from the tension T h² = −λ of the last [`stretch`] beyond [`EXPLICIT_LOAD`].
///
/// Under such a load an exact line pulls along where its links are predicted to point without it. To the waves that run
/// across it that is an explicit step: with g = h² ω² it is stable for g < 4/3, and the highest wave has g = 4 T h²/(m l).
/// Filtered so, it is stable for every g if θ ≥ 3/2. What does not move, and what all moves alike, is left as it is.
#[inline(always)]
pub(crate) fn soften<S: Simd>(
    simd: S,
    block: Block,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    lambda: &[f32],
    work: &mut Elimination,
) {
    const THETA: f32 = 1.5;
    let Block { base, stride, count, spacing } = block;
    let (zero, one, tiny) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, f32::MIN_POSITIVE));
    let theta = splat(simd, THETA);
    let mut before = zero;
    let (mut upper, mut last) = (zero, Vec3x8 { x: zero, y: zero, z: zero });
    for k in 0..count {
        let at = base + k * stride;
        let w = load(simd, inverse_mass, at);
        let after = if k + 1 < count {
            let lighter = w.max(load(simd, inverse_mass, at + stride)).max(tiny);
            let tension = load(simd, lambda, k * LANES) * splat(simd, -1.0 / spacing);
            (tension - splat(simd, EXPLICIT_LOAD) / lighter).max(zero) * theta
        } else {
            zero
        };
        let moves = Vec3x8::load(simd, moved, at);
        // Row k: −w before · Δ'_{k−1} + (1 + w (before + after)) Δ'_k − w after · Δ'_{k+1} = Δ_k.
        let lower = w * before;
        let inverse = one / (one + w * (before + after) - lower * upper);
        last = (moves + last * lower) * inverse;
        upper = w * after * inverse;
        last.store(&mut work.vector, k * LANES);
        store(upper, &mut work.upper, k * LANES);
        before = after;
    }
    for k in (0..count).rev() {
        let at = base + k * stride;
        if k + 1 < count {
            last = Vec3x8::load(simd, &work.vector, k * LANES) + last * load(simd, &work.upper, k * LANES);
        }
        last.store(moved, at);
    }
}

/// Bending of each run: at every inner particle the vector constraint `x_{k−1} − 2 x_k + x_{k+1} = 0`, whose energy
/// `½ D (width/l) |t₂ − t₁|²` is that of a hinge of angle θ, `|t₂ − t₁| = 2 sin(θ/2)` (isometric bending, Bergou et al.
/// 2006, along a line). It is linear in the positions, so it needs no normals and has no degenerate configuration, and
/// all constraints of a run are solved together, by the LDLᵀ factors of the pentadiagonal system: `A_kk = w_{k−1} + 4 w_k
/// + w_{k+1} + α̃`, `A_{k,k+1} = −2 (w_k + w_{k+1})`, `A_{k,k+2} = w_{k+1}`. Swept, fine meshes would not get stiff.
///
/// `compliance` is l³/(D width h²), 1/kg.
#[inline(always)]
fn bend<S: Simd>(
    simd: S,
    block: Block,
    position: &Soa3,
    moved: &mut Soa3,
    inverse_mass: &[f32],
    compliance: f32x8<S>,
    links: impl Links,
    work: &mut Elimination,
) {
    let Block { base, stride, count, .. } = block;
    let (zero, one, two) = (splat(simd, 0.0), splat(simd, 1.0), splat(simd, 2.0));
    let none = Vec3x8 { x: zero, y: zero, z: zero };
    if count < 3 {
        return;
    }
    let at = |k: usize| base + k * stride;
    let mut start = Vec3x8::load(simd, position, at(1));
    let mut moves = Vec3x8::load(simd, moved, at(1));
    let mut edge = start - Vec3x8::load(simd, position, at(0)) + (moves - Vec3x8::load(simd, moved, at(0)));
    let (mut w0, mut w1) = (load(simd, inverse_mass, at(0)), load(simd, inverse_mass, at(1)));
    // Of the rows k−1 and k−2: the pivot's inverse, the factor next to the diagonal, the right-hand side.
    let (mut inverse1, mut inverse2, mut near1, mut y1, mut y2) = (zero, zero, zero, none, none);
    for k in 1..count - 1 {
        let (start_next, moves_next) = (Vec3x8::load(simd, position, at(k + 1)), Vec3x8::load(simd, moved, at(k + 1)));
        let edge_next = start_next - start + (moves_next - moves);
        let w2 = load(simd, inverse_mass, at(k + 1));
        let inner = if k > 1 { one } else { zero };
        let far = if k > 2 { w0 } else { zero };
        // The factors below the diagonal times their pivots; the nearer one, which is negative, with its sign turned.
        let near = two * (w0 + w1) * inner - far * near1;
        let (near_factor, far_factor) = (near * inverse1, far * inverse2);
        let pivot = w0 + two * two * w1 + w2 + links.bend(simd, k, compliance) - near_factor * near - far_factor * far;
        let inverse = one / pivot;
        let curl = edge - edge_next;
        let y = curl + y1 * near_factor - y2 * far_factor;
        (y * inverse).store(&mut work.vector, k * LANES);
        store(near_factor, &mut work.upper, k * LANES);
        store(far_factor, &mut work.far, k * LANES);
        (inverse2, inverse1, near1, y2, y1) = (inverse1, inverse, near_factor, y1, y);
        (start, moves, edge, w0, w1) = (start_next, moves_next, edge_next, w1, w2);
    }
    // Back: λ_k = z_k + near_{k+1} λ_{k+1} − far_{k+2} λ_{k+2}; a particle moves once its three multipliers are known.
    let (mut lambda1, mut lambda2) = (none, none);
    let (mut near1, mut far1, mut far2) = (zero, zero, zero);
    for k in (1..count - 1).rev() {
        let z = Vec3x8::load(simd, &work.vector, k * LANES);
        let lambda = z + lambda1 * near1 - lambda2 * far2;
        let next = at(k + 1);
        let push = lambda - lambda1 * two + lambda2;
        let w = load(simd, inverse_mass, next);
        (Vec3x8::load(simd, moved, next) + push * w).store(moved, next);
        far2 = far1;
        near1 = load(simd, &work.upper, k * LANES);
        far1 = load(simd, &work.far, k * LANES);
        (lambda2, lambda1) = (lambda1, lambda);
    }
    for (k, push) in [(1, lambda2 - lambda1 * two), (0, lambda1)] {
        let w = load(simd, inverse_mass, at(k));
        (Vec3x8::load(simd, moved, at(k)) + push * w).store(moved, at(k));
    }
}

/// Copies rows `first..first + 8` of a grid into lanes: particle `c` of row `first + lane` goes to lane `lane` of
/// vector `c`. Rows past the last repeat it.
#[inline(always)]
pub(crate) fn gather_rows<S: Simd>(simd: S, from: &[f32], to: &mut [f32], grid: Rows, first: usize) {
    for c in (0..grid.stride).step_by(LANES) {
        let block = core::array::from_fn(|lane| load(simd, from, (first + lane).min(grid.rows - 1) * grid.stride + c));
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
