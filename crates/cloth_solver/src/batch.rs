//! Colouring: constraints in groups of eight that share no particle, for kernels that gather and scatter.

use fearless_simd::Simd;

use crate::Soa3;
use crate::lanes::{LANES, Vec3x8};
use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8};

/// Eight constraints on `N` particles each: `[corner][lane]`.
pub(crate) type Group<const N: usize> = [[u32; LANES]; N];

/// Constraints on `N` particles each, coloured and grouped.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct Batches<const N: usize> {
    /// The groups, colour by colour.
    #[cfg_attr(feature = "save", serde(with = "crate::save::groups"))]
    pub groups: Vec<Group<N>>,
    /// For each lane of each group the constraint it solves; `None` for a lane that is left over.
    pub source: Vec<[Option<u32>; LANES]>,
}

impl<const N: usize> Batches<N> {
    /// Colours greedily in the order given, then fills groups colour by colour. A lane left over names `padding`, a
    /// slot of inverse mass 0.
    pub fn new(constraints: &[[u32; N]], slots: usize, padding: u32) -> Self {
        let mut used_by_particle = vec![0_u64; slots];
        let mut colours: Vec<Vec<u32>> = Vec::new();
        for (index, particles) in constraints.iter().enumerate() {
            let taken = particles.iter().fold(0, |all, &p| all | used_by_particle[p as usize]);
            // A 65th colour would need a vertex of 22 or more triangles; such constraints go to colours of their own.
            let colour = (!taken).trailing_zeros() as usize;
            if colour < 64 {
                for &p in particles {
                    used_by_particle[p as usize] |= 1 << colour;
                }
                if colours.len() <= colour {
                    colours.resize_with(colour + 1, Vec::new);
                }
                colours[colour].push(index as u32);
            } else {
                colours.push(vec![index as u32]);
            }
        }
        let mut batches = Self { groups: Vec::new(), source: Vec::new() };
        for colour in colours {
            for chunk in colour.chunks(LANES) {
                let mut group = [[padding; LANES]; N];
                let mut source = [None; LANES];
                for (lane, &index) in chunk.iter().enumerate() {
                    source[lane] = Some(index);
                    for (corner, &particle) in constraints[index as usize].iter().enumerate() {
                        group[corner][lane] = particle;
                    }
                }
                batches.groups.push(group);
                batches.source.push(source);
            }
        }
        batches
    }

    /// `value` of each constraint in lane order, one array per group; `idle` where no constraint is.
    pub fn lanes(&self, idle: f32, value: impl Fn(usize) -> f32) -> Vec<[f32; LANES]> {
        self.source.iter().map(|group| group.map(|index| index.map_or(idle, |i| value(i as usize)))).collect()
    }
}

/// The vectors at eight slots.
#[inline(always)]
pub(crate) fn gather3<S: Simd>(simd: S, v: &Soa3, slots: &[u32; LANES]) -> Vec3x8<S> {
    Vec3x8 { x: gather(simd, &v.x, slots), y: gather(simd, &v.y, slots), z: gather(simd, &v.z, slots) }
}

/// The numbers at eight slots.
#[inline(always)]
pub(crate) fn gather<S: Simd>(simd: S, v: &[f32], slots: &[u32; LANES]) -> f32x8<S> {
    let [a, b, c, d, e, f, g, h] = *slots;
    let at = |i: u32| i as usize;
    f32x8::simd_from(simd, [v[at(a)], v[at(b)], v[at(c)], v[at(d)], v[at(e)], v[at(f)], v[at(g)], v[at(h)]])
}

/// Three coordinates and one more number.
pub(crate) type Packed = [f32; 4];

/// Puts vectors together with a number each.
pub(crate) fn pack(v: &Soa3, numbers: &[f32], to: &mut Vec<Packed>) {
    to.clear();
    to.extend(v.x.iter().zip(&v.y).zip(&v.z).zip(numbers).map(|(((x, y), z), number)| [*x, *y, *z, *number]));
}

/// Takes the vectors out again.
pub(crate) fn unpack(from: &[Packed], v: &mut Soa3) {
    for (((x, y), z), packed) in v.x.iter_mut().zip(&mut v.y).zip(&mut v.z).zip(from) {
        [*x, *y, *z] = [packed[0], packed[1], packed[2]];
    }
}

