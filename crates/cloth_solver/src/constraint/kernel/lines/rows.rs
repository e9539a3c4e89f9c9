//! Rows of a grid into lanes and back.

use fearless_simd::Simd;

use crate::lanes::{LANES, load, splat, store, transpose};

/// Copies rows `first..first + 8` of a grid into lanes: particle `c` of row `first + lane` goes to lane `lane` of
/// vector `c`, from `base` on. Rows past the last repeat it.
#[inline(always)]
pub(crate) fn gather_rows<S: Simd>(simd: S, from: &[f32], to: &mut [f32], base: usize, grid: Rows, first: usize) {
    // No closures here either: see `shear::smooth`.
    for c in (0..grid.stride).step_by(LANES) {
        let mut block = [splat(simd, 0.0); LANES];
        for (lane, row) in block.iter_mut().enumerate() {
            *row = load(simd, from, (first + lane).min(grid.rows - 1) * grid.stride + c);
        }
        let block = transpose(block);
        for (i, column) in block.iter().enumerate() {
            store(*column, to, base + (c + i) * LANES);
        }
    }
}

/// The way back of [`gather_rows`].
#[inline(always)]
pub(crate) fn scatter_rows<S: Simd>(simd: S, from: &[f32], base: usize, to: &mut [f32], grid: Rows, first: usize) {
    for c in (0..grid.stride).step_by(LANES) {
        let mut block = [splat(simd, 0.0); LANES];
        for (i, column) in block.iter_mut().enumerate() {
            *column = load(simd, from, base + (c + i) * LANES);
        }
        let block = transpose(block);
        for (lane, row) in block.iter().enumerate().take(grid.rows - first) {
            store(*row, to, (first + lane) * grid.stride + c);
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
