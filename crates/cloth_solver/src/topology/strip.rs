//! Strips of triangles: what a straight thread along warp or weft crosses, one triangle after the other.
//!
//! ```text
//!   ╲  ╱╲  ╱╲  ╱╲       A thread starts in the middle of a triangle that none has crossed yet and runs
//!    ╲╱──╲╱──╲╱──╲──    straight on over the edges, bent only where the surface is, until it comes to a
//!    ╱╲  ╱╲  ╱╲  ╱      border, back to itself, or to an edge along which it would run.
//! ```

use glam::{Mat2, Vec2};

use super::hinge::corner;
use super::{Along, Topology};

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// Sine of the angle at which a thread no longer crosses an edge but runs along it.
const ALONG: f32 = 1e-3;

/// The strips along `along`, each triangle in one at least. No particle belongs to two triangles of a strip that are more
/// than `reach` apart in it: where a thread comes back to itself, and at a particle of very many triangles, the next strip
/// begins.
pub(crate) fn strips(topology: &Topology, along: Along, reach: usize) -> Vec<Vec<u32>> {
    let count = topology.triangles.len();
    let neighbours = neighbours(topology);
    let mut crossed = vec![false; count];
    // Which thread was the last in each triangle.
    let mut last = vec![NONE; count];
    let mut strips = Vec::new();
    for first in 0..count as u32 {
        if crossed[first as usize] {
            continue;
        }
        last[first as usize] = first;
        let mut thread = Vec::new();
        for sign in [-1.0, 1.0] {
            let mut at = Crossing::in_the_middle(topology, first, sign);
            while let Some(next) = at.next(topology, &neighbours, along) {
                if last[next.triangle as usize] == first {
                    break;
                }
                last[next.triangle as usize] = first;
                thread.push(next.triangle);
                at = next;
            }
            if sign < 0.0 {
                thread.reverse();
                thread.push(first);
            }
        }
        thread.iter().for_each(|triangle| crossed[*triangle as usize] = true);
        divide(topology, thread, reach, &mut strips);
    }
    strips
}

/// Cuts a thread where a particle comes back after more than `reach` triangles.
fn divide(topology: &Topology, thread: Vec<u32>, reach: usize, strips: &mut Vec<Vec<u32>>) {
    let mut strip: Vec<u32> = Vec::with_capacity(thread.len());
    let mut seen: std::collections::HashMap<u32, usize> = std::collections::HashMap::new();
    for triangle in thread {
        let corners = topology.triangles[triangle as usize];
        if corners.iter().any(|slot| seen.get(slot).is_some_and(|first| strip.len() > first + reach)) {
            strips.push(std::mem::take(&mut strip));
            seen.clear();
        }
        corners.iter().for_each(|slot| _ = seen.entry(*slot).or_insert(strip.len()));
        strip.push(triangle);
    }
    strips.push(strip);
}

/// The triangle over each side of each triangle, the side opposite to a corner at that corner's place.
pub(super) fn neighbours(topology: &Topology) -> Vec<[u32; 3]> {
    let mut neighbours = vec![[NONE; 3]; topology.triangles.len()];
    for ([_, _, c, d], [of_c, of_d]) in topology.hinges.iter().zip(&topology.hinge_triangles) {
        neighbours[*of_c as usize][corner(topology.triangles[*of_c as usize], *c)] = *of_d;
        neighbours[*of_d as usize][corner(topology.triangles[*of_d as usize], *d)] = *of_c;
    }
    neighbours
}

/// A thread within a triangle.
struct Crossing {
    triangle: u32,
    /// Where it is, in the plane of weft and warp, the first corner at the origin.
    place: Vec2,
    /// Whether it runs along or against the direction there.
    sign: f32,
    /// The corner opposite to the side it came in by.
    entry: Option<usize>,
}

impl Crossing {
    fn in_the_middle(topology: &Topology, triangle: u32, sign: f32) -> Self {
        let rest = topology.triangle_rest[triangle as usize];
        Self { triangle, place: (rest.x_axis + rest.y_axis) / 3.0, sign, entry: None }
    }

