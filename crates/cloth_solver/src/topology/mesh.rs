//! Any triangle mesh.

use std::borrow::Cow;

use glam::{DVec2, DVec3, Mat2, Vec2, Vec3};

use super::grid::TAIL;
use super::mend::{Mended, Sound, mend};
use super::{Topology, hinge, orient::orient, weld::weld};
use crate::ClothError;
use crate::lanes::LANES;

/// Vertices closer than this fraction of the bounding box's diagonal are one particle, and a triangle of less height
/// is degenerate. An order of magnitude above the rounding of an f32 coordinate as large as the box.
const WELD_TOLERANCE: f64 = 1e-6;

/// Where the unit normal's y is larger than this, the cosine of 45°, the warp follows z instead of y.
const HORIZONTAL: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// A triangle mesh as a renderer holds it.
#[derive(Clone, Copy, Debug)]
pub struct MeshSource<'a> {
    /// Vertex positions, m. The diagonal of their bounding box lies in 1e-4..=1e5 m.
    pub positions: &'a [Vec3],
    /// Texture coordinates, one per vertex or empty; the warp runs along v.
    pub uvs: &'a [Vec2],
    /// Three vertex indices per triangle.
    pub indices: &'a [u32],
}

impl Topology {
    /// A cloth from any triangle mesh; vertices at the same place (within 1e-6 of the bounding box's diagonal) are
    /// welded into one particle. Triangle `i` of the cloth is triangle `i` of the mesh, if nothing had to be mended.
    ///
    /// - Particles are numbered in the order in which triangles use them first, which keeps neighbours close in memory.
    /// - Triangles wound against their neighbours are turned over, see [`Topology::hinges`]. A Möbius strip keeps one
    ///   seam where no winding agrees; its hinges there take the front of the triangle that comes first.
    /// - The warp of a triangle runs along the gradient of v. Where texture coordinates are missing or degenerate it is
    ///   the y axis, or for triangles flatter than 45° the z axis, projected on the triangle.
    /// - What is wrong with a mesh and can be put right is mended, and told by [`Topology::mended`].
    ///
    /// # Errors
    /// If the index list is no triangle list or names vertices that do not exist; if the position of a vertex that is used is
    /// not finite; if no triangle has an area once vertices are welded.
    pub fn from_mesh(source: MeshSource<'_>) -> Result<Self, ClothError> {
        let used = validate(&source)?;
        let mut mended =
            Mended { unused_vertices: used.iter().filter(|used| !**used).count() as u32, ..Mended::default() };
        let positions = used_positions(source.positions, &used);
        let tolerance = WELD_TOLERANCE * diagonal(&positions)?;
        let first = weld(&positions, tolerance);
        let (corners, _) = source.indices.as_chunks::<3>();
        let Sound { vertices: mut triangle_vertices, backs } =
            mend(corners, &positions, &first, tolerance, &mut mended);
        if triangle_vertices.is_empty() {
            let place = |vertex: u32| positions[first[vertex as usize] as usize].as_dvec3();
            return Err(degenerate(corners[0].map(place), tolerance));
        }
        let (particle, vertices) = particles_by_first_use(&first, triangle_vertices.as_flattened());
        let mut triangles: Vec<[u32; 3]> = (triangle_vertices.iter())
            .map(|corners| corners.map(|v| particle[v as usize].unwrap_or_default()))
            .collect();
        let mut rest: Vec<Vec3> = vertices.iter().map(|v| positions[*v as usize]).collect();
        let sides = hinge::sides(&triangles);
        mended.shared_edges = hinge::by_edge(&sides).filter(|shared| shared.len() > 2).count() as u32;
        let mut triangle_backs = if backs.is_empty() { Vec::new() } else { triangle_vertices.clone() };
        let twins = backs.iter().enumerate().filter_map(|(triangle, back)| Some((triangle, (*back)?)));
        twins.for_each(|(triangle, back)| triangle_backs[triangle] = back);
        orient(&mut triangles, &rest, &sides, |triangle| {
            triangle_vertices[triangle].swap(1, 2);
            if let Some(back) = triangle_backs.get_mut(triangle) {
                back.swap(1, 2);
            }
            if backs.get(triangle).is_some_and(Option::is_some) {
                // The double is wound as the others are.
                core::mem::swap(&mut triangle_vertices[triangle], &mut triangle_backs[triangle]);
            } else {
                mended.turned_triangles += 1;
            }
        });
        let warps = triangle_vertices.iter().map(|corners| uv_warp(&source, *corners));
        let triangle_rest: Vec<Mat2> = (triangles.iter().zip(warps))
            .map(|(triangle, warp)| flattened(triangle.map(|p| rest[p as usize].as_dvec3()), warp))
            .collect();
        let (hinges, hinge_triangles): (Vec<_>, Vec<_>) = hinge::hinges(&triangles, &rest, &sides).unzip();
        let angle = |hinge: &[u32; 4]| {
            let [a, b, c, d] = hinge.map(|p| rest[p as usize]);
            hinge::hinge_angle(a, b, c, d)
        };
        let hinge_rest = hinges.iter().map(angle).collect();
        let mut area = vec![0.0; rest.len()];
        for (triangle, at_rest) in triangles.iter().zip(&triangle_rest) {
            triangle.iter().for_each(|p| area[*p as usize] += at_rest.determinant() / 6.0);
        }
        let joints = hinge::joints(&triangles, rest.len(), &sides);
        let slots = rest.len().next_multiple_of(LANES) + TAIL;
        rest.resize(slots, rest.last().copied().unwrap_or_default());
        area.resize(slots, 0.0);
        let no_particle = slots as u32 - 1;
        Ok(Self {
            edges: hinge::by_edge(&sides).map(|shared| shared[0].edge).collect(),
            free: slots as u32,
            weave: None,
            original_triangles: triangles.len() as u32,
            rest,
            area,
            triangles,
            triangle_vertices,
            triangle_backs,
            triangle_rest,
            hinges,
            hinge_triangles,
            hinge_rest,
            vertex_particle: (particle.iter().zip(&used).zip(source.positions.iter().zip(positions.iter())))
                .map(|((particle, used), (given, taken))| particle.filter(|_| *used || given == taken))
                .map(|particle| particle.unwrap_or(no_particle))
                .collect(),
            joints,
            mended,
            grid: None,
            quads: None,
            squares: Vec::new(),
            is_warp_told: corners.iter().any(|corners| uv_warp(&source, *corners).is_some()),
        })
    }
}

