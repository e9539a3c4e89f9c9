//! Vertex attributes of a mesh that its cloth does not write itself: they stay with their vertices, through tears and cuts.

use bevy::mesh::VertexAttributeValues::*;
use bevy::mesh::{Mesh, MeshVertexAttribute, VertexAttributeValues};
use cloth_solver::topology::{BornVertex, Change};

use crate::damage::ATTRIBUTE_STRENGTH;

/// What a cloth writes or keeps elsewhere.
const KEPT_ELSEWHERE: [MeshVertexAttribute; 6] = [
    Mesh::ATTRIBUTE_POSITION,
    Mesh::ATTRIBUTE_NORMAL,
    Mesh::ATTRIBUTE_TANGENT,
    Mesh::ATTRIBUTE_UV_0,
    Mesh::ATTRIBUTE_COLOR,
    ATTRIBUTE_STRENGTH,
];

/// A number, or several, of which there can be something between two.
trait Mix: Copy {
    fn mix(parts: &[(Self, f32)]) -> Self;
}

impl Mix for f32 {
    fn mix(parts: &[(Self, f32)]) -> Self {
        parts.iter().map(|(value, weight)| value * weight).sum()
    }
}

impl<const N: usize> Mix for [f32; N] {
    fn mix(parts: &[(Self, f32)]) -> Self {
        std::array::from_fn(|i| parts.iter().map(|(value, weight)| value[i] * weight).sum())
    }
}

/// That of the largest weight.
fn nearest<T: Copy>(parts: &[(T, f32)]) -> T {
    let better = |best: (T, f32), part: &(T, f32)| if part.1 > best.1 { *part } else { best };
    parts.iter().fold(parts[0], better).0
}

/// Does `$mixed` with the vector of those formats between whose values there is something, `$nearest` with that of all others.
macro_rules! with_values {
    ($values:expr, $v:ident, $mixed:expr, $nearest:expr) => {
        with_values!(@ $values, $v, $mixed, $nearest,
            Float32, Float32x2, Float32x3, Float32x4;
            Uint8, Uint8x2, Uint8x4, Sint8, Sint8x2, Sint8x4, Unorm8, Unorm8x2, Unorm8x4, Snorm8, Snorm8x2, Snorm8x4,
            Uint16, Uint16x2, Uint16x4, Sint16, Sint16x2, Sint16x4, Unorm16, Unorm16x2, Unorm16x4,
            Snorm16, Snorm16x2, Snorm16x4, Float16, Float16x2, Float16x4,
            Uint32, Uint32x2, Uint32x3, Uint32x4, Sint32, Sint32x2, Sint32x3, Sint32x4,
            Float64, Float64x2, Float64x3, Float64x4, Unorm10_10_10_2, Unorm8x4Bgra)
    };
    (@ $values:expr, $v:ident, $mixed:expr, $nearest:expr, $($smooth:ident),*; $($rough:ident),*) => {
        match $values {
            $($smooth($v) => $mixed,)*
            $($rough($v) => $nearest,)*
        }
    };
}

/// The attributes of a mesh that its cloth does not write itself, one entry for each render vertex: further texture
/// coordinates, joints and their weights, and those of the user.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Attributes {
    /// Not saved: those of the vertices that the mesh has are there wherever the mesh is.
    #[cfg_attr(feature = "serialize", serde(skip))]
    all: Vec<(MeshVertexAttribute, VertexAttributeValues)>,
    /// The vertices that came to be since.
    born: Vec<BornVertex>,
}

impl Attributes {
    /// Those of `mesh`, which has so many `vertices`.
    pub fn of(mesh: &Mesh, vertices: usize) -> Self {
        let Ok(all) = mesh.try_attributes() else { return Self::default() };
        let is_carried = |attribute: &MeshVertexAttribute| KEPT_ELSEWHERE.iter().all(|other| other.id != attribute.id);
        let carried = all.filter(|(attribute, values)| is_carried(attribute) && values.len() == vertices);
        let all = carried.map(|(attribute, values)| (*attribute, values.clone())).collect();
        Self { all, born: Vec::new() }
    }

    /// The values of an attribute.
    #[cfg_attr(not(feature = "render"), allow(dead_code, reason = "only drawing asks"))]
    pub fn get(&self, attribute: MeshVertexAttribute) -> Option<&VertexAttributeValues> {
        self.all.iter().find(|(known, _)| known.id == attribute.id).map(|(_, values)| values)
    }

