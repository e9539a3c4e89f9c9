//! Which triangles share an edge, at which angle, and how hard it is to change that angle.

use glam::{Vec2, Vec3};

use super::Topology;
use crate::Fabric;

/// One side of one triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The particles at its ends, the smaller first.
    pub edge: [u32; 2],
    /// The triangle.
    pub triangle: u32,
    /// The triangle's particle off the edge.
    pub opposite: u32,
}

/// The sides of `triangle`, whose corners these are.
pub(super) fn sides_of(triangle: u32, [a, b, c]: [u32; 3]) -> [Side; 3] {
    [[a, b, c], [b, c, a], [c, a, b]].map(|[p, q, opposite]| Side { edge: [p.min(q), p.max(q)], triangle, opposite })
}

/// All sides of all triangles, sorted by edge and then by triangle.
pub(super) fn sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides: Vec<Side> =
        (0..triangles.len() as u32).flat_map(|at| sides_of(at, triangles[at as usize])).collect();
    sides.sort_unstable();
    sides
}

/// The sides edge by edge: one side at the border, two inside, more where the surface is not a manifold.
pub(super) fn by_edge(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|s, t| s.edge == t.edge)
}

/// Which of the three corners of `triangle` the particle `particle` is.
pub(super) fn corner(triangle: [u32; 3], particle: u32) -> usize {
    usize::from(triangle[1] == particle) + 2 * usize::from(triangle[2] == particle)
}

/// The ends of `side` in the order in which its triangle runs from one to the other.
pub(super) fn direction(triangles: &[[u32; 3]], side: &Side) -> [u32; 2] {
    let triangle = triangles[side.triangle as usize];
    let corner = corner(triangle, side.opposite);
    [triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]]
}

/// The hinges, as [`Topology::hinges`] holds them, each with the triangles of `c` and of `d`; in the order of the
/// edges. `c` belongs to the triangle that comes first. `rest` is the place of each particle.
pub(super) fn hinges(
    triangles: &[[u32; 3]],
    rest: &[Vec3],
    sides: &[Side],
) -> impl Iterator<Item = ([u32; 4], [u32; 2])> {
    by_edge(sides).flat_map(move |shared| pairs(shared, rest)).map(move |[first, second]| {
        let [a, b] = direction(triangles, &first);
        ([a, b, first.opposite, second.opposite], [first.triangle, second.triangle])
    })
}

/// Which triangles bend against each other over the edge whose sides these are. Of three and more those two that go on
/// straightest, or of equally straight ones the first, then the next two; one may be left, which swings freely.
pub(super) fn pairs(shared: &[Side], rest: &[Vec3]) -> impl Iterator<Item = [Side; 2]> + use<> {
    let two = if let [first, second] = shared { Some([*first, *second]) } else { None };
    let several = if shared.len() > 2 { straightest(shared, rest) } else { Vec::new() };
    two.into_iter().chain(several)
}

fn straightest(shared: &[Side], rest: &[Vec3]) -> Vec<[Side; 2]> {
    /// Cosines that differ by less are equally straight: a pocket that lies on its shirt goes on as that does.
    const ALIKE: f32 = 1e-3;
    let [a, b] = shared[0].edge.map(|end| rest[end as usize]);
    let along = (b - a).normalize_or_zero();
    let mut left: Vec<(Side, Vec3)> = (shared.iter())
        .map(|side| (*side, (rest[side.opposite as usize] - a).reject_from(along).normalize_or_zero()))
        .collect();
    let mut pairs = Vec::new();
    while left.len() > 1 {
        let mut best = (0, 1, f32::INFINITY);
        for i in 0..left.len() {
            for k in i + 1..left.len() {
                let cosine = left[i].1.dot(left[k].1);
                if cosine < best.2 - ALIKE {
                    best = (i, k, cosine);
                }
            }
        }
        let second = left.remove(best.1).0;
        pairs.push([left.remove(best.0).0, second]);
    }
    pairs
}

