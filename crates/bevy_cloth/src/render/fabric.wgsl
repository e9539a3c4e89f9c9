// Fabric: a standard material whose colour, normal and smoothness are those of threads, with what threads scatter besides.

#import bevy_pbr::{
    forward_io::{VertexOutput, FragmentOutput},
    lighting,
    mesh_types::MESH_FLAGS_SHADOW_RECEIVER_BIT,
    mesh_view_bindings as view_bindings,
    mesh_view_types,
    pbr_fragment::pbr_input_from_standard_material,
    pbr_functions::{apply_pbr_lighting, main_pass_post_lighting_processing},
    pbr_types::PbrInput,
    shadows,
}
#import bevy_cloth::fabric_types::{fabric, fabric_sampler, is_gone, noise_texture, weave_texture}

// The steepest slope that the textures hold, and how deep the relief of threads is, in their widths.
const STEEPEST: f32 = 2.0;
const DEPTH: f32 = 0.4;
// Linear colour of a glowing rim: brighter than white, so that it shines where the camera blooms.
const EMBER: vec3<f32> = vec3(6.0, 1.1, 0.12);
// Width of the Charlie lobe of fibres that stand out (Estevez and Kulla 2017).
const FIBRE_WIDTH: f32 = 0.35;

// Stripes of the width 1, 0 and 1 by turns, with edges as wide as a pixel.
fn stripes(at: f32, pixel: f32) -> f32 {
    let wave = abs(fract(0.5 * at - 0.25) - 0.5) * 2.0 - 0.5;
    return clamp(wave / max(pixel, 1e-4) + 0.5, 0.0, 1.0);
}

// Colours of the warp and of the weft.
fn dyes(at: vec2<f32>) -> array<vec3<f32>, 2> {
    let color = fabric.color.rgb;
    let second = fabric.second.rgb;
    let width = fabric.pattern_width;
    let pixel = fwidth(at) / width;
    let down = stripes(at.x / width, pixel.x);
    let across = stripes(at.y / width, pixel.y);
    let from_hem = min(at, fabric.metres - at) / width;
    let inset = abs(min(from_hem.x, from_hem.y) - 2.5);
    let border = clamp((0.5 - inset) / max(max(pixel.x, pixel.y), 1e-4) + 0.5, 0.0, 1.0);
    switch fabric.pattern {
        case 0u: { return array(color, second); }
        case 1u: { let dye = mix(color, second, down); return array(dye, dye); }
        case 2u: { let dye = mix(color, second, across); return array(dye, dye); }
        case 3u: { return array(mix(color, second, down), mix(color, second, across)); }
        default: { let dye = mix(color, second, border); return array(dye, dye); }
    }
}

