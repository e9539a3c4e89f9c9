//! Where a cloth passes through itself.

use glam::Vec3A;

use crate::contact::{Bounds, Hierarchy};
use crate::{Particles, Pose, Topology};

/// An edge that passes through a triangle.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Passage {
    /// The particles at the ends of the edge, the smaller first.
    pub edge: [u32; 2],
    /// The number of the triangle in [`Topology::triangles`].
    pub triangle: u32,
}

/// Every edge that passes through a triangle it shares no particle with, in ascending order; none of a cloth that nowhere passes
/// through itself. What only touches does not pass. Takes about a millisecond for 8,000 triangles.
pub fn crossings(topology: &Topology, particles: &Particles) -> Vec<Passage> {
    let positions: Vec<Vec3A> = (0..topology.slots()).map(|slot| particles.position.get(slot).into()).collect();
    let points: Vec<Bounds> = positions.iter().map(|x| Bounds { min: *x, max: *x }).collect();
    let mut hierarchy = Hierarchy::new(topology);
    hierarchy.refit(topology, &points, false);
    passages(topology, &mut hierarchy, &positions)
}

/// Where two cloths pass through each other: every edge of the first that passes through a triangle of the second, and every edge of the
/// second that passes through one of the first, each in ascending order. `frame` is the frame of the second as seen from the first's.
/// What passes through itself does not count.
pub fn crossings_between(
    (first, of_first): (&Topology, &Particles),
    (second, of_second): (&Topology, &Particles),
    frame: &Pose,
) -> [Vec<Passage>; 2] {
    let (slots, triangles) = (first.slots() as u32, first.triangles.len() as u32);
    let mut positions: Vec<Vec3A> = (0..first.slots()).map(|slot| of_first.position.get(slot).into()).collect();
    positions.extend((0..second.slots()).map(|slot| Vec3A::from(frame.point(of_second.position.get(slot)))));
    let shifted = second.triangles.iter().map(|corners| corners.map(|slot| slot + slots));
    let both = Topology { triangles: first.triangles.iter().copied().chain(shifted).collect(), ..Topology::default() };
    let points: Vec<Bounds> = positions.iter().map(|x| Bounds { min: *x, max: *x }).collect();
    let [one, other] = [first, second].map(Hierarchy::new);
    let mut hierarchy = Hierarchy::join([(&one, slots, triangles), (&other, 0, 0)]);
    hierarchy.refit(&both, &points, false);
    let mut found = [Vec::new(), Vec::new()];
    for Passage { edge, triangle } in passages(&both, &mut hierarchy, &positions) {
        match (edge[0] < slots, triangle < triangles) {
            (true, false) => found[0].push(Passage { edge, triangle: triangle - triangles }),
            (false, true) => found[1].push(Passage { edge: edge.map(|slot| slot - slots), triangle }),
            _ => {}
        }
    }
    found
}

/// The same among the pairs that a hierarchy fitted to boxes around `positions` finds.
pub(crate) fn passages(topology: &Topology, hierarchy: &mut Hierarchy, positions: &[Vec3A]) -> Vec<Passage> {
    let bounds: Vec<Bounds> = (topology.triangles.iter())
        .map(|corners| {
            let points = corners.map(|slot| positions[slot as usize]);
            points.iter().fold(Bounds::EMPTY, |all, x| all.join(Bounds { min: *x, max: *x }))
        })
        .collect();
    let mut found = Vec::new();
    hierarchy.for_each_pair(false, |_, a, others| {
        for &b in others {
            if bounds[a as usize].overlaps(&bounds[b as usize]) {
                passages_of(topology, positions, a, b, &mut found);
                passages_of(topology, positions, b, a, &mut found);
            }
        }
    });
    // An edge of two triangles is found twice.
    found.sort_unstable();
    found.dedup();
    found
}

fn passages_of(topology: &Topology, positions: &[Vec3A], of: u32, through: u32, found: &mut Vec<Passage>) {
    let [corners, triangle] = [of, through].map(|triangle| topology.triangles[triangle as usize]);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let edge = [a.min(b), a.max(b)];
        if edge.iter().all(|slot| !triangle.contains(slot)) {
            let [from, to] = edge.map(|slot| positions[slot as usize]);
            if passes(from, to, triangle.map(|slot| positions[slot as usize])) {
                found.push(Passage { edge, triangle: through });
            }
        }
    }
}

