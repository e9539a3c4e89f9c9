//! Where each vertex of a fine mesh is on the triangles of a coarse cloth.

use std::collections::HashMap;

use bevy::prelude::*;
use cloth_solver::Topology;
use parry3d::math::Vector;
use parry3d::query::PointQueryWithLocation;
use parry3d::shape::TriMesh;

use crate::render::surface;

/// In place of a triangle of the cloth: that is burnt.
const GONE: u32 = u32::MAX;

/// By how much more a triangle may be away from the cloth than it was when bound, before the cloth under it counts as gone, as a
/// share of the mean length of an edge of the cloth.
const SLACK: f32 = 1e-3;

/// A triangle of the cloth, and its particles.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Under {
    triangle: u32,
    corners: [u32; 3],
}

const NOWHERE: Under = Under { triangle: GONE, corners: [0; 3] };

/// A vertex on a triangle: `Σ weights · corners + frame · offset`, the frame being along the triangle and its smooth normal.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    under: Under,
    /// Of the corners. They add up to 1, and some are below 0 where the vertex lies beyond the triangle.
    weights: Vec3,
    offset: Vec3,
    normal: Vec3,
    tangent: Vec3,
}

/// A vertex as authored, seen from the cloth at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: Vec3,
    pub normal: Vec3,
    pub tangent: Vec3,
}

/// Which triangles of a cloth the vertices and triangles of a fine mesh lie on.
#[derive(Clone, Debug, Default)]
pub(super) struct Binding {
    vertices: Vec<Vertex>,
    triangles: Vec<[u32; 3]>,
    /// Of each vertex, and behind them of the copies.
    anchors: Vec<Anchor>,
    /// What the middle of each triangle lies on.
    homes: Vec<Under>,
    /// How far the middle of each triangle was from the cloth when it was bound, m.
    gaps: Vec<f32>,
    /// Of each copy the vertex that it is a copy of.
    pub copies: Vec<u32>,
    /// Triangles to draw, of vertices and copies.
    pub drawn: Vec<[u32; 3]>,
    /// Rest positions of the cloth that it was made for.
    rest: Vec<Vec3>,
    /// Of each slot of the cloth, scratch.
    normals: Vec<Vec3>,
}

impl Binding {
    /// Binds a mesh to the whole cloth.
    pub fn new(vertices: Vec<Vertex>, triangles: Vec<[u32; 3]>, topology: &Topology) -> Self {
        let nowhere =
            Anchor { under: NOWHERE, weights: Vec3::ZERO, offset: Vec3::ZERO, normal: Vec3::Z, tangent: Vec3::X };
        let mut new = Self {
            anchors: vec![nowhere; vertices.len()],
            homes: vec![NOWHERE; triangles.len()],
            gaps: vec![f32::INFINITY; triangles.len()],
            vertices,
            triangles,
            rest: topology.rest.clone(),
            ..Self::default()
        };
        new.bind(topology);
        new.drawn.clone_from(&new.triangles);
        new
    }

    /// Whether `topology` is the same cloth, whole or taken apart.
    pub fn knows(&self, topology: &Topology) -> bool {
        topology.rest.starts_with(&self.rest)
    }

    /// Takes over what was torn, cut or burnt: a triangle of the mesh goes with the triangle of the cloth that its middle lies on.
    pub fn follow(&mut self, topology: &Topology) {
        self.bind(topology);
        self.copies.clear();
        self.anchors.truncate(self.vertices.len());
        self.drawn.clear();
        let pieces = topology.pieces();
        let rest = |corner: u32| topology.rest[corner as usize];
        let mut copied = HashMap::new();
        for (triangle, home) in self.triangles.iter().zip(&self.homes) {
            if home.triangle == GONE {
                continue;
            }
            let corners = triangle.map(|vertex| {
                let under = self.anchors[vertex as usize].under;
                let pairs = || under.corners.iter().flat_map(|a| home.corners.iter().map(move |b| (*a, *b)));
                // What shared a particle does so still; what was further apart is of one piece.
                let holds = if pairs().any(|(a, b)| rest(a) == rest(b)) {
                    pairs().any(|(a, b)| a == b)
                } else {
                    pieces.of_slot[under.corners[0] as usize] == pieces.of_slot[home.corners[0] as usize]
                };
                if holds {
                    return vertex;
                }
                *copied.entry((vertex, home.triangle)).or_insert_with(|| {
                    let (of, at) = (&self.vertices[vertex as usize], self.anchors.len() as u32);
                    self.copies.push(vertex);
                    self.anchors.push(anchor(of, *home, topology, &self.normals));
                    at
                })
            });
            self.drawn.push(corners);
        }
    }

