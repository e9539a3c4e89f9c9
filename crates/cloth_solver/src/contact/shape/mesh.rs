//! Triangle meshes as walls: solid within half a thickness of their triangles, on both sides.

use glam::{Vec3, Vec4};

use super::tree::Tree;
use crate::contact::nearest::on_triangle;

/// Cosine of the angle by which two triangles may be folded and count as flat: an edge of a cloth that lies across sinks in by less
/// than a hundredth of its length.
#[cfg(feature = "parry")]
const FLAT: f32 = 0.9994;

/// No edge.
const NONE: u32 = u32::MAX;

/// A wall along the triangles of a mesh. With the feature `parry`, `Shape::triangle_mesh` and `Shape::height_field` make one.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    /// Corners of the triangles, each once, m.
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Of the triangles, of unit length.
    normals: Vec<Vec3>,
    /// A ball around each triangle: its centre and radius, m.
    balls: Vec<Vec4>,
    /// Those along which the surface is folded or ends.
    edges: Vec<[u32; 2]>,
    /// Numbers of these of each triangle, or [`NONE`].
    edges_of: Vec<[u32; 3]>,
    /// Whether a vertex is at the end of one of them.
    is_corner: Vec<bool>,
    half_thickness: f32,
    /// How far it reaches from the origin, m.
    radius: f32,
    /// Lowest and highest corner of the box around it, m.
    bounds: [Vec3; 2],
    tree: Tree,
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.half_thickness == other.half_thickness
            && self.triangles == other.triangles
            && self.vertices == other.vertices
    }
}

#[cfg(feature = "parry")]
impl TriangleMesh {
    /// Of valid indices, finite vertices, and at least one triangle with an area.
    pub(super) fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>, thickness: f32) -> Self {
        let half_thickness = thickness / 2.0;
        let at = |triangle: &[u32; 3]| triangle.map(|i| vertices[i as usize]);
        let normals = triangles.iter().map(|triangle| {
            let [a, b, c] = at(triangle).map(Vec3::as_dvec3);
            (b - a).cross(c - a).normalize_or_zero().as_vec3()
        });
        let balls = triangles.iter().map(|triangle| {
            let [a, b, c] = at(triangle);
            let centre = (a + b + c) / 3.0;
            centre.extend([a, b, c].map(|corner| corner.distance(centre)).into_iter().fold(0.0, f32::max))
        });
        let (edges, edges_of) = folds(&vertices, &triangles);
        let mut is_corner = vec![false; vertices.len()];
        edges.iter().flatten().for_each(|i| is_corner[*i as usize] = true);
        let boxes = triangles.iter().map(|triangle| {
            let [a, b, c] = at(triangle);
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let (low, high) = vertices.iter().fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(*p), h.max(*p)));
        Self {
            normals: normals.collect(),
            balls: balls.collect(),
            edges,
            edges_of,
            is_corner,
            half_thickness,
            radius: vertices.iter().map(|p| p.length()).fold(0.0, f32::max) + half_thickness,
            bounds: [low - half_thickness, high + half_thickness],
            tree: Tree::new(boxes),
            vertices,
            triangles,
        }
    }
}

