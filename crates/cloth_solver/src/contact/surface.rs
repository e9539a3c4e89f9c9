//! What particles meet: a shape, or of a triangle mesh the triangles near each of them.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;

use super::near::Part;
use super::{Shape, respond};
use crate::lanes::{LANES, Vec3x8};

/// The surface that eight particles meet, in the collider's frame.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    shape: &'a Shape,
    /// Where the particles are in the lists of what is near.
    near: Option<(&'a Part, usize)>,
}

impl<'a> Surface<'a> {
    /// That of a shape which is the same for all particles.
    pub fn of(shape: &'a Shape) -> Self {
        Self { shape, near: None }
    }

    /// That near the particles of `part` from number `first` on.
    pub fn near(shape: &'a Shape, part: &'a Part, first: usize) -> Self {
        Self { shape, near: Some((part, first)) }
    }

    /// See [`respond::distance_and_normal`].
    #[inline(always)]
    pub fn distance_and_normal<S: Simd>(
        self,
        simd: S,
        p: Vec3x8<S>,
        margin: f32x8<S>,
        wanted: mask32x8<S>,
    ) -> (f32x8<S>, Vec3x8<S>) {
        let (Some(mesh), Some((part, first))) = (self.shape.mesh(), self.near) else {
            return respond::distance_and_normal(simd, self.shape, p, margin, wanted);
        };
        let (mut distance, mut n) = ([0.0; LANES], [[0.0; LANES]; 3]);
        for lane in 0..LANES {
            let near = part.triangles_near(first + lane);
            let (d, normal) = mesh.among(Vec3::new(p.x[lane], p.y[lane], p.z[lane]), near, part.bound);
            distance[lane] = d;
            (n[0][lane], n[1][lane], n[2][lane]) = (normal.x, normal.y, normal.z);
        }
        let [x, y, z] = n.map(|n| f32x8::simd_from(simd, n));
        (f32x8::simd_from(simd, distance), Vec3x8 { x, y, z })
    }

    /// Whether a plane through its nearest point has all of it on one side.
    pub fn is_convex(self) -> bool {
        self.shape.mesh().is_none()
    }
}
