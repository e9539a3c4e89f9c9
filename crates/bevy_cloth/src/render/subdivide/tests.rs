use std::collections::HashMap;

use cloth_solver::topology::{MeshSource, Resolution};

use super::*;

/// What is drawn of a topology whose particles are where `place` puts them from rest.
fn drawn(topology: &Topology, parts: u32, place: impl Fn(Vec3) -> Vec3) -> Subdivision {
    supported(topology, parts, place, &[])
}

fn supported(topology: &Topology, parts: u32, place: impl Fn(Vec3) -> Vec3, supports: &[Vec3]) -> Subdivision {
    let positions: Vec<Vec3> = topology.rest.iter().copied().map(place).collect();
    let mut subdivision = Subdivision::new(topology, parts);
    subdivision.apply(topology, &positions, &mut vec![Vec3::ZERO; positions.len()], supports);
    subdivision
}

/// A square metre of so many cells either way.
fn square(cells: u32) -> Topology {
    Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(cells))).expect("a square metre")
}

fn from_triangles(positions: &[Vec3], triangles: &[[u32; 3]]) -> Topology {
    let source = MeshSource { positions, uvs: &[], indices: triangles.as_flattened() };
    Topology::from_mesh(source).expect("a mesh")
}

/// A sphere of radius 1 m around the origin: an octahedron, each edge divided in 4 or 16.
fn sphere(rounds: u32) -> Topology {
    let mut positions = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let mut triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..rounds {
        let coarse = from_triangles(&positions, &triangles);
        let finer = drawn(&coarse, 4, |p| p);
        triangles = finer.triangles().to_vec();
        positions = finer.positions().iter().map(|p| p.normalize()).collect();
    }
    from_triangles(&positions, &triangles)
}

/// A fan of `corners` triangles around the origin.
fn disc(corners: u32) -> Topology {
    let corner = |i| Vec2::from_angle(i as f32 * std::f32::consts::TAU / corners as f32).extend(0.0);
    let positions: Vec<Vec3> = (0..corners).map(corner).chain([Vec3::ZERO]).collect();
    from_triangles(&positions, &(0..corners).map(|i| [i, (i + 1) % corners, corners]).collect::<Vec<_>>())
}

/// An upright tube of `corners` by 3 cells, with two vertices for each particle where it closes.
fn tube(corners: u32) -> Topology {
    let place = |i: u32, j: u32| {
        let around = Vec2::from_angle((i % corners) as f32 * std::f32::consts::TAU / corners as f32);
        Vec3::new(around.x, j as f32 / 3.0, around.y)
    };
    let positions: Vec<Vec3> = (0..4).flat_map(|j| (0..=corners).map(move |i| place(i, j))).collect();
    let cells = (0..3).flat_map(|j| (0..corners).map(move |i| j * (corners + 1) + i));
    let triangles = cells.flat_map(|a| {
        let [b, c, d] = [a + 1, a + corners + 1, a + corners + 2];
        [[a, c, b], [b, c, d]]
    });
    from_triangles(&positions, &triangles.collect::<Vec<_>>())
}

/// The largest distance from a surface of the corners and the middles of triangles.
fn largest_error(triangles: &[[u32; 3]], positions: &[Vec3], distance: impl Fn(Vec3) -> f32) -> f32 {
    let middles = triangles.iter().map(|corners| corners.map(|i| positions[i as usize]).iter().sum::<Vec3>() / 3.0);
    positions.iter().copied().chain(middles).map(|p| distance(p).abs()).fold(0.0, f32::max)
}

/// How many times nearer to a surface the drawn cloth is than its particles' triangles.
fn gain(topology: &Topology, parts: u32, place: impl Fn(Vec3) -> Vec3, distance: impl Fn(Vec3) -> f32) -> f32 {
    let positions: Vec<Vec3> = topology.rest.iter().copied().map(&place).collect();
    let fine = drawn(topology, parts, place);
    largest_error(&topology.triangles, &positions, &distance)
        / largest_error(fine.triangles(), fine.positions(), &distance)
}

