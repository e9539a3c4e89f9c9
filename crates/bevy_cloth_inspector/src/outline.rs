//! Lines around the selected object: its silhouette for a solid, its border for a cloth.
//!
//! The lines follow the mesh, not a primitive, so that anything that can be selected has them.

use bevy::camera::Camera3d;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_cloth::{Cloth, ClothSystems};

use crate::Selected;
use crate::silhouette::{Edge, Surface};

/// Bright, and far from the colours that cloth, wood and sky have.
const COLOR: Color = Color::srgb(1.0, 0.10, 0.70);
/// Width of the lines, pixels.
const WIDTH: f32 = 4.0;

/// The gizmos the outline is drawn with: change their [`GizmoConfig`] to change its width, or to hide it.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct SelectionGizmos;

/// Leaves the mesh of its entity out of the outline: for what is so fine that its outline would cover it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default)]
pub struct NoOutline;

/// Draws the outline.
pub struct OutlinePlugin;

impl Plugin for OutlinePlugin {
    fn build(&self, app: &mut App) {
        let config = GizmoConfig { line: GizmoLineConfig { width: WIDTH, ..default() }, depth_bias: -1.0, ..default() };
        app.register_type::<NoOutline>()
            .insert_gizmo_config(SelectionGizmos, config)
            .add_systems(PostUpdate, draw.after(TransformSystems::Propagate).after(ClothSystems::Draw));
    }
}

/// Edges of the meshes that were outlined last. A mesh that is changed in place keeps them, as long as it has as many
/// triangles.
#[derive(Default)]
struct EdgeCache(HashMap<AssetId<Mesh>, (usize, Vec<Edge>)>);

fn draw(
    mut gizmos: Gizmos<SelectionGizmos>,
    mut cache: Local<EdgeCache>,
    selected: Res<Selected>,
    meshes: Res<Assets<Mesh>>,
    shown: Query<(&Mesh3d, &GlobalTransform, Has<Cloth>), Without<NoOutline>>,
    children: Query<&Children>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
) {
    let Some(root) = selected.0 else {
        cache.0.clear();
        return;
    };
    let Some((_, camera)) =
        cameras.iter().filter(|(camera, _)| camera.is_active).min_by_key(|(camera, _)| camera.order)
    else {
        return;
    };
    for entity in std::iter::once(root).chain(children.iter_descendants(root)) {
        let Ok((mesh, transform, is_cloth)) = shown.get(entity) else { continue };
        // A curtain hangs below its rod in the hierarchy, but is another object.
        if is_cloth && entity != root {
            continue;
        }
        if let Some(surface) = meshes.get(mesh).and_then(Surface::read) {
            let triangles = surface.triangle_count();
            let (_, edges) = cache
                .0
                .entry(mesh.id())
                .and_modify(|cached| {
                    if cached.0 != triangles {
                        *cached = (triangles, surface.edges());
                    }
                })
                .or_insert_with(|| (triangles, surface.edges()));
            let eye = transform.affine().inverse().transform_point3(camera.translation());
            let mut line = |[a, b]: [Vec3; 2]| {
                gizmos.line(transform.transform_point(a), transform.transform_point(b), COLOR);
            };
            if is_cloth {
                surface.border(edges).for_each(&mut line);
            } else {
                surface.sharp_silhouette(edges, eye).chain(surface.smooth_silhouette(eye)).for_each(&mut line);
            }
        }
    }
}
