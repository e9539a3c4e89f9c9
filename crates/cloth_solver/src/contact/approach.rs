//! A solid that is suddenly deep inside a cloth: one that was spawned there or put over it, or a cloth that was reset into it.
//!
//! From there no particle can tell on which side of the solid it belongs: pushed out each its nearest way, a cloth ends up on both
//! sides, stretched around the solid for ever. So the solid is taken away along the direction in which it is soonest clear of the whole
//! cloth, and comes back from there, slowly, as any solid that moves: nothing passes it. What it pushes aside gets no speed from it.

use glam::Vec3;

use super::known_shape::KnownShape;
use super::near::travel;
use super::{DEPENETRATION_SPEED, Shape};
use crate::{Particles, Pose, Topology};

/// A collider between two substeps.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub(super) struct Arrival {
    /// Its shape; unknown if it is new.
    shape: KnownShape,
    /// Where it belonged at the end of the last substep.
    pose: Pose,
    /// How deep in it the deepest particle was in the last substep, m.
    buried: f32,
    /// Where it stands, seen from where it belongs, m.
    offset: Vec3,
}

/// A collider that is that many mean edges from where it was a substep before did not move there; nor did a particle that is so much
/// deeper in one, or by that part of its inner radius.
const JUMP: f32 = 0.25;

/// Pushed out each its nearest way, two ends of an edge may get that many times as far from each other as they are.
const MOST_STRETCH: f32 = 2.0;

/// What is deeper in a solid than that part of its inner radius is on neither side.
const CORE: f32 = 0.7;

/// What is left between solid and cloth to begin with, in mean edges: a triangle may reach farther than its corners.
const CLEAR: f32 = 0.5;

/// The way of a ray is followed to that many mean edges.
const NEAR_ENOUGH: f32 = 0.01;

/// Steps along a ray at most: one that only grazes the solid never arrives.
const MOST_STEPS: u32 = 64;

/// Points along the edge of a triangle at which its depth is looked at, at most.
const MOST_POINTS: f32 = 16.0;

impl Arrival {
    /// Begins a substep of `h` s, at the end of which the collider belongs at `pose`, and at its start at `from`. Tells whether it
    /// came there without moving.
    pub fn begin(&mut self, shape: &Shape, [from, pose]: [Pose; 2], edge: f32) -> bool {
        let is_known = self.shape.meet(shape);
        if !is_known {
            *self = Self { shape: std::mem::take(&mut self.shape), ..Self::default() };
        }
        let last = std::mem::replace(&mut self.pose, pose);
        !is_known || travel(shape, last, from) > JUMP * edge
    }

    /// Lets the solid come in for `h` s: the offset at the start and at the end, m.
    pub fn advance(&mut self, h: f32) -> [Vec3; 2] {
        let start = self.offset;
        let left = start.length() - DEPENETRATION_SPEED * h;
        self.offset = if left > 0.0 { start.normalize_or_zero() * left } else { Vec3::ZERO };
        [start, self.offset]
    }

    /// Ends a substep in which the deepest particle was `buried` m in the solid. Tells whether it came there without moving.
    pub fn is_buried_at_once(&mut self, shape: &Shape, [buried, edge]: [f32; 2]) -> bool {
        buried - std::mem::replace(&mut self.buried, buried) > JUMP * edge.min(shape.inner_radius())
    }

    /// Takes the solid away from a cloth that cannot leave it, each particle its nearest way. `true` if so. A triangle mesh, which has
    /// no inside, stays.
    pub fn yield_to(&mut self, of: (&Topology, &Particles), shape: &Shape, [margin, edge]: [f32; 2]) -> bool {
        if shape.mesh().is_some() {
            return false;
        }
        let pose = Pose { position: self.pose.position + self.offset, ..self.pose };
        let points: Vec<Vec3> = (0..of.1.slots()).map(|slot| pose.inverse_point(of.1.position.get(slot))).collect();
        let parts = is_parted(of.0, shape, &points);
        if parts {
            self.offset += way_out(of.0, shape, pose, &points, [margin, edge]);
            self.buried = 0.0;
        }
        parts
    }
}

