//! Fine meshes on coarse cloth: what is drawn follows what is simulated.

mod binding;

use std::sync::Arc;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::NoAutoAabb;
use bevy::math::Affine3A;
use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use cloth_solver::{ClothError, Topology};

use self::binding::{Binding, Vertex};
use super::write::{relation, values};
use crate::cloth::{ClothFrame, ClothTopology};
use crate::events::BoundRejected;
use crate::prepare::{Placements, positions_and_indices};
use crate::report::report;
use crate::shown::ShownShape;

/// Draws the entity's own [`Mesh3d`] on a cloth instead of the cloth itself: a fine mesh that follows a coarse cloth. What is
/// simulated costs as much as the coarse one, what is drawn shows every button of the fine one.
///
/// The mesh is bound when both are there, as they are authored: each vertex to the triangle of the cloth's rest shape that is nearest,
/// each as its entity's [`Transform`] places it. It keeps its place on that triangle (barycentric) and its distance from it, along the
/// smooth normal of the cloth. It may lie beyond the border, have a thickness, and have pieces that the cloth has not. Where the cloth
/// tears, the mesh parts along its own triangles; where the cloth is burnt away, it is gone, too; [`ResetCloth`](crate::ResetCloth)
/// gives all back.
///
/// A cloth that meshes are bound to draws no mesh of its own, but is picked as before. The mesh is not changed: a copy is drawn, in
/// which position, normal and tangent follow, and every other attribute stays. Normals turn with the cloth, they are not made anew.
/// When the component is removed, or the cloth despawned, the entity has its own mesh again. The mesh must be a list of triangles, or
/// a strip, kept in the main world; if it is not, [`BoundRejected`] tells. It is bound anew when it, or the rest shape of the cloth,
/// changes.
///
/// [`ClothLook`](crate::ClothLook), [`ClothColoring`](crate::ClothColoring) and [`ClothSubdivision`](crate::ClothSubdivision) are of
/// no effect on it: it has the material that it has.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_cloth::{BoundTo, Cloth, Pins};
/// fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
///     let cloth = commands.spawn((Cloth::rectangle(1.0, 1.0).with_cells(16, 16), Pins::top())).id();
///     // Ten times as fine. A plane of Bevy's lies in xz, a rectangle of cloth stands in xy.
///     let fine = Plane3d::new(Vec3::Z, Vec2::splat(0.5)).mesh().subdivisions(160);
///     commands.spawn((BoundTo(cloth), Mesh3d(meshes.add(fine))));
/// }
/// # bevy::ecs::system::assert_is_system(spawn);
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[require(Transform)]
#[relationship(relationship_target = BoundMeshes)]
pub struct BoundTo(
    /// The cloth.
    #[entities]
    pub Entity,
);

/// The entities whose meshes are bound to this cloth by [`BoundTo`]. Read-only.
#[derive(Component, Reflect, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, PartialEq)]
#[relationship_target(relationship = BoundTo)]
pub struct BoundMeshes(Vec<Entity>);

/// What is drawn of a mesh that is bound.
#[derive(Component, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Bound {
    source: Handle<Mesh>,
    drawn: Handle<Mesh>,
    /// `None` if it was refused.
    binding: Option<Binding>,
    cloth: Entity,
    topology: Arc<Topology>,
    relation: Option<Affine3A>,
}

impl Bound {
    /// Binds the mesh `source`, which its entity's transform takes `to_cloth`, the cloth's frame.
    fn binding(mesh: &Mesh, to_cloth: Affine3A, topology: &Topology) -> Result<Binding, ClothError> {
        let (positions, indices) = positions_and_indices(mesh, Vec3::ONE)?;
        let vertices = positions.len();
        let triangles: Vec<[u32; 3]> = indices.as_chunks().0.to_vec();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(index) = corners.iter().copied().find(|index| *index as usize >= vertices) {
                return Err(ClothError::IndexOutOfRange { triangle, index, vertices });
            }
        }
        if triangles.is_empty() {
            return Err(ClothError::NoTriangles { field: "BoundTo" });
        }
        if let Some(vertex) = positions.iter().position(|position| !position.is_finite()) {
            return Err(ClothError::VertexNotFinite { vertex, position: positions[vertex] });
        }
        let normals = match mesh.try_attribute_option(Mesh::ATTRIBUTE_NORMAL) {
            Ok(Some(VertexAttributeValues::Float32x3(normals))) => Some(normals),
            _ => None,
        };
        let tangents = match mesh.try_attribute_option(Mesh::ATTRIBUTE_TANGENT) {
            Ok(Some(VertexAttributeValues::Float32x4(tangents))) => Some(tangents),
            _ => None,
        };
        let turn = to_cloth.matrix3.inverse().transpose();
        let vertex = |(index, position): (usize, &Vec3)| Vertex {
            position: to_cloth.transform_point3(*position),
            normal: normals.map_or(Vec3::Z, |all| (turn * Vec3::from_array(all[index])).normalize_or(Vec3::Z)),
            tangent: tangents.map_or(Vec3::X, |all| {
                to_cloth.transform_vector3(Vec4::from_array(all[index]).truncate()).normalize_or(Vec3::X)
            }),
        };
        Ok(Binding::new(positions.iter().enumerate().map(vertex).collect(), triangles, topology))
    }
}

