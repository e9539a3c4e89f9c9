//! Links of a rectangle that are no longer there.

use fearless_simd::{Simd, f32x8};

use super::lines::Block;
use crate::Grid;
use crate::lanes::{LANES, load};

/// What a removed link adds to its compliance α̃, 1/kg: as good as infinite, so that its multiplier vanishes, and the systems
/// of its run keep their shape.
const GONE: f32 = 1e30;

/// What removal adds to the compliance of each link: blocks of eight runs, eight lanes per link.
#[derive(Clone, Debug)]
pub(super) struct Removed {
    weft: Vec<f32>,
    warp: Vec<f32>,
    /// Removed links along the weft and along the warp, and bends over them.
    links: [usize; 2],
    bends: [usize; 2],
}

/// Where links run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    Weft,
    Warp,
}

impl Removed {
    pub fn new(grid: &Grid) -> Self {
        let (columns, rows) = (grid.columns as usize, grid.rows as usize);
        Self {
            weft: vec![0.0; rows.next_multiple_of(LANES) * columns],
            warp: vec![0.0; grid.stride as usize * rows],
            links: [0; 2],
            bends: [0; 2],
        }
    }

    /// Removes the link between the slots `a` and `b`; `false` if they are no neighbours in a row or column, or it is gone.
    pub fn remove(&mut self, grid: &Grid, a: u32, b: u32) -> bool {
        let (a, b) = (a.min(b), a.max(b));
        let (row, column) = ((a / grid.stride) as usize, (a % grid.stride) as usize);
        let (columns, rows) = (grid.columns as usize, grid.rows as usize);
        let (along, run, k, count) = if b - a == 1 && column + 1 < columns && row < rows {
            (Along::Weft, row, column, columns)
        } else if b - a == grid.stride && column < columns && row + 1 < rows {
            (Along::Warp, column, row, rows)
        } else {
            return false;
        };
        let links = match along {
            Along::Weft => &mut self.weft,
            Along::Warp => &mut self.warp,
        };
        let at = |k: usize| index(run, count, k);
        if links[at(k)] > 0.0 {
            return false;
        }
        links[at(k)] = GONE;
        self.links[along as usize] += 1;
        // The bends at both its ends, unless the link beyond took them along.
        self.bends[along as usize] += usize::from(k > 0 && links[at(k - usize::from(k > 0))] == 0.0)
            + usize::from(k + 2 < count && links[at(k + 1)] == 0.0);
        true
    }

    /// Removed links, and bends over them along the weft and along the warp.
    pub fn count(&self) -> (usize, [usize; 2]) {
        (self.links[0] + self.links[1], self.bends)
    }

    /// The links along `along` of the block that starts with run `first`.
    pub fn block(&self, along: Along, first: usize, block: Block) -> Gone<'_> {
        let added = match along {
            Along::Weft => &self.weft,
            Along::Warp => &self.warp,
        };
        Gone { added: Some(&added[first * block.count..(first + LANES) * block.count]), first: 0, step: 1 }
    }

    /// Whether link `k` of run `run`, of `count` particles, is gone.
    pub fn is_gone(&self, along: Along, run: usize, count: usize, k: usize) -> bool {
        let added = match along {
            Along::Weft => &self.weft,
            Along::Warp => &self.warp,
        };
        added[index(run, count, k)] > 0.0
    }
}

const fn index(run: usize, count: usize, k: usize) -> usize {
    (run / LANES * count + k) * LANES + run % LANES
}

/// What removal adds to the compliance of the links of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gone<'a> {
    added: Option<&'a [f32]>,
    /// Link `k` stands for the links from `first + k * step` on, `step` in number.
    first: usize,
    step: usize,
}

impl Gone<'_> {
    /// Nothing removed.
    pub const NONE: Self = Self { added: None, first: 0, step: 1 };

    /// For [`Block::every_second`].
    pub const fn every_second(self, from: usize) -> Self {
        Self { first: from, step: 2, ..self }
    }

    /// `compliance` and what is added to it at link `k`.
    #[inline(always)]
    pub fn link<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S> {
        let Some(added) = self.added else { return compliance };
        let at = (self.first + k * self.step) * LANES;
        let one = compliance + load(simd, added, at);
        if self.step == 2 { one + load(simd, added, at + LANES) } else { one }
    }

    /// `compliance` and what is added to it at the bend over the links `k − 1` and `k`.
    #[inline(always)]
    pub fn bend<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S> {
        let Some(added) = self.added else { return compliance };
        compliance + load(simd, added, (k - 1) * LANES) + load(simd, added, k * LANES)
    }
}
