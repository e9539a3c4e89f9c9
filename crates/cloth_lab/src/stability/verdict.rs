//! How a run held: survived, inaccurate, exploded.

use std::time::Instant;

use cloth_scene::World;
use cloth_solver::{Cloth, measure};

use super::trial::Trial;
use crate::chart::run::{is_lost, place};

/// Largest strain error of an accurate run.
const ACCURATE: f64 = 0.01;
/// Speed above which a run has exploded, m/s.
const FASTEST: f32 = 100.0;
/// Kinetic energy above which a run has exploded, in energies it had to begin with and got by falling.
const GROWN: f64 = 10.0;

/// How a run held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Finite, its motion bounded, its largest strain within 1 % of the reference's.
    Survived,
    /// Finite and bounded, but off by more than that.
    Inaccurate,
    /// Not finite, faster than 100 m/s, or with ten times the energy it had to begin with and got by falling.
    Exploded,
}

impl Verdict {
    /// All, in the order of the classes of a map.
    pub const ALL: [Self; 3] = [Self::Survived, Self::Inaccurate, Self::Exploded];

    /// As a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Survived => "survived",
            Self::Inaccurate => "inaccurate",
            Self::Exploded => "exploded",
        }
    }
}

/// What was seen of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Whether it was lost: not finite, or faster than 100 m/s.
    pub lost: bool,
    /// Largest kinetic energy over the energy there was to begin with and that of what has fallen since.
    pub energy: f64,
    /// Difference of the largest strain at the end from the reference's.
    pub strain_error: f64,
    /// Steps taken.
    pub steps: u64,
}

impl Seen {
    /// What it amounts to.
    pub fn verdict(&self) -> Verdict {
        if self.lost || self.energy.is_nan() || self.energy > GROWN {
            Verdict::Exploded
        } else if self.strain_error <= ACCURATE {
            Verdict::Survived
        } else {
            Verdict::Inaccurate
        }
    }
}

/// Plays a trial for its ticks, or until `wall` seconds of computing are over, but ten ticks at least.
pub fn play(trial: &Trial, wall: f64) -> Seen {
    let mut seen = Seen::default();
    let Ok(mut world) = World::new(&trial.scene) else { return Seen { lost: true, ..seen } };
    place(&mut world.cloths[0], &trial.start);
    let fallen = |cloth: &Cloth| -measure::gravitational_energy(&cloth.particles, trial.scene.gravity);
    let before = fallen(&world.cloths[0]);
    let began = Instant::now();
    for tick in 1..=trial.ticks {
        world.tick();
        seen.steps += u64::from(trial.scene.substeps);
        let cloth = &world.cloths[0];
        if is_lost(cloth, FASTEST) {
            seen.lost = true;
            return seen;
        }
        // What stretches too far falls, and may move as fast as that makes it: it is inaccurate, no more.
        let had = trial.energy + (fallen(cloth) - before).max(0.0);
        seen.energy = seen.energy.max(measure::kinetic_energy(&cloth.particles) / had);
        if seen.energy > GROWN || (tick >= 10 && began.elapsed().as_secs_f64() > wall) {
            break;
        }
    }
    let cloth = &world.cloths[0];
    let strain = f64::from(measure::largest_strain(&cloth.topology, &cloth.particles));
    seen.strain_error = (strain - trial.strain).abs();
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_judged_by_what_was_seen_of_it() {
        let fine = Seen { lost: false, energy: 0.9, strain_error: 0.005, steps: 1 };
        assert_eq!(fine.verdict(), Verdict::Survived);
        assert_eq!(Seen { strain_error: 0.02, ..fine }.verdict(), Verdict::Inaccurate);
        assert_eq!(Seen { strain_error: f64::NAN, ..fine }.verdict(), Verdict::Inaccurate);
        assert_eq!(Seen { energy: 11.0, ..fine }.verdict(), Verdict::Exploded);
        assert_eq!(Seen { energy: f64::NAN, ..fine }.verdict(), Verdict::Exploded);
        assert_eq!(Seen { lost: true, ..fine }.verdict(), Verdict::Exploded);
    }
}
