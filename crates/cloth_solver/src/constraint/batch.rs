//! Colouring: constraints in groups of eight that share no particle, for kernels that gather and scatter.

use fearless_simd::Simd;

use crate::Soa3;
use crate::lanes::{LANES, Vec3x8};
use fearless_simd::f32x8;
use fearless_simd::prelude::*;

/// Eight constraints on `N` particles each: `[corner][lane]`.
pub(crate) type Group<const N: usize> = [[u32; LANES]; N];

/// Constraints on `N` particles each, coloured and grouped.
#[derive(Clone, Debug)]
pub(crate) struct Batches<const N: usize> {
    /// The groups, colour by colour.
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
    f32x8::simd_from(simd, slots.map(|i| v[i as usize]))
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
