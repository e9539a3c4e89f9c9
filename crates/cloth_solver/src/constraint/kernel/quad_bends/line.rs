//! The system of the bends of eight lines side by side.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use super::RIGID;
use crate::Soa3;
use crate::lanes::{LANES, Vec3x8, load, splat, store};

/// Working memory for a line in lanes.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Line {
    pub values: Soa3,
    near: Vec<f32>,
    far: Vec<f32>,
    /// Of closed lines, the columns of the last two bends below the diagonal.
    ring: [Vec<f32>; 2],
}

/// Eight lines of bends.
#[derive(Clone, Copy)]
pub(super) struct Of<'a> {
    pub per_length: &'a [f32],
    pub stiffness: &'a [f32],
    pub weights: &'a [f32],
    pub stride: usize,
    pub count: usize,
}

/// The matrix next to a bend: what it has in common with itself, the one before and the one before that.
#[derive(Clone, Copy)]
struct Shared<S: Simd> {
    own: f32x8<S>,
    near: f32x8<S>,
    far: f32x8<S>,
}

impl Of<'_> {
    #[inline(always)]
    fn load<S: Simd>(self, simd: S, of: &[f32], k: usize) -> f32x8<S> {
        let round = if k >= 2 * self.count {
            2 * self.count
        } else if k >= self.count {
            self.count
        } else {
            0
        };
        load(simd, of, (k - round) * self.stride)
    }

    /// Those of bend `k`, which may be that many more than there are.
    #[inline(always)]
    fn shared<S: Simd, const CLOSED: bool>(self, simd: S, k: usize, scale: f32x8<S>, filter: f32x8<S>) -> Shared<S> {
        let zero = splat(simd, 0.0);
        let (count, k) = (self.count, k + self.count);
        let per_length = |by: usize| self.load(simd, self.per_length, k - by);
        let (after, before, before2) = (per_length(0), per_length(1), per_length(2));
        let (before, before2) = if CLOSED {
            (before, before2)
        } else {
            (if k - count >= 1 { before } else { zero }, if k - count >= 2 { before2 } else { zero })
        };
        let weight = |k: usize| self.load(simd, self.weights, k);
        let (w0, w1, w2) = (weight(k - 1), weight(k), weight(k + 1));
        let both = before + after;
        let stiffness = self.load(simd, self.stiffness, k) * scale;
        let compliance = splat(simd, 1.0) / stiffness.max(splat(simd, 1.0 / RIGID));
        Shared {
            own: compliance + filter * (before * before * w0 + both * both * w1 + after * after * w2),
            near: -(filter * before * (w0 * (before2 + before) + w1 * both)),
            far: filter * before * before2 * w0,
        }
    }
}

impl Line {
    /// For lines in so many lanes.
    pub fn new(length: usize) -> Self {
        Self {
            values: Soa3::zeros(length),
            near: vec![0.0; length],
            far: vec![0.0; length],
            ring: [vec![0.0; length], vec![0.0; length]],
        }
    }