    /// Those that are drawn as they are. Joints are not: the renderer would move what the simulation has moved already.
    #[cfg(feature = "render")]
    pub fn drawn(&self) -> impl Iterator<Item = &(MeshVertexAttribute, VertexAttributeValues)> {
        let [joint, weight, uv] = [Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT, Mesh::ATTRIBUTE_UV_1];
        self.all.iter().filter(move |(attribute, _)| ![joint.id, weight.id, uv.id].contains(&attribute.id))
    }

    /// Adds the vertices that are new after a topology change. What has no values between two is that of the nearer one, and so
    /// are weights, which belong to the joints of one vertex.
    pub fn follow(&mut self, change: &Change) {
        self.bear(&change.vertices);
        self.born.extend(&change.vertices);
    }

    /// Whether the values are not there that `now` has.
    pub fn miss(&self, now: &Self) -> bool {
        self.all.is_empty() && !now.all.is_empty()
    }

    /// Takes the values of the vertices that the mesh has from `now`, and makes those of the vertices that came to be since.
    pub fn take(&mut self, now: &Self) {
        self.all.clone_from(&now.all);
        for (_, values) in &mut self.all {
            let own = values.len() - now.born.len();
            with_values!(values, all, all.truncate(own), all.truncate(own));
        }
        let born = std::mem::take(&mut self.born);
        self.bear(&born);
        self.born = born;
    }

    fn bear(&mut self, vertices: &[BornVertex]) {
        for (attribute, values) in &mut self.all {
            let is_weight = attribute.id == Mesh::ATTRIBUTE_JOINT_WEIGHT.id;
            for born in vertices {
                let [a, b] = born.parents.map(|vertex| vertex as usize);
                let copied = is_weight || a == b;
                with_values!(
                    values,
                    all,
                    {
                        let parts = [(all[a], 1.0 - born.t), (all[b], born.t)];
                        all.push(if copied { nearest(&parts) } else { Mix::mix(&parts) });
                    },
                    all.push(nearest(&[(all[a], 1.0 - born.t), (all[b], born.t)]))
                );
            }
        }
    }
}

/// The values of the front and then of the back of a mesh whose vertices have `values`, finer by `subdivision`.
#[cfg(feature = "render")]
pub(crate) fn two_sided(
    values: &VertexAttributeValues,
    subdivision: Option<&crate::render::Subdivision>,
) -> VertexAttributeValues {
    let mut values = values.clone();
    with_values!(
        &mut values,
        all,
        {
            subdivision.into_iter().for_each(|fine| fine.fill(all, Mix::mix));
            all.extend_from_within(..);
        },
        {
            subdivision.into_iter().for_each(|fine| fine.fill(all, nearest));
            all.extend_from_within(..);
        }
    );
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::asset::RenderAssetUsages;
    use bevy::mesh::PrimitiveTopology;

    #[test]
    fn what_is_born_between_two_vertices_is_between_them_and_joints_are_those_of_the_nearer() {
        let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![[0.0; 3]; 2])
            .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, vec![[0.0, 4.0], [1.0, 8.0]])
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, Uint16x4(vec![[1, 2, 3, 4], [5, 6, 7, 8]]))
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]]);
        let mut attributes = Attributes::of(&mesh, 2);
        let vertices = vec![BornVertex { parents: [0, 1], t: 0.75 }, BornVertex { parents: [1, 1], t: 0.0 }];
        let mut change = Change::default();
        change.vertices.extend(vertices);
        attributes.follow(&change);
        let Some(Float32x2(uvs)) = attributes.get(Mesh::ATTRIBUTE_UV_1) else { panic!("no second coordinates") };
        assert_eq!(uvs[2..], [[0.75, 7.0], [1.0, 8.0]]);
        let Some(Uint16x4(joints)) = attributes.get(Mesh::ATTRIBUTE_JOINT_INDEX) else { panic!("no joints") };
        assert_eq!(joints[2..], [[5, 6, 7, 8]; 2]);
        let Some(Float32x4(weights)) = attributes.get(Mesh::ATTRIBUTE_JOINT_WEIGHT) else { panic!("no weights") };
        assert_eq!(weights[2..], [[0.5, 0.5, 0.0, 0.0]; 2]);
        assert!(attributes.get(Mesh::ATTRIBUTE_POSITION).is_none());
        // Saved without values, and put back where the cloth is not torn yet.
        let mut saved = Attributes { all: Vec::new(), born: attributes.born.clone() };
        let now = Attributes::of(&mesh, 2);
        assert!(saved.miss(&now));
        saved.take(&now);
        let all = |attributes: &Attributes| attributes.all.iter().map(|(_, v)| v.clone()).collect::<Vec<_>>();
        assert_eq!(all(&saved), all(&attributes));
    }
}
