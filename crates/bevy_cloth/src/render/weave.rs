//! Textures of fabrics, made when a look first needs them: threads of each weave, and the noise that makes them uneven.
//!
//! All tile, and have mipmaps, so that threads too fine to be seen become an even surface and no moiré.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::math::ops;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

use super::look::Weave;
use super::value_noise::{fractal, hash_unit, noise};

/// Edge of each texture, pixels.
const SIZE: usize = 256;

/// The steepest slope that a texture holds.
const STEEPEST: f32 = 2.0;

/// Textures made so far.
#[derive(Default)]
pub(super) struct WeaveTextures {
    weaves: HashMap<Weave, Handle<Image>>,
    noise: Option<Handle<Image>>,
}

impl WeaveTextures {
    /// The threads of `weave`: slope along u and v, height, and how much of the warp is seen.
    pub fn weave(&mut self, weave: Weave, images: &mut Assets<Image>) -> Handle<Image> {
        self.weaves.entry(weave).or_insert_with(|| images.add(weave_texture(weave))).clone()
    }

    /// Noise: streaks along v, cloudy noise, and the slopes of creases along u and v.
    pub fn noise(&mut self, images: &mut Assets<Image>) -> Handle<Image> {
        self.noise.get_or_insert_with(|| images.add(noise_texture())).clone()
    }
}

/// Threads along the edge of the texture of a weave.
pub(super) const fn threads_a_tile(weave: Weave) -> f32 {
    match weave {
        Weave::Plain | Weave::Ripstop | Weave::Terry => 16.0,
        Weave::Twill => 24.0,
        Weave::Satin => 20.0,
        Weave::Knit => 8.0,
        Weave::Velvet => 24.0,
    }
}

/// Height and share of the warp at a place, in threads.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    height: f32,
    warp: f32,
}

fn weave_texture(weave: Weave) -> Image {
    let count = threads_a_tile(weave);
    let scale = count / SIZE as f32;
    let points = grid(|x, y| {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * scale;
        match weave {
            Weave::Plain => woven(at, count, |warp, weft| (warp + weft) % 2 == 0, |_| 1.0),
            Weave::Twill => woven(at, count, |warp, weft| (warp + 3 * weft) % 4 != 0, |_| 1.0),
            Weave::Satin => woven(at, count, |warp, weft| (2 * warp + weft) % 5 != 0, |_| 1.0),
            Weave::Ripstop => {
                woven(at, count, |warp, weft| (warp + weft) % 2 == 0, |thread| if thread % 16 < 2 { 1.9 } else { 1.0 })
            }
            Weave::Terry => terry(at, count),
            Weave::Knit => knit(at, count),
            Weave::Velvet => velvet(at, count),
        }
    });
    let height = |x: usize, y: usize| points[y % SIZE * SIZE + x % SIZE].height;
    let texels = grid(|x, y| {
        let slope = Vec2::new(height(x + 1, y) - height(x + SIZE - 1, y), height(x, y + 1) - height(x, y + SIZE - 1))
            / (2.0 * scale);
        let slope = 0.5 + 0.5 * slope / STEEPEST;
        let Point { height, warp } = points[y * SIZE + x];
        [slope.x, slope.y, height, warp]
    });
    texture(&texels)
}

/// A weave in which `is_warp_up` says which thread lies on top where warp and weft cross, and `thickness` how thick threads
/// are.
fn woven(at: Vec2, count: f32, is_warp_up: impl Fn(u32, u32) -> bool, thickness: impl Fn(u32) -> f32) -> Point {
    let n = count as u32;
    let (column, row) = (at.x as u32 % n, at.y as u32 % n);
    let (across, along) = (at.x.fract(), at.y.fract());
    let up = |column: u32, row: u32| f32::from(is_warp_up(column % n, row % n));
    // Between the middles of two crossings a thread rises or dips smoothly.
    let blend = |here: f32, before: f32, after: f32, t: f32| {
        let other = if t < 0.5 { before } else { after };
        let share = (t - 0.5).abs();
        here + (other - here) * (share * share * (3.0 - 2.0 * share) * 2.0).min(1.0) * 0.5
    };
    let warp_up = blend(up(column, row), up(column, row + n - 1), up(column, row + 1), along);
    let weft_up = 1.0 - blend(up(column, row), up(column + n - 1, row), up(column + 1, row), across);
    // No two threads are alike, and none is straight.
    let sway = |thread: u32, t: f32, seed: u32| 0.22 * (noise(Vec2::new(t, thread as f32), n, seed) - 0.5);
    let round = |t: f32, thick: f32| (1.0 - ops::powf((2.0 * t - 1.0).abs() / thick.max(0.8), 2.6)).max(0.0);
    let warp_thick = thickness(column) * (0.92 + 0.16 * hash_unit(column, 3));
    let weft_thick = thickness(row) * (0.92 + 0.16 * hash_unit(row, 4));
    let warp_profile = round((across + sway(column, at.y, 11)).clamp(0.0, 1.0), warp_thick);
    let weft_profile = round((along + sway(row, at.x, 12)).clamp(0.0, 1.0), weft_thick);
    let warp = warp_profile.sqrt() * (0.35 + 0.45 * warp_up) * warp_thick.sqrt();
    let weft = weft_profile.sqrt() * (0.35 + 0.45 * weft_up) * weft_thick.sqrt();
    // Fibres are twisted around each thread.
    let twist = |a: f32, b: f32, seed: u32| 0.07 * (noise(Vec2::new(6.0 * a + 3.0 * b, 2.0 * b), 4 * n, seed) - 0.5);
    let height = if warp > weft { warp + twist(at.x, at.y, 21) } else { weft + twist(at.y, at.x, 22) };
    Point { height: height.clamp(0.0, 1.0), warp: (0.5 + 6.0 * (warp - weft)).clamp(0.0, 1.0) }
}