/// The particles at which several fans of triangles meet: those of one fan hang together by edges there.
pub(super) fn joints(triangles: &[[u32; 3]], particles: usize, sides: &[Side]) -> Vec<u32> {
    // Each corner of each triangle leads to another one of its fan, or to itself.
    let mut leads: Vec<u32> = (0..3 * triangles.len() as u32).collect();
    let root = |leads: &[u32], mut at: u32| {
        while leads[at as usize] != at {
            at = leads[at as usize];
        }
        at
    };
    let corner_of = |side: &Side, end: u32| 3 * side.triangle + corner(triangles[side.triangle as usize], end) as u32;
    for shared in by_edge(sides) {
        for end in shared[0].edge {
            for other in &shared[1..] {
                let [a, b] = [&shared[0], other].map(|side| root(&leads, corner_of(side, end)));
                leads[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let mut fans = vec![0_u8; particles];
    for (at, particle) in triangles.as_flattened().iter().enumerate() {
        let fans = &mut fans[*particle as usize];
        *fans = fans.saturating_add(u8::from(leads[at] == at as u32));
    }
    (0..particles as u32).filter(|particle| fans[*particle as usize] > 1).collect()
}

/// The angle between the triangles `a b c` and `b a d` over their edge `a b`, rad, in −π..=π: 0 flat, positive where
/// the front faces turn away from each other (a ridge seen from the front), negative in a valley.
///
/// ```text
///     b          The front of `a b c` decides what front is: on a one-sided surface, where no choice of windings
///   ／│＼        agrees across every edge, the angle across the seam is still that of the fold one sees there.
///  c  │  d
///   ＼│／
///     a
/// ```
///
/// 0 where a triangle has no area.
pub(crate) fn hinge_angle(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f32 {
    // Of unit length, because the fifth power of a micrometre leaves the range of f32.
    let edge = (b - a).normalize_or_zero();
    let normal_c = edge.cross(c - a);
    let normal_d = (d - a).cross(edge);
    normal_c.cross(normal_d).dot(edge).atan2(normal_c.dot(normal_d))
}

impl Topology {
    /// Bending stiffness of each hinge of `fabric`, N·m per rad²: `D b / s`, so that a hinge turned by θ from its rest
    /// angle holds the energy `½ (D b / s) θ²`.
    ///
    /// `b` is the rest length of the hinge and `s = (A_c + A_d) / b` the distance it speaks for, the mean height of
    /// its two triangles: the discrete-shell weight `3 b² / (A_c + A_d) · D / 6` on both sides of `½`. `D` lies between
    /// the stiffness for curvature along the warp and along the weft as the square of the direction cosines of the
    /// curvature, which runs across the hinge; the two triangles are averaged.
    pub fn hinge_stiffness(&self, fabric: &Fabric) -> Vec<f32> {
        (0..self.hinges.len()).map(|hinge| self.stiffness_of(hinge, fabric)).collect()
    }

    /// That of one hinge.
    pub(crate) fn stiffness_of(&self, hinge: usize, fabric: &Fabric) -> f32 {
        let ([a, b, ..], sharing) = (self.hinges[hinge], self.hinge_triangles[hinge]);
        let [c, d] = sharing.map(|triangle| self.side_in_triangle(triangle, a, b));
        let bend = |along: Vec2| {
            let cosines = along * along / along.length_squared();
            // A hinge along the weft (x) bends the warp.
            fabric.bend_warp * cosines.x + fabric.bend_weft * cosines.y
        };
        let area: f32 = sharing.iter().map(|t| 0.5 * self.triangle_rest[*t as usize].determinant()).sum();
        0.5 * (bend(c) + bend(d)) * c.length_squared() / area
    }

    /// The rest edge from particle `a` to particle `b` of `triangle`, in the triangle's weft and warp coordinates, m.
    fn side_in_triangle(&self, triangle: u32, a: u32, b: u32) -> Vec2 {
        let rest = self.triangle_rest[triangle as usize];
        let place = |particle| match corner(self.triangles[triangle as usize], particle) {
            0 => Vec2::ZERO,
            1 => rest.x_axis,
            _ => rest.y_axis,
        };
        place(b) - place(a)
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::PI;

    use super::*;
    use crate::topology::Resolution;

    /// Edge up the y axis, `c` to the left, `d` to the right and turned back by `angle` about the edge.
    fn folded(angle: f32) -> f32 {
        hinge_angle(Vec3::ZERO, Vec3::Y, Vec3::NEG_X, Vec3::new(angle.cos(), 0.3, -angle.sin()))
    }

    #[test]
    fn a_flat_hinge_has_no_angle_and_a_ridge_seen_from_the_front_a_positive_one() {
        assert_eq!(folded(0.0), 0.0);
        for angle in [1e-4, 0.1, 1.0, PI / 2.0, 3.0] {
            assert!((folded(angle) - angle).abs() < 1e-6 * (1.0 + angle), "{angle}");
            assert!((folded(-angle) + angle).abs() < 1e-6 * (1.0 + angle), "{angle}");
        }
        assert!((folded(PI).abs() - PI).abs() < 1e-6);
    }

    #[test]
    fn a_hinge_angle_does_not_depend_on_which_side_comes_first() {
        let [a, b, c, d] = [[0.1, 0.2, 0.3], [0.4, 1.5, -0.2], [-1.0, 0.7, 0.1], [0.8, 0.4, 0.9]].map(Vec3::from);
        assert!((hinge_angle(a, b, c, d) - hinge_angle(b, a, d, c)).abs() < 1e-6);
    }

    #[test]
    fn a_hinge_without_area_has_no_angle() {
        assert_eq!(hinge_angle(Vec3::ONE, Vec3::ONE, Vec3::X, Vec3::Y), 0.0);
        assert_eq!(hinge_angle(Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::Y), 0.0);
    }

    #[test]
    fn bending_a_rectangle_into_a_cylinder_costs_half_d_curvature_squared_per_area() {
        // Every hinge along the weft turns by κ·spacing; the diagonals stay flat.
        let topology = Topology::rectangle(Vec2::new(0.6, 0.8), Resolution::Spacing(0.1)).unwrap();
        let fabric = Fabric { bend_warp: 2e-3, bend_weft: 0.0, ..Fabric::default() };
        let [curvature, spacing] = [0.5_f32, 0.1];
        let energy: f32 = (topology.hinges.iter().zip(topology.hinge_stiffness(&fabric)))
            .filter(|(hinge, _)| topology.rest[hinge[0] as usize].y == topology.rest[hinge[1] as usize].y)
            .map(|(_, stiffness)| 0.5 * stiffness * (curvature * spacing).powi(2))
            .sum();
        let inner_area = 0.6 * 0.7;
        assert!((energy / (0.5 * 2e-3 * curvature * curvature * inner_area) - 1.0).abs() < 1e-4, "{energy}");
    }
}
