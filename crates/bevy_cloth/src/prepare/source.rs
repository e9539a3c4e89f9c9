//! From a [`ClothSource`] to the solver's topology and to what drawing needs of the mesh.

use bevy::mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use cloth_solver::topology::{Change, MeshSource};
use cloth_solver::{ClothError, Topology};

use crate::cloth::ClothSource;
use crate::damage::ATTRIBUTE_STRENGTH;

/// What drawing and pinning need of the mesh beside its topology: one entry for each render vertex, unless said otherwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    /// Texture coordinates, or empty.
    pub uvs: Vec<Vec2>,
    /// Vertex colours, or empty.
    pub colors: Vec<[f32; 4]>,
    /// Factors on the strength, or empty.
    pub strength: Vec<f32>,
    /// For each slot whether it lies on the border that the whole cloth had.
    #[cfg(feature = "render")]
    pub hem: Vec<bool>,
}

impl Skin {
    /// Updates the skin after a topology change: adds vertices and particles that are new.
    pub fn follow(&mut self, change: &Change) {
        #[cfg(feature = "render")]
        {
            self.hem.resize(change.slots, false);
            for born in &change.born {
                let [a, b] = born.parents.map(|slot| self.hem[slot as usize]);
                self.hem[born.slot as usize] = a && b;
            }
        }
        for born in &change.vertices {
            let [a, b] = born.parents.map(|vertex| vertex as usize);
            if let (Some(from), Some(to)) = (self.uvs.get(a), self.uvs.get(b)) {
                self.uvs.push(from.lerp(*to, born.t));
            }
            if let (Some(from), Some(to)) = (self.colors.get(a), self.colors.get(b)) {
                self.colors.push(std::array::from_fn(|i| from[i] + (to[i] - from[i]) * born.t));
            }
            if let (Some(from), Some(to)) = (self.strength.get(a), self.strength.get(b)) {
                self.strength.push(from + (to - from) * born.t);
            }
        }
    }
}

/// Topology and skin of `source` under `scale`. `mesh` is needed for [`ClothSource::Mesh`].
pub(crate) fn shape(source: &ClothSource, scale: Vec3, mesh: Option<&Mesh>) -> Result<(Topology, Skin), ClothError> {
    let shape = match (source, mesh) {
        (ClothSource::Rectangle { size, resolution }, _) => {
            // The sign is kept out: a mirrored flat rectangle is the same rectangle.
            let topology = Topology::rectangle(*size * scale.truncate().abs(), *resolution)?;
            let skin = rectangle_skin(&topology);
            Ok((topology, skin))
        }
        (ClothSource::Mesh, Some(mesh)) => from_mesh(mesh, scale),
        (ClothSource::Mesh, None) => Err(ClothError::NoTriangles { field: "ClothSource::Mesh" }),
    };
    #[cfg(feature = "render")]
    let shape = shape.map(|(topology, skin)| {
        let hem = crate::render::hem(&topology);
        (topology, Skin { hem, ..skin })
    });
    shape
}

fn rectangle_skin(topology: &Topology) -> Skin {
    let (min, max) = bounds(topology);
    let size = (max - min).max(Vec3::splat(f32::MIN_POSITIVE));
    let uv = |slot: &u32| {
        let p = topology.rest[*slot as usize];
        Vec2::new((p.x - min.x) / size.x, (max.y - p.y) / size.y)
    };
    Skin { uvs: topology.vertex_particle.iter().map(uv).collect(), ..Skin::default() }
}

/// Lower and upper bounds of the rest positions of all particles, m.
pub(crate) fn bounds(topology: &Topology) -> (Vec3, Vec3) {
    let rest = topology.particles().map(|slot| topology.rest[slot as usize]);
    rest.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)))
}

/// Vertices under `scale` and corners of the triangles of a mesh.
pub(super) fn positions_and_indices(mesh: &Mesh, scale: Vec3) -> Result<(Vec<Vec3>, Vec<u32>), ClothError> {
    let not_a_list = |reason: String| ClothError::NotTriangleList { reason };
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return Err(not_a_list(format!("its primitive topology is {:?}", mesh.primitive_topology())));
    }
    let positions = match mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION) {
        Ok(Some(VertexAttributeValues::Float32x3(positions))) => positions,
        Ok(Some(_)) => return Err(not_a_list("its positions are not three floats each".into())),
        Ok(None) => return Err(not_a_list("it has no positions".into())),
        Err(error) => return Err(not_a_list(format!("{error}; keep it with `RenderAssetUsages::MAIN_WORLD`"))),
    };
    let positions: Vec<Vec3> = positions.iter().map(|p| Vec3::from_array(*p) * scale).collect();
    let mut indices: Vec<u32> = match mesh.try_indices_option() {
        Ok(Some(Indices::U32(indices))) => indices.clone(),
        Ok(Some(Indices::U16(indices))) => indices.iter().map(|i| u32::from(*i)).collect(),
        _ => (0..positions.len() as u32).collect(),
    };
    if !indices.len().is_multiple_of(3) {
        return Err(not_a_list(format!("it has {} indices, not a multiple of 3", indices.len())));
    }
    if scale.x * scale.y * scale.z < 0.0 {
        // Mirrored: the other side of every triangle is its front.
        indices.chunks_exact_mut(3).for_each(|triangle| triangle.swap(1, 2));
    }
    Ok((positions, indices))
}

fn from_mesh(mesh: &Mesh, scale: Vec3) -> Result<(Topology, Skin), ClothError> {
    let (positions, indices) = positions_and_indices(mesh, scale)?;
    let uvs: Vec<Vec2> = match mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0) {
        Ok(Some(VertexAttributeValues::Float32x2(uvs))) => uvs.iter().map(|uv| Vec2::from_array(*uv)).collect(),
        _ => Vec::new(),
    };
    let colors = match mesh.try_attribute_option(Mesh::ATTRIBUTE_COLOR) {
        Ok(Some(VertexAttributeValues::Float32x4(colors))) => colors.clone(),
        Ok(Some(VertexAttributeValues::Unorm8x4(colors))) => {
            colors.iter().map(|color| color.map(|channel| f32::from(channel) / 255.0)).collect()
        }
        _ => Vec::new(),
    };
    let source = MeshSource { positions: &positions, uvs: &uvs, indices: &indices };
    let topology = Topology::from_mesh(source)?.into_rectangle().into_quads();
    let strength = match mesh.try_attribute_option(ATTRIBUTE_STRENGTH) {
        Ok(Some(VertexAttributeValues::Float32(strength))) => strength.clone(),
        _ => Vec::new(),
    };
    Ok((topology, Skin { uvs, colors, strength, ..Skin::default() }))
}