    /// Finds the triangle under each vertex and each middle of a triangle, where that is not known or another one now.
    fn bind(&mut self, topology: &Topology) {
        let mut normals = std::mem::take(&mut self.normals);
        normals.resize(topology.slots(), Vec3::Z);
        surface::normals(&topology.triangles, &topology.rest, &mut normals);
        let mut nearest = Nearest { topology, tree: None };
        for (vertex, of) in self.anchors.iter_mut().zip(&self.vertices) {
            let is_known = nearest.is_still(&mut vertex.under);
            if !is_known && let Some((under, _)) = nearest.find(of.position) {
                *vertex = anchor(of, under, topology, &normals);
            }
        }
        let edge = (topology.area.iter().sum::<f32>() / topology.triangles.len().max(1) as f32).sqrt();
        for ((home, gap), triangle) in self.homes.iter_mut().zip(&mut self.gaps).zip(&self.triangles) {
            if nearest.is_still(home) {
                continue;
            }
            let middle = triangle.iter().map(|vertex| self.vertices[*vertex as usize].position).sum::<Vec3>() / 3.0;
            let found = nearest.find(middle).filter(|(_, distance)| *distance <= *gap + SLACK * edge);
            (*home, *gap) = found.map_or((NOWHERE, *gap), |(under, distance)| (under, gap.min(distance)));
        }
        self.normals = normals;
    }

    /// Finds where the vertices and copies are while the particles are at `shown`, and hands over each: its number, position, unit
    /// normal and unit tangent.
    pub fn place(&mut self, topology: &Topology, shown: &[Vec3], mut put: impl FnMut(usize, Vec3, Vec3, Vec3)) {
        self.normals.resize(topology.slots(), Vec3::Z);
        surface::normals(&topology.triangles, shown, &mut self.normals);
        for (index, vertex) in self.anchors.iter().enumerate() {
            let corners = vertex.under.corners.map(|slot| shown[slot as usize]);
            let frame = frame(&vertex.under, vertex.weights, corners, &self.normals);
            let at = blend(corners, vertex.weights) + frame * vertex.offset;
            put(index, at, frame * vertex.normal, frame * vertex.tangent);
        }
    }
}

/// Finds triangles of the cloth at rest.
struct Nearest<'a> {
    topology: &'a Topology,
    /// Made when it is first asked for.
    tree: Option<Option<TriMesh>>,
}

impl Nearest<'_> {
    /// Whether `under` lies where it lay, with the particles that it has now.
    fn is_still(&self, under: &mut Under) -> bool {
        let Some(now) = self.topology.triangles.get(under.triangle as usize) else { return false };
        // Of a cloth that is whole again, particles are gone that came of tears.
        let rest = |corners: &[u32; 3]| corners.map(|slot| self.topology.rest.get(slot as usize));
        let same = rest(now) == rest(&under.corners);
        if same {
            under.corners = *now;
        }
        same
    }

    /// The triangle nearest to a point, and how far it is, m. `None` of a cloth that is all burnt.
    fn find(&mut self, point: Vec3) -> Option<(Under, f32)> {
        let topology = self.topology;
        let tree = self.tree.get_or_insert_with(|| {
            let corners = topology.rest.iter().map(|p| vector(*p)).collect();
            TriMesh::new(corners, topology.triangles.clone()).ok()
        });
        let (at, (triangle, _)) = tree.as_ref()?.project_local_point_and_get_location(vector(point), false);
        let under = Under { triangle, corners: topology.triangles[triangle as usize] };
        Some((under, at.point.distance(vector(point))))
    }
}

fn vector(p: Vec3) -> Vector {
    Vector::new(p.x, p.y, p.z)
}

fn blend(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

/// The place of a vertex on the triangle `under` of the cloth at rest, where that has these `normals`.
fn anchor(of: &Vertex, under: Under, topology: &Topology, normals: &[Vec3]) -> Anchor {
    let corners = under.corners.map(|slot| topology.rest[slot as usize]);
    let (first, second, to) = (corners[1] - corners[0], corners[2] - corners[0], of.position - corners[0]);
    let across = first.cross(second);
    let scale = across.length_squared().recip();
    // Of the point below it in the plane of the triangle.
    let (second_weight, third_weight) = (to.cross(second).dot(across) * scale, first.cross(to).dot(across) * scale);
    let weights = Vec3::new(1.0 - second_weight - third_weight, second_weight, third_weight);
    let back = frame(&under, weights, corners, normals).transpose();
    Anchor {
        under,
        weights,
        offset: back * (of.position - blend(corners, weights)),
        normal: back * of.normal,
        tangent: back * of.tangent,
    }
}

/// Unit vectors at a point of a triangle: along its first side, across, and along the smooth normal.
fn frame(under: &Under, weights: Vec3, corners: [Vec3; 3], normals: &[Vec3]) -> Mat3 {
    let inside = weights.max(Vec3::ZERO);
    let at_corners = under.corners.map(|slot| normals[slot as usize]);
    let normal = blend(at_corners, inside).try_normalize().unwrap_or(at_corners[0]);
    let side = (corners[1] - corners[0]).reject_from_normalized(normal);
    let side = side.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
    Mat3::from_cols(side, normal.cross(side), normal)
}
