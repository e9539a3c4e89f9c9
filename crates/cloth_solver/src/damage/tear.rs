//! Tearing: a particle whose threads carry more than they can is parted, across the pull.
//!
//! The load of a particle along weft and along warp is the tension of its links, per width of fabric, smoothed over a few
//! ticks. The crack runs along warp or weft, between cells, and weakens the particles it points at: a tear runs on rather
//! than begin anew beside (Pfaff, Narain, de Joya, O'Brien 2014 refine the mesh for that; here the threads decide). What it
//! has passed is as strong as before: out of weak lips a hand would rip no more than what it holds.

use std::sync::Arc;

use glam::Vec3;

use crate::constraint::{Constraints, Pin, Tensions};
use crate::topology::{Along, Change, Surgery};
use crate::{ClothError, Particles, Soa3, Topology};

/// Time over which loads are smoothed, s: about three ticks of 1/60 s, so that no single jolt tears.
const SMOOTHING: f32 = 0.05;

/// A particle farther than this from the origin of its cloth's frame, in mean edges, tears no more: single precision does not
/// know the length of an edge there to better than a thousandth (2⁻²³ · 2¹³), and what it makes of that is no load.
const KNOWN: f32 = 8192.0;

/// How a cloth tears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tearing {
    /// Tension at which it tears, N/m; above 0, up to 1e9.
    pub strength: f32,
    /// Most particles that part in a tick, 1..=1000.
    pub splits: u32,
    /// Factor on the strength of the particles that a crack points at, until it has passed; 0..=1. 0.2–0.6 lets a tear run on.
    pub weakening: f32,
    /// Factor on the strength of what lies within [`reach`](Self::reach) of a pin, as a heading tape or an eyelet strengthens it;
    /// above 0, up to 1000.
    pub reinforcement: f32,
    /// How far from a pin, at rest and over the cloth, it is reinforced, m; 0..=1000. At 0 what is pinned is and nothing else.
    pub reach: f32,
}

impl Tearing {
    /// Tears at a tension of `strength` N/m: four particles in a tick, with a third of the strength ahead of a crack and five
    /// times as much within 0.1 m of a pin.
    pub const fn at(strength: f32) -> Self {
        Self { strength, splits: 4, weakening: 0.35, reinforcement: 5.0, reach: 0.1 }
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field out of range.
    pub fn validate(&self) -> Result<(), ClothError> {
        ClothError::check("Tearing::strength", self.strength, f32::MIN_POSITIVE..=1e9, "above 0, up to 1e9 N/m")?;
        ClothError::check("Tearing::splits", self.splits as f32, 1.0..=1000.0, "1..=1000")?;
        ClothError::check("Tearing::weakening", self.weakening, 0.0..=1.0, "0..=1")?;
        let field = "Tearing::reinforcement";
        ClothError::check(field, self.reinforcement, f32::MIN_POSITIVE..=1e3, "above 0, up to 1000")?;
        ClothError::check("Tearing::reach", self.reach, 0.0..=1e3, "0..=1000 m")
    }
}

/// A particle that parted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The particle.
    pub particle: u32,
    /// Its load over its strength when it did.
    pub overload: f32,
}

/// What tore in a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Torn {
    /// What that did to particles and triangles.
    pub change: Change,
    /// The particles that parted.
    pub splits: Vec<Split>,
}

/// What is known of a cloth that may tear: the load of each particle, and how weak it is.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
pub struct Tear {
    /// Smoothed tension along weft and warp at each slot, N/m.
    load: [Vec<f32>; 2],
    /// Factor on the strength of each slot, as painted and reinforced, and as it is now: weaker where a crack points at it.
    whole: Vec<f32>,
    weak: Vec<f32>,
    /// Factor that is due to the pins near each slot, and what it was made of.
    reinforced: Vec<f32>,
    tape: Tape,
    /// Distance from the frame's origin up to which loads are known, m.
    known: f32,
    tensions: Tensions,
    overloaded: Vec<(u32, Along, f32)>,
}

impl Tear {
    /// Nothing loaded. `painted` is a factor on the strength of each slot, or empty.
    pub fn new(topology: &Topology, painted: Vec<f32>) -> Self {
        let slots = topology.slots();
        let mut painted = painted;
        painted.resize(slots, 1.0);
        let rest = |slot: u32| topology.rest[slot as usize];
        let total: f32 = topology.edges.iter().map(|[a, b]| rest(*a).distance(rest(*b))).sum();
        let known = KNOWN * total / topology.edges.len().max(1) as f32;
        let load = [vec![0.0; slots], vec![0.0; slots]];
        Self { load, weak: painted.clone(), whole: painted, reinforced: vec![1.0; slots], known, ..Self::default() }
    }

    /// Number of slots it knows.
    pub fn slots(&self) -> usize {
        self.weak.len()
    }

    /// The larger load of a slot along weft or warp, N/m.
    pub fn load(&self, slot: usize) -> f32 {
        self.load[0][slot].max(self.load[1][slot])
    }

