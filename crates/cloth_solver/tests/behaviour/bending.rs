//! Bending: a strip clamped at one end droops as the heavy elastica does.

use std::sync::Arc;

use crate::common::*;
use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, Fabric, Motion, Topology};
use glam::{UVec2, Vec2, Vec3};

const LENGTH: f32 = 0.2;

/// Tip drop over tip reach of a horizontal strip clamped at x = 0, for Γ = σ g L³/D (Wang 1986 and oracles of textile
/// testing; computed by shooting).
const ELASTICA: [(f32, f32); 4] = [(1.0, 0.124_56), (3.0, 0.364_62), (10.0, 1.0668), (30.0, 2.5472)];

fn clamp(mut cloth: Cloth, spacing: f32) -> Cloth {
    let held = |p: &u32| cloth.topology.rest[*p as usize].x < -0.5 * LENGTH + 1.5 * spacing;
    let pins = cloth.topology.particles().filter(held).map(|particle| Pin {
        particle,
        frame: 0,
        local: cloth.topology.rest[particle as usize],
    });
    let pins = Pins { frames: vec![Motion::default()], pins: pins.collect() };
    cloth.constraints.set_pins(&mut cloth.particles, pins).unwrap();
    cloth
}

/// Drop over reach of the free end after it has come to rest.
fn droop(cloth: &mut Cloth, spacing: f32) -> f32 {
    settle(cloth, 20.0);
    let end = |p: &u32| cloth.topology.rest[*p as usize].x > 0.5 * LENGTH - 0.25 * spacing;
    let tips: Vec<Vec3> =
        cloth.topology.particles().filter(end).map(|p| cloth.particles.position.get(p as usize)).collect();
    let tip = tips.iter().sum::<Vec3>() / tips.len() as f32;
    // The clamp holds two columns; the strip is free from half-way between them on.
    let clamp = -0.5 * LENGTH + 0.5 * spacing;
    -tip.y / (tip.x - clamp)
}

/// A fabric whose strip, free over all but half a cell, has the given Γ.
fn fabric(gamma: f32, spacing: f32) -> Fabric {
    let bending = 0.15 * 9.81 * (LENGTH - 0.5 * spacing).powi(3) / gamma;
    Fabric { bend_warp: bending, bend_weft: bending, damping: 5.0, ..Fabric::COTTON_POPLIN }
}

fn horizontal(topology: &mut Topology) {
    for x in &mut topology.rest {
        *x = Vec3::new(x.x, 0.0, -x.y);
    }
}

#[test]
fn a_clamped_strip_droops_as_the_elastica_on_two_grids() {
    for cells in [20, 40] {
        let spacing = LENGTH / cells as f32;
        for (gamma, expected) in ELASTICA {
            let size = Vec2::new(LENGTH, 4.0 * spacing);
            let mut topology = Topology::rectangle(size, Resolution::Cells(UVec2::new(cells, 4))).unwrap();
            horizontal(&mut topology);
            let cloth = Cloth::new(Arc::new(topology), &fabric(gamma, spacing)).unwrap();
            let found = droop(&mut clamp(cloth, spacing), spacing);
            assert!((found / expected - 1.0).abs() < 0.05, "{found}, not {expected} at Γ = {gamma}, {cells} cells");
        }
    }
}

#[test]
fn a_clamped_strip_of_an_irregular_mesh_droops_as_the_elastica() {
    let (cells, gammas) = (cases(20, 40), [ELASTICA[1], ELASTICA[3]]);
    let spacing = LENGTH / cells as f32;
    for (gamma, expected) in gammas.into_iter().take(cases(1, 2)) {
        let (flat, triangles) = irregular(Vec2::new(LENGTH, 6.0 * spacing), [cells, 6]);
        let source = MeshSource { positions: &flat, uvs: &[], indices: triangles.as_flattened() };
        let mut topology = Topology::from_mesh(source).unwrap();
        horizontal(&mut topology);
        let cloth = Cloth::new(Arc::new(topology), &fabric(gamma, spacing)).unwrap();
        let found = droop(&mut clamp(cloth, spacing), spacing);
        assert!((found / expected - 1.0).abs() < 0.05, "{found}, not {expected} at Γ = {gamma}");
    }
}

/// Two triangles over an edge, folded by `angle`, without gravity.
fn folded(angle: f32) -> Cloth {
    let (sin, cos) = angle.sin_cos();
    let positions =
        [Vec3::ZERO, Vec3::new(0.0, 0.1, 0.0), Vec3::new(-0.08, 0.05, 0.0), Vec3::new(0.08 * cos, 0.05, -0.08 * sin)];
    let flat = [positions[0], positions[1], positions[2], Vec3::new(0.08, 0.05, 0.0)];
    let topology =
        Topology::from_mesh(MeshSource { positions: &flat, uvs: &[], indices: &[0, 1, 2, 1, 0, 3] }).unwrap();
    let fabric = Fabric { bend_warp: 1e-3, bend_weft: 1e-3, damping: 5.0, ..Fabric::COTTON_POPLIN };
    let mut cloth = Cloth::new(Arc::new(topology), &fabric).unwrap();
    for (vertex, &particle) in cloth.topology.vertex_particle.iter().enumerate() {
        cloth.particles.position.set(particle as usize, positions[vertex]);
    }
    cloth
}

/// The angle between the normals of the two triangles.
fn fold(cloth: &Cloth) -> f32 {
    let normal = |[a, b, c]: [u32; 3]| {
        let at = |i: u32| cloth.particles.position.get(i as usize);
        (at(b) - at(a)).cross(at(c) - at(a)).normalize()
    };
    normal(cloth.topology.triangles[0]).angle_between(normal(cloth.topology.triangles[1]))
}

#[test]
fn a_folded_hinge_opens_whichever_way_it_is_folded() {
    for angle in [0.3, -0.3, 1.5, -1.5, 3.0, -3.0] {
        let mut cloth = folded(angle);
        assert!((fold(&cloth) - f32::abs(angle)).abs() < 1e-3);
        for _ in 0..600 {
            cloth.step(TICK, Vec3::ZERO);
        }
        assert!(fold(&cloth) < 0.02, "{} rad left of {angle}", fold(&cloth));
    }
}
