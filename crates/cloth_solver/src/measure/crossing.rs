//! Where a cloth passes through itself.

use glam::{DVec3, Vec3A};

use crate::contact::{Bounds, Hierarchy};
use crate::{Particles, Topology};

/// An edge that passes through a triangle.
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
    hierarchy.refit(&points);
    passages(topology, &mut hierarchy, &positions)
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
    hierarchy.for_each_pair(|first, second| {
        for &a in first {
            for &b in second {
                if bounds[a as usize].overlaps(&bounds[b as usize]) {
                    passages_of(topology, positions, a, b, &mut found);
                    passages_of(topology, positions, b, a, &mut found);
                }
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
/// have eight more digits than the positions they are made of.
pub(crate) fn passes(from: Vec3A, to: Vec3A, triangle: [Vec3A; 3]) -> bool {
    let [from, to] = [from, to].map(|x| x.as_dvec3());
    let [a, b, c] = triangle.map(|x| x.as_dvec3());
    let volume = |p: DVec3, q: DVec3, r: DVec3, s: DVec3| (q - p).cross(r - p).dot(s - p);
    let (above, below) = (volume(a, b, c, from), volume(a, b, c, to));
    if above * below >= 0.0 {
        return false;
    }
    let sides = [volume(from, to, a, b), volume(from, to, b, c), volume(from, to, c, a)];
    sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
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
