//! Cloth on a skinned mesh: which joints take which particle along.

use bevy::ecs::system::SystemParam;
use bevy::math::{Affine3A, Mat3A};
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use cloth_solver::constraint::SkinPoint;
use cloth_solver::topology::Change;
use cloth_solver::{ClothError, Motion, Pose, Topology};

use super::placement::{Placement, Placements};
use super::relative;
use crate::cloth::ClothFrame;

/// Joints and weights of one vertex.
type Influence = ([u16; 4], [f32; 4]);

/// The joints that take a cloth along.
#[derive(Component, Clone, Debug)]
#[component(clone_behavior = Ignore)]
pub(crate) struct Armature {
    /// The joints, in the order of the first frames of the cloth's pins.
    pub joints: Vec<Entity>,
    /// For each slot its place.
    pub points: Vec<SkinPoint>,
}

/// The skin that was taken off an entity, so that the renderer does not apply it once more. Given back with the mesh.
#[derive(Component, Clone, Debug)]
pub(crate) struct TakenSkin {
    inverse_bindposes: Handle<SkinnedMeshInverseBindposes>,
    #[entities]
    joints: Vec<Entity>,
}

impl TakenSkin {
    pub fn new(skin: &SkinnedMesh) -> Self {
        Self { inverse_bindposes: skin.inverse_bindposes.clone(), joints: skin.joints.clone() }
    }

    /// Its joints.
    pub fn joints(&self) -> &[Entity] {
        &self.joints
    }

    /// Gives it back, unless the entity has another one by now.
    pub fn give_back(entity: &mut EntityWorldMut) {
        let Some(Self { inverse_bindposes, joints }) = entity.take::<Self>() else { return };
        if !entity.contains::<SkinnedMesh>() {
            entity.insert(SkinnedMesh { inverse_bindposes, joints });
        }
    }
}

/// How a mesh hangs on joints as they stand now.
pub(crate) struct Binding {
    joints: Vec<(Entity, Placement, Affine3A)>,
    influences: Vec<Influence>,
    /// From the mesh's own numbers to metres in the world.
    pub scale: Vec3,
}

/// What is needed to read a skin.
#[derive(SystemParam)]
pub(crate) struct Skins<'w> {
    inverse_bindposes: Option<Res<'w, Assets<SkinnedMeshInverseBindposes>>>,
}

impl Skins<'_> {
    /// How `mesh` hangs on `skin`. `Ok(None)` while a joint or the bind poses are not there yet.
    pub fn bind(
        &self,
        influences: Vec<Influence>,
        skin: &TakenSkin,
        placements: &Placements,
    ) -> Result<Option<Binding>, ClothError> {
        let bindposes = self.inverse_bindposes.as_ref().and_then(|all| all.get(&skin.inverse_bindposes));
        let Some(bindposes) = bindposes else { return Ok(None) };
        let count = skin.joints.len().min(bindposes.len());
        let mut known = vec![None; count];
        let mut joints = Vec::new();
        let mut scales = (0.0, 0.0);
        let mut used = influences;
        for (indices, weights) in &mut used {
            let total: f32 = weights.iter().sum();
            *weights = if total > 0.0 { weights.map(|weight| weight / total) } else { [1.0, 0.0, 0.0, 0.0] };
            for k in 0..4 {
                if weights[k] <= 0.0 {
                    indices[k] = indices[0];
                    continue;
                }
                let index = usize::from(indices[k]);
                let Some(slot) = known.get_mut(index) else {
                    let allowed = "an index of `SkinnedMesh::joints` that has an inverse bind pose";
                    return Err(ClothError::OutOfRange {
                        field: "ATTRIBUTE_JOINT_INDEX",
                        value: index as f32,
                        allowed,
                    });
                };
                if slot.is_none() {
                    let entity = skin.joints[index];
                    let Some(placement) = placements.get(entity).filter(Placement::is_finite) else { return Ok(None) };
                    let inverse = Affine3A::from_mat4(bindposes[index]);
                    *slot = Some(joints.len() as u16);
                    joints.push((entity, placement, inverse));
                }
                let joint = slot.unwrap_or_default();
                let (_, placement, inverse) = &joints[usize::from(joint)];
                let volume = placement.scale.element_product() * inverse.matrix3.determinant();
                scales = (scales.0 + weights[k] * volume.cbrt(), scales.1 + weights[k]);
                indices[k] = joint;
            }
            // A joint without weight is any that is known.
            let first = (0..4).find(|k| weights[*k] > 0.0).map_or(0, |k| indices[k]);
            for k in 0..4 {
                if weights[k] <= 0.0 {
                    indices[k] = first;
                }
            }
        }
        let scale: f32 = scales.0 / f32::max(scales.1, f32::MIN_POSITIVE);
        if !(scale.is_finite() && scale != 0.0) {
            let allowed = "joints and bind poses with a volume";
            return Err(ClothError::OutOfRange { field: "SkinnedMeshInverseBindposes", value: scale, allowed });
        }
        Ok(Some(Binding { joints, influences: used, scale: Vec3::new(scale, scale.abs(), scale.abs()) }))
    }
}

