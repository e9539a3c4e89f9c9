//! The curvature of a mesh that is no grid, triangle by triangle.
//!
//! ```text
//!      o───────o───────o       Through the corners of a triangle and of its three neighbours, laid flat beside it, goes one
//!       ╲     ╱ ╲     ╱        paraboloid. Over the middle of a side the slopes of those on either side are averaged; how
//!        ╲   ╱ → ╲   ╱         the slope changes from side to side is the triangle's curvature.
//!         o─────────o
//!          ╲   ↓   ╱           Exact for every surface of constant curvature, whichever way the mesh is cut; and since what
//!           ╲     ╱            one triangle gains by a slope its neighbour loses, no pattern of folds is cheaper than such a
//!            ╲   ╱             surface. Of hinges neither is true: they are up to 2.9 times too stiff and stiffer one way
//!             o                than another.
//! ```
//!
//! After the basic shell triangle of Oñate & Flores 2005, which takes slopes in the middle of sides.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::Topology;
use super::hinge::corner;
use super::strip::{NONE, neighbours};
use crate::Fabric;

/// What of the sum of squares of the three equations of a paraboloid is added to each: bounds what nearly dependent ones make of
/// a ripple, for a thousandth of the curvature.
const SINGULAR: f64 = 1e-4;

/// How far a paraboloid is lent on at the border, in triangles: to the corners, not down a ribbon.
const LENDINGS: usize = 2;

/// A mesh is flat where its curvature at rest times the size of a triangle is below this.
const FLAT: f64 = 1e-3;

/// Sums over particles: the weights of each, along weft, along warp and for twist.
type Curvatures = Vec<(u32, [f64; 3])>;

/// Curvature of the surface around one triangle, a vector each (in a sheet that does not stretch along its normal):
/// `Σ weights_i x_i`.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug)]
pub(crate) struct Curvature {
    corners: [u32; 3],
    /// Some twelve particles with their weights, which add up to 0: along weft, along warp, twist, 1/m².
    pub parts: Curvatures,
    /// The triangle's area, m².
    area: f64,
    /// The curvatures at rest, 1/m, cloth frame; 0 where it is flat.
    rest: [DVec3; 3],
}

impl Curvature {
    /// Whether it is flat at rest.
    pub fn is_flat(&self) -> bool {
        self.rest == [DVec3::ZERO; 3]
    }

    /// The curvatures of the particles at `x`.
    pub fn at(&self, x: impl Fn(u32) -> DVec3) -> [DVec3; 3] {
        let mut sum = [DVec3::ZERO; 3];
        // Relative to one of them, so that nothing is lost in large coordinates.
        let origin = x(self.corners[0]);
        for (slot, weights) in &self.parts {
            let place = x(*slot) - origin;
            for (sum, weight) in sum.iter_mut().zip(weights) {
                *sum += place * *weight;
            }
        }
        sum
    }

    /// Bending stiffness of each, N·m³, of `fabric`: twist counts twice, at the mean of warp and weft.
    pub fn stiffness(&self, fabric: &Fabric) -> [f64; 3] {
        [fabric.bend_weft, fabric.bend_warp, fabric.bend_weft + fabric.bend_warp]
            .map(|bend| self.area * f64::from(bend))
    }

    /// What the curvatures at `x` would be at rest: as long as they are in the rest shape and as they point now, so that
    /// bending back turns nothing; `now` are those at `x`.
    pub fn targets(&self, now: [DVec3; 3], x: impl Fn(u32) -> DVec3, rest: impl Fn(u32) -> DVec3) -> [DVec3; 3] {
        if self.is_flat() {
            return [DVec3::ZERO; 3];
        }
        let turn = frame(self.corners.map(x)) * frame(self.corners.map(rest)).transpose();
        core::array::from_fn(|i| target(now[i], turn * self.rest[i]))
    }
}

/// A vector as long as `rest` along `now`, to the side of `rest`, which is where it would point.
fn target(now: DVec3, rest: DVec3) -> DVec3 {
    /// So much of it points as it would: what is flat has no direction of its own.
    const STRAIGHT: f64 = 0.05;
    let cosine = now.dot(rest) / (now.length() * rest.length()).max(f64::MIN_POSITIVE);
    // Half-way to the other side it points as it would, so that nothing jumps where it changes sides.
    let side = now * (2.0 * cosine).clamp(-1.0, 1.0);
    (side + rest * STRAIGHT).normalize_or_zero() * rest.length()
}

