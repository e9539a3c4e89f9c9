//! Writes the shape of each cloth into the mesh it draws, if it is another one than is drawn already.

use bevy::camera::primitives::Aabb;
use bevy::math::Affine3A;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use cloth_solver::{Fabric, Particles, Pose, Topology};

use super::ClothColoring;
use super::bound::BoundMeshes;
use super::color::{Told, ToldItem};
use super::look_material::LookMaterial;
use super::material::StressColors;
use super::subdivide::Subdivision;
use super::surface::{self, TangentFrame};
use super::wear::{self, Folds};
use crate::cloth::{ClothFrame, ClothTopology};
use crate::prepare::{self, ClothSkin, DrawnMesh, Placements, Skin};
use crate::settings::Shared;
use crate::shown::ShownShape;

/// What is drawn of one cloth, and the memory to work it out.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Drawing {
    normals: Vec<Vec3>,
    tangents: Vec<Vec3>,
    tangent_frame: TangentFrame,
    shares: Vec<f32>,
    /// What is drawn where that is finer than what is simulated.
    subdivision: Option<Box<Subdivision>>,
    /// With a subdivision, for each slot the unit normal of the solid it lies on, or zero. Empty where nothing touches.
    supports: Vec<Vec3>,
    folds: Folds,
    /// For each slot what fire and water did, see [`wear::burn_and_wet`].
    marks: Vec<[f32; 2]>,
    /// For each slot 0 at a torn edge, 1 away from all.
    fray: Vec<f32>,
    /// Metres of cloth along a unit of u and of v.
    metres: Vec2,
    /// From the cloth's frame to that of the entity as drawn, scale included.
    relation: Affine3A,
    coloring: Option<ClothColoring>,
    /// It was last drawn with a [`ClothLook`](super::ClothLook).
    has_look: bool,
    written: bool,
}

impl Drawing {
    /// Nothing drawn yet. `uvs` are those of the mesh; `metres` of cloth to a unit of them, if that is known already.
    pub fn new(
        topology: &Topology,
        skin: &Skin,
        uvs: &[Vec2],
        metres: Option<Vec2>,
        subdivision: Option<Box<Subdivision>>,
    ) -> Self {
        let (slots, vertices) = (topology.slots(), topology.vertex_particle.len());
        let mut fray = Vec::new();
        wear::fray(topology, &skin.hem, &mut fray);
        Self {
            normals: vec![Vec3::Z; slots],
            tangents: vec![Vec3::X; vertices],
            tangent_frame: TangentFrame::new(&topology.triangle_vertices, &topology.triangle_backs, uvs),
            shares: Vec::new(),
            subdivision,
            supports: Vec::new(),
            folds: Folds::default(),
            marks: Vec::new(),
            fray,
            metres: metres.unwrap_or_else(|| wear::metres_per_uv(topology, uvs)),
            relation: Affine3A::IDENTITY,
            coloring: None,
            has_look: false,
            written: false,
        }
    }

    /// Metres of cloth along a unit of u and of v.
    pub fn metres(&self) -> Vec2 {
        self.metres
    }

    /// What is drawn, if that is finer than what is simulated.
    pub fn subdivision(&self) -> Option<&Subdivision> {
        self.subdivision.as_deref()
    }

    /// Takes it out, to be used again.
    pub fn take_subdivision(&mut self) -> Option<Box<Subdivision>> {
        self.subdivision.take()
    }

    /// Into how many parts each edge is divided.
    pub fn parts(&self) -> u32 {
        self.subdivision().map_or(1, Subdivision::parts)
    }

    /// Has it written anew, even if nothing moves.
    pub fn write_again(&mut self) {
        self.written = false;
    }

    /// From the cloth's frame to that of the entity as drawn, scale included.
    pub fn relation(&self) -> &Affine3A {
        &self.relation
    }
}

