//! A cloth that is played apart from its world, as it is or with a change.

use std::sync::Arc;
use std::time::Instant;

use cloth_solver::constraint::{Pin, Pins};
use cloth_solver::damage::{Tear, Tearing};
use cloth_solver::topology::Resolution;
use cloth_solver::{Cloth, ClothError, Fabric, Motion, Particles, Tick, Topology, measure};
use glam::{UVec2, Vec2, Vec3};

use crate::change::Change;
use crate::shape::{Shape, Sheet};

/// How often the shape is kept over the last half of a play.
const MOMENTS: u32 = 5;

/// A cloth that is played apart from its world: what it hangs on, solids and wind stand as they are at this moment.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The cloth.
    pub cloth: Cloth,
    /// What it is made of.
    pub fabric: Fabric,
    /// Gravity in the cloth's frame, m/s².
    pub gravity: Vec3,
    /// A tick.
    pub tick: Tick,
    /// What is known of its loads, and when it tears; `None` if it does not tear.
    pub tearing: Option<(Tear, Tearing)>,
}

/// What was seen of a play.
#[derive(Clone, Debug, Default)]
pub(crate) struct Played {
    /// Shapes at moments of the last half.
    pub shapes: Vec<Shape>,
    /// The mean over all ticks of the last half.
    pub mean: Shape,
    /// Time of a tick, ms: a quarter of them took less.
    pub time: f64,
    /// The most places at which it touched itself.
    pub touching: u32,
    /// The largest load over strength.
    pub load: f32,
}

impl Sample {
    /// Stops what moves it from outside: frames of pins, solids.
    pub(crate) fn stand(&mut self) {
        for frame in self.cloth.constraints.pin_frames_mut() {
            *frame = Motion::at_rest(frame.to);
        }
        for collider in &mut self.cloth.contacts.colliders {
            collider.motion = Motion::at_rest(collider.motion.to);
        }
    }

