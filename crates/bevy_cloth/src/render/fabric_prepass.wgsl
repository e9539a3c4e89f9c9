// Depth of fabric: in shadow maps and before the main pass. Holes and fringes are left out.

#import bevy_pbr::{
    prepass_io,
    pbr_prepass_functions,
}
#import bevy_cloth::fabric_types::{fabric, is_gone}

fn discard_what_is_gone(in: prepass_io::VertexOutput) {
    if is_gone(in.uv * fabric.metres, in.color.a, in.uv_b.x) {
        discard;
    }
}

#ifdef PREPASS_FRAGMENT
@fragment
fn fragment(in: prepass_io::VertexOutput) -> prepass_io::FragmentOutput {
    discard_what_is_gone(in);
    var out: prepass_io::FragmentOutput;
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.frag_depth = in.unclipped_depth;
#endif
#ifdef NORMAL_PREPASS
    out.normal = vec4(normalize(in.world_normal) * 0.5 + 0.5, 1.0);
#endif
#ifdef MOTION_VECTOR_PREPASS
    out.motion_vector = pbr_prepass_functions::calculate_motion_vector(in.world_position, in.previous_world_position);
#endif
    return out;
}
#else
@fragment
fn fragment(in: prepass_io::VertexOutput) {
    discard_what_is_gone(in);
}
#endif