/// Binds what is new or another one, and lets what is bound follow what was taken apart.
pub(crate) fn bind(
    mut bound: Query<(Entity, &BoundTo, &Mesh3d, Option<&mut Bound>)>,
    cloths: Query<&ClothTopology>,
    placements: Placements,
    mut meshes: ResMut<Assets<Mesh>>,
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut modified: Local<HashSet<AssetId<Mesh>>>,
    mut commands: Commands,
) {
    modified.clear();
    modified.extend(events.read().filter_map(|event| match event {
        AssetEvent::Modified { id } => Some(*id),
        _ => None,
    }));
    for (entity, BoundTo(cloth), mesh, state) in &mut bound {
        let Ok(topology) = cloths.get(*cloth) else { continue };
        let is_drawn = state.as_ref().is_some_and(|state| state.drawn == mesh.0);
        let source = state.as_ref().filter(|_| is_drawn).map_or(&mesh.0, |state| &state.source).clone();
        if let Some(mut state) = state {
            let is_same = is_drawn && state.cloth == *cloth && !modified.contains(&source.id());
            if is_same && Arc::ptr_eq(&state.topology, &topology.0) {
                continue;
            }
            let state = &mut *state;
            if let Some(binding) = state.binding.as_mut().filter(|binding| is_same && binding.knows(&topology.0)) {
                binding.follow(&topology.0);
                state.topology = topology.0.clone();
                state.relation = None;
                if let Some(drawn) = meshes.get(&source).and_then(|mesh| drawn_of(mesh, binding))
                    && let Err(error) = meshes.insert(state.drawn.id(), drawn)
                {
                    error!("the mesh bound to cloth {cloth} could not be replaced: {error}");
                }
                continue;
            }
        }
        let Some(loaded) = meshes.get(&source) else { continue };
        let Some(to_cloth) = to_cloth(&placements, entity, *cloth) else { continue };
        let binding = Bound::binding(loaded, to_cloth, &topology.0);
        let copy = binding.as_ref().ok().and_then(|binding| drawn_of(loaded, binding));
        let drawn = copy.map_or(source.clone(), |copy| meshes.add(copy));
        let (topology, mut to) = (topology.0.clone(), commands.entity(entity));
        to.try_insert(Mesh3d(drawn.clone()));
        match &binding {
            Ok(_) => to.try_insert((Aabb::default(), NoAutoAabb)),
            Err(_) => to.try_remove::<(Aabb, NoAutoAabb)>(),
        };
        if let Err(error) = &binding {
            report(&mut commands, BoundRejected { entity, error: error.clone() });
        }
        let state = Bound { source, drawn, binding: binding.ok(), cloth: *cloth, topology, relation: None };
        commands.entity(entity).try_insert(state);
    }
}

/// From the frame of a mesh's entity to that of the cloth at rest.
fn to_cloth(placements: &Placements, entity: Entity, cloth: Entity) -> Option<Affine3A> {
    let pose = placements.get(cloth)?.pose;
    let relation = relation(&pose, placements.affine(entity))?.inverse();
    relation.is_finite().then_some(relation)
}