impl TriangleMesh {
    /// Its triangles, by their corners, m.
    pub fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|i| self.vertices[i as usize]))
    }

    /// How far the wall reaches to each side of the triangles, m.
    pub fn half_thickness(&self) -> f32 {
        self.half_thickness
    }

    pub(super) fn radius(&self) -> f32 {
        self.radius
    }

    pub(super) fn bounds(&self) -> [Vec3; 2] {
        self.bounds
    }

    /// See [`super::Shape::distance_and_normal`]; inside, the way out on the side where `p` is.
    pub(super) fn distance_and_normal(&self, p: Vec3) -> (f32, Vec3) {
        match self.nearest(p, f32::MAX) {
            Some(triangle) => self.to_triangle(triangle, p),
            // Too far off for the square of a distance.
            None => (f32::MAX, p.normalize_or(Vec3::Y)),
        }
    }

    /// Signed distance from the surface where `p` is inside; outside infinite.
    pub(super) fn depth(&self, p: Vec3) -> f32 {
        self.nearest(p, self.half_thickness).map_or(f32::INFINITY, |triangle| self.to_triangle(triangle, p).0)
    }

    /// Of those `triangles` the nearest to `p`: signed distance from the surface around it, `bound` m at most, and its normal.
    pub(crate) fn among(&self, p: Vec3, triangles: &[u32], bound: f32) -> (f32, Vec3) {
        let mut nearest = (bound, Vec3::Y);
        for &triangle in triangles {
            let ball = self.balls[triangle as usize];
            let reach = nearest.0 + self.half_thickness + ball.w;
            if ball.truncate().distance_squared(p) < reach * reach {
                let found = self.to_triangle(triangle, p);
                nearest = if found.0 < nearest.0 { found } else { nearest };
            }
        }
        nearest
    }

    fn nearest(&self, p: Vec3, reach: f32) -> Option<u32> {
        self.tree.nearest(p, reach, |triangle| self.to_triangle(triangle, p).0 + self.half_thickness)
    }

    /// Signed distance and normal of the wall along one triangle.
    fn to_triangle(&self, triangle: u32, p: Vec3) -> (f32, Vec3) {
        let corners = self.corners(triangle);
        let normal = self.normals[triangle as usize];
        let height = normal.dot(p - corners[0]);
        let side = normal * 1.0_f32.copysign(height);
        let weights = on_triangle(p, corners);
        if weights.iter().all(|weight| *weight > 0.0) {
            return (height.abs() - self.half_thickness, side);
        }
        let away = p - (0..3).map(|i| corners[i] * weights[i]).sum::<Vec3>();
        (away.length() - self.half_thickness, away.normalize_or(side))
    }

    /// Whether the way from one point to another passes through a triangle.
    pub(super) fn is_between(&self, from: Vec3, to: Vec3) -> bool {
        self.tree.any_between([from, to], |triangle| {
            crate::contact::features::is_pierced(self.corners(triangle), [from, to])
        })
    }

    /// Whether it may come as near as `reach` to the box from `low` to `high`.
    pub(crate) fn may_reach(&self, low: Vec3, high: Vec3, reach: f32) -> bool {
        let reach = Vec3::splat(reach + self.half_thickness);
        self.tree.any_in(low - reach, high + reach)
    }

    /// Adds the triangles around which the surface is no farther than `reach` from `p`.
    pub(crate) fn add_triangles(&self, p: Vec3, reach: f32, found: &mut Vec<u32>) {
        let around = Vec3::splat(reach + self.half_thickness);
        self.tree.for_each_in(p - around, p + around, |triangle| {
            if self.to_triangle(triangle, p).0 <= reach {
                found.push(triangle);
            }
        });
    }

    /// Adds the vertices and the edges at which the surface is folded or ends, of the triangles that meet the box from `low` to
    /// `high`, each once.
    pub(crate) fn add_folds(&self, low: Vec3, high: Vec3, corners: &mut Vec<u32>, edges: &mut Vec<u32>) {
        self.tree.for_each_in(low, high, |triangle| {
            let triangle = triangle as usize;
            corners.extend(self.triangles[triangle].iter().filter(|i| self.is_corner[**i as usize]));
            edges.extend(self.edges_of[triangle].iter().filter(|edge| **edge != NONE));
        });
        for all in [corners, edges] {
            all.sort_unstable();
            all.dedup();
        }
    }

    /// The corners of a triangle, m.
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.vertices[i as usize])
    }

    /// Where a vertex is, m.
    pub(crate) fn vertex(&self, which: u32) -> Vec3 {
        self.vertices[which as usize]
    }

    /// Where an edge begins and ends, m.
    pub(crate) fn edge(&self, which: u32) -> [Vec3; 2] {
        self.edges[which as usize].map(|i| self.vertices[i as usize])
    }
}

/// The edges of one, of three and more, and of two triangles that are folded; and the numbers of these of each triangle.
#[cfg(feature = "parry")]
fn folds(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let sides = triangles.iter().enumerate().flat_map(|(triangle, [a, b, c])| {
        let sides = [[*a, *b, *c], [*b, *c, *a], [*c, *a, *b]].into_iter().enumerate();
        sides.map(move |(side, [a, b, opposite])| ([a.min(b), a.max(b)], (triangle, side), opposite))
    });
    let mut sides: Vec<([u32; 2], (usize, usize), u32)> = sides.collect();
    sides.sort_unstable();
    let (mut edges, mut edges_of) = (Vec::new(), vec![[NONE; 3]; triangles.len()]);
    for sharing in sides.chunk_by(|a, b| a.0 == b.0) {
        let [a, b] = sharing[0].0.map(|i| vertices[i as usize]);
        // Across the edge into a triangle.
        let along = (b - a).normalize_or_zero();
        let into = |opposite: u32| (vertices[opposite as usize] - a).reject_from_normalized(along).normalize_or_zero();
        if sharing.len() == 2 && into(sharing[0].2).dot(into(sharing[1].2)) <= -FLAT {
            continue;
        }
        for (_, (triangle, side), _) in sharing {
            edges_of[*triangle][*side] = edges.len() as u32;
        }
        edges.push(sharing[0].0);
    }
    (edges, edges_of)
}
