//! A meadow: rough grass as far as the haze, blades of it near by.

use bevy::asset::RenderAssetUsages;
use bevy::light::NotShadowCaster;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;

use super::{Builder, GROUND, textures};
use crate::look::{fractal, hash};

/// Blades of grass, how far they reach from the middle, m, and how long they are, m.
const BLADES: u32 = 26_000;
const REACH: f32 = 9.0;
const LENGTH: (f32, f32) = (0.05, 0.15);

pub(super) fn build(builder: &mut Builder) {
    let base_color_texture = builder.texture(textures::grass());
    let ground = builder.material(StandardMaterial {
        base_color_texture,
        perceptual_roughness: 1.0,
        reflectance: 0.1,
        ..default()
    });
    builder.floor(GROUND, 2.6, &ground);
    let blade = builder.material(StandardMaterial {
        perceptual_roughness: 0.85,
        reflectance: 0.2,
        cull_mode: None,
        ..default()
    });
    let blades = builder.put(blades(), &blade, Transform::IDENTITY);
    builder.commands.entity(blades).insert(NotShadowCaster);
}

/// Triangles that stand and lean, denser in tufts and near the middle, dark at the root.
fn blades() -> Mesh {
    let (mut positions, mut normals, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for blade in 0..BLADES {
        let draw = |which: u32| hash(Vec2::new(blade as f32, which as f32));
        let (out, around) = (REACH * draw(0).powf(0.75), core::f32::consts::TAU * draw(1));
        let at = Vec2::from_angle(around) * out;
        let tuft = fractal(at * 1.3 + 90.0, 3);
        if tuft < 0.28 {
            continue;
        }
        let fade = 1.0 - (out / REACH).powi(3);
        let length = (LENGTH.0 + (LENGTH.1 - LENGTH.0) * draw(2) * tuft * 1.6) * fade;
        let (side, lean) =
            (Vec2::from_angle(6.3 * draw(3)) * 0.0035, Vec2::from_angle(6.3 * draw(4)) * length * 0.6 * draw(5));
        let root = Vec3::new(at.x, 0.0, at.y);
        positions.extend([
            (root - Vec3::new(side.x, 0.004, side.y)).to_array(),
            (root + Vec3::new(side.x, -0.004, side.y)).to_array(),
            (root + Vec3::new(lean.x, length, lean.y)).to_array(),
        ]);
        // They are lit as the ground is, so that a field of them is of one light.
        normals.extend([[0.0_f32, 1.0, 0.0]; 3]);
        let dry = draw(6) * draw(6);
        let tip = Vec3::new(0.13, 0.20, 0.045).lerp(Vec3::new(0.36, 0.33, 0.13), dry) * (0.7 + 0.5 * draw(7));
        colors.extend([tip * 0.35, tip * 0.35, tip].map(|color| color.extend(1.0).to_array()));
    }
    let uvs = vec![[0.0_f32; 2]; positions.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
}
