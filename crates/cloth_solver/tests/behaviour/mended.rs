//! Meshes as modellers hand them over: with faults of every kind at random places, they are mended, told, and are cloth.

use std::collections::HashMap;
use std::sync::Arc;

use crate::common::damage::{area, mass};
use crate::common::*;
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::SelfContact;
use cloth_solver::damage::{Blade, Direction};
use cloth_solver::topology::{Change, Mended, MeshSource};
use cloth_solver::{Cloth, Fabric, Motion, Topology};
use glam::{Vec2, Vec3};
use rand::rngs::Xoshiro256PlusPlus;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};

type Random = Xoshiro256PlusPlus;

/// A mesh, and the faults that were put into it.
#[derive(Clone)]
struct Faulty {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Triangles that no fault has touched yet, by their numbers, in random order.
    sound: Vec<usize>,
    told: Mended,
}

/// A point of the sheet, the tube or the sphere at `u` and `v`, 0..=1.
fn surface(kind: usize, u: f32, v: f32) -> Vec3 {
    let around = core::f32::consts::TAU * u;
    match kind {
        0 => Vec3::new(u - 0.5, 0.5 - v, 0.0),
        1 => Vec3::new(0.25 * around.cos(), 0.5 - v, 0.25 * around.sin()),
        _ => {
            let down = core::f32::consts::PI * v;
            0.3 * Vec3::new(down.sin() * around.cos(), down.cos(), down.sin() * around.sin())
        }
    }
}

