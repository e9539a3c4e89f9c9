//! The shapes that `parry3d` helps to make: hulls of points, triangle meshes, height fields.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{DVec3, UVec2, Vec2, Vec3};

use super::faces::Face;
use super::{ConvexHull, Shape, TriangleMesh};
use crate::ClothError;

/// Faces of the hull of points at most: the cost of contact grows with them.
const MAX_FACES: usize = 256;

/// How far from the origin of its frame a solid may reach, m.
const MAX_REACH: f32 = 1e4;

/// Points nearer to a plane than this part of the reach of all are on it: an order of magnitude above what the rounding of an f32 at
/// that distance moves a plane through three of them.
const COPLANAR: f64 = 1e-6;

impl Shape {
    /// The convex hull of `points`, m: at least four, not in one plane, within 1e4 m of the origin. It may have 256 faces; points
    /// inside cost nothing.
    pub fn hull(points: &[Vec3]) -> Result<Self, ClothError> {
        let [count, reach, depth, faces] = [
            "ClothCollider::Hull.points.len()",
            "reach of ClothCollider::Hull.points",
            "depth of ClothCollider::Hull.points",
            "number of faces of ClothCollider::Hull",
        ];
        ClothError::check(count, points.len() as f32, 4.0..=1e6, "4..=1,000,000")?;
        let farthest = check_places(points, reach)?;
        let is_flat = |value| ClothError::OutOfRange { field: depth, value, allowed: "above 1e-6 of its reach" };
        let places: Vec<_> = points.iter().map(|p| parry3d::math::Vector::new(p.x, p.y, p.z)).collect();
        let (corners, triangles) = parry3d::transformation::try_convex_hull(&places).map_err(|_| is_flat(0.0))?;
        let corners: Vec<Vec3> = corners.iter().map(|p| Vec3::new(p.x, p.y, p.z)).collect();
        let tolerance = COPLANAR * f64::from(farthest);
        let merged = merge(&corners, &triangles, tolerance);
        ClothError::check(faces, merged.len() as f32, 0.0..=MAX_FACES as f32, "4..=256; leave out points")?;
        let mut hull = ConvexHull::from_faces(&corners, &merged);
        // What has no volume has no middle to measure from.
        let thickness = if hull.inner_radius.is_finite() { hull.inner_radius.max(0.0) } else { 0.0 };
        if merged.len() < 4 || f64::from(thickness) <= tolerance {
            return Err(is_flat(thickness));
        }
        // What was so near to a face that it was taken for a point of it lies inside, too.
        for (normal, offset) in &mut hull.planes {
            *offset = points.iter().map(|p| normal.dot(*p)).fold(*offset, f32::max);
        }
        Ok(Self::Convex(Arc::new(hull)))
    }

    /// A wall along triangles, solid within half of `thickness` (1e-3..=10 m) of them, on both sides. `indices` name the corners of
    /// each triangle among `positions`, m, within 1e4 m of the origin. Triangles without an area are left out.
    ///
    /// Cloth that gets to the other side of the middle stays there: it is a wall, not a solid. The thicker, the cheaper it is for
    /// what is fast.
    pub fn triangle_mesh(positions: &[Vec3], indices: &[u32], thickness: f32) -> Result<Self, ClothError> {
        check_thickness("ClothCollider::Mesh.thickness", thickness)?;
        if !indices.len().is_multiple_of(3) {
            let reason = format!("{} indices, not a multiple of three", indices.len());
            return Err(ClothError::NotTriangleList { reason });
        }
        let vertices = positions.len();
        if let Some((place, index)) = indices.iter().enumerate().find(|(_, index)| **index as usize >= vertices) {
            return Err(ClothError::IndexOutOfRange { triangle: place / 3, index: *index, vertices });
        }
        check_places(positions, "reach of ClothCollider::Mesh")?;
        let (triangles, _) = indices.as_chunks::<3>();
        Self::wall(positions, triangles.iter().copied(), thickness, "ClothCollider::Mesh")
    }

