//! What became of the fabric: factors on the stiffness and the rest length around each particle.

use super::kernel::links::{Block, GONE, New, Worn};
use crate::Grid;
use crate::lanes::LANES;
use crate::topology::{Along, Change};

/// What wear does to the particles of a cloth, one number per slot.
#[derive(Clone, Copy, Debug)]
pub struct Wear<'a> {
    /// Factor on stiffness around a particle, 0..=1.
    pub stiffness: &'a [f32],
    /// Factor on rest lengths around a particle, above 0.
    pub rest: &'a [f32],
}

/// What forces ask of the fabric. Two kinds again, so that what is not worn pays nothing.
pub(super) trait Condition: Copy {
    /// The factors on the stiffness and on the rest length of the link between two slots.
    fn of_link(self, link: [usize; 2]) -> (f32, f32);
    /// The factor on the stiffness of a cell.
    fn of_cell(self, corners: [usize; 4]) -> f32;
    /// The factors on the compliance and on the rest length of a triangle.
    fn of_triangle(self, corners: [u32; 3]) -> (f32, f32);
}

impl Condition for New {
    fn of_link(self, _: [usize; 2]) -> (f32, f32) {
        (1.0, 1.0)
    }

    fn of_cell(self, _: [usize; 4]) -> f32 {
        1.0
    }

    fn of_triangle(self, _: [u32; 3]) -> (f32, f32) {
        (1.0, 1.0)
    }
}

impl Condition for Wear<'_> {
    fn of_link(self, link: [usize; 2]) -> (f32, f32) {
        let link = link.map(|slot| slot as u32);
        (1.0 / self.compliance(link), self.rest(link))
    }

    fn of_cell(self, corners: [usize; 4]) -> f32 {
        Wear::of_cell(&self, corners.map(|slot| slot as u32))
    }

    fn of_triangle(self, corners: [u32; 3]) -> (f32, f32) {
        Wear::of_triangle(&self, corners)
    }
}

/// The wear of a cloth, kept for methods that step forces and for constraints that are rebuilt.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Kept {
    stiffness: Vec<f32>,
    rest: Vec<f32>,
}

impl Kept {
    /// Takes over what became of the particles.
    pub fn update(&mut self, wear: Wear<'_>) {
        for (kept, told) in [(&mut self.stiffness, wear.stiffness), (&mut self.rest, wear.rest)] {
            kept.clear();
            kept.extend_from_slice(told);
        }
    }

    /// Takes over that the cloth was taken apart: what is born is as worn as its parents.
    pub fn follow(&mut self, change: &Change) {
        for kept in [&mut self.stiffness, &mut self.rest] {
            kept.resize(change.slots, 1.0);
            for born in &change.born {
                kept[born.slot as usize] = born.blend(|slot| kept[slot]);
            }
        }
    }

    /// As it was told.
    pub fn wear(&self) -> Wear<'_> {
        Wear { stiffness: &self.stiffness, rest: &self.rest }
    }
}

impl Wear<'_> {
    /// The factor on the compliance of the link between two slots.
    pub(in crate::constraint) fn compliance(&self, [a, b]: [u32; 2]) -> f32 {
        let stiffness = 0.5 * (self.stiffness[a as usize] + self.stiffness[b as usize]);
        (1.0 / stiffness).min(GONE)
    }

    /// The factor on the stiffness of a cell; never 0, which would say that there is none.
    pub(super) fn of_cell(&self, corners: [u32; 4]) -> f32 {
        (0.25 * corners.iter().map(|slot| self.stiffness[*slot as usize]).sum::<f32>()).max(1.0 / GONE)
    }

    /// The factors on the compliance and on the rest length of a triangle.
    pub(super) fn of_triangle(&self, corners: [u32; 3]) -> (f32, f32) {
        let mean = |of: &[f32]| corners.iter().map(|slot| of[*slot as usize]).sum::<f32>() / 3.0;
        ((1.0 / mean(self.stiffness)).min(GONE), mean(self.rest))
    }

    /// The factor on the rest length of the link between two slots.
    pub(super) fn rest(&self, [a, b]: [u32; 2]) -> f32 {
        0.5 * (self.rest[a as usize] + self.rest[b as usize])
    }
}

/// The factors of all links of a grid: blocks of eight runs, eight lanes per link.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(super) struct WornGrid {
    weft: [Vec<f32>; 2],
    warp: [Vec<f32>; 2],
}

impl WornGrid {
    /// Nothing worn yet.
    pub fn new(grid: &Grid) -> Self {
        let (columns, rows) = (grid.columns as usize, grid.rows as usize);
        let [weft, warp] = [rows.next_multiple_of(LANES) * columns, grid.stride as usize * rows];
        Self { weft: [vec![1.0; weft], vec![1.0; weft]], warp: [vec![1.0; warp], vec![1.0; warp]] }
    }

    /// Takes over what became of the particles.
    pub fn update(&mut self, grid: &Grid, wear: Wear<'_>) {
        let (columns, rows) = (grid.columns as usize, grid.rows as usize);
        for row in 0..rows {
            for k in 0..columns - 1 {
                let slot = grid.slot(row as u32, k as u32);
                let (link, at) = ([slot, slot + 1], index(row, columns, k));
                (self.weft[0][at], self.weft[1][at]) = (wear.compliance(link), wear.rest(link));
            }
        }
        for k in 0..rows - 1 {
            for column in 0..columns {
                let slot = grid.slot(k as u32, column as u32);
                let (link, at) = ([slot, slot + grid.stride], index(column, rows, k));
                (self.warp[0][at], self.warp[1][at]) = (wear.compliance(link), wear.rest(link));
            }
        }
    }

    /// The links along `along` of the block that starts with run `first`.
    pub fn block(&self, along: Along, first: usize, block: Block) -> Worn<'_> {
        let [compliance, rest] = match along {
            Along::Weft => &self.weft,
            Along::Warp => &self.warp,
        };
        let range = first * block.count..(first + LANES) * block.count;
        Worn::new(&compliance[range.clone()], &rest[range])
    }
}

/// Where the number of link `k` of run `run`, of `count` particles, stands.
pub(super) const fn index(run: usize, count: usize, k: usize) -> usize {
    (run / LANES * count + k) * LANES + run % LANES
}
