//! rapier-cloth-core: XPBD on the edges of a triangle mesh and on the dihedral angles between them.
//!
//! The mapping of an SI fabric, so that both engines mean the same cloth:
//! - **stretch and shear**: a cell has one diagonal; it gets twice the shear stiffness, k = 2 G, and warp and weft edges
//!   k₁ such that a pull along them meets the stiffness Y, as two diagonals of G would ask for. Border edges get half.
//!   Compliances are 1/k of each edge.
//! - **bending**: its angle constraints hold ½ s θ² with the stiffness s of this project's own hinges, `D b/s`.
//! - **mass**: thirds of triangles times the areal density: this project's but at the four corners, where it is a third
//!   and a sixth of a cell in place of a quarter.
//! - **a weight** can only be hung on as a force: the engine has no mass per particle. At rest that is the same.
//! - **friction inside**: `damping` slows all motion, rigid motion too; the same rate is given.
//! - **tethers** act only at compliance 0, as a second row with nothing else changed.

use cloth_solver::topology::MeshSource;
use glam::Vec3;
use rapier_cloth_core::{
    Cloth, ClothError, ClothMaterial, ClothMesh, Contact, ContactKey, ContactSource, ContactStage, Solver,
    SolverSettings, Vec3 as Theirs,
};

use super::ours::GRAVITY;
use super::play::{Engine, RATE};
use super::scenes::{Ball, Setup};

/// A sheet of rapier-cloth-core.
pub struct RapierCloth {
    cloth: Cloth,
    solver: Solver,
    settings: SolverSettings,
    substeps: u32,
    obstacle: Obstacle,
}

impl RapierCloth {
    /// The sheet of `setup`; where `rigid`, with compliance 0 and thereby tethers.
    ///
    /// # Errors
    /// What the engine does not take.
    pub fn new(setup: &Setup, substeps: u32, iterations: u32, rigid: bool) -> Result<Self, String> {
        let say = |error: ClothError| error.to_string();
        let own = setup.cloth(cloth_solver::Method::default()).map_err(|error| error.to_string())?;
        let mut mesh = ClothMesh::new(setup.flat().map(|p| theirs(&p)).collect(), setup.triangles()).map_err(say)?;
        let hinges = hinges(setup)?;
        mesh.scale_edge_compliance(|edge| 1.0 / stiffness(setup, edge.vertices)).map_err(say)?;
        let bend = |ends: [u32; 4]| hinges.get(&pair(ends[0], ends[1])).copied().unwrap_or(f32::MIN_POSITIVE);
        mesh.scale_hinge_stiffness(|hinge| bend(hinge.vertices)).map_err(say)?;
        let material = ClothMaterial {
            surface_density: setup.fabric.areal_density,
            stretch_compliance: if rigid { 0.0 } else { 1.0 },
            bend_compliance: 1.0,
            damping: setup.fabric.damping,
            friction: setup.fabric.friction,
            contact_radius: own.contacts.offset,
            stitch_compliance: 0.0,
        };
        let mut cloth = Cloth::new(mesh, material).map_err(say)?;
        let start: Vec<Theirs> = setup.start.iter().map(theirs).collect();
        cloth.set_positions(&start).map_err(say)?;
        for pin in &setup.pins {
            cloth.pin(*pin as u32, start[*pin]).map_err(say)?;
        }
        if let Some((particle, mass)) = setup.weight {
            cloth.set_force(particle as u32, theirs(&(GRAVITY * mass))).map_err(say)?;
        }
        let settings = SolverSettings { iterations: iterations as usize, ..SolverSettings::default() };
        Ok(Self { cloth, solver: Solver::new(), settings, substeps, obstacle: Obstacle(setup.ball) })
    }
}

impl Engine for RapierCloth {
    fn tick(&mut self) -> bool {
        let h = 1.0 / (RATE * self.substeps as f32);
        let Self { cloth, solver, settings, obstacle, .. } = self;
        (0..self.substeps)
            .all(|_| solver.step_with_contacts(cloth, h, theirs(&GRAVITY), settings, &[], obstacle).is_ok())
    }