    /// A wall along a height field, centred on the origin, solid within half of `thickness` (1e-3..=10 m) of it, above and below.
    /// `heights` (m, within ±1e4) are those of `cells + 1` points, along x first, from −x and −z on; `size` its extent along x and
    /// z, each 1e-4..=1e4 m. The diagonal of each cell goes from its corner at −x and +z to the one at +x and −z.
    pub fn height_field(size: Vec2, cells: UVec2, heights: &[f32], thickness: f32) -> Result<Self, ClothError> {
        super::check_size("ClothCollider::HeightField.size.x", size.x)?;
        super::check_size("ClothCollider::HeightField.size.y", size.y)?;
        let [across, down] = ["ClothCollider::HeightField.cells.x", "ClothCollider::HeightField.cells.y"];
        ClothError::check(across, cells.x as f32, 1.0..=4096.0, "1..=4096")?;
        ClothError::check(down, cells.y as f32, 1.0..=4096.0, "1..=4096")?;
        check_thickness("ClothCollider::HeightField.thickness", thickness)?;
        let points = cells + 1;
        if heights.len() != points.element_product() as usize {
            let field = "ClothCollider::HeightField.heights.len()";
            let allowed = "(cells.x + 1) * (cells.y + 1)";
            return Err(ClothError::OutOfRange { field, value: heights.len() as f32, allowed });
        }
        let place = |i: usize| {
            let at = UVec2::new(i as u32 % points.x, i as u32 / points.x).as_vec2() / cells.as_vec2() - 0.5;
            Vec3::new(at.x * size.x, heights[i], at.y * size.y)
        };
        let positions: Vec<Vec3> = (0..heights.len()).map(place).collect();
        check_places(&positions, "ClothCollider::HeightField.heights")?;
        let corners = (0..cells.y).flat_map(|j| (0..cells.x).map(move |i| j * points.x + i));
        let triangles = corners.flat_map(|a| {
            let [b, c, d] = [a + 1, a + points.x, a + points.x + 1];
            [[a, c, b], [b, c, d]]
        });
        Self::wall(&positions, triangles, thickness, "ClothCollider::HeightField")
    }

    fn wall(
        positions: &[Vec3],
        triangles: impl Iterator<Item = [u32; 3]>,
        thickness: f32,
        field: &'static str,
    ) -> Result<Self, ClothError> {
        let (vertices, welded) = weld(positions);
        let triangles = triangles.map(|triangle| triangle.map(|i| welded[i as usize]));
        let has_area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| vertices[i as usize].as_dvec3());
            let sides = [b - a, c - b, a - c].map(DVec3::length_squared).into_iter().fold(0.0, f64::max);
            // Thinner than what its corners are rounded to, it has no normal.
            (b - a).cross(c - a).length() > f64::from(f32::EPSILON) * sides
        };
        let triangles: Vec<[u32; 3]> = triangles.filter(has_area).collect();
        if triangles.is_empty() {
            return Err(ClothError::NoTriangles { field });
        }
        Ok(Self::Mesh(Arc::new(TriangleMesh::new(vertices, triangles, thickness))))
    }
}

fn check_thickness(field: &'static str, thickness: f32) -> Result<(), ClothError> {
    ClothError::check(field, thickness, 1e-3..=10.0, "0.001..=10 m")
}

/// The largest coordinate of points that are all finite and not too far off, m.
fn check_places(points: &[Vec3], field: &'static str) -> Result<f32, ClothError> {
    if let Some((vertex, position)) = points.iter().enumerate().find(|(_, p)| !p.is_finite()) {
        return Err(ClothError::VertexNotFinite { vertex, position: *position });
    }
    let farthest = points.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    ClothError::check(field, farthest, 0.0..=MAX_REACH, "within 1e4 m of the origin")?;
    Ok(farthest)
}

/// Points at the same place as one, and which each of them became.
fn weld(positions: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    let (mut vertices, mut known) = (Vec::new(), HashMap::with_capacity(positions.len()));
    let welded = positions.iter().map(|p| {
        // Adding 0 makes a zero of -0.
        let place = (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        *known.entry(place).or_insert_with(|| {
            vertices.push(*p);
            vertices.len() as u32 - 1
        })
    });
    let welded = welded.collect();
    (vertices, welded)
}

/// Triangles of a convex solid in faces: those that share an edge and a plane are one.
fn merge(corners: &[Vec3], triangles: &[[u32; 3]], tolerance: f64) -> Vec<Face> {
    let at = |i: u32| corners[i as usize].as_dvec3();
    let area = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a));
    let mut neighbors: HashMap<[u32; 2], usize> = HashMap::new();
    for (triangle, [a, b, c]) in triangles.iter().enumerate() {
        neighbors.extend([[*a, *b], [*b, *c], [*c, *a]].map(|side| (side, triangle)));
    }
    // The largest first: its plane is known best.
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|a, b| area(triangles[*b]).length_squared().total_cmp(&area(triangles[*a]).length_squared()));
    let (mut faces, mut is_taken) = (Vec::new(), vec![false; triangles.len()]);
    for first in order {
        if std::mem::replace(&mut is_taken[first], true) {
            continue;
        }
        let (normal, origin) = (area(triangles[first]).normalize_or_zero(), at(triangles[first][0]));
        let is_in_plane = |i: u32| normal.dot(at(i) - origin).abs() <= tolerance;
        let (mut face, mut next) = (vec![triangles[first]], 0);
        while next < face.len() {
            let [a, b, c] = face[next];
            next += 1;
            for side in [[b, a], [c, b], [a, c]] {
                let Some(other) = neighbors.get(&side).copied().filter(|other| !is_taken[*other]) else { continue };
                if triangles[other].iter().all(|i| is_in_plane(*i)) {
                    is_taken[other] = true;
                    face.push(triangles[other]);
                }
            }
        }
        faces.push(face);
    }
    faces
}