/// Loops of all sizes that lean every way, several to a cell.
fn terry(at: Vec2, count: f32) -> Point {
    let n = count as i32;
    let mut highest = Point { height: 0.05, warp: 0.5 };
    let cell = at.floor().as_ivec2();
    for step in (0..9).map(|k| IVec2::new(k % 3 - 1, k / 3 - 1)) {
        let of = (cell + step).rem_euclid(IVec2::splat(n));
        let of = (of.y * n + of.x) as u32;
        for k in 0..2 {
            let of = 2 * of + k;
            let middle = (cell + step).as_vec2() + Vec2::new(hash_unit(of, 1), hash_unit(of, 2));
            let lean = Vec2::from_angle(std::f32::consts::TAU * hash_unit(of, 3));
            let from = at - middle;
            // A loop is an arch: long one way, narrow the other, with a groove between its two plies.
            let (long, wide) = (from.dot(lean) / 0.75, from.perp_dot(lean) / (0.34 + 0.12 * hash_unit(of, 4)));
            let inside = 1.0 - long * long - wide * wide;
            if inside > 0.0 {
                let groove = 0.10 * (1.0 - (4.0 * wide.abs()).min(1.0));
                let height = (0.35 + 0.55 * hash_unit(of, 5)) * inside.sqrt() + 0.1 - groove;
                if height > highest.height {
                    highest = Point { height, warp: hash_unit(of, 6) };
                }
            }
        }
    }
    Point { height: highest.height.min(1.0), ..highest }
}

/// Stitches in columns, each a V of two legs.
fn knit(at: Vec2, count: f32) -> Point {
    let n = count as u32;
    let mut highest = Point { height: 0.0, warp: 1.0 };
    let column = at.x as u32 % n;
    // The legs of a stitch lie over those of the row above.
    for row in [-1.0_f32, 0.0, 1.0] {
        let base = at.y.floor() + row;
        let up = (at.y - base) / 1.7 + 0.2;
        if !(0.0..1.0).contains(&up) {
            continue;
        }
        let number = (base.rem_euclid(count)) as u32 * n + column;
        for side in [-1.0, 1.0] {
            let middle = 0.5 + side * (0.36 - 0.27 * up);
            let off = (at.x.fract() - middle) / 0.23;
            let round = 1.0 - off * off;
            if round > 0.0 {
                let height = round.sqrt() * (0.55 + 0.35 * up) + 0.06 * (hash_unit(number, 7) - 0.5);
                let ply = 0.06 * (noise(Vec2::new(5.0 * (off + up * side), at.y), 8 * n, 31) - 0.5);
                if height > highest.height {
                    highest.height = height + ply;
                }
            }
        }
    }
    Point { height: highest.height.clamp(0.0, 1.0), ..highest }
}

/// Ends of fibres, tuft by tuft.
fn velvet(at: Vec2, count: f32) -> Point {
    let n = count as u32;
    let tufts = noise(at, n, 41);
    let fibres = 0.6 * noise(at * 3.0, 3 * n, 42) + 0.4 * noise(at * 6.0, 6 * n, 43);
    Point { height: 0.25 + 0.35 * tufts + 0.4 * fibres, warp: fibres }
}