impl Faulty {
    /// Without a fault: of `kind` 3 a sheet with inner corners moved about and some triangles missing, else as [`surface`] has it,
    /// with vertices doubled where u comes back to itself.
    fn new(kind: usize, [across, down]: [u32; 2], random: &mut Random) -> Self {
        let (positions, mut triangles) = if kind == 3 {
            irregular(Vec2::ONE, [across, down])
        } else {
            let at = |i: u32, j: u32| j * (across + 1) + i;
            let places = (0..=down).flat_map(|j| (0..=across).map(move |i| (i, j)));
            let place = |(i, j): (u32, u32)| {
                surface(kind, (i % across_of(kind, across)) as f32 / across as f32, j as f32 / down as f32)
            };
            let quads = (0..down).flat_map(|j| (0..across).map(move |i| (i, j)));
            let triangles = quads.flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let is_pole = |row: u32| kind == 2 && (row == 0 || row == down);
                let first = (!is_pole(j)).then_some([a, c, b]);
                first.into_iter().chain((!is_pole(j + 1)).then_some([a, d, c]))
            });
            (places.map(place).collect(), triangles.collect::<Vec<_>>())
        };
        if kind == 3 {
            triangles.retain(|_| random.random_bool(0.95));
        }
        let mut used = vec![false; positions.len()];
        triangles.iter().flatten().for_each(|vertex| used[*vertex as usize] = true);
        let mut sound: Vec<usize> = (0..triangles.len()).collect();
        sound.shuffle(random);
        let unused_vertices = used.iter().filter(|used| !**used).count() as u32;
        Self { positions, triangles, sound, told: Mended { unused_vertices, ..Mended::default() } }
    }

    fn copy(&mut self, vertex: u32) -> u32 {
        self.positions.push(self.positions[vertex as usize]);
        self.positions.len() as u32 - 1
    }

    fn at(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    fn unused_vertex(&mut self, random: &mut Random) {
        self.positions.push(Vec3::from(core::array::from_fn(|_| random.random_range(-3.0..3.0))));
        self.told.unused_vertices += 1;
    }

    /// A triangle with two corners in one place, by one vertex or by two.
    fn needle(&mut self, random: &mut Random) {
        let [a, b, _] = self.triangles[random.random_range(0..self.triangles.len())];
        let double = if random.random_bool(0.5) { a } else { self.copy(a) };
        self.triangles.push([a, b, double]);
        self.told.flat_triangles += 1;
    }

    /// Two triangles that no fault has touched, and the ends of the edge between them as the first runs it.
    fn sound_pair(&mut self) -> Option<([usize; 2], [u32; 2])> {
        for first in 0..self.sound.len() {
            for second in first + 1..self.sound.len() {
                let (t, s) = (self.triangles[self.sound[first]], self.triangles[self.sound[second]]);
                let side = (0..3).map(|i| [t[i], t[(i + 1) % 3]]).find(|side| side.iter().all(|v| s.contains(v)));
                if let Some(side) = side {
                    let second = self.sound.remove(second);
                    return Some(([self.sound.remove(first), second], side));
                }
            }
        }
        None
    }

    /// A vertex on an edge of one triangle only, the gap bridged by a triangle without area.
    fn bridge(&mut self, random: &mut Random) {
        let Some(([_, divided], [a, b])) = self.sound_pair() else { return };
        self.positions.push(self.at(a).lerp(self.at(b), random.random_range(0.3..0.7)));
        let middle = self.positions.len() as u32 - 1;
        let corners = self.triangles[divided];
        // The second triangle runs the edge the other way.
        let apex = corners.into_iter().find(|corner| *corner != a && *corner != b).unwrap();
        self.triangles[divided] = [b, middle, apex];
        self.triangles.extend([[middle, a, apex], [a, b, middle]]);
        self.told.flat_triangles += 1;
    }

    fn double(&mut self, random: &mut Random) {
        let Some(of) = self.sound.pop() else { return };
        let [a, b, c] = self.triangles[of];
        let double = if random.random_bool(0.5) { [a, b, c] } else { [a, b, c].map(|vertex| self.copy(vertex)) };
        let [a, b, c] = double;
        self.triangles.push(if random.random_bool(0.5) { [b, c, a] } else { [c, b, a] });
        self.told.doubled_triangles += 1;
    }

    fn turn(&mut self) {
        let Some(triangle) = self.sound.pop() else { return };
        self.triangles[triangle].swap(0, 2);
        self.told.turned_triangles += 1;
    }

    /// A triangle that stands on an inner edge.
    fn wing(&mut self, random: &mut Random) {
        let Some(([first, _], [a, b])) = self.sound_pair() else { return };
        let [p, q, r] = self.triangles[first].map(|vertex| self.at(vertex));
        let normal = (q - p).cross(r - p).normalize();
        let length = self.at(a).distance(self.at(b));
        self.positions.push(self.at(a).midpoint(self.at(b)) + normal * length);
        let top = self.positions.len() as u32 - 1;
        self.triangles.push(if random.random_bool(0.5) { [a, b, top] } else { [b, a, top] });
        self.told.shared_edges += 1;
    }

    /// Puts up to `most` faults of each kind in.
    fn spoil(&mut self, most: u32, random: &mut Random) {
        for _ in 0..random.random_range(0..=most) {
            self.unused_vertex(random);
        }
        for _ in 0..random.random_range(0..=most) {
            self.needle(random);
        }
        for kind in 0..4 {
            for _ in 0..random.random_range(0..=most) {
                match kind {
                    0 => self.bridge(random),
                    1 => self.double(random),
                    2 => self.turn(),
                    _ => self.wing(random),
                }
            }
        }
        self.triangles.shuffle(random);
    }

    fn topology(&self) -> Topology {
        let source = MeshSource { positions: &self.positions, uvs: &[], indices: self.triangles.as_flattened() };
        Topology::from_mesh(source).unwrap()
    }
}

/// So that the last column of a sheet stands apart from the first and that of a tube on it.
fn across_of(kind: usize, across: u32) -> u32 {
    if kind == 0 { u32::MAX } else { across }
}

/// The kinds of mesh in turn, of random size.
fn meshes(count: usize, seed: u64) -> impl Iterator<Item = (Faulty, Random)> {
    let mut random = Random::seed_from_u64(seed);
    (0..count).map(move |round| {
        let cells = [random.random_range(4..=10), random.random_range(4..=8)];
        let faulty = Faulty::new(round % 4, cells, &mut random);
        (faulty, Random::seed_from_u64(seed + 1 + round as u64))
    })
}

