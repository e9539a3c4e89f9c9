//! rapier3d's soft-body cloth: springs along warp, weft and both diagonals, and skip-one springs against bending.
//!
//! The mapping of an SI fabric, so that both engines mean the same cloth:
//! - **stretch and shear**: both diagonals of a cell get k₂ = G, the shear stiffness, and the edges k₁ such that a pull
//!   along warp or weft meets the stiffness Y: Y = k₁ + k₂ − k₂²/(k₁ + k₂). At the border edges k₁ is half of that, as
//!   they stand for half the width. A spring network has a Poisson ratio (k₂/(k₁ + k₂), about 1 % of poplin), which
//!   this project's fabric has not.
//! - **softness**: rapier takes a natural frequency and normalises it by the effective mass of each spring, so each edge
//!   gets f = √(k (w_a + w_b))/2π of its own, with w the inverse masses, and damping ratio 0: the implicit spring k.
//! - **bending**: a skip-one spring stores nothing to second order when flat, so no stiffness of it is the bending
//!   stiffness D. It gets k = 16 D/l² (times w/l of its line), which stores the energy of D at a turn of one radian.
//! - **mass**: each particle's own. **Friction inside**: `deformation_damping`, which is defined as this project's.
//! - **contact**: the sheet's thickness is this project's contact distance.

use rapier3d::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, SoftBodyBuilder, SoftBodyHandle, SoftBodyMaterial,
    SoftBodyParticleSettings, SpringCoefficients, Vector,
};

use glam::Vec3;

use super::ours::GRAVITY;
use super::play::{Engine, RATE};
use super::scenes::Setup;

/// A rapier3d world with one sheet in it.
pub struct Rapier {
    world: PhysicsWorld,
    sheet: SoftBodyHandle,
}

impl Rapier {
    /// The sheet of `setup` at `substeps` solver iterations, which rapier's soft bodies take as substeps, of `iterations`
    /// sweeps each (its default is 4).
    ///
    /// # Errors
    /// What this project's own sheet of the same scene would refuse.
    pub fn new(setup: &Setup, substeps: u32, iterations: u32) -> Result<Self, cloth_solver::ClothError> {
        let ours = setup.cloth(cloth_solver::Method::default())?;
        let masses: Vec<f32> = ours.topology.vertex_particle.iter().map(|p| ours.particles.mass[*p as usize]).collect();
        let (springs, bends) = springs(setup);
        let to = |p: &Vec3| Vector::new(p.x, p.y, p.z);
        let softness = softness(setup, &masses, springs.iter().chain(&bends));
        let mut sheet = SoftBodyBuilder::new(setup.flat().map(|p| to(&p)).collect())
            .edges(springs.iter().map(|s| s.ends.map(|p| p as u32)).collect())
            .bend_edges(bends.iter().map(|s| s.ends.map(|p| p as u32)).collect())
            .surface(setup.triangles())
            .masses(masses)
            .material(SoftBodyMaterial { deformation_damping: setup.fabric.damping, ..SoftBodyMaterial::default() })
            .particle_settings(SoftBodyParticleSettings {
                can_sleep: false,
                additional_pgs_iterations: 0,
                ..SoftBodyParticleSettings::default()
            })
            .pinned_particles(setup.pins.iter().map(|p| *p as u32))
            .particle_radius(ours.contacts.offset);
        sheet.edge_softness = softness;
        sheet = match setup.ball {
            Some(ball) => sheet.surface_collider(ColliderBuilder::ball(1.0).friction(ball.friction)),
            None => sheet.no_surface_collider(),
        };
        let mut world = PhysicsWorld { gravity: to(&GRAVITY), ..PhysicsWorld::default() };
        world.integration_parameters.dt = 1.0 / RATE;
        world.integration_parameters.num_solver_iterations = substeps as usize;
        world.integration_parameters.num_internal_pgs_iterations = iterations as usize;
        if let Some(ball) = setup.ball {
            let shape = ColliderBuilder::ball(ball.radius).friction(ball.friction).translation(to(&ball.centre));
            world.insert(RigidBodyBuilder::fixed(), shape);
        }
        let sheet = world.insert_soft_body(sheet);
        if let Some(body) = world.soft_bodies.get_mut(sheet) {
            for (particle, start) in setup.start.iter().enumerate() {
                body.set_particle_position(particle, to(start));
            }
        }
        Ok(Self { world, sheet })
    }
}

impl Engine for Rapier {
    fn tick(&mut self) -> bool {
        self.world.step();
        self.world.soft_bodies.get(self.sheet).is_some_and(|sheet| sheet.is_enabled())
    }