/// Whether what is inside of `shape` would be torn apart, or pass through its middle, if each of the `points` were pushed out its
/// nearest way.
fn is_parted(topology: &Topology, shape: &Shape, points: &[Vec3]) -> bool {
    let (radius, core) = (shape.bounding_radius(), CORE * shape.inner_radius());
    topology.triangles.iter().any(|corners| {
        let corners = corners.map(|slot| points[slot as usize]);
        if radius.is_finite() {
            let (low, high) = (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
            if low.max_element() > radius || high.min_element() < -radius {
                return false;
            }
        }
        let out = corners.map(|p| {
            let (distance, normal) = shape.distance_and_normal(p);
            if distance < 0.0 { p - normal * distance } else { p }
        });
        let stretched = |i: usize, j: usize| out[i].distance(out[j]) > MOST_STRETCH * corners[i].distance(corners[j]);
        if out == corners {
            passes(shape, out, core)
        } else {
            stretched(0, 1) || stretched(1, 2) || stretched(2, 0) || passes(shape, out, core)
        }
    })
}

/// Whether a triangle is somewhere deeper than `core` in a shape.
fn passes(shape: &Shape, [a, b, c]: [Vec3; 3], core: f32) -> bool {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let steps = (longest / (0.5 * core)).ceil().clamp(1.0, MOST_POINTS) as u32;
    let at = |i: u32, j: u32| a + ((b - a) * i as f32 + (c - a) * j as f32) / steps as f32;
    (0..=steps).any(|i| (0..=steps - i).any(|j| shape.distance_and_normal(at(i, j)).0 < -core))
}

/// The shortest way along which `shape` at `pose` gets clear of the whole cloth, m: of those along its own axes and faces, and along the
/// normal of what of the cloth is inside.
fn way_out(topology: &Topology, shape: &Shape, pose: Pose, points: &[Vec3], [margin, edge]: [f32; 2]) -> Vec3 {
    let local = |slot: u32| points[slot as usize];
    let inside = |triangle: &[Vec3; 3]| triangle.iter().any(|p| shape.distance_and_normal(*p).0 < 0.0);
    let triangles = topology.triangles.iter().map(|corners| corners.map(local)).filter(inside);
    let across: Vec3 = triangles.map(|[a, b, c]| (b - a).cross(c - a)).sum();
    let across = across.normalize_or_zero();
    let ways: Vec<Vec3> = match shape {
        Shape::HalfSpace => vec![Vec3::NEG_Y],
        Shape::Convex(hull) => hull.planes.iter().map(|(normal, _)| -*normal).collect(),
        _ => vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z],
    };
    let also = if matches!(shape, Shape::HalfSpace) { Vec3::ZERO } else { across };
    let mut shortest = (f32::INFINITY, Vec3::ZERO);
    for way in [also, -also].into_iter().chain(ways).filter(|way| *way != Vec3::ZERO) {
        let length = clearance(shape, points, way, [margin + CLEAR * edge, NEAR_ENOUGH * edge], shortest.0);
        if length < shortest.0 {
            shortest = (length, way);
        }
    }
    let (length, way) = shortest;
    pose.rotation * (way * length)
}

/// How far `shape` has to go along `way` until all `points` are farther than `keep` from it for good, m, or more than `most`: each point
/// is followed along the ray on which it comes in, by the distance that is free (sphere tracing: Hart 1996).
fn clearance(shape: &Shape, points: &[Vec3], way: Vec3, [keep, near]: [f32; 2], most: f32) -> f32 {
    let radius = shape.bounding_radius() + keep;
    let mut farthest = 0.0_f32;
    for point in points {
        let along = point.dot(way);
        let off = (*point - way * along).length_squared();
        // Where the ray leaves the ball around the shape; a plane is left where it is.
        let mut at = if radius.is_finite() {
            if off >= radius * radius {
                continue;
            }
            along + (radius * radius - off).sqrt()
        } else {
            keep - shape.distance_and_normal(*point).0
        };
        for _ in 0..MOST_STEPS {
            if at <= farthest {
                break;
            }
            let free = shape.distance_and_normal(*point - way * at).0 - keep;
            if free <= near {
                farthest = at;
                break;
            }
            at -= free;
        }
        if farthest >= most {
            break;
        }
    }
    farthest
}