    /// The factor on the strength of a slot.
    pub fn strength(&self, slot: usize) -> f32 {
        self.weak[slot]
    }

    /// Takes over what was cut or burnt.
    pub fn follow(&mut self, change: &Change) {
        for numbers in self.load.iter_mut().chain([&mut self.whole, &mut self.weak, &mut self.reinforced]) {
            numbers.resize(change.slots, 0.0);
            for born in &change.born {
                numbers[born.slot as usize] = born.blend(|slot| numbers[slot]);
            }
        }
    }

    /// Takes note of the loads at the end of a tick of `dt` s.
    pub fn watch(&mut self, topology: &Topology, particles: &Particles, constraints: &mut Constraints, dt: f32) {
        constraints.tensions(topology, particles, &mut self.tensions);
        let (fresh, farthest) = (dt / (SMOOTHING + dt), self.known * self.known);
        let Soa3 { x, y, z } = &particles.position;
        for (load, sums) in self.load.iter_mut().zip(self.tensions.along()) {
            let sums = sums.tension.iter().zip(&sums.weight);
            for ((load, (tension, weight)), ((x, y), z)) in load.iter_mut().zip(sums).zip(x.iter().zip(y).zip(z)) {
                let is_known = (*weight > 0.0) & (x * x + y * y + z * z < farthest);
                let now = if is_known { tension / weight } else { 0.0 };
                *load += (now - *load) * fresh;
            }
        }
    }

    /// Parts what carries more than `tearing` allows, the most overloaded first, in a cloth that hangs on `pins`. `strength` is a
    /// further factor on the strength of each slot (of what is charred, say), or empty. `None` if nothing tears, which takes
    /// next to no time. What tore, this too has to [`follow`](Self::follow).
    pub fn tear(
        &mut self,
        topology: &mut Arc<Topology>,
        pins: &[Pin],
        tearing: &Tearing,
        strength: &[f32],
    ) -> Option<Torn> {
        self.reinforce(topology, pins, tearing);
        self.find_overloaded(tearing, strength);
        self.keep_what_can_part(topology);
        if self.overloaded.is_empty() {
            return None;
        }
        let mut surgery = Surgery::new(topology);
        let mut splits = Vec::new();
        for &(particle, along, overload) in &self.overloaded {
            if splits.len() as u32 >= tearing.splits {
                break;
            }
            if let Some(ends) = split(&mut surgery, particle, along) {
                splits.push(Split { particle, overload });
                // The crack has passed: its lips are as strong as any edge. What it points at now is weak, if it was not born in
                // this very tick.
                self.weak[particle as usize] = self.whole[particle as usize];
                for slot in ends {
                    let known = self.weak.get_mut(slot as usize).zip(self.whole.get(slot as usize));
                    known.into_iter().for_each(|(weak, whole)| *weak = whole * tearing.weakening);
                }
            }
        }
        let change = surgery.finish()?;
        Some(Torn { change, splits })
    }

    /// Strengthens what lies near a pin, if pins or tape are others than before.
    fn reinforce(&mut self, topology: &Topology, pins: &[Pin], tearing: &Tearing) {
        let Tearing { reinforcement, reach, .. } = *tearing;
        if self.tape.is(pins, reinforcement, reach) {
            return;
        }
        self.tape = Tape { pins: pins.iter().map(|pin| pin.particle).collect(), reinforcement, reach };
        let near = self.tape.covered(topology);
        for (slot, near) in near.into_iter().enumerate() {
            let now = if near { reinforcement } else { 1.0 };
            let change = now / self.reinforced[slot];
            self.whole[slot] *= change;
            self.weak[slot] *= change;
            self.reinforced[slot] = now;
        }
    }

    fn find_overloaded(&mut self, tearing: &Tearing, strength: &[f32]) {
        self.overloaded.clear();
        // Nothing gets weaker than this; a loop without an exit becomes vector code.
        let weakest = strength.iter().fold(1.0_f32, |least, part| least.min(*part)) * tearing.strength;
        let over = |any: bool, (load, weak): (&f32, &f32)| any | (*load > weakest * weak);
        if !self.load.iter().any(|load| load.iter().zip(&self.weak).fold(false, over)) {
            return;
        }
        for (along, load) in [Along::Weft, Along::Warp].into_iter().zip(&self.load) {
            for (slot, (load, weak)) in load.iter().zip(&self.weak).enumerate() {
                let limit = tearing.strength * weak * strength.get(slot).copied().unwrap_or(1.0);
                if *load > limit {
                    self.overloaded.push((slot as u32, along, load / limit.max(f32::MIN_POSITIVE)));
                }
            }
        }
    }