    fn positions(&self, out: &mut Vec<Vec3>) {
        out.clear();
        if let Some(sheet) = self.world.soft_bodies.get(self.sheet) {
            out.extend(sheet.particle_positions().map(|p| Vec3::new(p.x, p.y, p.z)));
        }
    }
}

/// A spring between two particles, N/m.
struct Spring {
    ends: [usize; 2],
    stiffness: f32,
}

/// The springs of the plane and those against bending.
fn springs(setup: &Setup) -> (Vec<Spring>, Vec<Spring>) {
    let (side, fabric) = (setup.side, &setup.fabric);
    let along = |stretch: f32| {
        let (y, k2) = (stretch, fabric.shear);
        0.5 * (y + (y * y + 4.0 * k2 * k2).sqrt()) - k2
    };
    let (weft, warp) = (along(fabric.stretch_weft), along(fabric.stretch_warp));
    let bend = |stiffness: f32| 16.0 * stiffness / (setup.spacing() * setup.spacing());
    let width = |line: usize| if line == 0 || line == side - 1 { 0.5 } else { 1.0 };
    let (mut plane, mut folds) = (Vec::new(), Vec::new());
    for row in 0..side {
        for column in 0..side {
            let here = row * side + column;
            let mut add = |to: usize, stiffness: f32| plane.push(Spring { ends: [here, to], stiffness });
            if column + 1 < side {
                add(here + 1, weft * width(row));
            }
            if row + 1 < side {
                add(here + side, warp * width(column));
            }
            if column + 1 < side && row + 1 < side {
                add(here + side + 1, fabric.shear);
            }
            if column > 0 && row + 1 < side {
                add(here + side - 1, fabric.shear);
            }
            if column + 2 < side {
                folds.push(Spring { ends: [here, here + 2], stiffness: bend(fabric.bend_weft) * width(row) });
            }
            if row + 2 < side {
                folds.push(Spring { ends: [here, here + 2 * side], stiffness: bend(fabric.bend_warp) * width(column) });
            }
        }
    }
    (plane, folds)
}

/// The natural frequency of each spring with the masses at its ends, numbered as rapier numbers edges.
fn softness<'a>(
    setup: &Setup,
    masses: &[f32],
    springs: impl Iterator<Item = &'a Spring>,
) -> Vec<(u32, SpringCoefficients<f32>)> {
    let mut inverse: Vec<f32> = masses.iter().map(|m| 1.0 / m).collect();
    for pin in &setup.pins {
        inverse[*pin] = 0.0;
    }
    springs
        .enumerate()
        .map(|(index, Spring { ends: [a, b], stiffness })| {
            let give = inverse[*a] + inverse[*b];
            // Between two pins there is nothing to solve; a frequency of 0 would be 0/0.
            let frequency = if give > 0.0 { (stiffness * give).sqrt() / core::f32::consts::TAU } else { 1.0 };
            (index as u32, SpringCoefficients::new(frequency, 0.0))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pull_along_a_thread_meets_the_stiffness_of_the_fabric() {
        let setup = &Setup::all(8, 1.0)[0];
        let (springs, _) = springs(setup);
        let of = |ends: [usize; 2]| springs.iter().find(|s| s.ends == ends).map_or(0.0, |s| s.stiffness);
        // Inside, from the second particle of the second row.
        let (edge, diagonal) = (of([9, 10]), of([9, 18]));
        let met = edge + diagonal - diagonal * diagonal / (edge + diagonal);
        assert!((met / setup.fabric.stretch_weft - 1.0).abs() < 1e-5, "{met} N/m");
        assert_eq!(of([0, 1]), 0.5 * edge);
        assert_eq!(diagonal, setup.fabric.shear);
    }

    #[test]
    fn no_spring_has_a_frequency_that_is_no_number() {
        for setup in Setup::all(8, 1.0) {
            let (springs, bends) = springs(&setup);
            let masses = vec![1e-3; setup.side * setup.side];
            for (_, softness) in softness(&setup, &masses, springs.iter().chain(&bends)) {
                assert!(softness.natural_frequency > 0.0 && softness.natural_frequency.is_finite());
            }
        }
    }

    #[test]
    fn the_sheet_hangs_under_its_top_edge() {
        let setup = &Setup::all(6, 1.0)[0];
        let mut engine = Rapier::new(setup, 10, 4).unwrap();
        assert!((0..60).all(|_| engine.tick()));
        let mut places = Vec::new();
        engine.positions(&mut places);
        let sunk = places.iter().zip(&setup.start).map(|(now, then)| then.distance(*now)).fold(0.0, f32::max);
        assert!(sunk < 0.05, "{sunk} m");
    }
}