/// Writes positions, normals, tangents and bounds of what moved.
pub(crate) fn write(
    mut cloths: Query<
        (
            Entity,
            (&ClothTopology, &ClothSkin, &ClothFrame, Ref<ShownShape>),
            Ref<Particles>,
            Option<&Fabric>,
            Option<&ClothColoring>,
            (&DrawnMesh, Told, Has<LookMaterial>),
            &mut Drawing,
            Option<&mut Aabb>,
        ),
        Without<BoundMeshes>,
    >,
    shared: Res<Shared<ClothColoring>>,
    placements: Placements,
    mut meshes: ResMut<Assets<Mesh>>,
    stress_colors: Local<StressColors>,
) {
    for (entity, state, particles, fabric, coloring, (mesh, told, has_look), mut drawing, aabb) in &mut cloths {
        let (topology, skin, frame, shape) = state;
        let drawing = &mut *drawing;
        let coloring = *coloring.unwrap_or(&shared);
        let relation = relation(&frame.pose, placements.affine(entity));
        let Some(relation) = relation.filter(|relation| relation.is_finite()) else { continue };
        let (moved, shown) = (shape.is_changed(), shape.positions());
        if shown.len() != topology.slots() {
            continue;
        }
        let recolored = drawing.coloring != Some(coloring)
            || (coloring != ClothColoring::Material && particles.is_changed())
            || drawing.has_look != has_look
            || told.is_burning();
        if drawing.written && !moved && !recolored && relation == drawing.relation {
            continue;
        }
        let Some(mut mesh) = meshes.get_mut(&mesh.drawn) else { continue };
        let fabric = fabric.copied().unwrap_or_default();
        if drawing.subdivision.is_some() && (particles.is_changed() || !drawing.written) {
            told.supports(topology, &particles, &mut drawing.supports);
        }
        drawing.relation = relation;
        drawing.written = true;
        let bounds = drawing.write_shape(&mut mesh, topology, shown, fabric.thickness / 2.0);
        if let Some(mut aabb) = aabb {
            *aabb = Aabb::from_min_max(bounds.0, bounds.1);
        }
        // Folds darken where they are.
        if recolored || (has_look && coloring == ClothColoring::Material) {
            (drawing.coloring, drawing.has_look) = (Some(coloring), has_look);
            drawing.write_colors(&mut mesh, topology, shown, &skin.0, &particles, &fabric, &told, &stress_colors);
        }
    }
}

/// From the frame of the simulation to that of the entity as it is drawn. They differ by the scale, and by what the
/// entity moved since the last tick. Differences first, so that far from the origin nothing is lost.
pub(super) fn relation(pose: &Pose, entity: Option<GlobalTransform>) -> Option<Affine3A> {
    let affine = entity?.affine();
    let to_entity = affine.matrix3.inverse();
    let rotation = bevy::math::Mat3A::from_quat(pose.rotation);
    let offset = to_entity * (bevy::math::Vec3A::from(pose.position) - affine.translation);
    Some(Affine3A { matrix3: to_entity * rotation, translation: offset })
}

impl Drawing {
    /// Writes positions, normals and tangents, and gives the bounds of the positions.
    fn write_shape(&mut self, mesh: &mut Mesh, topology: &Topology, shown: &[Vec3], half: f32) -> (Vec3, Vec3) {
        match &mut self.subdivision {
            None => surface::normals(&topology.triangles, shown, &mut self.normals),
            Some(fine) => fine.apply(topology, shown, &mut self.normals, &self.supports),
        }
        let particle = &topology.vertex_particle;
        let fine = self.subdivision.as_deref();
        let back = fine.map_or(particle.len(), Subdivision::vertices);
        // Position and normal of a vertex of the front.
        let surface = |vertex: usize| match fine {
            Some(fine) => (fine.positions()[vertex], fine.normals()[vertex]),
            None => (shown[particle[vertex] as usize], self.normals[particle[vertex] as usize]),
        };
        // A vertex that no triangle uses stays anywhere.
        let all_used = topology.mended.is_nothing();
        let is_used =
            |vertex: usize| all_used || particle.get(vertex % back).is_none_or(|slot| topology.is_particle(*slot));
        let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        if let Some(VertexAttributeValues::Float32x3(positions)) = values(mesh, Mesh::ATTRIBUTE_POSITION) {
            for vertex in 0..back {
                let (at, normal) = surface(vertex);
                let normal = normal * half;
                for (vertex, at) in [(vertex, at + normal), (vertex + back, at - normal)] {
                    let at = self.relation.transform_point3(at);
                    if is_used(vertex) {
                        bounds = (bounds.0.min(at), bounds.1.max(at));
                    }
                    positions[vertex] = at.to_array();
                }
            }
        }
        // Normals turn against what stretches: by the inverse transposed.
        let turn = self.relation.matrix3.inverse().transpose();
        if let Some(VertexAttributeValues::Float32x3(normals)) = values(mesh, Mesh::ATTRIBUTE_NORMAL) {
            for vertex in 0..back {
                let normal = (turn * surface(vertex).1).normalize_or(Vec3::Z);
                normals[vertex] = normal.to_array();
                normals[vertex + back] = (-normal).to_array();
            }
        }
        if let Some(VertexAttributeValues::Float32x4(tangents)) = values(mesh, Mesh::ATTRIBUTE_TANGENT) {
            self.tangent_frame.tangents(
                &topology.triangle_vertices,
                particle,
                shown,
                &self.normals,
                &mut self.tangents,
            );
            for (vertex, tangent) in self.tangents.iter().enumerate() {
                let tangent = self.relation.transform_vector3(*tangent).normalize_or(Vec3::X);
                let sign = self.tangent_frame.sign(vertex);
                tangents[vertex] = tangent.extend(sign).to_array();
                tangents[vertex + back] = tangent.extend(-sign).to_array();
            }
            if let Some(fine) = fine {
                fine.spread(&mut tangents[..back]);
                for vertex in particle.len()..back {
                    let tangent = Vec4::from_array(tangents[vertex]);
                    let normal = (turn * fine.normals()[vertex]).normalize_or(Vec3::Z);
                    let along = tangent.truncate().reject_from_normalized(normal);
                    let along = along.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
                    let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
                    tangents[vertex] = along.extend(sign).to_array();
                    tangents[vertex + back] = along.extend(-sign).to_array();
                }
            }
        }
        bounds
    }