    fn positions(&self, out: &mut Vec<Vec3>) {
        out.clear();
        out.extend(self.cloth.positions().iter().map(|p| Vec3::new(p.x, p.y, p.z)));
    }
}

/// The ball, if there is one, as the engine asks for it.
struct Obstacle(Option<Ball>);

impl ContactSource for Obstacle {
    fn contacts(
        &mut self,
        _: &[Theirs],
        positions: &[Theirs],
        radius: f32,
        _: ContactStage,
        out: &mut Vec<Contact>,
    ) -> Result<(), ClothError> {
        let Some(ball) = self.0 else { return Ok(()) };
        let centre = theirs(&ball.centre);
        for (particle, position) in positions.iter().enumerate() {
            let from = *position - centre;
            let distance = from.length();
            if distance < ball.radius + 2.0 * radius {
                let normal = if distance > 0.0 { from / distance } else { Theirs::Y };
                out.push(Contact {
                    key: ContactKey { particle: particle as u32, external: 0, feature: 0 },
                    normal,
                    point: centre + normal * ball.radius,
                    surface_velocity: Theirs::ZERO,
                    friction: ball.friction,
                });
            }
        }
        Ok(())
    }
}

fn theirs(v: &Vec3) -> Theirs {
    Theirs::new(v.x, v.y, v.z)
}

/// Stiffness of the edge between two particles, N/m.
fn stiffness(setup: &Setup, [a, b]: [u32; 2]) -> f32 {
    let (side, fabric) = (setup.side as u32, &setup.fabric);
    let along = |stretch: f32| {
        let (y, k2) = (stretch, fabric.shear);
        0.5 * (y + (y * y + 4.0 * k2 * k2).sqrt()) - k2
    };
    let width = |line: u32| if line == 0 || line == side - 1 { 0.5 } else { 1.0 };
    match b.abs_diff(a) {
        1 => along(fabric.stretch_weft) * width(a / side),
        apart if apart == side => along(fabric.stretch_warp) * width(a % side),
        _ => 2.0 * fabric.shear,
    }
}

/// Bending stiffness of each hinge by the ends of its edge, N·m per rad².
fn hinges(setup: &Setup) -> Result<std::collections::HashMap<[u32; 2], f32>, String> {
    let positions: Vec<Vec3> = setup.flat().collect();
    let indices: Vec<u32> = setup.triangles().into_iter().flatten().collect();
    let topology = cloth_solver::Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices })
        .map_err(|error| error.to_string())?;
    let mut vertex = vec![0; topology.slots()];
    for (index, particle) in topology.vertex_particle.iter().enumerate() {
        vertex[*particle as usize] = index as u32;
    }
    let ends = |hinge: &[u32; 4]| pair(vertex[hinge[0] as usize], vertex[hinge[1] as usize]);
    Ok(topology.hinges.iter().map(ends).zip(topology.hinge_stiffness(&setup.fabric)).collect())
}

fn pair(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_hangs_under_its_top_edge() {
        let setup = &Setup::all(6, 1.0)[0];
        for rigid in [false, true] {
            let mut engine = RapierCloth::new(setup, 10, 4, rigid).unwrap();
            assert!((0..60).all(|_| engine.tick()));
            let mut places = Vec::new();
            engine.positions(&mut places);
            let sunk = places.iter().zip(&setup.start).map(|(now, then)| then.distance(*now)).fold(0.0, f32::max);
            assert!(sunk < 0.05, "{sunk} m");
        }
    }

    #[test]
    fn every_inner_edge_of_the_mesh_bends_as_a_hinge_of_this_project() {
        let setup = &Setup::all(6, 1.0)[0];
        let hinges = hinges(setup).unwrap();
        let mesh = ClothMesh::new(setup.flat().map(|p| theirs(&p)).collect(), setup.triangles()).unwrap();
        assert_eq!(mesh.hinges().len(), hinges.len());
        assert!(mesh.hinges().iter().all(|hinge| hinges.contains_key(&pair(hinge.vertices[0], hinge.vertices[1]))));
    }
}
