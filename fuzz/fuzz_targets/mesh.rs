//! Any numbers as a mesh: the reader refuses it with an error, or the cloth built from it can be simulated.

#![no_main]

use std::sync::Arc;

use arbitrary::Arbitrary;
use cloth_solver::topology::MeshSource;
use cloth_solver::{Cloth, Fabric, Tick, Topology};
use glam::{Vec2, Vec3};
use libfuzzer_sys::fuzz_target;

/// A mesh. Coordinates are small whole numbers now and then, so that vertices coincide and triangles share edges.
#[derive(Arbitrary, Debug)]
struct Mesh {
    positions: Vec<[Coordinate; 3]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u8>,
    is_wide: bool,
}

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Coordinate {
    Grid(i8),
    Any(f32),
}

impl Coordinate {
    fn metres(self) -> f32 {
        match self {
            Self::Grid(cells) => 0.01 * f32::from(cells),
            Self::Any(number) => number,
        }
    }
}

fuzz_target!(|mesh: Mesh| {
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| Vec3::from(p.map(Coordinate::metres))).collect();
    let uvs: Vec<Vec2> = mesh.uvs.iter().copied().map(Vec2::from).collect();
    // Few indices name a vertex that is not there, as every one above the number of vertices is an error of its own.
    let count = positions.len().max(1) as u32;
    let index = |index: &u8| if mesh.is_wide { u32::from(*index) } else { u32::from(*index) % count };
    let indices: Vec<u32> = mesh.indices.iter().map(index).collect();
    let source = MeshSource { positions: &positions, uvs: &uvs, indices: &indices };
    let Ok(topology) = Topology::from_mesh(source) else { return };
    assert!(topology.rest.iter().all(|rest| rest.is_finite()), "a mesh that is taken is finite");
    let Ok(mut cloth) = Cloth::new(Arc::new(topology), &Fabric::COTTON_POPLIN) else { return };
    for _ in 0..3 {
        cloth.step(Tick::new(1.0 / 60.0), Vec3::new(0.0, -9.81, 0.0));
    }
    assert!(cloth.particles.is_finite(), "a cloth that is built can be simulated");
});
