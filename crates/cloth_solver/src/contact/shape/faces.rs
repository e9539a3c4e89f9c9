//! A convex solid from its faces, and the polyhedra inside curved solids.

use core::f32::consts::TAU;

use glam::{DVec3, Vec3};

use super::ConvexHull;

/// Sides of the prism inside a cylinder, and of the pyramid inside a cone: the middle of a side is half a percent of the radius
/// below the surface.
const SIDES: u32 = 32;

/// A face: triangles in one plane, counterclockwise seen from outside.
pub(super) type Face = Vec<[u32; 3]>;

impl ConvexHull {
    /// The solid with these corners and faces, which close it.
    pub(super) fn from_faces(corners: &[Vec3], faces: &[Face]) -> Self {
        let at = |i: u32| corners[i as usize].as_dvec3();
        // Twice the area vector of a face is the sum of those of its triangles.
        let area =
            |face: &Face| -> DVec3 { face.iter().map(|[a, b, c]| (at(*b) - at(*a)).cross(at(*c) - at(*a))).sum() };
        let normals: Vec<Vec3> = faces.iter().map(|face| area(face).normalize_or_zero().as_vec3()).collect();
        let offset = |n: &Vec3| corners.iter().map(|c| n.as_dvec3().dot(c.as_dvec3())).fold(f64::MIN, f64::max) as f32;
        let planes: Vec<(Vec3, f32)> = normals.iter().map(|n| (*n, offset(n))).collect();

        let sides = sides_between(faces);
        let mut used: Vec<u32> = sides.iter().flat_map(|(edge, _)| *edge).collect();
        used.sort_unstable();
        used.dedup();
        let renamed = |i: u32| used.partition_point(|other| *other < i) as u32;
        // Along an edge the face that has it in this direction lies to the left, seen from outside.
        let into = |[a, b]: [u32; 2], [left, right]: [usize; 2]| {
            let along = (at(b) - at(a)).as_vec3();
            [normals[left].cross(along).normalize_or_zero(), along.cross(normals[right]).normalize_or_zero()]
        };
        let corners: Vec<Vec3> = used.iter().map(|i| corners[*i as usize]).collect();
        let middle = centroid(faces, at).as_vec3();
        Self {
            radius: corners.iter().map(|corner| corner.length()).fold(0.0, f32::max),
            inner_radius: planes.iter().map(|(n, d)| d - n.dot(middle)).fold(f32::INFINITY, f32::min),
            into_faces: sides.iter().map(|(edge, faces)| into(*edge, *faces)).collect(),
            edges: sides.iter().map(|(edge, _)| edge.map(renamed)).collect(),
            planes,
            corners,
        }
    }

    /// The prism of [`SIDES`] sides whose corners lie on the rims of a cylinder along y.
    pub(super) fn in_cylinder(radius: f32, half_height: f32) -> Self {
        let corners: Vec<Vec3> = [-half_height, half_height].into_iter().flat_map(|y| ring(radius, y)).collect();
        let side = |i: u32| {
            let (a, b) = (i, (i + 1) % SIDES);
            vec![[a, a + SIDES, b], [b, a + SIDES, b + SIDES]]
        };
        let bottom = (1..SIDES - 1).map(|i| [0, i, i + 1]).collect();
        let top = (1..SIDES - 1).map(|i| [SIDES, SIDES + i + 1, SIDES + i]).collect();
        Self::from_faces(&corners, &(0..SIDES).map(side).chain([bottom, top]).collect::<Vec<_>>())
    }

    /// The pyramid of [`SIDES`] sides whose corners are the apex of a cone along y and lie on its rim.
    pub(super) fn in_cone(radius: f32, half_height: f32) -> Self {
        let corners: Vec<Vec3> = ring(radius, -half_height).chain([Vec3::Y * half_height]).collect();
        let bottom = (1..SIDES - 1).map(|i| [0, i, i + 1]).collect();
        let sides = (0..SIDES).map(|i| vec![[i, SIDES, (i + 1) % SIDES]]);
        Self::from_faces(&corners, &sides.chain([bottom]).collect::<Vec<_>>())
    }

    /// A polyhedron of 80 triangles whose corners lie on an ellipsoid: an icosahedron of which each triangle is divided into four.
    pub(super) fn in_ellipsoid(half: Vec3) -> Self {
        let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
        let mut corners: Vec<Vec3> = Vec::new();
        for [short, long] in [[1.0, golden], [-1.0, golden], [1.0, -golden], [-1.0, -golden]] {
            corners.extend([Vec3::new(0.0, short, long), Vec3::new(short, long, 0.0), Vec3::new(long, 0.0, short)]);
        }
        // Neighbours are 2 apart, all others farther.
        let is_edge = |a: usize, b: usize| corners[a].distance(corners[b]) < 2.5;
        let mut triangles = Vec::new();
        for a in 0..12 {
            for b in (a + 1..12).filter(|b| is_edge(a, *b)) {
                for c in (b + 1..12).filter(|c| is_edge(a, *c) && is_edge(b, *c)) {
                    let volume = corners[a].dot(corners[b].cross(corners[c]));
                    triangles.push(if volume > 0.0 { [a, b, c] } else { [a, c, b] }.map(|i| i as u32));
                }
            }
        }
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                corners.push(corners[a as usize] + corners[b as usize]);
                corners.len() as u32 - 1
            })
        };
        let mut faces: Vec<Face> = Vec::new();
        for [a, b, c] in triangles {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|triangle| vec![triangle]));
        }
        let corners: Vec<Vec3> = corners.iter().map(|corner| corner.normalize() * half).collect();
        Self::from_faces(&corners, &faces)
    }
}

/// Corners on a circle about the y axis, clockwise seen from above.
fn ring(radius: f32, y: f32) -> impl Iterator<Item = Vec3> {
    let angle = |i: u32| TAU * i as f32 / SIDES as f32;
    (0..SIDES).map(move |i| Vec3::new(radius * libm::cosf(angle(i)), y, radius * libm::sinf(angle(i))))
}

/// The edges between different faces, each with the face on its left and that on its right.
fn sides_between(faces: &[Face]) -> Vec<([u32; 2], [usize; 2])> {
    let mut half_edges: Vec<([u32; 2], bool, usize)> = Vec::new();
    for (face, triangles) in faces.iter().enumerate() {
        for [a, b, c] in triangles {
            let directed = [[*a, *b], [*b, *c], [*c, *a]];
            half_edges.extend(directed.map(|[a, b]| ([a.min(b), a.max(b)], a > b, face)));
        }
    }
    half_edges.sort_unstable();
    let pairs = half_edges.chunk_by(|a, b| a.0 == b.0).filter(|pair| pair.len() == 2 && pair[0].2 != pair[1].2);
    pairs.map(|pair| (pair[0].0, [pair[0].2, pair[1].2])).collect()
}

/// The centre of the volume within closed faces.
fn centroid(faces: &[Face], at: impl Fn(u32) -> DVec3) -> DVec3 {
    let triangles = || faces.iter().flatten().map(|triangle| triangle.map(&at));
    let origin = triangles().next().map_or(DVec3::ZERO, |[a, ..]| a);
    let (mut sum, mut volume) = (DVec3::ZERO, 0.0);
    for [a, b, c] in triangles().map(|triangle| triangle.map(|corner| corner - origin)) {
        let part = a.dot(b.cross(c));
        sum += (a + b + c) * part;
        volume += part;
    }
    origin + sum / (4.0 * volume)
}
