//! What a monkey does to which cloth: a plan drawn from a seed, and nothing else decides.

use std::f32::consts::TAU;

use cloth_solver::{Cloth, ClothError, Fabric, Method};
use glam::{UVec2, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::stability::random::Random;
use crate::validate::rig;

/// Most columns, and most rows.
const MOST: f64 = 20.0;
/// Least and largest side of a cell, m.
const SPACING: [f64; 2] = [0.015, 0.06];
/// Largest ratio of the sides of a cell.
const ASPECT: f64 = 3.0;
/// Ticks between two acts at most.
const PAUSE: f64 = 40.0;
/// The fastest wind, hand and ball, m/s.
const FASTEST: [f64; 3] = [20.0, 10.0, 30.0];
/// Least and largest radius of a ball, m.
const BALL: [f64; 2] = [0.03, 0.2];
/// Balls there may be.
pub const BALLS: u32 = 2;
/// Farthest that a ball appears from a particle, m.
const NEAR: f64 = 0.15;

/// What a monkey has at hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tool {
    /// A hand of 40 N that takes hold of the cloth, moves and lets go.
    Hand,
    /// Wind.
    Wind,
    /// A blade.
    Blade,
    /// Tears by order, beside those by load.
    Tear,
    /// A match.
    Fire,
    /// Balls that appear anywhere, and move.
    Ball,
}

impl Tool {
    /// All.
    pub const ALL: [Self; 6] = [Self::Hand, Self::Wind, Self::Blade, Self::Tear, Self::Fire, Self::Ball];

    /// As on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hand => "hand",
            Self::Wind => "wind",
            Self::Blade => "blade",
            Self::Tear => "tear",
            Self::Fire => "fire",
            Self::Ball => "ball",
        }
    }
}

/// What holds the cloth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Held {
    /// Its upper edge.
    Top,
    /// Its two upper corners.
    Corners,
    /// Its left edge.
    Side,
    /// Nothing.
    Free,
}

/// One act. A place on the cloth is a part of the list of its particles, or triangles: so it is there whatever is left of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Act {
    /// Cuts from one particle to another with rays along `along`.
    Cut {
        /// The two particles, 0..1.
        between: [f32; 2],
        /// Direction of the rays.
        along: Vec3,
    },
    /// Parts a particle, across the weft or the warp.
    Tear {
        /// The particle, 0..1.
        at: f32,
        /// Whether the weft is what breaks.
        weft: bool,
    },
    /// Takes hold of a triangle and moves.
    Grab {
        /// The triangle, 0..1.
        at: f32,
        /// Velocity of the hand, m/s.
        velocity: Vec3,
        /// For so many ticks; then it stays where it is.
        ticks: u32,
    },
    /// Lets go.
    LetGo,
    /// A uniform wind from now on, m/s.
    Wind(Vec3),
    /// Lights what is near a particle.
    Light {
        /// The particle, 0..1.
        at: f32,
        /// How near, m.
        radius: f32,
    },
    /// A ball appears beside a particle, or is put there.
    Put {
        /// Which ball.
        ball: u32,
        /// The particle, 0..1.
        at: f32,
        /// How far from it, m.
        off: Vec3,
        /// Radius, m.
        radius: f32,
    },
    /// A ball moves.
    Throw {
        /// Which ball.
        ball: u32,
        /// Velocity, m/s.
        velocity: Vec3,
        /// For so many ticks.
        ticks: u32,
    },
}

/// An act and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Due {
    /// Before that tick.
    pub tick: u32,
    /// The act.
    pub act: Act,
}

/// A cloth and what is done to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Name of the fabric's preset.
    pub fabric: String,
    /// Whether it is an irregular mesh and no rectangle.
    pub mesh: bool,
    /// Columns and rows.
    pub cells: UVec2,
    /// Width and height, m.
    pub size: Vec2,
    /// What holds it.
    pub held: Held,
    /// Whether it burns.
    pub burns: bool,
    /// For so many ticks.
    pub ticks: u32,
    /// The acts, in the order of their ticks.
    pub acts: Vec<Due>,
}

