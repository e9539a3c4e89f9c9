//! Mends what is wrong with a mesh and can be put right.
//!
//! ```text
//!        x               A triangle without area that bridges a gap: vertex b stands on the side a c of
//!       ╱│╲              the triangle above. Leaving a b c out would cut the cloth open along a c, so the
//!      ╱ │ ╲             side is divided at b.
//!     a──b──c
//! ```

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fmt;

use glam::{DVec3, Vec3};

/// What was wrong with a mesh and was mended, each as a number; all 0 for a mesh without faults.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mended {
    /// Vertices that no triangle uses. They keep their numbers and have no particle.
    pub unused_vertices: u32,
    /// Triangles without area. They are left out; where one bridged a gap, the triangle beside it is divided instead.
    pub flat_triangles: u32,
    /// Triangles on the same three particles as an earlier one. They are left out of the simulation. The first that is wound
    /// the other way is what is seen of the back; a copy with the same winding is not drawn twice in one place.
    pub doubled_triangles: u32,
    /// Triangles that were wound against most of their neighbours. They are turned over.
    pub turned_triangles: u32,
    /// Edges of three or more triangles, such as the seam of a pocket. All of them hang on the edge; those two that go on
    /// straightest bend over it, then the next two.
    pub shared_edges: u32,
}

impl Mended {
    /// Whether nothing was mended.
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for Mended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = [
            (self.unused_vertices, "unused vertex", "unused vertices"),
            (self.flat_triangles, "triangle without area", "triangles without area"),
            (self.doubled_triangles, "doubled triangle", "doubled triangles"),
            (self.turned_triangles, "triangle wound against the others", "triangles wound against the others"),
            (self.shared_edges, "edge of three or more triangles", "edges of three or more triangles"),
        ];
        let mut separator = "";
        for (count, one, many) in parts.into_iter().filter(|(count, ..)| *count > 0) {
            write!(f, "{separator}{count} {}", if count == 1 { one } else { many })?;
            separator = ", ";
        }
        if separator.is_empty() { f.write_str("nothing") } else { Ok(()) }
    }
}

/// The triangles that are simulated, corner by corner.
#[derive(Clone, Debug, Default)]
pub(super) struct Sound {
    /// Vertices of the mesh.
    pub vertices: Vec<[u32; 3]>,
    /// For each of them the vertices of its double wound the other way; empty if none has one.
    pub backs: Vec<Option<[u32; 3]>>,
}

/// Leaves out what has no area or is there twice. `first` names for each vertex the one it is welded to, of which `positions`
/// are taken; a triangle that is nowhere higher than `tolerance` (m) has no area.
pub(super) fn mend(
    triangles: &[[u32; 3]],
    positions: &[Vec3],
    first: &[u32],
    tolerance: f64,
    mended: &mut Mended,
) -> Sound {
    let welded = |corners: [u32; 3]| corners.map(|vertex| first[vertex as usize]);
    let place = |vertex: u32| positions[first[vertex as usize] as usize].as_dvec3();
    let is_flat = |corners: &[u32; 3]| height(corners.map(place)) <= tolerance;
    let (flat, mut kept): (Vec<_>, Vec<_>) = triangles.iter().copied().partition(is_flat);
    mended.flat_triangles = flat.len() as u32;
    let has_three = |corners: &[u32; 3]| {
        let [a, b, c] = welded(*corners);
        a != b && b != c && c != a
    };
    let mut bridges: Vec<Bridge> =
        flat.into_iter().filter(has_three).map(|corners| Bridge::new(corners, place)).collect();
    let mut left = usize::MAX;
    while bridges.len() < left {
        left = bridges.len();
        bridges.retain(|bridge| !bridge.divide(&mut kept, welded, is_flat));
    }
    let sound = without_doubles(kept, welded);
    mended.doubled_triangles = sound.1;
    sound.0
}

/// The height of a triangle over its longest side, m.
pub(super) fn height([a, b, c]: [DVec3; 3]) -> f64 {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let area = 0.5 * (b - a).cross(c - a).length();
    if longest > 0.0 { 2.0 * area / longest } else { 0.0 }
}

/// A triangle without area: a vertex in the middle of a side.
struct Bridge {
    ends: [u32; 2],
    middle: u32,
}

impl Bridge {
    fn new([a, b, c]: [u32; 3], place: impl Fn(u32) -> DVec3) -> Self {
        let length = |from: u32, to: u32| place(from).distance_squared(place(to));
        let (ab, bc, ca) = (length(a, b), length(b, c), length(c, a));
        match () {
            () if ab >= bc && ab >= ca => Self { ends: [a, b], middle: c },
            () if bc >= ca => Self { ends: [b, c], middle: a },
            () => Self { ends: [c, a], middle: b },
        }
    }

