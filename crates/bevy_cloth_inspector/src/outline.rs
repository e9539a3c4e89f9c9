//! Lines around the selected object: its silhouette for a solid, its border for a cloth.
//!
//! The lines follow the mesh, not a primitive, so that anything that can be selected has them.

use bevy::camera::Camera3d;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::Topology;
use bevy_cloth::{Cloth, ClothSystems, ClothTopology};

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
struct EdgeCache {
    solids: HashMap<AssetId<Mesh>, (usize, Vec<Edge>)>,
    /// Pairs of vertices along the border of each cloth.
    cloths: HashMap<Entity, Vec<[u32; 2]>>,
}

/// Vertices at the ends of the edges that have a triangle on one side only. By its particles, not by where they are: the sides of
/// a fresh tear still lie together, and the sides of a seam of the texture are one.
fn border(topology: &Topology) -> Vec<[u32; 2]> {
    let mut vertex = vec![0; topology.slots()];
    for (number, particle) in topology.vertex_particle.iter().enumerate() {
        vertex[*particle as usize] = number as u32;
    }
    let mut sides: HashMap<[u32; 2], u32> = HashMap::default();
    for [a, b, c] in &topology.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *sides.entry([*a.min(b), *a.max(b)]).or_default() += 1;
        }
    }
    let mut border: Vec<_> = sides.into_iter().filter(|(_, sides)| *sides == 1).map(|(edge, _)| edge).collect();
    border.sort_unstable();
    border.into_iter().map(|edge| edge.map(|particle| vertex[particle as usize])).collect()
}

fn draw(
    mut gizmos: Gizmos<SelectionGizmos>,
    mut cache: Local<EdgeCache>,
    selected: Res<Selected>,
    meshes: Res<Assets<Mesh>>,
    shown: Query<(&Mesh3d, &GlobalTransform, Has<Cloth>, Option<Ref<ClothTopology>>), Without<NoOutline>>,
    children: Query<&Children>,
    cameras: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
) {
    let Some(root) = selected.0 else {
        *cache = EdgeCache::default();
        return;
    };
    let Some((_, camera)) =
        cameras.iter().filter(|(camera, _)| camera.is_active).min_by_key(|(camera, _)| camera.order)
    else {
        return;
    };
    for entity in std::iter::once(root).chain(children.iter_descendants(root)) {
        let Ok((mesh, transform, is_cloth, topology)) = shown.get(entity) else { continue };
        // A curtain hangs below its rod in the hierarchy, but is another object.
        if is_cloth && entity != root {
            continue;
        }
        let Some(surface) = meshes.get(mesh).and_then(Surface::read) else { continue };
        let mut line = |[a, b]: [Vec3; 2]| {
            gizmos.line(transform.transform_point(a), transform.transform_point(b), COLOR);
        };
        if let Some(topology) = topology {
            if topology.is_changed() {
                cache.cloths.remove(&entity);
            }
            let border = cache.cloths.entry(entity).or_insert_with(|| border(&topology));
            border.iter().filter_map(|edge| surface.segment(*edge)).for_each(&mut line);
            continue;
        }
        let triangles = surface.triangle_count();
        let (_, edges) = cache
            .solids
            .entry(mesh.id())
            .and_modify(|cached| {
                if cached.0 != triangles {
                    *cached = (triangles, surface.edges());
                }
            })
            .or_insert_with(|| (triangles, surface.edges()));
        let eye = transform.affine().inverse().transform_point3(camera.translation());
        surface.sharp_silhouette(edges, eye).chain(surface.smooth_silhouette(eye)).for_each(&mut line);
    }
}

#[cfg(test)]
mod tests {
    use bevy_cloth::cloth_solver::topology::Resolution;

    use super::*;

    #[test]
    fn a_rectangle_has_its_four_sides_as_border() {
        let topology = Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::new(5, 3))).expect("a rectangle");
        assert_eq!(border(&topology).len(), 2 * (5 + 3));
    }
}