/// Three axes of a triangle.
fn frame([a, b, c]: [DVec3; 3]) -> DMat3 {
    let along = (b - a).normalize_or_zero();
    let normal = along.cross(c - a).normalize_or_zero();
    DMat3::from_cols(along, normal.cross(along), normal)
}

/// That of every triangle of a mesh.
pub(crate) fn curvatures(topology: &Topology) -> Vec<Curvature> {
    let neighbours = neighbours(topology);
    let fits = fits(topology, &neighbours);
    let mut parts: Vec<Curvatures> = vec![Vec::with_capacity(12); topology.triangles.len()];
    for triangle in 0..topology.triangles.len() {
        for side in 0..3 {
            let here = Side::new(topology, triangle, side);
            let [i, j] = here.ends;
            add(&mut parts[triangle], i, here.lengthwise.map(|part| -part));
            add(&mut parts[triangle], j, here.lengthwise);
            let other = neighbours[triangle][side];
            if other == NONE {
                slope(topology, triangle, side, &fits[triangle], |slot, slope| {
                    add(&mut parts[triangle], slot, here.across.map(|part| part * slope));
                });
            } else if other > triangle as u32 {
                // For both of them; outward here is inward there.
                let other = other as usize;
                let [a, b] = here.ends.map(|slot| corner(topology.triangles[other], slot));
                let there = Side::new(topology, other, 3 - a - b);
                for (of, side, half) in [(triangle, side, 0.5), (other, 3 - a - b, -0.5)] {
                    slope(topology, of, side, &fits[of], |slot, slope| {
                        add(&mut parts[triangle], slot, here.across.map(|part| part * slope * half));
                        add(&mut parts[other], slot, there.across.map(|part| -part * slope * half));
                    });
                }
            }
        }
    }
    let made = |(triangle, parts)| {
        let flat = laid_flat(topology, triangle);
        let area = 0.5 * (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        let mut made = Curvature { corners: topology.triangles[triangle], parts, area, rest: [DVec3::ZERO; 3] };
        let folded = made.at(|slot| topology.rest[slot as usize].as_dvec3());
        if folded.iter().any(|bend| bend.length() * area.sqrt() > FLAT) {
            made.rest = folded;
        }
        made
    };
    parts.into_iter().enumerate().map(made).collect()
}

/// Adds weights to those of a particle.
fn add(parts: &mut Curvatures, slot: u32, weights: [f64; 3]) {
    match parts.iter_mut().find(|(known, _)| *known == slot) {
        Some((_, sum)) => sum.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight),
        None => parts.push((slot, weights)),
    }
}

/// A side of a triangle, opposite to one of its corners.
struct Side {
    ends: [u32; 2],
    /// What a slope of 1 across it, outward, adds to the triangle's curvatures.
    across: [f64; 3],
    /// What a difference of 1 between its ends adds.
    lengthwise: [f64; 3],
}

