//! A room with a wooden floor and two windows, one behind and one on the left. Its front is open to the camera.

use bevy::prelude::*;

use super::{Builder, textures};

/// Width, height and depth, m; the wall behind stands at `BACK`.
const SIZE: Vec3 = Vec3::new(6.4, 2.75, 8.0);
const BACK: f32 = -1.9;
const THICK: f32 = 0.18;
/// Width and height of a window, and the height of its sill, m.
const WINDOW: Vec2 = Vec2::new(1.9, 1.5);
const SILL: f32 = 0.85;
/// How far the middle of the left window is from the wall behind, m.
const ASIDE: f32 = 2.3;
/// Edge of a tile of the floor's texture, m.
const TILE: f32 = 1.4;

pub(super) fn build(builder: &mut Builder) {
    let boards = builder.texture(textures::boards());
    let floor = builder.material(StandardMaterial {
        base_color_texture: boards,
        perceptual_roughness: 0.42,
        reflectance: 0.4,
        ..default()
    });
    let plaster = builder.texture(textures::stone());
    let wall = builder.material(StandardMaterial {
        base_color: Color::srgb(0.95, 0.925, 0.885),
        base_color_texture: plaster,
        perceptual_roughness: 0.95,
        reflectance: 0.2,
        ..default()
    });
    let white = builder.material(StandardMaterial {
        base_color: Color::srgb(0.93, 0.93, 0.92),
        perceptual_roughness: 0.4,
        ..default()
    });
    let mut mesh = Plane3d::default().mesh().size(SIZE.z, SIZE.z).build();
    textures::repeat(&mut mesh, SIZE.z / TILE);
    builder.put(mesh, &floor, Transform::from_xyz(0.0, 0.0, BACK + SIZE.z / 2.0));
    let slab = Cuboid::new(SIZE.x + 2.0 * THICK, THICK, SIZE.z).mesh().build();
    builder.put(slab, &wall, Transform::from_xyz(0.0, SIZE.y + THICK / 2.0, BACK + SIZE.z / 2.0));

    let behind = Transform::from_xyz(0.0, 0.0, BACK);
    let left = Transform::from_xyz(-SIZE.x / 2.0, 0.0, BACK + SIZE.z / 2.0)
        .with_rotation(Quat::from_rotation_y(core::f32::consts::FRAC_PI_2));
    let right = Transform::from_xyz(SIZE.x / 2.0, 0.0, BACK + SIZE.z / 2.0)
        .with_rotation(Quat::from_rotation_y(-core::f32::consts::FRAC_PI_2));
    // Along the left wall x runs towards the wall behind.
    pierced(builder, behind, SIZE.x, 0.0, &wall, &white);
    pierced(builder, left, SIZE.z, SIZE.z / 2.0 - ASIDE, &wall, &white);
    block(builder, right, (-SIZE.z / 2.0, SIZE.z / 2.0), (0.0, SIZE.y), (-THICK, 0.0), &wall);
    for (place, width) in [(behind, SIZE.x), (left, SIZE.z), (right, SIZE.z)] {
        block(builder, place, (-width / 2.0, width / 2.0), (0.0, 0.09), (0.0, 0.015), &white);
    }
}

/// A box between bounds along a wall, upwards, and out of the wall (into the room).
fn block(
    builder: &mut Builder,
    wall: Transform,
    along: (f32, f32),
    up: (f32, f32),
    out: (f32, f32),
    material: &Handle<StandardMaterial>,
) {
    let (low, high) = (Vec3::new(along.0, up.0, out.0), Vec3::new(along.1, up.1, out.1));
    let mut mesh = Cuboid::from_size(high - low).mesh().build();
    textures::repeat(&mut mesh, (high - low).max_element() / 2.0);
    builder.put(mesh, material, wall * Transform::from_translation((low + high) / 2.0));
}

/// A wall `width` wide with a window whose middle is at `at` along it.
fn pierced(
    builder: &mut Builder,
    wall: Transform,
    width: f32,
    at: f32,
    plaster: &Handle<StandardMaterial>,
    white: &Handle<StandardMaterial>,
) {
    let (left, right) = (at - WINDOW.x / 2.0, at + WINDOW.x / 2.0);
    let (low, high) = (SILL, SILL + WINDOW.y);
    let depth = (-THICK, 0.0);
    block(builder, wall, (-width / 2.0, left), (0.0, SIZE.y), depth, plaster);
    block(builder, wall, (right, width / 2.0), (0.0, SIZE.y), depth, plaster);
    block(builder, wall, (left, right), (0.0, low), depth, plaster);
    block(builder, wall, (left, right), (high, SIZE.y), depth, plaster);
    // Frame, bars, sill.
    let (frame, bar, inset) = (0.06, 0.018, (-0.12, -0.07));
    for side in [(left, left + frame), (right - frame, right), (at - frame / 2.0, at + frame / 2.0)] {
        block(builder, wall, side, (low, high), inset, white);
    }
    for height in [(low, low + frame), (high - frame, high)] {
        block(builder, wall, (left, right), height, inset, white);
    }
    let cross = low + WINDOW.y * 0.62;
    block(builder, wall, (left, right), (cross - bar, cross + bar), inset, white);
    block(builder, wall, (left - 0.05, right + 0.05), (low - 0.03, low), (-THICK, 0.08), white);
}