/// The mesh to draw: of `mesh` what is not burnt, with a copy of each vertex at which it came apart.
fn drawn_of(mesh: &Mesh, binding: &Binding) -> Option<Mesh> {
    let mut drawn = mesh.clone();
    if !binding.copies.is_empty() {
        let all = 0..mesh.count_vertices() as u32;
        drawn.insert_indices(Indices::U32(all.chain(binding.copies.iter().copied()).collect()));
        drawn.try_duplicate_vertices().ok()?;
    }
    let mut list = Mesh::new(bevy::mesh::PrimitiveTopology::TriangleList, drawn.asset_usage);
    for (attribute, values) in drawn.try_attributes().ok()? {
        list.insert_attribute(*attribute, values.clone());
    }
    list.insert_indices(Indices::U32(binding.drawn.as_flattened().to_vec()));
    Some(list)
}

/// Writes positions, normals, tangents and bounds of what moved.
pub(crate) fn write(
    mut bound: Query<(Entity, &BoundTo, &mut Bound, Option<&mut Aabb>)>,
    cloths: Query<(&ClothTopology, &ClothFrame, Ref<ShownShape>)>,
    placements: Placements,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (entity, BoundTo(cloth), mut bound, aabb) in &mut bound {
        let Ok((topology, frame, shape)) = cloths.get(*cloth) else { continue };
        let shown = shape.positions();
        let relation = relation(&frame.pose, placements.affine(entity)).filter(Affine3A::is_finite);
        let bound = &mut *bound;
        let is_current = bound.relation == relation && !shape.is_changed();
        let Some((binding, relation)) = bound.binding.as_mut().zip(relation) else { continue };
        if is_current || shown.len() != topology.slots() || !Arc::ptr_eq(&bound.topology, &topology.0) {
            continue;
        }
        let Some(mut mesh) = meshes.get_mut(&bound.drawn) else { continue };
        bound.relation = Some(relation);
        let bounds = write_shape(&mut mesh, binding, &topology.0, shown, &relation);
        if let Some(mut aabb) = aabb {
            *aabb = Aabb::from_min_max(bounds.0, bounds.1);
        }
    }
}

fn write_shape(
    mesh: &mut Mesh,
    binding: &mut Binding,
    topology: &Topology,
    shown: &[Vec3],
    relation: &Affine3A,
) -> (Vec3, Vec3) {
    // Taken out, since a mesh lends one attribute at a time.
    let [mut positions, mut normals] =
        [Mesh::ATTRIBUTE_POSITION, Mesh::ATTRIBUTE_NORMAL].map(|attribute| match values(mesh, attribute) {
            Some(VertexAttributeValues::Float32x3(values)) => std::mem::take(values),
            _ => Vec::new(),
        });
    let mut tangents = match values(mesh, Mesh::ATTRIBUTE_TANGENT) {
        Some(VertexAttributeValues::Float32x4(values)) => std::mem::take(values),
        _ => Vec::new(),
    };
    // Normals turn against what stretches: by the inverse transposed.
    let turn = relation.matrix3.inverse().transpose();
    let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    binding.place(topology, shown, |vertex, at, normal, tangent| {
        let at = relation.transform_point3(at);
        bounds = (bounds.0.min(at), bounds.1.max(at));
        positions[vertex] = at.to_array();
        if let Some(out) = normals.get_mut(vertex) {
            *out = (turn * normal).normalize_or(Vec3::Z).to_array();
        }
        if let Some([x, y, z, _]) = tangents.get_mut(vertex) {
            [*x, *y, *z] = relation.transform_vector3(tangent).normalize_or(Vec3::X).to_array();
        }
    });
    for (attribute, written) in [(Mesh::ATTRIBUTE_POSITION, positions), (Mesh::ATTRIBUTE_NORMAL, normals)] {
        if let Some(VertexAttributeValues::Float32x3(values)) = values(mesh, attribute) {
            *values = written;
        }
    }
    if let Some(VertexAttributeValues::Float32x4(values)) = values(mesh, Mesh::ATTRIBUTE_TANGENT) {
        *values = tangents;
    }
    bounds
}

/// Gives an entity its own mesh back when it is bound no more.
pub(crate) fn on_unbound(removed: On<Remove, BoundTo>, bound: Query<(&Bound, &Mesh3d)>, mut commands: Commands) {
    let Ok((bound, shown)) = bound.get(removed.entity) else { return };
    let mut entity = commands.entity(removed.entity);
    entity.try_remove::<(Bound, NoAutoAabb, Aabb)>();
    if shown.0 == bound.drawn {
        entity.try_insert(Mesh3d(bound.source.clone()));
    }
}
