//! Value noise that repeats, for textures.

use bevy::math::{UVec2, Vec2};

/// A number of 0..1 that depends on `key` and `seed` and looks random.
pub(super) fn hash_unit(key: u32, seed: u32) -> f32 {
    let mut x = key.wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// Smooth noise of 0..=1 with a value at each whole number, repeating after `period` both ways.
pub(super) fn noise(at: Vec2, period: u32, seed: u32) -> f32 {
    let low = at.floor();
    let t = at - low;
    let t = t * t * (3.0 - 2.0 * t);
    let low = low.rem_euclid(Vec2::splat(period as f32)).as_uvec2();
    let value = |step: UVec2| {
        let cell = (low + step) % period;
        hash_unit(cell.y * period + cell.x, seed)
    };
    let (left, right) = (UVec2::ZERO, UVec2::X);
    let top = value(left) + (value(right) - value(left)) * t.x;
    let bottom = value(left + UVec2::Y) + (value(right + UVec2::Y) - value(left + UVec2::Y)) * t.x;
    top + (bottom - top) * t.y
}

/// Noise of several octaves over the unit square, which it tiles: `scale` values along an edge, doubled with each octave.
pub(super) fn fractal(at: Vec2, scale: u32, octaves: u32, seed: u32) -> f32 {
    let octave = |k: u32| noise(at * (scale << k) as f32, scale << k, seed + 7 * k) * 0.5_f32.powi(k as i32);
    let sum: f32 = (0..octaves).map(octave).sum();
    sum / (2.0 - 2.0_f32.powi(1 - octaves as i32))
}
