//! The scenes that every engine plays, as plain numbers.

use std::sync::Arc;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::contact::{Collider, Shape};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, ClothError, Fabric, Method, Motion, Pose, Topology};
use glam::{Quat, UVec2, Vec2, Vec3};

/// Internal friction in the scenes that are judged at rest, 1/s. A pose at rest does not depend on it.
const SETTLING: f32 = 5.0;

/// A ball in the way.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Its centre, m.
    pub centre: Vec3,
    /// Its radius, m.
    pub radius: f32,
    /// Coulomb friction against the cloth.
    pub friction: f32,
}

/// When the strains of a scene are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    /// Mean over the last quarter of the run.
    AtRest,
    /// The largest of the whole run.
    Throughout,
}

/// A square sheet of 1 m, where it starts, what holds it and what it meets. Particles are numbered row by row from the
/// upper left.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What the scene is called.
    pub name: &'static str,
    /// What the sheet is made of.
    pub fabric: Fabric,
    /// Particles along each side.
    pub side: usize,
    /// Where each particle starts, at rest, m. Rest lengths are those of the flat sheet.
    pub start: Vec<Vec3>,
    /// Particles held where they start.
    pub pins: Vec<usize>,
    /// A particle with a further mass on it, kg.
    pub weight: Option<(usize, f32)>,
    /// What is in the way.
    pub ball: Option<Ball>,
    /// Length of the run, s.
    pub seconds: f32,
    /// When strains are taken.
    pub judged: Judged,
}

impl Setup {
    /// Where each particle of the flat sheet is, m.
    pub fn flat(&self) -> impl Iterator<Item = Vec3> + '_ {
        let part = |i: usize| i as f32 * self.spacing() - 0.5;
        (0..self.side * self.side).map(move |i| Vec3::new(part(i % self.side), -part(i / self.side), 0.0))
    }

    /// Two triangles to a cell, all diagonals from the upper left, so that inner particles have one mass.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let side = self.side;
        (0..(side - 1) * (side - 1))
            .flat_map(|cell| {
                let a = (cell / (side - 1) * side + cell % (side - 1)) as u32;
                let below = a + side as u32;
                [[a, below, below + 1], [a, below + 1, a + 1]]
            })
            .collect()
    }

    /// All scenes, for a sheet of `side` × `side` particles; those that come to rest are given `seconds` for it. They are
    /// scenes of the chart, under the same names.
    pub fn all(side: usize, seconds: f32) -> Vec<Self> {
        let last = side - 1;
        let hung = Self {
            name: "top-hung",
            fabric: Fabric { damping: SETTLING, ..Fabric::COTTON_POPLIN },
            side,
            start: sheet(side, Quat::IDENTITY),
            pins: (0..side).collect(),
            weight: None,
            ball: None,
            seconds,
            judged: Judged::AtRest,
        };
        let particle_mass = Fabric::COTTON_POPLIN.areal_density / (last * last) as f32;
        let weight = Some((side * side - 1, 1e3 * particle_mass));
        let corners = Self { name: "corner-hung", pins: vec![0, last], ..hung.clone() };
        let swing = Self {
            name: "swing",
            fabric: Fabric { damping: 0.0, ..Fabric::COTTON_POPLIN },
            start: sheet(side, Quat::from_rotation_x(core::f32::consts::FRAC_PI_2)),
            seconds: 2.0,
            judged: Judged::Throughout,
            ..hung.clone()
        };
        let drape = Self {
            name: "drape",
            fabric: Fabric::COTTON_POPLIN,
            start: sheet(side, Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2)),
            pins: Vec::new(),
            ball: Some(Ball {
                centre: Vec3::new(0.03, -0.262, 0.02),
                radius: 0.25,
                friction: Fabric::COTTON_POPLIN.friction,
            }),
            seconds: 0.6,
            ..swing.clone()
        };
        let weighed = Self { name: "weight", weight, ..hung.clone() };
        let weighed_corners = Self { name: "weight-corners", weight, ..corners.clone() };
        vec![hung, corners, weighed, weighed_corners, swing, drape]
    }

    /// Rest distance between neighbours, m.
    pub fn spacing(&self) -> f32 {
        1.0 / (self.side - 1) as f32
    }

    /// Rest state and connectivity of the sheet.
    ///
    /// # Errors
    /// A side that is too long for a rectangle of this project.
    pub fn topology(&self) -> Result<Topology, ClothError> {
        Topology::rectangle(Vec2::ONE, Resolution::Cells(UVec2::splat(self.side as u32 - 1)))
    }

    /// The sheet as this project simulates it.
    ///
    /// # Errors
    /// What in the scene is out of range.
    pub fn cloth(&self, method: Method) -> Result<Cloth, ClothError> {
        let mut cloth = Cloth::new(Arc::new(self.topology()?), &self.fabric)?;
        cloth.set_method(method);
        let slots: Vec<u32> = cloth.topology.vertex_particle.clone();
        for (slot, start) in slots.iter().zip(&self.start) {
            cloth.particles.position.set(*slot as usize, *start);
            cloth.particles.previous.set(*slot as usize, *start);
        }
        if let Some((particle, mass)) = self.weight {
            cloth.particles.add_mass(slots[particle] as usize, mass)?;
        }
        let pins = self.pins.iter().map(|&p| Pin { particle: slots[p], frame: 0, local: self.start[p] }).collect();
        cloth.constraints.set_pins(&mut cloth.particles, Pins { frames: vec![Motion::default()], pins })?;
        if let Some(ball) = self.ball {
            let motion = Motion::at_rest(Pose::new(ball.centre, Quat::IDENTITY));
            cloth.contacts.colliders.push(Collider {
                shape: Shape::sphere(ball.radius)?,
                motion,
                friction: ball.friction,
            });
        }
        Ok(cloth)
    }
}

/// Places of the particles of a flat sheet around the origin, turned.
fn sheet(side: usize, turn: Quat) -> Vec<Vec3> {
    let part = |i: usize| i as f32 / (side - 1) as f32 - 0.5;
    (0..side * side).map(|i| turn * Vec3::new(part(i % side), -part(i / side), 0.0)).collect()
}
