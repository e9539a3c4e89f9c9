//! Wisps of flame: what rises from each burning particle, as a function of the time alone.

use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use bevy::math::ops;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// Wisps that rise from one root at the same time.
pub(super) const A_ROOT: u32 = 4;

/// How long a wisp lives, s: it rises half a metre meanwhile, as flames on a curtain are high.
const LIFETIME: f32 = 0.55;

/// Half the width of a wisp over the width of the cloth it burns on, and its length over its width.
const PROPORTION: (f32, f32) = (1.5, 1.9);

/// Edge of a tile of the texture, in pixels, and how many tiles there are across and down: first the flames, then the others.
const TILE: u32 = 64;
pub(super) const TILES: UVec2 = UVec2::new(4, 2);

/// The tiles that show puffs of smoke, and the one that shows a spark.
pub(super) const PUFFS: core::ops::Range<u32> = 4..7;
pub(super) const SPARK: u32 = 7;

/// Colours through the life of a wisp, linear: what it shines with, and how much it hides.
const COLORS: [[f32; 4]; 4] =
    [[0.45, 0.17, 0.04, 0.20], [0.85, 0.34, 0.06, 0.40], [0.50, 0.10, 0.01, 0.25], [0.0, 0.0, 0.0, 0.0]];

/// Where flames stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// m.
    pub at: Vec3,
    /// Width of the cloth that burns there, m.
    pub width: f32,
    /// How strongly, 0..=1.
    pub strength: f32,
    /// What tells it from others.
    pub seed: u32,
}

/// One wisp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wisp {
    /// Its middle, m.
    pub at: Vec3,
    /// Half its width and half its length, m.
    pub half: Vec2,
    /// How far it is turned in the picture, rad.
    pub turn: f32,
    /// Premultiplied, linear.
    pub color: [f32; 4],
    /// Which tile of the texture it shows.
    pub tile: u32,
}

impl Root {
    /// Its wisp number `k` at `time` s, where the hot gas streams at `stream` m/s.
    pub fn wisp(&self, k: u32, time: f64, stream: Vec3) -> Wisp {
        let life = LIFETIME * (0.7 + 0.6 * unit(hash(self.seed)));
        let (age, mut draw) = self.age(k, time / f64::from(life) + f64::from(k) / f64::from(A_ROOT));
        let aside = (Vec3::new(draw(), draw(), draw()) - 0.5) * (self.width * (0.5 + 1.5 * age));
        let size = self.width * (0.7 + 0.6 * draw()) * self.strength.sqrt();
        // It spreads while it takes fire, and is eaten up as it rises.
        let swell = (0.6 + 1.2 * age) * (1.0 - age * age);
        let width = PROPORTION.0 * size * swell;
        let rise = stream * (life * age * (0.5 + 0.5 * age));
        let length = PROPORTION.1 * width * (0.9 + 0.3 * stream.length());
        let shine = (age * 8.0).min(1.0) * (0.75 + 0.5 * draw());
        Wisp {
            at: self.at + rise + aside + stream.normalize_or_zero() * (0.6 * length),
            half: Vec2::new(width, length),
            turn: 0.0,
            color: color(&COLORS, age).map(|part| part * shine),
            tile: (4.0 * draw()) as u32 % 4,
        }
    }

    /// The age, 0..1, of what it lets rise as number `k`, of which it has let so many rise, and numbers of 0..1 without pattern that
    /// stay the same until that is gone.
    pub fn age(&self, k: u32, risen: f64) -> (f32, impl FnMut() -> f32 + use<>) {
        let turns = risen + f64::from(unit(hash(self.seed ^ 7)));
        let (age, born) = (turns.fract() as f32, turns as u64 as u32);
        let mut chance = hash(hash(self.seed.wrapping_add(k)).wrapping_add(born));
        let draw = move || {
            chance = hash(chance);
            unit(chance)
        };
        (age, draw)
    }
}

/// The colour at an age of 0..=1, of those through a life.
pub(super) fn color(colors: &[[f32; 4]; 4], age: f32) -> [f32; 4] {
    let place = age.clamp(0.0, 1.0) * (colors.len() - 1) as f32;
    let from = (place as usize).min(colors.len() - 2);
    let t = place - from as f32;
    std::array::from_fn(|i| colors[from][i] * (1.0 - t) + colors[from + 1][i] * t)
}

/// How brightly a fire shines at `time` s, 1 on the average.
pub(super) fn flicker(time: f64) -> f32 {
    0.8 + 0.4 * noise(Vec2::new((time * 7.0 % 4096.0) as f32, 0.5), 1)
}

/// A number without pattern for each number (PCG, after Jarzynski and Olano 2020).
pub(super) fn hash(number: u32) -> u32 {
    let state = number.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// `hash` as a number of 0..1.
pub(super) fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 / (1 << 24) as f32
}

/// Smooth noise of 0..1.
fn noise(at: Vec2, seed: u32) -> f32 {
    let (cell, t) = (at.floor().as_ivec2(), at - at.floor());
    let t = t * t * (3.0 - 2.0 * t);
    let corner = |x: i32, y: i32| {
        let [x, y] = [cell.x + x, cell.y + y].map(|k| k as u32);
        unit(hash(x.wrapping_add(hash(y.wrapping_add(hash(seed))))))
    };
    let row = |y| corner(0, y) * (1.0 - t.x) + corner(1, y) * t.x;
    row(0) * (1.0 - t.y) + row(1) * t.y
}