impl Plan {
    /// The plan of that seed, for a monkey with these tools.
    pub fn new(seed: u64, ticks: u32, tools: &[Tool]) -> Self {
        // Seeds side by side are far apart for what is drawn from them.
        let mut random = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
        let (fabric, _) = Fabric::PRESETS[random.below(Fabric::PRESETS.len())];
        let cells = UVec2::from([0; 2].map(|_| random.between(1.0, MOST + 1.0).floor().min(MOST) as u32));
        let (spacing, aspect) = (random.between(SPACING[0], SPACING[1]), random.between(1.0 / ASPECT, ASPECT).sqrt());
        let cell = Vec2::new((spacing * aspect) as f32, (spacing / aspect) as f32);
        let held = [Held::Top, Held::Corners, Held::Side, Held::Free][random.below(4)];
        let mut plan = Self {
            fabric: fabric.to_owned(),
            mesh: random.below(2) == 1,
            cells,
            size: cell * cells.as_vec2(),
            held,
            burns: tools.contains(&Tool::Fire),
            ticks,
            acts: Vec::new(),
        };
        let mut tick = random.below(PAUSE as usize) as u32;
        while tick < ticks && !tools.is_empty() {
            plan.acts.push(Due { tick, act: act(&mut random, tools) });
            tick += 1 + random.below(PAUSE as usize) as u32;
        }
        plan
    }

    /// The fabric; `None` if there is none of that name.
    pub fn fabric(&self) -> Option<Fabric> {
        Fabric::PRESETS.iter().find(|(name, _)| *name == self.fabric).map(|(_, fabric)| *fabric)
    }

    /// The cloth, upright, where it starts.
    ///
    /// # Errors
    /// None for a plan that was drawn.
    pub fn cloth(&self, fabric: &Fabric) -> Result<Cloth, ClothError> {
        let mut cloth = if self.mesh {
            let (positions, triangles) = rig::irregular(self.size, self.cells.into(), self.cells.x);
            rig::mesh(&positions, &triangles, fabric, Method::default())?
        } else {
            rig::rectangle(self.size.into(), self.cells.into(), fabric, Method::default())?
        };
        let edge = 0.4999 * self.size;
        match self.held {
            Held::Top => rig::hold(&mut cloth, |rest| rest.y > edge.y)?,
            Held::Corners => rig::hold(&mut cloth, |rest| rest.y > edge.y && rest.x.abs() > edge.x)?,
            Held::Side => rig::hold(&mut cloth, |rest| rest.x < -edge.x)?,
            Held::Free => {}
        }
        Ok(cloth)
    }
}

fn act(random: &mut Random, tools: &[Tool]) -> Act {
    let at = random.part() as f32;
    let [wind, hand, ball] = FASTEST;
    match tools[random.below(tools.len())] {
        Tool::Hand if random.below(4) == 0 => Act::LetGo,
        Tool::Hand => {
            let velocity = direction(random) * (hand * random.part()) as f32;
            Act::Grab { at, velocity, ticks: random.below(60) as u32 }
        }
        Tool::Wind if random.below(4) == 0 => Act::Wind(Vec3::ZERO),
        Tool::Wind => Act::Wind(direction(random) * (wind * random.part()) as f32),
        Tool::Blade => Act::Cut { between: [at, random.part() as f32], along: direction(random) },
        Tool::Tear => Act::Tear { at, weft: random.below(2) == 1 },
        Tool::Fire => Act::Light { at, radius: 0.1 * random.part() as f32 },
        Tool::Ball => {
            let of = random.below(BALLS as usize) as u32;
            if random.below(2) == 0 {
                let off = direction(random) * (NEAR * random.part()) as f32;
                Act::Put { ball: of, at, off, radius: random.between(BALL[0], BALL[1]) as f32 }
            } else {
                let velocity = direction(random) * (ball * random.part()) as f32;
                Act::Throw { ball: of, velocity, ticks: random.below(60) as u32 }
            }
        }
    }
}

/// A direction, none likelier than another.
fn direction(random: &mut Random) -> Vec3 {
    let (height, turn) = (2.0 * random.part() as f32 - 1.0, TAU * random.part() as f32);
    let across = (1.0 - height * height).max(0.0).sqrt();
    Vec3::new(across * turn.cos(), height, across * turn.sin())
}
