//! In-plane shear of a grid as a force, stable at any stiffness and any step.
//!
//! ```text
//!   C = u·v of every cell  →  stress λ = G a b C  →  smoothed along columns and rows  →  force −λ ∇C on four corners
//! ```
//!
//! Swept as a constraint, no cell gets stiffer than m/h²: a cotton sheet of 64 × 64 particles would lose three quarters of
//! its shear stiffness at 600 substeps a second. As a plain force it would explode. Here the stress is smoothed just so far
//! that no wave of it is too fast for the substep: `(1 − c h² G/σ ∂_x²)⁻¹` along rows, between two times `(1 − ½ c h² G/σ ∂_y²)⁻¹` along
//! columns, tridiagonal along each line. The whole is symmetric; in rows and then columns alone it would not be where these do not
//! end alike, at corners and pins, and would feed energy into leather that hangs by its corners.
//! Across a fold the forces of two cells point different ways, so there they are smoothed together the less the sharper it is, by
//! v · v' along rows and u · u' along columns; else cloth would tremble at sharp folds.
//! What changes slowly from cell to cell keeps its full stiffness, and the finer the step the less is smoothed; with
//! ω² h² ≤ 1/c the step is stable. The smoothed stress is still a force pair for each cell, from a potential: it keeps linear
//! and angular momentum, and energy as symplectic Euler does.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::constraint::kernel::lines::{self, Rows};
use crate::lanes::{LANES, Vec3x8, load, splat, store};
use crate::{Grid, Soa3};

/// ω² h² of the fastest shear wave after smoothing; 4 is the limit of stability.
pub(super) const FASTEST: f32 = 2.0;

/// The same before filtering, in the shortest substep of a tick. What filters takes it that neighbouring cells lie in one plane. Of
/// paper crumpled in a crash they do not, and what is stiffer than this goes on shaking there, or flies apart.
pub(in crate::constraint) const STIFFEST: f32 = 20.0;

/// The product of two edges, in rest lengths, from which on they are alike: that of edges at 37°.
const UNLIKE: f32 = 0.8;

/// The stress of each cell, and the working memory to find it.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(in crate::constraint) struct Stress {
    /// λ h² of each cell, per slot of its upper left corner, N·s².
    pub lambda: Vec<f32>,
    /// How alike v of each cell and the next in its row turn, u of each and the next in its column: see [`alike`].
    alike: [Vec<f32>; 2],
    upper: Vec<f32>,
    rows: Vec<f32>,
    rows_alike: Vec<f32>,
    rows_above: Vec<f32>,
    rows_below: Vec<f32>,
}

/// What the stress of the cells follows from.
#[derive(Clone, Copy, Debug)]
pub(in crate::constraint) struct Sheet<'a> {
    pub grid: &'a Grid,
    /// 1 for a cell that is there, 0 for none, per slot of its upper left corner.
    pub mask: &'a [f32],
    /// G, N/m.
    pub shear: f32,
    /// σ, kg/m².
    pub density: f32,
}

/// Smooths eight lines of cells at once: `y_k = x_k + c ((w_k + w_{k+1}) x_k − ρ_k w_k x_{k−1} − ρ_{k+1} w_{k+1} x_{k+1})`, w_k the mean
/// mobility of the two particles between cells k − 1 and k, ρ_k how alike these turn. At a free edge, where the particles have half
/// the mass and stress must vanish, that is what makes it vanish; at a pinned edge it may stand. The inverse masses of the two particles
/// are given as they lie beside the values, ρ beside the first of its two cells, c with the half of the mean as their scale.
// No closure here: it would be compiled without the instruction set that `find` is dispatched to.
#[inline(always)]
fn smooth<S: Simd>(
    simd: S,
    (values, base, stride, count): (&mut [f32], usize, usize, usize),
    (one_side, other_side, scale): (&[f32], &[f32], f32),
    alike: &[f32],
    upper: &mut [f32],
) {
    let (one, scale) = (splat(simd, 1.0), splat(simd, scale));
    let mut before = (load(simd, one_side, base) + load(simd, other_side, base)) * scale;
    let (mut last, mut last_upper, mut near) = (splat(simd, 0.0), splat(simd, 0.0), splat(simd, 0.0));
    for k in 0..count {
        let at = base + k * stride;
        let after = (load(simd, one_side, at + stride) + load(simd, other_side, at + stride)) * scale;
        let inverse = one / (one + before + after - near * last_upper);
        last = (load(simd, values, at) + near * last) * inverse;
        near = after * load(simd, alike, at);
        last_upper = near * inverse;
        store(last, values, at);
        store(last_upper, upper, k * LANES);
        before = after;
    }
    for k in (0..count - 1).rev() {
        let at = base + k * stride;
        last = load(simd, values, at) + load(simd, upper, k * LANES) * last;
        store(last, values, at);
    }
}

impl Stress {
    pub fn new(grid: &Grid) -> Self {
        let (stride, rows) = (grid.stride as usize, grid.rows as usize);
        let line = vec![0.0; stride * LANES];
        Self {
            lambda: vec![0.0; stride * rows + 2 * LANES],
            alike: [(); 2].map(|()| vec![0.0; stride * rows + 2 * LANES]),
            rows_alike: line.clone(),
            upper: vec![0.0; stride.max(rows) * LANES],
            rows: line.clone(),
            rows_above: line.clone(),
            rows_below: line,
        }
    }