    /// `(1/K H² + θ B W Bᵀ) s = r`, r and then s its values.
    #[inline(always)]
    pub fn solve<S: Simd, const CLOSED: bool>(&mut self, simd: S, of: Of<'_>, square: f32, filter: f32) {
        let (scale, filter, zero, one) = (splat(simd, square), splat(simd, filter), splat(simd, 0.0), splat(simd, 1.0));
        let none = Vec3x8::splat(simd, glam::Vec3::ZERO);
        let count = if CLOSED { of.count - 2 } else { of.count };
        // Of the rows k − 1 and k − 2: the pivot's inverse and L⁻¹ r, the factor next to the diagonal.
        let (mut inverse1, mut inverse2, mut near1, mut y1, mut y2) = (zero, zero, zero, none, none);
        // Of a closed line: its last two bends, p and q.
        let (p, q) = (of.count.wrapping_sub(2), of.count.wrapping_sub(1));
        let (mut columns1, mut columns2) = ([zero; 2], [zero; 2]);
        let (mut right_p, mut right_q) = (none, none);
        let (mut pp, mut pq, mut qq) = (zero, zero, zero);
        for k in 0..count {
            let here = of.shared::<S, CLOSED>(simd, k, scale, filter);
            let (near, far) = (if k > 0 { here.near } else { zero }, if k > 1 { here.far } else { zero });
            let near = near - far * near1;
            let (near_factor, far_factor) = (near * inverse1, far * inverse2);
            let inverse = one / (here.own - near_factor * near - far_factor * far);
            let y = Vec3x8::load(simd, &self.values, k * LANES) - y1 * near_factor - y2 * far_factor;
            if CLOSED {
                let mut columns = [
                    zero - columns1[0] * near_factor - columns2[0] * far_factor,
                    zero - columns1[1] * near_factor - columns2[1] * far_factor,
                ];
                // What p and q have in common with the first two and the last two of the others.
                if k == 0 {
                    columns[0] += here.far;
                    columns[1] += here.near;
                }
                if k == 1 {
                    columns[1] += here.far;
                }
                if k + 2 == count {
                    columns[0] += of.shared::<S, CLOSED>(simd, p, scale, filter).far;
                }
                if k + 1 == count {
                    columns[0] += of.shared::<S, CLOSED>(simd, p, scale, filter).near;
                    columns[1] += of.shared::<S, CLOSED>(simd, q, scale, filter).far;
                }
                let scaled = [columns[0] * inverse, columns[1] * inverse];
                pp += columns[0] * scaled[0];
                pq += columns[0] * scaled[1];
                qq += columns[1] * scaled[1];
                right_p = right_p + y * scaled[0];
                right_q = right_q + y * scaled[1];
                store(scaled[0], &mut self.ring[0], k * LANES);
                store(scaled[1], &mut self.ring[1], k * LANES);
                (columns2, columns1) = (columns1, columns);
            }
            (y * inverse).store(&mut self.values, k * LANES);
            store(near_factor, &mut self.near, k * LANES);
            store(far_factor, &mut self.far, k * LANES);
            (inverse2, inverse1, near1, y2, y1) = (inverse1, inverse, near_factor, y1, y);
        }
        let (mut at_p, mut at_q) = (none, none);
        if CLOSED {
            let (of_p, of_q) =
                (of.shared::<S, CLOSED>(simd, p, scale, filter), of.shared::<S, CLOSED>(simd, q, scale, filter));
            right_p = Vec3x8::load(simd, &self.values, p * LANES) - right_p;
            right_q = Vec3x8::load(simd, &self.values, q * LANES) - right_q;
            // In a line of three they are next to each other both ways round.
            let both_ways = if of.count == 3 { of_q.near + of_p.far } else { of_q.near };
            let (pp, pq, qq) = (of_p.own - pp, both_ways - pq, of_q.own - qq);
            let factor = pq / pp;
            at_q = (right_q - right_p * factor) * (one / (qq - pq * factor));
            at_p = (right_p - at_q * pq) * (one / pp);
            at_p.store(&mut self.values, p * LANES);
            at_q.store(&mut self.values, q * LANES);
        }
        let (mut s1, mut s2) = (none, none);
        let (mut near1, mut far1, mut far2) = (zero, zero, zero);
        for k in (0..count).rev() {
            let mut s = Vec3x8::load(simd, &self.values, k * LANES) - s1 * near1 - s2 * far2;
            if CLOSED {
                s = s - at_p * load(simd, &self.ring[0], k * LANES) - at_q * load(simd, &self.ring[1], k * LANES);
            }
            s.store(&mut self.values, k * LANES);
            far2 = far1;
            near1 = load(simd, &self.near, k * LANES);
            far1 = load(simd, &self.far, k * LANES);
            (s2, s1) = (s1, s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LEVEL;

    /// A number in 0..1.
    fn noise(i: usize) -> f32 {
        let hash = (i as u32).wrapping_mul(0x9E37_79B9);
        ((hash ^ (hash >> 15)).wrapping_mul(0x85EB_CA6B) >> 8) as f32 / 16_777_216.0
    }

    /// The largest part of r that is left of it by s.
    fn left(count: usize, closed: bool) -> f32 {
        let len = count * LANES;
        let mut per_length: Vec<f32> = (0..len).map(|i| 20.0 + 60.0 * noise(i)).collect();
        let mut stiffness: Vec<f32> = (0..len).map(|i| 1e-3 * (1.0 + noise(i + 7000))).collect();
        let weights: Vec<f32> =
            (0..len).map(|i| if noise(i + 900) < 0.1 { 0.0 } else { 1e4 * (1.0 + noise(i + 99)) }).collect();
        if !closed {
            per_length[len - LANES..].fill(0.0);
            stiffness[..LANES].fill(0.0);
            stiffness[len - LANES..].fill(0.0);
        }
        let right: Vec<glam::Vec3> =
            (0..len).map(|i| glam::Vec3::new(noise(3 * i), noise(3 * i + 1), noise(3 * i + 2))).collect();
        let mut line = Line {
            values: Soa3::from_slice(&right),
            near: vec![0.0; len],
            far: vec![0.0; len],
            ring: [vec![0.0; len], vec![0.0; len]],
        };
        let (square, filter) = (1e-3, 0.8);
        let of = Of { per_length: &per_length, stiffness: &stiffness, weights: &weights, stride: LANES, count };
        fearless_simd::dispatch!(*LEVEL, simd => if closed {
            line.solve::<_, true>(simd, of, square, filter);
        } else {
            line.solve::<_, false>(simd, of, square, filter);
        });
        let mut worst = 0.0_f32;
        for lane in 0..LANES {
            let at = |k: usize| k % count * LANES + lane;
            // B: of each bend, its particles and what it takes of them.
            let bends: Vec<[(usize, f32); 3]> = (0..count)
                .map(|k| {
                    let (before, after) = (per_length[at(k + count - 1)], per_length[at(k)]);
                    [((k + count - 1) % count, before), (k, -(before + after)), ((k + 1) % count, after)]
                })
                .collect();
            let is_there = |k: usize| closed || (k > 0 && k + 1 < count);
            for k in (0..count).filter(|k| is_there(*k)) {
                let mut sum = line.values.get(at(k)).as_dvec3() / f64::from(stiffness[at(k)] * square);
                for j in (0..count).filter(|j| is_there(*j)) {
                    for (p, a) in bends[k] {
                        for (q, b) in bends[j] {
                            if p == q {
                                sum += line.values.get(at(j)).as_dvec3() * f64::from(filter * a * b * weights[at(p)]);
                            }
                        }
                    }
                }
                worst = worst.max((sum.as_vec3() - right[at(k)]).length());
            }
        }
        worst
    }

    #[test]
    fn bends_of_open_and_closed_lines_of_any_length_solve_their_system() {
        for count in 3..20 {
            for closed in [false, true] {
                let left = left(count, closed);
                assert!(left < 2e-3, "{left} of {count}, closed: {closed}");
            }
        }
    }
}
