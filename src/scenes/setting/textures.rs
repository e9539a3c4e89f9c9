//! Textures painted when the game starts: wood, grass, stone. Each repeats without a seam and has all its coarser copies.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

use crate::look::{fractal, hash};

/// Edge of a texture, texels.
const EDGE: u32 = 256;
/// Boards across a texture of a floor.
const BOARDS: f32 = 8.0;

/// Paints a texture that repeats: `color` gives linear red, green and blue at a place, 0..1 along both edges.
fn paint(color: impl Fn(Vec2) -> Vec3) -> Image {
    let place = |index: u32| (Vec2::new((index % EDGE) as f32, (index / EDGE) as f32) + 0.5) / EDGE as f32;
    let mut level: Vec<Vec3> = (0..EDGE * EDGE).map(|index| color(place(index))).collect();
    let (mut edge, mut bytes, mut levels) = (EDGE, Vec::new(), 0);
    loop {
        for texel in &level {
            let srgb = Srgba::from(LinearRgba::rgb(texel.x, texel.y, texel.z));
            bytes.extend(srgb.to_u8_array());
        }
        levels += 1;
        if edge == 1 {
            break;
        }
        let half = edge / 2;
        let old = |x: u32, y: u32| level[(y * edge + x) as usize];
        let mean = |index: u32| {
            let (x, y) = (2 * (index % half), 2 * (index / half));
            (old(x, y) + old(x + 1, y) + old(x, y + 1) + old(x + 1, y + 1)) / 4.0
        };
        level = (0..half * half).map(mean).collect();
        edge = half;
    }
    let size = Extent3d { width: EDGE, height: EDGE, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let mut image = Image::new_uninit(size, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD);
    image.texture_descriptor.mip_level_count = levels;
    image.data = Some(bytes);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: 8,
        ..default()
    });
    image
}

/// Noise that repeats after 1 along both axes, with `x` and `y` waves of it; 0..=1.
fn tiled(at: Vec2, waves: Vec2, octaves: u32) -> f32 {
    let from = |offset: Vec2| fractal((at + offset) * waves + 11.0, octaves);
    let (near, right, down, both) = (from(Vec2::ZERO), from(Vec2::NEG_X), from(Vec2::NEG_Y), from(Vec2::NEG_ONE));
    let smooth = |part: f32| part * part * (3.0 - 2.0 * part);
    let (x, y) = (smooth(at.x), smooth(at.y));
    // Mixing noises flattens them: stretched back about their mean.
    let mixed = (near * (1.0 - x) + right * x) * (1.0 - y) + (down * (1.0 - x) + both * x) * y;
    let flat = ((1.0 - x).powi(2) + x * x) * ((1.0 - y).powi(2) + y * y);
    (0.5 + (mixed - 0.5) / flat.sqrt()).clamp(0.0, 1.0)
}

/// Fibres along y, darker and lighter than 1.
fn fibres(at: Vec2, seed: f32) -> f32 {
    let wavy = at.x + 0.02 * (tiled(Vec2::new(at.x, at.y), Vec2::new(2.0, 2.0), 2) - 0.5);
    let fine = tiled(Vec2::new((wavy + seed).rem_euclid(1.0), at.y), Vec2::new(56.0, 2.0), 3);
    let broad = tiled(Vec2::new((wavy + 2.0 * seed).rem_euclid(1.0), at.y), Vec2::new(12.0, 1.5), 3);
    0.72 + 0.30 * fine + 0.26 * (broad - 0.3)
}

/// The grain of a piece of wood along y.
pub fn grain() -> Image {
    paint(|at| Vec3::splat((fibres(at, 0.0) * 0.9).min(1.0)))
}

/// A floor of oak boards along y.
pub fn boards() -> Image {
    paint(|at| {
        let board = (at.x * BOARDS).floor();
        let joint = hash(Vec2::new(board, 5.0));
        let along = (at.y + joint).rem_euclid(1.0);
        let (tone, seed) = (hash(Vec2::new(board, 1.0)), hash(Vec2::new(board, 2.0)));
        let across = (at.x * BOARDS).fract();
        let wood = Vec3::new(0.36, 0.215, 0.115).lerp(Vec3::new(0.47, 0.31, 0.18), tone) * fibres(at, seed);
        let gap = (across.min(1.0 - across) * 60.0).min(1.0) * (along.min(1.0 - along) * 420.0).min(1.0);
        wood * (0.35 + 0.65 * gap)
    })
}

/// Short grass.
pub fn grass() -> Image {
    paint(|at| {
        let blades = tiled(at, Vec2::new(90.0, 60.0), 3);
        let patches = tiled(at, Vec2::new(4.0, 4.0), 4);
        let green = Vec3::new(0.045, 0.085, 0.018).lerp(Vec3::new(0.13, 0.175, 0.045), blades);
        green.lerp(Vec3::new(0.20, 0.19, 0.07), 0.45 * (patches - 0.35).max(0.0)) * (0.75 + 0.5 * patches)
    })
}

/// Fine speckles, lighter and darker than most.
pub fn stone() -> Image {
    paint(|at| {
        let broad = tiled(at, Vec2::splat(5.0), 5);
        let fine = tiled(at, Vec2::splat(70.0), 2);
        Vec3::splat(0.80 + 0.12 * (broad - 0.5) + 0.10 * (fine - 0.5))
    })
}

/// Repeats the texture of a mesh so many times along both edges.
pub fn repeat(mesh: &mut Mesh, times: f32) {
    if let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute_mut(Mesh::ATTRIBUTE_UV_0) {
        uvs.iter_mut().flatten().for_each(|part| *part *= times);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_repeat_without_a_seam() {
        for waves in [3.0, 17.0] {
            for along in [0.1, 0.37, 0.8] {
                let [left, right] = [0.0, 0.999_9].map(|x| tiled(Vec2::new(x, along), Vec2::splat(waves), 3));
                let [top, bottom] = [0.0, 0.999_9].map(|y| tiled(Vec2::new(along, y), Vec2::splat(waves), 3));
                assert!((left - right).abs() < 0.02 && (top - bottom).abs() < 0.02, "{left} {right} {top} {bottom}");
            }
        }
    }

    #[test]
    fn a_texture_has_all_its_coarser_copies() {
        let image = stone();
        assert_eq!(image.texture_descriptor.mip_level_count, 9);
        assert_eq!(
            image.data.expect("data").len(),
            4 * (0..9).map(|level| (256 >> level) * (256 >> level)).sum::<usize>()
        );
    }
}