/// Whether the edge `from`–`to` passes through the inside of the triangle. In f64, where differences of f32 are exact and volumes
/// have eight more digits than the positions they are made of; a volume within their rounding has no sign: parallel edges in one plane
/// have such.
pub(crate) fn passes(from: Vec3A, to: Vec3A, triangle: [Vec3A; 3]) -> bool {
    let [to, a, b, c] = [to, triangle[0], triangle[1], triangle[2]].map(|x| x.as_dvec3() - from.as_dvec3());
    let size = to.length_squared().max(a.length_squared()).max(b.length_squared()).max(c.length_squared()).sqrt();
    let rounding = 16.0 * f64::EPSILON * size.powi(3);
    let sign = |volume: f64| if volume.abs() <= rounding { 0.0 } else { volume.signum() };
    let normal = (b - a).cross(c - a);
    if sign(normal.dot(-a)) * sign(normal.dot(to - a)) >= 0.0 {
        return false;
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| sign(to.cross(p).dot(q)));
    sides == [1.0; 3] || sides == [-1.0; 3]
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec2, Vec3};
    use rand::rngs::Xoshiro256PlusPlus;
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::topology::Resolution;

    fn sheet(cells: u32) -> (Topology, Particles) {
        let topology = Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(cells))).unwrap();
        let particles = Particles::new(&topology, 0.2);
        (topology, particles)
    }

    #[test]
    fn a_flat_sheet_passes_nowhere_through_itself() {
        let (topology, particles) = sheet(9);
        assert_eq!(crossings(&topology, &particles), []);
    }

    #[test]
    fn a_flat_sheet_that_is_turned_passes_nowhere_through_itself() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(8);
        for cells in [7, 12, 16, 31] {
            for _ in 0..100 {
                let (topology, mut particles) = sheet(cells);
                let axis = Vec3::from_array([0; 3].map(|_| random.random_range(-3.0..3.0)));
                let turn = glam::Quat::from_scaled_axis(axis);
                for slot in 0..topology.slots() {
                    particles.position.set(slot, turn * (topology.rest[slot] * 0.4));
                }
                assert_eq!(crossings(&topology, &particles), []);
            }
        }
    }

    #[test]
    fn a_corner_pulled_through_the_middle_is_found() {
        let (topology, mut particles) = sheet(8);
        // The middle of a cell's half, off all edges.
        particles.position.set(0, Vec3::new(0.03, 0.05, -0.2));
        let (up, neighbor) = (Vec3::new(0.03, 0.04, 0.2), 1);
        particles.position.set(neighbor, up);
        let found = crossings(&topology, &particles);
        assert!(found.iter().any(|passage| passage.edge == [0, 1]), "{found:?}");
    }

    #[test]
    fn crumpled_at_random_the_same_are_found_as_by_trying_all() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        for cells in [1, 2, 5, 8] {
            let (topology, mut particles) = sheet(cells);
            for slot in 0..topology.slots() {
                let off = Vec3::from_array([0; 3].map(|_| random.random_range(-0.3..0.3)));
                particles.position.set(slot, topology.rest[slot] + off);
            }
            let positions: Vec<Vec3A> = (0..topology.slots()).map(|slot| particles.position.get(slot).into()).collect();
            let at = |slot: u32| positions[slot as usize];
            let mut all = Vec::new();
            for edge in &topology.edges {
                for (index, corners) in topology.triangles.iter().enumerate() {
                    let is_apart = edge.iter().all(|slot| !corners.contains(slot));
                    if is_apart && passes(at(edge[0]), at(edge[1]), corners.map(at)) {
                        all.push(Passage { edge: *edge, triangle: index as u32 });
                    }
                }
            }
            all.sort_unstable();
            assert!(cells < 5 || all.len() > 20);
            assert_eq!(crossings(&topology, &particles), all);
        }
    }
}