    /// Forgets those overloaded particles whose triangles all lie on one side, at the end of a thread: charred ones stay
    /// overloaded for as long as they are there.
    fn keep_what_can_part(&mut self, topology: &Topology) {
        if self.overloaded.is_empty() {
            return;
        }
        // For each slot on which sides triangles lie: before and after it along the weft, before and after it along the warp.
        const OVERLOADED: u8 = 1 << 4;
        let bit = |along: Along, after: bool| 1 << (2 * u8::from(along == Along::Warp) + u8::from(after));
        let mut sides = vec![0_u8; topology.slots()];
        self.overloaded.iter().for_each(|(slot, ..)| sides[*slot as usize] = OVERLOADED);
        for (triangle, corners) in topology.triangles.iter().enumerate() {
            for slot in corners {
                let sides = &mut sides[*slot as usize];
                if *sides != 0 {
                    for along in [Along::Weft, Along::Warp] {
                        *sides |= bit(along, is_after(topology, triangle as u32, *slot, along));
                    }
                }
            }
        }
        let is_between =
            |slot: u32, along| [false, true].iter().all(|after| sides[slot as usize] & bit(along, *after) != 0);
        self.overloaded.retain(|(slot, along, _)| is_between(*slot, *along));
        self.overloaded.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
    }
}

/// What strengthens the cloth around its pins.
#[cfg_attr(feature = "save", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Debug, Default)]
struct Tape {
    /// The particles pinned.
    pins: Vec<u32>,
    reinforcement: f32,
    reach: f32,
}

impl Tape {
    fn is(&self, pins: &[Pin], reinforcement: f32, reach: f32) -> bool {
        (self.reinforcement, self.reach) == (reinforcement, reach)
            && self.pins.iter().copied().eq(pins.iter().map(|pin| pin.particle))
    }

    /// Whether each slot lies within reach of a pin: by rest positions, over edges that lie within reach themselves, so that it
    /// does not leap to another layer.
    fn covered(&self, topology: &Topology) -> Vec<bool> {
        let mut nearest: Vec<Option<(f32, Vec3)>> = vec![None; topology.slots()];
        for pin in self.pins.iter().map(|pin| *pin as usize).filter(|pin| *pin < topology.slots()) {
            nearest[pin] = Some((0.0, topology.rest[pin]));
        }
        loop {
            let mut is_done = true;
            let ways =
                topology.edges.iter().flat_map(|[a, b]| [[*a as usize, *b as usize], [*b as usize, *a as usize]]);
            for [from, to] in ways {
                let Some((_, pin)) = nearest[from] else { continue };
                let distance = pin.distance(topology.rest[to]);
                if distance <= self.reach && nearest[to].is_none_or(|(known, _)| distance < known) {
                    nearest[to] = Some((distance, pin));
                    is_done = false;
                }
            }
            if is_done {
                return nearest.iter().map(Option::is_some).collect();
            }
        }
    }
}

/// Parts `particle` of `topology` as if it were pulled along `pull`; `None` if it cannot be parted.
pub fn tear_at(topology: &mut Arc<Topology>, particle: u32, pull: Direction) -> Option<Change> {
    topology.is_particle(particle).then_some(())?;
    let mut surgery = Surgery::new(topology);
    split(&mut surgery, particle, pull.along())?;
    surgery.finish()
}

/// A direction of the weave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Along the weft: across the cloth.
    Weft,
    /// Along the warp: down the cloth.
    Warp,
}

impl Direction {
    fn along(self) -> Along {
        match self {
            Self::Weft => Along::Weft,
            Self::Warp => Along::Warp,
        }
    }
}

/// On which side of `particle` one of its triangles lies at rest: whether it comes after it along the weft or the warp.
fn is_after(topology: &Topology, triangle: u32, particle: u32, along: Along) -> bool {
    let rest = topology.triangle_rest[triangle as usize];
    let flat = [glam::Vec2::ZERO, rest.x_axis, rest.y_axis];
    let corner = topology.triangles[triangle as usize].iter().position(|slot| *slot == particle).unwrap_or(0);
    let middle = (flat[0] + flat[1] + flat[2]) / 3.0 - flat[corner];
    match along {
        Along::Weft => middle.x > 0.0,
        Along::Warp => middle.y > 0.0,
    }
}

/// Parts the fan of `particle` by the line through it that runs across `along`; the particles that the crack points at, or
/// `None` if all its triangles lie on one side.
fn split(surgery: &mut Surgery, particle: u32, along: Along) -> Option<Vec<u32>> {
    let fan = surgery.fan(particle);
    let topology = surgery.topology();
    let side = |triangle: &u32| (*triangle, is_after(topology, *triangle, particle, along));
    let sides: Vec<(u32, bool)> = fan.iter().map(side).collect();
    if sides.iter().all(|(_, after)| *after) || !sides.iter().any(|(_, after)| *after) {
        return None;
    }
    let corners = |after: bool| {
        let triangles = sides.iter().filter(move |(_, side)| *side == after).map(|(triangle, _)| *triangle);
        triangles.flat_map(|triangle| topology.triangles[triangle as usize]).filter(|slot| *slot != particle)
    };
    let ends: Vec<u32> = corners(true).filter(|slot| corners(false).any(|other| other == *slot)).collect();
    let of = |triangle: u32| sides.iter().find(|(known, _)| *known == triangle).map(|(_, after)| *after);
    surgery.part_all(vec![particle], |_, a, b| of(a) != of(b));
    Some(ends)
}
