//! Where a solid mesh ends for an eye: its sharp edges between a face turned towards the eye and one turned
//! away, and the lines across smoothly shaded triangles where the shading normal turns away.

use bevy::mesh::{PrimitiveTopology, VertexAttributeValues};
use bevy::platform::collections::HashMap;
use bevy::platform::collections::hash_map::Entry;
use bevy::prelude::*;

/// Shading normals at one place that differ by more than this (cosine) make an edge sharp.
const SHARP: f32 = 0.9;

/// Vertices nearer to each other than about this share of the mesh's size are at the same place.
const SAME_PLACE: f32 = 1e-5;

/// A triangle mesh to look at.
pub struct Surface<'a> {
    positions: &'a [[f32; 3]],
    normals: &'a [[f32; 3]],
    triangles: Vec<[usize; 3]>,
}

/// An edge of a mesh with the triangles at its sides. Vertices at the same place are one.
pub struct Edge {
    ends: [usize; 2],
    first: usize,
    /// `None` at a border.
    second: Option<usize>,
    sharp: bool,
}

impl<'a> Surface<'a> {
    /// Reads a mesh; `None` if it is not a list of triangles with positions and normals in the main world.
    pub fn read(mesh: &'a Mesh) -> Option<Self> {
        let vectors = |attribute| match mesh.try_attribute(attribute) {
            Ok(VertexAttributeValues::Float32x3(values)) => Some(values.as_slice()),
            _ => None,
        };
        let positions = vectors(Mesh::ATTRIBUTE_POSITION)?;
        let normals = vectors(Mesh::ATTRIBUTE_NORMAL).filter(|normals| normals.len() == positions.len())?;
        if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
            return None;
        }
        let vertices: Vec<usize> = match mesh.try_indices() {
            Ok(indices) => indices.iter().collect(),
            Err(_) => (0..positions.len()).collect(),
        };
        let (triangles, _) = vertices.as_chunks::<3>();
        let within = |triangle: &[usize; 3]| triangle.iter().all(|vertex| *vertex < positions.len());
        Some(Self { positions, normals, triangles: triangles.iter().copied().filter(within).collect() })
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Every edge once.
    pub fn edges(&self) -> Vec<Edge> {
        let mut edges: Vec<Edge> = Vec::with_capacity(self.triangles.len() * 2);
        let mut known: HashMap<[IVec3; 2], usize> = HashMap::default();
        let size = self.positions.iter().flatten().fold(f32::MIN_POSITIVE, |size, value| size.max(value.abs()));
        let place = |vertex| (self.position(vertex) / (SAME_PLACE * size)).round().as_ivec3();
        for (triangle, [a, b, c]) in self.triangles.iter().copied().enumerate() {
            for ends in [[a, b], [b, c], [c, a]] {
                let mut places = ends.map(place);
                places.sort_unstable_by_key(|place| place.to_array());
                match known.entry(places) {
                    Entry::Vacant(entry) => {
                        entry.insert(edges.len());
                        edges.push(Edge { ends, first: triangle, second: None, sharp: false });
                    }
                    Entry::Occupied(entry) => {
                        let edge = &mut edges[*entry.get()];
                        // The neighbour runs along the edge the other way.
                        let sharp = |here, there| self.normal(here).dot(self.normal(there)) < SHARP;
                        edge.sharp |= sharp(edge.ends[0], ends[1]) || sharp(edge.ends[1], ends[0]);
                        edge.second = Some(triangle);
                    }
                }
            }
        }
        edges
    }

    /// The segment between two vertices; `None` if there are no such.
    pub fn segment(&self, ends: [u32; 2]) -> Option<[Vec3; 2]> {
        let [a, b] = ends.map(|vertex| self.positions.get(vertex as usize).map(|at| Vec3::from_array(*at)));
        Some([a?, b?])
    }

    /// The sharp edges between a face turned towards `eye` and one turned away.
    pub fn sharp_silhouette(&self, edges: &[Edge], eye: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
        edges
            .iter()
            .filter(move |edge| match edge.second {
                Some(second) => edge.sharp && self.faces(edge.first, eye) != self.faces(second, eye),
                None => true,
            })
            .map(|edge| edge.ends.map(|vertex| self.position(vertex)))
    }

    /// The lines across triangles where the shading normal is at a right angle to the view from `eye`.
    pub fn smooth_silhouette(&self, eye: Vec3) -> impl Iterator<Item = [Vec3; 2]> {
        self.triangles.iter().filter_map(move |triangle| {
            let at = triangle.map(|vertex| (self.position(vertex), self.normal(vertex)));
            let facing = at.map(|(position, normal)| normal.dot(eye - position));
            let crossing = |i: usize, j: usize| at[i].0.lerp(at[j].0, facing[i] / (facing[i] - facing[j]));
            let mut crossings = [(0, 1), (1, 2), (2, 0)]
                .into_iter()
                .filter(|(i, j)| (facing[*i] > 0.0) != (facing[*j] > 0.0))
                .map(|(i, j)| crossing(i, j));
            Some([crossings.next()?, crossings.next()?])
        })
    }

    fn position(&self, vertex: usize) -> Vec3 {
        Vec3::from_array(self.positions[vertex])
    }

    fn normal(&self, vertex: usize) -> Vec3 {
        Vec3::from_array(self.normals[vertex])
    }

    fn faces(&self, triangle: usize, eye: Vec3) -> bool {
        let [a, b, c] = self.triangles[triangle].map(|vertex| self.position(vertex));
        (b - a).cross(c - a).dot(eye - a) > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Vec3 = Vec3::new(3.0, 4.0, 5.0);

    #[test]
    fn a_box_seen_from_a_corner_has_a_silhouette_of_six_edges() {
        let mesh = Cuboid::default().mesh().build();
        let surface = Surface::read(&mesh).expect("a triangle mesh");
        let edges = surface.edges();
        assert_eq!(surface.sharp_silhouette(&edges, EYE).count(), 6);
    }

    #[test]
    fn the_silhouette_of_a_ball_is_a_circle_at_a_right_angle_to_the_tangents() {
        let mesh = Sphere::new(1.0).mesh().uv(64, 32);
        let surface = Surface::read(&mesh).expect("a triangle mesh");
        let borders = surface.edges().iter().filter(|edge| edge.second.is_none()).count();
        assert_eq!(borders, 0, "the seam of the texture is no border");
        let points: Vec<Vec3> = surface.smooth_silhouette(EYE).flatten().collect();
        assert!(points.len() > 64);
        for point in points {
            let cosine = point.normalize().dot((EYE - point).normalize());
            assert!(cosine.abs() < 0.02, "{point} is off the silhouette, cosine {cosine}");
        }
    }
}