    /// Writes vertex colours, and what fire and water did: into the colours, or beside them where a look knows how to show it.
    fn write_colors(
        &mut self,
        mesh: &mut Mesh,
        topology: &Topology,
        shown: &[Vec3],
        skin: &Skin,
        particles: &Particles,
        fabric: &Fabric,
        told: &ToldItem,
        stress_colors: &StressColors,
    ) {
        let fine = self.subdivision.as_deref();
        let back = fine.map_or(topology.vertex_particle.len(), Subdivision::vertices);
        let coloring = self.coloring.unwrap_or_default();
        let tells = coloring != ClothColoring::Material;
        let own = |vertex: usize| skin.colors.get(vertex).copied().unwrap_or([1.0; 4]);
        told.shares(coloring, topology, particles, fabric, &mut self.shares);
        if self.has_look && !tells {
            self.folds.update(topology, shown, &self.normals);
        }
        if let Some(VertexAttributeValues::Float32x4(colors)) = values(mesh, Mesh::ATTRIBUTE_COLOR) {
            for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
                let color = match tells {
                    true => stress_colors.at(self.shares[*slot as usize]),
                    false if self.has_look => own(vertex),
                    false => told.scorched(*slot, own(vertex)),
                };
                (colors[vertex], colors[vertex + back]) = (color, color);
                if self.has_look {
                    let light = if tells { [1.0; 2] } else { self.folds.light(*slot) };
                    for (vertex, light) in [vertex, vertex + back].into_iter().zip(light) {
                        let [red, green, blue, _] = color;
                        colors[vertex] = [red * light, green * light, blue * light, self.fray[*slot as usize]];
                    }
                }
            }
            if let Some(fine) = fine {
                let (front, back) = colors.split_at_mut(back);
                fine.spread(front);
                fine.spread(back);
            }
        }
        let own = skin.attributes.get(Mesh::ATTRIBUTE_UV_1).filter(|_| !self.has_look);
        if let (Some(own), Ok(_)) = (own, mesh.try_attribute(Mesh::ATTRIBUTE_UV_1)) {
            // As it was before a look was taken off.
            mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, prepare::two_sided(own, fine));
        }
        if let Some(VertexAttributeValues::Float32x2(marks)) = values(mesh, Mesh::ATTRIBUTE_UV_1)
            && self.has_look
        {
            wear::marks(topology, told.fire(), &mut self.marks);
            for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
                let mark = self.marks[*slot as usize];
                (marks[vertex], marks[vertex + back]) = (mark, mark);
            }
            if let Some(fine) = fine {
                let (front, back) = marks.split_at_mut(back);
                fine.spread(front);
                back.copy_from_slice(front);
            }
        }
    }
}

pub(super) fn values(
    mesh: &mut Mesh,
    attribute: bevy::mesh::MeshVertexAttribute,
) -> Option<&mut VertexAttributeValues> {
    mesh.try_attribute_mut_option(attribute).ok().flatten()
}
