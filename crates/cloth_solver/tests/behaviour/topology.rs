//! Meshes of every kind become cloth that a continuous surface of that kind would recognise.

use cloth_solver::Topology;
use cloth_solver::topology::{MeshSource, Resolution};
use glam::{Quat, UVec2, Vec2, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Particles − edges + triangles: 1 for a disc, 0 for a cylinder, torus or Möbius strip, 2 for a sphere.
fn euler_characteristic(topology: &Topology) -> i64 {
    topology.particle_count() as i64 - topology.edges.len() as i64 + topology.triangles.len() as i64
}

/// A band of `around` × `across` cells placed by `place`, its ends doubled vertices as a renderer has at a UV seam.
fn band(around: u32, across: u32, place: impl Fn(f32, f32) -> Vec3) -> Topology {
    let mut positions = Vec::new();
    for i in 0..=around {
        for j in 0..=across {
            positions.push(place(i as f32 / around as f32, j as f32 / across as f32));
        }
    }
    let vertex = |i: u32, j: u32| i * (across + 1) + j;
    let mut indices = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
            indices.extend([a, b, c, a, c, d]);
        }
    }
    Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap()
}

fn turned(u: f32) -> Quat {
    Quat::from_rotation_z(u * core::f32::consts::TAU)
}

#[test]
fn a_cylinder_and_a_torus_close_across_their_seams() {
    let cylinder = band(24, 5, |u, v| turned(u) * Vec3::new(1.0, 0.0, v));
    assert_eq!(euler_characteristic(&cylinder), 0);
    assert_eq!(cylinder.particle_count(), 24 * 6);
    assert_eq!(cylinder.hinges.len(), cylinder.edges.len() - 2 * 24);
    let torus = band(24, 12, |u, v| {
        let ring = Quat::from_rotation_y(v * core::f32::consts::TAU) * Vec3::new(0.3, 0.0, 0.0);
        turned(u) * (Vec3::X + ring)
    });
    assert_eq!(euler_characteristic(&torus), 0);
    assert_eq!(torus.hinges.len(), torus.edges.len());
}

#[test]
fn the_rest_angles_of_a_cylinder_add_up_to_a_full_turn() {
    let cylinder = band(24, 1, |u, v| turned(u) * Vec3::new(1.0, 0.0, v));
    let total: f32 = cylinder.hinge_rest.iter().sum();
    assert!((total.abs() - core::f32::consts::TAU).abs() < 1e-4, "{total}");
    assert!(cylinder.hinge_rest.iter().all(|angle| angle * total > -1e-6));
}

#[test]
fn a_moebius_strip_is_one_piece_with_a_gentle_fold_at_every_hinge() {
    let strip = band(48, 4, |u, v| {
        let half_turn = Quat::from_rotation_y(u * core::f32::consts::PI);
        turned(u) * (Vec3::X + half_turn * Vec3::new(0.0, 0.0, (v - 0.5) * 0.4))
    });
    assert_eq!(euler_characteristic(&strip), 0);
    assert_eq!(strip.particle_count(), 48 * 5);
    // The border is a single loop twice as long as the strip.
    assert_eq!(strip.hinges.len(), strip.edges.len() - 2 * 48);
    assert!(strip.hinge_rest.iter().all(|angle| angle.abs() < 0.5), "a seam folded over");
    assert!(strip.triangle_rest.iter().all(|rest| rest.determinant() > 0.0));
}

/// A rectangle taken apart: every triangle has three vertices of its own, in an order and with windings of chance.
#[derive(Debug)]
struct Apart {
    size: Vec2,
    cells: UVec2,
    scale: f32,
    turn: Quat,
    shuffle: Vec<u32>,
    turned_over: Vec<bool>,
}

fn apart() -> impl Strategy<Value = Apart> {
    let cells = (1_u32..7, 1_u32..7).prop_map(|(x, y)| UVec2::new(x, y));
    let numbers = (0.2_f32..2.0, 0.2_f32..2.0, -3.0_f32..3.0, prop::array::uniform3(-3.0_f32..3.0));
    (cells, numbers).prop_flat_map(|(cells, (width, height, decade, angles))| {
        let triangles = (2 * cells.x * cells.y) as usize;
        let shuffle = Just((0..triangles as u32).collect::<Vec<_>>()).prop_shuffle();
        // Less than half of them, so that the front stays the front.
        let turned_over = prop::collection::vec(any::<bool>(), (triangles - 1) / 2);
        (shuffle, turned_over).prop_map(move |(shuffle, turned_over)| Apart {
            size: Vec2::new(width, height),
            cells,
            scale: 10_f32.powf(decade),
            turn: Quat::from_euler(glam::EulerRot::XYZ, angles[0], angles[1], angles[2]),
            shuffle,
            turned_over,
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    #[test]
    fn a_rectangle_taken_apart_is_welded_to_the_same_sheet(apart in apart()) {
        let whole = Topology::rectangle(apart.size, Resolution::Cells(apart.cells)).unwrap();
        let mut positions = Vec::new();
        for (i, triangle) in apart.shuffle.iter().map(|i| whole.triangles[*i as usize]).enumerate() {
            let mut corners = triangle.map(|p| apart.turn * (whole.rest[p as usize] * apart.scale));
            if apart.turned_over.get(i) == Some(&true) {
                corners.swap(1, 2);
            }
            positions.extend(corners);
        }
        let indices: Vec<u32> = (0..positions.len() as u32).collect();
        let welded = Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap();

        prop_assert_eq!(welded.particle_count(), whole.particle_count());
        prop_assert_eq!(euler_characteristic(&welded), 1);
        prop_assert_eq!(welded.edges.len(), whole.edges.len());
        prop_assert_eq!(welded.hinges.len(), whole.hinges.len());
        prop_assert!(welded.hinge_rest.iter().all(|angle| angle.abs() < 1e-3));
        let area = apart.size.element_product() * apart.scale * apart.scale;
        prop_assert!((welded.area.iter().sum::<f32>() / area - 1.0).abs() < 1e-4);
        for (vertex, position) in positions.iter().enumerate() {
            let particle = welded.rest[welded.vertex_particle[vertex] as usize];
            prop_assert!(particle.distance(*position) <= 1e-5 * apart.scale);
        }
        for (triangle, rest) in welded.triangles.iter().zip(&welded.triangle_rest) {
            let [a, b, c] = triangle.map(|p| apart.turn.conjugate() * welded.rest[p as usize]);
            prop_assert!((b - a).cross(c - a).z > 0.0, "a triangle shows its back");
            for (found, expected) in
                [(rest.x_axis, b - a), (rest.y_axis, c - a), (rest.y_axis - rest.x_axis, c - b)]
            {
                prop_assert!((found.length() / expected.length() - 1.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn a_rectangle_of_any_size_weighs_its_area_and_is_its_own_mirror_image(
        width in 1e-3_f32..1e3, height in 1e-3_f32..1e3, x in 1_u32..40, y in 1_u32..40,
    ) {
        let sheet = Topology::rectangle(Vec2::new(width, height), Resolution::Cells(UVec2::new(x, y))).unwrap();
        let area: f64 = sheet.area.iter().map(|a| f64::from(*a)).sum();
        prop_assert!((area / (f64::from(width) * f64::from(height)) - 1.0).abs() < 1e-5);
        prop_assert_eq!(euler_characteristic(&sheet), 1);
        let grid = sheet.grid.unwrap();
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                let here = sheet.rest[grid.slot(row, column) as usize];
                let there = sheet.rest[grid.slot(y - row, x - column) as usize];
                prop_assert_eq!(here, -there);
            }
        }
    }
}