/// What can be said without looking at the geometry; which vertices are used.
fn validate(source: &MeshSource<'_>) -> Result<Vec<bool>, ClothError> {
    let MeshSource { positions, uvs, indices } = source;
    if indices.is_empty() {
        return Err(ClothError::NoTriangles { field: "MeshSource::indices" });
    }
    if !indices.len().is_multiple_of(3) {
        return Err(ClothError::NotTriangleList { reason: format!("{} indices, not a multiple of 3", indices.len()) });
    }
    if !uvs.is_empty() && uvs.len() != positions.len() {
        let [field, allowed] = ["MeshSource::uvs.len()", "0 or the number of vertices"];
        return Err(ClothError::OutOfRange { field, value: uvs.len() as f32, allowed });
    }
    let vertices = positions.len();
    let mut used = vec![false; vertices];
    for (i, index) in indices.iter().enumerate() {
        let Some(used) = used.get_mut(*index as usize) else {
            return Err(ClothError::IndexOutOfRange { triangle: i / 3, index: *index, vertices });
        };
        *used = true;
    }
    let is_wrong = |vertex: &usize| used[*vertex] && !positions[*vertex].is_finite();
    match (0..vertices).find(is_wrong) {
        Some(vertex) => Err(ClothError::VertexNotFinite { vertex, position: positions[vertex] }),
        None => Ok(used),
    }
}

/// The positions, those of unused vertices replaced by that of a used one where they are not finite or beyond all that is used:
/// nothing about the cloth depends on them.
fn used_positions<'a>(positions: &'a [Vec3], used: &[bool]) -> Cow<'a, [Vec3]> {
    let of_used = || positions.iter().zip(used).filter(|(_, used)| **used).map(|(position, _)| *position);
    let (min, max) = of_used().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)));
    let is_inside = |p: &Vec3| p.cmpge(min).all() && p.cmple(max).all();
    if positions.iter().all(is_inside) {
        return Cow::Borrowed(positions);
    }
    let any = of_used().next().unwrap_or_default();
    Cow::Owned(positions.iter().map(|p| if is_inside(p) { *p } else { any }).collect())
}

