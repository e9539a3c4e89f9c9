//! Gives a cloth a mesh of its own to draw, and takes it away again.

use bevy::asset::RenderAssetUsages;
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoAutoAabb;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use cloth_solver::Topology;

use super::bound::BoundMeshes;
use super::subdivide::{ClothSubdivision, Subdivision};
use super::write::Drawing;
use super::{flames, look_material, material, wear};
use crate::cloth::ClothTopology;
use crate::damage::ClothPieces;
use crate::prepare::{self, ClothSkin, DrawnMesh, Skin};
use crate::settings::Shared;

/// Makes the mesh of every cloth that has none or was built anew, and puts it on the entity.
pub(crate) fn attach(
    cloths: Query<(
        Entity,
        Ref<ClothTopology>,
        &ClothSkin,
        (Has<ClothPieces>, Has<BoundMeshes>),
        Option<&ClothSubdivision>,
    )>,
    shared: Res<Shared<ClothSubdivision>>,
    mut drawn: Query<(&mut DrawnMesh, &mut Drawing)>,
    on_entity: Query<&Mesh3d>,
    cloned: Query<&DrawnMesh, Without<Drawing>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut commands: Commands,
) {
    for (entity, topology, skin, (in_pieces, is_hidden), subdivision) in &cloths {
        let shown = on_entity.get(entity).ok();
        let parts = subdivision.unwrap_or(&shared).parts();
        let Ok((mut mesh, mut drawing)) = drawn.get_mut(entity) else {
            let uvs = wear::uvs(&topology, &skin.0);
            let drawing = Drawing::new(&topology, &skin.0, &uvs, None, subdivided(&topology, parts, None));
            let handle = meshes.add(two_sided(&topology, &skin.0, &uvs, drawing.subdivision()));
            // A clone still shows the mesh of the cloth it was cloned from.
            let original = cloned.get(entity).ok().filter(|of| shown.is_some_and(|shown| shown.0 == of.drawn));
            let source = original.map_or_else(|| shown.map(|mesh| mesh.0.clone()), |original| original.source.clone());
            let mesh = DrawnMesh { source, drawn: handle.clone() };
            commands.entity(entity).try_insert((Mesh3d(handle), mesh, drawing, Aabb::default(), NoAutoAabb));
            #[cfg(feature = "picking")]
            commands.entity(entity).try_insert(crate::picking::hidden_from_mesh_picking());
            commands.queue(move |world: &mut World| material::give_default(world, entity));
            continue;
        };
        if topology.is_changed() || drawing.parts() != parts {
            let uvs = wear::uvs(&topology, &skin.0);
            // What is burnt or torn away does not change the scale of what is left.
            let metres = in_pieces.then_some(drawing.metres());
            let subdivision = subdivided(&topology, parts, drawing.take_subdivision());
            *drawing = Drawing::new(&topology, &skin.0, &uvs, metres, subdivision);
            if let Err(error) =
                meshes.insert(mesh.drawn.id(), two_sided(&topology, &skin.0, &uvs, drawing.subdivision()))
            {
                error!("the mesh of cloth {entity} could not be replaced: {error}");
            }
        }
        if shown.is_none_or(|shown| shown.0 != mesh.drawn) {
            // The user gave the entity another mesh: remember it, and go on drawing the cloth.
            if let Some(shown) = shown {
                mesh.source = Some(shown.0.clone());
            }
            if !is_hidden {
                drawing.write_again();
                commands.entity(entity).try_insert(Mesh3d(mesh.drawn.clone()));
            }
        } else if is_hidden {
            commands.entity(entity).try_remove::<Mesh3d>();
        }
    }
}

/// The subdivision of `topology` in so many `parts`, in the memory of `old` if that has as many.
fn subdivided(topology: &Topology, parts: u32, old: Option<Box<Subdivision>>) -> Option<Box<Subdivision>> {
    if parts == 1 {
        return None;
    }
    let Some(mut same) = old.filter(|old| old.parts() == parts) else {
        return Some(Box::new(Subdivision::new(topology, parts)));
    };
    same.rebuild(topology);
    Some(same)
}

/// A mesh with front and back of `topology` as separate vertices: first all of the front, then all of the back. Positions,
/// normals and tangents are still to be written. Colours and the second texture coordinates (what fire and water did) are
/// there from the beginning: a mesh of another layout would need another pipeline, and vanish until that is compiled.
///
/// The attributes of the mesh that the cloth does not write are there, too.
fn two_sided(topology: &Topology, skin: &Skin, uvs: &[Vec2], subdivision: Option<&Subdivision>) -> Mesh {
    let vertices = subdivision.map_or(topology.vertex_particle.len(), Subdivision::vertices);
    let back = |vertex: u32| vertex + vertices as u32;
    let triangles = subdivision.map_or(&topology.triangle_vertices[..], Subdivision::triangles);
    let backs = match subdivision {
        Some(fine) => fine.backs(),
        None if topology.triangle_backs.is_empty() => triangles,
        None => &topology.triangle_backs,
    };
    let front_and_back = triangles.iter().copied();
    let front_and_back = front_and_back.chain(backs.iter().map(|[a, b, c]| [back(*a), back(*c), back(*b)]));
    let mut uvs: Vec<[f32; 2]> = uvs.iter().map(Vec2::to_array).collect();
    if let Some(subdivision) = subdivision {
        uvs.resize(vertices, [0.0; 2]);
        subdivision.spread(&mut uvs);
    }
    uvs.extend_from_within(..);
    let second_uvs = match skin.attributes.get(Mesh::ATTRIBUTE_UV_1) {
        Some(uvs) => prepare::two_sided(uvs, subdivision),
        None => vec![[0.0_f32; 2]; 2 * vertices].into(),
    };
    let mut mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 2 * vertices])
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 2 * vertices])
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, second_uvs)
        .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[1.0, 0.0, 0.0, 1.0]; 2 * vertices])
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, vec![[1.0; 4]; 2 * vertices])
        .with_inserted_indices(Indices::U32(front_and_back.flatten().collect()));
    for (attribute, values) in skin.attributes.drawn() {
        mesh.insert_attribute(*attribute, prepare::two_sided(values, subdivision));
    }
    mesh
}

/// Takes off the entity what was put on to draw the cloth, and gives it back its own mesh.
pub(crate) fn undraw(entity: &mut EntityWorldMut) {
    flames::undraw(entity);
    let Some(mesh) = entity.take::<DrawnMesh>() else { return };
    entity.remove::<(Drawing, NoAutoAabb, Aabb)>();
    if entity.get::<Mesh3d>().is_some_and(|shown| shown.0 == mesh.drawn) {
        match mesh.source {
            Some(source) => entity.insert(Mesh3d(source)),
            None => entity.remove::<Mesh3d>(),
        };
    }
    look_material::take_back(entity);
    material::take_back(entity);
}
