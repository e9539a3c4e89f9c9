//! Eight lanes at a time: loads, stores, vectors of three lanes, and the transposition of blocks of rows.
//!
//! No kernel uses a fused multiply-add: the same input gives the same bits on every instruction set.

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x8, mask32x8};

use glam::{Mat3, Vec3};

use crate::{Pose, Soa3};

/// Lanes in a vector.
pub(crate) const LANES: usize = 8;

/// The best instruction set of this processor.
pub(crate) static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Loads `v[i..i + 8]`.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, v: &[f32], i: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &v[i..i + LANES])
}

/// Stores to `v[i..i + 8]`.
#[inline(always)]
pub(crate) fn store<S: Simd>(value: f32x8<S>, v: &mut [f32], i: usize) {
    value.store_slice(&mut v[i..i + LANES]);
}

/// The same number in every lane.
#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, value: f32) -> f32x8<S> {
    f32x8::splat(simd, value)
}

/// Eight vectors of three coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Vec3x8<S: Simd> {
    pub x: f32x8<S>,
    pub y: f32x8<S>,
    pub z: f32x8<S>,
}

impl<S: Simd> Vec3x8<S> {
    #[inline(always)]
    pub fn load(simd: S, v: &Soa3, i: usize) -> Self {
        Self { x: load(simd, &v.x, i), y: load(simd, &v.y, i), z: load(simd, &v.z, i) }
    }

    #[inline(always)]
    pub fn store(self, v: &mut Soa3, i: usize) {
        store(self.x, &mut v.x, i);
        store(self.y, &mut v.y, i);
        store(self.z, &mut v.z, i);
    }

    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        Self { x: splat(simd, v.x), y: splat(simd, v.y), z: splat(simd, v.z) }
    }

    #[inline(always)]
    pub fn dot(self, b: Self) -> f32x8<S> {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self { x: self.y * b.z - self.z * b.y, y: self.z * b.x - self.x * b.z, z: self.x * b.y - self.y * b.x }
    }

    #[inline(always)]
    pub fn length(self) -> f32x8<S> {
        self.dot(self).sqrt()
    }
}

impl<S: Simd> core::ops::Add for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<S: Simd> core::ops::Sub for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

impl<S: Simd> core::ops::Mul<f32x8<S>> for Vec3x8<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f32x8<S>) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

/// `yes` where the mask says so, else `no`.
#[inline(always)]
pub(crate) fn select<S: Simd>(mask: mask32x8<S>, yes: Vec3x8<S>, no: Vec3x8<S>) -> Vec3x8<S> {
    Vec3x8 { x: mask.select(yes.x, no.x), y: mask.select(yes.y, no.y), z: mask.select(yes.z, no.z) }
}

/// A pose with its rotation as a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub origin: Vec3,
    axes: Mat3,
}

impl Frame {
    pub fn new(pose: Pose) -> Self {
        Self { origin: pose.position, axes: Mat3::from_quat(pose.rotation) }
    }

    #[inline(always)]
    pub fn direction<S: Simd>(&self, simd: S, v: Vec3x8<S>) -> Vec3x8<S> {
        let m = &self.axes;
        Vec3x8::splat(simd, m.x_axis) * v.x + Vec3x8::splat(simd, m.y_axis) * v.y + Vec3x8::splat(simd, m.z_axis) * v.z
    }

    #[inline(always)]
    pub fn point<S: Simd>(&self, simd: S, p: Vec3x8<S>) -> Vec3x8<S> {
        self.direction(simd, p) + Vec3x8::splat(simd, self.origin)
    }

    #[inline(always)]
    pub fn inverse_direction<S: Simd>(&self, simd: S, v: Vec3x8<S>) -> Vec3x8<S> {
        let m = &self.axes;
        Vec3x8 {
            x: v.dot(Vec3x8::splat(simd, m.x_axis)),
            y: v.dot(Vec3x8::splat(simd, m.y_axis)),
            z: v.dot(Vec3x8::splat(simd, m.z_axis)),
        }
    }

    #[inline(always)]
    pub fn inverse_point<S: Simd>(&self, simd: S, p: Vec3x8<S>) -> Vec3x8<S> {
        self.inverse_direction(simd, p - Vec3x8::splat(simd, self.origin))
    }
}

/// Transposes an 8 × 8 block: three rounds of a perfect shuffle.
#[inline(always)]
pub(crate) fn transpose<S: Simd>(mut rows: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    for _ in 0..3 {
        let mut shuffled = rows;
        for i in 0..4 {
            (shuffled[2 * i], shuffled[2 * i + 1]) = rows[i].interleave(rows[i + 4]);
        }
        rows = shuffled;
    }
    rows
}