/// The vectors and numbers at eight slots: half the time of [`gather3`] and [`gather`].
#[inline(always)]
pub(crate) fn gather4<S: Simd>(simd: S, all: &[Packed], slots: &[u32; LANES]) -> (Vec3x8<S>, f32x8<S>) {
    let [a, b, c, d, e, f, g, h] = *slots;
    let pair = |i: u32, j: u32| {
        let [first, second] = [i, j].map(|i| f32x4::simd_from(simd, all[i as usize]));
        first.combine(second)
    };
    // A perfect shuffle each: x0 y0 z0 w0 x1 … becomes x0 x4 y0 y4 …, that x0 x2 x4 x6 y0 …, and that x0 x1 x2 ….
    let (p0, p1) = pair(a, b).interleave(pair(e, f));
    let (q0, q1) = pair(c, d).interleave(pair(g, h));
    let ((even_xy, even_zw), (odd_xy, odd_zw)) = (p0.interleave(q0), p1.interleave(q1));
    let ((x, y), (z, number)) = (even_xy.interleave(odd_xy), even_zw.interleave(odd_zw));
    (Vec3x8 { x, y, z }, number)
}

/// The way back of [`gather4`], to slots which differ but for padding.
#[inline(always)]
pub(crate) fn scatter4<S: Simd>(value: Vec3x8<S>, number: f32x8<S>, all: &mut [Packed], slots: &[u32; LANES]) {
    let [a, b, c, d, e, f, g, h] = *slots;
    let ((even_xy, odd_xy), (even_zw, odd_zw)) = (value.x.deinterleave(value.y), value.z.deinterleave(number));
    let ((p0, q0), (p1, q1)) = (even_xy.deinterleave(even_zw), odd_xy.deinterleave(odd_zw));
    let ((ab, ef), (cd, gh)) = (p0.deinterleave(p1), q0.deinterleave(q1));
    for (pair, [i, j]) in [(ab, [a, b]), (cd, [c, d]), (ef, [e, f]), (gh, [g, h])] {
        let (first, second) = pair.split();
        first.store_slice(&mut all[i as usize]);
        second.store_slice(&mut all[j as usize]);
    }
}

/// Writes to eight slots, which differ but for padding.
#[inline(always)]
pub(crate) fn scatter3<S: Simd>(value: Vec3x8<S>, v: &mut Soa3, slots: &[u32; LANES]) {
    for lane in 0..LANES {
        let i = slots[lane] as usize;
        v.x[i] = value.x[lane];
        v.y[i] = value.y[lane];
        v.z[i] = value.z[lane];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::splat;

    #[test]
    fn what_is_gathered_from_packed_numbers_is_what_is_there_and_goes_back_there() {
        let all: Vec<Packed> = (0..20_u8).map(|i| [0.0, 0.25, 0.5, 0.75].map(|part| f32::from(i) + part)).collect();
        let slots = [3, 17, 5, 0, 19, 8, 11, 2];
        let mut scattered = all.clone();
        fearless_simd::dispatch!(*crate::lanes::LEVEL, simd => {
            let (v, number) = gather4(simd, &all, &slots);
            for (lane, slot) in slots.iter().enumerate() {
                assert_eq!([v.x[lane], v.y[lane], v.z[lane], number[lane]], all[*slot as usize]);
            }
            scatter4(v * splat(simd, 2.0), number, &mut scattered, &slots);
        });
        for (i, [x, y, z, number]) in all.iter().enumerate() {
            let factor = if slots.contains(&(i as u32)) { 2.0 } else { 1.0 };
            assert_eq!(scattered[i], [x * factor, y * factor, z * factor, *number]);
        }
    }

    #[test]
    fn a_group_never_names_a_particle_twice() {
        let constraints: Vec<[u32; 2]> = (0..200).map(|i| [i % 50, (i * 7 + 1) % 50]).filter(|[a, b]| a != b).collect();
        let batches = Batches::new(&constraints, 51, 50);
        for group in &batches.groups {
            let mut named: Vec<u32> = group.iter().flatten().copied().filter(|&p| p != 50).collect();
            let all = named.len();
            named.sort_unstable();
            named.dedup();
            assert_eq!(named.len(), all);
        }
        assert_eq!(batches.source.iter().flatten().flatten().count(), constraints.len());
    }

    #[test]
    fn a_particle_of_a_hundred_constraints_is_coloured() {
        let constraints: Vec<[u32; 2]> = (1..=100).map(|i| [0, i]).collect();
        let batches = Batches::new(&constraints, 102, 101);
        assert_eq!(batches.groups.len(), 100);
    }
}
