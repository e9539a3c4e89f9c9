//! How far eight points at least are from a curved solid, and which plane is between.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8, mask32x8};
use glam::Vec3;

use super::{Curved, Form};
use crate::lanes::{Vec3x8, select, splat};

impl Curved {
    /// For each of eight points a plane that the whole solid lies behind: how far the point is beyond it, and its normal. Then that is
    /// also signed distance and normal of the solid, but where the mask says that [`Self::distance_and_normal`] knows better.
    #[inline(always)]
    pub(crate) fn bound<S: Simd>(&self, simd: S, p: Vec3x8<S>) -> (f32x8<S>, Vec3x8<S>, mask32x8<S>) {
        let zero = splat(simd, 0.0);
        match self.form() {
            Form::Cylinder { radius, half_height } => {
                let (away, outward) = from_axis(simd, p);
                let aside = away - splat(simd, radius);
                let above = p.y.abs() - splat(simd, half_height);
                let up = Vec3x8 { x: zero, y: splat(simd, 1.0).copysign(p.y), z: zero };
                let is_side = aside.simd_ge(above);
                let beyond_rim = aside.simd_gt(zero) & above.simd_gt(zero);
                (aside.max(above), select(is_side, outward, up), beyond_rim)
            }
            Form::Cone { radius, half_height } => {
                let length = (radius * radius + 4.0 * half_height * half_height).sqrt();
                // The slope's normal away from the axis and up, which across it is the way down the slope.
                let [off, up] = [2.0 * half_height / length, radius / length].map(|part| splat(simd, part));
                let (away, outward) = from_axis(simd, p);
                let height = p.y - splat(simd, half_height);
                let (out, along) = (off * away + up * height, up * away - off * height);
                let below = -splat(simd, half_height) - p.y;
                let is_slope = out.simd_ge(below);
                let slope = Vec3x8 { x: outward.x * off, y: up, z: outward.z * off };
                let on_slope = is_slope & along.simd_ge(zero) & along.simd_le(splat(simd, length));
                let on_base = !is_slope & away.simd_le(splat(simd, radius));
                let distance = out.max(below);
                let normal = select(is_slope, slope, Vec3x8::splat(simd, Vec3::NEG_Y));
                (distance, normal, distance.simd_gt(zero) & !(on_slope | on_base))
            }
            Form::Ellipsoid { half } => {
                // The plane across the gradient that touches it.
                let (e, by) = (Vec3x8::splat(simd, half), Vec3x8::splat(simd, half.recip()));
                let shrunk = Vec3x8 { x: p.x * by.x, y: p.y * by.y, z: p.z * by.z };
                let gradient = Vec3x8 { x: shrunk.x * by.x, y: shrunk.y * by.y, z: shrunk.z * by.z };
                let length = gradient.length();
                let is_middle = length.simd_le(splat(simd, f32::MIN_POSITIVE));
                let across = gradient * (splat(simd, 1.0) / length);
                let normal = select(is_middle, Vec3x8::splat(simd, Vec3::Y), across);
                let farthest = Vec3x8 { x: e.x * normal.x, y: e.y * normal.y, z: e.z * normal.z }.length();
                (p.dot(normal) - farthest, normal, zero.simd_eq(zero))
            }
            Form::RoundedCuboid { core, radius } => {
                let (distance, normal) = from_box(simd, p, core);
                (distance - splat(simd, radius), normal, zero.simd_gt(zero))
            }
        }
    }
}

/// Distance from the y axis and the direction away from it; on it +x.
#[inline(always)]
fn from_axis<S: Simd>(simd: S, p: Vec3x8<S>) -> (f32x8<S>, Vec3x8<S>) {
    let zero = splat(simd, 0.0);
    let away = (p.x * p.x + p.z * p.z).sqrt();
    let on_axis = away.simd_le(splat(simd, f32::MIN_POSITIVE));
    let outward = Vec3x8 { x: p.x / away, y: zero, z: p.z / away };
    (away, select(on_axis, Vec3x8::splat(simd, Vec3::X), outward))
}

/// Signed distance and outward normal of a box of half its edges.
#[inline(always)]
fn from_box<S: Simd>(simd: S, p: Vec3x8<S>, half: Vec3) -> (f32x8<S>, Vec3x8<S>) {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let sign = Vec3x8 { x: one.copysign(p.x), y: one.copysign(p.y), z: one.copysign(p.z) };
    let half = Vec3x8::splat(simd, half);
    let over = Vec3x8 { x: p.x.abs() - half.x, y: p.y.abs() - half.y, z: p.z.abs() - half.z };
    let away = Vec3x8 { x: over.x.max(zero), y: over.y.max(zero), z: over.z.max(zero) };
    let (length, height) = (away.length(), over.x.max(over.y).max(over.z));
    let is_x = over.x.simd_ge(height);
    let is_y = over.y.simd_ge(height) & !is_x;
    let side =
        Vec3x8 { x: is_x.select(sign.x, zero), y: is_y.select(sign.y, zero), z: (is_x | is_y).select(zero, sign.z) };
    let outside = length.simd_gt(splat(simd, f32::MIN_POSITIVE));
    let outward = Vec3x8 { x: away.x * sign.x, y: away.y * sign.y, z: away.z * sign.z } * (one / length);
    (outside.select(length, height), select(outside, outward, side))
}