/// Joints and weights of every vertex of a mesh, if it has them.
pub(crate) fn influences(mesh: &Mesh) -> Option<Vec<Influence>> {
    let (indices, weights) = (
        mesh.try_attribute_option(Mesh::ATTRIBUTE_JOINT_INDEX),
        mesh.try_attribute_option(Mesh::ATTRIBUTE_JOINT_WEIGHT),
    );
    match (indices, weights) {
        (Ok(Some(VertexAttributeValues::Uint16x4(indices))), Ok(Some(VertexAttributeValues::Float32x4(weights)))) => {
            Some(indices.iter().copied().zip(weights.iter().copied()).collect())
        }
        _ => None,
    }
}

impl Binding {
    /// The armature of a cloth of this mesh, whose rest shape is the mesh times `scale`.
    pub fn armature(&self, topology: &Topology) -> Armature {
        let normals = normals(topology);
        let mut points = vec![None; topology.slots()];
        for (slot, influence) in topology.vertex_particle.iter().zip(&self.influences) {
            let slot = *slot as usize;
            if points[slot].is_none() {
                points[slot] = Some(self.point(topology.rest[slot], normals[slot], influence));
            }
        }
        // Padding repeats a neighbour.
        let mut last = points.iter().flatten().next().copied().unwrap_or_default();
        let points = points.into_iter().map(|point| {
            last = point.unwrap_or(last);
            last
        });
        Armature { joints: self.joints.iter().map(|(entity, ..)| *entity).collect(), points: points.collect() }
    }

    fn point(&self, rest: Vec3, normal: Vec3, (joints, weights): &Influence) -> SkinPoint {
        // In the mesh's own numbers; a mirrored one faces the other way.
        let (at, normal) = (rest / self.scale, normal * self.scale.signum());
        let mut point = SkinPoint { frames: joints.map(u32::from), weights: *weights, ..SkinPoint::default() };
        for k in 0..4 {
            let (_, placement, inverse) = &self.joints[usize::from(joints[k])];
            let to_joint = Mat3A::from_diagonal(placement.scale) * inverse.matrix3;
            point.locals[k] = placement.scale * inverse.transform_point3(at);
            point.normals[k] = (to_joint.inverse().transpose() * normal).normalize_or_zero();
        }
        point
    }
}

/// Normal of the rest shape at each slot.
pub(crate) fn normals(topology: &Topology) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; topology.slots()];
    for triangle in &topology.triangles {
        let [a, b, c] = triangle.map(|slot| topology.rest[slot as usize]);
        for slot in triangle {
            normals[*slot as usize] += (b - a).cross(c - a);
        }
    }
    normals.into_iter().map(|normal| normal.normalize_or(Vec3::Z)).collect()
}

impl Armature {
    /// Where each slot is with the joints where they stand now, seen from `frame`.
    pub fn now(&self, frame: &ClothFrame, placements: &Placements) -> Vec<Vec3> {
        let pose = |joint: &Entity| {
            placements.get(*joint).map_or(Pose::IDENTITY, |placement| relative(&frame.pose, &placement.pose))
        };
        let poses: Vec<Pose> = self.joints.iter().map(pose).collect();
        self.points.iter().map(|point| point.point(|joint| poses[joint as usize])).collect()
    }

    /// Where each slot is at the end of the tick, with the frames of the cloth's pins. `None` if those are not of its joints.
    pub fn place(&self, frames: &[Motion]) -> Option<Vec<Vec3>> {
        (frames.len() >= self.joints.len())
            .then(|| self.points.iter().map(|point| point.point(|joint| frames[joint as usize].to)).collect())
    }

    /// Takes over what was torn, cut or burnt.
    pub fn follow(&mut self, change: &Change) {
        let last = self.points.last().copied().unwrap_or_default();
        self.points.resize(change.slots, last);
        for born in &change.born {
            let parent = born.parents[usize::from(born.t > 0.5)];
            self.points[born.slot as usize] = self.points[parent as usize];
        }
    }
}
