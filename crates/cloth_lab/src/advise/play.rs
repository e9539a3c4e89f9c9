//! Plays a scene and keeps what is compared, predicted and timed.

use std::time::{Duration, Instant};

use cloth_advice::{Difference, Shape, Sheet};
use cloth_scene::{Scene, SceneError, World};
use cloth_solver::measure;

/// How often the shape is kept over the last half of the scene.
const SAMPLES: u32 = 10;
/// What moves slower than this, root mean square, is at rest, m/s.
pub const REST_SPEED: f32 = 0.03;
/// A particle farther than this from the scene's origin has exploded, m.
const EXPLODED: f32 = 1e5;

/// How a play ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It played to its end.
    Finished,
    /// A number was not finite, or a particle farther away than a town.
    Exploded,
    /// It took longer than it was given.
    TooSlow,
}

/// What was seen of a play.
#[derive(Clone, Debug)]
pub struct Recording {
    /// How it ended.
    pub end: End,
    /// Shapes at ten moments, evenly over the last half; the last is the end of the scene.
    pub shapes: Vec<Shape>,
    /// The mean over all ticks of the last half.
    pub mean: Shape,
    /// Median time of a tick, ms.
    pub median: f64,
    /// Time of the fastest tick, ms.
    pub least: f64,
    /// For each collider whether a cloth came near.
    pub touched: Vec<bool>,
    /// Largest tensile strain at any tick.
    pub largest_strain: f32,
    /// Largest speed of a particle at any tick, m/s.
    pub fastest: f32,
    /// Since when the cloth has been at rest at the end, s; `None` if it moves.
    pub at_rest_from: Option<f32>,
}

/// What two plays are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Every moment of the last half.
    Path,
    /// The end alone.
    End,
    /// The mean over the last half.
    Mean,
}

impl Recording {
    /// How far `other` is from this play.
    pub fn difference(&self, other: &Self, by: By) -> Difference {
        if self.end != End::Finished || other.end != End::Finished {
            return Difference::INFINITE;
        }
        match by {
            By::Path => Difference::worst(self.shapes.iter().zip(&other.shapes).map(|(a, b)| a.difference(b))),
            By::End => Difference::worst(self.shapes.last().zip(other.shapes.last()).map(|(a, b)| a.difference(b))),
            By::Mean => self.mean.difference(&other.mean),
        }
    }
}

/// Plays `scene` for no longer than `patience` of computing time.
///
/// # Errors
/// What in the scene is out of range.
pub fn play(scene: &Scene, patience: Duration) -> Result<Recording, SceneError> {
    let mut world = World::new(scene)?;
    let ticks = world.ticks();
    let half = ticks / 2;
    let mut recording = Recording {
        end: End::Finished,
        shapes: Vec::new(),
        mean: Shape::default(),
        median: 0.0,
        least: 0.0,
        touched: vec![false; scene.colliders.len()],
        largest_strain: 0.0,
        fastest: 0.0,
        at_rest_from: None,
    };
    let mut times = Vec::with_capacity(ticks as usize);
    let mut spent = Duration::ZERO;
    for tick in 1..=ticks {
        let begin = Instant::now();
        world.tick();
        let took = begin.elapsed();
        spent += took;
        times.push(took.as_secs_f64() * 1e3);
        recording.look(&world, tick);
        if recording.end == End::Exploded {
            break;
        }
        if spent > patience {
            recording.end = End::TooSlow;
            break;
        }
        if tick > half {
            let shape = shape_of(&world);
            recording.mean.add(&shape);
            // Moment i of n is the last tick of part i of the half.
            let part = |tick: u32| u64::from(tick - half) * u64::from(SAMPLES) / u64::from((ticks - half).max(1));
            if part(tick) > part(tick - 1) {
                recording.shapes.push(shape);
            }
        }
    }
    recording.mean.scale(1.0 / (ticks - half).max(1) as f32);
    times.sort_by(f64::total_cmp);
    recording.least = times.first().copied().unwrap_or(0.0);
    recording.median = times.get(times.len() / 2).copied().unwrap_or(0.0);
    Ok(recording)
}