/// Flames, puffs of smoke and a spark, white, as bright as they hide.
pub(super) fn texture() -> Image {
    let UVec2 { x: width, y: height } = TILE * TILES;
    let pixels = (0..width * height).flat_map(|pixel| {
        let (x, y) = (pixel % width, pixel / width);
        let at = (Vec2::new((x % TILE) as f32, (y % TILE) as f32) + 0.5) / TILE as f32 * 2.0 - 1.0;
        [(255.0 * shown(at, x / TILE + TILES.x * (y / TILE))) as u8; 4]
    });
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    let usage = RenderAssetUsages::RENDER_WORLD;
    Image::new(size, TextureDimension::D2, pixels.collect(), TextureFormat::Rgba8Unorm, usage)
}

/// How dense what a tile shows is at a place of −1..=1, y down; 0 at the border.
fn shown(at: Vec2, tile: u32) -> f32 {
    if PUFFS.contains(&tile) {
        puff(at, tile)
    } else if tile == SPARK {
        (1.1 - 1.2 * at.length()).clamp(0.0, 1.0)
    } else {
        density(at, tile)
    }
}

/// The same of a puff of smoke: round, and of billows.
fn puff(at: Vec2, tile: u32) -> f32 {
    let billows = 0.65 * noise(at * 2.0 + 9.0, tile) + 0.35 * noise(at * 4.5 + 9.0, tile + 4);
    let dense = ((0.95 - at.length()) * 1.5).clamp(0.0, 1.0) * (0.35 + 0.9 * billows);
    let dense = dense.min(1.0);
    dense * dense * (3.0 - 2.0 * dense)
}

/// The same of a flame: wide and round below, frayed and pointed above.
fn density(at: Vec2, tile: u32) -> f32 {
    let up = 0.5 - 0.5 * at.y;
    let sway = (noise(Vec2::new(2.0 * up, 0.5), 31 + tile) - 0.5) * 0.6 * up;
    let taper = 0.85 * ops::powf(1.0 - up, 0.4).max(0.05);
    let across = (at.x - sway) / taper;
    let r = Vec2::new(across, if at.y > 0.3 { (at.y - 0.3) / 0.65 } else { (0.3 - at.y) / 1.25 }).length();
    let frayed = 0.6 * noise(at * 2.5 + 9.0, tile) + 0.4 * noise(at * 6.0 + 9.0, tile + 4);
    let dense = ((1.0 - r) * 1.6 - 0.5 * frayed * up * 1.6).clamp(0.0, 1.0);
    dense * dense * (3.0 - 2.0 * dense)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: Root = Root { at: Vec3::new(1.0, 2.0, 3.0), width: 0.1, strength: 1.0, seed: 5 };

    fn wisps(time: f64, stream: Vec3) -> Vec<Wisp> {
        (0..A_ROOT).map(|k| ROOT.wisp(k, time, stream)).collect()
    }

    #[test]
    fn wisps_rise_from_their_root_with_the_stream_and_none_is_born_or_dies_in_sight() {
        let stream = Vec3::new(0.4, 1.0, 0.0);
        let mut highest = 0.0_f32;
        for frame in 0..500 {
            let (before, now) = (wisps(f64::from(frame) * 1e-3, stream), wisps(f64::from(frame + 1) * 1e-3, stream));
            for (before, now) in before.iter().zip(&now) {
                let jump = before.at.distance(now.at);
                let seen = before.color[0].max(now.color[0]);
                assert!(jump < 0.01 || seen < 0.02, "{jump} m in a millisecond, {seen} bright");
                highest = highest.max(now.at.y - ROOT.at.y);
            }
        }
        assert!((0.25..1.0).contains(&highest), "{highest}");
    }

    #[test]
    fn the_same_moment_shows_the_same_flames_and_another_root_others() {
        assert_eq!(wisps(3.7, Vec3::Y), wisps(3.7, Vec3::Y));
        let other = Root { seed: 6, ..ROOT };
        assert_ne!(other.wisp(0, 3.7, Vec3::Y).at, ROOT.wisp(0, 3.7, Vec3::Y).at);
    }

    #[test]
    fn the_texture_is_clear_at_the_border_of_each_wisp_and_dense_inside() {
        for tile in 0..TILES.element_product() {
            let around = (0..100).map(|i| i as f32 / 50.0 - 1.0);
            let border = around.flat_map(|k| [Vec2::new(k, 1.0), Vec2::new(k, -1.0), Vec2::new(1.0, k)]);
            assert!(border.map(|at| shown(at, tile)).all(|density| density == 0.0), "{tile}");
            let inside = if tile < 4 { shown(Vec2::new(0.0, 0.3), tile) } else { shown(Vec2::ZERO, tile) };
            assert!(inside > if PUFFS.contains(&tile) { 0.4 } else { 0.9 }, "{tile}: {inside}");
        }
    }
}