    /// Finds the stress of every cell where a substep begins, smoothed for substeps of length `h`. That must not change with every
    /// substep: what is stiffer at one time and softer at another takes up energy and gives back more.
    #[inline(always)]
    pub fn find<S: Simd>(&mut self, simd: S, sheet: Sheet<'_>, position: &Soa3, inverse_mass: &[f32], h: f32) {
        let Sheet { grid, mask, shear, density } = sheet;
        let (a, b) = (grid.spacing.x, grid.spacing.y);
        let (columns, rows, stride) = (grid.columns as usize, grid.rows as usize, grid.stride as usize);
        let scale = splat(simd, shear * a * b * h * h);
        let (half_a, half_b) = (splat(simd, 0.5 / a), splat(simd, 0.5 / b));
        // h² G/σ over the squares of the spacings: unsmoothed, the fastest wave has ω² h² four times their sum.
        let wave = h * h * shear / density;
        let (along, down) = (wave / (a * a), wave / (b * b));
        let share = 1.0 / FASTEST - 1.0 / (4.0 * (along + down));
        let is_smoothed = share > 0.0;
        for row in 0..rows - 1 {
            for at in (row * stride..row * stride + columns - 1).step_by(LANES) {
                let (p00, p10) = (Vec3x8::load(simd, position, at), Vec3x8::load(simd, position, at + 1));
                let below = at + stride;
                let (p01, p11) = (Vec3x8::load(simd, position, below), Vec3x8::load(simd, position, below + 1));
                let (e, f) = (p11 - p00, p10 - p01);
                let (u, v) = ((e + f) * half_a, (e - f) * half_b);
                let stress = u.dot(v) * scale * relief(simd, u, v) * load(simd, mask, at);
                store(stress, &mut self.lambda, at);
                if !is_smoothed {
                    continue;
                }
                // The same of the cell at the right and of that below; there is none below the last row, and nothing reads what is found.
                let (p20, p21) = (Vec3x8::load(simd, position, at + 2), Vec3x8::load(simd, position, below + 2));
                let lower = below + if row + 2 < rows { stride } else { 0 };
                let (p02, p12) = (Vec3x8::load(simd, position, lower), Vec3x8::load(simd, position, lower + 1));
                store(alike(simd, v, ((p21 - p10) - (p20 - p11)) * half_b), &mut self.alike[0], at);
                store(alike(simd, u, ((p12 - p01) + (p11 - p02)) * half_a), &mut self.alike[1], at);
            }
        }
        if !is_smoothed {
            return;
        }
        // Half, for the mean of two particles; times the mass of a cell, so that an inner particle has mobility 1.
        let cell = 0.5 * density * a * b * share;
        self.smooth_columns(simd, grid, inverse_mass, 0.5 * down * cell);
        let of_cells = Rows { rows: rows - 1, stride };
        for first in (0..rows - 1).step_by(LANES) {
            lines::gather_rows(simd, &self.lambda, &mut self.rows, 0, of_cells, first);
            lines::gather_rows(simd, inverse_mass, &mut self.rows_above, 0, of_cells, first);
            lines::gather_rows(simd, &inverse_mass[stride..], &mut self.rows_below, 0, of_cells, first);
            let mobility = (self.rows_above.as_slice(), self.rows_below.as_slice(), along * cell);
            lines::gather_rows(simd, &self.alike[0], &mut self.rows_alike, 0, of_cells, first);
            smooth(simd, (&mut self.rows, 0, LANES, columns - 1), mobility, &self.rows_alike, &mut self.upper);
            lines::scatter_rows(simd, &self.rows, 0, &mut self.lambda, of_cells, first);
        }
        self.smooth_columns(simd, grid, inverse_mass, 0.5 * down * cell);
    }

    #[inline(always)]
    fn smooth_columns<S: Simd>(&mut self, simd: S, grid: &Grid, inverse_mass: &[f32], scale: f32) {
        let (columns, rows, stride) = (grid.columns as usize, grid.rows as usize, grid.stride as usize);
        for base in (0..columns - 1).step_by(LANES) {
            let mobility = (inverse_mass, &inverse_mass[1..], scale);
            smooth(simd, (&mut self.lambda, base, stride, rows - 1), mobility, &self.alike[1], &mut self.upper);
        }
    }
}

/// How alike two edges in rest lengths turn, from −1 to 1. Of cloth in one plane, or nearly, it is 1 whatever it does, so that what smooths
/// it does not change: changes would give energy to stiff fabric.
#[inline(always)]
fn alike<S: Simd>(simd: S, one: Vec3x8<S>, other: Vec3x8<S>) -> f32x8<S> {
    (one.dot(other) * splat(simd, 1.0 / UNLIKE)).min(splat(simd, 1.0)).max(splat(simd, -1.0))
}

/// 1 up to a stretch of a tenth, less beyond: forces of cells torn apart by an impact would grow with the cube of their size.
#[inline(always)]
pub(super) fn relief<S: Simd>(simd: S, u: Vec3x8<S>, v: Vec3x8<S>) -> f32x8<S> {
    let one = splat(simd, 1.0);
    let size = (u.dot(u).max(one) * v.dot(v).max(one) * splat(simd, 1.0 / 1.21)).max(one);
    one / (size * size)
}