impl Recording {
    fn look(&mut self, world: &World, tick: u32) {
        let time = tick as f32 / world.scene.rate;
        let mut rests = true;
        for cloth in &world.cloths {
            let (particles, topology) = (&cloth.particles, &cloth.topology);
            let (low, high) = measure::bounds(topology, &particles.position);
            if !particles.is_finite() || low.abs().max(high.abs()).max_element() > EXPLODED {
                self.end = End::Exploded;
                return;
            }
            rests &= measure::rms_speed(topology, particles) < REST_SPEED;
            self.largest_strain = self.largest_strain.max(measure::largest_strain(topology, particles));
            for slot in topology.particles().map(|slot| slot as usize) {
                let (point, velocity) = (particles.position.get(slot), particles.velocity.get(slot));
                self.fastest = self.fastest.max(velocity.length());
                // What is that near at the end of a tick may have touched within it.
                let near = 2.0 * cloth.contacts.offset + velocity.length() / world.scene.rate;
                for (touched, collider) in self.touched.iter_mut().zip(&cloth.contacts.colliders) {
                    if !*touched {
                        let local = collider.motion.to.inverse_point(point);
                        *touched = collider.shape.distance_and_normal(local).0 < near;
                    }
                }
            }
        }
        self.at_rest_from = if rests { self.at_rest_from.or(Some(time)) } else { None };
    }
}

/// The cloths of `world` as they are now.
fn shape_of(world: &World) -> Shape {
    let sheets = world.cloths.iter().zip(&world.frames).filter_map(|(cloth, frame)| {
        Sheet::of_grid(&cloth.topology, |slot| frame.point(cloth.particles.position.get(slot)))
    });
    Shape(sheets.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn played(text: &str) -> Recording {
        play(&Scene::from_ron(text).unwrap(), Duration::MAX).unwrap()
    }

    #[test]
    fn the_shape_is_kept_ten_times_and_last_at_the_end() {
        for seconds in [0.5, 1.0, 1.3] {
            let text = format!("(seconds: {seconds}, cloths: [(cells: (2, 2))])");
            let recording = played(&text);
            assert_eq!(recording.shapes.len(), SAMPLES as usize, "{seconds}");
            let mut world = World::new(&Scene::from_ron(&text).unwrap()).unwrap();
            (0..world.ticks()).for_each(|_| world.tick());
            assert_eq!(recording.shapes.last(), Some(&shape_of(&world)));
        }
    }

    #[test]
    fn a_collider_that_is_passed_by_is_told_from_one_that_is_hit() {
        let recording = played(
            "(seconds: 1, cloths: [(cells: (4, 4), place: (at: (0, 1, 0), turn: (-90, 0, 0)))], colliders: [
                (shape: Sphere(radius: 0.2), place: (at: (0, 0.5, 0))), (shape: Sphere(radius: 0.2), place: (at: (5, 0.5, 0)))])",
        );
        assert_eq!(recording.touched, [true, false]);
    }

    #[test]
    fn what_hangs_still_is_at_rest_and_what_falls_is_not() {
        let hung = played("(seconds: 1, cloths: [(cells: (4, 4), pins: [Top])])");
        assert!(hung.at_rest_from.is_some_and(|from| from < 0.5));
        assert!(played("(seconds: 1, cloths: [(cells: (4, 4))])").at_rest_from.is_none());
    }

    #[test]
    fn what_takes_too_long_is_stopped() {
        let scene = Scene::from_ron("(seconds: 1, cloths: [(cells: (4, 4))])").unwrap();
        assert_eq!(play(&scene, Duration::ZERO).unwrap().end, End::TooSlow);
    }
}
