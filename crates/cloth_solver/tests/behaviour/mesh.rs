//! Cloth from any mesh behaves as cloth from a rectangle does.

use std::sync::Arc;

use crate::common::*;
use cloth_solver::constraint::Wear;
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, Fabric, Method, Tick, Topology, measure};
use glam::{UVec2, Vec2, Vec3};

/// The rectangle's own triangles, as a renderer's mesh; with `seam`, every triangle has vertices of its own.
fn as_mesh(size: Vec2, cells: UVec2, seam: bool) -> (Vec<Vec3>, Vec<Vec2>, Vec<u32>) {
    let grid = Topology::rectangle(size, Resolution::Cells(cells)).unwrap();
    let uv = |p: Vec3| Vec2::new(p.x / size.x + 0.5, 0.5 - p.y / size.y);
    let at = |i: &u32| grid.rest[*i as usize];
    if seam {
        let positions: Vec<Vec3> = grid.triangles.iter().flatten().map(at).collect();
        let indices = (0..positions.len() as u32).collect();
        return (positions.clone(), positions.into_iter().map(uv).collect(), indices);
    }
    let positions: Vec<Vec3> = grid.vertex_particle.iter().map(at).collect();
    let vertex = |slot: &u32| grid.vertex_particle.iter().position(|s| s == slot).unwrap() as u32;
    let indices = grid.triangles.iter().flatten().map(vertex).collect();
    (positions.clone(), positions.into_iter().map(uv).collect(), indices)
}

fn mesh(size: Vec2, cells: UVec2, seam: bool, fabric: &Fabric) -> Cloth {
    let (positions, uvs, indices) = as_mesh(size, cells, seam);
    let source = MeshSource { positions: &positions, uvs: &uvs, indices: &indices };
    Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), fabric).unwrap()
}

fn pin_top_edge(cloth: &mut Cloth) {
    let top = cloth.topology.particles().map(|p| cloth.topology.rest[p as usize].y).fold(f32::MIN, f32::max);
    let rest = &cloth.topology.rest;
    let pinned: Vec<u32> = cloth.topology.particles().filter(|p| rest[*p as usize].y > top - 1e-4).collect();
    pin_top(cloth, pinned);
}

#[test]
fn a_mesh_stretches_along_warp_and_weft_by_their_own_stiffness() {
    for (turned, stiffness) in [(false, 40.0), (true, 20.0)] {
        let fabric = Fabric { stretch_warp: 40.0, stretch_weft: 20.0, shear: 0.0, ..Fabric::COTTON_POPLIN };
        let (positions, mut uvs, indices) = as_mesh(Vec2::new(0.25, 0.5), UVec2::new(10, 20), false);
        if turned {
            uvs = uvs.iter().map(|uv| Vec2::new(uv.y, uv.x)).collect();
        }
        let source = MeshSource { positions: &positions, uvs: &uvs, indices: &indices };
        let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &fabric).unwrap();
        pin_top_edge(&mut cloth);
        for _ in 0..1200 {
            cloth.step(Tick { substeps: 40, ..TICK }, GRAVITY);
        }
        let bottom = |p: &u32| cloth.topology.rest[*p as usize].y < -0.25 + 1e-4;
        let heights = cloth.topology.particles().filter(bottom).map(|p| cloth.particles.position.get(p as usize).y);
        let low = heights.sum::<f32>() / 11.0;
        let expected = 0.15 * 9.81 * 0.5 * 0.5 / (2.0 * stiffness);
        let elongation = -0.25 - low;
        assert!((elongation / expected - 1.0).abs() < 0.05, "{elongation} m, not {expected} m");
    }
}

fn positions_low(cloth: &Cloth) -> f32 {
    positions(cloth).iter().map(|x| x.y).fold(f32::MAX, f32::min)
}

#[test]
fn a_mesh_whose_triangles_share_no_vertex_hangs_together() {
    let mut cloth = mesh(Vec2::ONE, UVec2::new(12, 12), true, &Fabric::COTTON_POPLIN);
    assert_eq!(cloth.topology.particle_count(), 13 * 13);
    assert_eq!(cloth.topology.vertex_particle.len(), 12 * 12 * 6);
    pin_top_edge(&mut cloth);
    run(&mut cloth, 3.0);
    assert!(positions_low(&cloth) > -0.6, "it fell to {}", positions_low(&cloth));
    assert!(measure::largest_strain(&cloth.topology, &cloth.particles) < 0.05);
}

/// An irregular square metre of cotton hung by its upper corners or its upper edge, after four seconds.
fn hung(corners: bool, substeps: u32) -> Cloth {
    let (positions, triangles) = irregular(Vec2::ONE, [24, 24]);
    let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
    let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &fabric).unwrap();
    let held = |p: &u32| {
        let rest = cloth.topology.rest[*p as usize];
        rest.y > 0.499 && (!corners || rest.x.abs() > 0.499)
    };
    let pinned: Vec<u32> = cloth.topology.particles().filter(held).collect();
    pin_top(&mut cloth, pinned);
    for _ in 0..240 {
        cloth.step(Tick { substeps, ..TICK }, GRAVITY);
    }
    cloth
}