/// The diagonal of the bounding box, m.
fn diagonal(positions: &[Vec3]) -> Result<f64, ClothError> {
    let min = positions.iter().copied().reduce(Vec3::min).unwrap_or_default().as_dvec3();
    let max = positions.iter().copied().reduce(Vec3::max).unwrap_or_default().as_dvec3();
    let diagonal = min.distance(max);
    ClothError::check("diagonal of MeshSource::positions", diagonal as f32, 1e-4..=1e5, "1e-4..=1e5 m")?;
    Ok(diagonal)
}

/// The error for a mesh that has no triangle higher than `tolerance`, m, told of its first one.
fn degenerate([a, b, c]: [DVec3; 3], tolerance: f64) -> ClothError {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let area = 0.5 * (b - a).cross(c - a).length();
    // Two corners welded together have no length either, so the longest side alone would allow anything.
    let smallest = 0.5 * longest.max(tolerance) * tolerance;
    ClothError::DegenerateTriangle { triangle: 0, area: area as f32, smallest: smallest as f32 }
}

/// The particle of each vertex, if it has one, and the vertex that stands for each particle.
fn particles_by_first_use(first: &[u32], indices: &[u32]) -> (Vec<Option<u32>>, Vec<u32>) {
    let mut particle = vec![None; first.len()];
    let mut vertices = Vec::new();
    for index in indices {
        let vertex = first[*index as usize];
        particle[vertex as usize].get_or_insert_with(|| {
            vertices.push(vertex);
            vertices.len() as u32 - 1
        });
    }
    (first.iter().map(|vertex| particle[*vertex as usize]).collect(), vertices)
}

/// The direction up which v falls fastest in the mesh's triangle `corners` (in a texture v runs down, in a grid of
/// rows the warp runs up; the warp has no sign), or `None` without usable texture coordinates.
fn uv_warp(source: &MeshSource<'_>, corners: [u32; 3]) -> Option<DVec3> {
    if source.uvs.is_empty() {
        return None;
    }
    let [t0, t1, t2] = corners.map(|v| source.uvs[v as usize].as_dvec2());
    let [p0, p1, p2] = corners.map(|v| source.positions[v as usize].as_dvec3());
    let (side1, side2): (DVec2, DVec2) = (t1 - t0, t2 - t0);
    let largest = t0.abs().max(t1.abs()).max(t2.abs()).max_element();
    let rounding = f64::from(f32::EPSILON) * largest * (side1.length() + side2.length());
    // Written so that a NaN is not usable.
    let usable = side1.perp_dot(side2).abs() > rounding;
    let (edge1, edge2) = (p1 - p0, p2 - p0);
    let normal = edge1.cross(edge2);
    let gradient = (edge2.cross(normal) * side1.y + normal.cross(edge1) * side2.y) / normal.length_squared();
    (usable && gradient.is_finite()).then_some(-gradient)
}

