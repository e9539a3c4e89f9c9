//! Which particles are near a flame: cells of space, hashed into a table (Teschner et al. 2003).

use glam::{IVec3, Vec3};

use crate::Soa3;

/// Points sorted by the cell of space they lie in.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Width of a cell, m.
    width: f32,
    /// The largest [`Point::cell`], m.
    pub widest: f32,
    /// Where the points of each bucket start; one more at the end. The number of buckets is a power of two.
    start: Vec<u32>,
    /// Bucket by bucket.
    pub points: Vec<Point>,
    /// The buckets of the points while they are sorted.
    buckets: Vec<u32>,
}

/// A particle that a flame may heat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Point {
    /// Where it is, m.
    pub at: Vec3,
    /// Width of the cloth it stands for, m.
    pub cell: f32,
    /// Its slot.
    pub slot: u32,
}

impl Cells {
    /// Room for `slots` points.
    pub fn new(slots: usize) -> Self {
        let table = slots.next_power_of_two();
        Self {
            width: 1.0,
            widest: 0.0,
            start: vec![0; table + 1],
            points: Vec::with_capacity(slots),
            buckets: Vec::with_capacity(slots),
        }
    }

    /// Sorts the particles `slots`, which stand at `position` for cloth of the widths `cell` (m), into cells of `width` m.
    pub fn build(&mut self, width: f32, slots: impl Iterator<Item = u32> + Clone, position: &Soa3, cell: &[f32]) {
        (self.width, self.widest) = (width, 0.0);
        self.start.fill(0);
        self.buckets.clear();
        for slot in slots.clone() {
            let bucket = self.bucket(self.cell(position.get(slot as usize)));
            self.buckets.push(bucket as u32);
            self.start[bucket] += 1;
        }
        let mut sum = 0;
        for start in &mut self.start {
            sum += *start;
            *start = sum;
        }
        self.points.clear();
        self.points.resize(self.buckets.len(), Point::default());
        for (slot, bucket) in slots.zip(&self.buckets) {
            let place = &mut self.start[*bucket as usize];
            *place -= 1;
            let at = position.get(slot as usize);
            let point = Point { at, cell: cell[slot as usize], slot };
            self.points[*place as usize] = point;
            self.widest = self.widest.max(point.cell);
        }
    }

    /// Visits every point within the box of the corners `low` and `high`, and others, some of them twice.
    pub fn visit(&self, low: Vec3, high: Vec3, mut visit: impl FnMut(&Point)) {
        if self.points.is_empty() {
            return;
        }
        let (low, high) = (self.cell(low), self.cell(high));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let bucket = self.bucket(IVec3::new(x, y, z));
                    let points = self.start[bucket] as usize..self.start[bucket + 1] as usize;
                    self.points[points].iter().for_each(&mut visit);
                }
            }
        }
    }

    fn cell(&self, at: Vec3) -> IVec3 {
        (at / self.width).floor().as_ivec3()
    }

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
            let mut found: Vec<u32> = Vec::new();
            cells.visit(low, high, |point| found.push(point.slot));
            found.retain(|slot| inside(at(*slot as usize)));
            found.sort_unstable();
            found.dedup();
            let wanted: Vec<u32> = (0..500).filter(|i| i % 3 > 0 && inside(at(*i as usize))).collect();
            assert!(wanted.len() > 5);
            assert_eq!(found, wanted);
        }
    }
}
