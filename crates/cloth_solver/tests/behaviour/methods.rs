//! Every method, on the same fabric.

use crate::common::*;
use cloth_solver::topology::{MeshSource, Resolution};
use cloth_solver::{Cloth, Fabric, Method, Tick, Topology, measure};
use glam::{UVec2, Vec2, Vec3};
use std::sync::Arc;

/// Soft enough for methods that step forces.
const SOFT: Fabric =
    Fabric { stretch_warp: 50.0, stretch_weft: 50.0, shear: 5.0, damping: 20.0, ..Fabric::COTTON_POPLIN };

fn budget(method: Method) -> Tick {
    match method {
        Method::XpbdLines => TICK,
        _ => Tick { substeps: 40, ..TICK },
    }
}

#[test]
fn every_method_but_two_stretches_a_hanging_strip_by_its_weight() {
    // PBD knows no stiffness, explicit Euler no stability.
    let others = |method: &Method| !matches!(method, Method::Pbd | Method::ExplicitEuler);
    for method in Method::ALL.into_iter().filter(others) {
        let mut cloth = rectangle(0.25, 0.5, 5, 10, &SOFT);
        cloth.set_method(method);
        pin_top(&mut cloth, 0..=5);
        for _ in 0..300 {
            cloth.step(budget(method), GRAVITY);
        }
        let tip = cloth.topology.grid.unwrap().slot(10, 2) as usize;
        let elongation = cloth.topology.rest[tip].y - cloth.particles.position.get(tip).y;
        let expected = 0.15 * 9.81 * 0.25 / (2.0 * 50.0);
        assert!((elongation / expected - 1.0).abs() < 0.03, "{elongation} m, not {expected} m, by {}", method.name());
    }
}

#[test]
fn methods_that_step_forces_keep_energy_as_their_order_says() {
    let lost = |method, substeps| {
        let fabric = Fabric { damping: 0.0, ..SOFT };
        let mut cloth = rectangle(0.5, 0.5, 8, 8, &fabric);
        cloth.set_method(method);
        for p in 0..cloth.topology.slots() {
            let x = cloth.topology.rest[p];
            cloth.particles.position.set(p, Vec3::new(x.x * 1.02, x.y * 0.99, 0.05 * x.x * x.y));
        }
        let energy = |cloth: &Cloth| {
            measure::kinetic_energy(&cloth.particles)
                + measure::elastic_energy(&cloth.topology, &cloth.particles, &fabric)
        };
        let start = energy(&cloth);
        for _ in 0..60 {
            cloth.step(Tick { substeps, ..TICK }, Vec3::ZERO);
        }
        (energy(&cloth) / start - 1.0).abs()
    };
    assert!(lost(Method::RungeKutta4, 80) < 1e-3);
    assert!(lost(Method::StormerVerlet, 80) < 0.02);
    assert!(lost(Method::SymplecticEuler, 80) < 0.1);
    let gained = lost(Method::ExplicitEuler, 80);
    assert!(gained > 1.0 || gained.is_nan(), "explicit Euler gains {gained}");
}

#[test]
fn forces_on_a_mesh_are_those_of_its_energy() {
    let sheet = Topology::rectangle(Vec2::new(0.5, 0.4), Resolution::Cells(UVec2::new(5, 4))).unwrap();
    let grid = sheet.grid.unwrap();
    let points: Vec<Vec3> = sheet.vertex_particle.iter().map(|p| sheet.rest[*p as usize]).collect();
    let vertex = |slot: u32| slot / grid.stride * grid.columns + slot % grid.stride;
    let indices: Vec<u32> = sheet.triangles.iter().flatten().map(|p| vertex(*p)).collect();
    let mesh = Topology::from_mesh(MeshSource { positions: &points, uvs: &[], indices: &indices }).unwrap();
    let fabric = Fabric { damping: 0.0, bend_warp: 1e-3, bend_weft: 1e-3, ..SOFT };
    let mut cloth = Cloth::new(Arc::new(mesh), &fabric).unwrap();
    cloth.set_method(Method::StormerVerlet);
    for p in 0..cloth.topology.slots() {
        let x = cloth.topology.rest[p];
        cloth.particles.position.set(p, Vec3::new(x.x * 1.02, x.y, 0.3 * x.x * x.x));
    }
    let energy = |cloth: &Cloth| {
        measure::kinetic_energy(&cloth.particles) + measure::elastic_energy(&cloth.topology, &cloth.particles, &fabric)
    };
    let start = energy(&cloth);
    for _ in 0..30 {
        cloth.step(Tick { substeps: 80, ..TICK }, Vec3::ZERO);
        assert!((energy(&cloth) / start - 1.0).abs() < 0.02, "{} of {start} J", energy(&cloth));
    }
}