/// Whatever else it is, a topology is consistent: edges are those of the triangles, half of the triangles on each bend in pairs,
/// areas add up, and what is drawn follows what is simulated.
fn assert_consistent(topology: &Topology) {
    let mut beside: HashMap<[u32; 2], usize> = HashMap::new();
    for (triangle, corners) in topology.triangles.iter().enumerate() {
        for i in 0..3 {
            let [a, b] = [corners[i], corners[(i + 1) % 3]];
            assert!(topology.is_particle(a));
            *beside.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
        assert_eq!(topology.triangle_vertices[triangle].map(|v| topology.vertex_particle[v as usize]), *corners);
        if let Some(back) = topology.triangle_backs.get(triangle) {
            assert_eq!(back.map(|v| topology.vertex_particle[v as usize]), *corners);
        }
        assert!(topology.triangle_rest[triangle].determinant() > 0.0);
    }
    assert!(topology.triangle_backs.is_empty() || topology.triangle_backs.len() == topology.triangles.len());
    assert_eq!(beside.len(), topology.edges.len());
    assert_eq!(topology.hinges.len(), beside.values().map(|count| count / 2).sum::<usize>());
    for ([a, b, c, d], sharing) in topology.hinges.iter().zip(&topology.hinge_triangles) {
        let [first, second] = sharing.map(|triangle| topology.triangles[triangle as usize]);
        assert!([a, b, c].iter().all(|p| first.contains(p)) && [a, b, d].iter().all(|p| second.contains(p)));
    }
    let of_particles: f64 = topology.area.iter().map(|area| f64::from(*area)).sum();
    assert!((of_particles / area(topology) - 1.0).abs() < 1e-5);
}

#[test]
fn every_fault_of_a_mesh_is_mended_and_counted() {
    for (mut faulty, mut random) in meshes(400, 1) {
        let whole = faulty.topology();
        assert_eq!(whole.mended, faulty.told);
        let wings = |of: &Topology| of.triangles.len() as f64;
        faulty.spoil(4, &mut random);
        let mended = faulty.topology();
        assert_eq!(mended.mended, faulty.told);
        assert_consistent(&mended);
        // Each bridge is a vertex more on an inner edge: two triangles more. Each wing is one.
        assert!(wings(&mended) >= wings(&whole) + f64::from(faulty.told.shared_edges));
        for (vertex, slot) in mended.vertex_particle.iter().enumerate() {
            let is_used = mended.triangle_vertices.iter().flatten().any(|used| *used == vertex as u32);
            if is_used {
                assert!(mended.rest[*slot as usize].distance(faulty.positions[vertex]) < 1e-5);
            }
        }
    }
}

#[test]
fn a_mended_sheet_covers_what_the_sound_one_does_without_a_gap() {
    for (mut faulty, mut random) in meshes(200, 2) {
        let whole = faulty.topology();
        for _ in 0..4 {
            faulty.bridge(&mut random);
            faulty.double(&mut random);
            faulty.turn();
        }
        faulty.triangles.shuffle(&mut random);
        let mended = faulty.topology();
        assert!((area(&mended) / area(&whole) - 1.0).abs() < 1e-5);
        let border = |topology: &Topology| topology.edges.len() - topology.hinges.len();
        assert_eq!(border(&mended), border(&whole), "a gap is a border");
        assert_eq!(mended.pieces().triangles.len(), whole.pieces().triangles.len());
    }
}

/// Pins the highest particle of each piece where it is.
fn hang(cloth: &mut Cloth) {
    let topology = &cloth.topology;
    let pieces = topology.pieces();
    let rest = |slot: u32| topology.rest[slot as usize];
    let highest = |piece: usize| {
        let of_piece = topology.particles().filter(|slot| pieces.of_slot[*slot as usize] == piece as u32);
        of_piece.max_by(|a, b| rest(*a).y.total_cmp(&rest(*b).y)).unwrap()
    };
    let pins = (0..pieces.triangles.len()).map(highest);
    let pins = pins.map(|particle| Pin { particle, frame: 0, local: rest(particle) }).collect();
    let pins = Pins { frames: vec![Motion::default()], pins };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
}

fn assert_finite_and_slow(cloth: &Cloth, most: f32) {
    let speed = fastest(cloth);
    assert!(speed < most, "{speed} m/s");
    assert!(positions(cloth).iter().all(|position| position.is_finite() && position.length() < 20.0));
}

#[test]
fn a_mended_cloth_hangs_tears_and_is_cut_like_any_other() {
    let (mut tears, mut cuts) = (0, 0);
    for (mut faulty, mut random) in meshes(24, 3) {
        faulty.spoil(4, &mut random);
        let mut cloth = Cloth::new(Arc::new(faulty.topology()), &Fabric::COTTON_POPLIN).unwrap();
        let (mass_before, area_before) = (mass(&cloth), area(&cloth.topology));
        hang(&mut cloth);
        if random.random_bool(0.5) {
            cloth.set_self_contact(&Fabric::COTTON_POPLIN, &SelfContact::default()).unwrap();
        }
        settle(&mut cloth, 2.0);
        assert_finite_and_slow(&cloth, 1.0);
        let mut follow = |cloth: &Cloth, change: &Change| {
            let vertices = faulty.positions.len() + change.vertices.len();
            faulty.positions.resize(vertices, Vec3::ZERO);
            assert_eq!(vertices, cloth.topology.vertex_particle.len());
            assert_consistent(&cloth.topology);
            assert!((mass(cloth) / mass_before - 1.0).abs() < 1e-5);
            assert!((area(&cloth.topology) / area_before - 1.0).abs() < 1e-5);
        };
        for _ in 0..12 {
            if random.random_bool(0.6) {
                let particles: Vec<u32> = cloth.topology.particles().collect();
                let particle = particles[random.random_range(0..particles.len())];
                let pull = if random.random_bool(0.5) { Direction::Weft } else { Direction::Warp };
                let Some(change) = cloth.tear_at(particle, pull) else { continue };
                follow(&cloth, &change);
                tears += 1;
            } else {
                let mut ray = || {
                    let [x, y] = [0, 1].map(|_| random.random_range(-0.6_f32..0.6));
                    [Vec3::new(x, y - 0.2, 1.0), Vec3::new(x, y - 0.2, -1.0)]
                };
                let Some(cut) = cloth.cut(&Blade { from: ray(), to: ray() }) else { continue };
                follow(&cloth, &cut.change);
                cuts += 1;
            }
            run(&mut cloth, 0.1);
            assert!(fastest(&cloth).is_finite());
        }
        let burnt: Vec<u32> = (0..cloth.topology.triangles.len() as u32).filter(|_| random.random_bool(0.1)).collect();
        if cloth.remove_triangles(&burnt).is_some() {
            assert_consistent(&cloth.topology);
        }
        settle(&mut cloth, 0.5);
        assert!(fastest(&cloth).is_finite());
    }
    assert!(tears > 60 && cuts > 30, "{tears} tears, {cuts} cuts");
}

/// Two sheets that meet in one particle, the upper left corner of one being the lower right one of the other.
fn two_that_meet() -> (Cloth, u32) {
    let (lower, triangles) = irregular(Vec2::ONE, [4, 4]);
    let count = lower.len() as u32;
    let positions: Vec<Vec3> =
        lower.iter().copied().chain(lower.iter().map(|p| *p + Vec3::new(1.0, 1.0, 0.0))).collect();
    let both: Vec<[u32; 3]> = triangles.iter().copied().chain(triangles.iter().map(|t| t.map(|v| v + count))).collect();
    let source = MeshSource { positions: &positions, uvs: &[], indices: both.as_flattened() };
    let cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &Fabric::COTTON_POPLIN).unwrap();
    let joint = cloth.topology.particles().find(|slot| cloth.topology.rest[*slot as usize] == Vec3::new(0.5, 0.5, 0.0));
    (cloth, joint.unwrap())
}

