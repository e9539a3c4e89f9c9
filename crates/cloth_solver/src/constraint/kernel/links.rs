//! Where the particles and links of eight straight runs lie, and what became of the links.

use fearless_simd::{Simd, f32x8};

use crate::lanes::{LANES, load, splat};

use fearless_simd::prelude::*;

/// Eight runs of `count` particles each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// Where the first vector starts.
    pub base: usize,
    /// From one vector to the next.
    pub stride: usize,
    /// Particles in each run, at least 2.
    pub count: usize,
    /// Rest distance between neighbours, m.
    pub spacing: f32,
    /// Where in the arrays of the links its own start, eight lanes per link.
    pub links: usize,
}

impl Block {
    /// Where the vector of the k-th particles starts.
    pub const fn at(&self, k: usize) -> usize {
        self.base + k * self.stride
    }

    /// Where the vector of the k-th links starts.
    pub const fn link(&self, k: usize) -> usize {
        self.links + k * LANES
    }

    /// Every second particle from the first (`0`) or second (`1`) on.
    pub const fn every_second(&self, from: usize) -> Self {
        Self {
            base: self.base + from * self.stride,
            stride: 2 * self.stride,
            count: (self.count + 1 - from) / 2,
            spacing: 2.0 * self.spacing,
            links: self.links,
        }
    }
}

/// The factor on the compliance of a link that is not there: so soft that its multiplier vanishes, and the systems of its
/// run keep their shape.
pub(in crate::constraint) const GONE: f32 = 1e25;

/// What the kernels ask of the links of a block. Three kinds, so that what is not worn or all of one length pays nothing.
pub(crate) trait Links: Copy {
    /// Whether links are of various lengths.
    const VARIED: bool = false;
    /// The block's spacing over the length of link `k`; asked of those that are varied.
    #[inline(always)]
    fn shorter<S: Simd>(self, simd: S, _: usize) -> f32x8<S> {
        splat(simd, 1.0)
    }
    /// `compliance` of link `k` as worn.
    fn compliance<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S>;
    /// `rest` of link `k` as worn.
    fn rest<S: Simd>(self, simd: S, k: usize, rest: f32x8<S>) -> f32x8<S>;
    /// `compliance` of the bend over the links `k − 1` and `k`, as the worse of them is worn.
    fn bend<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S>;
    /// For [`Block::every_second`].
    fn every_second(self, from: usize) -> Self;
}

/// Links as they were made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct New;

impl Links for New {
    #[inline(always)]
    fn compliance<S: Simd>(self, _: S, _: usize, compliance: f32x8<S>) -> f32x8<S> {
        compliance
    }

    #[inline(always)]
    fn rest<S: Simd>(self, _: S, _: usize, rest: f32x8<S>) -> f32x8<S> {
        rest
    }

    #[inline(always)]
    fn bend<S: Simd>(self, _: S, _: usize, compliance: f32x8<S>) -> f32x8<S> {
        compliance
    }

    fn every_second(self, _: usize) -> Self {
        self
    }
}

/// Links with factors on compliance and rest length, eight lanes per link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Worn<'a> {
    compliance: &'a [f32],
    rest: &'a [f32],
    /// Link `k` stands for the links from `first + k * step` on, `step` in number.
    first: usize,
    step: usize,
}

impl<'a> Worn<'a> {
    pub const fn new(compliance: &'a [f32], rest: &'a [f32]) -> Self {
        Self { compliance, rest, first: 0, step: 1 }
    }
}

impl Links for Worn<'_> {
    #[inline(always)]
    fn compliance<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S> {
        let at = (self.first + k * self.step) * LANES;
        let one = load(simd, self.compliance, at);
        compliance * if self.step == 2 { one.max(load(simd, self.compliance, at + LANES)) } else { one }
    }

    #[inline(always)]
    fn rest<S: Simd>(self, simd: S, k: usize, rest: f32x8<S>) -> f32x8<S> {
        rest * load(simd, self.rest, (self.first + k * self.step) * LANES)
    }

    #[inline(always)]
    fn bend<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S> {
        let (before, after) = (load(simd, self.compliance, (k - 1) * LANES), load(simd, self.compliance, k * LANES));
        compliance * before.max(after)
    }

    fn every_second(self, from: usize) -> Self {
        Self { first: from, step: 2, ..self }
    }
}

/// Links each of a length and width of its own: factors as [`Worn`] has them, wear included, and the spacing over the length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Varied<'a> {
    pub compliance: &'a [f32],
    pub rest: &'a [f32],
    pub shorter: &'a [f32],
}

impl Links for Varied<'_> {
    const VARIED: bool = true;

    #[inline(always)]
    fn shorter<S: Simd>(self, simd: S, k: usize) -> f32x8<S> {
        load(simd, self.shorter, k * LANES)
    }

    #[inline(always)]
    fn compliance<S: Simd>(self, simd: S, k: usize, compliance: f32x8<S>) -> f32x8<S> {
        compliance * load(simd, self.compliance, k * LANES)
    }

    #[inline(always)]
    fn rest<S: Simd>(self, simd: S, k: usize, rest: f32x8<S>) -> f32x8<S> {
        rest * load(simd, self.rest, k * LANES)
    }

    #[inline(always)]
    fn bend<S: Simd>(self, _: S, _: usize, compliance: f32x8<S>) -> f32x8<S> {
        compliance
    }

    fn every_second(self, _: usize) -> Self {
        self
    }
}