    /// Part of the elastic energy that `change` takes away, 0..=1.
    pub(crate) fn energy_share(&self, change: &Change) -> f64 {
        let mut without = self.fabric;
        change.change_fabric(&mut without);
        let energy = |fabric| measure::elastic_energy(&self.cloth.topology, &self.cloth.particles, fabric);
        let all = energy(&self.fabric);
        if all > 0.0 { (1.0 - energy(&without) / all).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The same with a change; `None` where the change does not apply to it.
    pub(crate) fn with(&self, change: &Change) -> Option<Self> {
        let mut sample = self.clone();
        match *change {
            Change::NoBending | Change::NoShear => {
                change.change_fabric(&mut sample.fabric);
                sample.make_of_fabric().ok()?;
            }
            Change::NoAir => sample.cloth.air = None,
            Change::NoSelfContact => sample.cloth.self_contacts = None,
            Change::NoTearing => sample.tearing = None,
            Change::Coarser(times) => sample = self.coarser(times)?,
            Change::Budget { method, substeps, iterations } => {
                sample.cloth.set_method(method);
                (sample.tick.substeps, sample.tick.iterations) = (substeps, iterations);
            }
            Change::Inextensible | Change::NoFriction | Change::NoColliders(_) => return None,
        }
        Some(sample)
    }

    /// Takes over another fabric; shape, speed, pins stay.
    fn make_of_fabric(&mut self) -> Result<(), ClothError> {
        let cloth = &mut self.cloth;
        let fresh = Cloth::new(cloth.topology.clone(), &self.fabric)?;
        let (pins, method) = (cloth.constraints.pins().clone(), cloth.constraints.method());
        cloth.constraints = fresh.constraints;
        cloth.constraints.set_pins(&mut cloth.particles, pins)?;
        cloth.set_method(method);
        Ok(())
    }

    /// On a mesh with so many times fewer cells along each side. `None` for what is no whole rectangle, and where no cells would be
    /// left.
    fn coarser(&self, times: u32) -> Option<Self> {
        let (topology, particles) = (&self.cloth.topology, &self.cloth.particles);
        let grid = topology.grid?;
        let fine = UVec2::new(grid.columns, grid.rows) - 1;
        let cells = fine / times.max(1);
        if cells.min_element() < 2 || topology.particle_count() as u32 != grid.columns * grid.rows {
            return None;
        }
        let size = grid.spacing * fine.as_vec2();
        let coarse = Arc::new(Topology::rectangle(size, Resolution::Cells(cells)).ok()?);
        let mut cloth = Cloth::new(coarse.clone(), &self.fabric).ok()?;
        let [places, speeds] =
            [&particles.position, &particles.velocity].map(|of| Sheet::of_grid(topology, |slot| of.get(slot)));
        let (places, speeds, to) = (places?, speeds?, coarse.grid?);
        for row in 0..to.rows {
            for column in 0..to.columns {
                let (slot, part) =
                    (to.slot(row, column) as usize, Vec2::new(column as f32, row as f32) / cells.as_vec2());
                let place = places.at(part).as_vec3();
                cloth.particles.position.set(slot, place);
                cloth.particles.previous.set(slot, place);
                cloth.particles.velocity.set(slot, speeds.at(part).as_vec3());
            }
        }
        // The particle of the coarse mesh that is nearest to one of the fine mesh.
        let near = |row: u32, column: u32| {
            let place = Vec2::new(column as f32, row as f32) * cells.as_vec2() / fine.as_vec2();
            let [column, row] = place.round().as_uvec2().to_array();
            to.slot(row, column)
        };
        let bare = Particles::new(topology, self.fabric.areal_density);
        let old = self.cloth.constraints.pins();
        let mut pins = Pins { frames: old.frames.clone(), pins: Vec::new() };
        for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column))) {
            let (slot, particle) = (grid.slot(row, column), near(row, column));
            let weight = particles.mass[slot as usize] - bare.mass[slot as usize];
            if weight > 1e-3 * bare.mass[slot as usize] {
                cloth.particles.add_mass(particle as usize, weight).ok()?;
            }
            let is_pinned = old.pins.iter().find(|pin| pin.particle == slot);
            if let Some(pin) = is_pinned.filter(|_| !pins.pins.iter().any(|pin| pin.particle == particle)) {
                let local =
                    pins.frames[pin.frame as usize].to.inverse_point(cloth.particles.position.get(particle as usize));
                pins.pins.push(Pin { particle, frame: pin.frame, local });
            }
        }
        cloth.constraints.set_pins(&mut cloth.particles, pins).ok()?;
        cloth.set_method(self.cloth.constraints.method());
        cloth.contacts.colliders = self.cloth.contacts.colliders.clone();
        (cloth.air, cloth.wind) = (self.cloth.air, self.cloth.wind.clone());
        if let Some(own) = &self.cloth.self_contacts {
            let distance = Some(own.distance());
            let settings = cloth_solver::contact::SelfContact { distance, ..Default::default() };
            cloth.set_self_contact(&self.fabric, &settings).ok()?;
        }
        let tearing = self.tearing.as_ref().map(|(_, tearing)| (Tear::new(&coarse, Vec::new()), *tearing));
        Some(Self { cloth, tearing, ..self.clone() })
    }

    /// Plays it for `seconds`. `None` if `go_on` says so.
    pub(crate) fn play(mut self, seconds: f32, go_on: impl Fn() -> bool) -> Option<Played> {
        let ticks = (seconds / self.tick.dt).round().clamp(2.0, 6000.0) as u32;
        let half = ticks / 2;
        let mut played = Played::default();
        let mut times = Vec::with_capacity(ticks as usize);
        for tick in 1..=ticks {
            if !go_on() {
                return None;
            }
            let begin = Instant::now();
            self.cloth.step(self.tick, self.gravity);
            if let Some((tear, _)) = &mut self.tearing {
                tear.watch(&self.cloth.topology, &self.cloth.particles, &mut self.cloth.constraints, self.tick.dt);
            }
            times.push(1e3 * begin.elapsed().as_secs_f64());
            played.touching = played.touching.max(self.cloth.self_contacts.as_ref().map_or(0, |own| own.touching()));
            played.load = played.load.max(self.load());
            // Moment i of n is the last tick of part i of the half.
            let part = |tick: u32| u64::from(tick.saturating_sub(half)) * u64::from(MOMENTS) / u64::from(ticks - half);
            if tick > half {
                let shape = self.shape();
                played.mean.add(&shape);
                if part(tick) > part(tick - 1) {
                    played.shapes.push(shape);
                }
            }
        }
        played.mean.scale(1.0 / (ticks - half) as f32);
        times.sort_by(f64::total_cmp);
        played.time = times[times.len() / 4];
        Some(played)
    }

    fn shape(&self) -> Shape {
        let (topology, position) = (&self.cloth.topology, &self.cloth.particles.position);
        let is_whole = topology.grid.is_some_and(|grid| topology.particle_count() as u32 == grid.columns * grid.rows);
        let grid = is_whole.then(|| Sheet::of_grid(topology, |slot| position.get(slot))).flatten();
        Shape(vec![grid.unwrap_or_else(|| Sheet::of_particles(topology, |slot| position.get(slot)))])
    }

    /// The largest load of a particle over its strength.
    fn load(&self) -> f32 {
        let Some((tear, tearing)) = &self.tearing else { return 0.0 };
        let load = |slot: usize| tear.load(slot) / (tear.strength(slot) * tearing.strength).max(f32::MIN_POSITIVE);
        (0..tear.slots()).map(load).fold(0.0, f32::max)
    }
}
