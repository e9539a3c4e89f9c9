//! Random cloths: which of them come to rest.

mod cloth;
mod numbers;
mod write;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cloth_solver::{Cloth, ClothError, Tick, measure};
use glam::{DMat3, DVec3};

use crate::report::Output;
use crate::validate::rig::GRAVITY;
use crate::{LabError, progress};

pub use cloth::{Held, MOST_CELLS, Sample};
pub use numbers::Random;

/// How long each is watched, s.
const SECONDS: f32 = 20.0;
/// Ticks at the end in which it has to be at rest: half a second.
const LAST: usize = 30;
/// Root mean square speed below which a cloth is at rest, m/s.
const REST: f64 = 0.03;

/// What was seen of a cloth.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    /// Whether every number stayed finite.
    pub finite: bool,
    /// The largest root mean square speed of the last half second, m/s.
    pub speed: f64,
    /// The same of what is left of the motion without moving and turning as a whole.
    pub inner_speed: f64,
    /// The largest strain of the last half second.
    pub strain: f64,
    /// Mean number of substeps in a tick, of the whole run and of the last half second.
    pub substeps: [f64; 2],
    /// How long it took to compute, s.
    pub time: f64,
}

impl Seen {
    /// Whether it came to rest.
    pub fn rests(&self) -> bool {
        self.finite && self.speed < REST
    }
}

/// A cloth and what was seen of it.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The cloth.
    pub sample: Sample,
    /// What was seen.
    pub seen: Seen,
}

/// Plays a cloth at the default tick.
///
/// # Errors
/// What the solver refuses in it.
pub fn play(sample: &Sample) -> Result<Seen, ClothError> {
    let (mut cloth, began) = (sample.cloth()?, Instant::now());
    let tick = Tick::new(1.0 / 60.0);
    let ticks = (SECONDS / tick.dt).round() as usize;
    let mut seen = Seen { finite: true, ..Seen::default() };
    for number in 0..ticks {
        cloth.step(tick, GRAVITY);
        let taken = f64::from(cloth.pace.taken());
        seen.substeps[0] += taken / ticks as f64;
        if !cloth.particles.is_finite() {
            return Ok(Seen { finite: false, time: began.elapsed().as_secs_f64(), ..seen });
        }
        if number + LAST >= ticks {
            seen.substeps[1] += taken / LAST as f64;
            seen.speed = seen.speed.max(f64::from(measure::rms_speed(&cloth.topology, &cloth.particles)));
            seen.inner_speed = seen.inner_speed.max(inner_speed(&cloth));
            seen.strain = seen.strain.max(f64::from(measure::largest_strain(&cloth.topology, &cloth.particles)));
        }
    }
    Ok(Seen { time: began.elapsed().as_secs_f64(), ..seen })
}

/// Root mean square speed without the rigid motion that comes nearest, m/s: a swing as a whole fades by the air alone.
fn inner_speed(cloth: &Cloth) -> f64 {
    let particles = &cloth.particles;
    let centre = measure::centre_of_mass(particles);
    let mass = particles.mass.iter().map(|mass| f64::from(*mass)).sum::<f64>();
    let drift = measure::linear_momentum(particles) / mass;
    let states = || {
        (cloth.topology.particles().map(|slot| slot as usize)).map(|slot| {
            let arm = particles.position.get(slot).as_dvec3() - centre;
            (f64::from(particles.mass[slot]), arm, particles.velocity.get(slot).as_dvec3() - drift)
        })
    };
    let inertia = states().fold(DMat3::ZERO, |sum, (mass, arm, _)| {
        sum + mass * (arm.length_squared() * DMat3::IDENTITY - DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z))
    });
    let spin = inertia.inverse() * measure::angular_momentum(particles, centre);
    let spin = if spin.is_finite() { spin } else { DVec3::ZERO };
    let squares = states().map(|(mass, arm, velocity)| mass * (velocity - spin.cross(arm)).length_squared());
    (squares.sum::<f64>() / mass).sqrt()
}

/// Plays `count` random cloths, those of the seeds from `seed` on, on all cores.
///
/// # Errors
/// A file that could not be written.
pub fn run(count: u32, seed: u64, output: &Output) -> Result<(), LabError> {
    let samples: Vec<Sample> = (0..u64::from(count)).map(|number| Sample::new(seed.wrapping_add(number))).collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let bar = progress::bar(u64::from(count));
    let work = || {
        while let Some(sample) = samples.get(next.fetch_add(1, Ordering::Relaxed)) {
            // None of them is out of any range.
            let Ok(seen) = play(sample) else { continue };
            if let Ok(mut found) = found.lock() {
                found.push(Entry { sample: *sample, seen });
                bar.inc(1);
                if bar.is_hidden() && found.len().is_multiple_of(10) {
                    let restless = found.iter().filter(|entry| !entry.seen.rests()).count();
                    eprintln!("{} of {count} cloths, {restless} of them not at rest", found.len());
                }
            }
        }
    };
    std::thread::scope(|scope| {
        (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| {
            scope.spawn(work);
        });
    });
    bar.finish_and_clear();
    let mut entries = found.into_inner().unwrap_or_default();
    entries.sort_by_key(|entry| entry.sample.seed);
    write::write(&entries, output)?;
    let rest = entries.iter().filter(|entry| entry.seen.rests()).count();
    println!("{rest} of {} cloths at rest; results in {}", entries.len(), output.out.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_rigid_motion_has_no_inner_speed() {
        let mut cloth = Sample::new(2).cloth().unwrap();
        let spin = Vec3::new(0.3, -1.0, 2.0);
        for slot in cloth.topology.particles().map(|slot| slot as usize).collect::<Vec<_>>() {
            let velocity = Vec3::X + spin.cross(cloth.particles.position.get(slot));
            cloth.particles.velocity.set(slot, velocity);
        }
        assert!(inner_speed(&cloth) < 1e-4, "{}", inner_speed(&cloth));
    }
}