#[test]
fn an_irregular_mesh_hung_by_two_corners_keeps_its_size_and_comes_to_rest() {
    for (corners, substeps, most) in [(true, 10, 0.02), (true, 5, 0.04), (false, 10, 0.002)] {
        let cloth = hung(corners, substeps);
        let strain = measure::largest_strain(&cloth.topology, &cloth.particles);
        assert!(strain < most, "{strain} with {substeps} substeps");
        let speed = measure::rms_speed(&cloth.topology, &cloth.particles);
        assert!(speed < 0.01, "{speed} m/s");
    }
}

#[test]
fn a_mesh_hangs_where_the_rectangle_does() {
    let size = Vec2::new(0.6, 0.6);
    let mut grid = rectangle(size.x, size.y, 16, 16, &Fabric::COTTON_POPLIN);
    let mut mesh = mesh(size, UVec2::splat(16), false, &Fabric::COTTON_POPLIN);
    pin_top(&mut grid, 0..=16);
    pin_top_edge(&mut mesh);
    run(&mut grid, 5.0);
    run(&mut mesh, 5.0);
    assert!((positions_low(&grid) - positions_low(&mesh)).abs() < 0.01 * size.y);
}

#[test]
fn what_wore_a_mesh_still_does_after_another_method_was_tried() {
    let low = |tried: bool| {
        let (positions, triangles) = irregular(Vec2::new(0.3, 0.6), [6, 12]);
        let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
        let fabric = Fabric { damping: 5.0, ..Fabric::COTTON_JERSEY };
        let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &fabric).unwrap();
        pin_top_edge(&mut cloth);
        let slots = cloth.topology.slots();
        cloth.constraints.wear(Some(Wear { stiffness: &vec![0.2; slots], rest: &vec![1.0; slots] }));
        if tried {
            cloth.set_method(Method::XpbdSweeps);
            cloth.set_method(Method::XpbdLines);
        }
        run(&mut cloth, 3.0);
        positions_low(&cloth)
    };
    let (kept, tried) = (low(false), low(true));
    assert!(kept < -0.31 && (kept - tried).abs() < 1e-4, "{kept} m and {tried} m");
}

#[test]
fn a_mesh_of_steel_hung_by_its_corners_stays_finite() {
    let fabric = Fabric { stretch_warp: 1e7, stretch_weft: 1e7, ..Fabric::PAPER };
    let mut cloth = mesh(Vec2::splat(0.1), UVec2::splat(20), false, &fabric);
    let rest = |p: &u32| cloth.topology.rest[*p as usize];
    let corner = |p: &u32| rest(p).y > 0.0499 && rest(p).x.abs() > 0.0499;
    let corners: Vec<u32> = cloth.topology.particles().filter(corner).collect();
    assert_eq!(corners.len(), 2);
    pin_top(&mut cloth, corners);
    run(&mut cloth, 1.0);
    assert!(cloth.particles.is_finite());
    assert!(positions_low(&cloth) > -0.2, "it fell to {} m", positions_low(&cloth));
}

#[test]
fn free_stiff_cloth_does_not_move_of_itself() {
    let (positions, triangles) = irregular(Vec2::splat(0.3), [12, 12]);
    let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
    let fabric = Fabric { bend_warp: 0.1, bend_weft: 0.1, damping: 0.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &fabric).unwrap();
    for i in 0..cloth.particles.slots() {
        let x = cloth.topology.rest[i];
        cloth.particles.velocity.set(i, Vec3::Z * (0.2 * (20.0 * x.x).sin()));
    }
    let before = measure::linear_momentum(&cloth.particles);
    let energy = measure::kinetic_energy(&cloth.particles);
    let mass: f64 = cloth.particles.mass.iter().map(|m| f64::from(*m)).sum();
    for _ in 0..300 {
        cloth.step(TICK, Vec3::ZERO);
    }
    let drift = (measure::linear_momentum(&cloth.particles) - before).length() / mass;
    assert!(drift < 1e-4, "{drift} m/s");
    assert!(measure::kinetic_energy(&cloth.particles) < energy);
}

#[test]
fn a_free_mesh_keeps_its_momentum() {
    let (positions, triangles) = irregular(Vec2::ONE, [16, 16]);
    let source = MeshSource { positions: &positions, uvs: &[], indices: triangles.as_flattened() };
    let mut cloth = Cloth::new(Arc::new(Topology::from_mesh(source).unwrap()), &UNDAMPED).unwrap();
    for i in 0..cloth.particles.slots() {
        let x = cloth.topology.rest[i];
        let spin = Vec3::new(0.4, 1.0, 2.0).cross(x);
        cloth.particles.velocity.set(i, Vec3::new(0.05, 0.0, 0.02) + spin + Vec3::Z * (3.0 * x.x * x.y));
    }
    let about = |cloth: &Cloth| measure::angular_momentum(&cloth.particles, measure::centre_of_mass(&cloth.particles));
    let (linear, angular) = (measure::linear_momentum(&cloth.particles), about(&cloth));
    for _ in 0..300 {
        cloth.step(TICK, Vec3::ZERO);
    }
    let drift = (measure::linear_momentum(&cloth.particles) - linear).length() / linear.length();
    assert!(drift < 3e-5, "{drift}");
    let turn = (about(&cloth) - angular).length() / angular.length();
    assert!(turn < 2e-3, "{turn}");
}
