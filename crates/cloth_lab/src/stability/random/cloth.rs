//! What is drawn by lot.

use std::f32::consts::TAU;

use cloth_solver::contact::{Collider, Shape};
use cloth_solver::forces::Air;
use cloth_solver::{Cloth, ClothError, Fabric, Method, Motion, Pose};
use glam::{Quat, UVec2, Vec2, Vec3};

use super::Random;
use crate::validate::hang::level;
use crate::validate::rig;

/// Most cells of a cloth.
pub const MOST_CELLS: u32 = 1600;
/// Most columns, and most rows.
const MOST: f64 = 64.0;
/// Least and largest width and height, m.
const SIZE: [f64; 2] = [0.05, 3.0];
/// Largest ratio of the sides of a cell.
const ASPECT: f64 = 8.0;
/// How far out of its plane a cloth starts, in the mean of its sides: flat, it might stay flat.
const BULGE: f32 = 1e-3;
/// Radius of the ball in larger sides of the cloth.
const BALL: f32 = 0.25;

/// What keeps a cloth from falling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Its upper edge.
    Top,
    /// Its two upper corners.
    Corners,
    /// Its upper left corner; it starts with its middle below that.
    Corner,
    /// Its left edge.
    Side,
    /// A ball that it is laid on, a little off the middle. The ball stands on the ground.
    Ball,
}

impl Held {
    /// All.
    pub const ALL: [Self; 5] = [Self::Top, Self::Corners, Self::Corner, Self::Side, Self::Ball];

    /// As it stands in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Top => "top",
            Self::Corners => "two corners",
            Self::Corner => "one corner",
            Self::Side => "side",
            Self::Ball => "ball",
        }
    }
}

/// A cloth drawn by lot.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// What it was drawn from: the same seed, the same cloth.
    pub seed: u64,
    /// Name of the fabric.
    pub preset: &'static str,
    /// The fabric.
    pub fabric: Fabric,
    /// Whether it is an irregular mesh and no rectangle with rows and columns.
    pub mesh: bool,
    /// Columns and rows.
    pub cells: UVec2,
    /// Width and height, m.
    pub size: Vec2,
    /// What holds it.
    pub held: Held,
    /// Phases of the bulge that it starts with, rad.
    bulge: [f32; 2],
}

impl Sample {
    /// The cloth of that seed; those of odd seeds are irregular meshes. Columns, rows, width and ratio of a cell's sides are
    /// even in their logarithm, drawn again until all is within its range.
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let (preset, fabric) = Fabric::PRESETS[random.below(Fabric::PRESETS.len())];
        let held = Held::ALL[random.below(Held::ALL.len())];
        let bulge = [0; 2].map(|_| TAU * random.part() as f32);
        let (cells, size) = loop {
            let cells = [0; 2].map(|_| random.between(1.0, MOST + 1.0).floor().min(MOST));
            let width = random.between(SIZE[0], SIZE[1]);
            let height = width / cells[0] * cells[1] / random.between(1.0 / ASPECT, ASPECT);
            if cells[0] * cells[1] <= f64::from(MOST_CELLS) && (SIZE[0]..=SIZE[1]).contains(&height) {
                break (UVec2::from(cells.map(|count| count as u32)), Vec2::new(width as f32, height as f32));
            }
        };
        Self { seed, preset, fabric, mesh: seed % 2 == 1, cells, size, held, bulge }
    }

    /// Width of a cell over its height.
    pub fn aspect(&self) -> f64 {
        let cell = self.size / self.cells.as_vec2();
        f64::from(cell.x / cell.y)
    }

    /// The cloth where it starts, in still air.
    ///
    /// # Errors
    /// None: all is within its range.
    pub fn cloth(&self) -> Result<Cloth, ClothError> {
        let (size, cells) = (self.size, self.cells);
        let mut cloth = if self.mesh {
            let (positions, triangles) = rig::irregular(size, cells.into(), self.seed as u32);
            rig::mesh(&positions, &triangles, &self.fabric, Method::default())?
        } else {
            rig::rectangle(size.into(), cells.into(), &self.fabric, Method::default())?
        };
        let mean = 0.5 * size.element_sum();
        let bulged = |rest: Vec3| {
            let waves = (5.0 * rest.x / mean + self.bulge[0]).sin() * (4.0 * rest.y / mean + self.bulge[1]).sin();
            rest + Vec3::Z * (BULGE * mean * waves)
        };
        let edge = 0.4999 * size;
        let (top, left) = (|rest: Vec3| rest.y > edge.y, |rest: Vec3| rest.x < -edge.x);
        let upright = Quat::from_rotation_z(if self.held == Held::Corner { -(size.x / size.y).atan() } else { 0.0 });
        let radius = BALL * size.max_element();
        let on_ball = Vec3::new(0.1 * radius, radius + cloth.contacts.offset, 0.07 * radius);
        rig::put(&mut cloth, |rest| match self.held {
            Held::Ball => on_ball + level(bulged(rest)),
            _ => upright * bulged(rest),
        });
        match self.held {
            Held::Top => rig::hold(&mut cloth, top)?,
            Held::Corners => rig::hold(&mut cloth, |rest| top(rest) && rest.x.abs() > edge.x)?,
            Held::Corner => rig::hold(&mut cloth, |rest| top(rest) && left(rest))?,
            Held::Side => rig::hold(&mut cloth, left)?,
            Held::Ball => {
                let solid = |shape, at| {
                    let motion = Motion::at_rest(Pose::new(at, Quat::IDENTITY));
                    Collider { shape, motion, friction: self.fabric.friction }
                };
                let ball = solid(Shape::sphere(radius)?, Vec3::ZERO);
                cloth.contacts.set_colliders([ball, solid(Shape::HalfSpace, Vec3::NEG_Y * radius)]);
            }
        }
        cloth.air = Some(Air::default());
        Ok(cloth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cloth_is_within_its_ranges_and_the_same_from_the_same_seed() {
        for seed in 0..200 {
            let sample = Sample::new(seed);
            assert!(sample.cells.min_element() >= 1 && sample.cells.max_element() <= 64, "{sample:?}");
            assert!(sample.size.min_element() >= 0.05 && sample.size.max_element() <= 3.0001, "{sample:?}");
            assert!((1.0 / 8.01..=8.01).contains(&sample.aspect()), "{sample:?}");
            assert_eq!(format!("{sample:?}"), format!("{:?}", Sample::new(seed)));
        }
    }

    #[test]
    fn each_way_of_holding_pins_what_it_says() {
        for held in Held::ALL {
            for mesh in [false, true] {
                let drawn = Sample { held, mesh, cells: UVec2::new(6, 4), size: Vec2::new(0.9, 0.4), ..Sample::new(3) };
                let cloth = drawn.cloth().unwrap();
                let expected = match held {
                    Held::Top => 7,
                    Held::Corners => 2,
                    Held::Corner => 1,
                    Held::Side => 5,
                    Held::Ball => 0,
                };
                assert_eq!(cloth.constraints.pins().pins.len(), expected, "{held:?}, mesh: {mesh}");
                assert_eq!(cloth.topology.grid.is_none(), mesh);
            }
        }
    }
}