fn noise_texture() -> Image {
    let place = |x: usize, y: usize| Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / SIZE as f32;
    // Creases run in sharp ridges between smooth hollows.
    let crease = grid(|x, y| {
        let at = place(x, y);
        let ridge = |scale: u32, seed: u32| 1.0 - (2.0 * fractal(at, scale, 2, seed) - 1.0).abs();
        0.65 * fractal(at, 4, 3, 51) + 0.35 * ridge(5, 52)
    });
    let height = |x: usize, y: usize| crease[y % SIZE * SIZE + x % SIZE];
    let texels = grid(|x, y| {
        let at = place(x, y);
        let streaks = 0.6 * noise(at * Vec2::new(128.0, 4.0), 128, 53) + 0.4 * noise(at * Vec2::new(64.0, 2.0), 64, 54);
        let slope = Vec2::new(height(x + 1, y) - height(x + SIZE - 1, y), height(x, y + 1) - height(x, y + SIZE - 1))
            * (SIZE as f32 / 2.0 / 16.0);
        [streaks, fractal(at, 8, 4, 55), 0.5 + 0.5 * slope.x, 0.5 + 0.5 * slope.y]
    });
    texture(&texels)
}

fn grid<T>(value: impl Fn(usize, usize) -> T) -> Vec<T> {
    (0..SIZE * SIZE).map(|i| value(i % SIZE, i / SIZE)).collect()
}

/// A texture that repeats, with all its mipmaps.
fn texture(texels: &[[f32; 4]]) -> Image {
    let mut data = Vec::with_capacity(SIZE * SIZE * 4 * 4 / 3 + 4);
    let mut level = texels.to_vec();
    let (mut size, mut levels) = (SIZE, 1);
    loop {
        data.extend(level.iter().flatten().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8));
        if size == 1 {
            break;
        }
        let half = size / 2;
        let mean = |i: usize| -> [f32; 4] {
            let (x, y) = (2 * (i % half), 2 * (i / half));
            let four = [y * size + x, y * size + x + 1, (y + 1) * size + x, (y + 1) * size + x + 1];
            std::array::from_fn(|channel| four.iter().map(|texel| level[*texel][channel]).sum::<f32>() / 4.0)
        };
        level = (0..half * half).map(mean).collect();
        size = half;
        levels += 1;
    }
    let size = Extent3d { width: SIZE as u32, height: SIZE as u32, depth_or_array_layers: 1 };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new_uninit(size, TextureDimension::D2, TextureFormat::Rgba8Unorm, usage);
    image.data = Some(data);
    image.texture_descriptor.mip_level_count = levels;
    // Not anisotropic: Mesa's software renderer can then hang in a sample of a given level.
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        ..default()
    });
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(image: &Image, x: usize, y: usize) -> [f32; 4] {
        let data = image.data.as_ref().expect("pixels");
        std::array::from_fn(|channel| f32::from(data[4 * (y * SIZE + x) + channel]) / 255.0)
    }

    /// The largest difference of neighbours over a seam, and inside.
    fn steps(image: &Image, channel: usize) -> [f32; 2] {
        let step = |x: usize| {
            (0..SIZE).map(move |y| {
                let over = |x: usize, y: usize| pixel(image, x % SIZE, y % SIZE)[channel];
                (over(x, y) - over(x + 1, y)).abs().max((over(y, x) - over(y, x + 1)).abs())
            })
        };
        [step(SIZE - 1).fold(0.0, f32::max), (0..SIZE - 1).flat_map(step).fold(0.0, f32::max)]
    }

    #[test]
    fn every_texture_tiles() {
        let all = Weave::ALL.map(weave_texture).into_iter().chain([noise_texture()]);
        for (number, image) in all.enumerate() {
            for channel in [1, 2] {
                let [seam, inside] = steps(&image, channel);
                assert!(
                    seam <= inside + 0.02,
                    "texture {number}, channel {channel}: {seam} at the seam, {inside} inside"
                );
            }
        }
    }

    #[test]
    fn every_texture_has_all_mipmaps_and_the_last_is_its_mean() {
        for image in Weave::ALL.map(weave_texture) {
            assert_eq!(image.texture_descriptor.mip_level_count, 9);
            let data = image.data.as_ref().expect("pixels");
            assert_eq!(data.len(), (0..9).map(|level| 4 * (SIZE >> level) * (SIZE >> level)).sum::<usize>());
            // Seen from far away a fabric is flat.
            let [slope_u, slope_v] = [0, 1].map(|channel| data[data.len() - 4 + channel]);
            assert!(slope_u.abs_diff(128) <= 2 && slope_v.abs_diff(128) <= 2, "{slope_u} {slope_v}");
        }
    }

    #[test]
    fn twill_shows_more_of_the_warp_and_plain_weave_as_much_of_both() {
        let warp = |weave| {
            let image = weave_texture(weave);
            (0..SIZE * SIZE).map(|i| pixel(&image, i % SIZE, i / SIZE)[3]).sum::<f32>() / (SIZE * SIZE) as f32
        };
        assert!((0.4..0.6).contains(&warp(Weave::Plain)), "{}", warp(Weave::Plain));
        assert!((0.6..0.85).contains(&warp(Weave::Twill)), "{}", warp(Weave::Twill));
    }
}