// What fibres that stand out and smooth threads throw back of the lights that are far away.
fn threads_light(in: PbrInput, weft: vec3<f32>, warp: vec3<f32>, sheen: vec3<f32>, silk: vec3<f32>) -> vec3<f32> {
    var light_sum = vec3(0.0);
    let view_z = dot(vec4(
        view_bindings::view.view_from_world[0].z,
        view_bindings::view.view_from_world[1].z,
        view_bindings::view.view_from_world[2].z,
        view_bindings::view.view_from_world[3].z
    ), in.world_position);
    let NdotV = max(dot(in.N, in.V), 1e-3);
    for (var i = 0u; i < view_bindings::lights.n_directional_lights; i += 1u) {
        let light = &view_bindings::lights.directional_lights[i];
        let L = (*light).direction_to_light.xyz;
        let NdotL = max(dot(in.N, L), 1e-4);
        var shadow = 1.0;
        if (in.flags & MESH_FLAGS_SHADOW_RECEIVER_BIT) != 0u
            && ((*light).flags & mesh_view_types::DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u {
            shadow = shadows::fetch_directional_shadow(i, in.world_position, in.world_normal, view_z, in.frag_coord.xy);
        }
        let H = normalize(L + in.V);
        let NdotH = saturate(dot(in.N, H));
        let sine = sqrt(max(1.0 - NdotH * NdotH, 0.0));
        let fibres = (2.0 + 1.0 / FIBRE_WIDTH) * pow(sine, 1.0 / FIBRE_WIDTH) / 6.2831853
            / (4.0 * (NdotL + NdotV - NdotL * NdotV));
        // Light glides along threads and spreads across them.
        let wide = 0.45;
        let narrow = 0.13;
        let threads = lighting::D_GGX_anisotropic(wide, narrow, NdotH, dot(weft, H), dot(warp, H))
            * lighting::V_GGX_anisotropic(
                wide, narrow, NdotL, NdotV, dot(warp, in.V), dot(weft, in.V), dot(weft, L), dot(warp, L));
        light_sum += (sheen * fibres + silk * threads) * NdotL * shadow * (*light).color.rgb;
    }
    return light_sum * view_bindings::view.exposure;
}

@fragment
fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> FragmentOutput {
    let at = in.uv * fabric.metres;
    let threads = textureSample(weave_texture, fabric_sampler, at / fabric.tile);
    let mean = textureSampleLevel(weave_texture, fabric_sampler, at, 8.0);
    let uneven = at * fabric.threads / 400.0;
    let streak_warp = textureSample(noise_texture, fabric_sampler, uneven).r;
    let streak_weft = textureSample(noise_texture, fabric_sampler, uneven.yx).r;
    let clouds = textureSample(noise_texture, fabric_sampler, at / 0.43);
    let fine_clouds = textureSample(noise_texture, fabric_sampler, at / 0.17);
    let dye = dyes(at);
    let burn = in.uv_b.x;
    let gone = is_gone(at, in.color.a, burn);
    var pbr = pbr_input_from_standard_material(in, is_front);
    if gone {
        discard;
    }
    let wet = smoothstep(0.1, 0.7, in.uv_b.y + 0.5 * step(0.01, in.uv_b.y) * (fine_clouds.g - 0.5));
    let glow = saturate(-in.uv_b.y);

    // The frame of the fabric: the weft along u, the warp against v.
    let N = normalize(in.world_normal);
    let weft = normalize(in.world_tangent.xyz);
    let warp = in.world_tangent.w * cross(N, weft);
    var slope = (threads.rg - 0.5) * (2.0 * STEEPEST * DEPTH) * fabric.relief * (1.0 - 0.5 * wet);
    slope += ((clouds.ba - 0.5) + 0.5 * (fine_clouds.ba - 0.5)) * 0.5 * fabric.crumple;
    pbr.N = normalize(N - slope.x * weft + slope.y * warp);
    let NdotV = saturate(dot(pbr.N, pbr.V));
    let edge_on = pow(1.0 - saturate(dot(N, pbr.V)), 2.5);

    if fabric.tells != 0u {
        pbr.material.base_color = vec4(in.color.rgb, 1.0);
        pbr.material.diffuse_transmission = 0.0;
        var out: FragmentOutput;
        out.color = main_pass_post_lighting_processing(pbr, apply_pbr_lighting(pbr));
        return out;
    }

    // Looked at along the warp, more of the weft is seen.
    let along_warp = dot(pbr.V, warp);
    let along_weft = dot(pbr.V, weft);
    let shot = 0.35 * fabric.gloss * (along_weft * along_weft - along_warp * along_warp);
    let share = saturate(threads.a + shot);
    var albedo = mix(dye[1], dye[0], share) * in.color.rgb;
    let streak = mix(streak_weft, streak_warp, share) - 0.5;
    albedo *= 1.0 + fabric.slub * (0.55 * streak + 0.25 * (clouds.g - 0.5));
    albedo *= mix(0.45, 1.0, saturate(threads.b / max(mean.b, 0.1)));

    // Scorched brown: blue goes first. Then black.
    let ragged = burn + 0.5 * saturate(burn) * (fine_clouds.g - 0.5);
    let scorch = saturate(ragged);
    let char_share = saturate(1.3 * (ragged - 1.0));
    albedo *= 1.0 - scorch * vec3(0.45, 0.70, 0.85);
    albedo = mix(albedo, vec3(0.012, 0.011, 0.010), char_share);
    albedo *= mix(1.0, 0.42, wet);

    let bare = (1.0 - char_share) * (1.0 - 0.8 * wet);
    let sheen = fabric.sheen * bare;
    // A pile is dark where it is looked into, and bright where its fibres are seen from the side.
    let pile = fabric.pile * bare;
    let lively = sqrt(albedo) * 0.75;
    albedo *= 1.0 - 0.55 * pile * NdotV;
    albedo = mix(albedo, lively, sheen * edge_on * 0.55);

    pbr.material.base_color = vec4(albedo, 1.0);
    pbr.material.perceptual_roughness = mix(pbr.material.perceptual_roughness, 0.5, 0.8 * wet);
    // A pile breaks the film of water, so that it mirrors little.
    pbr.material.reflectance = mix(pbr.material.reflectance, vec3(0.3 * (1.0 - 0.8 * fabric.pile)), wet);
    let thin = 1.0 + 0.7 * (mean.b - threads.b);
    pbr.material.diffuse_transmission = saturate(fabric.translucency * thin * (1.0 + 0.3 * wet)) * (1.0 - char_share);
    let rim = smoothstep(1.7, 2.6, burn + 0.8 * (fine_clouds.g - 0.5));
    pbr.material.emissive = vec4(EMBER * glow * rim, 0.0);

    var color = apply_pbr_lighting(pbr);
    if sheen > 0.05 || fabric.gloss > 0.3 {
        let smoothness = fabric.gloss * fabric.gloss * (1.0 - char_share);
        let tint = mix(vec3(1.0), lively / max(max(lively.r, max(lively.g, lively.b)), 0.05), 0.65);
        let extra = threads_light(pbr, weft, warp, lively * sheen * 0.6, tint * 0.14 * smoothness);
        color = vec4(color.rgb + extra, color.a);
    }
    var out: FragmentOutput;
    out.color = main_pass_post_lighting_processing(pbr, color);
    return out;
}