/// A quarter of a cylinder of radius 1 m around an upright axis.
fn bent(p: Vec3) -> Vec3 {
    let angle = p.x * std::f32::consts::FRAC_PI_2;
    Vec3::new(angle.sin(), p.y, angle.cos())
}

fn off_cylinder(p: Vec3) -> f32 {
    p.xz().length() - 1.0
}

#[test]
fn particles_stay_where_they_are_and_each_triangle_becomes_4_or_16() {
    let topology = square(5);
    for (parts, times) in [(2, 4), (4, 16)] {
        let fine = drawn(&topology, parts, bent);
        assert_eq!(fine.triangles().len(), times * topology.triangles.len());
        for (vertex, slot) in topology.vertex_particle.iter().enumerate() {
            assert_eq!(fine.positions()[vertex], bent(topology.rest[*slot as usize]));
        }
        assert_eq!(fine.vertices(), ((5 * parts + 1) * (5 * parts + 1)) as usize);
    }
}

#[test]
fn a_plane_stays_a_plane_of_equal_parts() {
    let topology = square(4);
    for parts in [2, 4] {
        let fine = drawn(&topology, parts, |p| p);
        let spacing = 0.25 / parts as f32;
        for (position, normal) in fine.positions().iter().zip(fine.normals()) {
            assert_eq!((position.z, *normal), (0.0, Vec3::Z));
            let cell = (position.truncate() + 0.5) / spacing;
            assert!(cell.distance(cell.round()) < 1e-4, "a vertex at {position}");
        }
    }
}

#[test]
fn triangles_are_wound_as_the_cloth_and_leave_no_gap_and_no_overlap() {
    let topology = square(3);
    for parts in [2, 4] {
        let fine = drawn(&topology, parts, |p| p);
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| fine.positions()[vertex as usize].truncate());
        let areas = fine.triangles().iter().map(corners).map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a));
        let least = areas.clone().fold(f32::MAX, f32::min);
        assert!(least > 0.0 && (areas.sum::<f32>() - 1.0).abs() < 1e-5, "least {least}");
        let mut sides = HashMap::new();
        for triangle in fine.triangles() {
            for corner in 0..3 {
                let (a, b) = (triangle[corner], triangle[(corner + 1) % 3]);
                *sides.entry((a.min(b), a.max(b))).or_insert(0) += 1;
            }
        }
        let open = sides.values().filter(|count| **count == 1).count();
        assert_eq!(open, 4 * 3 * parts as usize);
        assert!(sides.values().all(|count| *count <= 2));
    }
}

#[test]
fn a_coarse_sphere_is_nearly_4_or_16_times_nearer_to_the_true_one() {
    let gains = [2, 4].map(|parts| gain(&sphere(1), parts, |p| p, |p| p.length() - 1.0));
    assert!(gains[0] > 3.5 && gains[1] > 12.0, "nearer by {gains:?}");
}

#[test]
fn a_coarse_cylinder_is_nearly_4_or_16_times_nearer_to_the_true_one() {
    for cells in [3, 6, 12] {
        let gains = [2, 4].map(|parts| gain(&square(cells), parts, bent, off_cylinder));
        assert!(gains[0] > 3.5 && gains[1] > 10.0, "of {cells} cells, nearer by {gains:?}");
    }
}

#[test]
fn normals_are_those_of_the_true_surface() {
    let fine = drawn(&square(6), 4, bent);
    for (position, normal) in fine.positions().iter().zip(fine.normals()) {
        let off = normal.distance(position.with_y(0.0).normalize());
        assert!(off < 0.001, "off by {off} at {position}");
    }
}

#[test]
fn a_crease_stays_sharp_and_what_is_flat_beside_it_flat() {
    // Folded by 60° along a column of particles.
    let fold = |p: Vec3| if p.x > 0.0 { Vec3::new(0.5 * p.x, p.y, 0.866 * p.x) } else { p };
    for parts in [2, 4] {
        for position in drawn(&square(4), parts, fold).positions() {
            let off = if position.x > 0.0 { position.z - position.x * 1.732 } else { position.z };
            assert!(off.abs() < 1e-6, "{off} m off the crease at {position}");
        }
    }
}