impl Side {
    fn new(topology: &Topology, triangle: usize, side: usize) -> Self {
        let [i, j] = [(side + 1) % 3, (side + 2) % 3];
        let (corners, flat) = (topology.triangles[triangle], laid_flat(topology, triangle));
        let area = 0.5 * (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        let (length, tangent) = ((flat[j] - flat[i]).length(), (flat[j] - flat[i]).normalize_or_zero());
        let normal = -tangent.perp();
        let sheared = 0.5 * (normal.x * tangent.y + normal.y * tangent.x);
        Self {
            ends: [corners[i], corners[j]],
            across: [normal.x * normal.x, normal.y * normal.y, normal.x * normal.y].map(|part| part * length / area),
            lengthwise: [normal.x * tangent.x, normal.y * tangent.y, sheared].map(|part| part / area),
        }
    }
}

/// The slope outward over the middle of a side of a triangle of the paraboloid with the curvatures `fit`, particle by
/// particle.
fn slope(topology: &Topology, triangle: usize, side: usize, fit: &Curvatures, mut each: impl FnMut(u32, f64)) {
    let flat = laid_flat(topology, triangle);
    let [i, j] = [(side + 1) % 3, (side + 2) % 3];
    let outward = -(flat[j] - flat[i]).normalize_or_zero().perp();
    let area = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
    // Of the plane through the corners: each has the slope of its own hat.
    let hat = |k: usize| (flat[(k + 2) % 3] - flat[(k + 1) % 3]).perp() / area;
    let mut bend = slope_of_monomials(flat[i].midpoint(flat[j]), outward);
    for (k, slot) in topology.triangles[triangle].into_iter().enumerate() {
        let slope = hat(k).dot(outward);
        bend -= monomials(flat[k]) * slope;
        each(slot, slope);
    }
    fit.iter().for_each(|(slot, weights)| each(*slot, bend.dot(DVec3::from_array(*weights))));
}

/// ½ u², ½ v², u v.
fn monomials(p: DVec2) -> DVec3 {
    DVec3::new(0.5 * p.x * p.x, 0.5 * p.y * p.y, p.x * p.y)
}

/// How they change at `p` along `direction`.
fn slope_of_monomials(p: DVec2, direction: DVec2) -> DVec3 {
    DVec3::new(p.x * direction.x, p.y * direction.y, p.x * direction.y + p.y * direction.x)
}

/// The corners of a triangle in its plane.
fn laid_flat(topology: &Topology, triangle: usize) -> [DVec2; 3] {
    let rest = topology.triangle_rest[triangle].as_dmat2();
    [DVec2::ZERO, rest.x_axis, rest.y_axis]
}

/// The curvatures of the paraboloids of all triangles. At the border, where a triangle has fewer than three neighbours to tell
/// of one, it has the mean of its neighbours'.
fn fits(topology: &Topology, neighbours: &[[u32; 3]]) -> Vec<Curvatures> {
    let count = topology.triangles.len();
    let mut fits: Vec<Curvatures> = (0..count).map(|triangle| fit(topology, triangle, neighbours[triangle])).collect();
    let mut known: Vec<bool> = neighbours.iter().map(|all| all.iter().all(|other| *other != NONE)).collect();
    for _ in 0..LENDINGS {
        let mut lent: Vec<(usize, Curvatures)> = Vec::new();
        for triangle in (0..count).filter(|triangle| !known[*triangle]) {
            let others = neighbours[triangle].into_iter().enumerate();
            let lenders: Vec<(usize, u32)> =
                others.filter(|(_, other)| *other != NONE && known[*other as usize]).collect();
            let share = 1.0 / lenders.len() as f64;
            let of = |(side, other): (usize, u32)| {
                let turn = turn(topology, triangle, side, other as usize);
                let turned = move |weights: [f64; 3]| turn_curvature(turn, weights).map(|weight| weight * share);
                fits[other as usize].iter().map(move |(slot, weights)| (*slot, turned(*weights)))
            };
            if !lenders.is_empty() {
                lent.push((triangle, lenders.into_iter().flat_map(of).collect()));
            }
        }
        for (triangle, fit) in lent {
            fits[triangle] = fit;
            known[triangle] = true;
        }
    }
    fits
}

/// What turns the plane of the triangle over a side into that of `triangle`.
fn turn(topology: &Topology, triangle: usize, side: usize, other: usize) -> DMat2 {
    let [i, j] = [(side + 1) % 3, (side + 2) % 3];
    let corners = topology.triangles[triangle];
    let [a, b] = [i, j].map(|i| corner(topology.triangles[other], corners[i]));
    let (here, there) = (laid_flat(topology, triangle), laid_flat(topology, other));
    let (to, from) = ((here[j] - here[i]).normalize_or_zero(), (there[b] - there[a]).normalize_or_zero());
    DMat2::from_cols(DVec2::new(from.dot(to), from.perp_dot(to)), DVec2::new(-from.perp_dot(to), from.dot(to)))
}

fn turn_curvature(turn: DMat2, [weft, warp, twist]: [f64; 3]) -> [f64; 3] {
    let turned = turn * DMat2::from_cols(DVec2::new(weft, twist), DVec2::new(twist, warp)) * turn.transpose();
    [turned.x_axis.x, turned.y_axis.y, turned.x_axis.y]
}

/// The curvatures of the paraboloid of one triangle.
fn fit(topology: &Topology, triangle: usize, neighbours: [u32; 3]) -> Curvatures {
    let corners = topology.triangles[triangle];
    let flat = laid_flat(topology, triangle);
    let rest = |slot: u32| topology.rest[slot as usize].as_dvec3();
    let mut slots = [NONE; 6];
    slots[..3].copy_from_slice(&corners);
    // By side: what its far corner's place off the plane is made of, and what it tells of the curvatures.
    let mut off = [[0.0; 6]; 3];
    let mut told = [DVec3::ZERO; 3];
    for side in (0..3).filter(|side| neighbours[*side] != NONE) {
        let [i, j] = [(side + 1) % 3, (side + 2) % 3];
        let others = topology.triangles[neighbours[side] as usize];
        let Some(far) = others.into_iter().find(|slot| *slot != corners[i] && *slot != corners[j]) else { continue };
        slots[3 + side] = far;
        // Laid flat over the side.
        let (along, to_far) = (rest(corners[j]) - rest(corners[i]), rest(far) - rest(corners[i]));
        let length = along.length();
        let part = to_far.dot(along) / (length * length);
        let height = (to_far - along * part).length();
        let direction = (flat[j] - flat[i]).normalize_or_zero();
        let place = flat[i] + (flat[j] - flat[i]) * part - direction.perp() * height;
        // Where the triangle's own plane has that place, by its corners.
        let opposite = (flat[side] - flat[i]).dot(direction.perp());
        let foot = (flat[side] - flat[i]).dot(direction) / length;
        let by_side = -height / opposite;
        let by_j = part - by_side * foot;
        off[side][3 + side] = 1.0;
        told[side] = monomials(place);
        for (corner, by) in [(i, 1.0 - by_side - by_j), (j, by_j), (side, by_side)] {
            off[side][corner] -= by;
            told[side] -= monomials(flat[corner]) * by;
        }
    }
    // All of one size, or a large neighbour would drown the others.
    for (off, told) in off.iter_mut().zip(&mut told).filter(|(_, told)| told.length_squared() > 0.0) {
        let norm = (*told * DVec3::new(1.0, 1.0, core::f64::consts::FRAC_1_SQRT_2)).length().max(f64::MIN_POSITIVE);
        *told /= norm;
        off.iter_mut().for_each(|part| *part /= norm);
    }
    let inverse = pseudo_inverse(told);
    let weights = |k: usize| (0..3).map(|side| inverse.col(side) * off[side][k]).sum::<DVec3>().to_array();
    slots.into_iter().enumerate().filter(|(_, slot)| *slot != NONE).map(|(k, slot)| (slot, weights(k))).collect()
}

/// The curvatures of least norm (a twist counts twice) that fulfil three equations, as far as these are independent: sides
/// at the border say nothing, and six points on a conic say one thing twice.
fn pseudo_inverse(rows: [DVec3; 3]) -> DMat3 {
    let scale = DVec3::new(1.0, 1.0, core::f64::consts::FRAC_1_SQRT_2);
    let transposed = DMat3::from_cols(rows[0] * scale, rows[1] * scale, rows[2] * scale);
    let gram = transposed.transpose() * transposed;
    let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
    if trace <= 0.0 {
        return DMat3::ZERO;
    }
    DMat3::from_diagonal(scale) * transposed * (gram + DMat3::from_diagonal(DVec3::splat(SINGULAR * trace))).inverse()
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::topology::MeshSource;

    /// A square metre of `n` × `n` quads whose inner corners are moved about, each cut one way or the other.
    pub(crate) fn irregular(n: u32) -> Topology {
        let noise = |i: u32| f32::from((i.wrapping_mul(2_654_435_761) >> 16) as u16) / 65_536.0 - 0.5;
        let at = |i: u32, j: u32| j * (n + 1) + i;
        let place = |i: u32, j: u32| {
            let inner = (1..n).contains(&i) && (1..n).contains(&j);
            let off = if inner { 0.5 * Vec2::new(noise(2 * at(i, j)), noise(2 * at(i, j) + 1)) } else { Vec2::ZERO };
            ((Vec2::new(i as f32, j as f32) + off) / n as f32).extend(0.0)
        };
        let positions: Vec<Vec3> =
            (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| place(i, j)).collect();
        let triangles: Vec<[u32; 3]> = (0..n)
            .flat_map(|j| (0..n).map(move |i| (i, j)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                if noise(7 * a + 3) > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
            })
            .collect();
        Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() })
            .expect("a mesh")
    }

    #[test]
    fn a_paraboloid_has_its_curvatures_in_every_triangle() {
        let topology = irregular(8);
        let all = curvatures(&topology);
        let bend = |slot: u32| {
            let p = topology.rest[slot as usize].as_dvec3();
            DVec3::new(p.x, p.y, p.x * p.x - 0.25 * p.y * p.y + 0.5 * p.x * p.y)
        };
        for curvature in &all {
            let [weft, warp, twist] = curvature.at(bend).map(|bend| bend.z);
            assert!(
                (weft - 2.0).abs() < 0.02 && (warp + 0.5).abs() < 0.02 && (twist.abs() - 0.5).abs() < 0.02,
                "{weft} {warp} {twist}"
            );
        }
        assert!(all.iter().all(Curvature::is_flat));
    }

    #[test]
    fn columns_of_very_different_width_do_not_drown_one_another() {
        let columns: Vec<f32> = (0..=8)
            .scan(0.0, |at, i| Some(core::mem::replace(at, *at + if i % 2 == 0 { 1.0 } else { 0.03 })))
            .collect();
        let positions: Vec<Vec3> =
            (0..=4).flat_map(|j| columns.iter().map(move |x| Vec3::new(*x, 0.3 * j as f32, 0.0))).collect();
        let at = |i: u32, j: u32| j * 9 + i;
        let triangles: Vec<[u32; 3]> = (0..4)
            .flat_map(|j| (0..8).map(move |i| (i, j)))
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect();
        let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
        let topology = Topology::from_mesh(source).expect("a mesh");
        let bend = |slot: u32| {
            let p = topology.rest[slot as usize].as_dvec3();
            DVec3::new(p.x, p.y, 0.5 * p.x * p.x)
        };
        for curvature in curvatures(&topology) {
            let [weft, warp, twist] = curvature.at(bend).map(|bend| bend.z);
            assert!((weft - 1.0).abs() < 0.02 && warp.abs() < 0.02 && twist.abs() < 0.02, "{weft} {warp} {twist}");
        }
    }

    #[test]
    fn what_is_flat_has_no_curvature_wherever_it_lies_and_a_roof_its_own() {
        let topology = irregular(6);
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.0, -0.5);
        let place = |slot: u32| turn * topology.rest[slot as usize].as_dvec3() + DVec3::new(1.0, 2.0, 3.0);
        for curvature in curvatures(&topology) {
            assert!(curvature.at(place).iter().all(|bend| bend.length() < 1e-4));
        }
        let roof = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.5, -0.5], [1.0, 0.5, -0.5]].map(Vec3::from);
        let roof = Topology::from_mesh(MeshSource { positions: &roof, uvs: &[], indices: &[0, 1, 2, 1, 0, 3] })
            .expect("a roof");
        let rest = |slot: u32| roof.rest[slot as usize].as_dvec3();
        let turned = |slot: u32| turn * rest(slot);
        let flat = |slot: u32| rest(slot) * DVec3::new(1.0, 1.0, 0.0);
        for curvature in curvatures(&roof) {
            assert!(!curvature.is_flat());
            let (now, bent_back) = (curvature.at(turned), curvature.at(flat));
            for (now, target) in now.iter().zip(curvature.targets(now, turned, rest)) {
                assert!(now.distance(target) < 1e-9, "{now} {target}");
            }
            // Flattened, it is bent against the fold, to the side it was folded to.
            let targets = curvature.targets(bent_back, flat, rest);
            assert!(
                targets
                    .iter()
                    .zip(&curvature.rest)
                    .all(|(target, rest)| (target.length() - rest.length()).abs() < 1e-9)
            );
        }
    }
}