    /// In the next triangle.
    fn next(&self, topology: &Topology, neighbours: &[[u32; 3]], along: Along) -> Option<Self> {
        let direction = match along {
            Along::Weft => Vec2::X,
            Along::Warp => Vec2::Y,
        };
        let corners = topology.triangles[self.triangle as usize];
        let places = laid_flat(topology.triangle_rest[self.triangle as usize]);
        // It leaves by the side it meets first of those that it runs towards.
        let (exit, place) = (0..3)
            .filter(|side| Some(*side) != self.entry)
            .filter_map(|side| {
                let (from, to) = (places[(side + 1) % 3], places[(side + 2) % 3]);
                let across = outflow(from, to, direction * self.sign);
                (across > 0.0).then(|| (side, (from - self.place).perp_dot(to - from) / across))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(side, distance)| (side, self.place + direction * (self.sign * distance)))?;
        let next = neighbours[self.triangle as usize][exit];
        if next == NONE {
            return None;
        }
        let [a, b] = [(exit + 1) % 3, (exit + 2) % 3];
        let side = places[b] - places[a];
        let part = ((place - places[a]).dot(side) / side.length_squared()).clamp(0.0, 1.0);
        let (others, other_places) =
            (topology.triangles[next as usize], laid_flat(topology.triangle_rest[next as usize]));
        let [a, b] = [a, b].map(|i| corner(others, corners[i]));
        let inflow = -outflow(other_places[a], other_places[b], direction);
        // Which way round the side runs in the other triangle.
        let inflow = if (a + 1) % 3 == b { inflow } else { -inflow };
        (inflow.abs() > ALONG * side.length()).then(|| Self {
            triangle: next,
            place: other_places[a].lerp(other_places[b], part),
            sign: inflow.signum(),
            entry: Some(3 - a - b),
        })
    }
}

/// The corners of a triangle with these edges at rest.
fn laid_flat(rest: Mat2) -> [Vec2; 3] {
    [Vec2::ZERO, rest.x_axis, rest.y_axis]
}

/// How much of `direction` leaves a triangle over its side from `from` to `to`, its corners being in mathematical order.
fn outflow(from: Vec2, to: Vec2, direction: Vec2) -> f32 {
    direction.perp_dot(to - from)
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec3};

    use super::*;
    use crate::topology::{MeshSource, Resolution};

    const REACH: usize = 5;

    fn mesh(positions: &[Vec3], uvs: &[Vec2], triangles: &[[u32; 3]]) -> Topology {
        Topology::from_mesh(MeshSource { positions, uvs, indices: triangles.as_flattened() }).expect("a mesh")
    }

    fn sheet(cells: UVec2, bend: impl Fn(Vec3) -> Vec3) -> Topology {
        let grid = Topology::rectangle(Vec2::ONE, Resolution::Cells(cells)).expect("a rectangle");
        let flat: Vec<Vec3> = grid.vertex_particle.iter().map(|slot| grid.rest[*slot as usize]).collect();
        let positions: Vec<Vec3> = flat.iter().map(|p| bend(*p)).collect();
        let uvs: Vec<Vec2> = flat.iter().map(|p| Vec2::new(p.x, -p.y)).collect();
        mesh(&positions, &uvs, &grid.triangle_vertices)
    }

    /// Each triangle in a strip, each strip connected, no particle further apart than the reach.
    fn check(topology: &Topology, strips: &[Vec<u32>]) {
        let mut crossed = vec![false; topology.triangles.len()];
        for strip in strips {
            let shared = |i: usize, j: usize| {
                let [a, b] = [i, j].map(|k| topology.triangles[strip[k] as usize]);
                a.iter().filter(|slot| b.contains(slot)).count()
            };
            for i in 0..strip.len() {
                crossed[strip[i] as usize] = true;
                assert!(i == 0 || shared(i - 1, i) == 2);
                assert!((0..i.saturating_sub(REACH)).all(|j| shared(j, i) == 0));
            }
        }
        assert!(crossed.iter().all(|crossed| *crossed));
    }

    #[test]
    fn the_strips_of_a_sheet_are_its_rows_and_columns() {
        let topology = sheet(UVec2::new(6, 4), |p| p);
        for (along, count, length) in [(Along::Weft, 4, 12), (Along::Warp, 6, 8)] {
            let strips = strips(&topology, along, REACH);
            check(&topology, &strips);
            assert_eq!(strips.len(), count);
            assert!(strips.iter().all(|strip| strip.len() == length));
        }
    }

    #[test]
    fn a_thread_goes_straight_on_over_what_is_bent() {
        let topology = sheet(UVec2::new(8, 8), |p| Vec3::new(0.3 * (3.0 * p.x).sin(), p.y, 0.3 * (3.0 * p.x).cos()));
        for along in [Along::Weft, Along::Warp] {
            let strips = strips(&topology, along, REACH);
            check(&topology, &strips);
            assert!(strips.iter().all(|strip| strip.len() == 16));
        }
    }

    #[test]
    fn a_ring_is_cut_open_and_a_fan_of_many_triangles_divided() {
        let around = 40;
        let ring = |i: u32, y: f32| {
            let angle = core::f32::consts::TAU * i as f32 / around as f32;
            Vec3::new(angle.cos(), y, angle.sin())
        };
        let positions: Vec<Vec3> = (0..around).map(|i| ring(i, 0.0)).chain((0..around).map(|i| ring(i, 0.2))).collect();
        let triangles: Vec<[u32; 3]> = (0..around)
            .flat_map(|i| {
                let [a, b, c, d] = [i, (i + 1) % around, i + around, (i + 1) % around + around];
                [[a, c, b], [b, c, d]]
            })
            .collect();
        let topology = mesh(&positions, &[], &triangles);
        check(&topology, &strips(&topology, Along::Weft, REACH));
        check(&topology, &strips(&topology, Along::Warp, REACH));
        let mut disc: Vec<Vec3> = (0..around).map(|i| ring(i, 0.0)).collect();
        disc.push(Vec3::ZERO);
        let fan: Vec<[u32; 3]> = (0..around).map(|i| [around, (i + 1) % around, i]).collect();
        let topology = mesh(&disc, &[], &fan);
        check(&topology, &strips(&topology, Along::Weft, REACH));
    }
}
