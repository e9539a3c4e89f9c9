//! Which particles are near a flame: cells of space, hashed into a table (Teschner et al. 2003).

use glam::{IVec3, Vec3};

use crate::Soa3;
use crate::lanes::LANES;

/// Cells of space along the longest reach of a flame.
const CELLS_A_REACH: f32 = 3.0;

/// Points sorted by the cell of space they lie in.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Width of a cell, m.
    width: f32,
    /// Where the points of each bucket start; one more at the end. The number of buckets is a power of two.
    start: Vec<u32>,
    /// Where the points are, m, bucket by bucket. Behind the last come eight that are nowhere.
    pub at: Soa3,
    /// Width of the cloth that each point stands for, m.
    pub cloth: Vec<f32>,
    /// The slots of the points.
    pub slot: Vec<u32>,
    /// The largest of `cloth`, m.
    pub widest: f32,
    /// The buckets of the points while they are sorted.
    buckets: Vec<u32>,
}

impl Cells {
    /// Room for `slots` points.
    pub fn new(slots: usize) -> Self {
        let nowhere = || vec![f32::NAN; slots + LANES];
        Self {
            width: 1.0,
            start: vec![0; slots.next_power_of_two() + 1],
            at: Soa3 { x: nowhere(), y: nowhere(), z: nowhere() },
            cloth: nowhere(),
            slot: vec![0; slots + LANES],
            widest: 0.0,
            buckets: Vec::with_capacity(slots),
        }
    }

    /// Sorts the particles `slots`, which stand at `position` for cloth of the widths `cloth` (m), into cells that are
    /// not much smaller than `reach` (m) and the widths: a box about that large has few of them.
    pub fn build(&mut self, reach: f32, slots: impl Iterator<Item = usize> + Clone, position: &Soa3, cloth: &[f32]) {
        self.widest = cloth.iter().copied().fold(0.0, f32::max);
        self.width = CELLS_A_REACH.recip() * self.widest.max(reach);
        self.start.fill(0);
        self.buckets.clear();
        for slot in slots.clone() {
            let bucket = self.bucket(self.cell(position.get(slot)));
            self.buckets.push(bucket as u32);
            self.start[bucket] += 1;
        }
        let mut sum = 0;
        for start in &mut self.start {
            sum += *start;
            *start = sum;
        }
        for (slot, bucket) in slots.zip(&self.buckets) {
            let place = &mut self.start[*bucket as usize];
            *place -= 1;
            let place = *place as usize;
            self.at.set(place, position.get(slot));
            (self.cloth[place], self.slot[place]) = (cloth[slot], slot as u32);
        }
        let count = self.buckets.len();
        (count..count + LANES).for_each(|place| self.at.set(place, Vec3::NAN));
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.buckets.is_empty()
    }

    /// Where the points of `cell` are, and maybe others.
    #[inline(always)]
    pub fn points(&self, cell: IVec3) -> core::ops::Range<usize> {
        let bucket = self.bucket(cell);
        self.start[bucket] as usize..self.start[bucket + 1] as usize
    }

    /// The cell that a place is in.
    #[inline(always)]
    pub fn cell(&self, at: Vec3) -> IVec3 {
        (at / self.width).floor().as_ivec3()
    }

    #[inline(always)]
    fn bucket(&self, cell: IVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|k| k as u32);
        let hash = x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
        hash as usize & (self.start.len() - 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_in_a_box_is_found() {
        let at = |i: usize| Vec3::new((i * 37 % 101) as f32, (i * 53 % 97) as f32, (i * 71 % 89) as f32) * 0.01 - 0.4;
        let position = Soa3::from_slice(&(0..500).map(at).collect::<Vec<_>>());
        let mut cells = Cells::new(500);
        for width in [0.03, 0.2, 5.0] {
            cells.build(width, (0..500).filter(|i| i % 3 > 0), &position, &[0.01; 500]);
            let (low, high) = (Vec3::new(-0.21, -0.1, 0.05), Vec3::new(0.1, 0.33, 0.4));
            let inside = |at: Vec3| at.cmpge(low).all() && at.cmple(high).all();
            let (from, to) = (cells.cell(low), cells.cell(high));
            let mut found = Vec::new();
            for cell in (0..).map(|k| from + IVec3::new(k % 20, k / 20 % 20, k / 400)).take(8000) {
                if cell.cmple(to).all() {
                    found.extend_from_slice(&cells.slot[cells.points(cell)]);
                }
            }
            found.retain(|slot| inside(at(*slot as usize)));
            found.sort_unstable();
            found.dedup();
            let wanted: Vec<u32> = (0..500).filter(|i| i % 3 > 0 && inside(at(*i as usize))).collect();
            assert!(wanted.len() > 5);
            assert_eq!(found, wanted);
        }
    }
}
