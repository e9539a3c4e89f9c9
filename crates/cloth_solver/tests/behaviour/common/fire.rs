//! Burning cloths for the tests of fire.

use std::sync::Arc;

use cloth_solver::damage;
use cloth_solver::damage::fire::{Flammability, ROOM_TEMPERATURE, Stage, Surroundings};
use cloth_solver::topology::{Change, MeshSource, Resolution};
use cloth_solver::{Fabric, Fire, Flammable, Particles, Topology};
use glam::{UVec2, Vec2, Vec3};

pub const DT: f32 = 1.0 / 60.0;

/// Cotton of 150 g/m².
pub const SHEET: Fabric = Fabric::COTTON_POPLIN;

/// Heat that takes it from room temperature to ignition, J/m².
pub const TO_IGNITION: f32 = 0.15 * 1340.0 * (Flammability::COTTON.ignition - ROOM_TEMPERATURE);

/// Cotton whose flames are so high that a particle just above one gets all of their flux.
pub const TALL_FLAMES: Flammability = Flammability { reach_up: 10.0, ..Flammability::COTTON };

/// A cloth that does not move, and its fire.
#[derive(Clone)]
pub struct Burning {
    pub topology: Arc<Topology>,
    pub particles: Particles,
    pub fire: Fire,
    pub around: Surroundings,
    pub dt: f32,
    /// When each particle burst into flame, s.
    pub lit_at: Vec<f32>,
    pub time: f32,
}

impl Burning {
    pub fn new(topology: Topology, fabric: &Fabric, flammable: &Flammable) -> Self {
        Self {
            particles: Particles::new(&topology, fabric.areal_density),
            fire: Fire::new(&topology, fabric, flammable).unwrap(),
            lit_at: vec![f32::INFINITY; topology.slots()],
            topology: Arc::new(topology),
            around: Surroundings::default(),
            dt: DT,
            time: 0.0,
        }
    }

    pub fn cotton(topology: Topology) -> Self {
        Self::new(topology, &SHEET, &Flammable::default())
    }

    /// Puts every particle where `place` takes its rest position.
    pub fn put(mut self, place: impl Fn(Vec3) -> Vec3) -> Self {
        for (slot, rest) in self.topology.rest.iter().enumerate() {
            self.particles.position.set(slot, place(*rest));
        }
        self
    }

    pub fn slots(&self, chosen: impl Fn(Vec3) -> bool) -> Vec<u32> {
        self.topology.particles().filter(|slot| chosen(self.topology.rest[*slot as usize])).collect()
    }

    /// Lights the particles whose rest position is `chosen`.
    pub fn light(&mut self, chosen: impl Fn(Vec3) -> bool) {
        for slot in self.slots(chosen) {
            assert!(self.fire.ignite_particle(slot).unwrap());
        }
    }

    pub fn tick(&mut self) {
        self.fire.burn(&self.topology, &self.particles, &self.around, self.dt).unwrap();
        self.time += self.dt;
        for slot in self.fire.ignited() {
            self.lit_at[*slot as usize] = self.time;
        }
    }

    /// Takes a change of its topology from `before` over.
    pub fn follow(&mut self, before: &Topology, change: &Change) {
        self.fire.follow(&self.topology, change);
        self.particles.follow(before, &self.topology, change);
        self.lit_at.resize(change.slots, f32::INFINITY);
    }

    /// Takes out what burnt through in the last tick.
    pub fn take_out(&mut self) {
        let before = self.topology.clone();
        if let Some(change) = damage::remove(&mut self.topology, self.fire.burnt_through()) {
            self.follow(&before, &change);
        }
    }

    pub fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds / self.dt).round() as u32 {
            self.tick();
        }
    }

    /// Burns from the low end along `along` (a coordinate of the rest shape) until the fire has crossed to the other,
    /// and gives its speed over the last three quarters of the way, m/s: the slope of the place over the time.
    pub fn speed(mut self, along: impl Fn(Vec3) -> f32) -> f32 {
        let place = |slot: u32| along(self.topology.rest[slot as usize]);
        let places: Vec<(u32, f32)> = self.topology.particles().map(|slot| (slot, place(slot))).collect();
        let low = places.iter().map(|(_, x)| *x).fold(f32::MAX, f32::min);
        let high = places.iter().map(|(_, x)| *x).fold(f32::MIN, f32::max);
        self.light(|rest| along(rest) < low + 1e-4);
        let wanted: Vec<(u32, f32)> =
            places.into_iter().filter(|(_, x)| *x > low + 0.25 * (high - low) && *x < high - 1e-4).collect();
        while wanted.iter().any(|(slot, _)| self.lit_at[*slot as usize].is_infinite()) {
            assert!(self.fire.is_warm() && self.time < 300.0, "the fire went out or stood still");
            self.tick();
        }
        let mean = |value: &dyn Fn(&(u32, f32)) -> f32| wanted.iter().map(value).sum::<f32>() / wanted.len() as f32;
        let (x, t) = (mean(&|(_, x)| *x), mean(&|(slot, _)| self.lit_at[*slot as usize]));
        let covariance = mean(&|(slot, at)| (at - x) * (self.lit_at[*slot as usize] - t));
        mean(&|(_, at)| (at - x) * (at - x)) / covariance
    }

    pub fn stage(&self, slot: u32) -> Stage {
        self.fire.stage(slot)
    }
}

/// A rectangle of `size`, m, of about square cells of `spacing`, m.
pub fn sheet(size: [f32; 2], spacing: f32) -> Topology {
    Topology::rectangle(size.into(), Resolution::Spacing(spacing)).unwrap()
}

/// A rectangular mesh of `size`, m, whose vertices lie in a grid of about `spacing` m turned by 45°, or with `jitter`
/// (in spacings) strewn about the places of a grid that is not turned. The border stays straight.
pub fn mesh(size: [f32; 2], spacing: f32, jitter: f32) -> Topology {
    let cells = (Vec2::from(size) / spacing).round().as_uvec2();
    let step = Vec2::from(size) / cells.as_vec2();
    let mut chance = 1_u32;
    let mut strewn = || {
        chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (chance >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut positions = Vec::new();
    for (y, x) in (0..=cells.y).flat_map(|y| (0..=cells.x).map(move |x| (y, x))) {
        let inside = x > 0 && x < cells.x && y > 0 && y < cells.y;
        let aside = Vec2::new(strewn(), strewn()) * if inside { jitter } else { 0.0 };
        positions.push(((UVec2::new(x, y).as_vec2() + aside) * step).extend(0.0));
    }
    let corner = |x: u32, y: u32| y * (cells.x + 1) + x;
    let mut indices = Vec::new();
    for (y, x) in (0..cells.y).flat_map(|y| (0..cells.x).map(move |x| (y, x))) {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1)];
        if jitter > 0.0 {
            indices.extend([a, b, d, a, d, c]);
        } else {
            // A fifth vertex in the middle of each cell: rows and columns of diamonds.
            positions.push((positions[a as usize] + positions[d as usize]) * 0.5);
            let m = positions.len() as u32 - 1;
            indices.extend([a, b, m, b, d, m, d, c, m, c, a, m]);
        }
    }
    Topology::from_mesh(MeshSource { positions: &positions, uvs: &[], indices: &indices }).unwrap()
}
