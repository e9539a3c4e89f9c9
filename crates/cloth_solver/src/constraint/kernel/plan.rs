//! Numbers of a sheet of rows and columns with a margin all round, so that every particle has neighbours to load.
//!
//! ```text
//!    ·  · · · · ·   ·        a row more above and below, which repeats the one beside it
//!    c  a b c · ·   a        eight numbers more before and after each row: in a closed row the next two to its ends are those
//!    c  a b c · ·   a        of the other end, in an open one its own
//!    ·  · · · · ·   ·
//! ```

use fearless_simd::Simd;

use crate::lanes::{LANES, load, splat, store, transpose};
use crate::topology::Quads;
use crate::{Grid, Soa3};

/// How numbers lie.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug)]
pub(in crate::constraint) struct Plan {
    pub rows: usize,
    pub columns: usize,
    /// Cells in a row.
    pub across: usize,
    pub closed: bool,
    /// From one row of particles to the next as particles lie.
    pub stride: usize,
    /// From one row to the next with the margin.
    pub pitch: usize,
}

impl Plan {
    pub fn new(quads: &Quads) -> Self {
        let Grid { rows, columns, stride, .. } = quads.grid;
        let [rows, columns, stride, across] = [rows, columns, stride, quads.across()].map(|count| count as usize);
        Self { rows, columns, across, closed: quads.closed, stride, pitch: stride + 2 * LANES }
    }

    /// How many numbers there are.
    pub const fn len(&self) -> usize {
        (self.rows + 2) * self.pitch + 2 * LANES
    }

    /// Where that of a particle is.
    pub const fn at(&self, row: usize, column: usize) -> usize {
        (row + 1) * self.pitch + LANES + column
    }

    /// Those of the particles in `from`, with the margin.
    pub fn fill(&self, from: &[f32], to: &mut [f32]) {
        for row in 0..self.rows {
            let at = self.at(row, 0);
            to[at..at + self.stride].copy_from_slice(&from[row * self.stride..(row + 1) * self.stride]);
            self.fill_ends(to, row);
        }
        let (first, last) = (self.pitch, self.rows * self.pitch);
        to.copy_within(first..first + self.pitch, 0);
        to.copy_within(last..last + self.pitch, last + self.pitch);
    }

    /// The ends of the margin beside `row`.
    pub fn fill_ends(&self, of: &mut [f32], row: usize) {
        let (first, last) = (self.at(row, 0), self.at(row, self.columns - 1));
        let (before, after) = if self.closed { (last, first) } else { (first, last) };
        (of[first - 1], of[last + 1]) = (of[before], of[after]);
    }

    pub fn fill3(&self, from: &Soa3, to: &mut Soa3) {
        self.fill(&from.x, &mut to.x);
        self.fill(&from.y, &mut to.y);
        self.fill(&from.z, &mut to.z);
    }

    /// A number for each slot that `value` has one for, 0 elsewhere, the margin of closed rows included.
    pub fn numbers(&self, value: impl Fn(usize) -> f32) -> Vec<f32> {
        let mut numbers = vec![0.0; self.len()];
        for row in 0..self.rows {
            for column in 0..self.columns {
                numbers[self.at(row, column)] = value(row * self.stride + column);
            }
            if self.closed {
                self.fill_ends(&mut numbers, row);
            }
        }
        numbers
    }

    /// Eight rows from `first` on, of `rows`, into lanes, `width` of each; beyond the last it is repeated.
    #[inline(always)]
    pub fn gather<S: Simd>(&self, simd: S, from: &[f32], to: &mut [f32], rows: usize, first: usize, width: usize) {
        for column in (0..width).step_by(LANES) {
            let mut block = [splat(simd, 0.0); LANES];
            for (lane, row) in block.iter_mut().enumerate() {
                *row = load(simd, from, self.at((first + lane).min(rows - 1), column));
            }
            let block = transpose(block);
            for (i, numbers) in block.iter().enumerate() {
                store(*numbers, to, (column + i) * LANES);
            }
        }
    }

    /// The way back of [`Self::gather`].
    #[inline(always)]
    pub fn scatter<S: Simd>(&self, simd: S, from: &[f32], to: &mut [f32], rows: usize, first: usize, width: usize) {
        for column in (0..width).step_by(LANES) {
            let mut block = [splat(simd, 0.0); LANES];
            for (i, numbers) in block.iter_mut().enumerate() {
                *numbers = load(simd, from, (column + i) * LANES);
            }
            let block = transpose(block);
            for (lane, row) in block.iter().enumerate().take(rows - first) {
                store(*row, to, self.at(first + lane, column));
            }
        }
    }

    /// The same numbers in lanes, every eight rows a block.
    pub fn lanes(&self, from: &[f32], rows: usize) -> Vec<f32> {
        let (width, mut lanes) = (self.stride + LANES, Vec::new());
        for first in (0..rows).step_by(LANES) {
            for k in 0..width {
                lanes.extend((0..LANES).map(|lane| from[self.at((first + lane).min(rows - 1), k)]));
            }
        }
        lanes
    }

    /// Where the block of eight rows from `first` on begins in them.
    pub const fn block(&self, first: usize) -> usize {
        first * (self.stride + LANES)
    }
}