    /// Divides the triangles on its long side; whether there are any that can be.
    fn divide(
        &self,
        kept: &mut Vec<[u32; 3]>,
        welded: impl Fn([u32; 3]) -> [u32; 3],
        is_flat: impl Fn(&[u32; 3]) -> bool,
    ) -> bool {
        let [from, to, middle] = welded([self.ends[0], self.ends[1], self.middle]);
        let mut done = false;
        for at in 0..kept.len() {
            let corners = welded(kept[at]);
            let side = (0..3).find(|i| {
                let (p, q) = (corners[*i], corners[(i + 1) % 3]);
                (p, q) == (from, to) || (p, q) == (to, from)
            });
            let Some(side) = side.filter(|_| !corners.contains(&middle)) else { continue };
            let [p, q, apex] = [0, 1, 2].map(|i| kept[at][(side + i) % 3]);
            let halves = [[p, self.middle, apex], [self.middle, q, apex]];
            if !halves.iter().any(&is_flat) {
                kept[at] = halves[0];
                kept.push(halves[1]);
                done = true;
            }
        }
        done
    }
}

/// One of all triangles on the same three particles, and how many others there were.
fn without_doubles(triangles: Vec<[u32; 3]>, welded: impl Fn([u32; 3]) -> [u32; 3]) -> (Sound, u32) {
    let mut known: HashMap<[u32; 3], usize> = HashMap::with_capacity(triangles.len());
    let mut sound = Sound::default();
    let mut doubles = 0;
    for corners in triangles {
        let particles = welded(corners);
        let mut sorted = particles;
        sorted.sort_unstable();
        let at = match known.entry(sorted) {
            Entry::Vacant(place) => {
                place.insert(sound.vertices.len());
                sound.vertices.push(corners);
                continue;
            }
            Entry::Occupied(place) => *place.get(),
        };
        doubles += 1;
        let front = welded(sound.vertices[at]);
        let turn = front.map(|particle| particles.iter().position(|other| *other == particle).unwrap_or_default());
        let is_opposite = (turn[0] + 1) % 3 != turn[1];
        if is_opposite {
            sound.backs.resize(sound.vertices.len().max(sound.backs.len()), None);
            sound.backs[at].get_or_insert(turn.map(|i| corners[i]));
        }
    }
    if !sound.backs.is_empty() {
        sound.backs.resize(sound.vertices.len(), None);
    }
    (sound, doubles)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mended(triangles: &[[u32; 3]], positions: &[[f32; 3]]) -> (Sound, Mended) {
        let positions: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
        let first: Vec<u32> = (0..positions.len() as u32).collect();
        let mut told = Mended::default();
        (mend(triangles, &positions, &first, 1e-6, &mut told), told)
    }

    const SQUARE: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]];

    #[test]
    fn a_triangle_that_bridges_a_gap_is_replaced_by_dividing_the_one_beside_it() {
        // Vertex 4 stands in the middle of the diagonal of the lower triangle.
        let (sound, told) = mended(&[[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]], &SQUARE);
        assert_eq!(told.flat_triangles, 1);
        let edges: Vec<[u32; 2]> = sound.vertices.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
        // Every edge inside is run through both ways: the winding is kept, and no gap is left.
        let inner = edges.iter().filter(|[a, b]| edges.contains(&[*b, *a])).count();
        assert_eq!((sound.vertices.len(), inner), (4, 8));
    }

    #[test]
    fn several_vertices_on_one_side_divide_it_in_any_order() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]];
        let below = [[0, 5, 1], [1, 5, 2], [2, 5, 3]];
        for bridges in [[[0, 1, 2], [0, 2, 3]], [[0, 2, 3], [0, 1, 2]]] {
            let all: Vec<[u32; 3]> = below.into_iter().chain(bridges).chain([[0, 3, 4]]).collect();
            let (sound, told) = mended(&all, &positions);
            assert_eq!((sound.vertices.len(), told.flat_triangles), (6, 2));
            for side in [[0, 1], [1, 2], [2, 3]] {
                let beside = sound.vertices.iter().filter(|corners| side.iter().all(|end| corners.contains(end)));
                assert_eq!(beside.count(), 2, "{side:?}");
            }
        }
    }

    #[test]
    fn a_double_wound_the_other_way_is_the_back_corner_by_corner_and_one_wound_alike_is_gone() {
        let positions: Vec<[f32; 3]> = SQUARE[..3].iter().chain(&SQUARE[..3]).copied().collect();
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from).collect();
        let first = [0, 1, 2, 0, 1, 2];
        let mut told = Mended::default();
        let sound = mend(&[[0, 1, 2], [4, 5, 3], [5, 4, 3], [3, 5, 4]], &positions, &first, 1e-6, &mut told);
        assert_eq!((sound.vertices, sound.backs), (vec![[0, 1, 2]], vec![Some([3, 4, 5])]));
        assert_eq!(told.doubled_triangles, 3);
    }

    #[test]
    fn what_was_mended_is_told_in_words() {
        assert_eq!(Mended::default().to_string(), "nothing");
        let some = Mended { unused_vertices: 1, shared_edges: 12, ..Mended::default() };
        assert_eq!(some.to_string(), "1 unused vertex, 12 edges of three or more triangles");
    }
}
