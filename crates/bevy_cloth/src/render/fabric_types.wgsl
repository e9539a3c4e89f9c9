// What the fabric shaders share: the numbers of a look, its textures, and where cloth is no more.

#define_import_path bevy_cloth::fabric_types

// Its twin is `FabricUniform` in `look_material.rs`, with the meaning of each field.
struct Fabric {
    color: vec4<f32>,
    second: vec4<f32>,
    metres: vec2<f32>,
    tile: f32,
    threads: f32,
    pattern_width: f32,
    pattern: u32,
    sheen: f32,
    gloss: f32,
    translucency: f32,
    relief: f32,
    crumple: f32,
    slub: f32,
    pile: f32,
    fray_reach: f32,
    tells: u32,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<uniform> fabric: Fabric;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var weave_texture: texture_2d<f32>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var fabric_sampler: sampler;
@group(#{MATERIAL_BIND_GROUP}) @binding(103) var noise_texture: texture_2d<f32>;

fn hash(key: f32) -> f32 {
    return fract(sin(key * 12.9898 + 4.1414) * 43758.547);
}

// Whether a thread has come off, or fire has eaten the cloth, at `at` (m along weft and warp). `fray` is 0 at a torn edge and
// 1 away from it, `burn` more than 2 where cloth falls apart.
fn is_gone(at: vec2<f32>, fray: f32, burn: f32) -> bool {
    // Derivatives and samples first: they need all neighbours.
    let clouds = textureSample(noise_texture, fabric_sampler, at / 0.12).g;
    let along_x = dpdx(at);
    let along_y = dpdy(at);
    let step = vec2(dpdx(fray), dpdy(fray));
    let turn = along_x.x * along_y.y - along_x.y * along_y.x;
    let slope = vec2(along_y.y * step.x - along_x.y * step.y, along_x.x * step.y - along_y.x * step.x);

    if burn > 2.0 && (burn - 2.0) + 0.8 * (clouds - 0.5) > 0.7 {
        return true;
    }
    // A strip between two tears has no inside to fray from.
    if fray >= 1.0 || burn > 1.0 || length(slope) * fabric.fray_reach < 0.1 * abs(turn) {
        return false;
    }
    let distance = fray * fabric.fray_reach;
    // Threads that end at the edge stick out; those along it have come off.
    let across = select(at.x, at.y, abs(slope.x) > abs(slope.y));
    let width = length(vec2(length(along_x), length(along_y)));
    let number = across * clamp(fabric.threads, 300.0, 1500.0);
    let seen = 1.0 - smoothstep(0.35, 0.8, width * clamp(fabric.threads, 300.0, 1500.0));
    let clump = hash(floor(across * 190.0 + 1.5 * clouds));
    let longest = 0.002 + 0.010 * clump * clump + 0.006 * (clouds - 0.3);
    let ends = longest * mix(0.6, hash(floor(number)), seen);
    let is_gap = abs(fract(number) - 0.5) > 0.30 && seen > 0.5;
    return distance < ends || (distance < 1.3 * longest && is_gap);
}