/// The two edges of a triangle at rest as columns, x along the weft and y along the warp.
pub(super) fn flattened([p0, p1, p2]: [DVec3; 3], warp: Option<DVec3>) -> Mat2 {
    let normal = (p1 - p0).cross(p2 - p0).normalize_or_zero();
    let axis = if normal.y.abs() > HORIZONTAL { DVec3::Z } else { DVec3::Y };
    let warp = warp.unwrap_or(axis).reject_from_normalized(normal).normalize_or_zero();
    // This order makes the determinant positive on whichever side the warp points.
    let weft = warp.cross(normal);
    let flat = |edge: DVec3| Vec2::new(edge.dot(weft) as f32, edge.dot(warp) as f32);
    Mat2::from_cols(flat(p1 - p0), flat(p2 - p0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(positions: &[[f32; 3]], uvs: &[[f32; 2]], indices: &[u32]) -> Result<Topology, ClothError> {
        let positions: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let uvs: Vec<Vec2> = uvs.iter().copied().map(Vec2::from).collect();
        Topology::from_mesh(MeshSource { positions: &positions, uvs: &uvs, indices })
    }

    const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    const TWO: [u32; 6] = [0, 1, 2, 0, 2, 3];

    #[test]
    fn a_square_becomes_four_particles_five_edges_and_one_hinge_with_padding_behind() {
        let square = mesh(&SQUARE, &[], &TWO).unwrap();
        assert_eq!(square.slots(), 8 + TAIL);
        assert_eq!(square.particles().collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert!(square.rest[4..].iter().all(|p| *p == square.rest[3]));
        assert_eq!(square.edges, [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        assert_eq!(square.hinges, [[2, 0, 1, 3]]);
        assert_eq!(square.hinge_rest, [0.0]);
        assert!((square.area.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!((square.area[0] - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(square.grid, None);
    }

    #[test]
    fn a_single_triangle_is_a_cloth_and_two_back_to_back_have_no_hinge() {
        let one = mesh(&SQUARE[..3], &[], &TWO[..3]).unwrap();
        assert_eq!((one.particle_count(), one.edges.len(), one.hinges.len()), (3, 3, 0));
        let doubled = mesh(&SQUARE[..3], &[], &[0, 1, 2, 2, 1, 0]).unwrap();
        assert_eq!((doubled.particle_count(), doubled.edges.len(), doubled.hinges.len()), (3, 3, 0));
        assert_eq!((doubled.triangles.len(), doubled.mended.doubled_triangles), (1, 1));
    }

    #[test]
    fn particles_are_numbered_as_triangles_use_them() {
        let square = mesh(&SQUARE, &[], &[3, 1, 2, 3, 0, 1]).unwrap();
        assert_eq!(square.vertex_particle, [3, 1, 2, 0]);
        assert_eq!(square.triangles, [[0, 1, 2], [0, 3, 1]]);
    }

    #[test]
    fn a_ridge_is_positive_a_valley_negative_and_a_closed_box_all_ridges() {
        let fold = |depth: f32| {
            let positions = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, 0.0], [0.0, 0.5, depth]];
            mesh(&positions, &[], &[0, 1, 2, 1, 0, 3]).unwrap().hinge_rest[0]
        };
        assert!((fold(-1.0) - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!((fold(1.0) + core::f32::consts::FRAC_PI_2).abs() < 1e-6);
        let corners: Vec<[f32; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|x| x as f32)).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let indices: Vec<u32> = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
        let cube = mesh(&corners, &[], &indices).unwrap();
        assert_eq!(cube.particle_count() + cube.triangles.len(), cube.edges.len() + 2);
        let folds = cube.hinge_rest.iter().filter(|angle| **angle > 1.5).count();
        assert_eq!((folds, cube.hinges.len()), (12, 18));
    }

    #[test]
    fn the_warp_follows_v_and_without_it_the_y_axis_or_the_z_axis_on_the_flat() {
        let along = |topology: &Topology| {
            // The first triangle's first edge is +x of the mesh.
            let edge = topology.triangle_rest[0].x_axis;
            (edge.x.abs().round(), edge.y.abs().round())
        };
        let (weft, warp) = ((1.0, 0.0), (0.0, 1.0));
        let upright = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let turned = upright.map(|[u, v]| [v, u]);
        assert_eq!(along(&mesh(&SQUARE, &upright, &TWO).unwrap()), weft);
        assert_eq!(along(&mesh(&SQUARE, &turned, &TWO).unwrap()), warp);
        assert_eq!(along(&mesh(&SQUARE, &[], &TWO).unwrap()), weft);
        let flat = SQUARE.map(|[x, y, _]| [x, 0.0, -y]);
        assert_eq!(along(&mesh(&flat, &[], &TWO).unwrap()), weft);
        for useless in [[[0.5, 0.5]; 4], [[f32::NAN; 2]; 4], upright.map(|[u, _]| [u, u])] {
            assert_eq!(along(&mesh(&SQUARE, &useless, &TWO).unwrap()), weft);
        }
        assert!(mesh(&SQUARE, &turned, &TWO).unwrap().triangle_rest.iter().all(|rest| rest.determinant() > 0.0));
    }

    #[test]
    fn every_fault_of_a_mesh_has_an_error_of_its_own() {
        let empty = mesh(&[], &[], &[]);
        assert_eq!(empty, Err(ClothError::NoTriangles { field: "MeshSource::indices" }));
        assert!(matches!(mesh(&SQUARE, &[], &TWO[..5]), Err(ClothError::NotTriangleList { .. })));
        let outside = mesh(&SQUARE, &[], &[0, 1, 2, 0, 2, 4]);
        assert_eq!(outside, Err(ClothError::IndexOutOfRange { triangle: 1, index: 4, vertices: 4 }));
        let mut nan = SQUARE;
        nan[2][1] = f32::NAN;
        assert!(matches!(mesh(&nan, &[], &TWO), Err(ClothError::VertexNotFinite { vertex: 2, .. })));
        let few_uvs = mesh(&SQUARE, &[[0.0; 2]; 3], &TWO);
        assert!(matches!(few_uvs, Err(ClothError::OutOfRange { field: "MeshSource::uvs.len()", .. })));
        let point = mesh(&[[1.0; 3]; 3], &[], &[0, 1, 2]);
        assert!(matches!(point, Err(ClothError::OutOfRange { .. })));
    }

    #[test]
    fn a_triangle_without_area_is_left_out_and_a_mesh_without_any_other_refused() {
        for fourth in [SQUARE[2], [0.5, 0.5, 0.0], [1.0, 1.0, 1e-6], [0.3, 0.3, 5e-7]] {
            let mended = mesh(&[SQUARE[0], SQUARE[1], SQUARE[2], fourth], &[], &TWO).unwrap();
            assert_eq!(mended.mended, Mended { flat_triangles: 1, ..Mended::default() }, "{fourth:?}");
            assert!(mended.triangle_rest.iter().all(|rest| rest.determinant() > 0.0));
            let refused = mesh(&[SQUARE[0], SQUARE[1], SQUARE[2], fourth], &[], &TWO[3..]);
            assert!(matches!(refused, Err(ClothError::DegenerateTriangle { triangle: 0, .. })), "{fourth:?}");
        }
        assert!(mesh(&[SQUARE[0], SQUARE[1], SQUARE[2], [0.5, 0.5, 1e-3]], &[], &TWO).unwrap().mended.is_nothing());
        assert_eq!(mesh(&SQUARE, &[], &[0, 1, 2, 2, 2, 3]).unwrap().mended.flat_triangles, 1);
    }

    #[test]
    fn an_unused_vertex_keeps_its_number_and_has_no_particle_unless_it_stands_on_one() {
        for lone in [[0.5, 0.5, 0.0], [9.0, 0.0, 0.0], [f32::NAN; 3], [1e30; 3]] {
            let positions = [lone, SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[3], SQUARE[3]];
            let mended = mesh(&positions, &[], &TWO.map(|i| i + 1)).unwrap();
            assert_eq!(mended.mended, Mended { unused_vertices: 2, ..Mended::default() });
            assert!(!mended.is_particle(mended.vertex_particle[0]));
            assert_eq!(mended.vertex_particle[1..], [0, 1, 2, 3, 3]);
            assert_eq!(mended.rest[..4], SQUARE.map(Vec3::from));
        }
    }

    #[test]
    fn the_first_double_is_the_back_even_where_it_comes_first() {
        // Two triangles, each with a double of other vertices wound the other way; of the second the double comes first.
        let positions: Vec<[f32; 3]> = SQUARE.into_iter().chain(SQUARE).collect();
        let doubled = mesh(&positions, &[], &[0, 1, 2, 4, 7, 6, 4, 6, 5, 0, 2, 3]).unwrap();
        assert_eq!(doubled.mended, Mended { doubled_triangles: 2, ..Mended::default() });
        let (fronts, backs) = (&doubled.triangle_vertices, &doubled.triangle_backs);
        assert!(fronts.as_flattened().iter().all(|vertex| *vertex < 4) && fronts.len() == 2);
        for (front, back) in fronts.iter().zip(backs) {
            assert_eq!(front.map(|vertex| vertex + 4), *back);
        }
        assert_eq!(doubled.hinges.len(), 1);
    }

    #[test]
    fn over_an_edge_of_three_triangles_those_two_bend_that_go_on_straightest() {
        // Vertex 0 is unlike particle 0, and 4 and 5 double 1 and 2.
        let positions = [
            [9.0, 9.0, 9.0],
            SQUARE[0],
            SQUARE[1],
            [0.5, 1.0, 0.0],
            SQUARE[0],
            SQUARE[1],
            [0.5, 0.0, 1.0],
            [0.5, -1.0, 0.0],
        ];
        let made = mesh(&positions, &[], &[3, 1, 2, 4, 5, 6, 1, 2, 7, 0, 3, 6]).unwrap();
        let of = |vertex: u32| made.vertex_particle[vertex as usize];
        let seam: Vec<_> = (made.hinges.iter().zip(&made.hinge_triangles))
            .filter(|([a, b, ..], _)| [*a.min(b), *a.max(b)] == [of(1).min(of(2)), of(1).max(of(2))])
            .map(|([_, _, c, d], triangles)| ([*c, *d], *triangles))
            .collect();
        assert_eq!(seam, [([of(3), of(7)], [0, 2])]);
        assert_eq!(made.mended.shared_edges, 1);
        assert_eq!(made.edges.iter().filter(|edge| edge.contains(&of(1)) && edge.contains(&of(2))).count(), 1);
    }
}
