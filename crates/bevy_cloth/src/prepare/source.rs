//! From a [`ClothSource`] to the solver's topology and to what drawing needs of the mesh.

use bevy::mesh::{Indices, Mesh, PrimitiveTopology, VertexAttributeValues};
use bevy::prelude::*;
use cloth_solver::topology::{Change, MeshSource};
use cloth_solver::{ClothError, Topology};

use super::attributes::Attributes;
use crate::cloth::ClothSource;
use crate::damage::ATTRIBUTE_STRENGTH;
use crate::freedom::ATTRIBUTE_FREEDOM;

/// What drawing and pinning need of the mesh beside its topology: one entry for each render vertex, unless said otherwise.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Skin {
    /// Texture coordinates, or empty.
    pub uvs: Vec<Vec2>,
    /// Vertex colours, or empty.
    pub colors: Vec<[f32; 4]>,
    /// Factors on the strength, or empty.
    pub strength: Vec<f32>,
    /// How free each is, or empty.
    pub freedom: Vec<f32>,
    /// All other attributes of the mesh.
    pub attributes: Attributes,
    /// For each slot whether it lies on the border that the whole cloth had, or empty where nothing is drawn.
    #[cfg_attr(not(feature = "render"), allow(dead_code, reason = "only drawing asks"))]
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
        self.attributes.follow(change);
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
            if let (Some(from), Some(to)) = (self.freedom.get(a), self.freedom.get(b)) {
                self.freedom.push(from + (to - from) * born.t);
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
pub(crate) fn positions_and_indices(mesh: &Mesh, scale: Vec3) -> Result<(Vec<Vec3>, Vec<u32>), ClothError> {
    let not_a_list = |reason: String| ClothError::NotTriangleList { reason };
    let is_strip = match mesh.primitive_topology() {
        PrimitiveTopology::TriangleList => false,
        PrimitiveTopology::TriangleStrip => true,
        other => return Err(not_a_list(format!("its primitive topology is {other:?}"))),
    };
    let positions = match mesh.try_attribute_option(Mesh::ATTRIBUTE_POSITION) {
        Ok(Some(VertexAttributeValues::Float32x3(positions))) => positions,
        Ok(Some(_)) => return Err(not_a_list("its positions are not three floats each".into())),
        Ok(None) => return Err(not_a_list("it has no positions".into())),
        Err(error) => return Err(not_a_list(format!("{error}; keep it with `RenderAssetUsages::MAIN_WORLD`"))),
    };
    let positions: Vec<Vec3> = positions.iter().map(|p| Vec3::from_array(*p) * scale).collect();
    // Of a strip, the largest number begins another one.
    let (mut indices, restart): (Vec<u32>, _) = match mesh.try_indices_option() {
        Ok(Some(Indices::U32(indices))) => (indices.clone(), u32::MAX),
        Ok(Some(Indices::U16(indices))) => (indices.iter().map(|i| u32::from(*i)).collect(), u32::from(u16::MAX)),
        _ => ((0..positions.len() as u32).collect(), u32::MAX),
    };
    if is_strip {
        indices = indices.split(|index| *index == restart).flat_map(triangles_of_strip).flatten().collect();
    }
    if !indices.len().is_multiple_of(3) {
        return Err(not_a_list(format!("it has {} indices, not a multiple of 3", indices.len())));
    }
    if scale.x * scale.y * scale.z < 0.0 {
        // Mirrored: the other side of every triangle is its front.
        indices.chunks_exact_mut(3).for_each(|triangle| triangle.swap(1, 2));
    }
    Ok((positions, indices))
}

/// The triangles of a strip, all wound alike. Those between two strips, which name a vertex twice, are none.
fn triangles_of_strip(strip: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let turned = |(at, corners): (usize, &[u32])| {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        if at % 2 == 0 { [a, b, c] } else { [b, a, c] }
    };
    strip.windows(3).enumerate().map(turned).filter(|[a, b, c]| a != b && b != c && c != a)
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
    let freedom = match mesh.try_attribute_option(ATTRIBUTE_FREEDOM) {
        Ok(Some(VertexAttributeValues::Float32(freedom))) => freedom.clone(),
        _ => Vec::new(),
    };
    let attributes = Attributes::of(mesh, positions.len());
    Ok((topology, Skin { uvs, colors, strength, freedom, attributes, ..Skin::default() }))
}