#[test]
fn nothing_sinks_below_ground_beside_a_fold() {
    // A fold of one particle's height stands up between flat parts.
    let fold = |p: Vec3| if p.x.abs() < 0.1 { p.with_z(0.1) } else { p };
    for parts in [2, 4] {
        let lowest = drawn(&square(8), parts, fold).positions().iter().map(|p| p.z).fold(f32::MAX, f32::min);
        assert!(lowest >= -1e-6, "{lowest} m");
    }
}

#[test]
fn a_valley_between_particles_that_lie_on_the_ground_does_not_sink_into_it() {
    // Two columns lie on the ground, their neighbours are lifted.
    let topology = square(7);
    let valley = |p: Vec3| p.with_z((p.x.abs() - 0.08).max(0.0));
    let lowest = |fine: &Subdivision| fine.positions().iter().map(|p| p.z).fold(f32::MAX, f32::min);
    assert!(lowest(&drawn(&topology, 4, valley)) < -0.005, "it would sink if nothing were known of the ground");
    let supports: Vec<Vec3> =
        topology.rest.iter().map(|p| if valley(*p).z == 0.0 { Vec3::Z } else { Vec3::ZERO }).collect();
    let found = lowest(&supported(&topology, 4, valley, &supports));
    assert!(found >= -1e-6, "{found} m");
}

#[test]
fn a_round_rim_becomes_rounder_and_a_corner_stays() {
    let disc = disc(24);
    let fine = drawn(&disc, 4, |p| p);
    let farthest = fine.positions().iter().map(|p| p.length()).fold(0.0, f32::max);
    assert!(farthest < 1.0 + 1e-3);
    let area = |triangles: &[[u32; 3]], positions: &[Vec3]| -> f32 {
        let corners = triangles.iter().map(|triangle| triangle.map(|i| positions[i as usize]));
        corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).z).sum()
    };
    let missing = std::f32::consts::PI - area(fine.triangles(), fine.positions());
    let before = std::f32::consts::PI - area(&disc.triangles, &disc.rest);
    assert!(missing < before / 10.0, "{missing} m² missing of {before}");

    // A single cell is nothing but corners.
    let cell = drawn(&square(1), 4, |p| p);
    assert!(cell.positions().iter().all(|p| p.abs().max_element() <= 0.5));
}

#[test]
fn both_sides_of_a_seam_have_the_same_positions_to_the_last_bit() {
    let topology = tube(8);
    assert!(topology.vertex_particle.len() > topology.particle_count(), "the mesh has no seam");
    let fine = drawn(&topology, 4, |p| p * Vec3::new(1.1, 1.0, 0.9));
    let mut sides = HashMap::new();
    for triangle in fine.triangles() {
        let corners = triangle.map(|vertex| fine.positions()[vertex as usize].to_array().map(f32::to_bits));
        for corner in 0..3 {
            let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
            *sides.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    let open = sides.values().filter(|count| **count == 1).count();
    assert_eq!(open, 2 * 8 * 4, "only the two rims are open");
}

#[test]
fn values_of_vertices_are_spread_evenly() {
    let topology = square(3);
    for parts in [2, 4] {
        let fine = drawn(&topology, parts, |p| p);
        let mut values = vec![[0.0_f32; 2]; fine.vertices()];
        for (value, slot) in values.iter_mut().zip(&topology.vertex_particle) {
            *value = topology.rest[*slot as usize].truncate().to_array();
        }
        fine.spread(&mut values);
        for (value, position) in values.iter().zip(fine.positions()) {
            assert!(Vec2::from_array(*value).distance(position.truncate()) < 1e-6, "{value:?} at {position}");
        }
        let mut ones = vec![[1.0_f32]; fine.vertices()];
        ones[topology.vertex_particle.len()..].fill([0.0]);
        fine.spread(&mut ones);
        assert!(ones.iter().all(|one| *one == [1.0]), "weights do not sum to 1");
    }
}

#[test]
fn rebuilt_is_the_same_as_new() {
    let mut fine = drawn(&square(5), 4, bent);
    let other = square(3);
    fine.rebuild(&other);
    let new = Subdivision::new(&other, 4);
    assert_eq!((fine.triangles(), fine.vertices()), (new.triangles(), new.vertices()));
}
