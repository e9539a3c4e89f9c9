//! Cube maps painted on the processor: what a sky looks like, and the light that comes from it.
//!
//! Light is averaged here and not on the graphics processor, so that it is there in the first frame and wherever the game runs.

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy::tasks::{ComputeTaskPool, ParallelSlice, ParallelSliceMut, TaskPool};
use half::f16;

/// Edge of a face of the map of diffuse light, texels: it has no detail.
const DIFFUSE: u32 = 8;

/// Six square faces of light, linear red, green and blue.
#[derive(Clone, Debug)]
pub struct Cubemap {
    edge: u32,
    texels: Vec<Vec3>,
}

impl Cubemap {
    /// Paints what is seen in each direction (a unit vector, y up) on faces of `edge` texels, a power of two.
    pub fn paint(edge: u32, radiance: impl Fn(Vec3) -> Vec3 + Send + Sync) -> Self {
        let mut texels = vec![Vec3::ZERO; 6 * (edge * edge) as usize];
        let part = (edge * edge).div_ceil(8) as usize;
        texels.par_chunk_map_mut(threads(), part, |index, texels| {
            for (index, texel) in (index * part..).zip(texels) {
                let index = index as u32;
                *texel = radiance(direction(index / (edge * edge), index % edge, index / edge % edge, edge));
            }
        });
        Self { edge, texels }
    }

    /// Half as fine: each texel the mean of four.
    fn halved(&self) -> Self {
        let edge = self.edge / 2;
        let old = |face: u32, x: u32, y: u32| self.texels[((face * self.edge + y) * self.edge + x) as usize];
        let mean = |index: u32| {
            let (face, x, y) = (index / (edge * edge), 2 * (index % edge), 2 * (index / edge % edge));
            (old(face, x, y) + old(face, x + 1, y) + old(face, x, y + 1) + old(face, x + 1, y + 1)) / 4.0
        };
        Self { edge, texels: (0..6 * edge * edge).map(mean).collect() }
    }

    /// The light on a matt surface that faces each direction, as a part of what falls on it from all sides.
    fn diffused(&self) -> Self {
        let mut coarse = self.clone();
        while coarse.edge > DIFFUSE {
            coarse = coarse.halved();
        }
        let edge = coarse.edge;
        let sources: Vec<(Vec3, Vec3)> = (0..6 * edge * edge)
            .map(|index| {
                let at = direction(index / (edge * edge), index % edge, index / edge % edge, edge);
                // A texel near a corner of the cube is farther away and seen at an angle.
                let solid_angle = at.abs().max_element().powi(3);
                (at, coarse.texels[index as usize].extend(1.0).truncate() * solid_angle)
            })
            .collect();
        let whole: f32 = sources.iter().map(|(at, _)| at.abs().max_element().powi(3) * at.y.max(0.0)).sum();
        Self::paint(edge, |normal| {
            sources.iter().map(|(at, light)| *light * normal.dot(*at).max(0.0)).sum::<Vec3>() / whole
        })
    }

    /// The map as a texture, without coarser copies of itself.
    pub fn image(&self) -> Image {
        image(self.edge, std::slice::from_ref(self))
    }

    /// The light that comes from all sides, as a matt and as a glossy surface receive it: textures for an environment map.
    pub fn light(&self) -> (Image, Image) {
        let mut levels = vec![self.clone()];
        while let Some(last) = levels.last().filter(|last| last.edge > 1) {
            levels.push(last.halved());
        }
        (self.diffused().image(), image(self.edge, &levels))
    }
}

/// The direction of the middle of a texel: faces +x, −x, +y, −y, +z, −z as graphics processors number them.
fn direction(face: u32, x: u32, y: u32, edge: u32) -> Vec3 {
    let part = |place: u32| (2.0 * place as f32 + 1.0) / edge as f32 - 1.0;
    let (u, v) = (part(x), part(y));
    // The cube is seen from within, its z axis turned about: Bevy flips z when it looks up.
    let at = match face {
        0 => Vec3::new(1.0, -v, -u),
        1 => Vec3::new(-1.0, -v, u),
        2 => Vec3::new(u, 1.0, v),
        3 => Vec3::new(u, -1.0, -v),
        4 => Vec3::new(u, -v, 1.0),
        _ => Vec3::new(-u, -v, -1.0),
    };
    (at * Vec3::new(1.0, 1.0, -1.0)).normalize()
}

/// The threads to paint on.
fn threads() -> &'static TaskPool {
    ComputeTaskPool::get_or_init(TaskPool::default)
}

/// A texel, opaque, as numbers of half precision.
fn halves(texel: &Vec3) -> [u8; 8] {
    let mut bytes = [0; 8];
    for (bytes, part) in bytes.chunks_exact_mut(2).zip(texel.extend(1.0).to_array()) {
        bytes.copy_from_slice(&f16::from_f32(part.clamp(0.0, 65_000.0)).to_le_bytes());
    }
    bytes
}

/// A texture of the same map at several sizes, each half of the one before.
fn image(edge: u32, levels: &[Cubemap]) -> Image {
    let mut bytes = Vec::new();
    // One face with all its levels after another.
    for face in 0..6 {
        for level in levels {
            let texels = (level.edge * level.edge) as usize;
            let face = &level.texels[face * texels..(face + 1) * texels];
            let parts = face.par_chunk_map(threads(), texels.div_ceil(8), |_, texels| {
                texels.iter().flat_map(halves).collect::<Vec<u8>>()
            });
            parts.iter().for_each(|part| bytes.extend_from_slice(part));
        }
    }
    let size = Extent3d { width: edge, height: edge, depth_or_array_layers: 6 };
    let mut image =
        Image::new_uninit(size, TextureDimension::D2, TextureFormat::Rgba16Float, RenderAssetUsages::RENDER_WORLD);
    image.texture_descriptor.mip_level_count = levels.len() as u32;
    image.data = Some(bytes);
    image.texture_view_descriptor =
        Some(TextureViewDescriptor { dimension: Some(TextureViewDimension::Cube), ..default() });
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn under_an_even_sky_every_surface_receives_the_same_light() {
        let even = Cubemap::paint(16, |_| Vec3::splat(2.0)).diffused();
        assert!(even.texels.iter().all(|light| (*light - 2.0).abs().max_element() < 0.05), "{:?}", even.texels[0]);
    }

    #[test]
    fn what_faces_a_bright_half_of_the_sky_is_brighter() {
        let above = Cubemap::paint(16, |at| Vec3::splat(if at.y > 0.0 { 1.0 } else { 0.0 })).diffused();
        let facing = |wanted: Vec3| {
            let at = |index: u32| direction(index / 64, index % 8, index / 8 % 8, 8);
            let nearest = (0..384).max_by(|a, b| at(*a).dot(wanted).total_cmp(&at(*b).dot(wanted))).expect("texels");
            above.texels[nearest as usize].x
        };
        let (up, aside, down) = (facing(Vec3::Y), facing(Vec3::X), facing(Vec3::NEG_Y));
        assert!(up > 0.9 && (0.4..0.65).contains(&aside) && down < 0.1, "{up} {aside} {down}");
    }

    #[test]
    fn a_texture_holds_all_its_levels() {
        let (diffuse, glossy) = Cubemap::paint(16, |_| Vec3::ONE).light();
        assert_eq!(diffuse.data.expect("data").len(), 6 * 64 * 8);
        assert_eq!(glossy.data.expect("data").len(), 6 * 8 * (256 + 64 + 16 + 4 + 1));
    }
}
