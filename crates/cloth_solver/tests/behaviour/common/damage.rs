//! What must hold of cloth that is taken apart.

use std::collections::HashMap;
use std::sync::Arc;

use cloth_solver::damage::Blade;
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Topology};
use glam::Vec3;

use super::rectangle;

/// A blade that sweeps straight down −z over the sheet, from above `from` to above `to`.
pub fn blade(from: [f32; 2], to: [f32; 2]) -> Blade {
    Blade { from: ray(from), to: ray(to) }
}

pub fn ray([x, y]: [f32; 2]) -> [Vec3; 2] {
    [Vec3::new(x, y, 1.0), Vec3::new(x, y, -1.0)]
}

/// The same sheet without rows and columns.
pub fn as_mesh(sheet: &Cloth, fabric: &Fabric) -> Cloth {
    let topology = &sheet.topology;
    let positions: Vec<Vec3> = topology.vertex_particle.iter().map(|slot| topology.rest[*slot as usize]).collect();
    let indices: Vec<u32> = topology.triangle_vertices.iter().flatten().copied().collect();
    let mesh = Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap();
    Cloth::new(Arc::new(mesh), fabric).unwrap()
}

pub fn euler(topology: &Topology) -> i64 {
    topology.particle_count() as i64 - topology.edges.len() as i64 + topology.triangles.len() as i64
}

pub fn area(topology: &Topology) -> f64 {
    topology.triangle_rest.iter().map(|rest| 0.5 * f64::from(rest.determinant())).sum()
}

pub fn mass(cloth: &Cloth) -> f64 {
    cloth.particles.mass.iter().map(|mass| f64::from(*mass)).sum()
}

/// At most two triangles an edge, one fan a particle, areas that add up, render vertices that follow their particles.
pub fn assert_sound(cloth: &Cloth) {
    let topology = &cloth.topology;
    let mut around: HashMap<u32, Vec<usize>> = HashMap::new();
    let mut beside: HashMap<[u32; 2], usize> = HashMap::new();
    for (triangle, corners) in topology.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            assert!(topology.is_particle(a), "triangle {triangle} stands on what is no particle");
            around.entry(a).or_default().push(triangle);
            *beside.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
        for (vertex, slot) in topology.triangle_vertices[triangle].iter().zip(corners) {
            assert_eq!(topology.vertex_particle[*vertex as usize], *slot);
        }
    }
    assert!(beside.values().all(|count| *count <= 2), "an edge has more than two triangles");
    assert_eq!(beside.len(), topology.edges.len());
    for (slot, fan) in &around {
        let mut reached = vec![fan[0]];
        let mut next = 0;
        while let Some(triangle) = reached.get(next).copied() {
            next += 1;
            for other in fan {
                let shared = topology.triangles[triangle].iter().filter(|s| topology.triangles[*other].contains(s));
                if shared.count() == 2 && !reached.contains(other) {
                    reached.push(*other);
                }
            }
        }
        assert_eq!(reached.len(), fan.len(), "particle {slot} has more than one fan");
    }
    let inner = beside.values().filter(|count| **count == 2).count();
    assert_eq!(topology.hinges.len(), inner, "every inner edge has a hinge");
    for ([a, b, c, d], sharing) in topology.hinges.iter().zip(&topology.hinge_triangles) {
        let [first, second] = sharing.map(|triangle| topology.triangles[triangle as usize]);
        assert!(
            [a, b, c].iter().all(|slot| first.contains(slot)) && [a, b, d].iter().all(|slot| second.contains(slot))
        );
    }
    let of_particles: f64 = topology.area.iter().map(|area| f64::from(*area)).sum();
    assert!((of_particles / area(topology) - 1.0).abs() < 1e-5);
    assert_eq!(around.len(), topology.particle_count());
}

pub fn both(width: u32, height: u32) -> [Cloth; 2] {
    let sheet = rectangle(1.0, 1.0, width, height, &Fabric::COTTON_POPLIN);
    [as_mesh(&sheet, &Fabric::COTTON_POPLIN), sheet]
}
