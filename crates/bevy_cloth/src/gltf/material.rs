//! Materials of mirrored nodes.

use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::prelude::*;
use bevy::render::render_resource::Face;

use super::FromGltf;

/// Gives a cloth whose node is mirrored a copy of its material that culls backs again. The loader makes materials of such nodes
/// cull fronts, because a mirror turns the triangles of their meshes over; the mesh that a cloth draws is never turned over.
pub(super) fn turn(
    mut cloths: Query<&mut MeshMaterial3d<StandardMaterial>, Added<FromGltf>>,
    materials: Option<ResMut<Assets<StandardMaterial>>>,
) {
    let Some(mut materials) = materials else { return };
    for mut material in &mut cloths {
        let mirrored = materials.get(&material.0).filter(|material| material.cull_mode == Some(Face::Front));
        if let Some(turned) = mirrored.map(|own| StandardMaterial { cull_mode: Some(Face::Back), ..own.clone() }) {
            material.0 = materials.add(turned);
        }
    }
}
