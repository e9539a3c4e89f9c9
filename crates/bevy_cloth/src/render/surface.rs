//! Normals and tangents of a deformed surface. Free functions on slices.

use bevy::prelude::*;

/// The least square of an edge's length that counts, m²: that of 10⁻¹² m.
const LEAST: f32 = 1e-24;

/// Fills `normals` (one for each particle) with the unit normals of `triangles` at `positions`. Each triangle counts by its area over
/// the squares of the two edges that meet at the particle (Max 1999): exact on spheres, however the triangles lie. A particle of no
/// area gets +z.
pub(crate) fn normals(triangles: &[[u32; 3]], positions: &[Vec3], normals: &mut [Vec3]) {
    normals.fill(Vec3::ZERO);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|slot| positions[slot as usize]);
        let normal = (b - a).cross(c - a);
        let [first, second, third] = [b - a, c - b, a - c].map(|edge| edge.length_squared().max(LEAST));
        for (slot, weight) in triangle.iter().zip([first * third, first * second, second * third]) {
            normals[*slot as usize] += normal / weight;
        }
    }
    for normal in normals {
        *normal = normal.normalize_or(Vec3::Z);
    }
}

/// How the direction of growing u follows from the edges of each triangle; constant while the surface deforms.
#[derive(Clone, Debug, Default)]
pub(crate) struct TangentFrame {
    /// For each triangle the factors of its two edges from the first vertex.
    factors: Vec<[f32; 2]>,
    /// Triangles of the back that have other vertices than those of the front, with what is theirs of `factors` behind those.
    backs: Vec<[u32; 3]>,
    /// For each vertex the sign of its bitangent (against growing v, as Bevy has it): `sign · normal × tangent`.
    signs: Vec<f32>,
}

impl TangentFrame {
    /// From texture coordinates, one for each vertex of `triangles`; empty without them. `backs` are the triangles of the back
    /// where these are others, or none.
    pub fn new(triangles: &[[u32; 3]], backs: &[[u32; 3]], uvs: &[Vec2]) -> Self {
        let of_back = triangles.iter().zip(backs).filter(|(front, back)| front != back);
        let backs: Vec<[u32; 3]> = of_back.map(|(_, back)| *back).collect();
        let mut signs = vec![1.0; uvs.len()];
        let factors = triangles.iter().chain(&backs).map(|triangle| {
            let [Some(a), Some(b), Some(c)] = triangle.map(|vertex| uvs.get(vertex as usize)) else { return [0.0; 2] };
            let (first, second) = (b - a, c - a);
            let area = first.perp_dot(second);
            for vertex in triangle {
                signs[*vertex as usize] = if area > 0.0 { -1.0 } else { 1.0 };
            }
            if area == 0.0 { [0.0; 2] } else { [second.y / area, -first.y / area] }
        });
        Self { factors: factors.collect(), signs, backs }
    }

    /// The sign of the bitangent of a vertex.
    pub fn sign(&self, vertex: usize) -> f32 {
        self.signs[vertex]
    }

    /// Fills `tangents` (one for each vertex) with unit tangents at right angles to the normals. `particle` says which
    /// particle each vertex follows.
    pub fn tangents(
        &self,
        triangles: &[[u32; 3]],
        particle: &[u32],
        positions: &[Vec3],
        normals: &[Vec3],
        tangents: &mut [Vec3],
    ) {
        tangents.fill(Vec3::ZERO);
        for (triangle, [first, second]) in triangles.iter().chain(&self.backs).zip(&self.factors) {
            let [a, b, c] = triangle.map(|vertex| positions[particle[vertex as usize] as usize]);
            let tangent = (b - a) * *first + (c - a) * *second;
            for vertex in triangle {
                tangents[*vertex as usize] += tangent;
            }
        }
        for (tangent, slot) in tangents.iter_mut().zip(particle) {
            let normal = normals[*slot as usize];
            let along = tangent.reject_from_normalized(normal).try_normalize();
            *tangent = along.unwrap_or_else(|| normal.any_orthonormal_vector());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in the xy plane, u along x, v down, two triangles.
    const CORNERS: [Vec3; 4] = [Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::ZERO, Vec3::X];
    const TRIANGLES: [[u32; 3]; 2] = [[0, 2, 1], [1, 2, 3]];

    #[test]
    fn a_flat_sheet_faces_plus_z() {
        let mut found = [Vec3::ZERO; 4];
        normals(&TRIANGLES, &CORNERS, &mut found);
        assert_eq!(found, [Vec3::Z; 4]);
    }

    #[test]
    fn a_triangle_of_no_area_does_not_spoil_its_normal() {
        let mut found = [Vec3::ZERO; 4];
        normals(&TRIANGLES, &[Vec3::ONE; 4], &mut found);
        assert_eq!(found, [Vec3::Z; 4]);
    }

    #[test]
    fn tangents_follow_u_and_bitangents_point_against_v() {
        let uvs = CORNERS.map(|corner| Vec2::new(corner.x, 1.0 - corner.y));
        let frame = TangentFrame::new(&TRIANGLES, &[], &uvs);
        let mut found = [Vec3::ZERO; 4];
        frame.tangents(&TRIANGLES, &[0, 1, 2, 3], &CORNERS, &[Vec3::Z; 4], &mut found);
        assert_eq!(found, [Vec3::X; 4]);
        // Growing v is down, so the bitangent is up.
        assert_eq!(Vec3::Z.cross(found[0]) * frame.sign(0), Vec3::Y);
    }

    #[test]
    fn a_sheet_without_spread_texture_coordinates_still_has_unit_tangents() {
        let frame = TangentFrame::new(&TRIANGLES, &[], &[Vec2::ZERO; 4]);
        let mut found = [Vec3::ZERO; 4];
        frame.tangents(&TRIANGLES, &[0, 1, 2, 3], &CORNERS, &[Vec3::Z; 4], &mut found);
        assert!(found.iter().all(|tangent| tangent.is_normalized() && tangent.dot(Vec3::Z).abs() < 1e-6));
    }
}
