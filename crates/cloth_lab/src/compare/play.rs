//! Playing a scene on an engine: how long it takes and how far it stretches.

use std::time::Instant;

use cloth_solver::{ClothError, Particles, Topology, measure};
use glam::Vec3;

use super::scenes::{Judged, Setup};

/// Ticks per second of every run, Hz.
pub const RATE: f32 = 60.0;

/// Farther than this from the origin, m, cloth has flown apart.
const GONE: f32 = 100.0;

/// A cloth engine with one sheet in it.
pub trait Engine {
    /// Advances by one tick of `1/RATE` s; `false` if the engine gave up.
    fn tick(&mut self) -> bool;

    /// Writes where the particles are, row by row from the upper left, m.
    fn positions(&self, out: &mut Vec<Vec3>);
}

/// What came of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It ended with finite strains.
    Ok,
    /// It flew apart, or the engine gave up.
    Diverged,
    /// The engine has no such thing; why.
    Unsupported(String),
}

/// A run in numbers.
#[derive(Clone, Debug)]
pub struct Played {
    /// Time to simulate one second on one core, s.
    pub cost: f64,
    /// Largest strain along warp and weft, dimensionless.
    pub largest: f64,
    /// Mean of the amounts of strain along warp and weft, dimensionless.
    pub mean: f64,
    /// Whether the numbers mean anything.
    pub outcome: Outcome,
}

impl Played {
    /// A run that did not take place.
    pub fn unsupported(reason: impl Into<String>) -> Self {
        let outcome = Outcome::Unsupported(reason.into());
        Self { cost: f64::NAN, largest: f64::NAN, mean: f64::NAN, outcome }
    }
}

/// Plays `setup` on `engine`.
///
/// # Errors
/// A sheet that this project refuses, whose strains it therefore cannot measure.
pub fn play(setup: &Setup, engine: &mut dyn Engine) -> Result<Played, ClothError> {
    let topology = setup.topology()?;
    let mut particles = Particles::new(&topology, setup.fabric.areal_density);
    let mut positions = Vec::with_capacity(setup.start.len());
    let ticks = (setup.seconds * RATE).round() as u32;
    let (mut largest, mut mean, mut samples) = (0.0, 0.0, 0.0);
    let mut spent = 0.0;
    for tick in 0..ticks {
        let start = Instant::now();
        let advanced = engine.tick();
        spent += start.elapsed().as_secs_f64();
        let cost = spent / f64::from(tick + 1) * f64::from(RATE);
        engine.positions(&mut positions);
        if !advanced || positions.iter().any(|p| !p.is_finite() || p.length() > GONE) {
            return Ok(Played { cost, largest: f64::NAN, mean: f64::NAN, outcome: Outcome::Diverged });
        }
        if setup.judged == Judged::AtRest && tick < ticks * 3 / 4 {
            continue;
        }
        let (now, mean_now) = strains(&topology, &mut particles, &positions);
        largest = if setup.judged == Judged::AtRest { largest + now } else { f64::max(largest, now) };
        mean += mean_now;
        samples += 1.0;
    }
    largest = if setup.judged == Judged::AtRest { largest / samples } else { largest };
    Ok(Played { cost: spent / f64::from(setup.seconds), largest, mean: mean / samples, outcome: Outcome::Ok })
}

/// Largest strain and mean amount of strain along warp and weft.
fn strains(topology: &Topology, particles: &mut Particles, positions: &[Vec3]) -> (f64, f64) {
    for (slot, position) in topology.vertex_particle.iter().zip(positions) {
        particles.position.set(*slot as usize, *position);
    }
    let (sum, count) = measure::edge_strains(topology, particles)
        .fold((0.0, 0.0), |(sum, count), (_, strain)| (sum + f64::from(strain.abs()), count + 1.0));
    (f64::from(measure::largest_strain(topology, particles)), sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sheet of a setup, all of it moved by `speed` m/s.
    struct Carried {
        places: Vec<Vec3>,
        speed: f32,
    }

    impl Engine for Carried {
        fn tick(&mut self) -> bool {
            self.places.iter_mut().for_each(|place| place.x += self.speed / RATE);
            true
        }

        fn positions(&self, out: &mut Vec<Vec3>) {
            out.clone_from(&self.places);
        }
    }

    fn carried(speed: f32, stretch: f32) -> Played {
        let setup = &Setup::all(8, 1.0)[0];
        let places = setup.start.iter().map(|p| *p * (1.0 + stretch)).collect();
        play(setup, &mut Carried { places, speed }).unwrap()
    }

    #[test]
    fn a_sheet_that_moves_as_it_is_keeps_its_strain() {
        let played = carried(1.0, 0.02);
        assert_eq!(played.outcome, Outcome::Ok);
        assert!((played.largest - 0.02).abs() < 1e-5 && (played.mean - 0.02).abs() < 1e-5);
    }

    #[test]
    fn a_sheet_that_flies_away_has_diverged() {
        assert_eq!(carried(1e4, 0.0).outcome, Outcome::Diverged);
        assert_eq!(carried(f32::NAN, 0.0).outcome, Outcome::Diverged);
    }
}