#[test]
fn what_meets_in_one_particle_stays_together_until_it_is_torn_there() {
    let mut torn_beside = 0;
    for pull in [Direction::Weft, Direction::Warp] {
        let (whole, joint) = two_that_meet();
        assert_eq!(whole.topology.pieces().triangles.len(), 1);
        assert!(whole.topology.mended.is_nothing());
        let near: Vec<u32> =
            whole.topology.edges.iter().filter(|edge| edge.contains(&joint)).flatten().copied().collect();
        for beside in near.into_iter().filter(|slot| *slot != joint) {
            let (mut cloth, joint) = two_that_meet();
            torn_beside += usize::from(cloth.tear_at(beside, pull).is_some());
            let pieces = cloth.topology.pieces();
            let both: Vec<u32> =
                cloth.topology.triangles.iter().filter(|t| t.contains(&joint)).flatten().copied().collect();
            let on = |upper: bool| both.iter().any(|slot| (cloth.topology.rest[*slot as usize].x > 0.5) == upper);
            assert!(on(false) && on(true), "it was parted by a tear beside it");
            assert_eq!(pieces.triangles.len(), 1);
            assert!(cloth.tear_at(joint, pull).is_some());
            assert!(cloth.topology.pieces().triangles.len() > 1, "a tear there parts it");
        }
        let (mut cloth, joint) = two_that_meet();
        let one = cloth.topology.triangles.iter().position(|t| t.contains(&joint)).unwrap() as u32;
        cloth.remove_triangles(&[one]).unwrap();
        assert_consistent(&cloth.topology);
    }
    assert!(torn_beside > 2, "{torn_beside}");
}
