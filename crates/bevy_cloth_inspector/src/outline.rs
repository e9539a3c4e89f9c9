//! Lines around the selected object and around the one under the pointer: the silhouette of a solid, the border of a cloth.
//!
//! The lines follow the mesh, not a primitive, so that anything that can be selected has them.

use bevy::camera::Camera3d;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_cloth::cloth_solver::Topology;
use bevy_cloth::{Cloth, ClothSystems, ClothTopology};

use crate::silhouette::{Edge, Surface};
use crate::{Hovered, Selected};

/// Bright, and far from the colours that cloth, wood and sky have.
const COLOR: Color = Color::srgb(1.0, 0.10, 0.70);
/// Width of the lines, pixels.
const WIDTH: f32 = 4.0;
/// Colour and width (pixels) of the lines around what is only pointed at.
const HOVER: (Color, f32) = (Color::srgba(1.0, 0.95, 0.75, 0.8), 2.5);

/// The gizmos the outline is drawn with: change their [`GizmoConfig`] to change its width, or to hide it.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct SelectionGizmos;

/// The gizmos that [`Hovered`] is drawn with.
#[derive(Default, Reflect, GizmoConfigGroup)]
pub struct HoverGizmos;

/// Leaves the mesh of its entity out of the outline: for what is so fine that its outline would cover it.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default)]
pub struct NoOutline;

/// Draws the outline.
pub struct OutlinePlugin;

impl Plugin for OutlinePlugin {
    fn build(&self, app: &mut App) {
        let config = GizmoConfig { line: GizmoLineConfig { width: WIDTH, ..default() }, depth_bias: -1.0, ..default() };
        let soft = GizmoConfig { line: GizmoLineConfig { width: HOVER.1, ..default() }, ..config.clone() };
        let draw = (draw_selected, draw_hovered).after(TransformSystems::Propagate).after(ClothSystems::Draw);
        app.register_type::<NoOutline>()
            .insert_gizmo_config(SelectionGizmos, config)
            .insert_gizmo_config(HoverGizmos, soft)
            .add_systems(PostUpdate, draw);
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

/// What an outline is drawn of, and for whom.
#[derive(SystemParam)]
struct Scene<'w, 's> {
    meshes: Res<'w, Assets<Mesh>>,
    shown: Query<
        'w,
        's,
        (&'static Mesh3d, &'static GlobalTransform, Has<Cloth>, Option<Ref<'static, ClothTopology>>),
        Without<NoOutline>,
    >,
    children: Query<'w, 's, &'static Children>,
    cameras: Query<'w, 's, (&'static Camera, &'static GlobalTransform), With<Camera3d>>,
}

fn draw_selected(
    mut gizmos: Gizmos<SelectionGizmos>,
    mut cache: Local<EdgeCache>,
    selected: Res<Selected>,
    scene: Scene,
) {
    scene.draw(selected.0, &mut cache, |[a, b]| gizmos.line(a, b, COLOR));
}

fn draw_hovered(
    mut gizmos: Gizmos<HoverGizmos>,
    mut cache: Local<EdgeCache>,
    (hovered, selected): (Res<Hovered>, Res<Selected>),
    scene: Scene,
) {
    let hovered = hovered.0.filter(|_| hovered.0 != selected.0);
    scene.draw(hovered, &mut cache, |[a, b]| gizmos.line(a, b, HOVER.0));
}

impl Scene<'_, '_> {
    /// Gives `line` the lines around `root` and what belongs to it, in the world.
    fn draw(&self, root: Option<Entity>, cache: &mut EdgeCache, mut line: impl FnMut([Vec3; 2])) {
        let Some(root) = root else {
            *cache = EdgeCache::default();
            return;
        };
        let active = self.cameras.iter().filter(|(camera, _)| camera.is_active);
        let Some((_, camera)) = active.min_by_key(|(camera, _)| camera.order) else { return };
        for entity in std::iter::once(root).chain(self.children.iter_descendants(root)) {
            let Ok((mesh, transform, is_cloth, topology)) = self.shown.get(entity) else { continue };
            // A curtain hangs below its rod in the hierarchy, but is another object.
            if is_cloth && entity != root {
                continue;
            }
            let Some(surface) = self.meshes.get(mesh).and_then(Surface::read) else { continue };
            let mut line = |ends: [Vec3; 2]| line(ends.map(|end| transform.transform_point(end)));
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
